"""Tasks, problems and answers for tests, in few words: one place for what many test files build."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from irc.driver.compile import lower_for
from irc.driver.solve import solve_task
from irc.lowering.lower import lower
from irc.model import Task
from irc.passes import run_passes
from irc.passes.critical_path import heads_and_tails
from irc.problem import Problem
from irc.schedule import Entry, Schedule
from irc.targets import SolveOptions, get_backend
from irc.validation import Violation, validate

Document = dict[str, Any]

# --- parts of documents -------------------------------------------------------------------------


def act(name: str, duration: Any = 2, **fields: Any) -> Document:
    """An action that lasts 2 unless it is said otherwise."""
    return {"id": name, "duration": duration, **fields}


def lettered(*actions: Document) -> list[Document]:
    """Actions a, b, c, … that last 2 unless they say otherwise."""
    return [
        {"id": letter, "duration": 2, **action}
        for letter, action in zip("abcdefg"[: len(actions)], actions, strict=True)
    ]


def at(when: str, var: str, value: Any = True) -> Document:
    """A condition or an effect: both are written alike."""
    return {"at": when, "var": var, "value": value}


def state_action(
    name: str,
    duration: Any = 5,
    conditions: tuple[Document, ...] = (),
    effects: tuple[Document, ...] = (),
    **fields: Any,
) -> Document:
    """An action with its conditions and effects."""
    return act(name, duration, conditions=list(conditions), effects=list(effects), **fields)


# --- documents, tasks and problems --------------------------------------------------------------


def document_of(*actions: Document, **fields: Any) -> Document:
    """A document with these actions and further fields."""
    return {"actions": list(actions), **fields}


def task_of(*actions: Document, **fields: Any) -> Task:
    """The task with these actions and further fields."""
    return Task.model_validate(document_of(*actions, **fields))


def stock_task(*actions: Document, **flour: Any) -> Task:
    """A task whose only resource is a reservoir of flour."""
    return task_of(*actions, resources=[{"id": "flour", "kind": "reservoir", **flour}])


def problem_of(*actions: Document, **fields: Any) -> Problem:
    """The problem that the task with these actions and further fields is lowered to."""
    return lower(task_of(*actions, **fields))


def after_passes(task: Task | Mapping[str, Any]) -> Problem:
    """The problem of a task as the passes leave it."""
    return run_passes(lower(Task.model_validate(task)))


def with_heads_and_tails(task: Task) -> Problem:
    """The problem of a task with heads and tails, but every choice open and resources apart."""
    return heads_and_tails(lower(task))


def problem_for_cpsat(task: Task) -> Problem:
    """The problem that `cpsat` gets of a task."""
    return lower_for(task, get_backend("cpsat"))


# --- a kitchen: an oven, two robots and three units of power -------------------------------------

OVEN = {"uses": [{"resource": "oven"}]}
EITHER = {"uses": [{"one_of": ["r1", "r2"]}]}
KITCHEN = [{"id": "oven"}, {"id": "r1"}, {"id": "r2"}, {"id": "power", "capacity": 3}]


def power(amount: int) -> Document:
    """The field of an action that takes so much power."""
    return {"uses": [{"resource": "power", "amount": amount}]}


def kitchen_task(*actions: Document, **fields: Any) -> Task:
    """Actions a, b, … over an oven, two robots and three units of power."""
    return task_of(*lettered(*actions), **{"resources": KITCHEN, **fields})


# --- answers ------------------------------------------------------------------------------------


def engine_schedule(task: Task | Mapping[str, Any]) -> Schedule:
    """What the engine of `cpsat` finds within 10 seconds, never the shortcut past it."""
    given = Task.model_validate(task)
    return solve_task(given, SolveOptions(time_limit=10, workers=1, shortcut=False)).schedule


def violations(task: Task, *entries: Entry) -> tuple[Violation, ...]:
    """What the validator holds against a schedule of these entries."""
    return validate(task, Schedule(entries)).violations


def rules(task: Task, *entries: Entry) -> list[str]:
    """The names of the rules that a schedule of these entries violates."""
    return [violation.rule for violation in violations(task, *entries)]
