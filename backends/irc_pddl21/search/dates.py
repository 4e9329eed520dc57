"""Objectives on due dates: deadlines in their place, tighter and tighter.

No metric of a planner says what a late end costs. But all ends in time is a task with deadlines,
which planners solve. The lateness that precedence alone forces is a bound; a plan under deadlines
that allow no more proves the best answer. Where there is none, the planner is asked to follow the
list schedule of least lateness that a search finds; then ends that are late are given deadlines a
tick earlier, one after another, while no other end gets later.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from irc.problem import Problem
from irc.problem.decisions import Decision
from irc.problem.objective_values import schedule_values
from irc.schedule import Schedule
from irc_pddl21.search.choice_search import Choice, ChoiceSearch, Option, narrowed
from irc_pddl21.search.list_schedules import Value, best_list_schedule
from irc_pddl21.search.makespan import (
    HINT_SECONDS,
    HINT_SHARE,
    STEP_SECONDS,
    STEP_SHARE,
    shorten,
)
from irc_pddl21.search.neighbourhood import near
from irc_pddl21.search.planner_session import PlannerSession, with_deadline
from irc_pddl21.search.selection import is_refuted
from irc_pddl21.search.selection_search import plan_of

DATED = frozenset(["tardiness", "tardy", "max_tardiness"])
"""Objectives that deadlines in the place of due dates can reach."""

FIRST_SHARE = 0.3
"""Of the time left, for a plan without any deadline for due dates."""

_MISSES = 3
"""After as many rounds over all late ends without a better plan the search is over."""


class Due(NamedTuple):
    """A due date (in ticks) of activities that end together, and its weight."""

    members: tuple[int, ...]
    due: int
    weight: int
    is_certain: bool
    """Whether they are present in every schedule."""


def dues_of(problem: Problem) -> list[Due]:
    """The due dates of actions and groups that have a weight."""
    found = [
        Due((i,), d.due, d.weight, _is_certain(problem, i))
        for i, activity in enumerate(problem.activities)
        for d in (activity.details,)
        if d.due is not None and d.weight
    ]
    found += [
        Due(g.members, g.due, g.weight, g.required)
        for g in problem.groups
        if g.due is not None and g.weight and g.members
    ]
    return found


def by_dates(session: PlannerSession, problem: Problem, name: str) -> dict[str, int]:
    """The bound on an objective on due dates, after a search for its least value."""
    dues = dues_of(problem)
    if name == "tardy":
        return _fewest(session, problem, dues)
    search = _LatenessSearch(session, problem, dues, name)
    search.run()
    return {name: search.bound}


def in_time(problem: Problem, latest: Mapping[Due, int]) -> Option:
    """The option that these due dates are kept by some ticks, as deadlines."""
    return Option(
        (0,), deadlines=tuple((i, max(-1, at)) for due, at in latest.items() for i in due.members)
    )


def with_common_deadline(problem: Problem) -> Problem:
    """The problem with a deadline for the whole, where the last ends have deadlines of their own.

    Bounds by resources compare the makespan with the deadline of the whole.
    """
    activities = problem.activities
    followed = {
        arc.before
        for arc in problem.arcs
        if arc.from_end and arc.min_lag >= 0 and _is_certain(problem, arc.after)
    }
    last = [activities[i].deadline for i in range(len(activities)) if i not in followed]
    known = [at for at in last if at is not None]
    if not known or len(known) < len(last):
        return problem
    return with_deadline(problem, max(known))


def _is_certain(problem: Problem, i: int) -> bool:
    details = problem.activities[i].details
    return not details.optional and details.repeats is None


def _fewest(session: PlannerSession, problem: Problem, dues: list[Due]) -> dict[str, int]:
    """The bound on the weighted number of late ends: which of them are late is a choice."""
    owners = _presence_choices(problem)
    choices = [
        Choice((Option((0,), present=members), Option((0,), absent=members)))
        for members in owners.values()
    ]
    owner_of = {i: k for k, members in enumerate(owners.values()) for i in members}
    for due in sorted(dues, key=lambda due: -due.weight):
        owner = None if due.is_certain else owner_of.get(due.members[0])
        late = Option((due.weight,))
        choices.append(Choice((in_time(problem, {due: due.due}), late), owner))
    search = ChoiceSearch(session, problem, ("tardy",), choices, (0,))
    search.run()
    return {} if search.bound is None else {"tardy": search.bound[0]}


def _presence_choices(problem: Problem) -> dict[str, tuple[int, ...]]:
    """The optional items that have due dates, by name."""
    found = {
        f"group {g.id}": g.members for g in problem.groups if not g.required and g.due is not None
    }
    grouped = {i for members in found.values() for i in members}
    for i, activity in enumerate(problem.activities):
        if activity.details.optional and activity.details.due is not None and i not in grouped:
            group = next((g for g in problem.groups if i in g.members and not g.required), None)
            members = (i,) if group is None else group.members
            found.setdefault(f"item {members[0]}", members)
    return found


class _LatenessSearch:
    """The least tardiness, summed or greatest; `bound` is in ticks."""

    def __init__(
        self, session: PlannerSession, problem: Problem, dues: list[Due], name: str
    ) -> None:
        self.session, self.problem, self.dues, self.name = session, problem, dues, name
        heads = problem.bounds.heads
        self.forced = {
            due: max(
                due.due,
                *(heads[i] + problem.activities[i].duration_min for i in due.members)
                if due.is_certain and heads
                else (due.due,),
            )
            for due in dues
        }
        self.bound = self._combined(
            due.weight * (at - due.due) for due, at in self.forced.items() if due.is_certain
        )

    def _late(self, ends: Mapping[Due, int]) -> int:
        """The lateness of ends (in ticks), with their weights."""
        return self._combined(due.weight * max(0, end - due.due) for due, end in ends.items())

    def _combined(self, late: Iterator[int]) -> int:
        return sum(late) if self.name == "tardiness" else max(late, default=0)

    def value(self) -> int | None:
        """The value of the best plan, in ticks."""
        best = self.session.best
        if best is None:
            return None
        values = schedule_values(self.session.problem, best)
        return self.session.problem.whole_ticks(values[self.name])

    @property
    def is_over(self) -> bool:
        """Whether the bound is reached, or time is over."""
        value = self.value()
        return self.session.is_over or (value is not None and value <= self.bound)

    def run(self) -> None:
        """Looks for a plan at the bound, for any plan, and for better ones."""
        if self._is_refuted(self.forced):
            self.bound = max(self.bound, self._next_bound())
        else:
            self._ask(self.forced)
        if not self.is_over and self.session.tactics.hint:
            self._follow_list_schedule()
        if self.value() is None:
            self.session.ask(self.problem, FIRST_SHARE * self.session.left, enough=0)
        if self.value() is None:
            shorten(self.session, self.problem)
        if self.name == "max_tardiness":
            self._bisect()
        misses = 0
        while not self.is_over and misses < _MISSES and self.name == "tardiness":
            misses = 0 if self._step() else misses + 1

    def _ask(self, latest: Mapping[Due, int]) -> bool:
        """Whether a plan is found that keeps these ends."""
        problem = self._within(latest)
        if problem is None or is_refuted(problem, thoroughly=True) or self.session.is_over:
            return False
        return plan_of(self.session, problem) is not None

    def _within(self, latest: Mapping[Due, int]) -> Problem | None:
        """The problem with these ends as deadlines; None where its times contradict each other."""
        problem = narrowed(self.problem, [in_time(self.problem, latest)])
        return None if problem is None else with_common_deadline(problem)

    def _is_refuted(self, latest: Mapping[Due, int]) -> bool:
        return is_refuted(self._within(latest), thoroughly=True)

    def _next_bound(self) -> int:
        """The least value where some end is later than precedence alone forces, by a tick."""
        if self.name == "tardiness":
            return self.bound + min((due.weight for due in self.dues), default=0)
        return min((d.weight * (at - d.due + 1) for d, at in self.forced.items()), default=0)

    def _follow_list_schedule(self) -> None:
        """Asks for the plan that follows the list schedule of least lateness."""

        def ends_in(decisions: Sequence[Decision]) -> dict[Due, int]:
            return {d: max(int(decisions[i].end) for i in d.members) for d in self.dues}

        def judge(decisions: Sequence[Decision]) -> Value:
            return self._late(ends_in(decisions)), max((int(d.end) for d in decisions), default=0)

        session, problem = self.session, self.problem
        enough = (self.bound, problem.bounds.makespan.value)
        budget = session.budget.share(HINT_SHARE).at_most(HINT_SECONDS)
        known = best_list_schedule(
            problem, judge, enough, budget, random.Random(session.options.seed)
        )
        if known is None:
            return
        ends = ends_in([known[i][0] for i in range(len(known))])
        value = self.value()
        if value is None or self._late(ends) < value:
            latest = {due: max(due.due, end) for due, end in ends.items()}
            asked = narrowed(near(problem, known, frozenset()), [in_time(problem, latest)])
            if asked is not None:
                session.ask(asked, max(STEP_SECONDS, STEP_SHARE * session.left), enough=0)

    def _bisect(self) -> None:
        """Halves the interval in which the greatest tardiness may be."""
        low = self.bound
        while not self.is_over:
            value = self.value()
            if value is None or low >= value:
                return
            tried = (low + value - 1) // 2
            latest = {due: due.due + tried // due.weight for due in self.dues}
            problem = self._within(latest)
            if problem is None or is_refuted(problem, thoroughly=True):
                self.bound = max(self.bound, tried + 1)
                low = tried + 1
            elif plan_of(self.session, problem) is None:
                low = tried + 1

    def _step(self) -> bool:
        """Whether some late end comes earlier while no other gets later."""
        best = self.session.best
        if best is None:
            return False
        ends = self._ends(best)
        late = [d for d in self.dues if ends.get(d, d.due) > d.due]
        before = self.value()
        for due in sorted(late, key=lambda d: -d.weight * (ends[d] - d.due)):
            if self.is_over:
                return False
            latest = {d: max(d.due, ends[d]) for d in self.dues if d in ends}
            self._ask({**latest, due: ends[due] - 1})
            if self.value() != before:
                return True
        return False

    def _ends(self, schedule: Schedule) -> dict[Due, int]:
        """When each due date is met, or missed, of what is present."""
        problem = self.session.problem
        by_id = {e.id: problem.whole_ticks(e.end) for e in schedule.entries}
        names = [a.id for a in self.problem.activities]
        return {
            due: max(by_id[names[i]] for i in due.members)
            for due in self.dues
            if all(names[i] in by_id for i in due.members)
        }
