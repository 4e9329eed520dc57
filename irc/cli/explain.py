"""The output of `irc explain` for people: the conflicting lines, or the critical chain."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby

from irc.cli.output import Format, put, put_json
from irc.cli.times import ClockText, TimesStyle, dates_shown
from irc.diagnostics.source import Source, pointer_text
from irc.diagnostics.text import excerpt
from irc.explanation import Explanation, Lateness
from irc.explanation.result import ChainStep, RenderedStatement
from irc.model.quantities import Number
from irc.model.times import format_number
from irc.schedule import Status

STATEMENTS_SHOWN = 60
"""Longer conflicts end in "and N more"; JSON has all of them."""

SLACK_ROWS = 60
"""Longer lists of slacks end in "and N more"; JSON has all of them."""


def hint_for(file: str) -> str:
    """The hint that `irc solve` prints for an infeasible task."""
    name = "FILE" if file == "-" else shlex.quote(file)
    return f"hint: `irc explain {name}` shows which statements cannot hold together"


def put_explanation(
    explanation: Explanation, format: Format, times: TimesStyle | None = None
) -> None:
    """Prints an explanation, and exits with the status for what it found."""
    _put(explanation, _lines(explanation, _clock(explanation, times)), format)


def put_lateness(lateness: Lateness, format: Format, times: TimesStyle | None = None) -> None:
    """Prints why something is late, and exits with the status for what it found."""
    _put(lateness, _of_lateness(lateness, _clock(lateness, times)), format)


def _clock(found: Explanation | Lateness, times: TimesStyle | None) -> ClockText | None:
    """The way in which times are written; None: as numbers of the unit."""
    schedule = found.schedule
    if schedule is None or not schedule.answered:
        return None
    shown = [0, schedule.makespan]
    shown += [time for step in found.chain or () for time in (step.start, step.end)]
    if isinstance(found, Lateness):
        shown += [time for time in (found.due, found.end) if time is not None]
        shown += [change.ends for change in found.changes]
    dates = dates_shown(schedule.dates, times, shown)
    return None if dates is None else ClockText(dates, shown)


def _at(time: Number, unit: str, clock: ClockText | None) -> str:
    return f"{format_number(time)} {unit}" if clock is None else clock.text(time).strip()


def _put(found: Explanation | Lateness, lines: Iterable[str], format: Format) -> None:
    if format is Format.json:
        put_json(found.to_dict())
    else:
        put("\n".join(lines))
    if not found.outcome.answered:
        sys.exit(found.outcome.exit)


def _lines(explanation: Explanation, clock: ClockText | None) -> Iterator[str]:
    if explanation.status is Status.INFEASIBLE:
        yield from _infeasible(explanation)
    elif explanation.schedule is None:
        ended = "interrupted, and " if explanation.interrupted else ""
        yield f"{_name(explanation)}: {ended}it is not known whether there is a schedule"
        yield "hint: give it more time with --time-limit"
    else:
        yield from _feasible(explanation, clock)


def _name(explanation: Explanation) -> str:
    return _visible(explanation.task or "unnamed task")


def _visible(text: str) -> str:
    """A task's name with control characters made visible (other names are quoted as in Python)."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


# --- no schedule --------------------------------------------------------------------------------


def _infeasible(explanation: Explanation) -> Iterator[str]:
    count = len(explanation.conflict)
    ended = "it was interrupted" if explanation.interrupted else "the time limit ended"
    yield f"{_name(explanation)}: no schedule exists"
    if not count and explanation.reason is not None:
        yield f"this is proven; {explanation.reason}"
        return
    if not count:
        yield f"this is proven; {ended} before the conflicting statements were found"
        yield "hint: give it more time with --time-limit"
        return
    proven = "without any one of them the others can"
    if not explanation.minimal:
        proven = f"{ended} before irc could prove that each of them is needed"
    yield f"these {count} statements cannot hold together; {proven}:"
    yield ""
    yield from _conflict(explanation.conflict, explanation.source)
    if explanation.reason is not None:
        yield ""
        yield f"because {explanation.reason}"


def _conflict(conflict: Sequence[RenderedStatement], source: Source | None) -> Iterator[str]:
    """The first statements of a conflict, in the lines of the text where there is one."""
    shown = conflict[:STATEMENTS_SHOWN]
    if source is not None and all(t.offset is not None for t in shown):
        yield from _snippet(source, shown)
    else:
        yield from (_listed(statement) for statement in shown)
    if len(conflict) > len(shown):
        yield f"and {len(conflict) - len(shown):,} more; `--format json` shows all of them"


def _listed(statement: RenderedStatement) -> str:
    return f"  {statement.text}  ({pointer_text(statement.pointer)})"


def _snippet(source: Source, conflict: Iterable[RenderedStatement]) -> Iterator[str]:
    """The lines of the text, each with its conflicting statements under their places."""
    placed = sorted(conflict, key=lambda t: (t.line or 0, t.column or 0))
    width = len(str(placed[-1].line))
    yield f"{'':{width}}--> {_visible(source.name)}"
    for line, on_line in groupby(placed, key=lambda t: t.line):
        statements = list(on_line)
        begin = (statements[0].column or 1) - 1
        text, first = excerpt(source.line_at(statements[0].offset or 0), begin)
        yield f"{line:>{width}} | {text}"
        for statement in statements:
            column = min((statement.column or 1) - 1 + first - begin, len(text))
            yield f"{'':{width}} | {'':{column}}^ {statement.text}"


# --- late work ----------------------------------------------------------------------------------


def _of_lateness(lateness: Lateness, clock: ClockText | None) -> Iterator[str]:
    name, unit = repr(lateness.name), lateness.time_unit
    if lateness.end is None:
        yield _without_end(lateness)
        return
    ends = f"{name} ends at {_at(lateness.end, unit, clock)}"
    if lateness.due is None:
        yield f"{ends}; it has no due date"
    elif lateness.late:
        due = f"due at {_at(lateness.due, unit, clock)}"
        yield f"{ends}, {format_number(lateness.late)} {unit} late ({due})"
    else:
        yield f"{ends}, on time: it is due at {_at(lateness.due, unit, clock)}"
    if lateness.chain:
        yield ""
        yield "it ends then because of this chain:"
        yield from _chain(lateness.chain, clock)
    if lateness.due is not None and lateness.late:
        yield ""
        yield from _of_possibility(lateness)
        yield ""
        yield from _of_changes(lateness, clock)


def _without_end(lateness: Lateness) -> str:
    if lateness.status is Status.INFEASIBLE:
        return "the task has no schedule; `irc explain` without --why shows the reason"
    if lateness.schedule is None or not lateness.schedule.answered:
        return "no schedule was found in time; give it more with --time-limit"
    return f"{lateness.name!r} is not part of the schedule"


def _of_possibility(lateness: Lateness) -> Iterator[str]:
    if lateness.possible is None:
        yield "whether it could be on time was not found out in time"
    elif lateness.possible:
        yield "it could be on time" + (", but then:" if lateness.instead else "")
        for shift in lateness.instead:
            would = f"{format_number(shift.would_be)} {lateness.time_unit} late"
            now = f"now {format_number(shift.late)}" if shift.late else "now on time"
            yield f"  {shift.name!r} would be {would} ({now})"
        if not lateness.instead:
            yield "  in a plan that is worse in other ways"
    else:
        yield "it cannot be on time, because these statements cannot hold together:"
        yield ""
        yield from _conflict(lateness.conflict, lateness.source)


def _of_changes(lateness: Lateness, clock: ClockText | None) -> Iterator[str]:
    if not lateness.changes:
        yield "no single change that was tried makes it on time"
        return
    yield "it would be on time with one of these changes, the smallest first:"
    for change in lateness.changes:
        ends = _at(change.ends, lateness.time_unit, clock)
        yield f"  {change.text}: it ends at {ends}"


# --- a schedule ---------------------------------------------------------------------------------


def _feasible(explanation: Explanation, clock: ClockText | None) -> Iterator[str]:
    assert explanation.schedule is not None
    unit = explanation.time_unit
    makespan = format_number(explanation.schedule.makespan)
    optimal = "optimal" if explanation.status is Status.OPTIMAL else "not proven optimal"
    if explanation.interrupted:
        optimal = f"interrupted, {optimal}"
    yield f"{_name(explanation)}: makespan {makespan} {unit}, {optimal}"
    if clock is not None:
        yield clock.span
    if explanation.chain is None:
        yield "no critical chain: this schedule could end earlier in the same order"
    elif explanation.chain:
        yield "it is as long as this chain:"
        yield ""
        yield from _chain(explanation.chain, clock)
    yield ""
    yield _visible(explanation.proof or "")
    if explanation.slack:
        yield ""
        yield from _slack(explanation, unit)


def _chain(chain: Sequence[ChainStep], clock: ClockText | None) -> Iterator[str]:
    times = [_span(step.start, step.end, clock) for step in chain]
    width = max(map(len, times))
    for time, step in zip(times, chain, strict=True):
        line = "" if step.statement.line is None else f"  (line {step.statement.line})"
        yield f"  {time:>{width}}  {step.statement.text}{line}"


def _span(start: Number, end: Number, clock: ClockText | None) -> str:
    shown = [
        format_number(time) if clock is None else clock.text(time).strip() for time in (start, end)
    ]
    return shown[0] if start == end else " – ".join(shown)


def _slack(explanation: Explanation, unit: str) -> Iterator[str]:
    """A line on the critical actions, then a line on each other action, by slack."""
    slack = explanation.slack
    critical = [repr(name) for name, value in slack.items() if not value]
    yield f"critical, so none can start later: {', '.join(critical) or 'none'}"
    waiting = sorted(
        ((value, name) for name, value in slack.items() if value), key=lambda item: item[0]
    )
    for value, name in waiting[:SLACK_ROWS]:
        yield f"  {name!r} can start up to {format_number(value)} {unit} later"
    if len(waiting) > SLACK_ROWS:
        yield f"  and {len(waiting) - SLACK_ROWS} more"
