"""What is said where nothing continues what has run: the limit that is in the way."""

from __future__ import annotations

from typing import Any

import pytest

import irc
from irc.execution import replan
from irc.model import Event
from irc.schedule import Status

TASK: dict[str, Any] = {
    "time_unit": "min",
    "deadline": 60,
    "resources": [
        {"id": "oven"},
        {"id": "cook", "capacity": 2},
        {"id": "eggs", "kind": "reservoir", "initial": 4},
    ],
    "state": [{"id": "table", "values": ["bare", "laid"], "initial": "bare"}],
    "actions": [
        {"id": "bake", "duration": 20, "uses": [{"resource": "oven"}]},
        {
            "id": "fry",
            "duration": 10,
            "uses": [{"resource": "cook"}],
            "consumes": [{"resource": "eggs", "amount": 2}],
        },
        {
            "id": "lay",
            "duration": 5,
            "effects": [{"at": "end", "var": "table", "value": "laid"}],
        },
        {"id": "call", "duration": 1, "start": 30},
        {
            "id": "serve",
            "duration": 5,
            "uses": [{"resource": "cook", "amount": 2}],
            "conditions": [{"at": "start", "var": "table", "value": "laid"}],
        },
    ],
    "precedence": [
        {"before": "bake", "after": "serve", "max_lag": 15},
        {"before": "fry", "after": "serve"},
    ],
    "goals": [{"var": "table", "value": "laid"}],
}


def told(*changes: dict[str, Any], at: int = 4, **fields: Any) -> list[str]:
    """What a step that has no schedule says."""
    task = irc.Task(**{**TASK, **fields}).ir
    event = Event.model_validate({"at": at, "changes": changes})
    step = replan(task, irc.solve(task), at, [event])
    assert step.schedule.status is Status.INFEASIBLE
    assert {note.code.id for note in step.notes} == {"IRC710"}
    assert all(note.hint for note in step.notes)
    return [note.message for note in step.notes]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"op": "set_duration", "action": "serve", "duration": 50},
            "all actions must end by 60 min, but cannot end before 70 min, the end of 'serve'",
        ),
        (
            {"op": "set_deadline", "action": "serve", "deadline": 22},
            "'serve' must end by 22 min, but cannot end before 25 min",
        ),
        (
            {"op": "set_release", "action": "call", "release": 33},
            "'call' must start at 30 min, but cannot start before 33 min",
        ),
        (
            {"op": "set_release", "action": "serve", "release": 40},
            "'serve' must start at most 15 min after the end of 'bake', but the best plan found "
            "has 20 min",
        ),
    ],
    ids=lambda value: value.get("op") if isinstance(value, dict) else "",
)
def test_the_limit_in_the_way_is_named(change: dict[str, Any], message: str) -> None:
    assert told(change) == [message]


def test_a_latest_start_in_the_way_is_named() -> None:
    actions = [{**a, "latest_start": 35} if a["id"] == "serve" else a for a in TASK["actions"]]
    late = {"op": "set_duration", "action": "bake", "duration": 37}
    assert told(late, actions=actions) == [
        "'serve' must start by 35 min, but cannot start before 37 min"
    ]


def test_of_several_limits_that_a_plan_breaks_only_those_in_the_way_are_named() -> None:
    precedence = [
        {"before": "bake", "after": "serve", "max_lag": 15},
        {"before": "fry", "after": "serve", "max_lag": 0},
        {"before": "lay", "after": "serve", "max_lag": 0},
    ]
    late = {"op": "set_release", "action": "serve", "release": 40}
    (message,) = told(late, precedence=precedence, deadline=None, at=1)
    assert message.startswith("'serve' must start at most 15 min after the end of 'bake'")


def test_limits_of_several_sorts_that_must_give_way_together_are_named_together() -> None:
    first, second = told({"op": "set_release", "action": "serve", "release": 70})
    assert first.startswith("all actions must end by 60 min, but the best plan found has 75 min")
    assert second.startswith("'serve' must start at most 15 min after the end of 'bake'")
