"""Finds heads, tails and the critical path from precedence, lags and fixed activities."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from irc.errors import IrcError
from irc.passes.fixed_load import release_behind_fixed
from irc.passes.mandatory import mandatory_part
from irc.problem import Bound, Bounds, Problem
from irc.problem.temporal_network import earliest
from irc.problem.time_points import least_times_to_end, timing_network


class TimesContradictError(IrcError, ValueError):
    """The lags and durations of activities that must all be present contradict each other."""


def heads_and_tails(problem: Problem) -> Problem:
    """Fills `heads` and `tails`, and raises the bound to the critical path.

    Only activities that every schedule contains count. Heads of the others are their releases.
    Activities wait for the resources that others hold at fixed times.

    Raises `TimesContradictError` where the network has a contradiction; the checks report that of
    a whole task first.
    """
    released = release_behind_fixed(problem)
    core, way = mandatory_part(released)
    found = _of_network(core)
    if core is not released:
        found = _of_core(released, found, way.activities.new)
    return replace(problem, bounds=found.bounds)


def bounded_mandatory_part(problem: Problem) -> Problem:
    """The part that every schedule contains, with heads and tails; it may be the whole problem."""
    core, _ = mandatory_part(problem)
    return problem if core is problem else heads_and_tails(core)


def _of_network(problem: Problem) -> Problem:
    timing = timing_network(problem)
    points, network = timing.points, timing.network
    forward = earliest(network, timing.floors)
    if forward.cycles:
        raise TimesContradictError("lags and durations of the problem contradict each other")
    to_end = least_times_to_end(points, network)
    critical = max((a + b for a, b in zip(forward.t, to_end, strict=True)), default=0)
    bound = problem.bounds.makespan
    if critical > bound.value:
        bound = Bound(critical, "critical path")
    bounds = Bounds(
        heads=tuple(forward.t[p] for p in points.start),
        tails=tuple(
            to_end[p] - offset for p, offset in zip(points.end, points.end_offset, strict=True)
        ),
        makespan=bound,
    )
    return replace(problem, bounds=bounds)


def _of_core(problem: Problem, core: Problem, places: Mapping[int, int]) -> Problem:
    bounds = Bounds(
        heads=tuple(
            core.bounds.heads[places[i]] if i in places else max(a.release, a.start or 0)
            for i, a in enumerate(problem.activities)
        ),
        tails=tuple(
            core.bounds.tails[places[i]] if i in places else 0
            for i in range(len(problem.activities))
        ),
        makespan=core.bounds.makespan,
    )
    return replace(problem, bounds=bounds)
