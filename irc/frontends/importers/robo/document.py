"""Reads Robo Challenge JSON as typed data, every fault located."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any

from irc.diagnostics import did_you_mean
from irc.frontends.importers.instances import Part
from irc.frontends.importers.robo.kitchen import (
    ACTIONS,
    PREDICATES,
    STATES,
    STATIONS,
    Item,
    Kitchen,
    action_id,
)
from irc.model.quantities import Span

MAKESPAN = "minimize_makespan"
REWARD = "maximize_reward_under_deadline"

_REQUIRED = ("id", "objective_type", "items", "goal", "action_durations", "stations")
_OPTIONAL = (
    "temporal_constraints",
    "robots",
    "deadline",
    "candidate_goals",
    "inventory_limits",
)
_KEPT = (
    "split",
    "difficulty",
    "optimal_makespan",
    "optimal_reward",
)
_SAID_OF_IT = (
    *_KEPT,
    "challenge_features",
    "implicit_style",
    "affordance_mode",
    "selected_goal_ids",
    "sequential_makespan",
    "speedup_ratio",
    "witness_plan",
    "groundtruth_solver",
    "groundtruth_solver_status",
)
"""Fields about the instance and its known answer; they are not part of the task."""

_FLAGS = ("grill_requires_marinated", "fry_requires_cut", "mash_requires_boiled")


@dataclass(frozen=True)
class Lag:
    """`after` starts at least `min_lag` (at most `max_lag`) after `before` has ended."""

    before: str
    after: str
    min_lag: Span
    max_lag: Span | None
    part: Part


@dataclass(frozen=True)
class Candidate:
    """An optional goal: it earns `reward` and consumes `cost` from the stock."""

    id: str
    item: str
    state: str
    reward: int
    cost: Mapping[str, int]
    part: Part


@dataclass(frozen=True)
class RoboTask:
    """An instance as read. `required` are the states that the items must reach."""

    id: str
    kitchen: Kitchen
    items: Mapping[str, Item]
    required: Mapping[str, str]
    stack_order: tuple[str, ...]
    lags: tuple[Lag, ...]
    deadline: Span | None
    candidates: tuple[Candidate, ...]
    stock: Mapping[str, int]
    metadata: Mapping[str, Any]
    part: Part


def read_robo_task(instance: Part) -> RoboTask | None:
    """The instance, or None after its faults have been recorded."""
    found = len(instance.faults.findings.items)
    fields = instance.record(_REQUIRED, (*_OPTIONAL, *_SAID_OF_IT))
    name = fields["id"].text() if "id" in fields else None
    items = read_items(fields.get("items"))
    goal = fields["goal"].record((), ("required_states", "stack_order")) if "goal" in fields else {}
    task = RoboTask(
        name or instance.owner,
        read_kitchen(fields),
        items,
        read_states(goal.get("required_states"), items),
        read_stack_order(goal.get("stack_order"), items),
        read_lags(fields.get("temporal_constraints"), items),
        fields["deadline"].time() if "deadline" in fields else None,
        read_candidates(fields.get("candidate_goals"), items),
        read_counts(fields.get("inventory_limits")),
        {key: fields[key].value for key in _KEPT if key in fields},
        instance,
    )
    _check_objective(task, fields)
    return task if len(instance.faults.findings.items) == found else None


def read_kitchen(fields: Mapping[str, Part]) -> Kitchen:
    """The kitchen: durations, stations and robots."""
    durations = {
        action: time
        for action, part in _members(fields.get("action_durations"))
        if _known(part, action, ACTIONS, "action") and (time := part.time()) is not None
    }
    stations = {
        station: capacity
        for station, part in _members(fields.get("stations"))
        if _known(part, station, STATIONS, "station") and (capacity := part.whole(1)) is not None
    }
    robots = [
        robot
        for part in (fields["robots"].items() if "robots" in fields else ())
        if (robot := part.text()) is not None
    ]
    kitchen = Kitchen(durations, stations, tuple(dict.fromkeys(robots)))
    if len(kitchen.robots) != len(robots):
        fields["robots"].fault("a robot is listed twice")
    return kitchen


def read_items(part: Part | None) -> dict[str, Item]:
    """The items by name."""
    return {name: _item(name, inner) for name, inner in _members(part)}


def _item(name: str, part: Part) -> Item:
    fields = part.record(("state",), ("predicates", *_FLAGS))
    state = fields["state"].one_of(STATES, "state") if "state" in fields else None
    predicates = [
        p.one_of(PREDICATES, "predicate")
        for p in (fields["predicates"].items() if "predicates" in fields else ())
    ]
    flags = {flag: fields[flag].flag() for flag in _FLAGS if flag in fields}
    return Item(name, state or "raw", frozenset(p for p in predicates if p), **flags)


def read_states(part: Part | None, items: Mapping[str, Item]) -> dict[str, str]:
    """The wanted state of each item."""
    return {
        name: state
        for name, inner in _members(part)
        if _known(inner, name, items, "item") and (state := inner.one_of(STATES, "state"))
    }


def read_stack_order(part: Part | None, items: Mapping[str, Item]) -> tuple[str, ...]:
    """The items of a dish, from below."""
    order: dict[str, None] = {}
    for inner in part.items() if part is not None else ():
        name = inner.one_of(items, "item")
        if name in order:
            inner.fault(f"item {name!r} is stacked twice")
        elif name is not None:
            order[name] = None
    return tuple(order)


def read_lags(part: Part | None, items: Mapping[str, Item]) -> tuple[Lag, ...]:
    """The temporal constraints."""
    return tuple(
        lag
        for inner in (part.items() if part is not None else ())
        if (lag := _lag(inner, items)) is not None
    )


def _lag(part: Part, items: Mapping[str, Item]) -> Lag | None:
    fields = part.record(("before", "after"), ("min_lag", "max_lag"))
    before, after = (_end(fields.get(key), items) for key in ("before", "after"))
    least = fields["min_lag"].time() if "min_lag" in fields else 0
    most = fields["max_lag"].time() if "max_lag" in fields else None
    if before is None or after is None or least is None:
        return None
    if before == after:
        part.fault(f"the action {before!r} cannot be timed after itself")
        return None
    return Lag(before, after, least, most, part)


def _end(part: Part | None, items: Mapping[str, Item]) -> str | None:
    fields = {} if part is None else part.record(("action", "item"), ())
    action = fields["action"].one_of(ACTIONS, "action") if "action" in fields else None
    item = fields["item"].one_of(items, "item") if "item" in fields else None
    return None if action is None or item is None else action_id(action, item)


def read_candidates(part: Part | None, items: Mapping[str, Item]) -> tuple[Candidate, ...]:
    """The candidate goals. Two goals for one item, which would need two states, are faults."""
    found: dict[str, Candidate] = {}
    for inner in part.items() if part is not None else ():
        candidate = _candidate(inner, items)
        if candidate is None:
            continue
        if candidate.item in {other.item for other in found.values()}:
            inner.fault(
                f"item {candidate.item!r} already has a candidate goal; this importer supports one "
                "for each item, because an item has one state at the end"
            )
        elif candidate.id in found:
            inner.fault(f"the candidate goal {candidate.id!r} is given twice")
        else:
            found[candidate.id] = candidate
    return tuple(found.values())


def _candidate(part: Part, items: Mapping[str, Item]) -> Candidate | None:
    fields = part.record(("id", "item", "state", "reward"), ("cost",))
    name = fields["id"].text() if "id" in fields else None
    item = fields["item"].one_of(items, "item") if "item" in fields else None
    state = fields["state"].one_of(STATES, "state") if "state" in fields else None
    reward = fields["reward"].whole() if "reward" in fields else None
    cost = read_counts(fields.get("cost"))
    if name is None or item is None or state is None or reward is None:
        return None
    return Candidate(name, item, state, reward, cost, part)


def _check_objective(task: RoboTask, fields: Mapping[str, Part]) -> None:
    if "objective_type" not in fields:
        return
    objective = fields["objective_type"].one_of((MAKESPAN, REWARD), "objective")
    if objective == REWARD and not task.candidates and "candidate_goals" not in fields:
        task.part.fault(f"the objective {REWARD!r} needs the field 'candidate_goals'")
    if objective == MAKESPAN and task.candidates:
        fields["candidate_goals"].fault(f"candidate goals need the objective {REWARD!r}")


def read_counts(part: Part | None) -> dict[str, int]:
    """The amount of each stock, or the amount that is consumed."""
    return {name: count for name, inner in _members(part) if (count := inner.whole()) is not None}


def _members(part: Part | None) -> list[tuple[str, Part]]:
    """The members of an object by name, after a fault for a name that is empty."""
    members = {} if part is None else part.members()
    if "" in members:
        members.pop("").fault("a name must not be empty", key=True)
    return list(members.items())


def _known(part: Part, name: str, known: Collection[str], what: str) -> bool:
    if name in known:
        return True
    hint = did_you_mean(name, known) or f"known are {', '.join(known) or 'none'}"
    part.fault(f"there is no {what} {name!r}", hint=hint, key=True)
    return False
