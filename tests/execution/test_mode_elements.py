"""What the chosen mode takes and changes is a fact once the action has begun."""

from __future__ import annotations

from typing import Any

import irc

TASK: dict[str, Any] = {
    "resources": [{"id": "budget", "kind": "reservoir", "initial": 100}, {"id": "mill"}],
    "state": [{"id": "dusty"}],
    "actions": [
        {
            "id": "cut",
            "modes": [
                {
                    "id": "mill",
                    "duration": 8,
                    "uses": [{"resource": "mill"}],
                    "cost": 20,
                    "consumes": [{"resource": "budget", "amount": 60}],
                    "effects": [{"at": "start", "var": "dusty", "value": True}],
                },
                {
                    "id": "laser",
                    "duration": 2,
                    "cost": 90,
                    "consumes": [{"resource": "budget", "amount": 30}],
                },
            ],
        }
    ],
    "objective": "minimize_cost",
}


def later(action: dict[str, Any]) -> irc.Schedule:
    task = irc.Task(**TASK).ir
    plan = irc.solve(task)
    assert plan.entries[0].mode == "mill"
    event = irc.Event(3).add_actions(action)
    return irc.replan(task, plan, 3, [event]).schedule


def test_the_stock_that_its_mode_has_taken_is_gone() -> None:
    wants: dict[str, Any] = {
        "id": "more",
        "duration": 1,
        "consumes": [{"resource": "budget", "amount": 50}],
    }
    assert [e.id for e in later(wants).entries] == ["cut"]
    wants["consumes"][0]["amount"] = 40
    assert [e.id for e in later(wants).entries] == ["cut", "more"]


def test_the_state_that_its_mode_has_set_holds() -> None:
    needs = {"id": "sweep", "duration": 1, "conditions": [{"at": "start", "var": "dusty"}]}
    step = later(needs)
    assert [e.start for e in step.entries if e.id == "sweep"] == [3]


def test_its_mode_and_cost_stay() -> None:
    step = later({"id": "other", "duration": 1})
    assert {o.name: o.value for o in step.objective}["cost"] == 20
