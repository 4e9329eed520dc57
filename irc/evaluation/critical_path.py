"""Schedules of a graph of steps that only order and durations bind."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

Edges = Iterable[tuple[int, int]]
Times = dict[int, float]

TOLERANCE = 1
"""Seconds by which the paper lets a time be off."""


def earliest_starts(durations: Mapping[int, float], edges: Edges) -> Times | None:
    """The earliest start of each step; None where the edges go round in a circle."""
    waiting = dict.fromkeys(durations, 0)
    after: dict[int, list[int]] = {}
    for a, b in edges:
        waiting[b] += 1
        after.setdefault(a, []).append(b)
    starts: Times = dict.fromkeys(durations, 0)
    free = [step for step, count in waiting.items() if not count]
    for step in free:
        end = starts[step] + durations[step]
        for following in after.get(step, ()):
            starts[following] = max(starts[following], end)
            waiting[following] -= 1
            if not waiting[following]:
                free.append(following)
    return starts if len(free) == len(durations) else None


def latest_starts(durations: Mapping[int, float], edges: Edges, makespan: float) -> Times:
    """The latest start of each step within a makespan, for edges without a circle."""
    back = earliest_starts(durations, [(b, a) for a, b in edges])
    if back is None:
        raise ValueError("the edges go round in a circle")
    return {step: makespan - back[step] - durations[step] for step in durations}


def makespan_of(durations: Mapping[int, float], starts: Times) -> float:
    """When the last step ends; 0 without steps."""
    return max((starts[step] + durations[step] for step in durations), default=0)


def keeps_order(durations: Mapping[int, float], starts: Times, edges: Edges) -> bool:
    """Whether each edge's second step starts after the first one's end, within the tolerance."""
    return all(starts[b] >= starts[a] + durations[a] - TOLERANCE for a, b in edges)


def solved_order_holds(
    durations: Mapping[int, float], edges: frozenset[tuple[int, int]], wanted: Edges
) -> bool:
    """Whether a schedule of least makespan that CP-SAT finds keeps the wanted order.

    The paper judges the schedule that CP-SAT returned, of which only the makespan is recorded.
    Where the edges bind the wanted order, or no schedule of least makespan keeps it, no solver
    is asked.
    """
    early = earliest_starts(durations, edges)
    if early is None:
        return False
    least = makespan_of(durations, early)
    late = latest_starts(durations, edges, least)
    open_edges = [(a, b) for a, b in wanted if (a, b) not in edges]
    if all(early[b] >= late[a] + durations[a] - TOLERANCE for a, b in open_edges):
        return True
    if any(late[b] < early[a] + durations[a] - TOLERANCE for a, b in open_edges):
        return False
    return keeps_order(durations, _solved(durations, edges), open_edges)


def _solved(durations: Mapping[int, float], edges: Edges) -> Times:
    """The starts in CP-SAT's schedule of least makespan, with one worker and seed 0."""
    from ortools.sat.python import cp_model

    model = cp_model.CpModel()
    horizon = sum(map(round, durations.values()))
    starts = {k: model.new_int_var(0, horizon, f"s{k}") for k in durations}
    ends = {k: model.new_int_var(0, horizon, f"e{k}") for k in durations}
    for k, duration in durations.items():
        model.new_interval_var(starts[k], round(duration), ends[k], f"i{k}")
    for a, b in sorted(edges):
        model.add(starts[b] >= ends[a])
    makespan = model.new_int_var(0, horizon, "makespan")
    model.add_max_equality(makespan, list(ends.values()))
    model.minimize(makespan)
    solver = cp_model.CpSolver()
    solver.parameters.num_workers = 1
    solver.parameters.random_seed = 0
    solver.solve(model)
    return {k: float(solver.value(start)) for k, start in starts.items()}
