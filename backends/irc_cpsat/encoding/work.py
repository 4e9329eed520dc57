"""Calendars of activities, and work that pauses, in a CP-SAT model.

The pause of an activity is a function of its start that is constant between a few breakpoints, so
there is one literal for each different pause, with the starts that lead to it as a domain. Where
the working time is a range, there is a literal for the open time of the start and of the end.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from itertools import product
from math import prod
from typing import Any, NamedTuple

from ortools.sat.python import cp_model

from irc.problem import Activity
from irc.problem.work_times import WorkTimes, WorkTimesOf, work_range
from irc.targets import Refusal
from irc_cpsat.encoding.builder import Builder, DemandLiterals, Literal, name_of

MOST_WAYS = 256
"""At most this many combinations of calendars are encoded for one activity."""


Demands = list[list[tuple[int, Literal]]]
"""For each open demand of an activity, (pool, literal that takes it)."""


class _Way(NamedTuple):
    """One way to carry out an activity: the literals that choose it, and its work times."""

    literals: tuple[Any, ...]
    times: WorkTimes
    work: tuple[int, int]


def add_work(builder: Builder, literals: DemandLiterals) -> None:
    """Adds the open times of activities that have a calendar or pause.

    Raises `Refusal` where an activity has too many combinations of calendars.
    """
    times = WorkTimesOf(builder.problem)
    for i, activity in enumerate(builder.problem.activities):
        details = activity.details
        if (details.calendar is not None or details.work) and not details.paused:
            present = builder.present[i]
            always = () if present is None else (present,)
            for way in _ways(builder, i, activity, literals[i], times):
                _add_way(builder, i, activity, way._replace(literals=(*always, *way.literals)))


def _ways(
    builder: Builder, i: int, activity: Activity, demands: Demands, times: WorkTimesOf
) -> Iterator[_Way]:
    """The ways to carry out an activity whose open times differ."""
    modes: Sequence[int | None] = range(len(activity.details.modes)) or (None,)
    for mode in modes:
        chosen = () if mode is None else (builder.modes[i][mode],)
        choices = _choices(builder, activity, mode, demands) if activity.details.work else []
        if prod(map(len, choices)) * len(modes) > MOST_WAYS:
            raise Refusal(
                f"action {activity.id!r} has more than {MOST_WAYS} combinations of calendars to "
                "pause by, more than target 'cpsat' writes out",
                (*activity.origin, "uses"),
                "use fewer alternatives with calendars of their own",
            )
        for combination in product(*choices):
            resources = [r for _, members in combination for r in members]
            holds = tuple(literal for literal, _ in combination if literal is not None)
            own = (*chosen, *holds)
            work = work_range(activity, mode)
            if work[0] or not resources or not activity.details.work:
                yield _Way(own, times.of(activity, resources), work)
            else:
                # What takes no time holds nothing, so only its own calendar counts.
                length = builder.positive[i]
                yield _Way((*own, length), times.of(activity, resources), work)
                yield _Way((*own, ~length), times.of_calendar(activity), work)


def _choices(
    builder: Builder, activity: Activity, mode: int | None, demands: Demands
) -> list[list[tuple[Literal | None, tuple[int, ...]]]]:
    """For each use with a calendar, the alternatives: a literal, and the resource it stands for."""
    pools = builder.problem.contention.pools
    found: list[list[tuple[Literal | None, tuple[int, ...]]]] = []
    for demand, options in zip(activity.open_demands, demands, strict=True):
        if activity.details.use_mode(demand.use) not in (None, mode):
            continue
        if not any(pools[r].windows for r in demand.alternatives):
            continue
        if options:
            found.append([(literal, pools[r].members[:1]) for r, literal in options])
        else:
            found.append([(None, pools[demand.alternatives[0]].members[:1])])
    return found


def _add_way(builder: Builder, i: int, activity: Activity, way: _Way) -> None:
    if way.times.always:
        if activity.details.work:
            _limit_length(builder, i, way)
        return
    if way.work[0] == way.work[1]:
        _add_fixed(builder, i, activity, way)
    else:
        _add_range(builder, i, activity, way)


def _limit_length(builder: Builder, i: int, way: _Way) -> None:
    """Without closed times nothing pauses."""
    size, model = builder.sizes[i], builder.model
    model.add(size >= way.work[0]).only_enforce_if(way.literals)
    model.add(size <= way.work[1]).only_enforce_if(way.literals)


def _add_fixed(builder: Builder, i: int, activity: Activity, way: _Way) -> None:
    """A working time that is fixed: a literal for each pause, with its starts as a domain."""
    model, start, work = builder.model, builder.starts[i], way.work[0]
    starts: dict[int, list[tuple[int, int]]] = defaultdict(list)
    limit = activity.details.max_pause if activity.details.work else 0
    for piece in way.times.pieces(work, builder.horizon):
        if limit is None or piece.pause <= limit:
            starts[piece.pause].append((piece.first, piece.last))
    if not activity.details.work or len(starts) < 2:
        whole = cp_model.Domain.from_intervals([list(s) for own in starts.values() for s in own])
        model.add_linear_expression_in_domain(start, whole).only_enforce_if(way.literals)
        if activity.details.work:
            length = work + next(iter(starts), 0)
            model.add(builder.sizes[i] == length).only_enforce_if(way.literals)
        return
    pauses = {
        pause: model.new_bool_var(f"{name_of(activity)} pauses {pause}") for pause in sorted(starts)
    }
    if way.literals:
        model.add_bool_or(pauses.values()).only_enforce_if(way.literals)
        model.add_at_most_one(pauses.values())
    else:
        model.add_exactly_one(pauses.values())
    for pause, literal in pauses.items():
        domain = cp_model.Domain.from_intervals([list(own) for own in starts[pause]])
        model.add_linear_expression_in_domain(start, domain).only_enforce_if(literal)
    together = sum(pause * literal for pause, literal in pauses.items())
    model.add(builder.sizes[i] == work + together).only_enforce_if(way.literals)


def _has_length(builder: Builder, i: int) -> Literal:
    """A literal that says an activity has a length, whose duration may be 0."""
    if i not in builder.positive:
        literal = builder.model.new_bool_var("")
        builder.model.add(builder.sizes[i] >= 1).only_enforce_if(literal)
        builder.model.add(builder.sizes[i] == 0).only_enforce_if(~literal)
        builder.positive[i] = literal
    return builder.positive[i]


def _add_range(builder: Builder, i: int, activity: Activity, way: _Way) -> None:
    """A working time that may vary: literals for the open times of its start and its end."""
    model, start, end = builder.model, builder.starts[i], builder.end(i)
    times, details = way.times, activity.details
    kept = [k for k, opened in enumerate(times.starts) if opened <= builder.horizon]
    if not kept:
        model.add_bool_or([]).only_enforce_if(way.literals)
        return
    begins = [model.new_bool_var("") for _ in kept]
    ends = [model.new_bool_var("") for _ in kept] if details.work else begins
    for group in (begins, ends):
        model.add_bool_or(group).only_enforce_if(way.literals)
        model.add_at_most_one(group)
    positive = _has_length(builder, i) if not way.work[0] else None
    for k, begin, finish in zip(kept, begins, ends, strict=True):
        opened, closed = times.intervals[k]
        model.add_linear_constraint(start, opened, closed - 1).only_enforce_if(begin)
        model.add(end <= closed).only_enforce_if(finish)
        model.add(end >= opened + (positive is None)).only_enforce_if(finish)
        if positive is not None:
            model.add(end >= opened + 1).only_enforce_if(finish, positive)
    if not details.work:
        return
    gap = [times.starts[k] - times.before[k] for k in kept]
    paused = sum(g * finish for g, finish in zip(gap, ends, strict=True)) - sum(
        g * begin for g, begin in zip(gap, begins, strict=True)
    )
    worked = builder.sizes[i] - paused
    model.add(worked >= way.work[0]).only_enforce_if(way.literals)
    model.add(worked <= way.work[1]).only_enforce_if(way.literals)
    if details.max_pause is not None:
        model.add(paused <= details.max_pause).only_enforce_if(way.literals)
