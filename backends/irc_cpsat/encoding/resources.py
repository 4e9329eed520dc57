"""Renewable resources in a CP-SAT model: an interval for a demand, a constraint for a pool."""

from __future__ import annotations

from ortools.sat.python import cp_model

from irc.problem import Activity, ContendedPool, OpenDemand
from irc_cpsat.encoding.builder import (
    Builder,
    DemandLiterals,
    Literal,
    LoadTaker,
    ResourceUses,
    Taker,
    name_of,
)
from irc_cpsat.encoding.calendars import with_windows


def add_resources(builder: Builder) -> DemandLiterals:
    """Adds the open demands of all activities and the capacities; returns the demands' literals."""
    activities = enumerate(builder.problem.activities)
    literals = [_add_demands(builder, i, activity) for i, activity in activities]
    for pool, uses in zip(builder.problem.contention.pools, builder.uses, strict=True):
        _add_capacity(builder, pool, uses, 1)
    for pool, uses in zip(builder.problem.contention.pools, builder.uses_in_moments, strict=True):
        _add_capacity(builder, pool, uses, builder.rank_count)
    return literals


def _add_demands(builder: Builder, i: int, activity: Activity) -> list[list[tuple[int, Literal]]]:
    if not activity.open_demands:
        return []
    has_length = _has_length(builder, i, activity)
    return [
        _add_demand(builder, i, demand, c, has_length)
        for c, demand in enumerate(activity.open_demands)
    ]


def _has_length(builder: Builder, i: int, activity: Activity) -> Literal | None:
    """A literal that says the activity has a length; None where it always has."""
    if activity.duration_min > 0 or activity.duration_max == 0:
        return None
    literal = builder.model.new_bool_var(f"holds {name_of(activity)}")
    builder.model.add(builder.sizes[i] >= 1).only_enforce_if(literal)
    builder.model.add(builder.sizes[i] == 0).only_enforce_if(~literal)
    builder.positive[i] = literal
    return literal


def _add_demand(
    builder: Builder, i: int, demand: OpenDemand, c: int, has_length: Literal | None
) -> list[tuple[int, Literal]]:
    mode = builder.problem.activities[i].details.use_mode(demand.use)
    needed = builder.present[i] if mode is None else builder.modes[i][mode]
    if len(demand.alternatives) > 1:
        return _add_choice(builder, i, demand, c, needed, has_length)
    (r,) = demand.alternatives
    if not _takes_time(builder.problem.activities[i], mode):
        return []
    _take(builder, i, demand, r, builder.taking(i, demand, r, needed, has_length))
    return []


def _add_choice(
    builder: Builder,
    i: int,
    demand: OpenDemand,
    c: int,
    needed: Literal | None,
    has_length: Literal | None,
) -> list[tuple[int, Literal]]:
    """An optional interval for each alternative, exactly one of them where one is needed."""
    model, activity = builder.model, builder.problem.activities[i]
    literals: list[tuple[int, Literal]] = []
    for r in demand.alternatives:
        pool = builder.problem.contention.pools[r]
        literal = model.new_bool_var(f"use {c} of {name_of(activity)} on {pool.id}")
        literals.append((r, literal))
        if demand.amount > pool.capacity and activity.duration_min > 0:
            model.add(literal == 0)
            continue
        if _takes_time(activity, activity.details.use_mode(demand.use)):
            _take(builder, i, demand, r, builder.taking(i, demand, r, has_length, literal))
    absent = [] if needed is None else [~needed]
    model.add_exactly_one([*(literal for _, literal in literals), *absent])
    return literals


def _takes_time(activity: Activity, mode: int | None) -> bool:
    """Whether a use in a mode (None: in all) can last, and so hold anything."""
    longest = activity.duration_max if mode is None else activity.details.modes[mode].duration_max
    return longest > 0


def _take(builder: Builder, i: int, demand: OpenDemand, r: int, taken: Literal | None) -> None:
    """Adds a use of a shared resource: over time, and where there are ranks over moments too.

    (The first follows from the second, but says more about time.)
    """
    members = builder.problem.contention.pools[r].members
    resource = builder.problem.resources[members[0]]
    family = builder.problem.activities[i].uses[demand.use].family
    if resource.batch:
        builder.loads.setdefault(r, []).append(LoadTaker(i, family, taken, demand.amount))
    elif resource.setups is not None:
        builder.takers.setdefault(r, []).append(Taker(i, family, taken))
    pauses = builder.problem.activities[i].details.keeps_units
    length = _length_in_mode(builder, i, demand)
    builder.uses[r].add(interval_of(builder, i, taken, length), demand.amount, pauses)
    if builder.ranked:
        interval = _interval_of_moments(builder, i, taken)
        builder.uses_in_moments[r].add(interval, demand.amount, pauses)


def _interval_of_moments(builder: Builder, i: int, literal: Literal | None) -> cp_model.IntervalVar:
    model, activity = builder.model, builder.problem.activities[i]
    name = name_of(activity)
    start = builder.point(i, at_end=False)
    if activity.is_fixed:
        size = activity.duration_min * builder.rank_count
        if literal is None:
            return model.new_fixed_size_interval_var(start, size, name)
        return model.new_optional_fixed_size_interval_var(start, size, literal, name)
    end = builder.point(i, at_end=True)
    longest = (builder.horizon + 1 + activity.duration_min) * builder.rank_count
    length = model.new_int_var(0, 2 * longest, "")
    if literal is None:
        return model.new_interval_var(start, length, end, name)
    return model.new_optional_interval_var(start, length, end, literal, name)


def _length_in_mode(builder: Builder, i: int, demand: OpenDemand) -> int | None:
    """The duration of the mode that has a demand, where it is one number of at least 1."""
    details = builder.problem.activities[i].details
    k = details.use_mode(demand.use)
    if k is None or details.keeps_units:
        return None
    mode = details.modes[k]
    return mode.duration_min if 0 < mode.duration_min == mode.duration_max else None


def interval_of(
    builder: Builder, i: int, literal: Literal | None, length: int | None = None
) -> cp_model.IntervalVar:
    """The interval of an activity over time, present where a literal holds (None: always).

    `length` is its duration where the literal holds, if that is one number: CP-SAT reasons better
    about an interval of fixed size.
    """
    model, activity, start = builder.model, builder.problem.activities[i], builder.starts[i]
    name = name_of(activity)
    if length is not None and literal is not None and not activity.is_fixed:
        return model.new_optional_interval_var(start, length, builder.end(i), literal, name)
    if activity.is_fixed:
        duration = activity.duration_min
        if literal is None:
            return model.new_fixed_size_interval_var(start, duration, name)
        return model.new_optional_fixed_size_interval_var(start, duration, literal, name)
    size, end = builder.sizes[i], builder.end(i)
    if literal is None:
        return model.new_interval_var(start, size, end, name)
    return model.new_optional_interval_var(start, size, end, literal, name)


def _add_capacity(builder: Builder, pool: ContendedPool, uses: ResourceUses, moments: int) -> None:
    """Adds the capacity of a resource, for uses with `moments` to a tick.

    What pauses keeps its units while there is no capacity, and nothing else is held then.
    """
    if not uses.intervals:
        return
    if pool.base is not None and any(uses.pauses):
        _add_capacity(builder, pool, uses.without_pauses, moments)
        uses = with_windows(builder, pool.never_away, uses, moments)
    elif pool.base is not None:
        uses = with_windows(builder, pool, uses, moments)
    capacity = pool.capacity
    if 2 * min(uses.amounts) > capacity and max(uses.amounts) <= capacity:
        builder.model.add_no_overlap(uses.intervals)
    else:
        builder.model.add_cumulative(uses.intervals, uses.amounts, capacity)
