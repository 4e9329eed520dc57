"""A good selection of optional items, before any plan is asked for: greedily, with exchanges.

Items are added by falling value, then exchanged while that adds value, again and again from the
best selection with a few items lost (iterated local search; Lourenço, Martin, Stützle, 2003).
Selections are judged by bounds and by the list schedule.
"""

from __future__ import annotations

import random
from collections.abc import Iterator

from irc.passes.serial_sgs import quick_makespan
from irc_pddl21.search.planner_session import PlannerSession
from irc_pddl21.search.selection import Selection, SelectionSpace, is_refuted

LOCAL_SEARCH_SHARE = 0.2
"""Of the time left, for finding a good selection before the first plan is asked for."""

RESTARTS = 200
"""The greatest number of restarts."""

LOST = 3
"""The greatest number of items that a restart drops, to be replaced in another order."""


def good_selection(session: PlannerSession, space: SelectionSpace, bound: int | None) -> Selection:
    """A good selection; one whose value is `bound` ends the search."""
    search = _LocalSearch(session, space)
    everything = range(len(space.items))
    rng = random.Random(session.options.seed)
    best = search.improved(frozenset(), list(everything))
    for _ in range(RESTARTS):
        if search.is_over or space.value(best) == bound:
            break
        lost = rng.sample(sorted(best), min(len(best), rng.randint(1, LOST)))
        order = sorted(everything, key=lambda k: (k in lost, rng.random()))
        other = search.improved(best - frozenset(lost), order)
        if space.value(other) >= space.value(best):
            best = other
    return space.canonical(best)


class _LocalSearch:
    """Improves selections until its share of the time is spent."""

    def __init__(self, session: PlannerSession, space: SelectionSpace) -> None:
        self.session, self.space = session, space
        self.budget = session.budget.share(LOCAL_SEARCH_SHARE)
        self.plausibility = _Plausibility(space)

    @property
    def is_over(self) -> bool:
        """Whether the time is spent."""
        return self.budget.is_over

    def improved(self, chosen: Selection, order: list[int]) -> Selection:
        """The selection with all items it can have, in this order, and then with exchanges."""
        for k in order:
            if k not in chosen and self.space.items[k].value > 0:
                if self.is_over:
                    return chosen
                if self.plausibility.holds(chosen | {k}):
                    chosen |= {k}
        improved = True
        while improved and not self.is_over:
            improved = False
            for other in self._exchanges(chosen):
                if self.is_over:
                    break
                if self.plausibility.holds(other):
                    chosen, improved = other, True
                    break
        return chosen

    def _exchanges(self, chosen: Selection) -> Iterator[Selection]:
        """Selections near this one of greater value: one or two in for at most one out."""
        value = self.space.value
        outside = [k for k in range(len(self.space.items)) if k not in chosen]
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


class _Plausibility:
    """Remembers which selections seem to have a plan.

    No bound is against them, and a list schedule, where one can be made, keeps the deadline.
    """

    def __init__(self, space: SelectionSpace) -> None:
        self.space = space
        self._known: dict[Selection, bool] = {}

    def holds(self, chosen: Selection) -> bool:
        """Whether a selection seems to have a plan."""
        chosen = self.space.canonical(chosen)
        if chosen not in self._known:
            self._known[chosen] = self._judge(chosen)
        return self._known[chosen]

    def _judge(self, chosen: Selection) -> bool:
        if self.space.upper_bound(chosen, frozenset()) is None:
            return False
        problem = self.space.restricted(chosen)
        if problem is None or is_refuted(problem, thoroughly=False):
            return False
        return not problem.is_plain or quick_makespan(problem) is not None
