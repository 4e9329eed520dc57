"""Drops conditions that the history breaks: no effect of the history makes them true."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

from irc.execution.executed import ExecutedActivity
from irc.execution.fresh_names import fresh_name
from irc.problem import Activity, Condition, Details, Effect, Problem, Variable
from irc.schedule import Entry

Write = tuple[int, int, int, int]
"""(time, stage, value, activity). At an instant at which the past comes first, stage 0 is an end,
1 a world change, 2 a start; at any other instant there is one stage."""


_NOBODY = -1
"""Stands for the activity of a timed change of state."""


def without_broken_conditions(
    problem: Problem, executed: Mapping[int, ExecutedActivity], now: int
) -> tuple[Problem, dict[int, ExecutedActivity]]:
    """Drops conditions of executed activities that no order of their own effects makes true."""
    staged = {now, *(f.start for f in executed.values() if f.by_itself)}
    staged |= {change.at for variable in problem.variables for change in variable.changes}
    written = _writes(problem, executed, staged)
    open_values = {
        (e.var, e.value)
        for i, a in enumerate(problem.activities)
        if i not in executed
        for e in a.details.all_effects
    }
    activities = list(problem.activities)
    helpers: list[tuple[Activity, ExecutedActivity]] = []
    lost: list[tuple[int, int, bool]] = []
    for i, past in executed.items():
        details = activities[i].details
        if not details.conditions:
            continue
        kept = []
        for c in details.conditions:
            writes = written.get(c.var, [])
            if _can_hold(problem, writes, c, i, past, open_values, staged):
                kept.append(c)
            elif past.running and c.at == "all":
                helpers += _held_until_broken(problem, writes, c, i, past, now)
        if len(kept) < len(details.conditions):
            conditions = tuple(kept)
            lost += [
                (i, c.var, c.at == "end")
                for c in details.conditions
                if c not in kept and c.at != "all"
            ]
            activities[i] = replace(activities[i], details=replace(details, conditions=conditions))
    variables = _still_read(problem, activities, executed, lost, now)
    changed = replace(
        problem,
        variables=(*problem.variables, *variables),
        activities=(*activities, *(a for a, _ in helpers)),
        previous=replace(
            problem.previous,
            places=problem.previous.places and (*problem.previous.places, *(None for _ in helpers)),
        ),
    )
    return changed, {**executed, **{len(activities) + k: f for k, (_, f) in enumerate(helpers)}}


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


def _held_until_broken(
    problem: Problem,
    writes: list[Write],
    condition: Condition,
    i: int,
    past: ExecutedActivity,
    now: int,
) -> list[tuple[Activity, ExecutedActivity]]:
    """A helper that holds a condition until an executed activity breaks it; none if broken now."""
    initial = problem.variables[condition.var].initial
    if condition.value not in _values_at(now, writes, initial):
        return []
    breaks = [t for t, _, v, j in writes if j != i and now < t < past.end and v != condition.value]
    if not breaks:
        return []
    who, var = problem.activities[i].id, problem.variables[condition.var].id
    name = fresh_name(f"{who} needs {var} until {breaks[0]}", {a.id for a in problem.activities})
    length = breaks[0] - now
    details = Details(conditions=(condition,))
    helper = Activity(name, length, length, release=now, start=now, details=details)
    entry = Entry(name, problem.to_units(now), problem.to_units(breaks[0]))
    return [(helper, ExecutedActivity(entry, now, breaks[0], None, (), running=True))]


def _writes(
    problem: Problem, executed: Mapping[int, ExecutedActivity], staged: Collection[int]
) -> dict[int, list[Write]]:
    """The changes of each variable by executed activities and due world changes, by time."""
    written: dict[int, list[Write]] = {}
    for i, activity in enumerate(problem.activities):
        past = executed.get(i)
        if past is not None:
            start, end = past.start, past.end
        elif activity.start is not None and not activity.details.optional and activity.is_fixed:
            start, end = activity.start, activity.start + activity.duration_min
        else:
            continue
        for effect in activity.details.effects:
            time = end if effect.at_end else start
            stage = 2
            if time in staged and past is not None:
                stage = 1 if past.by_itself else 0 if past.start < time else 2
            written.setdefault(effect.var, []).append((time, stage, effect.value, i))
    for var, variable in enumerate(problem.variables):
        for at, value in variable.changes:
            written.setdefault(var, []).append((at, 1, value, _NOBODY))
    for writes in written.values():
        writes.sort()
    return written


def _can_hold(
    problem: Problem,
    writes: list[Write],
    condition: Condition,
    i: int,
    past: ExecutedActivity,
    open_values: set[tuple[int, int]],
    staged: Collection[int],
) -> bool:
    others = [w for w in writes if w[3] != i]
    initial = problem.variables[condition.var].initial
    if condition.at == "all":
        if past.end <= past.start:
            instant = problem.activities[i].is_fixed
            return not instant or condition.value in _values_at(past.start, others, initial)
        breaks = any(past.start < t < past.end and v != condition.value for t, _, v, _ in others)
        return not breaks and condition.value in _values_at(past.start, writes, initial)
    time = past.end if condition.at == "end" else past.start
    stage = 0 if time in staged and past.start < time else 2
    if condition.value in _values_at(
        time, writes if condition.at == "end" else others, initial, stage
    ):
        return True
    return (
        past.running and condition.at == "end" and ((condition.var, condition.value) in open_values)
    )


def _values_at(time: int, writes: list[Write], initial: int, stage: int = 2) -> set[int]:
    """The possible values of a variable at a stage of an instant, in any order of its writes."""
    here = {v for t, s, v, _ in writes if (t, s) == (time, stage)}
    before = [w for w in writes if w[:2] < (time, stage)]
    if not before:
        return here | {initial}
    last = before[-1][:2]
    return here | {v for t, s, v, _ in before if (t, s) == last}
