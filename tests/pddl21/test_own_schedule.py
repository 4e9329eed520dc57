"""What `pddl21` answers where no planner finds a plan in time: the compiler's own schedule."""

from __future__ import annotations

from typing import Any

import pytest

from builders import at, state_action, task_of
from irc import solve
from irc.diagnostics import Code, Diagnostic
from irc.model import Task
from irc.schedule import Status
from irc.targets import Outcome, SolveOptions
from irc_pddl21.engines import Portfolio
from online_cases import action, entry, plan, repaired, starts

OPTIONS = SolveOptions("pddl21", time_limit=5.0)
OVEN = [{"id": "oven"}]
FOUND_NOTHING = Diagnostic(Code.NO_ANSWER, "kairos: there is no plan in the text")


@pytest.fixture(autouse=True)
def no_plan(monkeypatch: pytest.MonkeyPatch) -> None:
    def unknown(*_: Any) -> Outcome:
        return Outcome(Status.UNKNOWN, "kairos", notes=(FOUND_NOTHING,))

    monkeypatch.setattr(Portfolio, "solve", unknown)
    monkeypatch.setattr(Portfolio, "missing", lambda _self: None)


def baking(**fields: Any) -> Task:
    return task_of(*(action(n, 3, "oven") for n in "abc"), resources=OVEN, **fields)


def test_it_is_the_list_schedule_of_the_compiler() -> None:
    schedule = solve(baking(precedence=[{"before": "b", "after": "a"}]), options=OPTIONS)
    assert (schedule.engine, schedule.makespan) == ("list-schedule", 9)
    assert schedule.status is Status.OPTIMAL  # The oven cannot be done earlier.


def test_it_says_that_no_planner_found_a_plan() -> None:
    task = task_of(
        action("a", 3, "oven"), action("b", 3, "oven", release=1), action("c", 4), resources=OVEN
    )
    step = repaired(task, plan(entry("c", 0, 4)), 1, target="pddl21")
    assert step.schedule.engine == "list-schedule"
    assert FOUND_NOTHING in step.notes


def test_a_deadline_that_it_does_not_keep_leaves_the_answer_unknown() -> None:
    """The rule takes the longest tail first, and `late` must come before it."""
    task = task_of(
        action("long", 5, "oven"),
        action("tail", 20),
        action("late", 2, "oven", deadline=2),
        resources=OVEN,
        precedence=[{"before": "long", "after": "tail"}],
    )
    schedule = solve(task, options=OPTIONS)
    assert schedule.status is Status.UNKNOWN


def test_of_a_running_task_with_state_it_is_the_plan_before_shifted() -> None:
    task = task_of(
        state_action("light", 2, (), (at("end", "lit"),)),
        state_action("read", 3, (at("all", "lit"),)),
        action("cook", 3, "oven"),
        state=[{"id": "lit", "initial": False}],
        resources=OVEN,
    )
    old = plan(entry("light", 1, 3), entry("read", 3, 6, rank=1), entry("cook", 0, 3, "oven"))
    later = {"op": "set_duration", "action": "light", "duration": 4}
    step = repaired(task, old, 1, later, target="pddl21")
    assert step.schedule.engine == "list-schedule"
    assert starts(step.schedule) == {"cook": 0, "light": 1, "read": 5}
    assert FOUND_NOTHING in step.notes
