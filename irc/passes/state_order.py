"""Turns state that only orders activities into precedence.

Where each value of a variable comes from one place and the changes follow from each other, its
conditions and effects order activities: "cut" gives the value that "fry" needs, so "fry" starts
after "cut" has ended. Solvers are far better at precedence than at state.

Ranks stay possible. The orders taken are of the type finish-start alone, and together with the
problem's own arcs (then finish-start too, without negative lags) they have no cycle: ranks that
grow along them satisfy every order and every interference at once, whatever the times
(docs/semantics.md, rule 6).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from irc.problem import Arc, Problem
from irc.problem.projection import restricted

ACTIVITY_LIMIT = 4_000
"""Reachability is kept in bit sets of this size at most (size²/8 bytes)."""


def order_from_state(problem: Problem) -> Problem:
    """The problem with arcs (and `state_precedences`) instead of variables that only order."""
    if not problem.variables or len(problem.activities) > ACTIVITY_LIMIT:
        return problem
    if not all(a.from_end and not a.to_end and a.min_lag >= 0 for a in problem.arcs):
        return problem
    order = _KnownOrder(problem)
    if not order.is_acyclic():
        return problem
    index = _Index(problem)
    found = [(v, _orders(index, v)) for v in range(len(problem.variables))]
    gone = order.with_most_of([(v, pairs) for v, pairs in found if pairs is not None])
    return _without(problem, gone, order.added) if gone else problem


@dataclass(frozen=True, slots=True)
class _Touch:
    """A condition on a variable, or an effect: its activity, value and point."""

    activity: int
    value: int
    at: str


class _Index:
    """The conditions and effects of each variable, and the optional group of each activity."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self.effects: list[list[_Touch]] = [[] for _ in problem.variables]
        self.conditions: list[list[_Touch]] = [[] for _ in problem.variables]
        self.goals: list[set[int]] = [set() for _ in problem.variables]
        self.by_mode: set[int] = set()
        """The variables that some mode alone reads or changes."""
        for i, activity in enumerate(problem.activities):
            for e in activity.details.effects:
                self.effects[e.var].append(_Touch(i, e.value, "end" if e.at_end else "start"))
            for c in activity.details.conditions:
                self.conditions[c.var].append(_Touch(i, c.value, c.at))
            for mode in activity.details.modes:
                self.by_mode |= {c.var for c in mode.conditions} | {e.var for e in mode.effects}
        for v, value in problem.goals:
            self.goals[v].add(value)
        self.chooser = {
            i: k
            for k, group in enumerate(problem.groups)
            if not group.required
            for i in group.members
        }


def _orders(index: _Index, v: int) -> set[tuple[int, int]] | None:
    """The demands of a variable as pairs: a ends before b starts. None where it demands more."""
    problem = index.problem
    effects, conditions = index.effects[v], index.conditions[v]
    touching = {t.activity for t in (*effects, *conditions)}
    if v in index.by_mode or not _same_presence(index, touching):
        return None
    if index.goals[v] and any(problem.activities[i].details.optional for i in touching):
        return None  # The goal also says which activity must be present.
    if any(e.at == "start" for e in effects):
        return None
    if len({e.activity for e in effects}) < len(effects):
        return None
    if {t.activity for t in conditions} - {t.activity for t in conditions if t.at != "end"}:
        return None  # Needed only when it ends, a value may be given while the reader runs.
    if problem.variables[v].changes:
        return None
    initial = problem.variables[v].initial
    given = [initial, *(e.value for e in effects)]
    if len(set(given)) < len(given):
        return None
    source: dict[int, int | None] = {e.value: e.activity for e in effects}
    source[initial] = None
    line = _line(effects, conditions, source)
    if line is None:
        return None
    return _pairs(index.goals[v], line, conditions, source)


def _same_presence(index: _Index, touching: set[int]) -> bool:
    """Whether all are present in every schedule, or all by the choice of one group."""
    details = {i: index.problem.activities[i].details for i in touching}
    if any(d.repeats is not None for d in details.values()):
        return False
    optional = {i for i in touching if details[i].optional}
    if not optional:
        return True
    choosers = {index.chooser.get(i) for i in touching}
    return touching == optional and len(choosers) == 1 and None not in choosers


def _line(
    effects: list[_Touch], conditions: list[_Touch], source: dict[int, int | None]
) -> list[_Touch] | None:
    """The effects in the only order in which each changer finds the value that it needs.

    Each changer must itself need a value, the one that the previous effect gave.
    """
    needs: dict[int, set[int]] = {}
    for condition in conditions:
        needs.setdefault(condition.activity, set()).add(condition.value)
    follower: dict[int | None, _Touch] = {}
    for effect in effects:
        needed = needs.get(effect.activity, set())
        if len(needed) != 1 or (value := next(iter(needed))) not in source:
            return None
        if source[value] in follower:
            return None
        follower[source[value]] = effect
    line: list[_Touch] = []
    at: int | None = None
    while at in follower:
        line.append(follower[at])
        at = line[-1].activity
    return line if len(line) == len(effects) else None


def _pairs(
    goals: set[int],
    line: list[_Touch],
    conditions: list[_Touch],
    source: dict[int, int | None],
) -> set[tuple[int, int]] | None:
    """Pairs of a value's source and its readers, and of readers and the next change.

    A reader that is not the next changer must have ended before that one starts only where both
    are so ordered by finish-start; the next change takes effect at its changer's *end*, so a
    reader may overlap it. Such an order is not finish-start: then the variable stays.
    """
    next_changer: dict[int | None, int] = {}
    before: int | None = None
    for effect in line:
        next_changer[before] = effect.activity
        before = effect.activity
    if any(goal not in source or source[goal] != before for goal in goals):
        return None
    pairs: set[tuple[int, int]] = set()
    for condition in conditions:
        if condition.value not in source:
            return None
        giver = source[condition.value]
        reader = condition.activity
        if giver == reader:
            return None
        if giver is not None:
            pairs.add((giver, reader))
        changer = next_changer.get(giver)
        if changer is not None and changer != reader:
            return None
    return pairs


class _KnownOrder:
    """The known orders: which activity ends before which starts."""

    def __init__(self, problem: Problem) -> None:
        self.size = len(problem.activities)
        self.following: list[set[int]] = [set() for _ in range(self.size)]
        for arc in problem.arcs:
            self.following[arc.before].add(arc.after)
        self.added: set[tuple[int, int]] = set()

    def is_acyclic(self) -> bool:
        waiting = [0] * self.size
        for following in self.following:
            for b in following:
                waiting[b] += 1
        ready = [i for i, count in enumerate(waiting) if not count]
        done = 0
        while ready:
            done += 1
            for b in self.following[ready.pop()]:
                waiting[b] -= 1
                if not waiting[b]:
                    ready.append(b)
        return done == self.size

    def with_most_of(self, found: Sequence[tuple[int, set[tuple[int, int]]]]) -> set[int]:
        """Adds the pairs of each variable that close no cycle; returns those variables.

        All at once where that is possible, else half by half.
        """
        if not found:
            return set()
        if self.with_pairs({pair for _, pairs in found for pair in pairs}):
            return {v for v, _ in found}
        if len(found) == 1:
            return set()
        half = len(found) // 2
        return self.with_most_of(found[:half]) | self.with_most_of(found[half:])

    def with_pairs(self, pairs: set[tuple[int, int]]) -> bool:
        """Adds pairs if they make no cycle."""
        fresh = [(a, b) for a, b in pairs if b not in self.following[a]]
        for a, b in fresh:
            self.following[a].add(b)
        if self.is_acyclic():
            self.added |= pairs
            return True
        for a, b in fresh:
            self.following[a].discard(b)
        return False


def _without(problem: Problem, gone: set[int], pairs: set[tuple[int, int]]) -> Problem:
    """The problem with precedences instead of some variables."""
    kept = (v for v in range(len(problem.variables)) if v not in gone)
    known = {(a.before, a.after) for a in problem.arcs}
    added = (Arc(a, b, origin=-1) for a, b in sorted(pairs) if (a, b) not in known)
    smaller, _ = restricted(problem, variables=kept)
    return replace(smaller, arcs=(*problem.arcs, *added), state_precedences=tuple(sorted(pairs)))
