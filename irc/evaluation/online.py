"""Online Robo Challenge: the final plan of an episode against all that was asked for in it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from irc.evaluation.kitchen import (
    RESULT_OF,
    Item,
    Rules,
    Run,
    exact,
    simulate,
    start_state,
)
from irc.methods import PlanLine

RUSH = "rush_"
"""How the ids of orders with a deadline begin."""

RUSH_SLACK = 5
"""Seconds that the released data leave a rush order beyond the work it needs."""

_LENIENT, _STRICT = Rules(lags=False, durations=False), Rules()


@dataclass(frozen=True)
class Order:
    """A delivery: wanted states, a stack in order, and the instant by which all is done."""

    states: Mapping[str, str]
    stack: Sequence[str]
    deadline: Fraction | None


@dataclass(frozen=True)
class Episode:
    """All of an episode, its events included, as if it were known from the start."""

    kitchen: Mapping[str, Any]
    orders: tuple[Order, ...]
    candidates: tuple[Mapping[str, Any], ...]
    limits: Mapping[str, float]
    deadline: Fraction | None


@dataclass(frozen=True)
class FinalVerdict:
    """Whether a final plan is valid: as the runs were made, with lags and durations, and also
    with deadlines."""

    plan: bool = False
    strict: bool = False
    with_deadlines: bool = False


def judge_final(episode: Episode, plan: Sequence[PlanLine]) -> FinalVerdict:
    """The verdict on the final plan of an episode."""
    lenient = simulate(episode.kitchen, plan, _LENIENT)
    if lenient.fault is not None or _missed(episode, lenient):
        return FinalVerdict()
    strict = simulate(episode.kitchen, plan, _STRICT).fault is None
    return FinalVerdict(True, strict, strict and not _is_late(episode, lenient))


def _missed(episode: Episode, run: Run) -> bool:
    """Whether a wanted state, a stack or a limit of stock is not kept."""
    for order in episode.orders:
        if any(run.states[item] != state for item, state in order.states.items()):
            return True
        if not _in_order(order.stack, run.stacked):
            return True
    used: Counter[str] = Counter()
    for goal in episode.candidates:
        if run.states[goal["item"]] == goal["state"]:
            used.update(goal.get("cost") or {})
    return any(used[name] > limit for name, limit in episode.limits.items())


def _in_order(wanted: Iterable[str], found: Iterable[str]) -> bool:
    rest = iter(found)
    return all(item in rest for item in wanted)


def _is_late(episode: Episode, run: Run) -> bool:
    if episode.deadline is not None and run.makespan > episode.deadline:
        return True
    return any(
        run.done_with(item) > order.deadline
        for order in episode.orders
        if order.deadline is not None
        for item in (*order.states, *order.stack)
    )


# --- reading an episode -------------------------------------------------------------------------


def read_episode(raw: Mapping[str, Any], source: Mapping[str, Any] | None) -> Episode:
    """An episode with its events; `source` is the instance of Robo Challenge that it is made of.

    The episodes that the runs were made with have no deadlines. Where an episode names none at
    all, those of the released data are worked out: see `released_deadlines`.
    """
    start, deltas = raw["initial_task"], [event["delta"] for event in raw["events"]]
    items = dict(start["items"])
    for delta in deltas:
        items.update(delta.get("add_items") or {})
    lags = _together(start, deltas, "temporal_constraints")
    written = _together(start, deltas, "deliveries")
    dated = [delivery["deadline"] for delivery in written if delivery.get("deadline") is not None]
    deadline = _last_deadline(start, deltas)
    by_id: Mapping[str, Fraction] = {}
    if not dated and deadline is None:
        by_id = released_deadlines(raw, items)
        deadline = None if source is None else source.get("deadline")
    return Episode(
        {**start, "items": items, "temporal_constraints": lags},
        tuple(_order(delivery, by_id) for delivery in written),
        tuple(_together(start, deltas, "candidate_goals")),
        start.get("inventory_limits") or {},
        None if deadline is None else exact(deadline),
    )


def _together(
    start: Mapping[str, Any], deltas: Sequence[Mapping[str, Any]], name: str
) -> list[Mapping[str, Any]]:
    added = (item for delta in deltas for item in delta.get(f"add_{name}") or ())
    return [*(start.get(name) or ()), *added]


def _last_deadline(start: Mapping[str, Any], deltas: Sequence[Mapping[str, Any]]) -> Any:
    named = (start.get("deadline"), *(delta.get("set_deadline") for delta in deltas))
    return next((value for value in reversed(named) if value is not None), None)


def _order(delivery: Mapping[str, Any], by_id: Mapping[str, Fraction]) -> Order:
    written = delivery.get("deadline")
    deadline = by_id.get(delivery["id"]) if written is None else exact(written)
    return Order(delivery["required_states"], delivery["stack_order"], deadline)


def released_deadlines(raw: Mapping[str, Any], items: Mapping[str, Item]) -> dict[str, Fraction]:
    """The deadlines that the released data give the rush orders, by id.

    All rush orders of an event are due at one instant: that of the event, plus the longest work
    that one of them needs (processing one after the other, then stacking), plus 5 s.
    """
    durations = raw["initial_task"]["action_durations"]
    found: dict[str, Fraction] = {}
    for event in raw["events"]:
        orders = event["delta"].get("add_deliveries") or ()
        rush = [order for order in orders if order["id"].startswith(RUSH)]
        longest = max((_work(order, items, durations) for order in rush), default=Fraction(0))
        due = exact(event["trigger_time"]) + longest + RUSH_SLACK
        found.update((order["id"], due) for order in rush)
    return found


def _work(
    order: Mapping[str, Any], items: Mapping[str, Item], durations: Mapping[str, float]
) -> Fraction:
    processing = [
        durations[action]
        for item, state in order["required_states"].items()
        for action in _actions_to(state, items[item])
    ]
    stacking = [durations["stack"]] * len(order["stack_order"])
    return sum(map(exact, [*processing, *stacking]), Fraction(0))


_MAKES = {result: action for action, result in RESULT_OF.items()}


def _actions_to(state: str, item: Item) -> list[str]:
    """The actions that bring an item to a state, the last one first."""
    actions: list[str] = []
    wanted: str | None = state
    while wanted is not None and wanted != item["state"] and len(actions) < len(_MAKES):
        action = _MAKES[wanted]
        actions.append(action)
        wanted = start_state(action, item)
    return actions
