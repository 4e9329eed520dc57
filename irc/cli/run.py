"""`irc run --stdio`: serves one execution; reads and prints lines of JSON."""

from __future__ import annotations

import json
import signal
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import IO, TYPE_CHECKING

from irc.cli.exit_codes import EXIT_USE
from irc.cli.interruption import INTERRUPTION, Interrupted
from irc.cli.output import Format, fail, print_notes, reporting_errors, say
from irc.cli.planning import (
    end_with,
    execution_of,
    read_sound_task,
    require_engine,
    schedule_to_begin_with,
)
from irc.diagnostics import Code, Diagnostic, InputError, Report
from irc.driver.solve import solve_task
from irc.execution.execution import Execution, Presume
from irc.frontends.texts import STANDARD_INPUT
from irc.model import Task
from irc.schedule import Schedule
from irc.service.journal import Journal, JournalError
from irc.service.protocol import MAX_LINE
from irc.service.session import Session, first_schedule
from irc.targets import SolveOptions

if TYPE_CHECKING:
    from irc.service.board import Board


def run_file(
    file: str,
    stdio: bool,
    schedule: str | None,
    journal: Path | None,
    options: SolveOptions,
    presume: Presume = "assume",
    board: int | None = None,
) -> None:
    """Serves one execution until its requests end or one of them is `stop`.

    `board` is the port of a page that shows the execution meanwhile.
    """
    if not stdio:
        fail(EXIT_USE, "add --stdio: requests come from standard input", Format.text)
    if STANDARD_INPUT in (file, schedule):
        fail(EXIT_USE, "standard input is for the requests: name a file", Format.text)
    # (Every acknowledged request is on disk.)
    INTERRUPTION.usual = signal.SIGTERM
    with reporting_errors(Format.text), ExitStack() as open_files:
        require_engine(options)
        task = read_sound_task(file, Format.text)
        try:
            with INTERRUPTION.planning() as cancel:
                options = replace(options, cancel=cancel)
                session = _session(task, schedule, journal, options, open_files, presume)
            if INTERRUPTION.status is None:
                _serve(session, sys.stdin.buffer, _board(session, board, open_files))
        except Interrupted as interrupted:
            sys.exit(interrupted.status)
        except JournalError as error:
            fail(EXIT_USE, str(error), Format.text)


def _session(
    task: Task,
    schedule: str | None,
    path: Path | None,
    options: SolveOptions,
    open_files: ExitStack,
    presume: Presume,
) -> Session:
    def make(first: Schedule) -> Execution:
        return execution_of(task, first, options, source=source, presume=presume)

    given, source = (None, None) if schedule is None else schedule_to_begin_with(schedule, task)
    if path is None:
        first = given or _planned(task, options)
        return Session.start(make(first))
    journal, found = Journal.open(path)
    open_files.enter_context(journal)
    if found is None:
        first = given or _planned(task, options)
        return Session.start(make(first), journal)
    begun = first_schedule(task, found)
    if given is not None and given.entries != begun.entries:
        raise InputError(Report((_other_schedule(),)))
    if (was := found.header.get("presume", "assume")) != presume:
        raise InputError(Report((_other_presumption(str(was)),)))
    return Session.resume(make, task, journal, found)


def _planned(task: Task, options: SolveOptions) -> Schedule:
    schedule = solve_task(task, options).schedule
    if not schedule.answered:
        say(f"error: there is no schedule to begin with: {schedule.status}")
        end_with([schedule.status])
    return schedule


def _other_presumption(was: str) -> Diagnostic:
    return Diagnostic(
        Code.OTHER_JOURNAL,
        f"the execution in the journal began with --presume {was}",
        hint=f"continue it with --presume {was}, or start another journal",
    )


def _other_schedule() -> Diagnostic:
    return Diagnostic(
        Code.OTHER_JOURNAL,
        "the execution in the journal began with another schedule",
        hint="leave --schedule out to continue it, or start another journal",
    )


def _board(session: Session, port: int | None, open_files: ExitStack) -> Board | None:
    """The board of a session, which is served until the files are closed."""
    if port is None:
        return None
    from irc.service.board import Board
    from irc.service.board_server import BoardServer

    board = Board(session.execution.copy())
    server = open_files.enter_context(BoardServer(board, port))
    say(f"board: {server.url}")
    return board


def _serve(session: Session, requests: IO[bytes], board: Board | None) -> None:
    if session.notes:
        print_notes(session.notes)
    _send(json.dumps(session.greeting(), ensure_ascii=False, allow_nan=False))
    for line in _lines(requests):
        if len(line) > MAX_LINE:
            _send(session.too_long().line())
            continue
        with INTERRUPTION.planning(session.execution.options.cancel):
            try:
                answer = session.answer(line)
            except JournalError as error:
                _send(session.broken(str(error)).line())
                raise
            _send(answer.line())
        if board is not None and answer.document["ok"]:
            board.publish(session.execution, session.happened)
        if answer.last or INTERRUPTION.status is not None:
            return
        if (unsaved := session.save()) is not None:
            say(f"note: {unsaved}")


def _lines(requests: IO[bytes]) -> Iterator[bytes]:
    """The lines that are not blank; a too long line is cut just behind the limit."""
    while line := requests.readline(MAX_LINE + 1):
        rest = line
        while len(rest) > MAX_LINE and not rest.endswith(b"\n"):
            rest = requests.readline(MAX_LINE + 1)
        if line.strip():
            yield line


def _send(line: str) -> None:
    sys.stdout.buffer.write(line.encode() + b"\n")
    sys.stdout.buffer.flush()
