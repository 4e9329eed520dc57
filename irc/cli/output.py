"""Output and errors of every command: standard output, standard error, exit codes."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from enum import StrEnum
from typing import Any, NoReturn

from irc.cli.exit_codes import EXIT_ENGINE, EXIT_INPUT, EXIT_NO_ANSWER, EXIT_USE
from irc.diagnostics import DIAGNOSTICS_VERSION, Diagnostic, InputError, Report, Severity
from irc.diagnostics.source import Source
from irc.errors import IrcError
from irc.outcome import FAILED, FAULTY, INTERRUPTED, MISUSED, UNKNOWN, Outcome


class Format(StrEnum):
    """The output format of a command."""

    text = "text"
    json = "json"


class CheckFormat(StrEnum):
    """The output format of `irc check`."""

    text = "text"
    json = "json"
    sarif = "sarif"


def say(text: str) -> None:
    """Prints a message for people on standard error."""
    print(_writable(text, sys.stderr), file=sys.stderr)


def put(text: str) -> None:
    """Prints a result on standard output."""
    sys.stdout.write(_writable(text if text.endswith("\n") else text + "\n", sys.stdout))
    sys.stdout.flush()


def _writable(text: str, stream: Any) -> str:
    encoding = getattr(stream, "encoding", None) or "utf-8"
    return text.encode(encoding, "backslashreplace").decode(encoding)


def put_json(document: Any) -> None:
    """Prints a JSON document on standard output, which has nothing else."""
    encoding = (getattr(sys.stdout, "encoding", None) or "utf-8").lower().replace("-", "")
    put(json.dumps(document, indent=2, ensure_ascii=encoding != "utf8", allow_nan=False))


def summary(report: Report) -> str:
    """The counts of a report in words: "2 errors, 1 warning"; empty without findings."""
    counts = {s: sum(d.severity is s for d in report) for s in Severity}
    return ", ".join(f"{n} {s}{'s' if n != 1 else ''}" for s, n in counts.items() if n)


def print_notes(notes: Iterable[Diagnostic], source: Source | None = None) -> None:
    """Prints the notes beside an answer on standard error.

    Without a `source`, only notes that carry their own source show their place.
    """
    shown = Report(tuple(notes), source).render()
    if shown:
        say(shown)


def fail(code: int, message: str, format: Format, status: str | None = None) -> NoReturn:
    """Exits with a code and one message; `status` is that of the outcome, if not the usual one."""
    if format is Format.json:
        outcome = Outcome.of(status or _STATUS.get(code, INTERRUPTED), (), message)
        document = {"irc_error": DIAGNOSTICS_VERSION, "exit": code, "message": message}
        put_json({**document, "outcome": {**outcome.to_dict(), "exit": code}})
    say(f"error: {message}")
    sys.exit(code)


_STATUS = {EXIT_INPUT: FAULTY, EXIT_USE: MISUSED, EXIT_NO_ANSWER: UNKNOWN, EXIT_ENGINE: FAILED}
"""The status of the outcome of a command that exits with a code and a message."""


def prepare(format: Format, *, steps: bool = False) -> None:
    """Loads what showing an answer takes, or `steps`: before planning, so that after it nothing is
    slow."""
    if format is Format.text:
        import irc.cli.render

        if steps:
            import irc.cli.step_text  # noqa: F401


@contextmanager
def reporting_errors(format: Format) -> Iterator[None]:
    """Turns irc's errors into messages and exit codes, so that none ends in a traceback."""
    from irc.cli.interruption import Interrupted
    from irc.driver.files import WriteError
    from irc.targets import EngineFailed, EngineMissing, UnknownTarget

    try:
        yield
    except Interrupted as interrupted:
        fail(interrupted.status, "interrupted, before there was anything to show", format)
    except InputError as error:
        if format is Format.json:
            put_json(error.report.to_dict())
        else:
            say(error.report.render())
            status = error.outcome.status
            say(summary(error.report) if status == FAULTY else f"{status}: {summary(error.report)}")
        sys.exit(EXIT_INPUT)
    except UnknownTarget as error:
        fail(EXIT_USE, str(error), format)
    except WriteError as error:
        fail(EXIT_USE, str(error), format)
    except (EngineMissing, EngineFailed) as error:
        fail(EXIT_ENGINE, str(error), format, error.ends_as)
    except IrcError as error:
        fail(error.outcome.exit, str(error), format, error.ends_as)
