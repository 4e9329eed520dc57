"""State in re-timing: which happening comes before which, so that every value stays as it was.

The happenings that touch a variable come in the decisions' order of (time, rank):

- its writes keep their order;
- a read stays after the write that gave it its value and before the next write;
- a hold opens no earlier than the write that gave it its value, and closes no later than the next
  write of *another* value; equal ranks will do for both, since it holds from just after its opening
  to just before its closing. What gives the same value again may come and go in between.

These neighbours are enough: all else follows from them, so their number is linear.
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


class Order(NamedTuple):
    """`before` is no later than `after`; where their times are equal its rank is no higher, and
    lower if the order is `strict`."""

    before: Happening
    after: Happening
    strict: bool


Key = tuple[Moment, int]
"""When a happening takes place: its time and its rank."""


class _Access(NamedTuple):
    key: Key
    happening: Happening
    value: int


class _Hold(NamedTuple):
    opening: tuple[Key, Happening]
    closing: tuple[Key, Happening]
    value: int


@dataclass(slots=True)
class _Story:
    """All that touches one variable."""

    reads: list[_Access] = field(default_factory=list)
    writes: list[_Access] = field(default_factory=list)
    holds: list[_Hold] = field(default_factory=list)


def is_one_happening(activity: Activity, decision: Decision) -> bool:
    """Whether the activity starts and ends at one time and rank, so all it does happens at once."""
    if activity.is_fixed:
        return not activity.duration_max
    return (decision.end, decision.end_rank) <= (decision.start, decision.rank)


def state_orders(
    problem: Problem, decisions: Sequence[Decision], tolerance: Fraction | int
) -> list[Order]:
    """What must stay in order because of state.

    A value that a write gives within `tolerance` after it is needed counts as given in time.
    Raises `AnswerError` where what the decisions say leaves a condition without its value.
    """
    orders: list[Order] = []
    stories = [_Story() for _ in problem.variables]
    for i, (activity, decision) in enumerate(zip(problem.activities, decisions, strict=True)):
        if activity.details.conditions or activity.details.effects:
            _tell(stories, i, activity, decision)
            if not activity.is_fixed:
                orders += _own_orders(i, one=is_one_happening(activity, decision))
    for v, story in enumerate(stories):
        orders += _Reader(problem, v, story, tolerance).orders()
    return orders


def _own_orders(i: int, *, one: bool) -> list[Order]:
    """An activity that could last: one happening stays one, and two stay two."""
    start, end = Happening(i, False), Happening(i, True)
    if one:
        return [Order(start, end, strict=False), Order(end, start, strict=False)]
    return [Order(start, end, strict=True)]


def _tell(stories: list[_Story], i: int, activity: Activity, decision: Decision) -> None:
    one = is_one_happening(activity, decision)
    start_key = (decision.start, decision.rank)
    start = (start_key, Happening(i, False))
    end = start if one else ((decision.end, decision.end_rank), Happening(i, True))
    for var, value, at in activity.details.conditions:
        if one or at == "start":
            stories[var].reads.append(_Access(*start, value))
        elif at == "end":
            stories[var].reads.append(_Access(*end, value))
        else:
            stories[var].holds.append(_Hold(start, end, value))
    for var, value, at_end in activity.details.effects:
        stories[var].writes.append(_Access(*(end if at_end else start), value))


class _Reader:
    """One variable's writes in order, and what reads and holds demand of them."""

    def __init__(self, problem: Problem, v: int, story: _Story, tolerance: Fraction | int) -> None:
        self.problem, self.variable = problem, problem.variables[v]
        self.story, self.tolerance = story, tolerance
        self.writes = sorted(set(story.writes))
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

    def orders(self) -> Iterator[Order]:
        for before, after in zip(self.writes, self.writes[1:], strict=False):
            yield from _between(before.happening, after.happening, strict=True)
        for read in self.story.reads:
            yield from self._read(read)
        for hold in self.story.holds:
            yield from self._hold(hold)

    def _read(self, read: _Access) -> Iterator[Order]:
        giver = self._giver(bisect_left(self.keys, read.key) - 1, read)
        if giver >= 0:
            yield from _between(self.writes[giver].happening, read.happening, strict=True)
        if giver + 1 < len(self.writes):
            yield from _between(read.happening, self.writes[giver + 1].happening, strict=True)

    def _hold(self, hold: _Hold) -> Iterator[Order]:
        key, opening = hold.opening
        giver = self._giver(bisect_right(self.keys, key) - 1, _Access(key, opening, hold.value))
        if giver >= 0:
            yield from _between(self.writes[giver].happening, opening, strict=False)
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
        yield from _between(closing, breaking.happening, strict=False)

    def _giver(self, last: int, need: _Access) -> int:
        """The write that gives what is needed: the last one before it, -1 for the initial value.

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


def _between(before: Happening, after: Happening, *, strict: bool) -> Iterator[Order]:
    """The order of two activities' happenings; of one activity's own, its duration takes care."""
    if before.activity != after.activity:
        yield Order(before, after, strict)
