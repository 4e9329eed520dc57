"""State in CP-SAT models: what needs an order within an instant, and what has none."""

from __future__ import annotations

from typing import Any

from builders import engine_schedule, task_of
from irc.schedule import Status


def gives(value: str, name: str, duration: Any, at: str = "start", **fields: Any) -> dict[str, Any]:
    effects = [{"at": at, "var": "door", "value": value}]
    return {"id": name, "duration": duration, "effects": effects, **fields}


DOOR = [{"id": "door", "values": ["shut", "open"], "initial": "shut"}]
OPEN = [{"var": "door", "value": "open"}]


def test_a_lag_as_long_as_the_horizon_still_orders_within_an_instant() -> None:
    """Closing starts no earlier, in ranks too, than two before the end of opening, its start."""
    at_once = {"before": "opening", "after": "closing", "min_lag": -2}
    actions = gives("open", "opening", 2), gives("shut", "closing", 0)
    schedule = engine_schedule(
        task_of(*actions, precedence=[at_once], state=DOOR, goals=OPEN, deadline=2)
    )
    assert schedule.status is Status.INFEASIBLE
    longer = {**at_once, "min_lag": -4}
    schedule = engine_schedule(
        task_of(*actions, precedence=[longer], state=DOOR, goals=OPEN, deadline=4)
    )
    assert (schedule.status, schedule.makespan) == (Status.OPTIMAL, 2)
