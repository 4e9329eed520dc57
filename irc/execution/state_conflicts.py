"""Drops conditions that the history breaks: no effect of the history makes them true."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

from irc.execution.awaited_ends import with_conditions, with_end_variables
from irc.execution.executed import ExecutedActivity
from irc.execution.fresh_names import fresh_name
from irc.problem import Activity, Condition, Details, Effect, Mode, Problem, Protected, Variable

Write = tuple[int, int, int, int]
"""(time, stage, value, activity). At an instant at which the past comes first, stage 0 is an end,
1 a world change, 2 a start; at any other instant there is one stage."""


_NOBODY = -1
"""Stands for the activity of a timed change of state."""


def without_broken_conditions(
    problem: Problem, executed: Mapping[int, ExecutedActivity], now: int, *, hopes: bool
) -> tuple[Problem, bool]:
    """Drops conditions of executed activities that no order of their own effects makes true.

    Where one binds throughout what still runs, open activities do not end it where it holds. With
    `hopes` a condition is kept that open activities may still meet; returns also whether one is.
    """
    history = _History.of(problem, executed, now)
    activities = list(problem.activities)
    lost: list[tuple[int, int, bool]] = []
    protected: list[Protected] = []
    hoped = False
    for i, past in executed.items():
        details = activities[i].details
        if not details.conditions:
            continue
        kept = []
        for c in details.conditions:
            if history.can_hold(c, i, past):
                kept.append(c)
            elif hopes and history.may_be_met(c, past):
                kept.append(c)
                hoped = True
            elif c.at != "all":
                lost.append((i, c.var, c.at == "end"))
            elif past.running and history.may_have_again(c):
                protected.append(Protected(i, c.var, c.value))
        if len(kept) < len(details.conditions):
            activities[i] = replace(activities[i], details=replace(details, conditions=tuple(kept)))
    if protected:
        activities = [
            a if i in executed else _protecting(a, protected) for i, a in enumerate(activities)
        ]
    variables = _still_read(problem, activities, executed, lost, now)
    changed = replace(
        problem,
        variables=(*problem.variables, *variables),
        activities=tuple(activities),
    )
    return changed, hoped


def _protecting(activity: Activity, protected: Sequence[Protected]) -> Activity:
    """An open activity that takes none of these values away; as before if it never could."""
    details = activity.details
    its = tuple(
        p
        for p in protected
        if any(e.var == p.var and e.value != p.value for e in details.all_effects)
    )
    return replace(activity, details=replace(details, protects=its)) if its else activity


def with_values_held(problem: Problem) -> Problem:
    """The problem in which protected values may not be touched at all, instead of not taken away.

    This is for a target that cannot say "where the variable has the value": another variable says
    whether the activity still runs, and who gives the first one another value needs its end.
    """
    needs = (
        (p, p.activity, problem.variables[p.var].id)
        for activity in problem.activities
        for p in activity.details.protects
    )
    extended, over = with_end_variables(problem, needs)
    if not over:
        return problem
    activities = tuple(_behind(activity, over) for activity in extended.activities)
    return replace(extended, activities=activities)


def _behind(activity: Activity, over: Mapping[Protected, int]) -> Activity:
    """An activity whose changes of protected variables come behind what needs these."""

    def needed(part: Details | Mode) -> tuple[Condition, ...]:
        return tuple(
            Condition(over[p], 1, "end" if e.at_end else "start")
            for p in activity.details.protects
            for e in part.effects
            if e.var == p.var and e.value != p.value
        )

    return with_conditions(activity, needed) if activity.details.protects else activity


def _still_read(
    problem: Problem,
    activities: list[Activity],
    executed: Mapping[int, ExecutedActivity],
    lost: Sequence[tuple[int, int, bool]],
    now: int,
) -> list[Variable]:
    """Lets happenings that are still to come read a variable, though their condition is dropped.

    Who changes the variable then must not do so at the same time and rank. So both change another
    variable, which has one value and which nothing needs. Returns these variables.
    """
    added: list[Variable] = []
    names = {v.id for v in problem.variables}
    for i, var, at_end in lost:
        past = executed[i]
        if (past.end if at_end else past.start) < now:
            continue
        index = len(problem.variables) + len(added)
        name = fresh_name(f"{problem.activities[i].id} reads {problem.variables[var].id}", names)
        names.add(name)
        added.append(Variable(name, (False,), 0))
        for j, activity in enumerate(activities):
            if j != i and j in executed and not executed[j].running:
                continue
            details = activity.details
            own = (Effect(index, 0, at_end),) if j == i else _alike(details.effects, var, index)
            modes = tuple(
                m._replace(effects=m.effects + _alike(m.effects, var, index)) for m in details.modes
            )
            if own or modes != details.modes:
                details = replace(details, effects=details.effects + own, modes=modes)
                activities[j] = replace(activity, details=details)
    return added


def _alike(effects: tuple[Effect, ...], var: int, other: int) -> tuple[Effect, ...]:
    """Effects on another variable, which has one value, where these change a variable."""
    return tuple(Effect(other, 0, e.at_end) for e in effects if e.var == var)


@dataclass(frozen=True)
class _History:
    """The changes of state by the history and by the world, and those that are open.

    `written` has them for each variable, by time. At the instants `staged` the past comes first.
    """

    problem: Problem
    now: int
    written: Mapping[int, Sequence[Write]]
    staged: frozenset[int]
    open_values: frozenset[tuple[int, int]]

    @classmethod
    def of(cls, problem: Problem, executed: Mapping[int, ExecutedActivity], now: int) -> _History:
        """The history of a frozen problem."""
        staged = {now, *(f.start for f in executed.values() if f.by_itself)}
        staged |= {change.at for variable in problem.variables for change in variable.changes}
        open_values = {
            (e.var, e.value)
            for i, a in enumerate(problem.activities)
            if i not in executed
            for e in a.details.all_effects
        }
        written = _writes(problem, executed, staged)
        return cls(problem, now, written, frozenset(staged), frozenset(open_values))

    def can_hold(self, condition: Condition, i: int, past: ExecutedActivity) -> bool:
        """Whether some order of what has happened meets a condition of an executed activity."""
        writes = self.written.get(condition.var, [])
        others = [w for w in writes if w[3] != i]
        initial = self.problem.variables[condition.var].initial
        if condition.at == "all":
            if past.end <= past.start:
                instant = self.problem.activities[i].is_fixed
                return not instant or condition.value in _values_at(past.start, others, initial)
            breaks = any(
                past.start < t < past.end and v != condition.value for t, _, v, _ in others
            )
            return not breaks and condition.value in _values_after(past.start, writes, i, initial)
        time = past.end if condition.at == "end" else past.start
        stage = 0 if time in self.staged and past.start < time else 2
        before = writes if condition.at == "end" else others
        return condition.value in _values_at(time, before, initial, stage)

    def may_be_met(self, condition: Condition, past: ExecutedActivity) -> bool:
        """Whether open activities may give the value that a running one needs at its end."""
        value = condition.var, condition.value
        return past.running and condition.at == "end" and value in self.open_values

    def may_have_again(self, condition: Condition) -> bool:
        """Whether a variable has the value now, or may have it later."""
        writes = self.written.get(condition.var, [])
        initial = self.problem.variables[condition.var].initial
        return (
            (condition.var, condition.value) in self.open_values
            or condition.value in _values_at(self.now, writes, initial)
            or any(t >= self.now and v == condition.value for t, _, v, _ in writes)
        )


def _writes(
    problem: Problem, executed: Mapping[int, ExecutedActivity], staged: Collection[int]
) -> dict[int, list[Write]]:
    """The changes of each variable by executed activities and by the world, by time."""
    written: dict[int, list[Write]] = {}
    for i, activity in enumerate(problem.activities):
        past = executed.get(i)
        if past is None:
            continue
        for effect in activity.details.effects:
            time = past.end if effect.at_end else past.start
            stage = 2
            if time in staged:
                stage = 1 if past.by_itself else 0 if past.start < time else 2
            written.setdefault(effect.var, []).append((time, stage, effect.value, i))
    for var, variable in enumerate(problem.variables):
        for at, value in variable.changes:
            written.setdefault(var, []).append((at, 1, value, _NOBODY))
    for writes in written.values():
        writes.sort()
    return written


def _values_at(time: int, writes: Sequence[Write], initial: int, stage: int = 2) -> set[int]:
    """The possible values of a variable at a stage of an instant, in any order of its writes."""
    here = {v for t, s, v, _ in writes if (t, s) == (time, stage)}
    before = [w for w in writes if w[:2] < (time, stage)]
    if not before:
        return here | {initial}
    last = before[-1][:2]
    return here | {v for t, s, v, _ in before if (t, s) == last}


def _values_after(time: int, writes: Sequence[Write], i: int, initial: int) -> set[int]:
    """The possible values of a variable from just after the start of activity i on.

    Another change at that instant comes no later than the start, or it would end the value.
    """
    here = {j: v for t, stage, v, j in writes if (t, stage) == (time, 2)}
    if i in here:
        return {here[i]}
    return set(here.values()) or _values_at(time, writes, initial)
