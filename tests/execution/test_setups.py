"""Set-ups in a running task: the family of the last use counts, and what is broken is carried."""

from __future__ import annotations

from typing import Any

import irc
from irc.model import Event
from irc.schedule import Schedule

ROWS = [
    {"from": "red", "to": "blue", "time": 5, "cost": 1},
    {"from": "blue", "to": "red", "time": 9, "cost": 2},
]


def shop(*actions: tuple[str, str], **more: Any) -> irc.Task:
    """Actions of 4 on one press, which is set up for blue."""
    return irc.Task(
        "shop",
        resources=[{"id": "press", "setups": {"initial": "blue", "times": ROWS}}],
        actions=[
            {"id": name, "duration": 4, "uses": [{"resource": "press", "family": family}]}
            for name, family in actions
        ],
        **more,
    )


def replanned(task: irc.Task, schedule: Schedule, at: int, *changes: dict[str, Any]) -> Any:
    return task.replan(schedule, at, [Event.model_validate({"at": at, "changes": list(changes)})])


def starts(schedule: Schedule) -> dict[str, Any]:
    return {entry.id: entry.start for entry in schedule.entries}


def test_what_was_used_last_says_which_setup_is_next() -> None:
    task = shop(("a", "blue"), ("b", "red"), ("c", "blue"))
    schedule = task.solve()
    assert starts(schedule) == {"a": 0, "c": 4, "b": 17}
    blue, red = (
        {"id": name, "duration": 1, "uses": [{"resource": "press", "family": family}]}
        for name, family in (("d", "blue"), ("e", "red"))
    )
    with_more = replanned(task, schedule, 18, {"op": "add_actions", "actions": [blue, red]})
    assert starts(with_more.schedule) == {"a": 0, "c": 4, "b": 17, "e": 21, "d": 27}


def test_setups_that_are_past_count_in_the_objective() -> None:
    task = shop(("a", "blue"), ("b", "red"), objective=["minimize_setup_cost", "minimize_makespan"])
    schedule = task.solve()
    step = replanned(task, schedule, 18, {"op": "add_resources", "resources": [{"id": "r"}]})
    values = {o.name: o.value for o in step.schedule.objective}
    assert values["setup_cost"] == 2


def test_a_setup_that_was_not_waited_for_is_carried() -> None:
    task = shop(("a", "blue"), ("b", "red"), ("c", "blue"))
    schedule = task.solve()
    observed = [
        {"op": "observe", "action": "b", "started": 8},
        {"op": "observe", "action": "c", "started": 4, "finished": 8},
    ]
    step = replanned(task, schedule, 10, *observed)
    assert step.schedule.status in ("optimal", "feasible")
    verdict = irc.validate(step.task, step.schedule, at=10)
    assert verdict.valid
    assert [v.rule for v in verdict.carried] == ["setup"]


def test_a_running_use_is_waited_for_with_its_setup() -> None:
    task = shop(("a", "blue"), ("c", "red"))
    schedule = task.solve()
    late = {"op": "observe", "action": "a", "started": 0, "finished": 6}
    step = replanned(task, schedule, 7, late)
    assert starts(step.schedule) == {"a": 0, "c": 15}


def test_a_use_is_not_presumed_to_have_begun_before_its_setup() -> None:
    task = shop(("a", "blue"), ("c", "red"))
    schedule = task.solve()
    assert starts(schedule) == {"a": 0, "c": 13}
    late = {"op": "observe", "action": "a", "started": 0, "finished": 6}
    assert starts(replanned(task, schedule, 14, late).schedule) == {"a": 0, "c": 15}
    assert starts(replanned(task, schedule, 16, late).schedule) == {"a": 0, "c": 16}


def kiln(*actions: dict[str, Any], **more: Any) -> irc.Task:
    """A kiln that is never idle between its uses."""
    fired = [{**action, "uses": [{"resource": "kiln"}]} for action in actions]
    return irc.Task("kiln", resources=[{"id": "kiln", "no_idle": True}], actions=fired, **more)


def test_a_gap_that_is_past_is_no_gap() -> None:
    task = kiln(
        {"id": "a", "duration": 4, "latest_start": 0},
        {"id": "b", "duration": 3, "latest_start": 20},
    )
    schedule = task.solve()
    held_up = {"op": "set_release", "action": "b", "release": 6}
    step = replanned(task, schedule, 4, held_up)
    assert step.schedule.status == "infeasible"
    now = replanned(task, schedule, 6, {"op": "observe", "action": "b", "status": "not_begun"})
    assert starts(now.schedule) == {"a": 0, "b": 6}
    assert irc.validate(now.task, now.schedule, at=6).valid


def test_what_runs_is_followed_at_once() -> None:
    task = kiln(
        {"id": "a", "duration": {"min": 4, "max": 9}, "start": 0}, {"id": "b", "duration": 3}
    )
    schedule = task.solve()
    step = replanned(task, schedule, 2, {"op": "set_release", "action": "b", "release": 7})
    assert [(e.id, e.start, e.end) for e in step.schedule.entries] == [("a", 0, 7), ("b", 7, 10)]
