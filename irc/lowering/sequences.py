"""Lowers orders of uses: names become indexes. Loaded for tasks that have some."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

from irc.model import Task
from irc.model.details import UseOrder as UseOrderNode
from irc.problem import NOBODY, Problem, Setups, UseOrder


def add_sequences(problem: Problem, task: Task, index: Mapping[str, int]) -> Problem:
    """The problem with the orders of uses of `task`; the checks report those that have no sense.

    Their resources get set-ups, if only empty ones: the order of their uses counts.
    """
    resources = {r.id: k for k, r in enumerate(problem.resources)}
    found: list[UseOrder] = []
    for k, node in enumerate(task.sequences):
        if node.consecutive is not None:
            found += _consecutive(problem, node, k, index, resources)
        elif node.same_order is not None and all(r in resources for r in node.same_order):
            found.append(_same_order(problem, task, node, k, index, resources))
    ordered = {r for order in found for r in order.resources}
    return replace(
        problem,
        sequences=tuple(found),
        resources=tuple(
            replace(r, setups=Setups()) if k in ordered and r.setups is None else r
            for k, r in enumerate(problem.resources)
        ),
    )


def _consecutive(
    problem: Problem,
    node: UseOrderNode,
    origin: int,
    index: Mapping[str, int],
    resources: Mapping[str, int],
) -> Iterator[UseOrder]:
    first, second = (index.get(name) for name in node.consecutive or ())
    if first is None or second is None or first == second:
        return
    common = _used(problem, first) & _used(problem, second)
    if node.resource is not None:
        common &= {resources.get(node.resource, -1)}
    if common:
        yield UseOrder("consecutive", tuple(sorted(common)), ((first, second),), origin)


def _same_order(
    problem: Problem,
    task: Task,
    node: UseOrderNode,
    origin: int,
    index: Mapping[str, int],
    resources: Mapping[str, int],
) -> UseOrder:
    of = tuple(resources[r] for r in node.same_order or ())
    rows = [[index.get(name, NOBODY) for name in row] for row in node.jobs]
    if not rows:
        grouped = {name for group in task.groups for name in group.actions}
        jobs = [[*group.actions] for group in task.groups]
        jobs += [[name] for name in index if name not in grouped]
        for names in jobs:
            members = [index[name] for name in names if name in index]
            rows.append([next((i for i in members if r in _used(problem, i)), NOBODY) for r in of])
    kept = {tuple(row) for row in rows if sum(i != NOBODY for i in row) > 1}
    return UseOrder("same_order", of, tuple(sorted(kept)), origin)


def _used(problem: Problem, activity: int) -> frozenset[int]:
    """The resources that an activity may hold."""
    uses = problem.activities[activity].uses
    return frozenset(r for use in uses for r in use.alternatives)
