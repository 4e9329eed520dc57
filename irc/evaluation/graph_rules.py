"""The paper's measures of a step graph against the gold graph (AsyncPlan-XXL)."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

from irc.evaluation.critical_path import (
    TOLERANCE,
    earliest_starts,
    makespan_of,
    solved_order_holds,
)
from irc.evaluation.data import StepInstance
from irc.methods import Answer, StepGraph

Scores = dict[str, float]
"""By the name of a measure: a share, or 0 and 1."""

_DIGITS = re.compile(r"\d+")

NOTHING: Scores = {
    **dict.fromkeys(("dep_prec", "dep_rec", "goal", "count", "dur", "code", "reversed"), 0),
    **dict.fromkeys(("plan", "plan_superset", "plan_valid", "exact"), 0),
    **dict.fromkeys(("missing_dep", "incomplete_goal", "wrong_dur"), 1),
}
"""The paper's scores where there is no graph: no share of anything, and every error."""


def step_number(name: str) -> int | None:
    """The number in a step's name: 4 for `step4`, `4` and `step 4: bake`; None without digits."""
    found = _DIGITS.search(name)
    return int(found.group()) if found else None


@dataclass(frozen=True)
class NumberedGraph:
    """A step graph by numbers of steps; an end of an edge without a number is None."""

    count: int
    durations: Mapping[int, float]
    edges: frozenset[tuple[int | None, int | None]]

    @property
    def inner_edges(self) -> frozenset[tuple[int, int]]:
        """The edges between steps that are there."""
        return frozenset(
            (a, b)
            for a, b in self.edges
            if a is not None and b is not None and {a, b} <= self.durations.keys()
        )

    @property
    def complete(self) -> bool:
        """Whether all its durations are positive, which the paper's validator asks for."""
        return bool(self.durations) and all(d > 0 for d in self.durations.values())


def numbered(graph: StepGraph) -> NumberedGraph:
    """The graph with its steps by number; a step without a duration lasts no time."""
    numbers = [(step_number(a.id), a.duration or 0) for a in graph.actions]
    return NumberedGraph(
        len(graph.actions),
        {number: duration for number, duration in numbers if number is not None},
        frozenset((step_number(e.before), step_number(e.after)) for e in graph.edges),
    )


def graph_scores(graph: NumberedGraph, gold: StepInstance) -> Scores:
    """The measures that need the graph alone."""
    edges, durations = graph.edges, graph.durations
    right = len(edges & gold.edges)
    goal = sum(step in durations for step in gold.durations) / gold.size
    equal = sum(durations.get(step) == d for step, d in gold.durations.items()) / gold.size
    return {
        "dep_prec": right / len(edges) if edges else 0,
        "dep_rec": right / len(gold.edges) if gold.edges else 1,
        "goal": goal,
        "count": graph.count == gold.size,
        "dur": equal,
        "missing_dep": not gold.edges <= edges,
        "incomplete_goal": goal < 1,
        "wrong_dur": equal < 1,
        "reversed": bool(edges) and edges == {(b, a) for a, b in gold.edges},
        "exact": edges == gold.edges and equal == 1,
        "code": own_makespan(graph) == gold.makespan,
    }


def own_makespan(graph: NumberedGraph) -> float | None:
    """The critical path of the graph itself; None where its edges go round in a circle."""
    starts = earliest_starts(graph.durations, graph.inner_edges)
    return None if starts is None else makespan_of(graph.durations, starts)


def planner_scores(answer: Answer, gold: StepInstance) -> Scores:
    """The measures of a Planner's answer: its stated makespan and its graph; there is no plan."""
    stated = answer.stated_makespan
    makespan = stated is not None and round(stated) == gold.makespan
    if answer.graph is None:
        return {**NOTHING, "makespan": makespan, "no_output": 1}
    graph = numbered(answer.graph)
    scores = graph_scores(graph, gold)
    sound = makespan and scores["dur"] == 1
    return {
        **scores,
        "makespan": makespan,
        "no_output": 0,
        "plan": sound and graph.edges == gold.edges,
        "plan_superset": sound and graph.edges >= gold.edges,
    }


def scheduled_scores(answer: Answer, recorded: float | None, gold: StepInstance) -> Scores:
    """The measures of an answer from which CP-SAT made a schedule of the recorded makespan.

    The last answer counts as rejected where it cannot be read, nothing is recorded, a duration is
    not positive, or its edges go round in a circle.
    """
    makespan = recorded is not None and recorded == gold.makespan
    if answer.graph is None:
        return {**NOTHING, "makespan": makespan, "invalid": 1}
    graph = numbered(answer.graph)
    rejected = recorded is None or not graph.complete or own_makespan(graph) is None
    valid = not rejected and schedule_is_valid(graph, gold)
    return {
        **graph_scores(graph, gold),
        "makespan": makespan,
        "invalid": rejected,
        "plan_valid": valid,
        "plan": valid and makespan,
    }


def schedule_is_valid(graph: NumberedGraph, gold: StepInstance) -> bool:
    """Whether CP-SAT's schedule of the graph does every gold step, as long, in the gold order."""
    durations = graph.durations
    for step, duration in gold.durations.items():
        if step not in durations or abs(durations[step] - duration) > TOLERANCE:
            return False
    return solved_order_holds(durations, graph.inner_edges, gold.edges)
