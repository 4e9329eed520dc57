"""Conflicts that only what has begun causes: they are carried, so they must not bind any more.

Each is relaxed just so far that the history is possible. What they are is told by judging the
history alone with the validator, which shares no code with this.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import pairwise

from irc.online.facts import Fact
from irc.problem import (
    Activity,
    Arc,
    Condition,
    Details,
    Problem,
    Renewable,
    Shared,
    Window,
)
from irc.schedule import Entry


def relaxed(
    problem: Problem, facts: Mapping[int, Fact], now: int
) -> tuple[Problem, dict[int, Fact]]:
    """The problem without what its facts (by activity) contradict, and its facts.

    Where a condition of what is running breaks later on, a helper behind all other activities, a
    fact too, holds it until then.
    """
    if not facts:
        return problem, {}
    problem = _without_late_deadline(problem, facts)
    problem = replace(
        problem, arcs=tuple(a for a in problem.arcs if not _is_broken(problem, a, facts))
    )
    problem = _with_room(problem, facts)
    if problem.reservoirs:
        problem = _with_stock_settled(problem, facts, now)
    if problem.variables:
        return _without_broken_conditions(problem, facts, now)
    return problem, dict(facts)


def _without_late_deadline(problem: Problem, facts: Mapping[int, Fact]) -> Problem:
    """Where a fact ends behind the task's deadline, it binds what is open alone."""
    latest = max(_ends(problem, i, f)[0] for i, f in facts.items())
    deadline = problem.deadline
    if deadline is None or latest <= deadline:
        return problem

    def bound(i: int, activity: Activity) -> Activity:
        if i in facts:
            return activity
        own = deadline if activity.deadline is None else min(deadline, activity.deadline)
        return replace(activity, deadline=own)

    activities = tuple(bound(i, a) for i, a in enumerate(problem.activities))
    return replace(problem, activities=activities, deadline=None)


def _ends(problem: Problem, i: int, fact: Fact) -> tuple[int, int]:
    """The least and the greatest time at which a fact can end."""
    activity = problem.activities[i]
    return fact.start + activity.duration_min, fact.start + activity.duration_max


def _is_broken(problem: Problem, arc: Arc, facts: Mapping[int, Fact]) -> bool:
    """Whether two facts contradict a precedence, however long they take."""
    if arc.before not in facts or arc.after not in facts:
        return False
    before, after = facts[arc.before], facts[arc.after]
    if before.cancelled or after.cancelled:
        return True
    from_least, from_most = before.start, before.start
    to_least, to_most = after.start, after.start
    if arc.from_end:
        from_least, from_most = _ends(problem, arc.before, before)
    if arc.to_end:
        to_least, to_most = _ends(problem, arc.after, after)
    if to_most - from_least < arc.min_lag:
        return True
    return arc.max_lag is not None and to_least - from_most > arc.max_lag


# --- capacity ---


def _with_room(problem: Problem, facts: Mapping[int, Fact]) -> Problem:
    """Resources have as much as the facts hold, at every instant."""
    loads: dict[int, list[tuple[int, int]]] = {}
    for i, fact in facts.items():
        activity = problem.activities[i]
        if fact.resources is None or (fact.mode is None and activity.details.modes):
            continue
        end = _ends(problem, i, fact)[0]
        for use in activity.uses if end > fact.start else ():
            load = loads.setdefault(use.alternatives[0], [])
            load += [(fact.start, use.amount), (end, -use.amount)]
    changed = {
        r: windows
        for r, load in loads.items()
        if (windows := _windows(problem.resources[r], load)) is not None
    }
    if not changed:
        return problem
    resources = tuple(
        replace(r, windows=changed[k]) if k in changed else r
        for k, r in enumerate(problem.resources)
    )
    return replace(
        problem,
        resources=resources,
        shared=tuple(_shared(s, resources, changed) for s in problem.shared),
    )


def _windows(resource: Renewable, load: list[tuple[int, int]]) -> tuple[Window, ...] | None:
    """The windows of a resource with room for a load; None where there is enough already."""
    times = {t for t, _ in load} | {t for w in resource.windows for t in (w.start, w.end)}
    steps: dict[int, int] = {}
    for time, amount in load:
        steps[time] = steps.get(time, 0) + amount
    level, short, pieces = 0, False, []
    for start, end in pairwise(sorted(times)):
        level += steps.get(start, 0)
        capacity = next((w.capacity for w in resource.windows if w.start <= start < w.end), None)
        there = resource.capacity if capacity is None else capacity
        short = short or level > there
        pieces.append(Window(start, end, max(level, there)))
    if not short:
        return None
    return tuple(w for w in pieces if w.capacity != resource.capacity)


def _shared(
    shared: Shared, resources: tuple[Renewable, ...], changed: Mapping[int, tuple[Window, ...]]
) -> Shared:
    if len(shared.members) > 1 or shared.members[0] not in changed:
        # (A pool's members are told apart when an answer is read; their sum is never short.)
        return shared
    resource = resources[shared.members[0]]
    greatest = max((resource.capacity, *(w.capacity for w in resource.windows)))
    return Shared(resource.id, greatest, shared.members, resource.capacity, resource.windows)


# --- state ---

Write = tuple[int, int, int]
"""(time, value, activity)."""


def _without_broken_conditions(
    problem: Problem, facts: Mapping[int, Fact], now: int
) -> tuple[Problem, dict[int, Fact]]:
    """Conditions of facts that no order of the facts' own effects makes true are dropped."""
    written = _writes(problem, facts)
    open_values = {
        (e.var, e.value)
        for i, a in enumerate(problem.activities)
        if i not in facts
        for e in a.details.effects
    }
    activities = list(problem.activities)
    helpers: list[tuple[Activity, Fact]] = []
    for i, fact in facts.items():
        details = activities[i].details
        if not details.conditions:
            continue
        kept = []
        for c in details.conditions:
            writes = written.get(c.var, [])
            if _can_hold(problem, writes, c, i, fact, open_values):
                kept.append(c)
            elif fact.running and c.at == "all":
                helpers += _held_until_broken(problem, writes, c, i, fact, now)
        if len(kept) < len(details.conditions):
            conditions = tuple(kept)
            activities[i] = replace(activities[i], details=replace(details, conditions=conditions))
    changed = replace(
        problem,
        activities=(*activities, *(a for a, _ in helpers)),
        earlier=problem.earlier and (*problem.earlier, *(None for _ in helpers)),
    )
    return changed, {**facts, **{len(activities) + k: f for k, (_, f) in enumerate(helpers)}}


def _held_until_broken(
    problem: Problem, writes: list[Write], condition: Condition, i: int, fact: Fact, now: int
) -> list[tuple[Activity, Fact]]:
    """A helper that holds a condition from now until a fact breaks it; none where it is broken."""
    initial = problem.variables[condition.var].initial
    if condition.value not in _values_at(now, writes, initial):
        return []
    breaks = [t for t, v, j in writes if j != i and now < t < fact.end and v != condition.value]
    if not breaks:
        return []
    name = (
        f"{problem.activities[i].id} needs {problem.variables[condition.var].id} until {breaks[0]}"
    )
    taken = {a.id for a in problem.activities}
    while name in taken:
        name += "'"
    length = breaks[0] - now
    details = Details(conditions=(condition,))
    helper = Activity(name, length, length, release=now, start=now, details=details)
    entry = Entry(name, problem.to_units(now), problem.to_units(breaks[0]))
    return [(helper, Fact(entry, now, breaks[0], None, (), running=True))]


def _writes(problem: Problem, facts: Mapping[int, Fact]) -> dict[int, list[Write]]:
    """What facts, and changes of the world that are due, do to each variable, by time."""
    written: dict[int, list[Write]] = {}
    for i, activity in enumerate(problem.activities):
        fact = facts.get(i)
        if fact is not None:
            start, end = fact.start, fact.end
        elif activity.start is not None and not activity.details.optional and activity.is_fixed:
            start, end = activity.start, activity.start + activity.duration_min
        else:
            continue
        for effect in activity.details.effects:
            time = end if effect.at_end else start
            written.setdefault(effect.var, []).append((time, effect.value, i))
    for writes in written.values():
        writes.sort()
    return written


def _can_hold(
    problem: Problem,
    writes: list[Write],
    condition: Condition,
    i: int,
    fact: Fact,
    open_values: set[tuple[int, int]],
) -> bool:
    others = [w for w in writes if w[2] != i]
    initial = problem.variables[condition.var].initial
    if condition.at == "all":
        if fact.end <= fact.start:
            return True
        breaks = any(fact.start < t < fact.end and v != condition.value for t, v, _ in others)
        return not breaks and condition.value in _values_at(fact.start, writes, initial)
    time = fact.end if condition.at == "end" else fact.start
    if condition.value in _values_at(time, writes if condition.at == "end" else others, initial):
        return True
    return (
        fact.running and condition.at == "end" and ((condition.var, condition.value) in open_values)
    )


def _values_at(time: int, writes: list[Write], initial: int) -> set[int]:
    """What a variable can be at an instant, in whichever order the writes of it come."""
    before = [w for w in writes if w[0] < time]
    values = {v for t, v, _ in writes if t == time}
    if not before:
        return values | {initial}
    last = before[-1][0]
    return values | {v for t, v, _ in before if t == last}


# --- stock ---


def _with_stock_settled(problem: Problem, facts: Mapping[int, Fact], now: int) -> Problem:
    """A reservoir whose past leaves its bounds starts from what the past has left."""
    for k, reservoir in enumerate(problem.reservoirs):
        changes = sorted(_stock_changes(problem, facts, k))
        past = [(t, amount) for t, amount, _ in changes if t <= now]
        level, broken = reservoir.initial, False
        times = sorted({t for t, _ in past})
        for time in times:
            level += sum(amount for t, amount in past if t == time)
            broken = broken or level < reservoir.least
            broken = broken or (reservoir.greatest is not None and level > reservoir.greatest)
        if broken:
            problem = _folded(problem, facts, k, now, level)
    return problem


def _stock_changes(
    problem: Problem, facts: Mapping[int, Fact], k: int
) -> Iterator[tuple[int, int, int]]:
    for i, fact in facts.items():
        for change in problem.activities[i].details.stock:
            if change.reservoir == k:
                yield fact.end if change.at_end else fact.start, change.amount, i


def _folded(problem: Problem, facts: Mapping[int, Fact], k: int, now: int, level: int) -> Problem:
    activities = list(problem.activities)
    for i, fact in facts.items():
        details = activities[i].details
        kept = tuple(
            c
            for c in details.stock
            if c.reservoir != k or (fact.end if c.at_end else fact.start) > now
        )
        activities[i] = replace(activities[i], details=replace(details, stock=kept))
    reservoirs = list(problem.reservoirs)
    reservoirs[k] = replace(
        reservoirs[k],
        initial=level,
        least=min(level, reservoirs[k].least),
        greatest=None
        if reservoirs[k].greatest is None
        else max(level, reservoirs[k].greatest or 0),
    )
    return replace(problem, activities=tuple(activities), reservoirs=tuple(reservoirs))
