"""Number variables on `cpsat`: timed changes by hand, and no cost of a large range."""

from __future__ import annotations

import pytest

import irc
from builders import Document, act, task_of
from irc.schedule import Status

TIDE: Document = {
    "id": "depth",
    "kind": "number",
    "initial": 5,
    "changes": [{"at": 2, "value": 0}, {"at": 6, "value": 9}],
}

TIDES: list[tuple[Document, Document, Document | None, int | None]] = [
    ({"at": "start", "at_least": 5}, {}, None, 11),
    ({"at": "start", "at_most": 0}, {}, None, 7),
    ({"at": "all", "at_least": 5}, {}, None, 11),
    ({"at": "end", "at_least": 5}, {}, None, 7),
    ({"at": "end", "at_most": 0}, {}, None, None),
    ({"at": "start", "at_most": 9}, {"at": "end", "add": 1}, {"equals": 10}, 7),
    ({"at": "start", "at_most": 9}, {"at": "start", "add": 1}, {"equals": 10}, 11),
    ({"at": "start", "at_most": 9}, {"at": "start", "add": 1}, {"equals": 9}, 7),
]


@pytest.mark.slow
@pytest.mark.parametrize(("condition", "effect", "goal", "makespan"), TIDES)
def test_timed_changes_of_a_number(
    condition: Document, effect: Document, goal: Document | None, makespan: int | None
) -> None:
    sail = act(
        "sail",
        5,
        conditions=[{"var": "depth", **condition}],
        effects=[{"var": "depth", **effect}] if effect else [],
    )
    task = task_of(
        act("load", 2),
        sail,
        state=[TIDE],
        precedence=[{"before": "load", "after": "sail"}],
        goals=[] if goal is None else [{"var": "depth", **goal}],
    )
    schedule = irc.solve(task, "cpsat", time_limit=60)
    if makespan is None:
        assert schedule.status is Status.INFEASIBLE
    else:
        assert (schedule.status, schedule.makespan) == (Status.OPTIMAL, makespan)


def test_a_model_does_not_grow_with_the_range_of_a_number() -> None:
    def size(unit: int) -> int:
        fuel = {"id": "fuel", "kind": "number", "initial": 10 * unit, "min": 0, "max": 40 * unit}
        actions = [
            act(
                f"a{i}",
                3,
                conditions=[{"at": "start", "var": "fuel", "at_least": unit}],
                effects=[{"at": "end", "var": "fuel", "add": unit if i % 2 else -unit}],
            )
            for i in range(6)
        ]
        files = irc.compile(task_of(*actions, state=[fuel]), "cpsat").files
        return files["model.pbtxt"].count("constraints {")

    assert size(1) == size(1_000_000)
