"""The columns of the tables of a report."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import NamedTuple


class Column(NamedTuple):
    """A column: its title, the kind of its cells, and the column by which it is sorted.

    `kind` is "text", "number" or "time" (a clock time). `by` is its own index or, for clock times,
    that of the exact number.
    """

    title: str
    kind: str
    by: int


@dataclass(frozen=True, slots=True)
class Table:
    """A table of a report; `note` stands above it."""

    title: str
    columns: tuple[Column, ...]
    note: str = ""


_Columns = tuple[tuple[str, str] | tuple[str, str, int], ...]

# (In a title, % stands for the time unit. The chart reads the columns of actions by their places:
# see model.js.)
_COLUMNS: Mapping[str, _Columns] = MappingProxyType(
    {
        "orders": (
            ("order", "text"),
            ("due", "time", 4),
            ("ends", "time", 6),
            ("on time", "text"),
            ("due (%)", "number"),
            ("start (%)", "number"),
            ("end (%)", "number"),
            ("lateness (%)", "number"),
            ("weight", "number"),
            ("actions", "number"),
            ("its end waits for", "text"),
        ),
        "changes": (
            ("action", "text"),
            ("occurrence", "number"),
            ("change", "text"),
            ("started", "time", 5),
            ("starts", "time", 6),
            ("start before (%)", "number"),
            ("start now (%)", "number"),
            ("resources before", "text"),
            ("resources now", "text"),
        ),
        "resources": (
            ("resource", "text"),
            ("capacity", "number"),
            ("actions", "number"),
            ("use in percent", "number"),
            ("busy (%)", "number"),
            ("set-up (%)", "number"),
            ("idle (%)", "number"),
            ("closed (%)", "number"),
            ("set-ups", "number"),
            ("set-up cost", "number"),
        ),
        "actions": (
            ("action", "text"),
            ("occurrence", "number"),
            ("starts", "time", 4),
            ("ends", "time", 5),
            ("start (%)", "number"),
            ("end (%)", "number"),
            ("duration (%)", "number"),
            ("mode", "text"),
            ("resources", "text"),
            ("order", "text"),
            ("due (%)", "number"),
            ("lateness (%)", "number"),
            ("slack (%)", "number"),
            ("status", "text"),
            ("why it starts then", "text"),
        ),
        "setups": (
            ("resource", "text"),
            ("starts", "time", 3),
            ("ends", "time", 4),
            ("start (%)", "number"),
            ("end (%)", "number"),
            ("after", "text"),
            ("for", "text"),
            ("cost", "number"),
        ),
        "levels": (
            ("stock or variable", "text"),
            ("from", "time", 2),
            ("from (%)", "number"),
            ("level or value", "text"),
        ),
        "days": (
            ("day", "text"),
            ("starts", "number"),
            ("ends", "number"),
            ("due", "number"),
            ("of these late", "number"),
        ),
    }
)

_TITLES: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        "orders": (
            "Due dates and orders",
            "Lateness is the end less the due date: below 0 the order is early.",
        ),
        "changes": ("Changes against the previous plan", ""),
        "resources": (
            "Resources",
            "From t = 0 to the last end. Use is the part of the open capacity that is held.",
        ),
        "actions": ("Actions", ""),
        "setups": ("Set-ups", ""),
        "levels": ("Stock and state over time", ""),
        "days": (
            "Days",
            "The numbers of actions that start and end, and of orders that are due, on each day.",
        ),
    }
)


def tables_for(unit: str) -> dict[str, Table]:
    """The tables of a report on a task with this time unit, in their order."""
    return {
        name: Table(title, _columns(_COLUMNS[name], unit), note)
        for name, (title, note) in _TITLES.items()
    }


def _columns(columns: _Columns, unit: str) -> tuple[Column, ...]:
    return tuple(
        Column(c[0].replace("%", unit), c[1], c[2] if len(c) == 3 else k)
        for k, c in enumerate(columns)
    )
