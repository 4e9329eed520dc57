"""Objectives that are sums over choices: the best choices, from the best upwards.

An objective such as the cost of chosen modes is a sum with a part for each choice. A planner that
minimises such a sum answers with any plan. So a search tree decides the choices one by one, by
rising lower bound on the sum (best-first search; Hart, Nilsson and Raphael 1968); choices that no
bound refutes go to the planner, as a task without them. The first plan is optimal if all better
choices were refuted.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from heapq import heappop, heappush
from itertools import count
from typing import NamedTuple

from irc.passes import resource_bounds
from irc.passes.contention import drop_uncontended
from irc.passes.critical_path import TimesContradictError, heads_and_tails
from irc.passes.restrict import drop_ample_stock, restrict
from irc.problem import PreviousPlan, Problem
from irc.problem.objective_values import schedule_values
from irc.problem.projection import in_one_mode
from irc.schedule import Schedule
from irc_pddl21.search.planner_session import PlannerSession
from irc_pddl21.search.selection import is_refuted
from irc_pddl21.search.selection_search import plan_of

Value = tuple[int, ...]
"""One number for each objective, in order; less is better (a reward counts as its negative)."""

MOST_CHOICES = 2_000
"""Tasks with more choices are left to the planner as they are."""

WHOLE_SHARE = 0.2
"""Of the time left, for a first plan of the whole task."""


class Option(NamedTuple):
    """One way to make a choice: its value, and what it fixes."""

    value: Value
    present: tuple[int, ...] = ()
    absent: tuple[int, ...] = ()
    mode: tuple[int, int] | None = None
    """(activity, mode)."""
    deadlines: tuple[tuple[int, int], ...] = ()
    """(activity, ticks)."""


class Choice(NamedTuple):
    """Options of which one is taken; `owner`: the choice that may leave its activities out."""

    options: tuple[Option, ...]
    owner: int | None = None


@dataclass(frozen=True, slots=True)
class _Node:
    taken: tuple[Option | None, ...]
    """The option of each choice that has been decided; None where its activities are absent."""
    problem: Problem


class ChoiceSearch:
    """The plan with the least value; no plan has a smaller one than `bound` (None: not known)."""

    def __init__(
        self,
        session: PlannerSession,
        problem: Problem,
        names: tuple[str, ...],
        choices: Sequence[Choice],
        base: Value,
    ) -> None:
        """`names`: the objectives. `base`: what is added to the value of every plan."""
        self.session, self.problem, self.names = session, problem, names
        self.choices, self.base = choices, base
        self.bound: Value | None = None
        self.plan: Schedule | None = None
        self.planned: Problem | None = None
        self._missed: list[Value] = []
        self._count = count()
        self._heap: list[tuple[Value, int, int, _Node]] = []

    @property
    def value(self) -> Value | None:
        """The value of the best plan of the session."""
        best = self.session.best
        return None if best is None else self._value_of(best)

    def _value_of(self, plan: Schedule) -> Value:
        values = schedule_values(self.session.problem, plan)
        return tuple(int(-values[n] if n == "reward" else values[n]) for n in self.names)

    def run(self) -> None:
        """Takes the nodes by rising bound until none can be better than the best plan."""
        self._push(())
        if len(self._heap) == 1 and self.choices:
            whole = self._heap[0][3].problem
            self.session.ask(whole, WHOLE_SHARE * self.session.left, enough=0)
        while self._heap:
            bound, _, _, node = self._heap[0]
            self.bound = min([bound, *self._missed])
            value = self.value
            if self.session.is_over or (value is not None and value <= bound):
                break
            heappop(self._heap)
            if len(node.taken) == len(self.choices):
                self._plan(bound, node)
            else:
                self._branch(node)
        known = [bound for bound, *_ in self._heap[:1]] + self._missed
        known += [] if self.value is None else [self.value]
        self.bound = min(known, default=None)

    def _branch(self, node: _Node) -> None:
        k = len(node.taken)
        choice = self.choices[k]
        owner = None if choice.owner is None else node.taken[choice.owner]
        if choice.owner is not None and (owner is None or owner.absent):
            self._push((*node.taken, None))
            return
        for option in choice.options:
            self._push((*node.taken, option))

    def _push(self, taken: tuple[Option | None, ...]) -> None:
        """Adds a node unless it is refuted."""
        problem = narrowed(self.problem, [option for option in taken if option is not None])
        if problem is None or is_refuted(problem, thoroughly=False):
            return
        place = (self._least(taken), -len(taken), next(self._count), _Node(taken, problem))
        heappush(self._heap, place)

    def _least(self, taken: tuple[Option | None, ...]) -> Value:
        """The least value of all plans with these options."""
        total = self.base
        for k, choice in enumerate(self.choices):
            if k < len(taken):
                option = taken[k]
                total = total if option is None else _sum(total, option.value)
                continue
            least = min(option.value for option in choice.options)
            if choice.owner is not None:
                certain = choice.owner < len(taken)
                owner = taken[choice.owner] if certain else None
                if certain and (owner is None or owner.absent):
                    continue
                nothing = tuple(0 for _ in self.base)
                least = least if certain else min(least, nothing)
            total = _sum(total, least)
        return total

    def _plan(self, bound: Value, node: _Node) -> None:
        problem = resource_bounds(node.problem)
        plan = None if is_refuted(node.problem, thoroughly=True) else plan_of(self.session, problem)
        if plan is not None:
            self.plan, self.planned = plan, problem
            if self._value_of(plan) > bound:
                self._missed.append(bound)
        elif not is_refuted(node.problem, thoroughly=True):
            self._missed.append(bound)


def _sum(a: Value, b: Value) -> Value:
    return tuple(x + y for x, y in zip(a, b, strict=True))


def narrowed(problem: Problem, options: Sequence[Option]) -> Problem | None:
    """The problem in which options are taken; None where its times contradict each other."""
    modes = dict(o.mode for o in options if o.mode is not None)
    deadlines: dict[int, int] = {}
    for option in options:
        for i, at in option.deadlines:
            deadlines[i] = min(at, deadlines.get(i, at))
    problem = _with_times(problem, modes, deadlines)
    present = {i for o in options for i in o.present}
    absent = {i for o in options for i in o.absent}
    problem = drop_ample_stock(restrict(problem, present, absent))
    open_groups = tuple(group for group in problem.groups if not group.required)
    problem = replace(problem, objectives=("makespan",), groups=open_groups)
    try:
        return heads_and_tails(drop_uncontended(problem))
    except TimesContradictError:
        return None


def _with_times(
    problem: Problem, modes: Mapping[int, int], deadlines: Mapping[int, int]
) -> Problem:
    """The problem with some activities in one mode alone, and with earlier deadlines."""
    activities = list(problem.activities)
    for i, mode in modes.items():
        activities[i] = in_one_mode(activities[i], mode)
    for i, at in deadlines.items():
        own = activities[i].deadline
        activities[i] = replace(activities[i], deadline=at if own is None else min(own, at))
    return replace(problem, activities=tuple(activities), previous=PreviousPlan())
