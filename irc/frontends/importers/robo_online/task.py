"""Builds the IR task of an online episode, with its events.

Each element is added when it is revealed: nothing shows it before its event. An event cannot add
values to a state variable, so the variable of an item has all states that the kitchen's rules allow
for it.
"""

from __future__ import annotations

from collections import Counter
from typing import Any

from irc.frontends.importers.instances import without_empty
from irc.frontends.importers.robo_online.document import Episode, Revelation
from irc.frontends.importers.robo_online.orders import Additions, Book
from irc.model import Task

_BY_REWARD = ["maximize_reward", "minimize_makespan"]


def episode_task(episode: Episode) -> Task | None:
    """The IR task of an episode, or None after its faults have been recorded."""
    found = len(episode.part.faults.findings.items)
    book = Book(episode.kitchen, episode.stock)
    first = book.reveal(episode.start)
    rewarded = first.rewarded
    events = []
    for happening in episode.happenings:
        new = book.reveal(happening.reveals)
        changes = _changes(new, happening.reveals)
        if new.rewarded and not rewarded:
            changes.append({"op": "set_objective", "objective": _BY_REWARD})
            rewarded = True
        events.append({"id": happening.id, "at": happening.at, "changes": changes})
    _check_names(episode)
    if len(episode.part.faults.findings.items) > found:
        return None
    deadline = episode.start.deadline
    return Task.model_validate(
        without_empty(
            {
                "name": episode.id,
                "metadata": {"id": episode.id, **episode.metadata, **_left_out(episode, book)},
                **({} if deadline is None else {"deadline": deadline}),
                "resources": _resources(episode, book),
                "state": first.state,
                "actions": first.actions,
                "precedence": first.precedence,
                "groups": first.groups,
                "goals": first.goals or [],
                "objective": _BY_REWARD if first.rewarded else "minimize_makespan",
                "events": events,
            }
        )
    )


def _changes(new: Additions, revelation: Revelation) -> list[dict[str, Any]]:
    """The changes of an event, in an order in which each names only known elements."""
    changes: list[dict[str, Any]] = [
        {"op": f"add_{field}", field: elements}
        for field, elements in (
            ("state", new.state),
            ("actions", new.actions),
            ("precedence", new.precedence),
            ("groups", new.groups),
        )
        if elements
    ]
    if new.goals is not None:
        changes.append({"op": "set_goals", "goals": new.goals})
    if revelation.deadline is not None:
        changes.append({"op": "set_deadline", "deadline": revelation.deadline})
    return changes


def _resources(episode: Episode, book: Book) -> list[dict[str, Any]]:
    """The resources of the kitchen from the start, without those that no order needs."""
    kitchen = episode.kitchen
    stations = [
        {"id": station, "capacity": capacity}
        for station, capacity in kitchen.stations.items()
        if station in book.stations
    ]
    stock = [
        {"id": name, "kind": "reservoir", "initial": amount}
        for name, amount in episode.stock.items()
        if name in book.consumed
    ]
    return [*stations, *({"id": robot} for robot in kitchen.robots), *stock]


def _left_out(episode: Episode, book: Book) -> dict[str, Any]:
    """The parts of the kitchen that no order needs, for the metadata."""
    unused = {
        "items_without_a_goal": book.idle,
        "unused_stations": [s for s in episode.kitchen.stations if s not in book.stations],
        "unused_stocks": [name for name in episode.stock if name not in book.consumed],
    }
    return {key: names for key, names in unused.items() if names}


def _check_names(episode: Episode) -> None:
    kitchen = episode.kitchen
    for name, count in Counter([*kitchen.stations, *kitchen.robots, *episode.stock]).items():
        if count > 1:
            episode.part.fault(f"{name!r} names two of its stations, robots and stocks")
