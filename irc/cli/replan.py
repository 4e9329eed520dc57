"""`irc replan`: one step of a running schedule, and the task in force after it."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from irc.cli.exit_codes import EXIT_INPUT
from irc.cli.interruption import INTERRUPTION
from irc.cli.moments import moment_of
from irc.cli.output import Format, prepare, print_notes, put_json, reporting_errors, say
from irc.cli.planning import (
    end_with,
    execution_of,
    one_standard_input,
    read_schedule,
    read_sound_task,
    require_task,
)
from irc.cli.progress import progress_shown
from irc.cli.times import TimesStyle, require_times
from irc.diagnostics import Code, Diagnostic, InputError, Report
from irc.diagnostics.source import Source
from irc.diagnostics.suggest import closest
from irc.driver.files import require_file, write_whole
from irc.events.apply import apply
from irc.execution.execution import Execution
from irc.execution.simulation import in_order
from irc.execution.step import Step
from irc.frontends.convert import written_as
from irc.frontends.events import PlacedEvent, read_events, wrong_time
from irc.frontends.formats import DSL_SUFFIX
from irc.model import Task
from irc.model.canonical import task_sha256
from irc.model.quantities import Number, TimeError
from irc.model.times import format_number, json_number
from irc.reporting.files import Shown, require_fit, require_output, write_shown
from irc.schedule import Schedule
from irc.service.protocol import own_event
from irc.targets import SolveOptions

STEP_VERSION = "1"


def replan_file(
    file: str,
    schedule: str,
    at: str,
    named: Sequence[str],
    options: SolveOptions,
    output: Path | None,
    task_output: Path | None,
    times: TimesStyle | None,
    format: Format,
) -> None:
    """Replans a task's schedule as of a time, prints the step and writes the requested files."""
    with reporting_errors(format), INTERRUPTION.planning() as cancel:
        options = replace(options, cancel=cancel)
        one_standard_input(format, file, schedule, *named)
        require_output(output)
        require_file(task_output, (".json", DSL_SUFFIX))
        task = read_sound_task(file, format)
        require_fit(output, task)
        require_times(task, times)
        moment = moment_of(task, at, format)
        before, source = read_schedule(schedule)
        prepare(format, steps=True)
        events = _events(task, named, moment, format)
        with progress_shown(task) as on_progress:
            options = replace(options, on_progress=on_progress)
            running = _running(task, before, source, moment, options)
            noted = _apply(running, events)
            step = running.replan(options.budget(INTERRUPTION.spent(file, schedule, *named)))
            step = replace(step, notes=(*noted, *step.notes))
        _write(step, before, output, task_output, times)
        if format is Format.json:
            put_json({"irc_step": STEP_VERSION, **step.to_dict()})
        else:
            from irc.cli.page import answer_console, in_a_file
            from irc.cli.step_text import clock_of_step, print_history, print_step

            print_notes(step.notes)
            clock = clock_of_step(step, times, before)
            print_step(step, before, answer_console(), clock)
            print_history(step, before, answer_console(), clock, all_rows=in_a_file())
            for path in filter(None, (output if step.schedule.answered else None, task_output)):
                say(f"wrote {path}")
        end_with([step.schedule.status])
        if step.left_out:
            sys.exit(EXIT_INPUT)


def _events(task: Task, named: Sequence[str], at: Number, format: Format) -> list[PlacedEvent]:
    """The named events, or else the task's own events at the time. Raises `InputError`."""
    if not named:
        own = enumerate(task.events)
        return [_own(task, i) for i, event in own if task.number(event.at) == at]
    events: list[PlacedEvent] = []
    for name in named:
        found = [_named(task, name)] if name.startswith("#") else _from_file(name, at, format)
        for placed in found:
            _require_time(task, placed, at)
        events += found
    return events


def _own(task: Task, index: int) -> PlacedEvent:
    return PlacedEvent(task.events[index], ("events", index), task.source)


def _named(task: Task, name: str) -> PlacedEvent:
    event = own_event(task, name.removeprefix("#"))
    if event is not None:
        return _own(task, task.events.index(event))
    ids = [f"#{e.id}" for e in task.events if e.id is not None]
    close = closest(name, ids)
    hint = f"its events are {', '.join(ids)}" if ids else "it has no events with an id"
    finding = Diagnostic(
        Code.UNKNOWN_NAME,
        f"the task has no event {name!r}",
        hint=f"did you mean `{close}`?" if close else hint,
    )
    raise InputError(Report((finding,)))


def _from_file(path: str, at: Number, format: Format) -> list[PlacedEvent]:
    events, notes, source = read_events(path, json_number(at))
    if format is Format.text:
        print_notes(notes, source)
    return events


def _require_time(task: Task, placed: PlacedEvent, at: Number) -> None:
    """Raises `InputError` if an event is not at the time of the step."""
    try:
        comes = task.number(placed.event.at)
    except TimeError:
        return  # The check of the event reports this.
    if comes == at:
        return
    name = "this event" if placed.event.id is None else f"event {placed.event.id!r}"
    when, now = (f"{format_number(time)} {task.time_unit}" for time in (comes, at))
    if comes < at:
        raise wrong_time(
            placed,
            f"{name} comes at {when}, before the time of this step, {now}",
            f"first replan at {when}, then continue with its schedule and its --task-output",
        )
    raise wrong_time(
        placed,
        f"{name} comes at {when}, which is later than the time of this step, {now}",
        f"leave it out until then, or replan with --at {format_number(comes)}",
    )


def _running(
    task: Task, schedule: Schedule, source: Source, at: Number, options: SolveOptions
) -> Execution:
    """The execution of a task by a schedule at `at`, after the task's own events before `at`.

    If the schedule belongs to the task before any event, the events come after it; otherwise it
    must belong to the task as these events revise it. Raises `InputError`.
    """
    earlier = [_own(task, task.events.index(e)) for e in in_order(task) if task.number(e.at) < at]
    if earlier and schedule.task_sha256 == task_sha256(task):
        execution = execution_of(task, schedule, options, source=source)
        _apply(execution, earlier)
        execution.advance(at)
        return execution
    starts = {entry.id: entry.start for entry in schedule.entries}
    for placed in earlier:
        try:
            task = apply(task, placed.event, starts)
        except InputError as error:
            raise InputError(placed.anchored(error.report)) from None
    require_task(schedule, source, task)
    return execution_of(task, schedule, options, at, source)


def _apply(execution: Execution, events: Sequence[PlacedEvent]) -> list[Diagnostic]:
    """Applies events; returns the notes on them."""
    notes: list[Diagnostic] = []
    for placed in events:
        try:
            report = execution.apply(placed.event)
        except InputError as error:
            raise InputError(placed.anchored(error.report)) from None
        notes += placed.notes(report)
    return notes


def _write(
    step: Step,
    before: Schedule,
    output: Path | None,
    task_output: Path | None,
    times: TimesStyle | None,
) -> None:
    """Writes the schedule, if there is one, and the task in force."""
    if output is not None and step.schedule.answered:
        from irc.cli.step_text import step_as_text

        text = partial(step_as_text, step, before, times)
        write_shown(output, Shown(step.task, step.schedule, before.of(step.task), text=text))
    if task_output is not None:
        write_whole(task_output, written_as(task_output, step.task))
