"""`irc solve`: one task or several, solved, written and shown."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Sequence
from contextlib import nullcontext, redirect_stdout
from dataclasses import dataclass, replace
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from irc.cli.exit_codes import EXIT_USE
from irc.cli.options import (
    DeterministicOption,
    EngineOption,
    FileOutOption,
    FormatOption,
    MemoryLimitOption,
    ProblemOption,
    SchedulerOption,
    SeedOption,
    TargetOption,
    TimeLimitOption,
    TimesOption,
    WorkersOption,
    WorkLimitOption,
)
from irc.cli.output import (
    Format,
    fail,
    prepare,
    print_notes,
    put,
    put_json,
    reporting_errors,
    say,
)
from irc.cli.times import TimesStyle
from irc.errors import IrcError

if TYPE_CHECKING:
    from irc.driver.judge import Answer
    from irc.frontends.files import Reading
    from irc.targets import SolveOptions

NAME = "{name}"
"""In the name of an output file, the name of the task's file without its ending."""


def solve(
    files: Annotated[
        list[str],
        typer.Argument(
            metavar="FILE...",
            help="Tasks: JSON, the DSL, or English; '-' is standard input. A PDDL domain goes with "
            "its problem.",
        ),
    ],
    target: TargetOption = "cpsat",
    engine: EngineOption = "auto",
    problem: ProblemOption = None,
    time_limit: TimeLimitOption = 60.0,
    memory_limit: MemoryLimitOption = None,
    seed: SeedOption = 0,
    workers: WorkersOption = None,
    deterministic: DeterministicOption = False,
    work_limit: WorkLimitOption = None,
    scheduler: SchedulerOption = None,
    shortcut: Annotated[
        bool,
        typer.Option(
            "--shortcut/--no-shortcut",
            help="Solve by the critical path alone if there is no contention.",
        ),
    ] = True,
    times: TimesOption = None,
    output: FileOutOption = None,
    format: FormatOption = Format.text,
) -> None:
    """Compile a task, run an engine, and show the exact, validated schedule.

    Several tasks are solved one after the other, each within the limits; in the name behind -o,
    {name} is that of each task's file.
    """
    from irc.targets import SolveOptions

    options = SolveOptions(target, engine, time_limit, memory_limit, workers, seed, shortcut)
    with reporting_errors(format):
        options = replace(options, deterministic=deterministic, work_limit=work_limit)
        tasks = list(_tasks(files, problem, output, format))
    if len(tasks) == 1:
        _solve(tasks[0], options, scheduler, times, format, first=True)
    else:
        _solve_all(tasks, options, scheduler, times, format)


@dataclass(frozen=True, slots=True)
class _Input:
    """A task to solve: its file, its problem file in PDDL, and the file for its schedule."""

    file: str
    problem: str | None
    output: Path | None


def _tasks(
    files: Sequence[str], problem: str | None, output: Path | None, format: Format
) -> Iterator[_Input]:
    """The tasks of some files. Exits with wrong use where they do not go together."""
    pairs = [(file, problem) for file in files]
    if problem is not None and len(files) > 1:
        fail(EXIT_USE, "--problem goes with one file, the domain", format)
    if problem is None and len(files) > 1 and all(f.lower().endswith(".pddl") for f in files):
        pairs = _pddl_pairs(files, format)
    if list(files).count("-") > 1:
        fail(EXIT_USE, "only one of the inputs can be standard input", format)
    outputs = [_output(output, file) for file, _ in pairs]
    if output is not None and len(set(outputs)) < len(outputs):
        message = f"several tasks cannot be written to {str(output)!r}: write {NAME} into its name"
        if NAME in str(output):
            message = f"two of the tasks would be written to one file by {str(output)!r}"
        fail(EXIT_USE, message, format)
    for (file, beside), path in zip(pairs, outputs, strict=True):
        yield _Input(file, beside, path)


def _output(output: Path | None, file: str) -> Path | None:
    if output is None:
        return None
    name = "stdin" if file == "-" else Path(file).stem
    return Path(str(output).replace(NAME, name))


def _pddl_pairs(files: Sequence[str], format: Format) -> list[tuple[str, str | None]]:
    """The domain with each of the problems."""
    from irc.frontends.mistaken import part_of_pddl
    from irc.frontends.texts import read_text

    parts = {file: part_of_pddl(read_text(file)[0]) for file in files}
    domains = [file for file in files if parts[file] == "domain"]
    if len(domains) != 1:
        fail(EXIT_USE, f"expected one PDDL domain and its problems, found {len(domains)}", format)
    return [(domains[0], file) for file in files if file != domains[0]]


def _solve_all(
    tasks: Sequence[_Input],
    options: SolveOptions,
    scheduler: str | None,
    times: TimesStyle | None,
    format: Format,
) -> None:
    """Solves tasks one after the other; exits with the status of the first one that failed."""
    from irc.cli.interruption import INTERRUPTION

    statuses = []
    for k, task in enumerate(tasks):
        if format is Format.text:
            put(f"{'' if not k else chr(10)}{task.problem or task.file}")
        printed = StringIO()
        try:
            if format is Format.json:
                with redirect_stdout(printed):
                    _solve(task, options, scheduler, times, format, first=not k)
            else:
                _solve(task, options, scheduler, times, format, first=not k)
        except SystemExit as ended:
            statuses.append(ended.code)
        if format is Format.json:
            put(json.dumps(json.loads(printed.getvalue()), ensure_ascii=False))
        if INTERRUPTION.number is not None:
            break
    sys.exit(next((status for status in statuses if status), 0))


def _solve(
    task: _Input,
    options: SolveOptions,
    scheduler: str | None,
    times: TimesStyle | None,
    format: Format,
    *,
    first: bool,
) -> None:
    from irc.cli.interruption import INTERRUPTION
    from irc.cli.progress import progress_shown
    from irc.cli.times import require_times
    from irc.driver.solve import solve_task
    from irc.frontends.files import read_task
    from irc.model.garbage import without_garbage
    from irc.reporting.files import require_fit, require_output

    with reporting_errors(format), INTERRUPTION.planning() as cancel:
        require_output(task.output)
        reading = read_task(task.file, task.problem)
        large = reading.task.columns is not None
        with without_garbage() if large else nullcontext():
            require_fit(task.output, reading.task)
            require_times(reading.task, times)
            prepare(format)
            with progress_shown(reading.task) as on_progress:
                chosen = replace(options, on_progress=on_progress, cancel=cancel)
                spent = INTERRUPTION.spent(task.file) if first else 0.0
                budget = chosen.budget(spent)
                if scheduler is None:
                    answer = solve_task(reading.task, chosen, budget)
                else:
                    from irc.cluster.solving import solve_on_cluster

                    answer = solve_on_cluster(reading.task, scheduler, chosen, budget)
            print_reading_notes(reading, format)
            if answer.schedule.status == "infeasible" and format is Format.text:
                from irc.cli.explain import hint_for

                say(hint_for(task.file))
            show_answer(answer, task.output, times, format)


def print_reading_notes(reading: Reading, format: Format) -> None:
    """Prints the notes on the text of a task."""
    if reading.notes and format is Format.text:
        print_notes(reading.notes, reading.task.source)


def show_answer(
    answer: Answer, output: Path | None, times: TimesStyle | None, format: Format
) -> None:
    """Writes the file that is asked for, prints an answer, and exits where there is none."""
    schedule = answer.schedule
    print_notes(answer.notes)
    # (The file first: the reader of what is printed may end before all of it is.)
    wrote, refused = False, None
    try:
        wrote = output is not None and _write_answer(output, answer, times)
    except IrcError as error:
        refused = error
    if format is Format.json:
        put_json(schedule.to_dict())
    else:
        from irc.cli.page import answer_console, in_a_file
        from irc.cli.render import CHART_UP_TO, print_answer

        # (A file has the whole of a large schedule, so the text need not repeat it.)
        beside = wrote and len(schedule.entries) > CHART_UP_TO
        all_rows = in_a_file() and not beside
        print_answer(answer, answer_console(), times, all_rows=all_rows)
    if refused is not None:
        raise refused
    if wrote and format is Format.text:
        say(f"wrote {output}")
    if not schedule.answered:
        sys.exit(schedule.outcome.exit)


def _write_answer(output: Path, answer: Answer, times: TimesStyle | None) -> bool:
    """Writes the file that was asked for; without an answer, only one for programs."""
    from irc.cli.showing import write_output
    from irc.reporting.files import Shown, kind_of, require_fit

    task = answer.schedule.made_for
    assert task is not None  # (It is a schedule that irc has made.)
    if not answer.schedule.answered and kind_of(output).ending not in (".json", ".txt"):
        return False
    require_fit(output, task)
    write_output(output, Shown(task, answer.schedule), answer, times)
    return True
