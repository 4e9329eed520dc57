"""Gold answers of kitchens and episodes: what CP-SAT proves to be the best, or none at all."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

from irc.driver.solve import solve_task
from irc.errors import IrcError
from irc.events.apply import apply
from irc.frontends.importers.robo import import_robo
from irc.frontends.importers.robo_online import import_robo_online
from irc.generators.kitchens import GeneratedKitchen, sequential_makespan
from irc.model import Task
from irc.model.canonical import written_task
from irc.model.times import json_number
from irc.outcome import UNKNOWN
from irc.schedule import Schedule, Status
from irc.targets import Cancellation, SolveOptions


class GoldNotProven(IrcError):
    """The best answer of an instance was not proven within the limits; the message names it."""

    ends_as = UNKNOWN


def with_gold(
    kitchen: GeneratedKitchen, time_limit: float, cancel: Cancellation | None = None
) -> dict[str, Any]:
    """The kitchen's document with its optimum. Raises `GoldNotProven`."""
    document = kitchen.document
    (task,) = _tasks(import_robo(json.dumps(document), document["id"]))
    found = _proven(task, time_limit, cancel)
    values = {level.name: json_number(level.value) for level in found.objective}
    makespan = values["makespan"]
    if "candidate_goals" in document:
        gold = {"optimal_reward": values["reward"], "optimal_makespan": makespan}
    else:
        work = sequential_makespan(kitchen)
        gold = {
            "optimal_makespan": makespan,
            "sequential_makespan": work,
            "speedup_ratio": round(work / float(makespan), 3),
        }
    solver = {"groundtruth_solver": "cp-sat", "groundtruth_solver_status": "OPTIMAL"}
    return {**document, **gold, **solver}


def with_oracle(
    document: dict[str, Any], time_limit: float, cancel: Cancellation | None = None
) -> dict[str, Any]:
    """The episode's document with the optimum of one who knows its events from the start.

    No plan that learns of them when they happen is better. Raises `GoldNotProven`.
    """
    (task,) = _tasks(import_robo_online(json.dumps(document), document["id"]))
    found = _proven(clairvoyant(task), time_limit, cancel)
    values = {f"oracle_final_{o.name}": json_number(o.value) for o in found.objective}
    return {**document, "oracle": {**document["oracle"], **values}}


def clairvoyant(task: Task) -> Task:
    """The task with all of its events known from the start.

    What an event adds still cannot begin before its instant.
    """
    known = {action.id for action in task.actions}
    releases: dict[str, Any] = {}
    for event in task.events:
        task = apply(task, event)
        new = [action.id for action in task.actions if action.id not in known]
        releases |= dict.fromkeys(new, event.at)
        known.update(new)
    document = written_task(task)
    for action in document["actions"]:
        if action["id"] in releases:
            action["release"] = json_number(task.number(releases[action["id"]]))
    return Task.model_validate(document)


def _tasks(instances: Iterator[tuple[str, Task]]) -> Iterator[Task]:
    return (task for _, task in instances)


def _proven(task: Task, time_limit: float, cancel: Cancellation | None) -> Schedule:
    options = SolveOptions("cpsat", "ortools", time_limit, workers=1, cancel=cancel)
    found = solve_task(task, options, options.budget()).schedule
    if found.status is not Status.OPTIMAL:
        raise GoldNotProven(
            f"the best answer of {task.name!r} was not proven within {time_limit:g} s "
            f"({found.status}): give it more time, or ask for a smaller size"
        )
    return found


def ir_document(document: Mapping[str, Any], family: str) -> dict[str, Any]:
    """The IR of a kitchen or an episode."""
    importer = import_robo if family == "robo" else import_robo_online
    (task,) = _tasks(importer(json.dumps(document), document["id"]))
    return written_task(task)
