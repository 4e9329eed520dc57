"""Checks for values that state variables can never have, in goals and conditions.

A relaxation: a variable keeps every value that it ever had (the delete relaxation of planning;
Bonet and Geffner 2001). A value that is unreachable in the relaxation is unreachable. The time is
linear in the conditions and effects of the task.
"""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from itertools import product

from irc.checks.facts import ShownFact, fact_places, goal_places, mode_fact_places
from irc.checks.required import is_ruled_out
from irc.diagnostics import Code, Findings
from irc.model import Task
from irc.model.state_values import value_text
from irc.problem import Activity, Details, Problem

Fact = tuple[int, int]
"""(variable, value), by index."""

_LONGEST_CHAIN = 4
"""A message names at most this many actions that need each other's effects."""


@dataclass
class Reach:
    """The values that can be reached at best, and the activities that can start and end."""

    facts: set[Fact]
    started: set[int] = field(default_factory=set)
    ended: set[int] = field(default_factory=set)


def reach_of(problem: Problem) -> Reach:
    """The reachable values: an activity starts once its start conditions can hold, and ends once
    all of its conditions can hold.
    """
    reach = Reach(set())
    waiting: dict[Fact, list[_Step]] = defaultdict(list)
    missing: dict[_Step, int] = {}
    ready: list[_Step] = []
    ways = [activity.details.ways for activity in problem.activities]
    for i, activity in enumerate(problem.activities):
        if is_ruled_out(activity):
            continue
        whole = activity.duration_max == 0
        for mode, to_end in product(range(len(ways[i])), (False, True)):
            step = i, mode, to_end
            needs = set(_needs(ways[i][mode], to_end, whole))
            for fact in needs:
                waiting[fact].append(step)
            # (The end waits for the start as well.)
            missing[step] = len(needs) + to_end
            if not missing[step]:
                ready.append(step)
    todo: deque[Fact] = deque()
    known = ((v, x) for v, variable in enumerate(problem.variables) for x in variable.known_values)
    _reached(reach, todo, known)
    while ready or todo:
        while ready:
            i, mode, to_end = ready.pop()
            (reach.ended if to_end else reach.started).add(i)
            _reached(reach, todo, _gives(ways[i][mode], to_end))
            if not to_end:
                _count_down(missing, (i, mode, True), ready)
        if todo:
            for step in waiting.get(todo.popleft(), ()):
                _count_down(missing, step, ready)
    return reach


_Step = tuple[int, int, bool]
"""An activity, a mode of it (0 where it has none), and whether it is the end, not the start."""


def _needs(way: Details, to_end: bool, whole: bool) -> Iterator[Fact]:
    """The values that the start of an activity needs, or those that its end needs in addition.

    The start of an activity that takes no time (`whole`) needs all of them.
    """
    for condition in way.conditions:
        if (condition.at != "start" and not whole) is to_end:
            yield condition.var, condition.value


def _gives(way: Details, at_end: bool) -> Iterator[Fact]:
    return ((e.var, e.value) for e in way.effects if e.at_end is at_end)


def _reached(reach: Reach, todo: deque[Fact], facts: Iterable[Fact]) -> None:
    for fact in facts:
        if fact not in reach.facts:
            reach.facts.add(fact)
            todo.append(fact)


def _count_down(
    missing: dict[_Step, int],
    step: _Step,
    ready: list[_Step],
) -> None:
    missing[step] -= 1
    if not missing[step]:
        ready.append(step)


def check_reach(task: Task, problem: Problem, required: frozenset[int], findings: Findings) -> None:
    """Adds goals, and conditions of required actions, that no schedule can meet."""
    reach = reach_of(problem)
    stuck = sorted(required - reach.ended)
    if stuck or any(goal not in reach.facts for goal in problem.goals):
        _Reporter(task, problem, reach, findings).report(stuck)
    _check_lost_goals(task, problem, required, findings)


class _Reporter:
    """Reports the causes of unreachable values, and not what only follows from them."""

    def __init__(self, task: Task, problem: Problem, reach: Reach, findings: Findings) -> None:
        self.task, self.problem, self.reach, self.findings = task, problem, reach, findings
        self.givers: dict[Fact, list[int]] = defaultdict(list)
        self.takers: dict[Fact, list[int]] = defaultdict(list)
        for i, activity in enumerate(problem.activities):
            for effect in activity.details.all_effects:
                self.givers[effect.var, effect.value].append(i)
            for condition in activity.details.all_conditions:
                self.takers[condition.var, condition.value].append(i)
        self.indexes = {v.id: k for k, v in enumerate(problem.variables)}
        self.values = [{(type(x), x): k for k, x in enumerate(v.values)} for v in problem.variables]
        self.explained: set[int] = set()

    def report(self, stuck: list[int]) -> None:
        """Reports first values that no effect gives, then values that only impossible actions
        give.
        """
        given_by_none: dict[Fact, list[int]] = defaultdict(list)
        for i in stuck:
            for fact in self._missing(i):
                if fact not in self.givers:
                    given_by_none[fact].append(i)
        for fact, needed_by in given_by_none.items():
            self._report_ungiven(fact, needed_by)
            for i in needed_by:
                self._explain(i)
        for i in stuck:
            missing = self._missing(i)
            if i not in self.explained and missing:
                self._report_stuck(i, missing[0])
                self._explain(i)
        for goal in goal_places(self.task):
            goal_fact = self._fact(goal)
            if goal_fact not in self.reach.facts and goal_fact not in given_by_none:
                self._report_goal(goal, goal_fact)

    def _fact(self, shown: ShownFact) -> Fact:
        v = self.indexes[shown.var]
        return v, self.values[v][shown.key]

    def _missing(self, i: int) -> list[Fact]:
        """The values that an activity needs and that are unreachable; none if it can do without."""
        found: list[Fact] = []
        for way in self.problem.activities[i].details.ways:
            facts = dict.fromkeys((c.var, c.value) for c in way.conditions)
            missing = [fact for fact in facts if fact not in self.reach.facts]
            if not missing:
                return []
            found += missing
        return list(dict.fromkeys(found))

    def _explain(self, root: int) -> None:
        """Marks the activities that depend, directly or not, on an activity already reported."""
        todo = [root]
        while todo:
            i = todo.pop()
            if i in self.explained:
                continue
            self.explained.add(i)
            for effect in self.problem.activities[i].details.all_effects:
                fact = (effect.var, effect.value)
                if fact not in self.reach.facts:
                    todo += self.takers.get(fact, ())

    def _report_ungiven(self, fact: Fact, needed_by: list[int]) -> None:
        activity = self.problem.activities[needed_by[0]]
        place = self._place(activity, fact)
        others = len(needed_by) - 1
        more = f" ({_other_actions(others)} need{'s' if others == 1 else ''} it too)"
        more = more if others else ""
        self.findings.add(
            Code.UNREACHABLE,
            f"action {activity.id!r} needs {place.var!r} to be {value_text(place.value)} "
            f"{_WHEN[place.at]}{more}, but {self._initially(fact)} "
            "and no effect gives it that value",
            place.pointer,
            hint=self._hint(fact),
        )

    def _report_stuck(self, i: int, fact: Fact) -> None:
        activity = self.problem.activities[i]
        place = self._place(activity, fact)
        self.findings.add(
            Code.UNREACHABLE,
            f"action {activity.id!r} needs {place.var!r} to be {value_text(place.value)} "
            f"{_WHEN[place.at]}, but {self._initially(fact)} and {self._chain(fact)}",
            place.pointer,
            hint="remove one of these conditions, or change the initial value",
        )

    def _report_goal(self, goal: ShownFact, fact: Fact) -> None:
        if fact not in self.givers:
            why, hint = "no effect gives it that value", self._hint(fact)
        elif self.explained.isdisjoint(self.givers[fact]):
            why = self._chain(fact)
            hint = "remove one of these conditions, or change the initial value"
        else:
            return
        self.findings.add(
            Code.UNREACHABLE,
            f"the goal that {goal.var!r} be {value_text(goal.value)} cannot be reached: "
            f"{self._initially(fact)} and {why}",
            goal.pointer,
            hint=hint,
        )

    def _place(self, activity: Activity, fact: Fact) -> ShownFact:
        """The place of the condition in which an action asks for a value."""
        places = fact_places(self.task, activity, "conditions")
        places += mode_fact_places(self.task, activity, "conditions")
        return next(place for place in places if self._fact(place) == fact)

    def _initially(self, fact: Fact) -> str:
        variable = self.problem.variables[fact[0]]
        return f"it is {value_text(variable.values[variable.initial])} at first"

    def _hint(self, fact: Fact) -> str:
        variable = self.problem.variables[fact[0]]
        can_be = [
            value_text(value)
            for k, value in enumerate(variable.values)
            if (fact[0], k) in self.reach.facts
        ]
        wanted = value_text(variable.values[fact[1]])
        listed = f"{', '.join(can_be[:5])}{', …' if len(can_be) > 5 else ''}"
        return f"add an effect that makes it {wanted}; now it can be {listed}"

    def _chain(self, fact: Fact) -> str:
        """The reason why no action can give a value: the chain of needs from the first of them."""
        parts: list[str] = []
        seen: set[Fact] = set()
        while fact not in seen and len(seen) < _LONGEST_CHAIN:
            seen.add(fact)
            givers = self.givers.get(fact)
            if not givers:
                return ", ".join([*parts, "which no effect gives it"])
            name = self.problem.activities[givers[0]].id
            parts.append(_would_make(name, len(givers), first=not parts))
            missing = self._missing(givers[0])
            if not missing:
                return ", ".join([*parts, "which may occur at most 0 times"])
            fact = missing[0]
            variable = self.problem.variables[fact[0]]
            needs = f"to be {value_text(variable.values[fact[1]])}"
            parts.append(f"and {name!r} needs {variable.id!r} {needs}")
        return ", ".join([*parts, "and so on in a cycle" if fact in seen else "and so on"])


def _would_make(name: str, givers: int, *, first: bool) -> str:
    if first and givers == 1:
        return f"only {name!r} gives it that value"
    others = "" if givers == 1 else f" (and {_other_actions(givers - 1)}, also impossible)"
    if first:
        return f"{name!r} would give it that value{others}"
    return f"which {name!r} would give it{others}"


def _other_actions(count: int) -> str:
    return "one more action" if count == 1 else f"{count} more actions"


_WHEN = {"start": "at its start", "all": "throughout", "end": "at its end"}


def _check_lost_goals(
    task: Task, problem: Problem, required: frozenset[int], findings: Findings
) -> None:
    """Adds goals that hold at first, that a required action breaks, and that no effect restores."""
    if not problem.goals:
        return
    given = {(e.var, e.value) for a in problem.activities for e in a.details.all_effects}
    given |= {(v, c.value) for v, own in enumerate(problem.variables) for c in own.changes}
    at_first = {v.id: v for v in problem.variables}
    ended_by: dict[int, int] = {}
    for i in sorted(required, reverse=True):
        for effect in problem.activities[i].details.effects:
            ended_by[effect.var] = i
    indexes = {v.id: k for k, v in enumerate(problem.variables)}
    for goal in goal_places(task):
        variable, v = at_first[goal.var], indexes[goal.var]
        same = variable.values[variable.initial]
        if goal.key != (type(same), same) or (v, variable.initial) in given or v not in ended_by:
            continue
        breaker = problem.activities[ended_by[v]]
        findings.add(
            Code.UNREACHABLE,
            f"the goal that {goal.var!r} be {value_text(goal.value)} cannot hold at the end: "
            f"action {breaker.id!r} changes it, and no effect restores it",
            goal.pointer,
            hint=f"add an effect that makes it {value_text(goal.value)} again, or change the goal",
        )
