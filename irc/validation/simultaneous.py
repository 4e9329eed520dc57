"""Simultaneous happenings: those that touch one state variable at one instant, and so need ranks.

Such a cluster is a small puzzle: put the writers in an order, and each read and each end of a hold
in a slot between them. Slot i lies after the i-th writer; values[i] is the variable's value there
(values[0] is the value that comes in). Most clusters have at most one writer and one answer, which
is found here at once. The other clusters go to the search.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from typing import Literal, NamedTuple

from irc.model import StateGoal, StateVariable
from irc.model.quantities import Number
from irc.model.state_values import value_text
from irc.validation.bound_schedule import BoundSchedule
from irc.validation.happenings import (
    Edge,
    Edges,
    Happening,
    Hold,
    Read,
    Timeline,
    Timelines,
    Write,
)
from irc.validation.levels import (
    Given,
    Need,
    NumberChange,
    Value,
    bounds_of,
    changed,
    meets,
    need_of,
)
from irc.validation.state_messages import (
    add_broken,
    add_contradiction,
    add_out_of_bounds,
    add_unheld,
    add_unmet,
    add_unmet_goal,
)
from irc.validation.verdict import Violations


class _OpenValue(Enum):
    """The mark of a value that depends on an order not yet found."""

    VALUE = "open"


OPEN = _OpenValue.VALUE
"""The value that comes into a cluster depends on the previous cluster."""


class Writer(NamedTuple):
    """A happening that changes the variable, and what it needs just before."""

    happening: Happening
    change: Given
    needs: tuple[Need, ...]


class SlotItem(NamedTuple):
    """An item that needs a slot: a read, the opening or closing of a hold, or (`span`) both."""

    kind: Literal["read", "open", "close", "span"]
    need: Need
    happening: Happening
    hold: Hold | None = None


@dataclass(frozen=True)
class Cluster:
    """One variable at one instant.

    `previous` numbers the cluster whose last value comes in, where `incoming` is open; `goals` are
    what the variable must be at the end, `always` what each value that is given must meet.
    """

    variable: str
    time: Number
    writers: tuple[Writer, ...]
    items: tuple[SlotItem, ...]
    incoming: Value | Literal[_OpenValue.VALUE]
    previous: int | None = None
    goals: tuple[Need, ...] = ()
    always: tuple[Need, ...] = ()

    @property
    def is_decided(self) -> bool:
        """Whether no choice is left in it."""
        return self.incoming is not OPEN and len(self.writers) <= 1 and not self.items

    def happenings(self) -> Iterator[Happening]:
        """All happenings of the cluster."""
        for writer in self.writers:
            yield writer.happening
        for item in self.items:
            yield item.happening
            if item.kind == "span" and item.hold is not None:
                yield item.hold.closing


def slots(item: SlotItem, order: Sequence[Writer], incoming: Value) -> list[Edges]:
    """The ways to place `item` among writers of a known order; none if its value never fits.

    A read shares its rank with no writer. A hold opens with the previous writer or later, and
    closes with the next writer or earlier, so for holds the outermost slot stands for all.
    """
    values: list[Value] = [incoming]
    for writer in order:
        values.append(changed(values[-1], writer.change))
    nodes = [writer.happening.node for writer in order]
    last = len(nodes)
    if item.kind == "read":
        return [
            _after(nodes, i, item.happening.node, 1) + _before(nodes, i, item.happening.node, 1)
            for i, value in enumerate(values)
            if meets(value, item.need)
        ]
    runs = _runs(values, item.need)
    if item.kind == "open":
        return [_after(nodes, i, item.happening.node, 0) for i, j in runs if j == last]
    if item.kind == "close":
        # The opening of the hold has already checked the value that comes in.
        reach = next((i for i in range(1, last + 1) if not meets(values[i], item.need)), last + 1)
        return [_before(nodes, reach - 1, item.happening.node, 0)]
    closing = item.hold.closing.node if item.hold is not None else item.happening.node
    return [
        _after(nodes, i, item.happening.node, 0) + _before(nodes, j, closing, 0) for i, j in runs
    ]


def _after(nodes: Sequence[int], slot: int, node: int, least: int) -> Edges:
    return ((nodes[slot - 1], node, least),) if slot > 0 else ()


def _before(nodes: Sequence[int], slot: int, node: int, least: int) -> Edges:
    return ((node, nodes[slot], least),) if slot < len(nodes) else ()


def _runs(values: Sequence[Value], wanted: Need) -> list[tuple[int, int]]:
    """The longest stretches [i, j] of slots in which the value is what is wanted."""
    runs: list[tuple[int, int]] = []
    for i, value in enumerate(values):
        if not meets(value, wanted):
            continue
        if runs and runs[-1][1] == i - 1:
            runs[-1] = (runs[-1][0], i)
        else:
            runs.append((i, i))
    return runs


@dataclass
class RankConstraints:
    """The edges between ranks that clusters with one answer give, and the other clusters."""

    edges: list[Edge] = field(default_factory=list)
    clusters: list[Cluster] = field(default_factory=list)


def rank_constraints(
    bound: BoundSchedule, timelines: Timelines, violations: Violations
) -> RankConstraints:
    """The rank constraints of all clusters, in O(n log n); reports violations under all ranks."""
    constraints = RankConstraints()
    goals: dict[str, list[Need]] = {}
    for goal in dict.fromkeys(bound.task.goals):
        if isinstance(goal, StateGoal) and not is_left_out(bound, goal):
            goals.setdefault(goal.var, []).append(need_of(goal))
    for name, variable in bound.variables.items():
        pass_over = _OneVariable(variable, constraints, violations)
        pass_over.run(timelines.by_variable[name], tuple(goals.get(name, ())))
    return constraints


@dataclass
class _Instant:
    writes: list[Write] = field(default_factory=list)
    reads: list[Read] = field(default_factory=list)
    opening: list[Hold] = field(default_factory=list)
    closing: list[Hold] = field(default_factory=list)
    spans: list[Hold] = field(default_factory=list)


class _OneVariable:
    """Builds the clusters of one variable, instant by instant."""

    def __init__(
        self, variable: StateVariable, constraints: RankConstraints, violations: Violations
    ) -> None:
        self.variable = variable.id
        self.value: Value | Literal[_OpenValue.VALUE] = variable.start_value
        self.bounds = bounds_of(variable)
        self.previous: int | None = None
        self.constraints = constraints
        self.violations = violations
        self.covering: dict[Need, dict[int, Hold]] = {}

    def run(self, timeline: Timeline, goals: tuple[Need, ...]) -> None:
        instants = _instants(timeline)
        for time in sorted(instants):
            instant = instants[time]
            for hold in instant.closing:
                self.covering.get(hold.need, {}).pop(id(hold), None)
            writers = self._writers(instant)
            self._check_covered(writers)
            self._decide(self._cluster(time, writers, _items(instant, writers)))
            self._take_over(writers)
            for hold in instant.opening:
                self.covering.setdefault(hold.need, {})[id(hold)] = hold
        self._reach_goals(goals, max(instants, default=0))

    def _writers(self, instant: _Instant) -> tuple[Writer, ...]:
        needs: dict[int, list[Need]] = {}
        for read in instant.reads:
            needs.setdefault(read.happening.node, []).append(read.need)
        writers: dict[int, Writer] = {}
        for write in instant.writes:
            node = write.happening.node
            if node in writers and writers[node].change != write.change:
                add_contradiction(self.variable, write, self.violations)
            writers[node] = Writer(write.happening, write.change, tuple(needs.get(node, ())))
        return tuple(writers.values())

    def _check_covered(self, writers: tuple[Writer, ...]) -> None:
        """Reports changes in the middle of a hold, and beyond bounds, which no order avoids.

        (Where the order of changes to a number counts, `Cluster.always` is asked.)
        """
        for writer in writers:
            if isinstance(writer.change, NumberChange) and (self.value is OPEN or len(writers) > 1):
                continue
            incoming = None if self.value is OPEN else self.value
            value = changed(incoming, writer.change)
            access = Write(writer.happening, writer.change)
            if self.bounds is not None and not meets(value, self.bounds):
                add_out_of_bounds(self.variable, access, value, self.bounds, self.violations)
            broken = [
                hold
                for need, holds in self.covering.items()
                if not meets(value, need)
                for hold in holds.values()
            ]
            if broken:
                add_broken(self.variable, access, broken, self.violations)
                self.covering = {n: h for n, h in self.covering.items() if meets(value, n)}

    def _decide(self, cluster: Cluster) -> None:
        if self.value is OPEN or len(cluster.writers) > 1:
            if (
                len(cluster.writers) > 1
                or cluster.items
                or any(isinstance(w.change, NumberChange) for w in cluster.writers)
                or any(w.needs for w in cluster.writers)
            ):
                self.constraints.clusters.append(cluster)
            return
        for writer in cluster.writers:
            for need in writer.needs:
                if not meets(self.value, need):
                    access = Read(writer.happening, need)
                    add_unmet(self.variable, access, value_text(self.value), self.violations)
        undecided = []
        for item in cluster.items:
            options = slots(item, cluster.writers, self.value)
            if not options:
                self._add_unplaceable(item, cluster.writers, self.value)
            elif len(options) == 1:
                self.constraints.edges.extend(options[0])
            else:
                undecided.append(item)
        if undecided:
            self.constraints.clusters.append(replace(cluster, items=tuple(undecided)))

    def _take_over(self, writers: tuple[Writer, ...]) -> None:
        given = {writer.change for writer in writers}
        fixed = not any(isinstance(change, NumberChange) for change in given)
        if self.value is not OPEN and (len(writers) == 1 or all(map(_only_adds, given))):
            for writer in writers:
                self.value = changed(self.value, writer.change)
        elif len(given) == 1 and (fixed or not _only_adds(next(iter(given)))):
            self.value = changed(None, given.pop())
        elif given:
            self.value, self.previous = OPEN, len(self.constraints.clusters) - 1

    def _reach_goals(self, goals: tuple[Need, ...], time: Number) -> None:
        if self.value is OPEN:
            if goals:
                self.constraints.clusters.append(self._cluster(time, (), (), goals))
            return
        for goal in goals:
            if not meets(self.value, goal):
                add_unmet_goal(self.variable, goal, self.value, self.violations)

    def _cluster(
        self,
        time: Number,
        writers: tuple[Writer, ...],
        items: tuple[SlotItem, ...],
        goals: tuple[Need, ...] = (),
    ) -> Cluster:
        previous = self.previous if self.value is OPEN else None
        always: tuple[Need, ...] = ()
        if any(isinstance(writer.change, NumberChange) for writer in writers):
            bounds = () if self.bounds is None else (self.bounds,)
            always = (*bounds, *(need for need, holds in self.covering.items() if holds))
        return Cluster(self.variable, time, writers, items, self.value, previous, goals, always)

    def _add_unplaceable(
        self, item: SlotItem, writers: tuple[Writer, ...], incoming: Value
    ) -> None:
        found = value_text(incoming)
        later = [w.change for w in writers if w.happening.node != item.happening.node]
        if later and changed(incoming, later[0]) != incoming:
            found += f", and {value_text(changed(incoming, later[0]))} from then on"
        if item.hold is not None:
            add_unheld(self.variable, item.hold, found, self.violations)
        else:
            add_unmet(self.variable, Read(item.happening, item.need), found, self.violations)


def is_left_out(bound: BoundSchedule, goal: StateGoal) -> bool:
    """Whether a running task goes on without a goal."""
    return (goal.var, goal.wanted) in bound.left_out


def _only_adds(change: Given) -> bool:
    return isinstance(change, NumberChange) and not change.sets


def _instants(timeline: Timeline) -> dict[Number, _Instant]:
    instants: dict[Number, _Instant] = {}

    def instant(happening: Happening) -> _Instant:
        return instants.setdefault(happening.time, _Instant())

    for write in timeline.writes:
        instant(write.happening).writes.append(write)
    for read in timeline.reads:
        instant(read.happening).reads.append(read)
    for hold in timeline.holds:
        if hold.opening.time == hold.closing.time:
            instant(hold.opening).spans.append(hold)
        else:
            instant(hold.opening).opening.append(hold)
            instant(hold.closing).closing.append(hold)
    return instants


def _items(instant: _Instant, writers: tuple[Writer, ...]) -> tuple[SlotItem, ...]:
    own = {writer.happening.node for writer in writers}
    items = [
        SlotItem("read", r.need, r.happening) for r in instant.reads if r.happening.node not in own
    ]
    items += [SlotItem("open", h.need, h.opening, h) for h in instant.opening]
    items += [SlotItem("close", h.need, h.closing, h) for h in instant.closing]
    items += [SlotItem("span", h.need, h.opening, h) for h in instant.spans]
    return tuple(items)
