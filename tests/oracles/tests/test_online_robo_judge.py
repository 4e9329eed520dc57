"""The judge of online episodes approves a history made by hand, and nothing that is worse."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import pytest

from oracles.online_robo import judge

Document = dict[str, Any]

EPISODE: Document = {
    "initial_task": {
        "items": {
            "patty": {"state": "raw", "predicates": ["iscookable"]},
            "tofu": {"state": "raw", "predicates": ["iscookable"]},
            "yam": {"state": "raw", "predicates": ["isboilable"], "mash_requires_boiled": True},
            "bun": {"state": "ready", "predicates": []},
        },
        "deliveries": [
            {
                "id": "order",
                "required_states": {"patty": "grilled"},
                "stack_order": ["bun", "patty"],
                "deadline": None,
                "reward": None,
            }
        ],
        "candidate_goals": [
            {"id": "side", "item": "yam", "state": "mashed", "reward": 5, "cost": {"root": 1}}
        ],
        "deadline": None,
        "inventory_limits": {"root": 1, "protein": 1},
        "action_durations": {"grill": 10.0, "boil": 12.0, "mash": 4.0, "cut": 3.0, "stack": 1.0},
        "stations": {"grill": 1, "boiler": 1, "cutting_board": 1},
        "temporal_constraints": [
            {
                "before": {"action": "grill", "item": "patty"},
                "after": {"action": "stack", "item": "patty"},
                "min_lag": 3,
                "max_lag": 8,
            }
        ],
        "robots": ["robot1", "robot2"],
    },
    "events": [
        {
            "id": "late",
            "trigger_time": 2.29,
            "delta": {
                "add_items": {"leek": {"state": "raw", "predicates": ["iscuttable"]}},
                "add_deliveries": [
                    {
                        "id": "more",
                        "required_states": {"leek": "cut"},
                        "stack_order": ["leek"],
                        "deadline": None,
                        "reward": None,
                    }
                ],
                "add_candidate_goals": [
                    {
                        "id": "other",
                        "item": "tofu",
                        "state": "grilled",
                        "reward": 7,
                        "cost": {"protein": 1},
                    }
                ],
                "set_deadline": None,
            },
        }
    ],
}


def entry(name: str, start: float, end: float, *held: str) -> Document:
    return {"id": name, "start": start, "end": end, "resources": dict.fromkeys(held, 1)}


def schedule(reward: int, makespan: float, *actions: Document) -> Document:
    objective = [{"name": "reward", "value": reward}, {"name": "makespan", "value": makespan}]
    return {"status": "optimal", "objective": objective, "actions": list(actions)}


FIRST = (
    entry("grill_patty", 0, 10, "grill", "robot1"),
    entry("boil_yam", 0, 12, "boiler", "robot2"),
    entry("stack_bun", 10, 11, "robot1"),
    entry("mash_yam", 12, 16, "cutting_board", "robot2"),
    entry("stack_patty", 13, 14, "robot1"),
)
"""The yam takes 16 whatever else is done."""

BEST = (
    *FIRST[:3],
    entry("grill_tofu", 11, 21, "grill", "robot1"),
    entry("cut_leek", 12, 15, "cutting_board", "robot2"),
    entry("stack_patty", 15, 16, "robot2"),
    entry("mash_yam", 16, 20, "cutting_board", "robot2"),
    entry("stack_leek", 20, 21, "robot2"),
)

SLOWER = (
    *FIRST[:2],
    entry("grill_tofu", 10, 20, "grill", "robot1"),
    entry("stack_bun", 12, 13, "robot2"),
    entry("stack_patty", 13, 14, "robot2"),
    entry("mash_yam", 14, 18, "cutting_board", "robot2"),
    entry("cut_leek", 18, 21, "cutting_board", "robot2"),
    entry("stack_leek", 21, 22, "robot2"),
)


def history(end: int = 21, moved: int = 2, actions: tuple[Document, ...] = BEST) -> Document:
    first, last = schedule(5, 16, *FIRST), schedule(12, end, *actions)
    steps = [
        {"at": 0, "event": None, "completed": [], "running": [], "moved": 0, "schedule": first},
        {
            "at": 2.29,
            "event": ["late"],
            "completed": [],
            "running": ["boil_yam", "grill_patty"],
            "moved": moved,
            "schedule": last,
        },
    ]
    document: Document = json.loads(json.dumps({"steps": steps, "final": last}))
    return document


def last_entry(document: Document, name: str) -> Document:
    actions = document["steps"][-1]["schedule"]["actions"]
    found: Document = next(a for a in actions if a["id"] == name)
    return found


def test_a_history_as_good_as_its_continuations_is_approved() -> None:
    verdict = judge(EPISODE, history())
    assert verdict.faults == ()
    assert verdict.approved
    assert verdict.optima == ((5, 16), (12, 21))


CORRUPTIONS: dict[str, tuple[Callable[[Document], Any], str]] = {
    "duration": (lambda d: last_entry(d, "mash_yam").update(end=21), "takes 5, not 4"),
    "history": (lambda d: last_entry(d, "boil_yam").update(start=1, end=13), "as it was"),
    "before the event": (
        lambda d: last_entry(d, "cut_leek").update(start=1, end=4),
        "before the event",
    ),
    "station": (lambda d: last_entry(d, "grill_tofu").update(start=9, end=19), "2 of grill"),
    "robot": (
        lambda d: last_entry(d, "stack_patty").update(resources={"robot1": 1}),
        "2 of robot1",
    ),
    "no robot": (lambda d: last_entry(d, "stack_bun").update(resources={}), "holds {}"),
    "order": (lambda d: last_entry(d, "stack_bun").update(start=22, end=23), "stack_bun and"),
    "greatest lag": (lambda d: last_entry(d, "stack_patty").update(start=19, end=20), "to 8"),
    "least lag": (lambda d: last_entry(d, "stack_patty").update(start=12, end=13), "are 3"),
    "processing": (lambda d: last_entry(d, "mash_yam").update(start=11, end=15), "boil_yam and"),
    "half-done": (
        lambda d: d["steps"][-1]["schedule"]["actions"].remove(last_entry(d, "mash_yam")),
        "only ['boil_yam']",
    ),
    "given up": (
        lambda d: (
            last_entry(d, "boil_yam").update(status="abandoned"),
            d["steps"][-1]["schedule"]["actions"].remove(last_entry(d, "mash_yam")),
        ),
        "should finish 1",
    ),
    "missing": (
        lambda d: d["steps"][-1]["schedule"]["actions"].remove(last_entry(d, "stack_leek")),
        "stack_leek is missing",
    ),
    "reward": (
        lambda d: d["steps"][-1]["schedule"]["actions"].remove(last_entry(d, "grill_tofu")),
        "says that its reward",
    ),
    "moved": (lambda d: d["steps"][-1].update(moved=1), "2 moved"),
    "running": (lambda d: d["steps"][-1].update(running=[]), "running are"),
    "final": (lambda d: d["final"]["actions"].pop(), "the final schedule"),
    "infeasible": (
        lambda d: d["steps"][-1]["schedule"].update(status="infeasible", actions=[]),
        "there is a continuation",
    ),
}


@pytest.mark.parametrize("name", CORRUPTIONS)
def test_a_corrupted_history_is_refused(name: str) -> None:
    document = history()
    corrupt, said = CORRUPTIONS[name]
    corrupt(document)
    assert any(said in fault for fault in judge(EPISODE, document).faults)


def test_a_history_that_is_valid_and_slower_is_not_approved() -> None:
    document = history(22, 3, SLOWER)
    assert "is called optimal" in judge(EPISODE, document).faults[0]
    document["steps"][-1]["schedule"]["status"] = "feasible"
    verdict = judge(EPISODE, document)
    assert not verdict.faults
    assert not verdict.approved
    assert verdict.worse == {
        1: "reward 12, makespan 22, and reward 12, makespan 21 is possible",
    }
