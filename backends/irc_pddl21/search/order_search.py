"""Plans that follow orders: the best orders first, until no other can be better.

Planners lose their way among set-ups, and no metric of theirs is a proof. But they soon find a plan
whose sequences are given. So partial orders are taken by rising bound (best-first search; Hart,
Nilsson and Raphael 1968), and the planner is asked for a plan of each whole order. A plan that
meets the bound of all orders that are left is the best.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from heapq import heappop, heappush
from itertools import count

from irc.model.objectives import TIMES, is_sum, terms_of
from irc.passes.critical_path import TimesContradictError, heads_and_tails
from irc.passes.setup_schedule import search_of
from irc.problem import Problem
from irc.problem.decisions import Decision
from irc.problem.objective_values import schedule_values
from irc.schedule import Schedule
from irc.targets import Budget
from irc_pddl21.search.dates import DATED, dues_of
from irc_pddl21.search.makespan import STEP_SECONDS
from irc_pddl21.search.neighbourhood import Places, near
from irc_pddl21.search.orders import Bounds, Decided, OrderSpace
from irc_pddl21.search.planner_session import PlannerSession, with_deadline
from irc_pddl21.search.selection_search import plan_of

HINT_SHARE = 0.1
HINT_SECONDS = 2.0
"""For the search for a list schedule whose sequences to follow; of the time left, and seconds."""

FOLLOW_SHARE = 0.25
"""Of the time left, for a plan that follows the list schedule, in each kind of search."""

MOST_NODES = 20_000
"""The greatest number of partial orders that are kept."""


class OrderSearch:
    """The plan of the best orders; no plan is better than `bounds` (None: that is not known)."""

    def __init__(self, session: PlannerSession, problem: Problem, budget: Budget) -> None:
        self.session, self.problem, self.budget = session, problem, budget
        self.space = OrderSpace(problem)
        self.bounds: Bounds | None = None
        self._missed: list[Bounds] = []
        self._count = count()
        self._heap: list[tuple[Bounds, int, int, Decided]] = []

    @property
    def value(self) -> Bounds | None:
        """The values of the best plan of the session, in the order of the objectives."""
        best = self.session.best
        return None if best is None else whole_values(self.session.problem, best)

    @property
    def is_over(self) -> bool:
        """Whether time is over, or no plan can be better than the best one."""
        return self.session.is_over or self.budget.is_over or self.is_proven

    @property
    def is_proven(self) -> bool:
        """Whether the best plan meets the bounds."""
        value = self.value
        return value is not None and self.bounds is not None and value <= self.bounds

    def run(self) -> None:
        """Follows a list schedule, then the order that seems best, then all by rising bound."""
        root = self.space.decided(self.space.root)
        if root is None:
            return
        if self.space.has_bounds:
            self.bounds = root.bounds
        if self.session.tactics.hint:
            self._follow_list_schedule()
        if not self.is_over:
            self._dive(root)
        self._push(root)
        self.go_on(self.budget)

    def go_on(self, budget: Budget) -> None:
        """Takes the orders that are left within a budget."""
        self.budget = budget
        while self._heap and not self.is_over and len(self._heap) < MOST_NODES:
            decided = heappop(self._heap)[-1]
            children = list(self._children(decided))
            if children or not self._is_leaf(decided):
                for child in children:
                    self._push(child)
            else:
                self._plan(decided)
            self._raise_bounds()

    def _raise_bounds(self) -> None:
        """The least that the orders which are left can have."""
        known = [self._heap[0][0]] if self._heap else []
        value = self.value
        known += [*self._missed, *([] if value is None else [value])]
        if self.bounds is not None and known:
            self.bounds = max(self.bounds, min(known))

    def _push(self, decided: Decided) -> None:
        value = self.value
        if value is None or decided.bounds < value:
            key = (decided.bounds, -decided.orders.depth, next(self._count), decided)
            heappush(self._heap, key)

    def _children(self, decided: Decided) -> Iterator[Decided]:
        for orders in self.space.children(decided):
            child = self.space.decided(orders)
            if child is not None:
                yield child

    def _is_leaf(self, decided: Decided) -> bool:
        return next(self.space.children(decided), None) is None

    def _dive(self, decided: Decided) -> None:
        """Asks for a plan of the order that is reached by always taking the best next decision."""
        while not self._is_leaf(decided) and not self.budget.is_over:
            found = min(self._children(decided), key=lambda d: d.bounds, default=None)
            if found is None:
                return
            decided = found
        if not self.budget.is_over:
            self._ask(decided)

    def _plan(self, decided: Decided) -> None:
        """Asks for a plan of whole orders; bounds of orders whose plan is not as good stay open."""
        plan = self._ask(decided)
        if plan is None or whole_values(self.session.problem, plan) > decided.bounds:
            self._missed.append(decided.bounds)

    def _ask(self, decided: Decided) -> Schedule | None:
        """A plan of whole orders, if possible one as good as their bounds."""
        problem = followed(self.problem, decided)
        if problem is None:
            return None
        plan = plan_of(self.session, with_latest_ends(self.problem, problem, decided))
        # (The least times know nothing of open times, so that they may be too early for any plan.)
        if plan is None and self.problem.has_calendars:
            return self._follow(problem)
        if plan is None and self.session.best is None:
            return plan_of(self.session, problem)
        return plan

    def _follow_list_schedule(self) -> None:
        """Asks for a plan with the sequences of a good list schedule."""
        search = search_of(self.problem)
        if search is None:
            return
        budget = self.budget.share(HINT_SHARE).at_most(HINT_SECONDS)
        search.improve(1_000_000, lambda: budget.is_over)
        if search.found is None:
            return
        decided = self.space.decided(self.space.orders_in(*search.found))
        if decided is None:
            return
        places = dict(enumerate(zip(*search.found, strict=True)))
        problem = followed(self.problem, decided, places)
        if problem is None:
            return
        self._follow(problem)

    def _follow(self, problem: Problem) -> Schedule | None:
        """A plan of a problem whose orders are given, asked for in each kind of search."""
        for kind in self.session.planner.searches:
            seconds = max(STEP_SECONDS, FOLLOW_SHARE * self.budget.left)
            plan = (
                None if self.is_over else self.session.ask(problem, seconds, enough=0, search=kind)
            )
            if plan is not None:
                return plan
        return None


def whole_values(problem: Problem, schedule: Schedule) -> Bounds:
    """The values of a schedule in whole numbers, in the order of the objectives."""
    values = schedule_values(problem, schedule)
    found = []
    for name in problem.objectives:
        value = Fraction(values[name])
        if is_sum(name):
            value *= problem.tick.denominator
        elif name in TIMES:
            value /= problem.tick
        found.append(-int(value) if name == "reward" else int(value))
    return tuple(found)


def followed(whole: Problem, decided: Decided, known: Places | None = None) -> Problem | None:
    """The problem whose sequences are decided, for a planner; None where its times contradict.

    Set-ups of these sequences are lags. All orders of some `known` places (or of the least times,
    where nothing is overfull at them) are kept as well.
    """
    problem, orders = decided.problem, decided.orders
    pools = problem.contention.pools
    sequenced = {pools[r].members[0] for r in orders.sequences}
    resources = tuple(
        replace(resource, setups=None) if k in sequenced else resource
        for k, resource in enumerate(problem.resources)
    )
    problem = replace(problem, resources=resources, objectives=("makespan",))
    places = _places(whole, decided) if known is None else known
    if places:
        activities, kept_places = list(problem.activities), {}
        for k, (decision, choice) in places.items():
            # (A choice that is not the only one there was is part of the plan.)
            demands = {d.use: d for d in whole.activities[decided.kept[k]].open_demands}
            own = activities[k].open_demands
            taken = dict(
                zip(demands if known is not None else (d.use for d in own), choice, strict=True)
            )
            activities[k] = replace(activities[k], open_demands=tuple(demands[d.use] for d in own))
            kept_places[k] = decision, tuple(taken[d.use] for d in own)
        problem = near(replace(problem, activities=tuple(activities)), kept_places, frozenset())
    try:
        return heads_and_tails(problem)
    except TimesContradictError:
        return None


def _places(whole: Problem, decided: Decided) -> Places:
    """The least times of activities with one way to be carried out; none where any overlap."""
    problem, times = decided.problem, decided.times
    if decided.overlapping or problem.has_state or problem.has_work or problem.reservoirs:
        return {}
    found = {}
    for k, activity in enumerate(problem.activities):
        i = decided.kept[k]
        if i not in times.start or activity.details.repeats is not None or activity.details.modes:
            continue
        if any(len(demand.alternatives) > 1 for demand in activity.open_demands):
            continue
        if activity.open_demands and not activity.duration_min:
            return {}
        choice = tuple(demand.alternatives[0] for demand in activity.open_demands)
        found[k] = Decision(times.start[i], times.end[i]), choice
    return found


def with_latest_ends(whole: Problem, problem: Problem, decided: Decided) -> Problem:
    """The problem in which nothing that counts in the objectives ends later than it must."""
    parts = {part for name in whole.objectives for _, part in terms_of(name)}
    times, activities = decided.times, list(problem.activities)
    place = {i: k for k, i in enumerate(decided.kept)}
    for due in dues_of(whole) if parts & DATED else ():
        if all(i in times.end for i in due.members):
            latest = max(due.due, *(times.end[i] for i in due.members))
            for k in (place[i] for i in due.members):
                own = activities[k].deadline
                soonest = latest if own is None else min(own, latest)
                activities[k] = replace(activities[k], deadline=soonest)
    problem = replace(problem, activities=tuple(activities))
    return with_deadline(problem, decided.makespan) if "makespan" in parts else problem
