"""Reads Online Robo Challenge JSON as typed data, every fault located.

Events are read in the order of their times, so that each can name the items known by then.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from irc.frontends.importers.instances import Part
from irc.frontends.importers.robo.document import (
    Candidate,
    Lag,
    read_candidates,
    read_counts,
    read_items,
    read_kitchen,
    read_lags,
    read_stack_order,
    read_states,
)
from irc.frontends.importers.robo.kitchen import Item, Kitchen
from irc.model.quantities import Span

_KEPT = ("protocol", "difficulty", "source_task_id", "source_split")
_SAID_OF_IT = (*_KEPT, "source_dataset", "challenge_features", "oracle")
"""Fields about the episode and its known answers; they are not part of the task."""


@dataclass(frozen=True)
class WantedState:
    """The state in which an order wants an item, with its place in the file."""

    item: str
    state: str
    part: Part


@dataclass(frozen=True)
class KitchenOrder:
    """An order of the kitchen: a delivery or a candidate goal.

    With a `reward` it is optional. `stacked` are the items of its dish, from below.
    """

    id: str
    wanted: tuple[WantedState, ...]
    stacked: tuple[str, ...]
    deadline: Span | None
    reward: int | None
    cost: Mapping[str, int]
    part: Part


@dataclass(frozen=True)
class Revelation:
    """The items, orders, lags and deadline that become known at the start, or by an event."""

    items: Mapping[str, Item]
    orders: tuple[KitchenOrder, ...]
    lags: tuple[Lag, ...]
    deadline: Span | None


@dataclass(frozen=True)
class Happening:
    """An event, with its time and its revelation."""

    id: str
    at: Span
    reveals: Revelation


@dataclass(frozen=True)
class Episode:
    """An episode as read, its events in the order of their times."""

    id: str
    kitchen: Kitchen
    stock: Mapping[str, int]
    start: Revelation
    happenings: tuple[Happening, ...]
    metadata: Mapping[str, Any]
    part: Part


def read_episode(instance: Part) -> Episode | None:
    """The episode, or None after its faults have been recorded."""
    found = len(instance.faults.findings.items)
    fields = instance.record(("id", "initial_task"), ("events", *_SAID_OF_IT))
    name = fields["id"].text() if "id" in fields else None
    initial = (
        fields["initial_task"].record(
            ("items", "action_durations", "stations"),
            (
                "deliveries",
                "candidate_goals",
                "temporal_constraints",
                "deadline",
                "inventory_limits",
                "robots",
            ),
        )
        if "initial_task" in fields
        else {}
    )
    known: dict[str, Item] = {}
    start = _revelation(initial, known, "", "deadline", "items")
    episode = Episode(
        name or instance.owner,
        read_kitchen(initial),
        read_counts(initial.get("inventory_limits")),
        start,
        _happenings(fields.get("events"), known),
        _metadata(fields),
        instance,
    )
    return episode if len(instance.faults.findings.items) == found else None


def _happenings(part: Part | None, known: dict[str, Item]) -> tuple[Happening, ...]:
    """The events by time; those of one instant in the order of the file."""
    found = []
    ids: set[str] = set()
    for inner in part.items() if part is not None else ():
        fields = inner.record(("id", "trigger_time", "delta"), ("type", "description"))
        name = fields["id"].text() if "id" in fields else None
        at = fields["trigger_time"].time() if "trigger_time" in fields else None
        if name is not None and name in ids:
            fields["id"].fault(f"the event {name!r} is given twice")
        ids.add(name or "")
        found.append((name or "", at, fields.get("delta")))
    found.sort(key=lambda event: _moment(event[1]))
    return tuple(
        Happening(name, 0 if at is None else at, _delta(delta, known)) for name, at, delta in found
    )


def _moment(at: Span | None) -> tuple[bool, Fraction]:
    """A sort key by time; an event with a faulty time comes last, and may name any item."""
    return at is None, Fraction(at) if isinstance(at, (int, Fraction)) else Fraction(0)


def _delta(part: Part | None, known: dict[str, Item]) -> Revelation:
    fields = (
        {}
        if part is None
        else part.record(
            (),
            (
                "add_items",
                "add_deliveries",
                "add_candidate_goals",
                "add_temporal_constraints",
                "set_deadline",
            ),
        )
    )
    return _revelation(fields, known, "add_", "set_deadline", "add_items")


def _revelation(
    fields: Mapping[str, Part], known: dict[str, Item], prefix: str, deadline: str, items: str
) -> Revelation:
    """The revelation in the fields of the initial task or a delta; adds new items to `known`."""
    new = read_items(fields.get(items))
    for name in new.keys() & known.keys():
        there = fields[items].members()[name]
        there.fault(f"item {name!r} is already there", hint="add it under another name", key=True)
    known.update({name: item for name, item in new.items() if name not in known})
    deliveries = fields.get(f"{prefix}deliveries")
    candidates = read_candidates(fields.get(f"{prefix}candidate_goals"), known)
    return Revelation(
        new,
        (
            *(
                order
                for inner in (deliveries.items() if deliveries is not None else ())
                if (order := _delivery(inner, known)) is not None
            ),
            *map(_of_candidate, candidates),
        ),
        read_lags(fields.get(f"{prefix}temporal_constraints"), known),
        fields[deadline].time() if deadline in fields else None,
    )


def _delivery(part: Part, items: Mapping[str, Item]) -> KitchenOrder | None:
    fields = part.record(("id",), ("required_states", "stack_order", "deadline", "reward"))
    name = fields["id"].text() if "id" in fields else None
    required = fields.get("required_states")
    states = read_states(required, items)
    places = required.members() if required is not None and states else {}
    stacked = read_stack_order(fields.get("stack_order"), items)
    deadline = fields["deadline"].time() if "deadline" in fields else None
    reward = fields["reward"].whole() if "reward" in fields else None
    if name is None:
        return None
    wanted = tuple(WantedState(item, state, places[item]) for item, state in states.items())
    return KitchenOrder(name, wanted, stacked, deadline, reward, {}, part)


def _of_candidate(candidate: Candidate) -> KitchenOrder:
    wanted = WantedState(candidate.item, candidate.state, candidate.part)
    return KitchenOrder(
        candidate.id, (wanted,), (), None, candidate.reward, candidate.cost, candidate.part
    )


def _metadata(fields: Mapping[str, Part]) -> dict[str, Any]:
    """The data about the episode, with the values of the oracle that are given."""
    kept = {key: fields[key].value for key in _KEPT if key in fields}
    if "oracle" not in fields:
        return kept
    known = {k: part.value for k, part in fields["oracle"].members().items()}
    return {**kept, "oracle": {k: value for k, value in known.items() if value is not None}}
