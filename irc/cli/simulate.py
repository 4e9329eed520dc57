"""`irc simulate`: runs a task through all of its own events, step by step."""

from __future__ import annotations

import sys
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from irc.cli.exit_codes import EXIT_INPUT
from irc.cli.interruption import INTERRUPTION
from irc.cli.output import (
    Format,
    prepare,
    print_notes,
    put,
    put_json,
    reporting_errors,
    say,
    summary,
)
from irc.cli.planning import (
    end_with,
    one_standard_input,
    read_sound_task,
    schedule_to_begin_with,
)
from irc.cli.replan import STEP_VERSION
from irc.cli.times import TimesStyle, require_times
from irc.diagnostics import Code, Report
from irc.driver.files import require_folder, write_folder
from irc.execution.simulation import EventRefused, Simulation, simulate
from irc.execution.step import Step
from irc.reporting.files import Shown, require_fit, require_output, write_shown
from irc.schedule import Schedule, dump_json
from irc.targets import SolveOptions
from irc.validation import Verdict, validate


def simulate_file(
    file: str,
    schedule: str | None,
    options: SolveOptions,
    output: Path | None,
    steps: Path | None,
    times: TimesStyle | None,
    format: Format,
) -> None:
    """Simulates a task, prints every step as it comes, and writes the requested files."""
    with reporting_errors(format), INTERRUPTION.planning() as cancel:
        options = replace(options, cancel=cancel)
        one_standard_input(format, file, schedule)
        require_output(output)
        require_folder(steps)
        task = read_sound_task(file, format)
        require_fit(output, task)
        require_times(task, times)
        given = None if schedule is None else schedule_to_begin_with(schedule, task)[0]
        prepare(format, steps=True)
        reporter = _StepReporter(steps, times, format)
        refused: Report | None = None
        try:
            simulation = simulate(
                task,
                schedule=given,
                on_step=reporter.report,
                options=options,
                spent=INTERRUPTION.spent(file, schedule),
            )
        except EventRefused as error:
            simulation, refused = error.simulation, error.report
        _report(simulation, refused, output, times, format)


def _report(
    simulation: Simulation,
    refused: Report | None,
    output: Path | None,
    times: TimesStyle | None,
    format: Format,
) -> None:
    """Prints the whole episode, up to an event that was refused if one was, and exits."""
    final = simulation.final
    if output is not None and final.answered:
        write_shown(output, _shown(simulation, times))
    verdict = _verdict(simulation)
    if format is Format.json:
        judged = None if verdict is None else verdict.to_dict()
        found = {} if refused is None else {"refused": refused.to_list()}
        put_json({**simulation.to_dict(), **found, "verdict": judged})
    elif verdict is not None:
        _print_end(simulation, times)
        before = "" if final.answered else "before the last event: "
        put(f"{before}{verdict}")
        if output is not None and final.answered:
            say(f"wrote {output}")
    if refused is not None:
        if format is Format.text:
            say(refused.render())
            say(summary(refused))
        sys.exit(EXIT_INPUT)
    end_with([final.status])
    if final.left_out or (verdict is not None and not verdict.valid):
        sys.exit(EXIT_INPUT)


@dataclass
class _StepReporter:
    """Prints the steps of a simulation as they come, and writes their documents."""

    folder: Path | None
    times: TimesStyle | None
    format: Format
    count: int = 0
    before: Schedule | None = None

    def report(self, step: Step) -> None:
        """Prints a step for people, and writes its document if there is a folder."""
        if self.folder is not None:
            document = {"irc_step": STEP_VERSION, **step.to_dict()}
            write_folder(self.folder, {f"step_{self.count:03}.json": dump_json(document)})
        if self.format is Format.text:
            from irc.cli.page import answer_console
            from irc.cli.step_text import clock_of_step, print_step

            if self.count:
                put("")
            notes = (d for d in step.notes if d.code is not Code.LATER_EVENTS)
            print_notes(notes, step.task.source)
            clock = clock_of_step(step, self.times, self.before)
            print_step(step, self.before, answer_console(), clock)
        self.count += 1
        if step.schedule.answered:
            self.before = step.schedule


def _last(simulation: Simulation) -> Step | None:
    """The last step that has a schedule."""
    answered = [step for step in simulation.steps if step.schedule.answered]
    return answered[-1] if answered else None


def _verdict(simulation: Simulation) -> Verdict | None:
    """The verdict on the whole history, for the task as all events have revised it."""
    last = _last(simulation)
    return None if last is None else validate(last.task, last.schedule, last.at)


def _shown(simulation: Simulation, times: TimesStyle | None) -> Shown:
    """The last schedule, the one before it, and all steps."""
    from irc.cli.step_text import step_as_text

    last, steps = simulation.steps[-1], simulation.steps
    before = [step.schedule for step in steps[:-1] if step.schedule.answered]
    previous = before[-1] if before else None
    text = partial(step_as_text, last, previous, times)
    return Shown(last.task, last.schedule, previous, steps, text)


def _print_end(simulation: Simulation, times: TimesStyle | None) -> None:
    """Prints the whole history and its objective values."""
    from irc.cli.page import answer_console, in_a_file
    from irc.cli.step_text import clock_of_step, print_end

    last = _last(simulation)
    if last is not None:
        clock = clock_of_step(last, times)
        print_end(simulation, last, answer_console(), clock, all_rows=in_a_file())
