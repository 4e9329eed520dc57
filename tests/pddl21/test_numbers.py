"""Number variables on `pddl21`: what the text says, and what is refused."""

from __future__ import annotations

from typing import Any

import pytest

import irc
from builders import Document, act, task_of
from irc.diagnostics import InputError

FUEL: Document = {"id": "fuel", "kind": "number", "initial": 1, "min": 0, "max": 3}


def text_of(*actions: Document, **more: Any) -> str:
    task = task_of(*actions, state=[FUEL | more.pop("fuel", {})], **more)
    files = irc.compile(task, "pddl21").files
    return files["domain.pddl"] + files["problem.pddl"]


def test_conditions_are_comparisons_and_effects_change_a_fluent() -> None:
    text = text_of(
        act(
            "drive",
            3,
            conditions=[
                {"at": "start", "var": "fuel", "at_least": 1},
                {"at": "all", "var": "fuel", "at_most": 2.5},
                {"at": "end", "var": "fuel", "equals": 2},
            ],
            effects=[
                {"at": "start", "var": "fuel", "add": -0.5},
                {"at": "end", "var": "fuel", "set": 3},
            ],
        ),
        goals=[{"var": "fuel", "at_least": 3}],
    )
    for said in (
        "(at start (>= (level_of_fuel) 2))",
        "(over all (<= (level_of_fuel) 5))",
        "(at end (= (level_of_fuel) 4))",
        "(at start (>= (level_of_fuel) 1))",  # Room for what the start takes.
        "(at start (decrease (level_of_fuel) 1))",
        "(at end (assign (level_of_fuel) 6))",
        "(= (level_of_fuel) 2)",
        "(>= (level_of_fuel) 6)",
    ):
        assert said in text, said


def test_timed_changes_of_a_number_are_refused_at_their_place() -> None:
    with pytest.raises(InputError) as refused:
        text_of(act("drive", 3), fuel={"changes": [{"at": 2, "value": 3}]})
    (error,) = refused.value.report.errors
    assert "timed changes of number variables" in error.message
    assert error.pointer == ("state", 0, "changes")


@pytest.mark.slow
def test_a_goal_alone_is_no_plan() -> None:
    pytest.importorskip("kairos")
    task = task_of(
        act("fill", 2, occurs="optional", effects=[{"at": "start", "var": "fuel", "add": 1}]),
        state=[FUEL],
        goals=[{"var": "fuel", "at_least": 2}],
    )
    assert [e.id for e in irc.solve(task, "pddl21", time_limit=20).entries] == ["fill"]
