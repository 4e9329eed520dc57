"""Random small tasks for each element of the vocabulary, each with its best answer."""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping

from element_laws import Best
from irc.model import Task
from oracles import pauses, setups
from oracles.mode_generators import mode_task
from oracles.pause_generators import pausing_task
from oracles.small_generators import (
    batch_task,
    coupling_task,
    objective_task,
    pair_task,
    selection_task,
    sequence_task,
)
from oracles.small_tasks import best_of
from oracles.state_brute_force import TooLargeError, optimum
from oracles.state_generators import number_task


class TooHardError(Exception):
    """Trying everything would take too long."""


def _modes(seed: int) -> tuple[Task, Best]:
    task = mode_task(seed)
    try:
        best = optimum(task, max_situations=100_000)
    except TooLargeError:
        raise TooHardError from None
    return task, None if best is None else best.vector


def _numbers(seed: int) -> tuple[Task, Best]:
    task = number_task(seed)
    try:
        best = optimum(task, max_situations=100_000)
    except TooLargeError:
        raise TooHardError from None
    return task, None if best is None else best.vector


def _objectives(seed: int) -> tuple[Task, Best]:
    document = objective_task(seed)
    return Task.model_validate(document), best_of(document)


def _couplings(seed: int) -> tuple[Task, Best]:
    document = coupling_task(seed)
    return Task.model_validate(document), best_of(document)


def _selections(seed: int) -> tuple[Task, Best]:
    document = selection_task(seed)
    return Task.model_validate(document), best_of(document)


def _sequences(seed: int) -> tuple[Task, Best]:
    document = sequence_task(seed)
    return Task.model_validate(document), best_of(document)


def _batches(seed: int) -> tuple[Task, Best]:
    document = batch_task(seed)
    return Task.model_validate(document), best_of(document)


def _pairs(seed: int) -> tuple[Task, Best]:
    document = pair_task(seed)
    return Task.model_validate(document), best_of(document)


def _setups(seed: int) -> tuple[Task, Best]:
    rng = random.Random(f"elements {seed}")
    document = setups.random_task(rng)
    for resource in document["resources"]:
        resource.pop("no_idle", None)
    levels = document["objective"]
    if rng.random() < 0.3:
        summed = [name for name in levels if name != "maximize_reward"][:2]
        rest = [name for name in levels if name not in summed]
        total = {"sum": [[rng.randint(1, 3), name] for name in summed]}
        document["objective"] = [total, *rest] if summed else levels
    best = setups.best(document)
    if best is not None:
        signs = [-1 if name == "maximize_reward" else 1 for name in document["objective"]]
        best = tuple(sign * value for sign, value in zip(signs, best, strict=True))
    return Task.model_validate(document), best


_PAUSES_UNTIL = 20


def _pauses(seed: int) -> tuple[Task, Best]:
    task = pausing_task(seed)
    best = pauses.optimum(task, _PAUSES_UNTIL)
    if best is None or (task.objective[0] != "minimize_makespan" and best.values[0]):
        raise TooHardError  # What ends later may be better.
    return task, best.values


KINDS: Mapping[str, Callable[[int], tuple[Task, Best]]] = {
    "modes": _modes,
    "numbers": _numbers,
    "objectives": _objectives,
    "couplings": _couplings,
    "selections": _selections,
    "sequences": _sequences,
    "batches": _batches,
    "small pairs": _pairs,
    "setups": _setups,
    "pauses": _pauses,
}
"""For each kind a task by its seed, with the best values of its objectives."""
