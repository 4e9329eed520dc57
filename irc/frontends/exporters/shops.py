"""Exporters for job shops: the standard format, and flexible job shops (`.fjs`).

A job is a chain of actions, each on one machine of capacity 1. Jobs are numbered in the order of
their first actions, machines in the order of the resources.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from irc.frontends.exporters.refusal import Refusals
from irc.model import Action, Mode, Task
from irc.model.features import Feature

_COMMON = frozenset(
    [Feature.ZERO_DURATION, Feature.PRECEDENCE, Feature.RESOURCES, Feature.MAKESPAN]
)

_Ways = list[tuple[int, int]]
"""(number of the machine, duration) of each way to carry out an operation."""


def write_job_shop(task: Task) -> str:
    """The text of a job shop, each line ended by `-1 -1` where a job visits not each machine once.

    Raises `InputError` with each element that it cannot say.
    """
    refusals = Refusals(task, "the job shop format")
    refusals.require_features(_COMMON)
    jobs = _jobs(task, refusals)
    for job in jobs:
        if any(len(ways) != 1 for ways in job):
            refusals.add(
                f"job {jobs.index(job) + 1} has a choice of machines",
                hint="write a flexible job shop (-o FILE.fjs) instead",
            )
    refusals.raise_any()
    machines = list(range(len(task.resources)))
    plain = all(sorted(machine for ((machine, _),) in job) == machines for job in jobs)
    end = "" if plain else " -1 -1"
    rows = [" ".join(f"{m} {duration}" for ((m, duration),) in job) + end for job in jobs]
    return "\n".join([f"{len(jobs)} {len(task.resources)}", *rows]) + "\n"


def write_flexible_job_shop(task: Task) -> str:
    """The text of a flexible job shop. Raises `InputError` with what it cannot say."""
    refusals = Refusals(task, "the flexible job shop format")
    refusals.require_features(_COMMON | {Feature.MODES, Feature.ALTERNATIVES})
    jobs = _jobs(task, refusals)
    refusals.raise_any()
    rows = []
    for job in jobs:
        row = [len(job)]
        for ways in job:
            row += [len(ways), *(n for m, duration in ways for n in (m + 1, duration))]
        rows.append(" ".join(map(str, row)))
    return "\n".join([f"{len(jobs)} {len(task.resources)}", *rows]) + "\n"


def _jobs(task: Task, refusals: Refusals) -> list[list[_Ways]]:
    for k, resource in enumerate(task.resources):
        if resource.capacity != 1:
            message = f"resource {resource.id!r}: a machine has capacity 1"
            refusals.add(message, ("resources", k, "capacity"))
    machines = {resource.id: k for k, resource in enumerate(task.resources)}
    ways = {
        action.id: _ways(action, i, machines, refusals) for i, action in enumerate(task.actions)
    }
    return [[ways[id] for id in chain] for chain in _chains(task, refusals)]


def _chains(task: Task, refusals: Refusals) -> list[list[str]]:
    """The ids of each job's actions, in their order. Refuses what is no chain."""
    following: dict[str, str] = {}
    entered: set[str] = set()
    for k, edge in enumerate(task.precedence):
        if edge.before in following or edge.after in entered:
            message = (
                f"'{edge.before}' before '{edge.after}': {refusals.format} has jobs, in which "
                "each operation has at most one predecessor and one successor"
            )
            refusals.add(message, ("precedence", k))
        following[edge.before] = edge.after
        entered.add(edge.after)
    chains = [
        _chain(action.id, following, len(task.actions))
        for action in task.actions
        if action.id not in entered
    ]
    if sum(map(len, chains)) < len(task.actions):
        refusals.add("the precedence has a cycle, which no job can have", ("precedence",))
    return chains


def _chain(first: str, following: Mapping[str, str], most: int) -> list[str]:
    chain = [first]
    while (after := following.get(chain[-1])) is not None and len(chain) < most:
        chain.append(after)
    return chain


def _ways(action: Action, index: int, machines: Mapping[str, int], refusals: Refusals) -> _Ways:
    parts: Sequence[Action | Mode] = action.modes or [action]
    found: _Ways = []
    for m, part in enumerate(parts):
        at = ("actions", index, "modes", m) if action.modes else ("actions", index)
        uses = [*part.uses, *(action.uses if action.modes else ())]
        name = f"action {action.id!r}"
        duration = refusals.whole(part.duration, name, (*at, "duration"))
        if len(uses) != 1:
            message = f"{name}: an operation needs one machine, not {len(uses)}"
            refusals.add(message, at)
            continue
        found += [(machines[one], duration) for one in uses[0].alternatives]
    return found
