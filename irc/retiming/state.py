"""State in re-timing: orders of happenings that keep every value as in the answer.

The happenings that touch a variable come in the decisions' order of (time, rank):

- its writes keep their order;
- a read stays after the write that gave it its value and before the next write;
- a change that must not take a value away while an activity runs stays behind that activity's end,
  if it takes that value away;
- a hold opens no earlier than the write that gave it its value, and closes no later than the next
  write of *another* value; equal ranks suit both, since it holds from just after its opening to
  just before its closing. Writes of the same value may come in between.

The orders of these neighbours imply all others, so their number is linear.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import NamedTuple

from irc.problem import Activity, Problem
from irc.problem.decisions import AnswerError, Decision, Moment


class Happening(NamedTuple):
    """The start or the end of an activity."""

    activity: int
    at_end: bool


class HappeningOrder(NamedTuple):
    """`before` is no later than `after`; where their times are equal its rank is no higher, and
    lower if the order is `strict`."""

    before: Happening
    after: Happening
    strict: bool


Key = tuple[Moment, int]
"""The time and the rank of a happening, as a key for sorting."""


class _Access(NamedTuple):
    key: Key
    happening: Happening
    value: int


class _Taking(NamedTuple):
    """A change that takes `value` away only behind `closing`."""

    key: Key
    happening: Happening
    closing: Happening
    value: int


class _Hold(NamedTuple):
    opening: tuple[Key, Happening]
    closing: tuple[Key, Happening]
    value: int


@dataclass(slots=True)
class _Timeline:
    """The reads, writes, holds and takings of one variable."""

    takings: list[_Taking] = field(default_factory=list)
    reads: list[_Access] = field(default_factory=list)
    writes: list[_Access] = field(default_factory=list)
    holds: list[_Hold] = field(default_factory=list)


def is_one_happening(activity: Activity, decision: Decision) -> bool:
    """Whether the activity starts and ends at one time and rank, so that it is one happening."""
    if activity.is_fixed:
        return not activity.duration_max
    return (decision.end, decision.end_rank) <= (decision.start, decision.rank)


def state_orders(
    problem: Problem,
    decisions: Sequence[Decision],
    tolerance: Fraction | int,
    *,
    only: int | None = None,
) -> list[HappeningOrder]:
    """The orders of happenings that state demands: of all variables, or of one `only`.

    A value that a write gives within `tolerance` after it is needed counts as given in time.
    Raises `AnswerError` where the decisions leave a condition without its value.
    """
    orders: list[HappeningOrder] = []
    timelines = [_Timeline() for _ in problem.variables]
    for i, (activity, decision) in enumerate(zip(problem.activities, decisions, strict=True)):
        if activity.details.touches_state:
            _add_activity(timelines, i, activity, decision)
            if not activity.is_fixed:
                orders += _own_orders(i, one=is_one_happening(activity, decision))
    for v, timeline in enumerate(timelines) if only is None else [(only, timelines[only])]:
        orders += _VariableOrder(problem, v, timeline, tolerance).orders()
    return orders


def _own_orders(i: int, *, one: bool) -> list[HappeningOrder]:
    """The order of start and end of an activity that could last: one happening stays one, two stay
    two.
    """
    start, end = Happening(i, False), Happening(i, True)
    if one:
        return [HappeningOrder(start, end, strict=False), HappeningOrder(end, start, strict=False)]
    return [HappeningOrder(start, end, strict=True)]


def _add_activity(
    timelines: list[_Timeline], i: int, activity: Activity, decision: Decision
) -> None:
    one = is_one_happening(activity, decision)
    start_key = (decision.start, decision.rank)
    start = (start_key, Happening(i, False))
    end = start if one else ((decision.end, decision.end_rank), Happening(i, True))
    for var, value, at in activity.details.conditions:
        if one or at == "start":
            timelines[var].reads.append(_Access(*start, value))
        elif at == "end":
            timelines[var].reads.append(_Access(*end, value))
        else:
            timelines[var].holds.append(_Hold(start, end, value))
    for var, value, at_end in activity.details.effects:
        key, happening = end if at_end else start
        timelines[var].writes.append(_Access(key, happening, value))
        timelines[var].takings += [
            _Taking(key, happening, Happening(p.activity, True), p.value)
            for p in activity.details.protects
            if p.var == var and p.value != value
        ]


class _VariableOrder:
    """One variable's writes in order, and the demands of reads and holds on them."""

    def __init__(
        self, problem: Problem, v: int, timeline: _Timeline, tolerance: Fraction | int
    ) -> None:
        self.problem, self.variable = problem, problem.variables[v]
        self.timeline, self.tolerance = timeline, tolerance
        self.writes = sorted(set(timeline.writes))
        self.keys = [write.key for write in self.writes]
        self.changes = self._next_changes()

    def _next_changes(self) -> list[int]:
        """For each write, the next one that gives another value (last: for the initial value)."""
        values = [write.value for write in self.writes]
        following = [len(values)] * (len(values) + 1)
        for k in range(len(values) - 2, -1, -1):
            following[k] = following[k + 1] if values[k] == values[k + 1] else k + 1
        if values:
            following[-1] = following[0] if values[0] == self.variable.initial else 0
        return following

    def orders(self) -> Iterator[HappeningOrder]:
        for before, after in zip(self.writes, self.writes[1:], strict=False):
            yield from between(before.happening, after.happening, strict=True)
        for read in self.timeline.reads:
            yield from self._read(read)
        for hold in self.timeline.holds:
            yield from self._hold(hold)
        for taking in self.timeline.takings:
            if self._before(taking.key) == taking.value:
                yield from between(taking.closing, taking.happening, strict=False)

    def _before(self, key: Key) -> int:
        """The value just before a time and rank."""
        last = bisect_left(self.keys, key) - 1
        return self.writes[last].value if last >= 0 else self.variable.initial

    def _read(self, read: _Access) -> Iterator[HappeningOrder]:
        giver = self._giver(bisect_left(self.keys, read.key) - 1, read)
        if giver >= 0:
            yield from between(self.writes[giver].happening, read.happening, strict=True)
        if giver + 1 < len(self.writes):
            yield from between(read.happening, self.writes[giver + 1].happening, strict=True)

    def _hold(self, hold: _Hold) -> Iterator[HappeningOrder]:
        key, opening = hold.opening
        giver = self._giver(bisect_right(self.keys, key) - 1, _Access(key, opening, hold.value))
        if giver >= 0:
            yield from between(self.writes[giver].happening, opening, strict=False)
        change = self.changes[giver]
        if change == len(self.writes):
            return
        key, closing = hold.closing
        breaking = self.writes[change]
        if breaking.key < key and breaking.key[0] < key[0] - self.tolerance:
            raise AnswerError(
                f"{self._name(opening)} needs one value of {self.variable.id!r} throughout, "
                f"which {self._name(breaking.happening)} changes in between"
            )
        yield from between(closing, breaking.happening, strict=False)

    def _giver(self, last: int, need: _Access) -> int:
        """The write that gives the needed value: the last one before it, -1 for the initial value.

        Failing that, the next one that gives it within the tolerance.
        """
        value = self.writes[last].value if last >= 0 else self.variable.initial
        if value == need.value:
            return last
        for k in range(last + 1, len(self.writes)):
            write = self.writes[k]
            if write.key[0] > need.key[0] + self.tolerance:
                break
            if write.value == need.value and write.happening.activity != need.happening.activity:
                return k
        raise AnswerError(
            f"{self._name(need.happening)} needs a value of {self.variable.id!r} "
            "that it does not have then"
        )

    def _name(self, happening: Happening) -> str:
        return repr(self.problem.activities[happening.activity].id)


def between(before: Happening, after: Happening, *, strict: bool) -> Iterator[HappeningOrder]:
    """The order of happenings of two activities; the duration orders those of one activity."""
    if before.activity != after.activity:
        yield HappeningOrder(before, after, strict)
