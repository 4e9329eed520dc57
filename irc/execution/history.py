"""The schedule that is being carried out, and what has been observed of it."""

from __future__ import annotations

from collections.abc import Collection, Hashable, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

from irc.execution.observations import Observed
from irc.execution.state import ExecutionState, Key, key_of, state_of
from irc.model.quantities import Number
from irc.schedule import BEGUN, CANCELLED, Entry, Schedule

_NO_STARTS: Mapping[str, Number] = MappingProxyType({})


@dataclass
class History:
    """The entries of the schedule that is being carried out, and what has been observed.

    `begun` are the occurrences that had begun when an event revised the task or a plan was made,
    and `came_later` the precedences that an event has added behind a start (as reasons against it);
    of the schedule that it all began with, `done` are those that had ended, and `fixed` those whose
    start was observed before: the task fixes it, or their status says so. `late` are those that
    cannot have begun as planned: they wait for an observation or the next plan. `cancelled` has for
    each action that must not begin any more the time since when. `plan` has the entries as planned;
    events do not change it.

    With `assumes` the plan is presumed to be carried out, else only what was observed has happened.
    From `held` on nothing is presumed: there is no plan for what was to begin then.
    """

    entries: dict[Key, Entry] = field(default_factory=dict)
    observed: dict[Key, Observed] = field(default_factory=dict)
    begun: set[Key] = field(default_factory=set)
    done: set[Key] = field(default_factory=set)
    late: set[Key] = field(default_factory=set)
    cancelled: dict[str, Number] = field(default_factory=dict)
    plan: Mapping[Key, Entry] = field(default_factory=dict)
    assumes: bool = True
    held: Number | None = None
    disturbed: bool = False
    """Whether something has come in since the last plan."""
    count: int = 0
    """The number of events that have come in."""
    fixed: frozenset[Key] = frozenset()
    came_later: frozenset[tuple[Hashable, ...]] = frozenset()
    least_ends: Mapping[Key, Number] = field(default_factory=dict)
    """Times before which running occurrences of actions that repeat do not end."""

    @classmethod
    def of(
        cls,
        schedule: Schedule,
        at: Number = 0,
        *,
        assumes: bool = True,
        starts: Mapping[str, Number] = _NO_STARTS,
    ) -> History:
        """The history with the entries of a schedule, which has been carried out until `at`.

        `starts` are the starts that the task fixes. (It does so for those that were observed.)
        """
        entries = {key_of(entry): without_begun(entry) for entry in schedule.entries}
        seen = {key_of(e) for e in schedule.entries if e.start == at and e.status == BEGUN}
        begun = {key: e for key, e in entries.items() if e.start < at or key in seen}
        fixed = {key for key, e in begun.items() if starts.get(key[0]) == e.start}
        return cls(
            entries,
            begun=set(begun),
            fixed=frozenset(fixed | seen),
            done={key for key, entry in begun.items() if entry.end <= at},
            cancelled={e.id: e.end for e in schedule.entries if e.status == CANCELLED},
            plan=dict(entries),
            assumes=assumes,
        )

    def copy(self) -> History:
        """Another history with the same contents."""
        return replace(
            self,
            entries=dict(self.entries),
            observed=dict(self.observed),
            begun=set(self.begun),
            done=set(self.done),
            late=set(self.late),
            cancelled=dict(self.cancelled),
        )

    def state(self, at: Number) -> ExecutionState:
        """The entries that are completed, running and open at `at`.

        (Of a history as it is taken to be then: `irc.execution.presumed.as_of`.)
        """
        return state_of(self.entries.values(), at, self.begun)

    def reject(self, now: Number) -> None:
        """Takes note that there is no plan: nothing of the previous one is presumed from now on."""
        self.held = now if self.held is None else min(self.held, now)


def without_begun(entry: Entry) -> Entry:
    """The entry without the status that it was observed to begin, which is in the history."""
    return replace(entry, status=None) if entry.status == BEGUN else entry


def ids(entries: Collection[Entry]) -> tuple[str, ...]:
    """The ids of entries, each once, in their order."""
    return tuple(dict.fromkeys(entry.id for entry in entries))
