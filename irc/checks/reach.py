"""Values that state variables can never have: unreachable goals, conditions that cannot hold.

A relaxation: a variable is taken to keep every value it ever had (the delete relaxation of
planning; Bonet and Geffner 2001). What is out of reach even so is out of reach. Linear in the
conditions and effects of the task.
"""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from irc.checks.facts import ShownFact, fact_places, goal_places
from irc.checks.required import is_ruled_out
from irc.diagnostics import Code, Findings
from irc.model import Task
from irc.model.state_values import value_text
from irc.problem import Activity, Problem

Fact = tuple[int, int]
"""(variable, value), by index."""

_LONGEST_CHAIN = 4
"""So many steps of "needs what only … gives" are told."""


@dataclass
class Reach:
    """What can be had and done at best."""

    facts: set[Fact]
    started: set[int] = field(default_factory=set)
    ended: set[int] = field(default_factory=set)


def reach_of(problem: Problem) -> Reach:
    """Each activity begins when its start conditions can hold, and ends when all can."""
    reach = Reach(set())
    waiting: dict[Fact, list[tuple[int, bool]]] = defaultdict(list)
    missing: dict[tuple[int, bool], int] = {}
    ready: list[tuple[int, bool]] = []
    for i, activity in enumerate(problem.activities):
        if is_ruled_out(activity):
            continue
        for to_end in (False, True):
            needs = set(_needs(activity, to_end))
            for fact in needs:
                waiting[fact].append((i, to_end))
            # (The end waits for the start as well.)
            missing[i, to_end] = len(needs) + to_end
            if not missing[i, to_end]:
                ready.append((i, to_end))
    todo: deque[Fact] = deque()
    _reached(reach, todo, ((v, variable.initial) for v, variable in enumerate(problem.variables)))
    while ready or todo:
        while ready:
            i, to_end = ready.pop()
            (reach.ended if to_end else reach.started).add(i)
            _reached(reach, todo, _gives(problem.activities[i], to_end))
            if not to_end:
                _count_down(missing, (i, True), ready)
        if todo:
            for step in waiting.get(todo.popleft(), ()):
                _count_down(missing, step, ready)
    return reach


def _needs(activity: Activity, to_end: bool) -> Iterator[Fact]:
    """What its start needs, or its end beyond that; what takes no time needs all at once."""
    whole = activity.duration_max == 0
    for condition in activity.details.conditions:
        if (condition.at != "start" and not whole) is to_end:
            yield condition.var, condition.value


def _gives(activity: Activity, at_end: bool) -> Iterator[Fact]:
    return ((e.var, e.value) for e in activity.details.effects if e.at_end is at_end)


def _reached(reach: Reach, todo: deque[Fact], facts: Iterable[Fact]) -> None:
    for fact in facts:
        if fact not in reach.facts:
            reach.facts.add(fact)
            todo.append(fact)


def _count_down(
    missing: dict[tuple[int, bool], int],
    step: tuple[int, bool],
    ready: list[tuple[int, bool]],
) -> None:
    missing[step] -= 1
    if not missing[step]:
        ready.append(step)


def check_reach(task: Task, problem: Problem, required: frozenset[int], findings: Findings) -> None:
    """Adds goals, and conditions of required actions, that no schedule can meet."""
    reach = reach_of(problem)
    stuck = sorted(required - reach.ended)
    if stuck or any(goal not in reach.facts for goal in problem.goals):
        _Telling(task, problem, reach, findings).tell(stuck)
    _check_lost_goals(task, problem, required, findings)


class _Telling:
    """Tells the roots of what is out of reach, and nothing that only follows from them."""

    def __init__(self, task: Task, problem: Problem, reach: Reach, findings: Findings) -> None:
        self.task, self.problem, self.reach, self.findings = task, problem, reach, findings
        self.givers: dict[Fact, list[int]] = defaultdict(list)
        self.takers: dict[Fact, list[int]] = defaultdict(list)
        for i, activity in enumerate(problem.activities):
            for effect in activity.details.effects:
                self.givers[effect.var, effect.value].append(i)
            for condition in activity.details.conditions:
                self.takers[condition.var, condition.value].append(i)
        self.indexes = {v.id: k for k, v in enumerate(problem.variables)}
        self.values = [{(type(x), x): k for k, x in enumerate(v.values)} for v in problem.variables]
        self.explained: set[int] = set()

    def tell(self, stuck: list[int]) -> None:
        """First what nothing gives at all; then what only such things give that cannot happen."""
        given_by_none: dict[Fact, list[int]] = defaultdict(list)
        for i in stuck:
            for fact in self._missing(i):
                if fact not in self.givers:
                    given_by_none[fact].append(i)
        for fact, needed_by in given_by_none.items():
            self._tell_ungiven(fact, needed_by)
            for i in needed_by:
                self._explain(i)
        for i in stuck:
            missing = self._missing(i)
            if i not in self.explained and missing:
                self._tell_stuck(i, missing[0])
                self._explain(i)
        for goal in goal_places(self.task):
            goal_fact = self._fact(goal)
            if goal_fact not in self.reach.facts and goal_fact not in given_by_none:
                self._tell_goal(goal, goal_fact)

    def _fact(self, shown: ShownFact) -> Fact:
        v = self.indexes[shown.var]
        return v, self.values[v][shown.key]

    def _missing(self, i: int) -> list[Fact]:
        """What an activity needs and never finds."""
        conditions = self.problem.activities[i].details.conditions
        facts = dict.fromkeys((c.var, c.value) for c in conditions)
        return [fact for fact in facts if fact not in self.reach.facts]

    def _explain(self, root: int) -> None:
        """Marks what waits, at one remove or more, for an activity that was told of."""
        todo = [root]
        while todo:
            i = todo.pop()
            if i in self.explained:
                continue
            self.explained.add(i)
            for effect in self.problem.activities[i].details.effects:
                fact = (effect.var, effect.value)
                if fact not in self.reach.facts:
                    todo += self.takers.get(fact, ())

    def _tell_ungiven(self, fact: Fact, needed_by: list[int]) -> None:
        activity = self.problem.activities[needed_by[0]]
        place = self._place(activity, fact)
        others = len(needed_by) - 1
        more = f" (and so for {_other_actions(others)})" if others else ""
        self.findings.add(
            Code.UNREACHABLE,
            f"action {activity.id!r} needs {place.var!r} to be {value_text(place.value)} "
            f"{_WHEN[place.at]}{more}, but {self._initially(fact)} and no effect makes it so",
            place.pointer,
            hint=self._hint(fact),
        )

    def _tell_stuck(self, i: int, fact: Fact) -> None:
        activity = self.problem.activities[i]
        place = self._place(activity, fact)
        self.findings.add(
            Code.UNREACHABLE,
            f"action {activity.id!r} needs {place.var!r} to be {value_text(place.value)} "
            f"{_WHEN[place.at]}, but {self._initially(fact)} and {self._chain(fact)}",
            place.pointer,
            hint="let one of these actions do without what it needs, or start from another value",
        )

    def _tell_goal(self, goal: ShownFact, fact: Fact) -> None:
        if fact not in self.givers:
            why, hint = "no effect makes it so", self._hint(fact)
        elif self.explained.isdisjoint(self.givers[fact]):
            why = self._chain(fact)
            hint = "let one of these actions do without what it needs, or start from another value"
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
        """Where an action asks for a fact."""
        places = fact_places(self.task, activity, "conditions")
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
        return f"let an action's effect make it {wanted}; so far it can be {listed}"

    def _chain(self, fact: Fact) -> str:
        """Why none of the actions that would give a fact can: the first of them, step by step."""
        told: list[str] = []
        seen: set[Fact] = set()
        while fact not in seen and len(seen) < _LONGEST_CHAIN:
            seen.add(fact)
            givers = self.givers.get(fact)
            if not givers:
                return ", ".join([*told, "which nothing makes it"])
            name = self.problem.activities[givers[0]].id
            told.append(_would_make(name, len(givers), first=not told))
            missing = self._missing(givers[0])
            if not missing:
                return ", ".join([*told, "which may not occur"])
            fact = missing[0]
            variable = self.problem.variables[fact[0]]
            needs = f"to be {value_text(variable.values[fact[1]])}"
            told.append(f"and {name!r} needs {variable.id!r} {needs}")
        return ", ".join([*told, "and so on in a circle" if fact in seen else "and so on"])


def _would_make(name: str, givers: int, *, first: bool) -> str:
    if first and givers == 1:
        return f"only {name!r} makes it so"
    others = "" if givers == 1 else f" (and {_other_actions(givers - 1)}, no more possible)"
    return (
        f"{name!r} would make it so{others}" if first else f"which {name!r} would make it{others}"
    )


def _other_actions(count: int) -> str:
    return "one more action" if count == 1 else f"{count} more actions"


_WHEN = {"start": "at its start", "all": "throughout", "end": "at its end"}


def _check_lost_goals(
    task: Task, problem: Problem, required: frozenset[int], findings: Findings
) -> None:
    """Goals that hold at first, but that an action ends which must occur, and none restores."""
    if not problem.goals:
        return
    given = {(e.var, e.value) for a in problem.activities for e in a.details.effects}
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
            f"action {breaker.id!r} changes it, and no effect makes it so again",
            goal.pointer,
            hint=f"let an action's effect make it {value_text(goal.value)} again, "
            "or change the goal",
        )
