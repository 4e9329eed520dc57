"""The sheets of a task in tables, and their columns."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum


class Kind(Enum):
    """How a cell is read."""

    TEXT = "text"
    """A text; a number counts as its text."""
    NAMES = "names"
    """Names with a semicolon between them."""
    SPAN = "span"
    """A length of time: a number of the task's unit, a text such as `2 h`, a duration cell."""
    INSTANT = "instant"
    """A point in time: like a span, or a date with a time of day."""
    CLOCK = "clock"
    """A time of day such as `06:00`, or a span where the task has no dates."""
    DAY = "day"
    """A date, perhaps with a time of day."""
    NUMBER = "number"
    """A whole number."""
    FLAG = "flag"
    """Yes or no."""


@dataclass(frozen=True)
class Column:
    """A column: how its cells are read, and other names by which people call it."""

    kind: Kind = Kind.TEXT
    required: bool = False
    aliases: tuple[str, ...] = ()
    help: str = ""


_TIMES: Mapping[str, Column] = {
    "release": Column(Kind.INSTANT, aliases=("earliest_start",), help="it starts no earlier"),
    "start": Column(Kind.INSTANT, help="it starts exactly then"),
    "latest_start": Column(Kind.INSTANT, help="it starts no later"),
    "deadline": Column(Kind.INSTANT, help="it ends no later"),
    "due": Column(Kind.INSTANT, aliases=("due_date",), help="later is late"),
    "weight": Column(Kind.NUMBER, help="how much lateness counts"),
}

SHEETS: Mapping[str, Mapping[str, Column]] = {
    "task": {
        "field": Column(required=True, help="name, time_unit, origin, deadline or objective"),
        "value": Column(Kind.INSTANT, required=True),
    },
    "actions": {
        "action": Column(required=True, aliases=("id", "name", "activity"), help="its name"),
        "label": Column(),
        "description": Column(),
        "duration": Column(Kind.SPAN, help="2 h, 30 min, or a number of the time unit"),
        "max_duration": Column(Kind.SPAN, help="where the solver may choose it, up to this"),
        "uses": Column(help="what it holds: oven; Ana | Bo; crane x 2"),
        "after": Column(Kind.NAMES, aliases=("predecessors",), help="actions before it: a; b"),
        **_TIMES,
        "order": Column(aliases=("group",), help="the order that it belongs to"),
        "calendar": Column(help="when it may be worked on"),
        "breaks": Column(help="avoid, or pause"),
        "max_pause": Column(Kind.SPAN, help="the longest pause in all"),
        "occurs": Column(help="once, or optional"),
        "reward": Column(Kind.NUMBER),
        "cost": Column(Kind.NUMBER),
    },
    "modes": {
        "action": Column(required=True),
        "mode": Column(required=True, help="the name of this way to carry the action out"),
        "label": Column(),
        "duration": Column(Kind.SPAN, required=True),
        "max_duration": Column(Kind.SPAN),
        "uses": Column(help="what it holds in this mode"),
    },
    "uses": {
        "action": Column(required=True),
        "mode": Column(help="only in this mode"),
        "use": Column(Kind.NUMBER, help="rows with one number are alternatives"),
        "resource": Column(required=True),
        "amount": Column(Kind.NUMBER),
        "family": Column(help="for the set-ups or loads of the resource"),
    },
    "resources": {
        "resource": Column(required=True, aliases=("id", "name")),
        "label": Column(),
        "description": Column(),
        "kind": Column(help="renewable (or empty), batch, or reservoir"),
        "capacity": Column(Kind.NUMBER, help="units that can be held at once"),
        "initial": Column(Kind.NUMBER, help="of a reservoir"),
        "min": Column(Kind.NUMBER),
        "max": Column(Kind.NUMBER),
        "calendar": Column(help="when it is open"),
        "initial_family": Column(help="what it is set up for at first"),
    },
    "calendars": {
        "calendar": Column(required=True, aliases=("id", "name")),
        "time_zone": Column(help="such as Europe/Berlin"),
        "every": Column(Kind.SPAN, help="the length of a cycle, where the task has no dates"),
        "days": Column(Kind.NAMES, help="mon; tue; …, or empty for all"),
        "from": Column(Kind.CLOCK, help="such as 06:00"),
        "to": Column(Kind.CLOCK),
        "closed": Column(Kind.DAY, help="a holiday, or the time at which closing begins"),
        "closed_to": Column(Kind.DAY, help="the time at which closing ends"),
    },
    "setups": {
        "resource": Column(required=True),
        "from": Column(required=True, help="a family, or *"),
        "to": Column(required=True, help="a family, or *"),
        "time": Column(Kind.SPAN),
        "cost": Column(Kind.NUMBER),
    },
    "availability": {
        "resource": Column(required=True),
        "from": Column(Kind.INSTANT, required=True),
        "to": Column(Kind.INSTANT, required=True),
        "capacity": Column(Kind.NUMBER, required=True, help="0: closed"),
    },
    "stock": {
        "action": Column(required=True),
        "resource": Column(required=True),
        "change": Column(required=True, help="consumes or produces"),
        "amount": Column(Kind.NUMBER),
        "at": Column(help="start or end"),
    },
    "precedence": {
        "before": Column(required=True, aliases=("predecessor",)),
        "after": Column(required=True, aliases=("successor",)),
        "type": Column(help="finish-start (or empty), start-start, finish-finish, start-finish"),
        "min_lag": Column(Kind.SPAN, aliases=("lag",)),
        "max_lag": Column(Kind.SPAN),
    },
    "consecutive": {
        "before": Column(required=True),
        "after": Column(required=True, help="the action that uses the resource next"),
        "resource": Column(help="or each that both use"),
    },
    "same_order": {
        "number": Column(Kind.NUMBER, help="rows with one number belong together"),
        "resources": Column(Kind.NAMES, required=True, help="press; saw"),
        "job": Column(Kind.NAMES, help="its action on each of them, or empty for all orders"),
    },
    "orders": {
        "order": Column(required=True, aliases=("id", "name", "group")),
        "label": Column(),
        "due": _TIMES["due"],
        "weight": _TIMES["weight"],
        "deadline": _TIMES["deadline"],
        "reward": Column(Kind.NUMBER),
        "required": Column(Kind.FLAG, help="no: it may be left out"),
    },
}
"""Each sheet with its columns, in the order in which they are written.

A sheet that is missing is empty; only `actions` must be there.
"""


def plain(name: str) -> str:
    """The name of a sheet or a column as it is compared: lower case, `_` for blanks and dashes."""
    return "_".join(name.strip().lower().replace("-", " ").replace("_", " ").split())
