"""Rewards and costs: which choice of optional things to plan for.

Planners cannot maximise a reward (kairos answers 0, OPTIC crashes), but they find plans of what
must be there quickly. So choices of items are tried by falling value: each is refuted by a bound
or handed to the planner as a task in which the chosen items are mandatory and the others absent.
The first plan is then optimal if each better choice was refuted. Since that may take long, a good
choice is found first: greedily, with exchanges, judged by bounds and by the list schedule.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import replace
from heapq import heappop, heappush
from itertools import count

from irc.passes import resource_bounds
from irc.passes.serial_sgs import quick_makespan
from irc.problem import Problem
from irc.schedule import Schedule
from irc_pddl21.hints import hint, hinted_makespan
from irc_pddl21.neighbourhood import Known, near, neighbourhoods
from irc_pddl21.selection import Selections, is_refuted
from irc_pddl21.session import Session, ticks
from irc_pddl21.shortest import shorten

Chosen = frozenset[int]

PLAN_SECONDS = 1.0
PLAN_SHARE = 0.15
"""For one plan of one choice: seconds, and of the time left."""

HINT_SECONDS = 0.3
HINT_SHARE = 0.1
"""For the search for a list schedule of one choice."""

GREEDY_SHARE = 0.2
"""Of the time left, for finding a good choice before the first plan is asked for."""

RESTARTS = 200
LOST = 3
"""So often at most a choice loses up to so many items, to be filled up in another way."""

TIES_LIMIT = 100
"""So many choices of equal value are compared by makespan; more leave it unproven."""


class RewardSearch:
    """The best choice of items for which the planner finds a plan.

    After `run`, `value` is what the best choice `chosen` is worth (None: nothing was found), and
    no choice is worth more than `bound`.
    """

    def __init__(self, session: Session, selections: Selections) -> None:
        self.session, self.selections = session, selections
        self.everything = frozenset(range(len(selections.items)))
        self.chosen: Chosen | None = None
        self.plan: Schedule | None = None
        self.value: int | None = None
        self.bound = selections.upper_bound(frozenset(), self.everything)
        self._missed: set[Chosen] = set()
        self._nodes = _Nodes(selections)

    @property
    def is_proven(self) -> bool:
        """Whether no choice is worth more than the best one found."""
        return self.value is not None and self.value == self.bound

    def run(self) -> None:
        """Finds a good choice, then goes through all that may be better, best first."""
        chosen: Chosen | None = self._greedy()
        while chosen is not None and not self.session.is_over:
            if self._try(chosen):
                break
            chosen = self._smaller(chosen)
        for upper, leaf in self._nodes.falling():
            self.bound = max([upper, *(self.selections.value(c) for c in self._missed)])
            if self.value is not None and upper <= self.value:
                self._nodes.put_back(upper, leaf)
                break
            if self.session.is_over:
                return
            if leaf is not None and leaf != self.chosen and not self._refuted(leaf):
                self._try(leaf)
        self._settle_missed()

    def _settle_missed(self) -> None:
        """Everything has been seen, so no choice is worth more than the best one or those missed.
        The planner is asked for these once more, with all the time there is.
        """
        value = self.selections.value
        for chosen in sorted(self._missed, key=value, reverse=True):
            if self.session.is_over or (self.value is not None and value(chosen) <= self.value):
                break
            if self._refuted(chosen):
                self._missed.discard(chosen)
            elif self._try_hard(chosen):
                break
        found = self.value
        better = [value(c) for c in self._missed if found is None or value(c) > found]
        self.bound = max(better, default=found)

    def _try_hard(self, chosen: Chosen) -> bool:
        """Looks for a plan among those that differ from the (late) list schedule in places."""
        problem = self.problem_of(chosen)
        rng = random.Random(self.session.limits.seed)
        latest = problem.deadline or 0
        known = hint(problem, latest, HINT_SHARE * self.session.left, rng)
        if known is None:
            return False
        for free in neighbourhoods(known, rng):
            if self.session.is_over:
                return False
            asked = near(problem, known, free)
            plan = self.session.ask(asked, PLAN_SECONDS, enough=problem.bound.value)
            if plan is not None:
                self.chosen, self.plan, self.value = chosen, plan, self.selections.value(chosen)
                return True
        return False

    def ties(self) -> Iterator[Chosen | None]:
        """The other choices that are worth the same; None where time or patience ran out."""
        # Those that the planner missed were seen before: they may be shorter all the same.
        missed = [c for c in self._missed if self.selections.value(c) == self.value]
        yield from sorted(missed, key=sorted)
        found = len(missed)
        for upper, leaf in self._nodes.falling():
            if self.value is None or upper < self.value:
                return
            if self.session.is_over or found > TIES_LIMIT:
                yield None
                return
            if leaf is not None and leaf != self.chosen and leaf not in self._missed:
                found += 1
                yield leaf

    def problem_of(self, chosen: Chosen) -> Problem:
        """The problem of a choice, with the best bound there is."""
        return resource_bounds(self.selections.restricted(chosen))

    def _refuted(self, chosen: Chosen) -> bool:
        return is_refuted(self.selections.restricted(chosen), thoroughly=True)

    def _try(self, chosen: Chosen) -> bool:
        """Whether the planner finds a plan of a choice; the best choice is kept."""
        plan = plan_of(self.session, self.problem_of(chosen))
        if plan is None:
            self._missed.add(chosen)
            return False
        value = self.selections.value(chosen)
        if self.value is None or value > self.value:
            self.chosen, self.plan, self.value = chosen, plan, value
        return True

    def _smaller(self, chosen: Chosen) -> Chosen | None:
        """Without the item that is worth least."""
        return chosen - {max(chosen)} if chosen else None

    def _greedy(self) -> Chosen:
        """A good choice: items by falling value, then exchanges that add value, again and again
        from the best with a few items lost (iterated local search; Lourenço, Martin, Stützle,
        2003).
        """
        until = self.session.left * (1 - GREEDY_SHARE)
        promising = _Promising(self.selections)
        rng = random.Random(self.session.limits.seed)
        best = self._climb(frozenset(), list(self.everything), promising, until)
        value = self.selections.value
        for _ in range(RESTARTS):
            if self.session.left <= until or value(best) == self.bound:
                break
            lost = rng.sample(sorted(best), min(len(best), rng.randint(1, LOST)))
            order = sorted(self.everything, key=lambda k: (k in lost, rng.random()))
            other = self._climb(best - frozenset(lost), order, promising, until)
            if value(other) >= value(best):
                best = other
        return best

    def _climb(
        self, chosen: Chosen, order: list[int], promising: _Promising, until: float
    ) -> Chosen:
        """Adds what it can in this order, then exchanges while that adds value."""
        for k in order:
            if k not in chosen and self.selections.items[k].value > 0:
                if self.session.left <= until:
                    return chosen
                if promising.is_so(chosen | {k}):
                    chosen |= {k}
        improved = True
        while improved and self.session.left > until:
            improved = False
            for other in self._exchanges(chosen):
                if self.session.left <= until:
                    break
                if promising.is_so(other):
                    chosen, improved = other, True
                    break
        return chosen

    def _by_value(self) -> range:
        return range(len(self.selections.items))

    def _exchanges(self, chosen: Chosen) -> Iterator[Chosen]:
        """Choices near this one that are worth more: one or two in for at most one out."""
        value = self.selections.value
        outside = [k for k in self._by_value() if k not in chosen]
        now = value(chosen)
        for k in outside:
            if value([k]) > 0:
                yield chosen | {k}
        for gone in sorted(chosen, reverse=True):
            rest = chosen - {gone}
            for n, k in enumerate(outside):
                if value(rest) + value([k]) > now:
                    yield rest | {k}
                for other in outside[n + 1 :]:
                    if value(rest) + value([k, other]) > now:
                        yield rest | {k, other}


class _Promising:
    """Whether a choice seems to have a plan: no bound is against it, and where a list schedule
    can be made it keeps the deadline."""

    def __init__(self, selections: Selections) -> None:
        self.selections = selections
        self._known: dict[Chosen, bool] = {}

    def is_so(self, chosen: Chosen) -> bool:
        """As above; remembered."""
        if chosen not in self._known:
            self._known[chosen] = self._judge(chosen)
        return self._known[chosen]

    def _judge(self, chosen: Chosen) -> bool:
        if self.selections.upper_bound(chosen, frozenset()) is None:
            return False
        problem = self.selections.restricted(chosen)
        if is_refuted(problem, thoroughly=False):
            return False
        return not problem.is_plain or quick_makespan(problem) is not None


class _Nodes:
    """Choices by falling upper bound, decided item by item."""

    def __init__(self, selections: Selections) -> None:
        self.selections = selections
        self._count = count()
        self._heap: list[tuple[int, int, int, Chosen]] = []
        self._push(frozenset(), 0)

    def _push(self, chosen: Chosen, decided: int) -> None:
        undecided = frozenset(range(decided, len(self.selections.items)))
        upper = self.selections.upper_bound(chosen, undecided)
        if upper is not None:
            heappush(self._heap, (-upper, -decided, next(self._count), chosen))

    def put_back(self, upper: int, leaf: Chosen | None) -> None:
        """Makes the last one come again."""
        if leaf is not None:
            decided = len(self.selections.items)
            heappush(self._heap, (-upper, -decided, next(self._count), leaf))

    def falling(self) -> Iterator[tuple[int, Chosen | None]]:
        """(Upper bound of all that has not been seen, a choice or None while items are open)."""
        size = len(self.selections.items)
        while self._heap:
            upper, decided, _, chosen = heappop(self._heap)
            if -decided == size:
                yield -upper, chosen
                continue
            k = -decided
            with_it = chosen | {k}
            if not is_refuted(self.selections.restricted(with_it), thoroughly=False):
                self._push(with_it, k + 1)
            self._push(chosen, k + 1)
            yield -upper, None


def plan_of(session: Session, problem: Problem) -> Schedule | None:
    """A plan of a problem, if the planner finds one soon."""
    if not problem.activities and not problem.goals:
        nothing = Schedule((), task=problem.name)
        session.keep(nothing)
        return nothing
    latest = problem.deadline
    known: Known | None = None
    if session.tactics.hint and latest is not None:
        rng = random.Random(session.limits.seed)
        known = hint(problem, latest, min(HINT_SECONDS, HINT_SHARE * session.left), rng)
    if known is not None and latest is not None and hinted_makespan(known) <= latest:
        followed = near(problem, known, frozenset())
        plan = session.ask(followed, PLAN_SECONDS, enough=problem.bound.value)
        if plan is not None:
            return plan
    for search in session.planner.searches:
        seconds = max(PLAN_SECONDS, PLAN_SHARE * session.left) / len(session.planner.searches)
        plan = session.ask(problem, seconds, enough=problem.bound.value, search=search)
        if plan is not None:
            return plan
    return None


def shortest_of_best(session: Session, search: RewardSearch) -> tuple[Schedule, int | None]:
    """The shortest plan among the choices of the best value, and a bound on its makespan in ticks
    (None where not all of those choices were compared).
    """
    assert search.chosen is not None
    assert search.plan is not None
    problem = search.problem_of(search.chosen)
    best = shorten(session, problem, search.plan) or search.plan
    bound = problem.bound.value
    if not search.is_proven:
        return best, None
    for chosen in search.ties():
        if chosen is None:
            return best, None
        other = search.problem_of(chosen)
        if is_refuted(other, thoroughly=False) or other.bound.value >= ticks(problem, best):
            continue
        sooner = replace(other, deadline=ticks(problem, best) - 1)
        plan = shorten(session, sooner)
        if plan is not None and ticks(problem, plan) < ticks(problem, best):
            best = plan
        bound = min(bound, other.bound.value)
    return best, bound
