"""Couplings and selections: what the checks say before any solver."""

from __future__ import annotations

from typing import Any

import irc

ACTIONS = [
    {"id": "a", "duration": 2, "uses": [{"one_of": ["x", "y"]}]},
    {"id": "b", "duration": 2, "uses": [{"resource": "z"}], "occurs": "optional"},
    {"id": "c", "modes": [{"id": "m", "duration": 1}, {"id": "n", "duration": 2}]},
    {"id": "d", "duration": 1, "uses": [{"resource": "z"}]},
]
RESOURCES = [{"id": name} for name in "xyz"]


def places(**fields: Any) -> list[str]:
    report = irc.check({"actions": ACTIONS, "resources": RESOURCES, **fields})
    return ["/".join(map(str, error.pointer)) for error in report.errors]


def test_names_are_looked_up() -> None:
    assert places(select=[{"actions": ["bb"]}]) == ["select/0/actions/0"]
    assert places(select=[{"actions": ["b"], "if": "q"}]) == ["select/0/if"]
    assert places(couplings=[{"same": "resource", "actions": ["a", "q"]}]) == [
        "couplings/0/actions/1/action"
    ]
    made = {"if": {"action": "c", "mode": "o"}, "then": {"action": "a", "resource": "x"}}
    assert places(couplings=[made]) == ["couplings/0/if/mode"]


def test_a_selection_that_nothing_can_satisfy_is_an_error() -> None:
    assert places(select=[{"actions": ["b"], "min": 2}]) == ["select/0/min"]
    assert places(select=[{"actions": ["b", "c"], "min": 2, "max": 1}]) == ["select/0/min"]


def test_the_same_resource_of_actions_that_share_none_is_an_error() -> None:
    uses = [{"action": "a", "use": 0}, {"action": "d", "use": 0}]
    assert places(couplings=[{"same": "resource", "actions": uses}]) == ["couplings/0/actions"]
    missing = [{"action": "a", "use": 1}, "d"]
    assert places(couplings=[{"same": "resource", "actions": missing}]) == [
        "couplings/0/actions/0/action"
    ]


def test_one_kind_of_coupling_at_a_time() -> None:
    report = irc.check(
        {"actions": ACTIONS, "resources": RESOURCES, "couplings": [{"actions": ["a", "b"]}]}
    )
    assert "needs one of 'same', 'different'" in str(report)


def test_a_cancelled_action_leaves_its_selection() -> None:
    task = irc.Task(
        actions=[
            {"id": "bus", "duration": 3, "occurs": "optional"},
            {"id": "walk", "duration": 5, "occurs": "optional"},
            {"id": "read", "duration": 9},
        ],
        select=[{"actions": ["bus", "walk"], "min": 1, "max": 1}],
    ).ir
    plan = irc.solve(task)
    step = irc.replan(task, plan, 0, [irc.Event(0).cancel_actions("bus")])
    assert {e.id for e in step.schedule.entries} == {"walk", "read"}
