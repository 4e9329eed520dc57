"""The output of `irc solve` for people: a headline, a summary, a table, and a Gantt chart.

Widths are counted in terminal cells, so that no line is wider than the console and the same text
can go into a pipe.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, NamedTuple

from rich.console import Console
from rich.text import Text

from irc.cli.absent import in_words, left_out
from irc.cli.chart import Drawn, Spans, chart_lines
from irc.cli.page import Page, grouped, print_lines, time_in_words, with_unit
from irc.cli.summary import counts_line, summary_lines
from irc.cli.table import (
    Column,
    aligned,
    entry_resources,
    entry_title,
    middle_cut,
    rank_text,
    table_lines,
    time_columns,
)
from irc.cli.times import ClockText, TimesStyle, dates_shown
from irc.model.quantities import Number
from irc.problem import Problem
from irc.problem.decisions import AnswerError
from irc.retiming.slack import slacks
from irc.schedule import Entry, ObjectiveValue, Schedule, Status

if TYPE_CHECKING:
    from irc.driver.judge import Answer
    from irc.reporting.analysis import Analysis

SUMMARY_FROM = 60
"""A schedule of more actions begins with a summary."""

CHART_UP_TO = 10_000
"""Of more actions there is no chart where it would be cut: 40 rows say nothing about them."""


def print_answer(
    answer: Answer, console: Console, times: TimesStyle | None = None, *, all_rows: bool = False
) -> None:
    """Prints an answer for people: the status and objective values, every action, and the chart.

    Lines are at most as wide as the console. Colours appear only on terminals. If the encoding has
    no box and block characters, ASCII characters replace them. Times are dates where there are any,
    unless `times` says otherwise; without `all_rows` long tables and charts are cut.
    """
    page, schedule = Page(console), answer.schedule
    clock = clock_of(schedule, times)
    problem, slack, analysis, lines = _known(page, answer, clock, all_rows)
    print_lines(page, console, (line for text in lines for line in text.wrap(console, page.width)))
    if not schedule.entries:
        return
    shown = _drawn(problem, analysis, slack, clock, all_rows)
    console.print()
    print_lines(page, console, _table(page, problem, schedule, shown))
    if all_rows or len(schedule.entries) <= CHART_UP_TO:
        console.print()
        print_lines(page, console, chart_lines(page, problem, schedule, shown))
    key = (line for text in page.key() for line in Text(text).wrap(console, page.width))
    print_lines(page, console, key)


class _Known(NamedTuple):
    """The problem, the slacks, the analysis where it is needed, the lines above the table."""

    problem: Problem
    slack: dict[str, int] | None
    analysis: Analysis | None
    lines: list[Text]


def _known(page: Page, answer: Answer, clock: ClockText | None, all_rows: bool) -> _Known:
    task, schedule = answer.schedule.made_for, answer.schedule
    if answer.times is not None and task is not None and task.columns is not None:
        from irc.cli.uncontended import frame_of, slacks_and_critical

        frame = frame_of(task.columns, answer.times)
        lines = [*_headline(page, frame, schedule, clock)]
        every = all_rows or len(schedule.entries) <= CHART_UP_TO
        shown, _ = middle_cut(schedule.entries, all_rows=every)
        free, critical = slacks_and_critical(task.columns, answer.times, shown)
        if len(schedule.entries) > SUMMARY_FROM:
            lines.append(counts_line(len(schedule.entries), critical, 0))
        return _Known(frame, free, None, lines)
    problem, slack = answer.problem, None
    lines = [*_headline(page, problem, schedule, clock)]
    try:
        if schedule.answered:
            slack = slacks(problem, schedule)
    except AnswerError as error:
        lines.append(Text(page.visible(f"slack is not known: {error}"), "dim"))
    analysis = _analysis(problem, schedule, slack)
    if analysis is not None and len(schedule.entries) > SUMMARY_FROM:
        lines += summary_lines(page, analysis)
    return _Known(problem, slack, analysis, lines)


def clock_of(schedule: Schedule, times: TimesStyle | None) -> ClockText | None:
    """The way in which the times of a schedule are written; None for numbers.

    Raises `OptionError` where dates are asked for and there are none.
    """
    ends = [0, schedule.makespan]
    dates = dates_shown(schedule.dates, times, ends)
    if dates is None or not schedule.entries:
        return None
    return ClockText(dates, [0, *(time for e in schedule.entries for time in (e.start, e.end))])


def _analysis(
    problem: Problem, schedule: Schedule, slack: Mapping[str, int] | None
) -> Analysis | None:
    """The analysis, where the text needs it: for closed times, pauses, a summary, and what is
    critical where slack does not say so.
    """
    task = schedule.made_for
    if task is None or not schedule.entries:
        return None
    needed = problem.has_calendars or len(schedule.entries) > SUMMARY_FROM or slack is None
    if not needed:
        return None
    from irc.reporting.analysis import analyse

    return analyse(task, schedule, problem, slack, reasons=False)


def _drawn(
    problem: Problem,
    analysis: Analysis | None,
    slack: dict[str, int] | None,
    clock: ClockText | None,
    all_rows: bool,
) -> Drawn:
    if analysis is None:
        return Drawn(slack, clock=clock, all_rows=all_rows)

    def in_ticks(spans: Iterable[tuple[Number, Number]]) -> Spans:
        return [(problem.to_ticks(start), problem.to_ticks(end)) for start, end in spans]

    closed = {load.resource: in_ticks(load.closed) for load in analysis.loads}
    pauses = {(p.action, p.occurrence): in_ticks(p.spans) for p in analysis.pauses}
    critical = frozenset(row.key for row in analysis.actions if row.critical)
    return Drawn(slack, critical, closed, pauses, clock, all_rows)


# --- headline -----------------------------------------------------------------------------------

_STATUS_STYLES = {
    Status.OPTIMAL: "bold green",
    Status.FEASIBLE: "bold yellow",
    Status.INFEASIBLE: "bold red",
    Status.UNKNOWN: "bold yellow",
    Status.FAILED: "bold red",
}


def _headline(
    page: Page, problem: Problem, schedule: Schedule, clock: ClockText | None
) -> Iterator[Text]:
    yield Text.assemble(
        (page.visible(schedule.task or "unnamed task"), "bold"),
        "  ",
        (_status(page, schedule), _STATUS_STYLES[schedule.status]),
    )
    if schedule.entries:
        makespan = ObjectiveValue("makespan", schedule.makespan)
        for value in schedule.objective or (makespan,):
            yield Text(_objective_line(page, problem, schedule, value))
        if clock is not None:
            yield Text(clock.span)
    else:
        yield Text(page.visible(_why_nothing(problem, schedule)))
    absent = left_out(problem, schedule)
    if absent:
        yield Text(in_words(absent, page.visible))
    made = [
        f"{what} {page.visible(name)}"
        for what, name in (("target", schedule.target), ("engine", schedule.engine))
        if name is not None
    ]
    if schedule.seconds is not None:
        made.append(f"{schedule.seconds:.{1 if schedule.seconds >= 10 else 3}f} s")
    if made:
        yield Text(", ".join(made), "dim")


def _status(page: Page, schedule: Schedule) -> str:
    glyphs, status = page.glyphs, schedule.status
    mark = {Status.OPTIMAL: glyphs.good, Status.INFEASIBLE: glyphs.bad}.get(status, "")
    gap = _gap(schedule) if status is Status.FEASIBLE else ""
    ended = ", interrupted" if schedule.interrupted else ""
    return f"{mark} {status}{ended}{gap}".strip()


def _gap(schedule: Schedule) -> str:
    """The gap between the first objective that is not proven optimal and its bound, in words."""
    for value in schedule.objective:
        if value.bound is None:
            return " (no bound known)"
        if value.bound != value.value:
            reached, bound = Fraction(value.value), Fraction(value.bound)
            percent = float(100 * abs(reached - bound) / max(abs(reached), abs(bound)))
            return f" (gap {percent:.1f} %)" if percent >= 0.05 else " (gap below 0.1 %)"
    return ""


def _objective_line(page: Page, problem: Problem, schedule: Schedule, value: ObjectiveValue) -> str:
    if value.name != "makespan":
        bound = "" if value.bound is None else f", bound {grouped(value.bound)}"
        return f"{value.name.replace('_', ' ')} {grouped(value.value)}{bound}"
    makespan = f"makespan {time_in_words(page, value.value, problem.time_unit)}"
    if value.bound is None:
        return makespan
    if value.bound == problem.to_units(problem.bounds.makespan.value):
        reason = page.visible(problem.bounds.makespan.reason)
    else:
        reason = page.visible(f"proved by {schedule.engine or 'the engine'}")
    return f"{makespan}, bound {with_unit(value.bound, problem.time_unit)}: {reason}"


def _why_nothing(problem: Problem, schedule: Schedule) -> str:
    status = schedule.status
    least, unit, reason = (
        problem.bounds.makespan.value,
        problem.time_unit,
        problem.bounds.makespan.reason,
    )
    needed = f"; at least {with_unit(problem.to_units(least), unit)} are needed: {reason}"
    if status is Status.UNKNOWN:
        when = "before it was interrupted" if schedule.interrupted else "within the limits"
        return f"no schedule was found {when}{needed if least else ''}"
    if status is Status.FAILED:
        return "the engine broke down before it had an answer"
    if not problem.activities:
        return "there is nothing to do"
    if status is not Status.INFEASIBLE:
        return "the schedule is empty"
    if problem.deadline is not None and least > problem.deadline:
        deadline = with_unit(problem.to_units(problem.deadline), unit)
        return f"no schedule meets the deadline of {deadline}{needed}"
    return "no schedule keeps all precedences, lags, windows and capacities at once"


# --- table --------------------------------------------------------------------------------------


_MARKED = ("action", "slack")


def _table(page: Page, problem: Problem, schedule: Schedule, shown: Drawn) -> Iterator[Text]:
    entries, hidden = middle_cut(schedule.entries, all_rows=shown.all_rows)

    def style(k: int, title: str) -> str:
        marked = title.partition(" (")[0] in _MARKED
        return "red" if marked and shown.is_critical(entries[k]) else ""

    yield from table_lines(page, _columns(page, problem, entries, shown), hidden, style)


def _columns(page: Page, problem: Problem, entries: Sequence[Entry], shown: Drawn) -> list[Column]:
    slack = shown.slack
    columns = [
        Column("action", [entry_title(page, entry) for entry in entries], flexible=True),
        *time_columns(page, problem.time_unit, entries, shown.clock),
    ]
    texts: list[tuple[str, Callable[[Entry], str]]] = [
        ("mode", lambda entry: page.visible(entry.mode or "")),
        ("rank", rank_text),
        ("resources", lambda entry: entry_resources(page, entry)),
        ("status", lambda entry: page.visible(entry.status or "")),
    ]
    for title, text in texts:
        cells = [text(entry) for entry in entries]
        if any(cells):
            columns.append(Column(title, cells, flexible=title not in ("status", "rank")))
    if slack is not None:
        free = aligned(problem.to_units(slack[entry.id]) for entry in entries)
        marked = [
            shown if slack[entry.id] else "critical"
            for entry, shown in zip(entries, free, strict=True)
        ]
        unit = page.visible(problem.time_unit)
        columns.append(Column("slack" if shown.clock is None else f"slack ({unit})", marked, True))
    return columns
