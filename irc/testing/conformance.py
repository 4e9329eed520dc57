"""The conformance suite for backends: irc's own pass it, and so should those of third parties.

>>> from irc.testing import CONFORMANCE_TASKS
>>> [case.name for case in CONFORMANCE_TASKS][:2]
['one action', 'a chain']

A package that brings a backend calls `check_backend(MyBackend())` in its own tests.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from irc.diagnostics import InputError
from irc.driver.compile import lower_for
from irc.driver.judge import finish, validate_schedule
from irc.errors import IrcError
from irc.model import Task
from irc.schedule import Status
from irc.targets import Backend, Budget, Engine, Program, SolveOptions, refused_features


@dataclass(frozen=True)
class Case:
    """A small task with the makespan of an optimal schedule; None if it has no schedule."""

    name: str
    document: dict[str, Any]
    optimum: int | None

    @property
    def task(self) -> Task:
        """The typed task."""
        return Task.model_validate(self.document)


def _actions(**durations: Any) -> list[dict[str, Any]]:
    return [{"id": name, "duration": duration} for name, duration in durations.items()]


def _on(name: str, duration: int, *uses: Any, **more: Any) -> dict[str, Any]:
    listed = [
        {"one_of": list(use)} if isinstance(use, tuple) else {"resource": use} for use in uses
    ]
    return {"id": name, "duration": duration, "uses": listed, **more}


def _lag(before: str, after: str, **more: Any) -> dict[str, Any]:
    return {"before": before, "after": after, **more}


_BOARD = [{"id": "board", "capacity": 2}]
_OVEN = [{"id": "oven"}]
_ROBOTS = [{"id": "r1"}, {"id": "r2"}]

CONFORMANCE_TASKS: tuple[Case, ...] = (
    Case("one action", {"actions": _actions(a=5)}, 5),
    Case("a chain", {"actions": _actions(a=2, b=3), "precedence": [["a", "b"]]}, 5),
    Case(
        "a milestone",
        {"actions": _actions(a=2, m=0, b=3), "precedence": [["a", "m"], ["m", "b"]]},
        5,
    ),
    Case(
        "a minimum lag",
        {"actions": _actions(a=2, b=3), "precedence": [_lag("a", "b", min_lag=4)]},
        9,
    ),
    Case(
        "a maximum lag between releases",
        {
            "actions": [*_actions(a=2), {"id": "b", "duration": 3, "release": 10}],
            "precedence": [_lag("a", "b", max_lag=1)],
        },
        13,
    ),
    Case(
        "a negative lag",
        {"actions": _actions(a=6, b=3), "precedence": [_lag("a", "b", min_lag=-2)]},
        7,
    ),
    Case(
        "start to start and finish to finish",
        {
            "actions": _actions(a=4, b=2),
            "precedence": [
                _lag("a", "b", type="start-start", min_lag=1),
                _lag("a", "b", type="finish-finish", min_lag=3),
            ],
        },
        7,
    ),
    Case(
        "starts that coincide",
        {
            "actions": [*_actions(a=4), {"id": "b", "duration": 2, "release": 3}],
            "precedence": [_lag("a", "b", type="start-start", max_lag=0)],
        },
        7,
    ),
    Case("a release", {"actions": [{"id": "a", "duration": 2, "release": 3}]}, 5),
    Case("a fixed start", {"actions": [{"id": "a", "duration": 2, "start": 4}]}, 6),
    Case(
        "a deadline that decides the order",
        {
            "resources": _OVEN,
            "actions": [_on("a", 4, "oven"), _on("b", 3, "oven", deadline=4)],
        },
        7,
    ),
    Case(
        "a latest start that decides the order",
        {
            "resources": _OVEN,
            "actions": [_on("a", 4, "oven"), _on("b", 3, "oven", latest_start=1)],
        },
        7,
    ),
    Case(
        "one oven for three",
        {
            "resources": _OVEN,
            "actions": [_on(n, d, "oven") for n, d in (("a", 3), ("b", 4), ("c", 5))],
        },
        12,
    ),
    Case(
        "freed capacity is taken at the same instant",
        {
            "resources": _OVEN,
            "actions": [_on("a", 3, "oven"), _on("b", 2, "oven")],
            "deadline": 5,
        },
        5,
    ),
    Case(
        "two at a time",
        {"resources": _BOARD, "actions": [_on(n, 4, "board") for n in "abc"]},
        8,
    ),
    Case(
        "amounts that fill a resource",
        {
            "resources": [{"id": "power", "capacity": 3}],
            "actions": [
                {"id": "a", "duration": 3, "uses": [{"resource": "power", "amount": 2}]},
                {"id": "b", "duration": 4, "uses": [{"resource": "power", "amount": 2}]},
                {"id": "c", "duration": 7, "uses": [{"resource": "power", "amount": 1}]},
            ],
        },
        7,
    ),
    Case(
        "one of two robots",
        {"resources": _ROBOTS, "actions": [_on(n, 3, ("r1", "r2")) for n in "abc"]},
        6,
    ),
    Case(
        "a robot that is also wanted by name",
        {
            "resources": _ROBOTS,
            "actions": [_on("a", 3, ("r1", "r2")), _on("b", 3, "r1"), _on("c", 3, "r1")],
        },
        6,
    ),
    Case(
        "a duration the solver chooses",
        {
            "actions": [{"id": "a", "duration": {"min": 2, "max": 6}}, *_actions(b=5)],
            "precedence": [_lag("a", "b", type="finish-finish", max_lag=0)],
        },
        5,
    ),
    Case(
        "a deadline that resources cannot meet",
        {
            "resources": _OVEN,
            "actions": [_on(n, 3, "oven") for n in "ab"],
            "deadline": 5,
        },
        None,
    ),
    Case(
        "tenths of a second",
        {
            "actions": [{"id": "a", "duration": "0.1 s"}, {"id": "b", "duration": "1900 ms"}],
            "precedence": [["a", "b"]],
        },
        2,
    ),
)


class ConformanceError(IrcError, AssertionError):
    """A backend that breaks the contract; the message says on which task and how."""


def check_backend(backend: Backend, seconds: float = 10.0) -> int:
    """Runs every conformance task through a backend and all of its installed engines.

    Returns the number of (task, engine) pairs solved and validated. A task with a feature the
    backend does not support must be refused. Raises `ConformanceError` otherwise.
    """
    return sum(1 for case in CONFORMANCE_TASKS for _ in _check(case, backend, seconds))


def _check(case: Case, backend: Backend, seconds: float) -> Iterator[str]:
    if refused_features(case.task, backend):
        try:
            lower_for(case.task, backend)
        except InputError:
            return
        raise ConformanceError(f"{case.name}: an unsupported feature was not refused")
    program = Program(backend, case.task, lower_for(case.task, backend))
    _check_encoding(case, program)
    for name, engine in backend.engines().items():
        if engine.missing() is None and name != "auto":
            _check_engine(case, program, engine, seconds)
            yield name


def _check_encoding(case: Case, program: Program) -> None:
    turned = {
        key: list(reversed(value)) if isinstance(value, list) else value
        for key, value in reversed(case.document.items())
    }
    task = Task.model_validate(turned)
    again = Program(program.backend, task, lower_for(task, program.backend))
    if dict(again.files) != dict(program.files):
        raise ConformanceError(f"{case.name}: the files depend on the order of the input")
    if again.manifest_text() != program.manifest_text():
        raise ConformanceError(f"{case.name}: the manifest depends on the order of the input")
    json.loads(program.manifest_text())


def _check_engine(case: Case, program: Program, engine: Engine, seconds: float) -> None:
    outcome = engine.solve(program, SolveOptions(time_limit=seconds, workers=1), Budget(seconds))
    where = f"{case.name}, {program.target} with {engine.name}"
    schedule = finish(case.task, program.problem, outcome, program.target, outcome.seconds)
    if outcome.schedule is None:
        honest = {Status.UNKNOWN} | ({Status.INFEASIBLE} if case.optimum is None else set())
        if schedule.status not in honest or (case.optimum is not None and seconds >= 10):
            raise ConformanceError(f"{where}: {schedule.status}, but the optimum is {case.optimum}")
        return
    verdict = validate_schedule(case.task, schedule)
    if not verdict.valid:
        raise ConformanceError(f"{where}: {verdict}")
    if case.optimum is None or schedule.makespan < case.optimum:
        raise ConformanceError(f"{where}: {schedule.makespan} beats the optimum {case.optimum}")
    if schedule.status is Status.OPTIMAL and schedule.makespan != case.optimum:
        raise ConformanceError(f"{where}: {schedule.makespan} is called optimal")
