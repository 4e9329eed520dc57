"""Precedence in PDDL: conditions, waits for minimum lags, envelopes for maximum ones, meetings."""

from __future__ import annotations

from irc_pddl21.encoding.arcs import MinLag, SortedArcs
from irc_pddl21.encoding.builder import Builder, Point
from irc_pddl21.encoding.pddl import Operator


def add_precedence(builder: Builder, arcs: SortedArcs) -> None:
    """Adds every arc."""
    for arc in arcs.conditions:
        builder.require(arc.after, builder.reached(arc.before))
    for (point, lag), followers in arcs.waits.items():
        _add_wait(builder, point, lag, followers)
    for arc in arcs.envelopes:
        _add_envelope(builder, arc)
    for one, other in arcs.meetings:
        _add_meeting(builder, one, other)


def _add_wait(builder: Builder, point: Point, lag: int, followers: list[Point]) -> None:
    """One wait after a point, for all that must come at least `lag` ticks later."""
    name = builder.names.new(f"wait_{lag}_after_{_label(builder, point)}")
    todo = builder.fact(f"todo_{name}", initially=True)
    over = builder.fact(f"lag_{name}")
    builder.lag_facts.setdefault(point // 2, []).append(over)
    duration = lag * builder.scale.units_per_tick
    operator = Operator(
        name,
        (duration, duration),
        at_start=[todo, builder.reached(point)],
        start_deletes=[todo],
        end_adds=[over],
    )
    builder.add_helper(operator, f"{lag} ticks after {_description(builder, point)}")
    for follower in followers:
        builder.require(follower, over)


def _add_envelope(builder: Builder, arc: MinLag) -> None:
    """`time(before) <= time(after) - lag` with lag <= 0, as an envelope around both points."""
    before, after, lag = arc
    name = builder.names.new(f"keep_{_label(builder, before)}_by_{_label(builder, after)}")
    todo = builder.fact(f"todo_{name}", initially=True)
    begun, running = builder.fact(f"after_{name}"), builder.fact(f"during_{name}")
    operator = Operator(
        name,
        (0, -lag * builder.scale.units_per_tick + builder.scale.slack),
        at_start=[todo],
        start_deletes=[todo],
        start_adds=[begun, running],
        end_deletes=[running],
    )
    meaning = (
        f"{_description(builder, before)} is at most {-lag} ticks after "
        f"{_description(builder, after)}"
    )
    builder.add_helper(operator, meaning)
    builder.require(after, begun)
    builder.require(before, running)


def _add_meeting(builder: Builder, one: Point, other: Point) -> None:
    """Two points at one time: both happen while something runs that lasts no longer than slack."""
    name = builder.names.new(f"meet_{_label(builder, one)}_and_{_label(builder, other)}")
    todo = builder.fact(f"todo_{name}", initially=True)
    running = builder.fact(f"during_{name}")
    operator = Operator(
        name,
        (0, builder.scale.slack),
        at_start=[todo],
        start_deletes=[todo],
        start_adds=[running],
        end_deletes=[running],
    )
    meaning = f"{_description(builder, one)} is also {_description(builder, other)}"
    builder.add_helper(operator, meaning)
    builder.require(one, running)
    builder.require(other, running)


def _label(builder: Builder, point: Point) -> str:
    return builder.base[point // 2] + ("" if point % 2 else "_start")


def _description(builder: Builder, point: Point) -> str:
    end = "end" if point % 2 else "start"
    return f"the {end} of {builder.problem.activities[point // 2].id!r}"
