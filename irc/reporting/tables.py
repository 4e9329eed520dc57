"""The tables of an analysis: actions, orders, resources and days, as columns and rows."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from fractions import Fraction
from typing import Any

from irc.model.quantities import Number
from irc.reporting.analysis import Analysis
from irc.reporting.rows import Key


@dataclass(frozen=True, slots=True)
class Table:
    """A table: its name, its columns, and rows with a value for each column.

    Values are texts, exact numbers, date-times, truth values, or None. `times` are the columns that
    count in the task's time unit.
    """

    name: str
    columns: tuple[str, ...]
    rows: tuple[Mapping[str, Any], ...]
    times: frozenset[str]

    def without_empty(self) -> Table:
        """The table without columns that are empty in every row; the first column stays."""
        used = [
            name
            for k, name in enumerate(self.columns)
            if not k or any(row[name] not in (None, "") for row in self.rows)
        ]
        return Table(self.name, tuple(used), self.rows, self.times)

    def headings(self, unit: str) -> list[str]:
        """The columns with the unit of those that are times."""
        return [f"{name} ({unit})" if name in self.times else name for name in self.columns]


_INSTANTS = ("start", "end", "release", "due", "deadline")


def action_table(analysis: Analysis) -> Table:
    """A row for each occurrence, in order of time."""
    return _table(
        analysis,
        "plan",
        "action occurrence label start end duration paused mode resources orders due lateness "
        "slack critical status why",
        (
            {
                "action": row.action,
                "occurrence": row.occurrence if row.occurrence > 1 else None,
                "label": row.label if row.label != row.action else None,
                "start": row.start,
                "end": row.end,
                "duration": row.duration,
                "paused": row.paused or None,
                "mode": row.mode,
                "resources": held_text(row.resources),
                "orders": ", ".join(row.orders),
                "due": row.due,
                "lateness": row.lateness,
                "slack": row.slack,
                "critical": row.critical,
                "status": row.status,
                "why": "; ".join(reason.text for reason in row.why),
            }
            for row in analysis.actions
        ),
        "start end due duration paused lateness slack",
    )


def order_table(analysis: Analysis) -> Table:
    """A row for each order, in the order of the task."""
    return _table(
        analysis,
        "orders",
        "order occurrence kind label actions start end release due deadline lateness tardiness "
        "weight critical",
        (
            {
                "order": row.order,
                "occurrence": row.occurrence if row.occurrence > 1 else None,
                "kind": row.kind,
                "label": row.label if row.label != row.order else None,
                "actions": row.actions,
                "start": row.start,
                "end": row.end,
                "release": row.release or None,
                "due": row.due,
                "deadline": row.deadline,
                "lateness": row.lateness,
                "tardiness": row.tardiness,
                "weight": row.weight,
                "critical": chain_text(row.critical),
            }
            for row in analysis.orders
        ),
        "start end release due deadline lateness tardiness",
    )


def resource_table(analysis: Analysis) -> Table:
    """A row for each renewable resource."""
    return _table(
        analysis,
        "resources",
        "resource label capacity actions busy setup idle closed used utilisation setups setup_cost",
        (
            {
                "resource": row.resource,
                "label": row.label if row.label != row.resource else None,
                "capacity": row.capacity,
                "actions": row.actions,
                "busy": row.busy,
                "setup": row.setup,
                "idle": row.idle,
                "closed": row.closed,
                "used": row.used,
                "utilisation": row.utilisation,
                "setups": row.setups,
                "setup_cost": row.setup_cost,
            }
            for row in analysis.resources
        ),
        "busy setup idle closed used",
    )


def day_table(analysis: Analysis) -> Table:
    """A row for each day, with a column for the use of each resource."""
    names = [load.resource for load in analysis.loads]
    columns = ["day", "begun", "ended", "due", "late", *(f"use of {name}" for name in names)]
    rows = [
        {
            "day": row.day.date(),
            "begun": row.begun,
            "ended": row.ended,
            "due": row.due,
            "late": row.late,
            **{f"use of {name}": row.used[name] for name in names},
        }
        for row in analysis.days
    ]
    return Table("days", tuple(columns), tuple(rows), frozenset(columns[5:]))


def tables_of(analysis: Analysis) -> list[Table]:
    """All tables that have rows; that of the actions is always there."""
    rest = [order_table(analysis), resource_table(analysis), day_table(analysis)]
    return [action_table(analysis), *(table for table in rest if table.rows)]


def summary_rows(analysis: Analysis) -> list[tuple[str, str | Number | datetime]]:
    """The facts about the whole: (name, value)."""
    schedule, dates = analysis.schedule, analysis.dates
    found: list[tuple[str, Any]] = [
        ("task", analysis.name),
        ("status", str(schedule.status)),
        ("time unit", analysis.time_unit),
        ("actions", len(analysis.actions)),
        ("makespan", analysis.span),
    ]
    if dates is not None:
        found += [("start", dates.at(0)), ("end", dates.at(analysis.span))]
        found.append(("time zone", zone_name(analysis)))
    found += [
        (value.name.replace("_", " "), value.value)
        for value in schedule.objective
        if value.name != "makespan"
    ]
    dated = [row for row in analysis.orders if row.due is not None]
    if dated:
        found.append(("orders with a due date", len(dated)))
        found.append(("late", sum(bool(row.tardiness) for row in dated)))
    return found


def zone_name(analysis: Analysis) -> str:
    """The zone of the dates: its name, or the offset of the origin."""
    dates = analysis.dates
    if dates is None or dates.zone is None:
        return "none"
    return str(getattr(dates.zone, "key", dates.zone))


def held_text(resources: Mapping[str, int]) -> str:
    """The resources that an occurrence holds in words: "board ×2, grill"."""
    return ", ".join(
        name if amount == 1 else f"{name} ×{amount}" for name, amount in sorted(resources.items())
    )


def chain_text(chain: Sequence[Key]) -> str:
    """The occurrences of a chain, one after the other."""
    return " → ".join(name if number == 1 else f"{name} ({number})" for name, number in chain)


def _table(
    analysis: Analysis,
    name: str,
    columns: str,
    rows: Iterable[dict[str, Any]],
    times: str,
) -> Table:
    """A table; with dates, an instant also has a column with its date-time, named "…_at"."""
    dates = analysis.dates
    wanted: list[str] = []
    for column in columns.split():
        wanted.append(column)
        if dates is not None and column in _INSTANTS:
            wanted.append(f"{column}_at")
    filled = []
    for row in rows:
        if dates is not None:
            for column in _INSTANTS:
                time = row.get(column)
                dated = time is not None and dates.reach(time)
                row[f"{column}_at"] = dates.at(time) if time is not None and dated else None
        filled.append(row)
    return Table(name, tuple(wanted), tuple(filled), frozenset(times.split()))


def as_float(value: Any) -> Any:
    """A value for spreadsheets and pictures, which have no fractions."""
    return float(value) if isinstance(value, Fraction) else value
