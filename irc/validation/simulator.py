"""Simulates one state variable, in the order of (time, rank), and reports what does not hold."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Literal, NamedTuple

from irc.model import StateVariable
from irc.model.quantities import Number
from irc.model.state_values import value_text
from irc.validation.happenings import (
    Happening,
    Hold,
    Read,
    Timeline,
    Write,
)
from irc.validation.levels import Between, Need, Value, bounds_of, changed, meets
from irc.validation.state_messages import (
    add_broken,
    add_contradiction,
    add_out_of_bounds,
    add_unheld,
    add_unmet,
)
from irc.validation.verdict import Violations, listed


class Demand(NamedTuple):
    """A need of a happening just before it, or just after it and from then on."""

    occurrence: int
    at_end: bool
    kind: Literal["before", "from then on"]
    need: Need


@dataclass
class _Moment:
    """The reads, writes and holds of one variable at one (time, rank)."""

    reads: list[Read] = field(default_factory=list)
    writes: list[Write] = field(default_factory=list)
    opening: list[tuple[int, Hold]] = field(default_factory=list)
    closing: list[tuple[int, Hold]] = field(default_factory=list)


_Holds = dict[Need, dict[int, Hold]]
"""Holds that are open, by what they need and a number."""


class StateSimulator:
    """Simulates one variable.

    `lost` are demands that the history alone does not meet: they are carried. `failed` collects
    the demands that are not met here. A change is carried too if the need that it breaks is history
    and it is history or timed; where something open takes part, it is a violation.
    """

    def __init__(
        self,
        variable: StateVariable,
        violations: Violations,
        lost: Collection[Demand] = frozenset(),
    ) -> None:
        self.name = variable.id
        self.value: Value = variable.start_value
        self.bounds = bounds_of(variable)
        self.violations = violations
        self.lost = lost
        self.failed: set[Demand] = set()
        self.held: _Holds = {}
        self.damaged: _Holds = {}
        """Holds that the history itself breaks; open occurrences must not break them again."""

    def run(self, timeline: Timeline, ranks: Sequence[int]) -> Value:
        """Checks all happenings of the variable and returns its last value."""
        moments: dict[tuple[Number, int], _Moment] = {}

        def moment(happening: Happening) -> _Moment:
            return moments.setdefault((happening.time, ranks[happening.node]), _Moment())

        for read in timeline.reads:
            moment(read.happening).reads.append(read)
        for access in timeline.writes:
            moment(access.happening).writes.append(access)
        for number, hold in enumerate(timeline.holds):
            first = (hold.opening.time, ranks[hold.opening.node])
            last = (hold.closing.time, ranks[hold.closing.node])
            if first < last:
                moments.setdefault(first, _Moment()).opening.append((number, hold))
                moments.setdefault(last, _Moment()).closing.append((number, hold))
        for (_, rank), current in sorted(moments.items(), key=lambda item: item[0]):
            self._pass(current, rank)
        return self.value

    def _pass(self, moment: _Moment, rank: int) -> None:
        for read in moment.reads:
            if not meets(self.value, read.need):
                carried = self._fail(read.happening, "before", read.need)
                found = value_text(self.value)
                add_unmet(self.name, read, found, self.violations, carried=carried)
        for number, hold in moment.closing:
            self.held.get(hold.need, {}).pop(number, None)
            self.damaged.get(hold.need, {}).pop(number, None)
        if moment.writes:
            self._check_interference(moment, rank)
            for access in moment.writes:
                self._write(access)
        for number, hold in moment.opening:
            if meets(self.value, hold.need):
                self.held.setdefault(hold.need, {})[number] = hold
                continue
            carried = self._fail(hold.opening, "from then on", hold.need)
            add_unheld(self.name, hold, value_text(self.value), self.violations, carried=carried)
            if carried:
                self.damaged.setdefault(hold.need, {})[number] = hold

    def _fail(
        self, happening: Happening, kind: Literal["before", "from then on"], need: Need
    ) -> bool:
        """Records a demand that is not met; returns whether it is carried."""
        demand = Demand(happening.occurrence.number, happening.at_end, kind, need)
        self.failed.add(demand)
        return demand in self.lost

    def _write(self, access: Write) -> None:
        value = changed(self.value, access.change)
        broken = _unmet(self.held, value)
        is_open = not access.happening.occurrence.is_history
        if self.bounds is not None and _leaves(self.bounds, self.value, value, further=is_open):
            add_out_of_bounds(
                self.name, access, value, self.bounds, self.violations, carried=not is_open
            )
        if is_open:
            # A damaged hold that has its value again must not lose it to an open occurrence.
            lost = _unmet(self.damaged, value)
            broken |= {n: h for n, h in lost.items() if meets(self.value, h.need)}
            self._add_broken(access, broken.values(), carried=False)
            _drop(self.damaged, broken)
        else:
            between_past = {n: h for n, h in broken.items() if h.opening.occurrence.past}
            self._add_broken(access, between_past.values(), carried=True)
            open_ones = [h for n, h in broken.items() if n not in between_past]
            self._add_broken(access, open_ones, carried=False)
            for number, hold in between_past.items():
                self.damaged.setdefault(hold.need, {})[number] = hold
        # Each broken hold is reported once, not again at every later change.
        _drop(self.held, broken)
        self.value = value

    def _add_broken(self, access: Write, broken: Collection[Hold], *, carried: bool) -> None:
        if broken:
            add_broken(self.name, access, list(broken), self.violations, carried=carried)

    def _check_interference(self, moment: _Moment, rank: int) -> None:
        writers = {access.happening.node: access for access in moment.writes}
        for access in moment.writes:
            if access.change != writers[access.happening.node].change:
                carried = _all_past([access])
                add_contradiction(self.name, access, self.violations, carried=carried)
        parties: dict[int, Read | Write] = {a.happening.node: a for a in moment.reads}
        parties = {**writers, **parties}
        if len(parties) < 2:
            return
        first = moment.writes[0].happening
        others = [a.happening.occurrence.entry.id for n, a in parties.items() if n != first.node]
        self.violations.add(
            "interference",
            f"{first.occurrence.name} changes {self.name!r} at "
            f"{self.violations.time(first.time)} with rank {rank}, where "
            f"{listed(others, len(others))} read or change it with the same rank; "
            "the later happening needs a higher rank",
            [first.occurrence.entry.id, *others],
            (first.time,),
            carried=_all_past(parties.values()),
        )


def _all_past(accesses: Iterable[Read | Write]) -> bool:
    return all(access.happening.occurrence.is_history for access in accesses)


def _unmet(holds: _Holds, value: Value) -> dict[int, Hold]:
    """The holds that a value does not suit."""
    return {n: h for need, own in holds.items() if not meets(value, need) for n, h in own.items()}


def _leaves(bounds: Between, old: Value, new: Value, *, further: bool) -> bool:
    """Whether a change of a number leaves its bounds; `further`: farther than it was before."""
    if meets(new, bounds):
        return False
    if not further or meets(old, bounds) or not isinstance(old, (int, Fraction)):
        return True
    beyond = Between(
        None if bounds.least is None else min(bounds.least, old),
        None if bounds.greatest is None else max(bounds.greatest, old),
    )
    return not meets(new, beyond)


def _drop(holds: _Holds, gone: dict[int, Hold]) -> None:
    for number, hold in gone.items():
        holds.get(hold.need, {}).pop(number, None)
