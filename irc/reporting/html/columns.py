"""The columns of the tables of a report."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
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


def _columns(*columns: tuple[str, str] | tuple[str, str, int]) -> tuple[Column, ...]:
    return tuple(Column(c[0], c[1], c[2] if len(c) == 3 else k) for k, c in enumerate(columns))


def tables_for(unit: str) -> Mapping[str, Table]:
    """The tables of a report on a task with this time unit, in their order."""
    return {
        "orders": Table(
            "Due dates and orders",
            _columns(
                ("order", "text"),
                ("due", "time", 4),
                ("ends", "time", 6),
                ("on time", "text"),
                (f"due ({unit})", "number"),
                (f"start ({unit})", "number"),
                (f"end ({unit})", "number"),
                (f"lateness ({unit})", "number"),
                ("weight", "number"),
                ("actions", "number"),
                ("its end waits for", "text"),
            ),
            "Lateness is the end less the due date: below 0 the order is early.",
        ),
        "changes": Table(
            "Changes against the previous plan",
            _columns(
                ("action", "text"),
                ("occurrence", "number"),
                ("change", "text"),
                ("started", "time", 5),
                ("starts", "time", 6),
                (f"start before ({unit})", "number"),
                (f"start now ({unit})", "number"),
                ("resources before", "text"),
                ("resources now", "text"),
            ),
        ),
        "resources": Table(
            "Resources",
            _columns(
                ("resource", "text"),
                ("capacity", "number"),
                ("actions", "number"),
                ("use (%)", "number"),
                (f"busy ({unit})", "number"),
                (f"set-up ({unit})", "number"),
                (f"idle ({unit})", "number"),
                (f"closed ({unit})", "number"),
                ("set-ups", "number"),
                ("set-up cost", "number"),
            ),
            "From t = 0 to the last end. Use is the part of the open capacity that is held.",
        ),
        "actions": Table("Actions", action_columns(unit)),
        "setups": Table(
            "Set-ups",
            _columns(
                ("resource", "text"),
                ("starts", "time", 3),
                ("ends", "time", 4),
                (f"start ({unit})", "number"),
                (f"end ({unit})", "number"),
                ("after", "text"),
                ("for", "text"),
                ("cost", "number"),
            ),
        ),
        "levels": Table(
            "Stock and state over time",
            _columns(
                ("stock or variable", "text"),
                ("from", "time", 2),
                (f"from ({unit})", "number"),
                ("level or value", "text"),
            ),
        ),
        "days": Table(
            "Days",
            _columns(
                ("day", "text"),
                ("starts", "number"),
                ("ends", "number"),
                ("due", "number"),
                ("of these late", "number"),
            ),
            "The numbers of actions that start and end, and of orders that are due, on each day.",
        ),
    }


def action_columns(unit: str) -> tuple[Column, ...]:
    """The columns of the actions; the chart reads them by their places (see model.js)."""
    return _columns(
        ("action", "text"),
        ("occurrence", "number"),
        ("starts", "time", 4),
        ("ends", "time", 5),
        (f"start ({unit})", "number"),
        (f"end ({unit})", "number"),
        (f"duration ({unit})", "number"),
        ("mode", "text"),
        ("resources", "text"),
        ("order", "text"),
        (f"due ({unit})", "number"),
        (f"lateness ({unit})", "number"),
        (f"slack ({unit})", "number"),
        ("status", "text"),
        ("why it starts then", "text"),
    )
