"""Kitchens and episodes in plain English, from templates."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from irc.generators.words import joined

_GERUNDS = {
    "grill": "grilling",
    "cut": "cutting",
    "fry": "frying",
    "boil": "boiling",
    "toast": "toasting",
    "marinate": "marinating",
    "mash": "mashing",
    "stack": "stacking",
}
_MAY = {
    "iscookable": "can be grilled raw",
    "iscookableifmarinated": "can be grilled once it is marinated",
    "iscuttable": "can be cut raw",
    "isfryable": "can be fried raw",
    "isfryableifcut": "can be fried once it is cut",
    "isboilable": "can be boiled raw",
    "ismarinatable": "can be marinated once it is cut",
}


def kitchen_text(document: Mapping[str, Any]) -> str:
    """A kitchen in sentences: what there is, what each action takes, and what is wanted."""
    lines = [*_there_is(document), "", *_items(document["items"]), ""]
    candidates = document.get("candidate_goals", ())
    if candidates:
        lines += [
            "Choose which of these goals to fulfil, so that the sum of the rewards is as great as "
            f"possible, and all that is begun ends by minute {document['deadline']}:",
            *map(_candidate, candidates),
            _stock(document["inventory_limits"]),
        ]
    else:
        goal = document["goal"]
        lines += [*_order(goal), "Everything is to be ready as early as possible."]
    return "\n".join([*lines, *map(_lag, document["temporal_constraints"])]) + "\n"


def episode_text(document: Mapping[str, Any]) -> str:
    """An episode in sentences: the kitchen at the start, then each event with its time."""
    initial = document["initial_task"]
    lines = [*_there_is(initial), "", *_items(initial["items"]), ""]
    for order in initial["deliveries"]:
        lines += _order(order)
    lines += map(_candidate, initial.get("candidate_goals", ()))
    if initial.get("inventory_limits"):
        lines.append(_stock(initial["inventory_limits"]))
    lines += map(_lag, initial["temporal_constraints"])
    for event in document["events"]:
        lines += ["", f"At minute {event['trigger_time']:g}: {event['description']}"]
        delta = event["delta"]
        lines += _items(delta["add_items"])
        for order in delta.get("add_deliveries", ()):
            lines += _order(order)
        lines += map(_candidate, delta.get("add_candidate_goals", ()))
        lines += map(_lag, delta.get("add_temporal_constraints", ()))
    return "\n".join(lines) + "\n"


def _there_is(document: Mapping[str, Any]) -> list[str]:
    stations = [
        f"{count} {_plain(name)}{'' if count == 1 else 's'}"
        for name, count in document["stations"].items()
    ]
    times = [
        f"{_GERUNDS[action]} takes {duration:g} minute{'' if duration == 1 else 's'}"
        for action, duration in document["action_durations"].items()
    ]
    robots = document.get("robots") or ()
    hands = f"Each action needs one of the robots {joined(robots)}." if len(robots) > 1 else ""
    first = f"In the kitchen there are {joined(stations)}; each has room for one item at a time."
    second = f"{joined(times)}."
    rules = (
        "Mashing is done on a cutting board, and only with what is boiled. Stacking needs no "
        "station. An item is stacked when it is in the state that is wanted."
    )
    return [line for line in (first, second[0].upper() + second[1:], rules, hands) if line]


def _items(items: Mapping[str, Mapping[str, Any]]) -> list[str]:
    return [_item(name, item) for name, item in items.items()]


def _item(name: str, item: Mapping[str, Any]) -> str:
    may = [_MAY[predicate] for predicate in item["predicates"]]
    if item.get("mash_requires_boiled"):
        may.append("can be mashed once it is boiled")
    return f"- {_plain(name)}, {item['state']}" + (f": {joined(may)}" if may else "")


def _order(order: Mapping[str, Any]) -> list[str]:
    states = [f"the {_plain(i)} {state}" for i, state in order["required_states"].items()]
    lines = [f"Wanted: {joined(states)}."] if states else []
    stack: Sequence[str] = [f"the {_plain(item)}" for item in order["stack_order"]]
    if len(stack) > 1:
        lines.append(f"Stack from below, one after the other: {joined(stack)}.")
    elif stack:
        lines.append(f"Stack {stack[0]}.")
    if order.get("deadline") is not None:
        lines.append(f"This order must be done by minute {order['deadline']:g}.")
    return lines


def _candidate(goal: Mapping[str, Any]) -> str:
    cost = [f"{amount} {_plain(name)}" for name, amount in goal["cost"].items()]
    return (
        f"The {_plain(goal['item'])} {goal['state']} earns {goal['reward']} and costs "
        f"{joined(cost)}."
    )


def _stock(limits: Mapping[str, int]) -> str:
    return f"In stock: {joined([f'{n} {_plain(name)}' for name, n in limits.items()])}."


def _lag(lag: Mapping[str, Any]) -> str:
    ends = [
        f"{_GERUNDS[lag[end]['action']]} the {_plain(lag[end]['item'])}"
        for end in ("before", "after")
    ]
    return f"At least {lag['min_lag']:g} minutes pass between {ends[0]} and {ends[1]}."


def _plain(name: str) -> str:
    return name.replace("_", " ")
