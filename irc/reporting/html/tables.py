"""The cells of the tables of a report, as texts with exact numbers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction

from irc.model.quantities import Number
from irc.model.times import format_number
from irc.reporting.analysis import Analysis
from irc.reporting.html.clock import clock_text
from irc.reporting.reasons import exact_of
from irc.reporting.rows import ActionRow, Key, OrderRow, ResourceRow

Cells = tuple[str, ...]


def number_text(value: Number | None) -> str:
    """The exact text of a number; empty for None."""
    return "" if value is None else format_number(value)


def held_text(resources: Mapping[str, int], names: Mapping[str, str]) -> str:
    """ "oven, team ×2"."""
    return ", ".join(
        names.get(name, name) if amount == 1 else f"{names.get(name, name)} ×{amount}"
        for name, amount in sorted(resources.items())
    )


def _key_text(key: Key) -> str:
    return key[0] if key[1] == 1 else f"{key[0]} ({key[1]})"


def action_cells(analysis: Analysis, row: ActionRow, names: Mapping[str, str]) -> Cells:
    """The cells of an action, in its columns."""
    return (
        row.action,
        "" if row.occurrence == 1 else str(row.occurrence),
        clock_text(analysis.dates, row.start),
        clock_text(analysis.dates, row.end),
        format_number(row.start),
        format_number(row.end),
        format_number(row.duration),
        row.mode or "",
        held_text(row.resources, names),
        ", ".join(row.orders),
        number_text(row.due),
        number_text(row.lateness),
        number_text(row.slack),
        row.status or "",
        "; ".join(reason.text for reason in row.why),
    )


def other_cells(
    analysis: Analysis, previous: Analysis | None, names: Mapping[str, str]
) -> dict[str, list[Cells]]:
    """The cells of every table but that of the actions."""
    return {
        "orders": [_order(analysis, row) for row in analysis.orders],
        "changes": [] if previous is None else list(_changes(analysis, previous, names)),
        "resources": [_resource(row) for row in analysis.resources],
        "setups": [_setup(analysis, k) for k in range(len(analysis.setups))],
        "levels": list(_levels(analysis)),
        "days": [
            (
                f"{d.day:%a} {d.day.date().isoformat()}",
                *map(str, (d.begun, d.ended, d.due, d.late)),
            )
            for d in analysis.days
        ],
    }


def _order(analysis: Analysis, row: OrderRow) -> Cells:
    dates = analysis.dates
    name = row.label if row.occurrence == 1 else f"{row.label} ({row.occurrence})"
    return (
        name,
        clock_text(dates, row.due),
        clock_text(dates, row.end),
        _punctuality(row),
        number_text(row.due),
        number_text(row.start),
        number_text(row.end),
        number_text(row.lateness),
        str(row.weight) if row.due is not None else "",
        str(row.actions),
        " → ".join(map(_key_text, _cut(row.critical))),
    )


def _cut(keys: Sequence[Key]) -> Sequence[Key]:
    """The last ones of a long chain."""
    return keys if len(keys) <= 6 else [("…", 1), *keys[-5:]]


def _punctuality(row: OrderRow) -> str:
    if not row.present:
        return "not in the plan"
    if row.lateness is None:
        return ""
    return "late" if row.lateness > 0 else "on time"


def _resource(row: ResourceRow) -> Cells:
    return (
        row.label,
        str(row.capacity),
        str(row.actions),
        percent_text(row.utilisation),
        format_number(row.busy),
        format_number(row.setup),
        format_number(row.idle),
        format_number(row.closed),
        str(row.setups) if row.setups else "",
        str(row.setup_cost) if row.setup_cost else "",
    )


def percent_text(part: Fraction | None) -> str:
    """A part as a percentage to one decimal place; empty for None."""
    return "" if part is None else f"{float(part * 100):.1f}"


def _setup(analysis: Analysis, k: int) -> Cells:
    row = analysis.setups[k]
    return (
        row.resource,
        clock_text(analysis.dates, row.start),
        clock_text(analysis.dates, row.end),
        format_number(row.start),
        format_number(row.end),
        "" if row.before is None else _key_text(row.before),
        _key_text(row.after),
        str(row.cost) if row.cost else "",
    )


def _levels(analysis: Analysis) -> Iterator[Cells]:
    for stock in analysis.stocks:
        for time, level in stock.levels:
            yield _level(analysis, stock.resource, time, str(level))
    for state in analysis.states:
        for time, value in state.values:
            yield _level(analysis, state.variable, time, value_shown(value))


def _level(analysis: Analysis, name: str, time: Number, value: str) -> Cells:
    return name, clock_text(analysis.dates, time), format_number(time), value


def value_shown(value: bool | str | Number) -> str:
    """The value of a state variable as cells and charts show it."""
    if isinstance(value, str):
        return value
    return ("true" if value else "false") if isinstance(value, bool) else format_number(value)


def _changes(analysis: Analysis, previous: Analysis, names: Mapping[str, str]) -> Iterator[Cells]:
    """The occurrences whose start, mode or resources changed, that are new, or that are gone."""
    now = {row.key: row for row in analysis.actions}
    before = {row.key: row for row in previous.actions}
    for key in sorted({*now, *before}, key=lambda k: (_start(now, before, k), k)):
        new, old = now.get(key), before.get(key)
        what = _change(old, new, analysis.time_unit)
        if what:
            yield (
                key[0],
                "" if key[1] == 1 else str(key[1]),
                what,
                "" if old is None else clock_text(previous.dates, old.start),
                "" if new is None else clock_text(analysis.dates, new.start),
                number_text(None if old is None else old.start),
                number_text(None if new is None else new.start),
                "" if old is None else held_text(old.resources, names),
                "" if new is None else held_text(new.resources, names),
            )


def _start(now: Mapping[Key, ActionRow], before: Mapping[Key, ActionRow], key: Key) -> Number:
    return (now.get(key) or before[key]).start


def _change(old: ActionRow | None, new: ActionRow | None, unit: str) -> str:
    """The change of an occurrence in words; empty where there is none."""
    if old is None:
        return "new"
    if new is None:
        return "gone"
    said = []
    if new.start != old.start:
        by: Number = exact_of(new.start - old.start)
        said.append(f"{'later' if by > 0 else 'earlier'} by {format_number(max(by, -by))} {unit}")
    if new.mode != old.mode:
        said.append(f"done as {new.mode or 'usual'}")
    if dict(new.resources) != dict(old.resources):
        said.append("other resources")
    return ", ".join(said)
