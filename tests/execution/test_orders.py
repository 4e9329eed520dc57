"""Orders of uses and loads in a running task: history counts, what it has broken binds no more."""

from __future__ import annotations

from typing import Any

import irc
from irc.model import Event
from irc.schedule import Schedule


def replanned(task: irc.Task, schedule: Schedule, at: int, *changes: dict[str, Any]) -> Any:
    step = task.replan(schedule, at, [Event.model_validate({"at": at, "changes": list(changes)})])
    assert step.schedule.answered, [d.message for d in step.schedule.reasons]
    verdict = irc.validate(step.task, step.schedule, at=at)
    assert verdict.valid, verdict
    return step


def starts(schedule: Schedule) -> dict[str, Any]:
    return {entry.id: entry.start for entry in schedule.entries}


def on(resource: str, name: str, duration: int = 4, **more: Any) -> dict[str, Any]:
    return {"id": name, "duration": duration, "uses": [{"resource": resource}], **more}


def shop(*sequences: dict[str, Any], **more: Any) -> irc.Task:
    """Two actions on a press, and two on a saw."""
    return irc.Task(
        resources=[{"id": "press"}, {"id": "saw"}],
        actions=[on("press", "a"), on("press", "b"), on("saw", "c"), on("saw", "d")],
        sequences=sequences,
        **more,
    )


def test_what_is_next_stays_next_after_the_first_has_ended() -> None:
    task = shop({"consecutive": ["a", "b"]}, precedence=[{"before": "a", "after": "b", "lag": 5}])
    urgent = {"op": "add_actions", "actions": [on("press", "x", 1, deadline=20)]}
    step = replanned(task, task.solve(), 6, urgent)
    found = starts(step.schedule)
    assert (found["a"], found["b"], found["x"]) == (0, 9, 13)


def test_what_is_next_is_waited_for_while_the_first_runs() -> None:
    task = shop({"consecutive": ["a", "b"]}, precedence=[{"before": "c", "after": "b", "lag": 5}])
    urgent = {"op": "add_actions", "actions": [on("press", "x", 1)]}
    found = starts(replanned(task, task.solve(), 3, urgent).schedule)
    assert (found["a"], found["b"], found["x"]) == (0, 9, 13)


def test_a_use_between_that_has_begun_is_carried() -> None:
    task = shop({"consecutive": ["a", "b"]})
    schedule = task.solve()
    between = {"op": "add_actions", "actions": [on("press", "x", 3)]}
    observed = {"op": "observe", "action": "x", "started": 4}
    late = {"op": "observe", "action": "b", "status": "not_begun"}
    step = replanned(task, schedule, 5, between, observed, late)
    found = starts(step.schedule)
    assert (found["a"], found["x"], found["b"]) == (0, 4, 7)
    verdict = irc.validate(step.task, step.schedule, at=5)
    assert [v.rule for v in verdict.carried] == ["sequence"]


def test_an_order_that_is_history_is_that_of_the_other_resource() -> None:
    order = {"same_order": ["press", "saw"], "jobs": [["a", "c"], ["b", "d"]]}
    task = shop(order, precedence=[("a", "c"), ("b", "d")])
    schedule = task.solve()
    first, second = ("a", "b") if schedule["a"].start == 0 else ("b", "a")
    other = {"a": "c", "b": "d"}
    slow = {"op": "set_duration", "action": second, "duration": 1}
    found = starts(replanned(task, schedule, 2, slow).schedule)
    assert found[first] < found[second]
    assert found[other[first]] < found[other[second]]


def test_a_broken_order_of_jobs_binds_no_more() -> None:
    order = {"same_order": ["press", "saw"], "jobs": [["a", "c"], ["b", "d"]]}
    task = shop(order)
    schedule = task.solve()
    wrong = [
        {"op": "observe", "action": "a", "started": 0, "finished": 3},
        {"op": "observe", "action": "c", "status": "not_begun"},
        {"op": "observe", "action": "d", "started": 0, "finished": 3},
        {"op": "observe", "action": "b", "status": "not_begun"},
    ]
    step = replanned(task, schedule, 3, *wrong)
    verdict = irc.validate(step.task, step.schedule, at=3)
    assert [v.rule for v in verdict.carried] == ["sequence"]


def kiln(**more: Any) -> irc.Task:
    """Two actions of one load, and one for the next."""
    return irc.Task(
        resources=[{"id": "kiln", "kind": "batch", "capacity": 3}],
        actions=[on("kiln", "a"), on("kiln", "b"), on("kiln", "c", 2)],
        **more,
    )


def test_nothing_joins_a_load_that_has_begun() -> None:
    task = kiln(precedence=[("a", "c")])
    schedule = task.solve()
    assert starts(schedule) == {"a": 0, "b": 0, "c": 4}
    more = {"op": "add_actions", "actions": [on("kiln", "x", 3), on("kiln", "y", 2)]}
    found = starts(replanned(task, schedule, 1, more).schedule)
    assert (found["a"], found["b"]) == (0, 0)
    assert found["x"] >= 4
    assert found["y"] == found["c"]


def test_the_end_of_a_running_load_is_waited_for() -> None:
    task = kiln(precedence=[("a", "c")])
    late = {"op": "observe", "action": "a", "status": "running", "expected_end": 6}
    later = {"op": "observe", "action": "b", "status": "running", "expected_end": 6}
    found = starts(replanned(task, task.solve(), 3, late, later).schedule)
    assert found == {"a": 0, "b": 0, "c": 6}


def test_a_load_that_history_has_broken_is_carried() -> None:
    task = kiln(precedence=[("a", "c")])
    first, second = ({"op": "observe", "action": n, "started": k} for n, k in (("a", 0), ("b", 2)))
    step = replanned(task, task.solve(), 3, first, second)
    assert starts(step.schedule) == {"a": 0, "b": 2, "c": 6}
    verdict = irc.validate(step.task, step.schedule, at=3)
    assert [v.rule for v in verdict.carried] == ["load"]


def test_nothing_is_presumed_to_join_a_load_that_began_earlier() -> None:
    """`b` was planned with `a`, which began later; so it has not begun at 0 by itself."""
    task = kiln()
    schedule = task.solve()
    delayed = {"op": "observe", "action": "a", "started": 1}
    step = replanned(task, schedule, 2, delayed)
    assert irc.validate(step.task, step.schedule, at=2).valid
