"""Checks of number variables: the right operators, bounds, and levels within reach."""

from __future__ import annotations

from typing import Any

import pytest

import irc
from builders import Document, act, task_of

FUEL: Document = {"id": "fuel", "kind": "number", "initial": 4, "min": 0, "max": 9}


def needs(**said: Any) -> Document:
    return {"at": "start", "var": "fuel", **said}


def gives(**said: Any) -> Document:
    return {"at": "end", "var": "fuel", **said}


WRONG: list[tuple[Document, list[Document], list[Document], str, str]] = [
    ({}, [needs(value=True)], [], "'fuel' is a number, so it has no 'value'", "at_least"),
    ({}, [needs()], [], "does not say which levels are meant", "at_least"),
    ({}, [], [gives()], "does not say how it changes", '"add" or "set"'),
    ({}, [], [gives(value="full")], "so it has no 'value'", '"add" or "set"'),
    ({}, [], [gives(add=1, set=2)], "adds to 'fuel' and sets it", "keep one"),
    ({}, [], [gives(set=10)], "becomes, 10, is outside its bounds", "at least 0 and at most 9"),
    ({"initial": 12}, [], [], "starts at, 12, is outside its bounds", "at least 0 and at most 9"),
    ({"initial": "full"}, [], [], "cannot be 'full'", "write a number"),
    ({"min": 10}, [], [], "min 10 is above max 9", "swap"),
    ({"changes": [{"at": 3, "value": -1}]}, [], [], "becomes at 3, -1, is outside", "at least 0"),
    ({}, [needs(at_least=5)], [gives(add=-1)], "at least 5, but it can be at most 4", "effect"),
    ({}, [needs(at_most="7/2")], [], "at most 3.5, but it can be at least 4", "effect"),
    ({}, [needs(at_least=5, at_most=4)], [], "which no number is", "correct"),
    ({}, [], [gives(set=1), gives(add=1)], "gives 'fuel' two levels at its end", "only"),
    ({"kind": "values"}, [needs(at_least=1)], [], "is no number", '"kind": "number"'),
    ({"kind": "values"}, [], [gives(add=1)], "is no number", '"kind": "number"'),
    ({"kind": "values"}, [], [], "has no value 4", '"kind": "number"'),
]


@pytest.mark.parametrize(("variable", "conditions", "effects", "message", "hint"), WRONG)
def test_what_is_wrong_about_a_number_is_told_with_what_to_write(
    variable: Document,
    conditions: list[Document],
    effects: list[Document],
    message: str,
    hint: str,
) -> None:
    action = act("drive", 3, conditions=conditions, effects=effects)
    report = irc.check(task_of(action, state=[FUEL | variable]))
    found = [d for d in report.errors if message in d.message]
    assert found, [d.message for d in report.errors]
    assert hint in (found[0].hint or "")


def test_a_goal_that_no_change_reaches_is_told() -> None:
    task = task_of(
        act("fill", 2, effects=[gives(add=3)]),
        state=[FUEL],
        goals=[{"var": "fuel", "at_least": 8}],
    )
    (error,) = irc.check(task).errors
    assert error.message == "a goal needs 'fuel' to be at least 8, but it can be at most 7"


@pytest.mark.parametrize(("value", "fine"), [(5, True), ("1/3", True), (-1, False), (True, False)])
def test_an_event_sets_a_number_to_a_level_within_its_bounds(value: Any, fine: bool) -> None:
    change = {"op": "set_state", "var": "fuel", "value": value}
    task = task_of(act("a", 3), state=[FUEL], events=[{"at": 1, "changes": [change]}])
    assert irc.check(task).ok is fine


def test_a_field_of_numbers_on_another_variable_has_no_effect() -> None:
    task = task_of(act("a", 3), state=[{"id": "lit", "max": 3}])
    assert any("'max' has no meaning" in d.message for d in irc.check(task).diagnostics)
