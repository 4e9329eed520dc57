"""Step functions over time: the load of resources, the levels of stocks, the values of state."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from itertools import groupby
from typing import Any, NamedTuple

from irc.model import Action, Effect, Task
from irc.model.quantities import Number
from irc.reporting.closed import Levels
from irc.reporting.rows import Key, State, Stock
from irc.schedule import CANCELLED, Entry


class Happening(NamedTuple):
    """A change at a start or an end; `by` is None for a timed change, or what is so at first."""

    time: Number
    rank: int
    at_end: bool
    by: Key | None
    change: Any


def actions_in_modes(task: Task, entries: Iterable[Entry]) -> dict[Key, Action]:
    """The action of each occurrence, with the stock, state and cost of its mode."""
    actions = {action.id: action for action in task.actions}
    return {(e.id, e.occurrence): actions[e.id].in_mode(e.mode) for e in entries if e.id in actions}


def loads(entries: Iterable[Entry]) -> dict[str, Levels]:
    """The amount of each resource that is held, over time; what takes no time holds nothing."""
    changes: dict[str, Counter[Number]] = {}
    for entry in entries:
        if entry.start < entry.end:
            for name, amount in entry.resources.items():
                of = changes.setdefault(name, Counter())
                of[entry.start] += amount
                of[entry.end] -= amount
    return {name: summed(of, 0) for name, of in changes.items()}


def summed(changes: Mapping[Number, int], initial: int) -> Levels:
    """The level from t = 0 on, after the changes at each time."""
    level = initial + sum(amount for time, amount in changes.items() if time <= 0)
    found: list[tuple[Number, int]] = [(0, level)]
    for time in sorted(t for t in changes if t > 0):
        if changes[time]:
            level += changes[time]
            found.append((time, level))
    return tuple(found)


def stock_happenings(
    entries: Iterable[Entry], actions: Mapping[Key, Action]
) -> dict[str, list[Happening]]:
    """The changes of each stock, in order of time.

    The end of what was cancelled changes nothing.
    """
    found: dict[str, list[Happening]] = {}
    for entry in entries:
        action = actions.get((entry.id, entry.occurrence))
        if action is None or not (action.consumes or action.produces):
            continue
        changes = [(c, -c.amount, (c.at or "start") == "end") for c in action.consumes]
        changes += [(c, c.amount, (c.at or "end") == "end") for c in action.produces]
        for change, amount, at_end in changes:
            if not (at_end and entry.status == CANCELLED):
                happening = _at(entry, at_end, amount)
                found.setdefault(change.resource, []).append(happening)
    for of in found.values():
        of.sort(key=lambda h: (h.time, h.rank))
    return found


def _at(entry: Entry, at_end: bool, change: Any) -> Happening:
    time, rank = (entry.end, entry.last_rank) if at_end else (entry.start, entry.rank)
    return Happening(time, rank, at_end, (entry.id, entry.occurrence), change)


def stocks(task: Task, happenings: Mapping[str, list[Happening]]) -> Iterator[Stock]:
    """The level of each reservoir over time."""
    for resource in task.resources:
        if resource.kind == "reservoir":
            changes: Counter[Number] = Counter()
            for happening in happenings.get(resource.id, ()):
                changes[happening.time] += happening.change
            levels = summed(changes, resource.initial)
            yield Stock(resource.id, levels, resource.min, resource.max)


def state_happenings(
    task: Task, entries: Iterable[Entry], actions: Mapping[Key, Action]
) -> dict[str, list[Happening]]:
    """The changes of each state variable in order of time and rank, timed changes included.

    What happens at one time and rank is in the order: ends, then starts. A change is a function
    from the value before to the value after.
    """
    found: dict[str, list[Happening]] = {}
    for variable in task.state:
        for change in variable.changes:
            value = variable.read(change.value)
            happening = Happening(task.number(change.at), -1, False, None, ("set", value))
            found.setdefault(variable.id, []).append(happening)
    for entry in entries:
        action = actions.get((entry.id, entry.occurrence))
        for effect in () if action is None else action.effects:
            at_end = effect.at == "end"
            if at_end and entry.status == CANCELLED:
                continue
            found.setdefault(effect.var, []).append(_at(entry, at_end, _change_of(effect)))
    for of in found.values():
        of.sort(key=lambda h: (h.time, h.rank, not h.at_end))
    return found


def _change_of(effect: Effect) -> tuple[str, Any]:
    """("add", amount) or ("set", value)."""
    if not effect.changes_a_level:
        return "set", effect.value
    return ("set", effect.set) if effect.add is None else ("add", effect.add)


def states(task: Task, happenings: Mapping[str, list[Happening]]) -> Iterator[State]:
    """The value of each state variable over time, after all changes of an instant."""
    for variable in task.state:
        value: Any = variable.start_value
        found: list[tuple[Number, Any]] = [] if value is None else [(0, value)]
        of = happenings.get(variable.id, ())
        for time, changes in groupby(of, key=lambda h: h.time):
            for happening in changes:
                how, by = happening.change
                value = value + by if how == "add" else by
            if found and found[-1][0] == max(time, 0):
                found.pop()
            if not found or found[-1][1] != value:
                found.append((max(time, 0), value))
        yield State(variable.id, variable.is_number, tuple(found))
