"""Late work: by how much, why, and changes that help, each verified by solving again."""

from __future__ import annotations

import pytest

import irc
from irc.model import Task
from oracles.late_work import faults_of, shop


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_the_changes_that_are_suggested_help(seed: int) -> None:
    faults, late = faults_of(shop(seed))
    assert (faults, late > 1) == ([], True)


MILL = {
    "time_unit": "min",
    "resources": [{"id": "mill"}],
    "actions": [
        {"id": "rough", "duration": 50, "uses": [{"resource": "mill"}]},
        {"id": "fine", "duration": 30, "uses": [{"resource": "mill"}], "due": 60, "weight": 3},
        {"id": "other", "duration": 40, "uses": [{"resource": "mill"}], "due": 50},
    ],
    "precedence": [["rough", "fine"]],
    "objective": ["minimize_tardiness", "minimize_makespan"],
}


def test_what_cannot_be_on_time_has_a_conflict() -> None:
    said = irc.explain_lateness(MILL, "fine")
    assert (said.late, said.possible, said.minimal) == (20, False, True)
    assert {s.text for s in said.conflict} == {
        "'rough' takes 50 min",
        "'fine' takes 30 min",
        "'rough' precedes 'fine'",
        "'fine' is due at 60 min",
    }
    assert [c.text for c in said.changes] == [
        "let 'fine' be due 20 min later",
        "'rough' takes 20 min less",
        "'fine' takes 20 min less",
        "without this: 'rough' precedes 'fine'",
    ]


def test_what_could_be_on_time_names_who_would_pay() -> None:
    said = irc.explain_lateness(MILL, "other")
    assert (said.late, said.possible, said.conflict) == (70, True, ())
    assert [(s.name, s.late, s.would_be) for s in said.instead] == [("fine", 20, 60)]
    assert [c.text for c in said.changes] == [
        "one more of 'mill'",
        "let 'other' be due 70 min later",
    ]


def test_an_order_is_late_with_its_last_action() -> None:
    order = {**MILL, "groups": [{"id": "order 7", "actions": ["rough", "fine"], "due": 70}]}
    said = irc.explain_lateness(order, "order 7")
    assert (said.end, said.late, said.possible) == (80, 10, False)
    assert "let 'order 7' be due 10 min later" in [c.text for c in said.changes]


def test_work_that_is_on_time_or_has_no_due_date_is_no_riddle() -> None:
    on_time = irc.explain_lateness({**MILL, "objective": "minimize_makespan"}, "rough")
    assert (on_time.due, on_time.late, on_time.changes) == (None, 0, ())
    with pytest.raises(irc.InputError, match="did you mean `other`"):
        irc.explain_lateness(MILL, "othr")


def test_a_task_without_a_schedule_has_no_late_work() -> None:
    task = Task.model_validate({**MILL, "deadline": 60})
    assert irc.explain_lateness(task, "fine").to_dict()["status"] == "infeasible"
