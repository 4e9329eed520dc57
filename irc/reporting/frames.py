"""The tables of a schedule as data frames."""

from __future__ import annotations

from typing import Any

from irc.display.frames import to_frame
from irc.model import Task
from irc.reporting.analysis import analyse
from irc.reporting.tables import Table, day_table, order_table, resource_table
from irc.schedule import Schedule


def orders(task: Task, schedule: Schedule, library: str | None = None) -> Any:
    """A data frame of the orders of a schedule. Raises `irc.LibraryMissing`."""
    return _frame(order_table(analyse(task, schedule)), library)


def resources(task: Task, schedule: Schedule, library: str | None = None) -> Any:
    """A data frame of the resources of a schedule. Raises `irc.LibraryMissing`."""
    return _frame(resource_table(analyse(task, schedule)), library)


def days(task: Task, schedule: Schedule, library: str | None = None) -> Any:
    """A data frame of the days of a schedule. Raises `irc.LibraryMissing`."""
    return _frame(day_table(analyse(task, schedule)), library)


def _frame(table: Table, library: str | None) -> Any:
    return to_frame(table.columns, table.rows, library)
