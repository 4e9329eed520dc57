"""Timed changes of state on both targets, in checks, in the DSL, and while a task runs."""

from __future__ import annotations

from typing import Any

import pytest

import irc
from builders import Document, act, at, task_of
from irc.driver.solve import solve_task
from irc.frontends.dsl.printer import print_task
from irc.frontends.dsl.task import dsl_task
from irc.model import Event, Task
from irc.schedule import Status
from irc.targets import SolveOptions, get_backend

DOOR = {
    "id": "door",
    "initial": True,
    "changes": [{"at": 2, "value": False}, {"at": 6, "value": True}],
}


def walk(when: str, value: bool) -> Task:
    """Something of two seconds, then a walk of five that needs the door so at some time."""
    walker = act("walk", 5, conditions=[at(when, "door", value)])
    order = [{"before": "wait", "after": "walk"}]
    return task_of(act("wait", 2), walker, state=[DOOR], precedence=order)


WALKS = [
    ("start", True, 11),
    ("start", False, 7),
    ("all", True, 11),
    ("all", False, None),
    ("end", True, 7),
    ("end", False, None),
]


@pytest.mark.slow
@pytest.mark.parametrize("target", ["cpsat", "pddl21"])
@pytest.mark.parametrize(("when", "value", "makespan"), WALKS)
def test_what_starts_at_a_change_finds_the_new_value(
    target: str, when: str, value: bool, makespan: int | None
) -> None:
    engines = get_backend(target).engines()
    if target == "pddl21" and (missing := engines["kairos"].missing()) is not None:
        pytest.skip(missing)
    schedule = irc.solve(walk(when, value), target, time_limit=2)
    if makespan is None:
        assert schedule.status in (Status.INFEASIBLE, Status.UNKNOWN)
    else:
        assert schedule.answered
        assert schedule.makespan == makespan


def test_a_change_is_no_action_and_not_in_the_makespan() -> None:
    late = {"id": "door", "changes": [{"at": 100, "value": True}]}
    schedule = irc.solve(
        task_of(act("a", 3, conditions=[at("start", "door", False)]), state=[late])
    )
    assert (schedule.makespan, [entry.id for entry in schedule.entries]) == (3, ["a"])


@pytest.mark.parametrize("changes", [[True, False], [False, True], [False, True, False]])
@pytest.mark.parametrize("number", [False, True])
def test_ends_at_several_changes_find_each_its_side(changes: list[bool], number: bool) -> None:
    """The place of one change among the ends of its instant does not hang on the next change."""
    values = [{"at": k + 1, "value": 5 * v if number else v} for k, v in enumerate(changes)]
    needed = {"at_least": 1} if number else {"value": True}
    reads = act("b", 1, conditions=[{"at": "end", "var": "door", **needed}])
    reads["occurs"] = {"min": 2, "max": 2}
    kind = {"kind": "number", "min": 0, "max": 5, "initial": 5} if number else {"initial": True}
    task = task_of(reads, state=[{"id": "door", **kind, "changes": values}])
    schedule = solve_task(task, SolveOptions("cpsat", workers=1, shortcut=False)).schedule
    assert schedule.status is Status.OPTIMAL
    assert [(e.start, e.end) for e in schedule.entries] == [(0, 1), (1, 2)]


def test_a_goal_may_wait_for_the_world() -> None:
    task = task_of(
        act("stay", {"min": 1, "max": 9}),
        state=[DOOR | {"initial": False}],
        goals=[{"var": "door"}],
    )
    assert irc.solve(task, "cpsat").makespan == 6


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"at": 1, "value": "ajar"}, "'door' has no value 'ajar'"),
        ({"at": -1, "value": True}, "'at' is -1, before t = 0"),
        ({"at": 2, "value": True}, "'door' gets two values at 2"),
    ],
)
def test_a_change_that_cannot_be_is_an_error(change: Document, message: str) -> None:
    door: dict[str, Any] = {**DOOR, "changes": [*DOOR["changes"], change]}
    task = task_of(act("a", 3, conditions=[at("start", "door")]), state=[door])
    found = irc.check(task).errors
    assert any(message in d.message for d in found), [d.message for d in found]


def test_a_change_brings_a_value_within_reach() -> None:
    closed = {"id": "door", "changes": [{"at": 4, "value": True}]}
    task = task_of(act("walk", 2, conditions=[at("start", "door")]), state=[closed])
    assert irc.check(task).ok
    assert irc.solve(task, "cpsat").makespan == 6


def test_the_dsl_says_it_and_prints_it() -> None:
    text = """
state door initial true changes to false at 2 changes to true at 6
state light = green, red initial red changes to green at 1 min
walk 5 needs door throughout, light = green at start
"""
    task = dsl_task(text).task
    assert task is not None
    assert [(c.at, c.value) for c in task.state[0].changes] == [(2, False), (6, True)]
    assert dsl_task(print_task(task)).task == task


@pytest.mark.slow
def test_what_has_changed_stays_changed_when_the_rest_is_planned_again() -> None:
    task = walk("start", True)
    schedule = irc.solve(task, "cpsat")
    event = Event.model_validate(
        {"at": 3, "changes": [{"op": "set_duration", "action": "walk", "duration": 4}]}
    )
    for target in ("cpsat", "pddl21"):
        step = irc.replan(task, schedule, 3, [event], target=target, time_limit=3)
        assert step.schedule.makespan == 10
