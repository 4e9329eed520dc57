"""The figures at the top of a report."""

from __future__ import annotations

from collections.abc import Iterator

from irc.model.times import format_number
from irc.reporting.analysis import Analysis
from irc.reporting.html.clock import clock_text
from irc.reporting.html.tables import percent_text
from irc.reporting.tables import zone_name
from irc.schedule import ObjectiveValue, Schedule, Status

Figure = tuple[str, str, str]
"""Its name, its value, and a note."""


def status_text(schedule: Schedule) -> str:
    """The status in a few words."""
    ended = ", interrupted" if schedule.interrupted else ""
    return f"{schedule.status}{ended}"


def figures_of(schedule: Schedule, analysis: Analysis, before: Analysis | None) -> list[Figure]:
    """The figures of a plan, the most important ones first."""
    return list(_figures(schedule, analysis, before))


def _figures(schedule: Schedule, analysis: Analysis, before: Analysis | None) -> Iterator[Figure]:
    unit = analysis.time_unit
    if not schedule.answered:
        yield "schedule", "none", schedule.outcome.message
        return
    makespan = f"{format_number(schedule.makespan)} {unit}"
    end = clock_text(analysis.dates, schedule.makespan)
    bounds = {value.name: value for value in schedule.objective}
    note = f"makespan {makespan}" if end else ""
    if (value := bounds.get("makespan")) is not None:
        note = ", ".join(filter(None, (note, _bound(value))))
    yield ("last end", end, note) if end else ("makespan", makespan, note)
    for value in schedule.objective:
        if value.name != "makespan":
            yield value.name.replace("_", " "), format_number(value.value), _bound(value)
    dated = [row for row in analysis.orders if row.due is not None and row.lateness is not None]
    if dated:
        late = [row for row in dated if row.lateness is not None and row.lateness > 0]
        worst = max((row.lateness for row in late if row.lateness is not None), default=None)
        most = "none is late" if worst is None else f"the latest by {format_number(worst)} {unit}"
        yield "on time", f"{len(dated) - len(late)} of {len(dated)}", most
    yield "actions", str(len(analysis.actions)), _moved(analysis, before)
    used = [row for row in analysis.resources if row.utilisation is not None]
    if used:
        most_used = max(used, key=lambda row: row.utilisation or 0)
        yield "most used", f"{percent_text(most_used.utilisation)} %", most_used.label


def _bound(value: ObjectiveValue) -> str:
    if value.bound is None:
        return "no bound known"
    return "the best" if value.bound == value.value else f"bound {format_number(value.bound)}"


def _moved(analysis: Analysis, before: Analysis | None) -> str:
    """How many occurrences of the previous plan are elsewhere now."""
    if before is None:
        return ""
    now = {row.key: (row.start, row.mode, dict(row.resources)) for row in analysis.actions}
    moved = sum(
        now.get(row.key) != (row.start, row.mode, dict(row.resources)) for row in before.actions
    )
    return f"{moved} moved against the previous plan"


def made_text(schedule: Schedule, analysis: Analysis) -> str:
    """A line on where the schedule is from: its first and last time, target and engine."""
    begin = clock_text(analysis.dates, min((e.start for e in schedule.entries), default=0))
    zone = "" if zone_name(analysis) == "none" else f" ({zone_name(analysis)})"
    parts = []
    if begin:
        parts.append(f"from {begin} to {clock_text(analysis.dates, schedule.makespan)}{zone}")
    if schedule.status in (Status.OPTIMAL, Status.FEASIBLE) and schedule.target:
        engine = f", {schedule.engine}" if schedule.engine else ""
        took = "" if schedule.seconds is None else f", in {schedule.seconds:g} s"
        parts.append(f"planned by {schedule.target}{engine}{took}")
    return "; ".join(part.strip() for part in parts)
