"""Activities in a CP-SAT model: starts, ends, durations, and ranks where there is state."""

from __future__ import annotations

from ortools.sat.python import cp_model

from irc.problem import Activity, Ranks
from irc_cpsat.encoding.builder import Builder, name_of


def add_activities(builder: Builder) -> None:
    """Adds a start for each activity, an end where its duration can vary, and their ranks."""
    for i, activity in enumerate(builder.problem.activities):
        start, end = _points(builder, i, activity)
        builder.starts.append(start)
        builder.ends.append(end)
    if builder.ranked:
        _add_ranks(builder)


def _points(
    builder: Builder, i: int, activity: Activity
) -> tuple[cp_model.IntVar, cp_model.IntVar | None]:
    deadline = builder.problem.effective_deadline(i)
    latest_end = builder.horizon if deadline is None else min(builder.horizon, deadline)
    earliest = max(activity.release, builder.problem.bounds.heads[i] if builder.bounds else 0)
    if activity.earliest_end is not None:
        earliest = max(earliest, activity.earliest_end - activity.duration_max)
    latest = latest_end - activity.duration_min
    if activity.latest_start is not None:
        latest = min(latest, activity.latest_start)
    fits = earliest <= latest
    present = builder.present[i]
    if not fits and present is not None:
        builder.model.add(present == 0)
        latest_end = earliest + activity.duration_max
        latest = latest_end - activity.duration_min
    start = _start(builder, activity, earliest, latest)
    late = activity.start is not None and activity.start > latest
    if (not fits and present is None) or late:
        builder.enforced(builder.model.add(start <= latest), i)
    if activity.start is not None and activity.start < activity.release:
        builder.enforced(builder.model.add(start >= activity.release), i)
    if activity.start is not None and activity.is_fixed and activity.earliest_end is not None:
        builder.enforced(
            builder.model.add(start >= activity.earliest_end - activity.duration_min), i
        )
    return start, None if activity.is_fixed else _end(builder, i, activity, start, latest_end)


def _start(builder: Builder, activity: Activity, earliest: int, latest: int) -> cp_model.IntVar:
    if activity.start is not None:
        domain = cp_model.Domain(activity.start, activity.start)
    else:
        domain = cp_model.Domain(earliest, max(earliest, latest))
    return builder.model.new_int_var_from_domain(domain, f"start {name_of(activity)}")


def _end(
    builder: Builder, i: int, activity: Activity, start: cp_model.IntVar, latest_end: int
) -> cp_model.IntVar:
    """The end of an activity whose duration can vary, with the duration between."""
    model, name = builder.model, name_of(activity)
    late = _late_end(builder, activity)
    end = model.new_int_var(0, max(0, latest_end, late), f"end {name}")
    if late > latest_end:
        builder.enforced(model.add(end <= latest_end), i)
    if activity.earliest_end is not None:
        builder.enforced(model.add(end >= activity.earliest_end), i)
    longest = max(activity.duration_min, min(activity.duration_max, builder.horizon))
    size = model.new_int_var(activity.duration_min, longest, f"duration {name}")
    model.add(start + size == end)
    builder.sizes[i] = size
    for mode, chosen in zip(activity.details.modes, builder.modes[i], strict=True):
        model.add(size >= mode.duration_min).only_enforce_if(chosen)
        if mode.duration_max < longest:
            model.add(size <= mode.duration_max).only_enforce_if(chosen)
    return end


def _late_end(builder: Builder, activity: Activity) -> int:
    """The latest end behind a fixed start, which may be so late that an absent one needs room."""
    if activity.start is None:
        return 0
    longest = max(activity.duration_min, builder.horizon)
    return activity.start + min(activity.duration_max, longest)


def _add_ranks(builder: Builder) -> None:
    """Adds a rank for each start; a fixed duration gives its end the same one."""
    constrained = {i for arc in builder.problem.arcs for i in (arc.before, arc.after)}
    for i, activity in enumerate(builder.problem.activities):
        details = activity.details
        touches = details.touches_world or bool(activity.open_demands)
        last = builder.rank_count - 1 if touches or i in constrained else 0
        known = details.ranks or Ranks(None, None)
        start = _rank(builder, last, known.start, f"rank {name_of(activity)}", known.at_least)
        if activity.is_fixed:
            builder.ranks.append((start, start))
            continue
        end = _rank(builder, last, known.end, f"end rank {name_of(activity)}")
        builder.ranks.append((start, end))
        if known.start is None or known.end is None:
            _add_duration_in_moments(builder, i, activity)
    for i, activity in enumerate(builder.problem.activities):
        if activity.details.not_before is not None:
            time, rank = activity.details.not_before
            moment = builder.moment(i, at_end=False)
            builder.enforced(builder.model.add(moment >= time * builder.rank_count + rank), i)


def _rank(
    builder: Builder, last: int, known: int | None, name: str, at_least: bool = False
) -> cp_model.IntVar:
    first = 0 if known is None else known
    if known is not None and not at_least:
        last = known
    return builder.model.new_int_var(first, max(first, last), name)


def _add_duration_in_moments(builder: Builder, i: int, activity: Activity) -> None:
    """Bounds on a duration hold in moments too; a mode of fixed duration has one rank."""
    lasts = builder.moment(i, at_end=True) - builder.moment(i, at_end=False)
    k = builder.rank_count
    modes = activity.details.modes
    if not modes:
        builder.model.add(lasts >= k * activity.duration_min)
        builder.model.add(lasts <= k * activity.duration_max)
    for mode, chosen in zip(modes, builder.modes[i], strict=True):
        builder.model.add(lasts >= k * mode.duration_min).only_enforce_if(chosen)
        builder.model.add(lasts <= k * mode.duration_max).only_enforce_if(chosen)
