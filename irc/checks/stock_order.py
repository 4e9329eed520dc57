"""Proves that stock lets some required action never happen, whatever the order.

A relaxation: what has been given to a reservoir, or taken from it, counts as often as it can occur
and stays for good. So the first happening of a schedule that is out of reach even so would have had
its level out of bounds: there is no such schedule. Two swaps that could only pay each other are
found like this. O(n log n) in the changes of stock.
"""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from heapq import heappop, heappush

from irc.checks.required import greatest_occurrences, required_activities
from irc.diagnostics import Code, Diagnostic
from irc.problem import Activity, Problem

_MOST_NAMED = 4

_Level = tuple[int, int]
"""A reservoir (index), and 1 for what is given to it or -1 for what is taken."""


@dataclass
class _Happening:
    """A start, an end, or both at once, in a mode. `missing` demands keep it from happening."""

    activity: int
    mode: int
    changes: Mapping[int, int]
    times: float
    missing: int = 0
    end: _Happening | None = None
    demands: list[tuple[_Level, int]] = field(default_factory=list)


def impossible_stock(problem: Problem) -> Diagnostic | None:
    """The required actions that stock keeps from ever happening; None where none was found."""
    if not problem.reservoirs:
        return None
    late = _unreached(problem)
    required = required_activities(problem)
    late_in: dict[int, set[int]] = {}
    for h in late:
        late_in.setdefault(h.activity, set()).add(h.mode)
    ways = [len(activity.details.ways) for activity in problem.activities]
    stuck = [
        h for h in late if h.activity in required and len(late_in[h.activity]) == ways[h.activity]
    ]
    if not stuck:
        return None
    names = list(dict.fromkeys(repr(problem.activities[h.activity].id) for h in stuck))
    more = "" if len(names) <= _MOST_NAMED else f" and {len(names) - _MOST_NAMED} more"
    waiting = f"{', '.join(names[:_MOST_NAMED])}{more}"
    first = next((h for h in stuck if h.demands), stuck[0])
    return Diagnostic(
        Code.STOCK,
        f"stock lets no order of {waiting} happen: {_reason(problem, first)}",
        problem.activities[first.activity].origin,
        'another "initial", or an action that brings the first of them about, would be needed',
    )


def _reason(problem: Problem, happening: _Happening) -> str:
    (r, sign), _ = happening.demands[0]
    name, amount = problem.reservoirs[r].id, abs(happening.changes[r])
    who = repr(problem.activities[happening.activity].id)
    if sign > 0:
        return f"{who} takes {amount} of {name!r}, which can never have enough before"
    return f"{who} puts {amount} into {name!r}, which can never have room before"


def _unreached(problem: Problem) -> list[_Happening]:
    """The happenings out of reach, each with its demands that are not met."""
    happenings = [h for i, a in enumerate(problem.activities) for h in _happenings(i, a)]
    moved: dict[_Level, float] = {}
    waiting: dict[_Level, list[tuple[int, int]]] = {}
    for k, happening in enumerate(happenings):
        happening.demands = list(_demands(problem, happening))
        happening.missing += len(happening.demands)
        for level, amount in happening.demands:
            heappush(waiting.setdefault(level, []), (amount, k))
    todo = deque(h for h in happenings if not h.missing)
    reached = set(map(id, todo))
    while todo:
        happening = todo.popleft()
        freed = [] if happening.end is None else [happening.end]
        for r, amount in happening.changes.items():
            level = (r, 1 if amount > 0 else -1)
            moved[level] = moved.get(level, 0) + abs(amount) * happening.times
            heap = waiting.get(level, [])
            while heap and heap[0][0] <= moved[level]:
                freed.append(happenings[heappop(heap)[1]])
        for other in freed:
            other.missing -= 1
            if not other.missing:
                reached.add(id(other))
                todo.append(other)
    late = [h for h in happenings if id(h) not in reached]
    for happening in late:
        happening.demands = [d for d in happening.demands if d[1] > moved.get(d[0], 0)]
    return late


def _happenings(i: int, activity: Activity) -> Iterator[_Happening]:
    """The start and the end of what changes stock; without the start there is no end."""
    most = greatest_occurrences(activity)
    if not activity.details.all_stock or most == 0:
        return
    times = float("inf") if most is None else float(most)
    for mode, way in enumerate(activity.details.ways):
        start, end = Counter[int](), Counter[int]()
        for change in way.stock:
            at_end = change.at_end and activity.duration_max > 0
            (end if at_end else start)[change.reservoir] += change.amount
        last = _Happening(i, mode, _nonzero(end), times, missing=1)
        yield _Happening(i, mode, _nonzero(start), times, end=last)
        yield last


def _nonzero(changes: Counter[int]) -> dict[int, int]:
    return {r: amount for r, amount in changes.items() if amount}


def _demands(problem: Problem, happening: _Happening) -> Iterator[tuple[_Level, int]]:
    """How much must have been given to, or taken from, which reservoirs before it at least."""
    activity = problem.activities[happening.activity]
    if activity.duration_min == 0 < activity.duration_max:
        # Its two ends may be one happening, of which only the sum counts; nothing is asked.
        return
    for r, amount in happening.changes.items():
        reservoir = problem.reservoirs[r]
        level = reservoir.initial + amount
        if amount < 0 and level < reservoir.least:
            yield (r, 1), reservoir.least - level
        if amount > 0 and reservoir.greatest is not None and level > reservoir.greatest:
            yield (r, -1), level - reservoir.greatest
