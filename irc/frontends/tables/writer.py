"""Writes a task as tables: each element a row, in sheets that `reader` reads back."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from datetime import datetime
from typing import Any

from irc.frontends.exporters.refusal import Refusals
from irc.frontends.tables.cells import Sheet, Value
from irc.frontends.tables.layout import SHEETS
from irc.model import Action, DurationRange, Mode, Resource, Task
from irc.model.base import write_time
from irc.model.details import ClosedTime
from irc.model.features import Feature

_SUPPORTED = frozenset(
    [
        *(Feature.DURATION_RANGE, Feature.ZERO_DURATION, Feature.MODES, Feature.OPTIONAL_ACTIONS),
        *(Feature.PRECEDENCE, Feature.PRECEDENCE_TYPES, Feature.MIN_LAG, Feature.NEGATIVE_LAG),
        *(Feature.MAX_LAG, Feature.RELEASE, Feature.DEADLINE, Feature.FIXED_START),
        *(Feature.LATEST_START, Feature.DUE_DATE, Feature.RESOURCES, Feature.AMOUNTS),
        *(Feature.ALTERNATIVES, Feature.CALENDARS, Feature.RESERVOIRS, Feature.GROUPS),
        *(Feature.REWARD, Feature.COST, Feature.TARDINESS, Feature.MAXIMIZE_REWARD),
        *(Feature.MINIMIZE_COST, Feature.SEVERAL_OBJECTIVES, Feature.MAKESPAN),
        *(Feature.SETUPS, Feature.ACTION_CALENDARS, Feature.PAUSES),
        *(Feature.SETUP_TIME, Feature.SETUP_COST, Feature.BATCHES, Feature.SEQUENCES),
    ]
)

Cells = Mapping[str, Value]


def sheets_of_task(task: Task) -> list[Sheet]:
    """The sheets of a task, without those that would be empty.

    Raises `InputError` with each element that tables cannot say.
    """
    refusals = Refusals(task, "a table")
    refusals.require_features(_SUPPORTED)
    groups = _orders(task, refusals)
    for i, action in enumerate(task.actions):
        if action.on_failure is not None:
            refusals.add(f"action {action.id!r}: a table has no on_failure", ("actions", i))
    for k, order in enumerate(task.sequences):
        names = (*(order.same_order or ()), *(name for job in order.jobs for name in job))
        if any(";" in name for name in names):
            refusals.add("a list of names in a cell has ';' between them", ("sequences", k))
    if task.events:
        refusals.add("a table has no events", ("events",))
    refusals.raise_any()
    rows: dict[str, list[Cells]] = {
        "task": [*_task(task)],
        "actions": [{**_action(action), "order": groups.get(action.id)} for action in task.actions],
        "modes": [{"action": a.id, **_mode(m)} for a in task.actions for m in a.modes],
        "uses": [*_uses(task)],
        "resources": [_resource(r) for r in task.resources],
        "calendars": [*_calendars(task)],
        "setups": [
            {"resource": r.id, **_fields(time, None, SHEETS["setups"])}
            for r in task.resources
            if r.setups is not None
            for time in r.setups.times
        ],
        "availability": [
            {"resource": r.id, **_fields(w, None, SHEETS["availability"])}
            for r in task.resources
            for w in r.availability
        ],
        "stock": [*_stock(task)],
        "precedence": [_fields(p, None, SHEETS["precedence"]) for p in task.precedence],
        "consecutive": [
            {"before": pair[0], "after": pair[1], "resource": order.resource}
            for order in task.sequences
            if (pair := order.consecutive) is not None
        ],
        "same_order": [*_same_orders(task)],
        "orders": [_fields(g, "order", SHEETS["orders"]) for g in task.groups],
    }
    return [_sheet(name, rows[name]) for name in SHEETS if rows[name]]


def template_sheets() -> list[Sheet]:
    """All sheets with their headings, and a small task as an example."""
    rows: dict[str, list[Cells]] = {
        "task": [
            {"field": "name", "value": "first plan"},
            {"field": "time_unit", "value": "min"},
            {"field": "origin", "value": datetime(2026, 3, 2, 8)},
        ],
        "actions": [
            {"action": "cut", "duration": 30, "uses": "saw; Ana | Bo"},
            {"action": "glue", "duration": 45, "uses": "Ana | Bo", "after": "cut"},
            {"action": "paint", "duration": "1 h", "uses": "Bo", "after": "glue"},
        ],
        "resources": [{"resource": name, "capacity": 1} for name in ("saw", "Ana", "Bo")],
        "availability": [
            {
                "resource": "Bo",
                "from": datetime(2026, 3, 2, 12),
                "to": datetime(2026, 3, 2, 13),
                "capacity": 0,
            }
        ],
    }
    return [_sheet(name, rows.get(name, []), every_column=True) for name in SHEETS]


def _sheet(name: str, rows: Sequence[Cells], *, every_column: bool = False) -> Sheet:
    """A sheet with the columns that its rows need, or with all."""
    columns = [
        column
        for column, spec in SHEETS[name].items()
        if every_column or spec.required or any(row.get(column) is not None for row in rows)
    ]
    return Sheet(name, [columns, *([row.get(column) for column in columns] for row in rows)])


_TASK_FIELDS = (
    *("name", "description", "time_unit", "days_per_month", "resolution", "origin", "deadline"),
)


def _task(task: Task) -> Iterator[Cells]:
    for field in _TASK_FIELDS:
        value = getattr(task, field)
        if field in task.model_fields_set and value is not None:
            yield {"field": field, "value": _cell(value)}
    if "objective" in task.model_fields_set:
        yield {
            "field": "objective",
            "value": "; ".join(o for o in task.objective if isinstance(o, str)),
        }


def _orders(task: Task, refusals: Refusals) -> dict[str, str]:
    """The order of each action."""
    found: dict[str, str] = {}
    for k, group in enumerate(task.groups):
        for id in group.actions:
            if id in found:
                message = f"action {id!r} is in two orders, for which a table has no column"
                refusals.add(message, ("groups", k))
            found[id] = group.id
    return found


def _fields(node: Any, id_column: str | None, columns: Mapping[str, Any]) -> dict[str, Value]:
    """The fields of an element that are columns of its sheet, as it was written."""
    written = node.model_fields_set
    fields = type(node).model_fields
    names = {(fields[name].alias or name): name for name in fields if name in written}
    cells = {c: _cell(getattr(node, names[c])) for c in columns if c in names}
    if columns is SHEETS["orders"] and "required" in cells:
        cells["required"] = "yes" if cells["required"] else "no"
    return cells if id_column is None else {id_column: node.id, **cells}


def _cell(value: Any) -> Value:
    """A value of the IR as a cell."""
    if value is None or isinstance(value, (str, int, datetime)):
        return value
    written: Value = write_time(value)
    return written


def _duration(part: Action | Mode) -> dict[str, Value]:
    if isinstance(part.duration, DurationRange):
        return {
            "duration": _cell(part.duration.min),
            "max_duration": _cell(part.duration.max),
        }
    return {} if part.duration is None else {"duration": _cell(part.duration)}


def _action(action: Action) -> dict[str, Value]:
    columns = {
        name: spec
        for name, spec in SHEETS["actions"].items()
        if name not in ("action", "duration", "max_duration", "uses", "after", "order")
    }
    return {**_fields(action, "action", columns), **_duration(action)}


def _mode(mode: Mode) -> dict[str, Value]:
    label = {} if mode.label is None else {"label": mode.label}
    return {"mode": mode.id, **label, **_duration(mode)}


def _resource(resource: Resource) -> dict[str, Value]:
    cells = _fields(resource, "resource", SHEETS["resources"])
    if resource.setups is not None and resource.setups.initial is not None:
        cells["initial_family"] = resource.setups.initial
    return cells


def _calendars(task: Task) -> Iterator[Cells]:
    """A row for each open time and each closed one; the first names what holds for all."""
    for calendar in task.calendars:
        columns = {name: SHEETS["calendars"][name] for name in ("time_zone", "every")}
        head = {"calendar": calendar.id, **_fields(calendar, None, columns)}
        for time in calendar.open:
            days = "; ".join(time.days) if time.days else None
            yield {**head, "days": days, "from": _cell(time.from_), "to": _cell(time.to)}
            head = {"calendar": calendar.id}
        for closed in calendar.closed:
            if isinstance(closed, ClosedTime):
                span = {"closed": _cell(closed.from_), "closed_to": _cell(closed.to)}
            else:
                span = {"closed": _cell(closed)}
            yield {"calendar": calendar.id, **span}


def _uses(task: Task) -> Iterator[Cells]:
    """A row for each resource of a use; those of one use have its number."""
    for action in task.actions:
        owners: list[tuple[str | None, Action | Mode]] = [(None, action)]
        owners += [(mode.id, mode) for mode in action.modes]
        for mode, owner in owners:
            for number, use in enumerate(owner.uses, 1):
                for name in use.alternatives:
                    yield {
                        "action": action.id,
                        "mode": mode,
                        "use": number,
                        "resource": name,
                        **({"amount": use.amount} if use.amount != 1 else {}),
                        **({"family": use.family} if use.family is not None else {}),
                    }


def _same_orders(task: Task) -> Iterator[Cells]:
    """A row for each job, or one without; those of one order have its number."""
    listed = [order for order in task.sequences if order.same_order is not None]
    for number, order in enumerate(listed, 1):
        head: dict[str, Value] = {"number": number, "resources": "; ".join(order.same_order or ())}
        for job in order.jobs or ((),):
            yield {**head, "job": "; ".join(job) or None}


def _stock(task: Task) -> Iterator[Cells]:
    for action in task.actions:
        for change in ("consumes", "produces"):
            for part in getattr(action, change):
                yield {
                    "action": action.id,
                    "change": change,
                    **_fields(part, None, SHEETS["stock"]),
                }
