"""Number variables while a task runs: levels of the history, world changes, what cannot go on."""

from __future__ import annotations

from typing import Any

import pytest

import irc
from builders import Document, act, task_of
from irc.model import Event, Task
from irc.schedule import Entry, Schedule, Status
from irc.validation import validate

FUEL: Document = {"id": "fuel", "kind": "number", "initial": 10, "min": 0, "max": 20}


def change(at: str, **how: Any) -> Document:
    return {"at": at, "var": "fuel", **how}


def trips() -> Task:
    """Two trips, and filling up, which may be needed."""
    asks = [change("start", at_least=4)]
    return task_of(
        act("out", 5, conditions=asks, effects=[change("start", add=-4), change("end", add=-2)]),
        act("back", 5, conditions=asks, effects=[change("start", add=-4)]),
        act("fill", 3, occurs="optional", effects=[change("end", set=20)]),
        state=[FUEL],
        precedence=[{"before": "out", "after": "back"}],
    )


PLAN = Schedule((Entry("out", 0, 5), Entry("back", 5, 10, rank=1)))


def step(*changes: Document, target: str = "cpsat") -> Any:
    event = Event.model_validate({"at": 3, "changes": list(changes)})
    return irc.replan(trips(), PLAN, 3, [event], target=target, time_limit=5)


@pytest.mark.slow
@pytest.mark.parametrize("target", ["cpsat", "pddl21"])
def test_a_level_that_the_world_changes_is_planned_with(target: str) -> None:
    if target == "pddl21":
        pytest.importorskip("kairos")
    after = step({"op": "set_state", "var": "fuel", "value": 4}, target=target)
    starts = {e.id: e.start for e in after.schedule.entries}
    assert starts["out"] == 0
    assert starts["back"] >= starts["fill"] + 3 == 6
    assert validate(after.task, after.schedule, at=3).valid


@pytest.mark.slow
def test_what_has_been_used_up_stays_used_up() -> None:
    after = step({"op": "set_duration", "action": "back", "duration": 2})
    places = {e.id: (e.start, e.end) for e in after.schedule.entries}
    assert (places["out"], places["back"]) == ((0, 5), (5, 7))


@pytest.mark.slow
def test_nothing_that_continues_is_told_with_the_level_that_is_missing() -> None:
    after = step(
        {"op": "set_state", "var": "fuel", "value": 4},
        {"op": "cancel_actions", "actions": ["fill"]},
    )
    assert after.schedule.status is Status.INFEASIBLE
    assert any("'fuel'" in d.message for d in after.notes), after.notes
