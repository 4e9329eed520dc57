"""The execution state: which entries of a schedule are completed, running and open at a time."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass

from irc.model.quantities import Number
from irc.schedule import CANCELLED, Entry, Schedule

Key = tuple[str, int]
"""An occurrence: the action's id and the number of the occurrence."""


def key_of(entry: Entry) -> Key:
    """The key of an entry's occurrence."""
    return entry.id, entry.occurrence


@dataclass(frozen=True, slots=True)
class ExecutionState:
    """The entries of a schedule at time `at` (docs/semantics.md, "While a task runs").

    `completed` entries have started before and ended by then, `running` entries have started before
    and end later. All others are `open`, even those that start just then, unless that start was
    observed.
    """

    at: Number
    completed: tuple[Entry, ...]
    running: tuple[Entry, ...]
    open: tuple[Entry, ...]

    @property
    def stopped(self) -> tuple[Entry, ...]:
        """The completed entries that were cancelled, or failed."""
        return tuple(entry for entry in self.completed if entry.status == CANCELLED)

    @property
    def frozen(self) -> tuple[Entry, ...]:
        """The entries that cannot be changed any more."""
        return (*self.completed, *self.running)


def state_at(schedule: Schedule, at: Number, observed: Collection[Key] = ()) -> ExecutionState:
    """The entries that are completed, running and open at `at`, in the task's unit.

    `observed` occurrences have started, even where the schedule has them start just at `at`.
    """
    begun = {
        key_of(entry)
        for entry in schedule.entries
        if entry.start < at or (entry.start == at and key_of(entry) in observed)
    }
    return state_of(schedule.entries, at, begun)


def state_of(entries: Iterable[Entry], at: Number, begun: Collection[Key]) -> ExecutionState:
    """The entries that are completed, running and open at `at`, of which some have `begun`."""
    completed: list[Entry] = []
    running: list[Entry] = []
    still_open: list[Entry] = []
    for entry in entries:
        if key_of(entry) in begun:
            (completed if entry.end <= at else running).append(entry)
        else:
            still_open.append(entry)
    return ExecutionState(at, tuple(completed), tuple(running), tuple(still_open))
