"""Runs `irc` commands in a folder, in this process, and reads the diagnostics they show."""

from __future__ import annotations

import contextlib
import re
import shlex
import sys
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from typer import Typer
from typer.testing import CliRunner, Result

from irc.cli.app import build_app

_FINDING = re.compile(
    r"^(?:error|warning|note)\[(IRC\d+)\]: .*\n(?:  --> (.+):(\d+):(\d+)$)?", re.MULTILINE
)
_SUMMARY = re.compile(
    r"(?:infeasible: |refused: )?\d+ (?:error|warning|note)s?(?:, \d+ (?:error|warning|note)s?)*"
)


@dataclass(frozen=True)
class Told:
    """What a command said: its exit code, and each finding with its place ("2:13", or none)."""

    exit_code: int
    findings: tuple[tuple[str, str | None], ...]
    text: str
    """The diagnostics alone, as they were shown."""


@cache
def _app(command: str | None) -> Typer:
    """The application with this command, as `irc` itself builds it to start quickly."""
    return build_app(command)


def run_irc(*arguments: object, stdin: str | bytes | None = None) -> Result:
    """What an `irc` command says in this process; an exception other than its exit is raised."""
    given = [str(a) for a in arguments]
    result = CliRunner().invoke(_app(given[0] if given else None), given, input=stdin)
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    return result


def run_command(command: str, folder: Path, *, engine: tuple[str, Path] | None = None) -> Told:
    """Runs one command line. `engine` is a planner's name and a file with what it is to print."""
    program, *arguments = shlex.split(command)
    assert program == "irc"
    environment = {}
    if engine is not None:
        name, printed = engine
        environment[f"IRC_{name.upper()}"] = str(_planner(folder, printed))
    with contextlib.chdir(folder):
        result = CliRunner(env=environment).invoke(_app(arguments[0]), arguments)
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    said = result.stderr if "[IRC" in result.stderr else result.stdout
    found = tuple(
        (code, f"{line}:{column}" if line else None)
        for code, _, line, column in _FINDING.findall(said)
    )
    lines = [line for line in said.rstrip().split("\n") if not _SUMMARY.fullmatch(line)]
    return Told(result.exit_code, found, "\n".join(lines) if found else "")


def _planner(folder: Path, printed: Path) -> Path:
    """A planner that prints a file, whatever it is asked."""
    command = folder / "planner"
    script = Path(__file__).parent / "fakes" / "prints_then.py"
    quoted = " ".join(shlex.quote(str(p)) for p in (sys.executable, script, printed))
    command.write_text(f"#!/bin/sh\nexec {quoted} exits\n", encoding="utf-8")
    command.chmod(0o755)
    return command
