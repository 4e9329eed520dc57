"""The shortest plan over all selections of optional items, where none of them is worth anything.

A planner that must choose among groups and order their activities at once often finds nothing. So
a search tree decides which items are present, by rising lower bound on the makespan; a selection
that no bound and no unreachable value refutes goes to the planner, as a task without options.
"""

from __future__ import annotations

from heapq import heappop, heappush
from itertools import count
from typing import NamedTuple

from irc.passes import resource_bounds
from irc.passes.contention import drop_uncontended
from irc.passes.critical_path import TimesContradictError, heads_and_tails
from irc.passes.restrict import drop_ample_stock, restrict
from irc.problem import Problem
from irc.schedule import Schedule
from irc_pddl21.search.planner_session import PlannerSession, ticks, with_deadline
from irc_pddl21.search.selection import is_refuted
from irc_pddl21.search.selection_search import plan_of

MOST_ITEMS = 64
"""Tasks with more optional items are left to the planner as they are."""

SEARCH_SHARE = 0.5
"""Of the time left, for this search; the planner then gets the whole task."""


class _Node(NamedTuple):
    """A lower bound on the makespan (ticks), how many items are decided, and which are present."""

    bound: int
    open: int
    number: int
    present: frozenset[int]
    problem: Problem


def shortest_of_selections(
    session: PlannerSession, problem: Problem
) -> tuple[Schedule | None, int | None]:
    """The shortest plan found, and a lower bound on the makespan of all (None: none was proven).

    Nothing is found where the problem has no optional items, or too many of them.
    """
    items = _optional_sets(problem)
    if not items or len(items) > MOST_ITEMS or not session.planner.under_deadlines:
        return None, None
    search = _Search(session, problem, items)
    search.run()
    return search.best, search.bound


def _optional_sets(problem: Problem) -> list[tuple[int, ...]]:
    """The activities (by index) that are present together or not at all, largest sets first."""
    sets = [g.members for g in problem.groups if not g.required]
    grouped = {i for members in sets for i in members}
    activities = enumerate(problem.activities)
    sets += [(i,) for i, a in activities if a.details.optional and i not in grouped]
    return sorted(sets, key=lambda members: (-len(members), members))


class _Search:
    """The open nodes, the best plan, and the least bound of what was given up unproven."""

    def __init__(
        self, session: PlannerSession, problem: Problem, items: list[tuple[int, ...]]
    ) -> None:
        self.session, self.problem, self.items = session, problem, items
        self.budget = session.budget.share(SEARCH_SHARE)
        self.best: Schedule | None = None
        self.bound: int | None = None
        self._missed: list[int] = []
        self._count = count()
        self._heap: list[_Node] = []

    @property
    def _shortest(self) -> int | None:
        return None if self.best is None else ticks(self.problem, self.best)

    def run(self) -> None:
        """Takes the nodes by rising bound until none can be shorter than the best plan."""
        self._push(frozenset(), 0)
        while self._heap:
            node = self._heap[0]
            self.bound = min([node.bound, *self._missed])
            shortest = self._shortest
            if self.budget.is_over or (shortest is not None and node.bound >= shortest):
                break
            heappop(self._heap)
            if node.open:
                decided = len(self.items) - node.open
                self._push(node.present, decided + 1)
                self._push(node.present | {decided}, decided + 1)
            else:
                self._plan(node)
        known = [node.bound for node in self._heap[:1]] + self._missed
        known += [] if self._shortest is None else [self._shortest]
        self.bound = min(known, default=None)

    def _push(self, present: frozenset[int], decided: int) -> None:
        """Adds a node unless it is refuted."""
        chosen = {i for k in present for i in self.items[k]}
        absent = {i for k in range(decided) if k not in present for i in self.items[k]}
        problem = drop_uncontended(drop_ample_stock(restrict(self.problem, chosen, absent)))
        try:
            problem = heads_and_tails(problem)
        except TimesContradictError:
            return
        if is_refuted(problem, thoroughly=False):
            return
        problem = resource_bounds(problem)
        bound, latest = problem.bounds.makespan.value, problem.deadline
        if latest is None or bound <= latest:
            left = len(self.items) - decided
            heappush(self._heap, _Node(bound, left, next(self._count), present, problem))

    def _plan(self, node: _Node) -> None:
        """Asks for plans of one selection: as short as its bound, then shorter than the best."""
        plan = plan_of(self.session, with_deadline(node.problem, node.bound))
        while plan is None or ticks(self.problem, plan) > node.bound:
            shortest = self._shortest
            if self.budget.is_over:
                plan = None
            elif shortest is None:
                plan = plan_of(self.session, node.problem)
            else:
                plan = plan_of(self.session, with_deadline(node.problem, shortest - 1))
            if plan is None:
                self._missed.append(node.bound)
                return
            self._keep(plan)
        self._keep(plan)

    def _keep(self, plan: Schedule) -> None:
        shortest = self._shortest
        if shortest is None or ticks(self.problem, plan) < shortest:
            self.best = plan
