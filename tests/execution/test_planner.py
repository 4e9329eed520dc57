"""Repairs by planners, which are given what is left with the present as time 0."""

from __future__ import annotations

from typing import Any

import pytest

from builders import task_of
from irc.schedule import Status
from irc_pddl21 import Pddl21
from online_cases import action, entry, plan, repaired, starts

KAIROS = Pddl21().engines()["kairos"]
pytestmark = pytest.mark.skipif(KAIROS.missing() is not None, reason="kairos is not there")

PLANNER: dict[str, Any] = {"target": "pddl21", "engine": "kairos"}
CREW = [{"id": "ann"}, {"id": "bob"}]
ORDER = {"id": "order", "actions": ["cook", "serve"], "required": False, "reward": 5}


def test_an_old_plan_that_is_as_good_stays_as_a_whole() -> None:
    whole = task_of(
        action("wash", 2, "ann|bob"),
        action("dry", 2, "ann|bob"),
        action("sing", 1, "ann|bob", occurs="optional"),
        action("cook", 4, "ann|bob"),
        resources=CREW,
    )
    old = plan(
        entry("cook", 0, 4, "bob"),
        entry("wash", 0, 2, "ann"),
        entry("sing", 2, 3, "ann"),
        entry("dry", 4, 6, "bob"),
    )
    later = {"op": "set_release", "action": "dry", "release": 4}
    step = repaired(whole, old, 1, later, **PLANNER)
    assert (step.schedule.status, step.moved) == (Status.OPTIMAL, 0)
    assert step.schedule.entries[-1] == old.entries[-1]


def test_behind_the_deadline_only_what_must_be_is_impossible() -> None:
    optional = task_of(
        action("wash", 2, "ann"),
        action("cook", 2, "ann"),
        action("serve", 1, "ann"),
        resources=CREW,
        groups=[ORDER],
        deadline=3,
        objective=["maximize_reward"],
    )
    old = plan(entry("wash", 0, 2, "ann"))
    tired = {"op": "set_capacity", "resource": "bob", "capacity": 0}
    step = repaired(optional, old, 4, tired, **PLANNER)
    assert starts(step.schedule) == {"wash": 0}
    must = optional.model_copy(update={"groups": ()})
    assert repaired(must, old, 4, tired, **PLANNER).schedule.status is Status.INFEASIBLE


def test_a_deadline_that_has_passed_keeps_an_order_out() -> None:
    whole = task_of(
        action("wash", 6, "ann"),
        action("dry", 3, "ann|bob"),
        action("cook", 2, "ann|bob", deadline=3),
        action("serve", 1, "ann|bob"),
        resources=CREW,
        groups=[ORDER],
        objective=["maximize_reward", "minimize_makespan"],
    )
    old = plan(entry("wash", 0, 6, "ann"), entry("dry", 4, 7, "bob"))
    step = repaired(whole, old, 4, **PLANNER)
    assert starts(step.schedule) == {"wash": 0, "dry": 4}


def test_what_must_be_and_is_too_late_is_proven_at_once() -> None:
    whole = task_of(
        action("wash", 2, "ann|bob"),
        action("cook", 2, "ann|bob", start=4),
        action("dry", 2, "ann|bob"),
        resources=CREW,
    )
    old = plan(entry("wash", 0, 2, "ann"), entry("cook", 4, 6, "ann"), entry("dry", 4, 6, "bob"))
    sooner = {"op": "set_deadline", "action": "cook", "deadline": 3}
    step = repaired(whole, old, 4, sooner, **PLANNER)
    assert step.schedule.status is Status.INFEASIBLE
    assert step.notes[0].message == "'cook' must end by 3 s, but cannot end before 6 s"


@pytest.mark.slow
def test_where_the_planner_finds_nothing_it_is_proven_that_there_is_nothing() -> None:
    whole = task_of(
        action("wash", 2, effects=[{"at": "end", "var": "clean"}]),
        action("cook", 2, effects=[{"at": "end", "var": "clean", "value": False}]),
        action("rinse", 5, effects=[{"at": "end", "var": "clean"}]),
        action("dry", 2, release=4, deadline=9, conditions=[{"at": "start", "var": "clean"}]),
        state=[{"id": "clean"}],
    )
    old = plan(entry("wash", 0, 2), entry("dry", 4, 6), entry("cook", 6, 8), entry("rinse", 8, 13))
    dirty = {"op": "set_state", "var": "clean", "value": False}
    step = repaired(whole, old, 3, dirty, **PLANNER, time_limit=4, workers=1)
    assert step.schedule.status is Status.INFEASIBLE
