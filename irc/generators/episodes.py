"""New episodes in the form of Online Robo Challenge: a kitchen, and orders that arrive meanwhile.

Each event adds orders of the axis's kinds, or goals with a reward. The second order has a deadline
that any running kitchen can keep: what runs may end, and then this order goes first. All times are
whole minutes, so that the best answers can be proven.
"""

from __future__ import annotations

from typing import Any

from irc.generators.dice import Dice
from irc.generators.kitchens import KINDS, GeneratedKitchen

_SHARES = (20, 42, 64)
"""When events arrive, in percent of the optimum without them."""

_BONUS = 7
"""How much more a goal that arrives earns than one from the start."""


def generate_episode(kitchen: GeneratedKitchen, optimum: int, seed: int) -> dict[str, Any]:
    """The episode of a kitchen whose optimum is known."""
    source = kitchen.document
    dice = Dice("robo-online", source["id"], seed)
    split = f"online_{kitchen.axis.split}"
    count = 2 if kitchen.axis.split in ("easy", "medium") else 3
    times = [optimum * share // 100 + dice.below(2) for share in _SHARES[:count]]
    events = [_event(kitchen, k, at, dice) for k, at in enumerate(times, 1)]
    return {
        "id": f"online_{source['id']}",
        "protocol": "robo_async_online_v2",
        "source_task_id": source["id"],
        "source_split": source["split"],
        "difficulty": split,
        "challenge_features": [
            *("online", "dynamic_goal_injection", "replanning"),
            *kitchen.axis.features,
        ],
        "initial_task": _initial(source),
        "events": events,
        "oracle": {
            "replan_points": [event["trigger_time"] for event in events],
            "source_task_id": source["id"],
            "source_optimal_makespan": optimum,
        },
    }


def _initial(source: dict[str, Any]) -> dict[str, Any]:
    order = {
        "id": "source_order",
        **source["goal"],
        "deadline": None,
        "reward": None,
    }
    rewarded = "candidate_goals" in source
    return {
        "items": source["items"],
        "deliveries": [] if rewarded else [order],
        **(
            {
                "candidate_goals": source["candidate_goals"],
                "inventory_limits": source["inventory_limits"],
                "deadline": None,
            }
            if rewarded
            else {}
        ),
        "action_durations": source["action_durations"],
        "stations": source["stations"],
        "temporal_constraints": source["temporal_constraints"],
        "robots": source.get("robots", []),
    }


def _event(kitchen: GeneratedKitchen, number: int, at: int, dice: Dice) -> dict[str, Any]:
    rewarded = "candidate_goals" in kitchen.document
    delta = _goals(kitchen, number, dice) if rewarded else _orders(kitchen, number, at, dice)
    return {
        "id": f"event_{number}",
        "trigger_time": at,
        "type": "add_candidate_goal" if rewarded else "add_delivery",
        "description": (
            "A new goal with a high reward can be chosen from now on."
            if rewarded
            else "A new order arrives while the others are under way."
        ),
        "delta": {**delta, "set_deadline": None},
    }


def _orders(kitchen: GeneratedKitchen, number: int, at: int, dice: Dice) -> dict[str, Any]:
    """One order, or two at the first event of a feast."""
    split = kitchen.axis.split
    count = 2 if split == "hard_high_speedup" and number == 1 else 1
    items: dict[str, Any] = {}
    orders, lags = [], []
    for k in range(1, count + 1):
        kind = dice.one_of(sorted({*kitchen.kinds.values()}))
        item = f"online_{kind}_{kitchen.number:02}_{number}{k}"
        items[item] = KINDS[kind].document()
        stacked = split in ("easy", "hard_temporal") or dice.chance(0.4)
        lag = dice.between(2, 5) if split == "hard_temporal" else 0
        if lag:
            last = KINDS[kind].actions[-1]
            ends = {"action": last, "item": item}, {"action": "stack", "item": item}
            lags.append({"before": ends[0], "after": ends[1], "min_lag": lag})
        rush = number == 2
        orders.append(
            {
                "id": f"event_{number}_order_{k}",
                "required_states": {item: KINDS[kind].state},
                "stack_order": [item] if stacked else [],
                "deadline": _deadline(kitchen, kind, at, lag) if rush else None,
                "reward": None,
            }
        )
    return {"add_items": items, "add_deliveries": orders, "add_temporal_constraints": lags}


def _deadline(kitchen: GeneratedKitchen, kind: str, at: int, lag: int) -> int:
    """A deadline that any running kitchen can keep: all that runs ends, then this order is made."""
    durations = kitchen.document["action_durations"]
    own: int = sum(durations[action] for action in KINDS[kind].actions) + durations["stack"]
    longest: int = max(durations.values())
    return at + 1 + longest + own + lag


def _goals(kitchen: GeneratedKitchen, number: int, dice: Dice) -> dict[str, Any]:
    goals = kitchen.document["candidate_goals"]
    like = goals[dice.below(len(goals))]
    kind = kitchen.kinds[like["item"]]
    item = f"online_{kind}_{kitchen.number:02}_{number}"
    goal = {
        "id": f"dynamic_{KINDS[kind].state}_bonus_{kitchen.number:02}_{number}",
        "item": item,
        "state": KINDS[kind].state,
        "reward": like["reward"] + _BONUS,
        "cost": dict(like["cost"]),
    }
    return {"add_items": {item: KINDS[kind].document()}, "add_candidate_goals": [goal]}
