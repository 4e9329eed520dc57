"""Commands that write, while the machine fails them: killed, on a full disk, into a closed pipe.

A file is the previous one or the new one, whole; and whoever still reads gets a message in words.
"""

from __future__ import annotations

import contextlib
import json
import os
import random
import resource
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from paths import EXAMPLES
from runs import run_irc

Seeds = Iterator[int]
OLD = '{"old": true}\n'
TASK = EXAMPLES / "late_dinner.json"


@dataclass(frozen=True)
class Command:
    """Arguments of `irc` for a folder, and the file that they write there."""

    arguments: Callable[[Path], list[str | Path]]
    writes: str


def _in_place(folder: Path) -> list[str | Path]:
    return ["fmt", folder / "task.json"]


COMMANDS = {
    "solve": Command(lambda d: ["solve", TASK, "-o", d / "out.json"], "out.json"),
    "convert": Command(lambda d: ["convert", TASK, "-o", d / "out.json"], "out.json"),
    "compile": Command(
        lambda d: ["compile", TASK, "-t", "pddl21", "-o", d / "files"], "files/manifest.json"
    ),
    "replan": Command(
        lambda d: ["replan", TASK, "-s", d / "plan.json", "--at", "5", "-o", d / "out.json"],
        "out.json",
    ),
    "simulate": Command(lambda d: ["simulate", TASK, "-o", d / "out.json"], "out.json"),
    "fmt": Command(_in_place, "task.json"),
}


def prepared(folder: Path) -> None:
    plan = run_irc("solve", TASK, "--format", "json").stdout
    (folder / "plan.json").write_text(plan)
    (folder / "out.json").write_text(OLD)
    (folder / "task.json").write_text(TASK.read_text().replace("\n", " \n"))


def started(command: Command, folder: Path, **options: object) -> subprocess.Popen[bytes]:
    arguments = [str(a) for a in command.arguments(folder)]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **options}
    return subprocess.Popen([sys.executable, "-m", "irc", *arguments], **pipes)  # type: ignore[call-overload,no-any-return]


def is_whole(file: Path, before: str | None) -> bool:
    """Whether a file is absent as before, the previous one, or a complete document."""
    if not file.exists():
        return before is None
    text = file.read_text()
    if text == before:
        return True
    with contextlib.suppress(json.JSONDecodeError):
        return isinstance(json.loads(text), dict | list)
    return False


def content(file: Path) -> str | None:
    return file.read_text() if file.exists() else None


@pytest.mark.parametrize("name", COMMANDS)
def test_a_killed_command_leaves_whole_files(
    seeds: Seeds, name: str, tmp_path_factory: pytest.TempPathFactory
) -> None:
    command = COMMANDS[name]
    for seed in seeds:
        folder = tmp_path_factory.mktemp("killed")
        prepared(folder)
        file = folder / command.writes
        before = content(file)
        process = started(command, folder, start_new_session=True)
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(random.Random(f"kill {seed}").uniform(0.1, 3.0))
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        assert is_whole(file, before), (seed, content(file))


def _full_disk(most: int) -> Callable[[], None]:
    def limited() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))

    return limited


@pytest.mark.parametrize("name", COMMANDS)
def test_on_a_full_disk_the_previous_file_stays_and_a_message_says_why(
    seeds: Seeds, name: str, tmp_path_factory: pytest.TempPathFactory
) -> None:
    command = COMMANDS[name]
    for seed in seeds:
        folder = tmp_path_factory.mktemp("full")
        prepared(folder)
        file = folder / command.writes
        before = content(file)
        most = random.Random(f"full {seed}").choice((0, 1, 50, 200))
        process = started(command, folder, preexec_fn=_full_disk(most))
        _, said = process.communicate(timeout=120)
        assert b"Traceback" not in said, said.decode()
        assert process.returncode != 0
        assert content(file) == before
        assert [f.name for f in folder.rglob("*.tmp")] == []


@pytest.mark.parametrize("name", ["solve", "check", "explain", "targets", "schema"])
def test_a_reader_that_goes_away_gets_no_traceback(seeds: Seeds, name: str) -> None:
    for seed in seeds:
        arguments = [] if name == "schema" else [str(TASK)]
        process = subprocess.Popen(
            [sys.executable, "-m", "irc", name, *arguments],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )
        assert process.stdout is not None
        process.stdout.read(random.Random(f"pipe {seed}").choice((0, 1)))
        process.stdout.close()
        assert process.stderr is not None
        said = process.stderr.read()
        process.wait(120)
        assert b"Traceback" not in said, said.decode()
        assert b"Exception ignored" not in said, said.decode()
