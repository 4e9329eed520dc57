"""Random executions: small tasks, and events that mean something for the plan at their time.

`play` draws an execution step by step, because what can happen at a time depends on the plan that
is being carried out then: it is given a solver and a replanner, and the judge looks on.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from types import MappingProxyType
from typing import Any

import irc
from irc.checks.events import check_event
from irc.execution.step import Step
from irc.model import Event, Task
from irc.model.quantities import Number, exact
from irc.model.times import json_number
from irc.schedule import Entry, Schedule
from oracles.generators import random_task
from oracles.state_generators import state_task

Document = dict[str, Any]
Solve = Callable[[Task], Schedule]
Replan = Callable[[Task, Schedule, Number, Sequence[Event]], Step]

OPERATIONS = (
    *("add_actions", "cancel_actions", "set_duration", "add_precedence", "remove_precedence"),
    *("add_resources", "set_capacity", "set_deadline", "set_release", "add_groups"),
    *("cancel_groups", "set_goals", "set_state", "add_state", "set_objective", "observe"),
)
"""The kinds of change that any event may have; `EACH` has one more, drawn where it is asked for."""
EACH = (*OPERATIONS, "retry_action")
MOST_ACTIONS = 7
_TRIES = 40


# --- tasks ----------------------------------------------------------------------------------------


def online_task(rng: random.Random) -> Task:
    """A small task with whatever the IR has; not every one has a schedule."""
    if rng.random() < 0.5:
        return state_task(rng.randrange(1_000_000))
    task = random_task(rng, actions=(2, 4), resources=(1, 2), durations=(0, 5), tighten=0.0)
    document = task.model_dump(mode="json", by_alias=True, exclude_unset=True)
    _furnish(rng, document)
    return Task.model_validate(document)


def _furnish(rng: random.Random, document: Document) -> None:
    """Adds choices, orders, due dates, stock and calendars to a task about resources."""
    actions: list[Document] = document["actions"]
    free = [a for a in actions if "start" not in a]
    rng.shuffle(free)
    rewarded = False
    if len(free) > 1 and rng.random() < 0.5:
        members = [free.pop() for _ in range(rng.randint(1, 2))]
        group = {"id": "order", "actions": [a["id"] for a in members], "reward": rng.randint(1, 9)}
        if rng.random() < 0.7:
            group["required"] = False
        if rng.random() < 0.3:
            group.update(due=rng.randint(1, 8), weight=rng.randint(1, 3))
        document["groups"] = [group]
        rewarded = True
    if free and rng.random() < 0.4:
        free.pop().update(occurs="optional", reward=rng.randint(1, 5))
        rewarded = True
    for action in actions:
        if rng.random() < 0.15:
            action.update(due=rng.randint(1, 8), weight=rng.randint(1, 3))
        if rng.random() < 0.15:
            action["cost"] = rng.randint(1, 5)
    resource = rng.choice(document["resources"])
    if rng.random() < 0.2:
        begin = rng.randint(1, 6)
        window = {"from": begin, "to": begin + rng.randint(1, 3), "capacity": rng.randint(0, 3)}
        resource["availability"] = [window]
    if rng.random() < 0.25:
        document["resources"].append(
            {"id": "stock", "kind": "reservoir", "initial": rng.randint(1, 3)}
        )
        rng.choice(actions)["consumes"] = [{"resource": "stock", "amount": rng.randint(1, 2)}]
        if rng.random() < 0.5:
            rng.choice(actions)["produces"] = [{"resource": "stock", "amount": 1}]
    names = ["minimize_makespan"]
    names += ["maximize_reward"] if rewarded else []
    names += ["minimize_tardiness"] if any("due" in a for a in actions) else []
    names += ["minimize_cost"] if any("cost" in a for a in actions) else []
    rng.shuffle(names)
    document["objective"] = names[: rng.randint(1, len(names))]


# --- events ---------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Moment:
    """A task, the plan that is being carried out, and the time."""

    task: Task
    schedule: Schedule
    at: Number
    number: int = 0
    """Tells the events of an execution apart, in the ids of what they add."""
    seen: frozenset[str] = frozenset()
    """Actions that were observed: what was seen once is not seen otherwise later."""

    @property
    def completed(self) -> list[Entry]:
        return [e for e in self.schedule.entries if e.start < self.at and e.end <= self.at]

    @property
    def running(self) -> list[Entry]:
        return [e for e in self.schedule.entries if e.start < self.at < e.end]

    @property
    def open(self) -> list[Entry]:
        return [e for e in self.schedule.entries if e.start >= self.at]

    @property
    def last(self) -> Number:
        return max(self.schedule.makespan, self.at)

    def once(self, entries: Sequence[Entry]) -> list[Entry]:
        """Those of actions that occur at most once."""
        bounds = {a.id: a.occurrence_bounds[1] for a in self.task.actions}
        return [e for e in entries if bounds[e.id] == 1]


def next_event(
    rng: random.Random,
    task: Task,
    schedule: Schedule,
    at: Number,
    operation: str,
    number: int = 0,
    seen: frozenset[str] = frozenset(),
) -> Event | None:
    """An event with a change of this kind that fits task and plan; None if none is found."""
    moment = Moment(task, schedule, at, number, seen)
    for _ in range(_TRIES):
        changes = _DRAWN[operation](rng, moment)
        if changes is None:
            continue
        event = Event.model_validate(
            {"id": f"e{number}", "at": json_number(at), "changes": changes}
        )
        if not check_event(task, event).ok:
            continue
        if len(task.actions) + _added(event) <= MOST_ACTIONS:
            return event
    return None


def _added(event: Event) -> int:
    return sum(len(c.actions) for c in event.changes if c.op == "add_actions")


def _new_action(rng: random.Random, moment: Moment, name: str) -> Document:
    action: Document = {"id": name, "duration": rng.randint(0, 4)}
    if rng.random() < 0.1:
        action["duration"] = {"min": 1, "max": rng.randint(1, 3)}
    renewable = [r for r in moment.task.resources if r.kind == "renewable" and r.capacity]
    if renewable and rng.random() < 0.7:
        resource = rng.choice(renewable)
        action["uses"] = [
            {"resource": resource.id, "amount": rng.randint(1, min(2, resource.capacity))}
        ]
        if len(renewable) > 1 and rng.random() < 0.3:
            action["uses"] = [{"one_of": [r.id for r in rng.sample(renewable, 2)]}]
    stock = [r for r in moment.task.resources if r.kind == "reservoir"]
    if stock and rng.random() < 0.3:
        key = rng.choice(("consumes", "produces"))
        action[key] = [{"resource": rng.choice(stock).id, "amount": 1}]
    if moment.task.state and rng.random() < 0.4:
        variable = rng.choice(moment.task.state)
        part = {"at": rng.choice(("start", "end")), "var": variable.id}
        part["value"] = rng.choice(variable.values)
        action["effects"] = [part]
    if rng.random() < 0.15:
        action["deadline"] = json_number(exact(moment.last + rng.randint(0, 6)))
    if rng.random() < 0.15:
        action["due"] = json_number(exact(moment.last))
    return action


def _add_actions(rng: random.Random, moment: Moment) -> list[Document] | None:
    added = [
        _new_action(rng, moment, f"new{moment.number}.{k}") for k in range(rng.choice((1, 1, 2)))
    ]
    for action in added:
        if rng.random() < 0.2:
            action.update(occurs="optional", reward=rng.randint(1, 4))
    return [{"op": "add_actions", "actions": added}]


def _cancel_actions(rng: random.Random, moment: Moment) -> list[Document] | None:
    begun = {e.id for e in moment.schedule.entries if e.start < moment.at}
    repeats = {e.id for e in moment.schedule.entries} - {
        e.id for e in moment.once(moment.schedule.entries)
    }
    names = {e.id for e in moment.open if e.id not in begun}
    names |= {e.id for e in moment.running if e.id not in repeats and e.status is None}
    if not names:
        return None
    return [{"op": "cancel_actions", "actions": [rng.choice(sorted(names))]}]


def _retry_action(rng: random.Random, moment: Moment) -> list[Document] | None:
    """Breaks off what runs, or cancels something, and does it again."""
    once = {e.id for e in moment.once(moment.schedule.entries)}
    actions = {a.id: a for a in moment.task.actions}
    running = [e for e in moment.running if e.id in once and e.status is None]
    waiting = [e for e in moment.open if e.id in once and e.status is None]
    if waiting and (not running or rng.random() < 0.3):
        entry = rng.choice(waiting)
        again: Document = {"op": "retry_action", "action": entry.id}
        return [{"op": "cancel_actions", "actions": [entry.id]}, again]
    if not running:
        return None
    entry = rng.choice(running)
    again = {"op": "retry_action", "action": entry.id}
    if rng.random() < 0.4:
        again["done"] = json_number(exact(Fraction(moment.at) - entry.start))
        if actions[entry.id].modes:
            again["mode"] = entry.mode
    if rng.random() < 0.3:
        again["id"] = f"{entry.id} once more"
    cancel = [{"op": "cancel_actions", "actions": [entry.id]}]
    return [*(cancel if rng.random() < 0.5 else []), again]


def _set_duration(rng: random.Random, moment: Moment) -> list[Document] | None:
    modes = {a.id for a in moment.task.actions if a.modes}
    entries = [
        e
        for e in moment.once([*moment.running, *moment.open])
        if e.id not in modes and e.status is None
    ]
    if not entries:
        return None
    entry = rng.choice(entries)
    least = moment.at - entry.start if entry.start < moment.at else 0
    duration = exact(Fraction(least) + rng.choice((0, 1, 1, 2, 3, 5)))
    change = {"op": "set_duration", "action": entry.id, "duration": json_number(duration)}
    if rng.random() < 0.12:
        change["duration"] = {"min": json_number(duration), "max": json_number(duration + 2)}
    return [change]


def _add_precedence(rng: random.Random, moment: Moment) -> list[Document] | None:
    entries = moment.once(moment.schedule.entries)
    open_ = moment.once(moment.open)
    if not open_ or len(entries) < 2:
        return None
    after = rng.choice(open_)
    earlier = [e for e in entries if e.id != after.id and e.end <= after.end]
    others = [e for e in entries if e.id != after.id]
    before = rng.choice(earlier if earlier and rng.random() < 0.8 else others)
    edge: Document = {"before": before.id, "after": after.id}
    edge["type"] = rng.choice(("finish-start", "finish-start", "start-start", "finish-finish"))
    edge["min_lag"] = rng.choice((0, 0, 1, 2, -1))
    if rng.random() < 0.25:
        edge["max_lag"] = edge["min_lag"] + rng.randint(0, 6)
    return [{"op": "add_precedence", "precedence": [edge]}]


def _remove_precedence(rng: random.Random, moment: Moment) -> list[Document] | None:
    if not moment.task.precedence:
        return None
    edge = rng.choice(moment.task.precedence)
    key = {"before": edge.before, "after": edge.after}
    return [{"op": "remove_precedence", "precedence": [key]}]


def _add_resources(rng: random.Random, moment: Moment) -> list[Document] | None:
    name = f"tool{moment.number}"
    resource: Document = {"id": name, "capacity": rng.randint(1, 2)}
    action = _new_action(rng, moment, f"new{moment.number}.0")
    if rng.random() < 0.25:
        resource = {"id": name, "kind": "reservoir", "initial": rng.randint(1, 2)}
        action["consumes"] = [{"resource": name, "amount": 1}]
    else:
        action["uses"] = [{"resource": name}]
        others = [r.id for r in moment.task.resources if r.kind == "renewable" and r.capacity]
        if others and rng.random() < 0.5:
            action["uses"] = [{"one_of": [name, rng.choice(others)]}]
    return [
        {"op": "add_resources", "resources": [resource]},
        {"op": "add_actions", "actions": [action]},
    ]


def _set_capacity(rng: random.Random, moment: Moment) -> list[Document] | None:
    used = {name for e in moment.schedule.entries for name in e.resources}
    found = [r for r in moment.task.resources if r.kind == "renewable" and r.id in used]
    if not found:
        return None
    resource = rng.choice(found)
    lower = rng.randint(0, resource.capacity - 1) if resource.capacity else 1
    capacity = lower if rng.random() < 0.75 else resource.capacity + 1
    change: Document = {"op": "set_capacity", "resource": resource.id, "capacity": capacity}
    if rng.random() < 0.75:
        begin = exact(Fraction(moment.at) + rng.choice((0, 0, 0, 1, 2)))
        change["to"] = json_number(exact(begin + rng.randint(1, 4)))
        if begin > moment.at or rng.random() < 0.3:
            change["from"] = json_number(begin)
    return [change]


def _set_deadline(rng: random.Random, moment: Moment) -> list[Document] | None:
    change: Document = {"op": "set_deadline", "deadline": None}
    where = rng.choice(("task", "action", "action", "group"))
    end: Number = moment.last
    if where == "action":
        entries = [*moment.running, *moment.open]
        if not entries:
            return None
        entry = rng.choice(entries)
        change["action"], end = entry.id, entry.end
    if where == "group":
        if not moment.task.groups:
            return None
        group = rng.choice(moment.task.groups)
        change["group"] = group.id
        ends = [e.end for e in moment.schedule.entries if e.id in group.actions]
        end = max(ends, default=end)
    if rng.random() < 0.85:
        change["deadline"] = json_number(exact(max(Fraction(0), end + rng.randint(-2, 3))))
    return [change]


def _set_release(rng: random.Random, moment: Moment) -> list[Document] | None:
    entries = moment.once([*moment.open, *moment.open, *moment.running])
    if not entries:
        return None
    entry = rng.choice(entries)
    release = exact(Fraction(max(entry.start, 0)) + rng.choice((-1, 0, 1, 1, 2, 3)))
    return [{"op": "set_release", "action": entry.id, "release": json_number(max(0, release))}]


def _add_groups(rng: random.Random, moment: Moment) -> list[Document] | None:
    group: Document = {"id": f"order{moment.number}", "reward": rng.randint(1, 6)}
    if rng.random() < 0.75:
        group["required"] = False
    if rng.random() < 0.3:
        group["deadline"] = json_number(exact(Fraction(moment.last) + rng.randint(0, 5)))
    if rng.random() < 0.2:
        group["due"] = json_number(exact(Fraction(moment.at) + rng.randint(0, 5)))
    change = {"op": "add_groups", "groups": [group]}
    goal: list[Document] = []
    if rng.random() < 0.6 and "maximize_reward" not in moment.task.objective:
        names = ["maximize_reward", *moment.task.objective]
        goal = [{"op": "set_objective", "objective": names}]
    grouped = {name for g in moment.task.groups for name in g.actions}
    optional = [a.id for a in moment.task.actions if a.occurs == "optional"]
    free = [name for name in optional if name not in grouped]
    if free and rng.random() < 0.3:
        group["actions"] = [rng.choice(free)]
        return [change, *goal]
    added = [_new_action(rng, moment, f"new{moment.number}.{k}") for k in range(rng.choice((1, 2)))]
    group["actions"] = [a["id"] for a in added]
    return [{"op": "add_actions", "actions": added}, change, *goal]


def _cancel_groups(rng: random.Random, moment: Moment) -> list[Document] | None:
    unfinished = {e.id for e in (*moment.running, *moment.open)}
    groups = [
        g
        for g in moment.task.groups
        if not unfinished.isdisjoint(g.actions)
        or not {e.id for e in moment.schedule.entries} & set(g.actions)
    ]
    if not groups:
        return None
    return [{"op": "cancel_groups", "groups": [rng.choice(groups).id]}]


def _set_goals(rng: random.Random, moment: Moment) -> list[Document] | None:
    if not moment.task.state:
        return None
    written: dict[str, list[Any]] = {}
    for action in moment.task.actions:
        for effect in action.effects:
            written.setdefault(effect.var, []).append(effect.value)
    goals: list[Any] = []
    for variable in moment.task.state:
        if rng.random() < 0.6:
            likely = written.get(variable.id, [])
            value = rng.choice(likely if likely and rng.random() < 0.8 else variable.values)
            goals.append({"var": variable.id, "value": value})
    ended = {e.id for e in moment.schedule.entries if e.status == "cancelled"}
    optional = [a.id for a in moment.task.actions if a.occurs == "optional" and a.id not in ended]
    if optional and rng.random() < 0.3:
        goals.append(rng.choice(optional))
    return [{"op": "set_goals", "goals": goals}]


def _set_state(rng: random.Random, moment: Moment) -> list[Document] | None:
    if not moment.task.state:
        return None
    variable = rng.choice(moment.task.state)
    value = rng.choice(variable.values)
    return [{"op": "set_state", "var": variable.id, "value": value}]


def _add_state(rng: random.Random, moment: Moment) -> list[Document] | None:
    name = f"fact{moment.number}"
    makes = _new_action(rng, moment, f"new{moment.number}.0")
    makes["effects"] = [{"at": "end", "var": name, "value": True}]
    changes: list[Document] = [{"op": "add_state", "state": [{"id": name}]}]
    changes.append({"op": "add_actions", "actions": [makes]})
    if rng.random() < 0.5:
        needs = _new_action(rng, moment, f"new{moment.number}.1")
        needs["conditions"] = [{"at": "start", "var": name, "value": True}]
        changes[1]["actions"].append(needs)
    if rng.random() < 0.4:
        makes["occurs"] = "optional"
        old = [g.model_dump() if not isinstance(g, str) else g for g in moment.task.goals]
        changes.append({"op": "set_goals", "goals": [*old, {"var": name, "value": True}]})
    return changes


def _set_objective(rng: random.Random, moment: Moment) -> list[Document] | None:
    names = ["minimize_makespan", "minimize_tardiness", "maximize_reward", "minimize_cost"]
    rng.shuffle(names)
    chosen = names[: rng.randint(1, 3)]
    if tuple(chosen) == moment.task.objective:
        return None
    if rng.random() < 0.1:
        chosen.append("minimize_changes")
    return [{"op": "set_objective", "objective": chosen}]


def _observe(rng: random.Random, moment: Moment) -> list[Document] | None:
    """A late or an early start, an early or a late end, or that all went as planned."""
    at = moment.at
    seen = {a.id for a in moment.task.actions if a.start is not None} | moment.seen
    begun = [
        e
        for e in moment.once([*moment.running, *moment.completed])
        if e.id not in seen and e.status is None
    ]
    early = [e for e in moment.once(moment.open) if e.id not in seen]
    change: Document = {"op": "observe"}
    if early and (not begun or rng.random() < 0.2):
        entry = rng.choice(early)
        change.update(action=entry.id, started=json_number(at))
        return [change]
    if not begun:
        return None
    entry = rng.choice(begun)
    change["action"] = entry.id
    start = entry.start
    if rng.random() < 0.5:
        start = _between(rng, entry.start, at)
        change["started"] = json_number(start)
    if "started" not in change or rng.random() < 0.3:
        change["finished"] = json_number(_between(rng, start, at))
    return [change]


def _between(rng: random.Random, least: Number, most: Number) -> Number:
    """A time between two, both included; on the grid that the two lie on."""
    steps = rng.randint(0, 4)
    return exact(Fraction(least) + (Fraction(most) - Fraction(least)) * Fraction(steps, 4))


_DRAWN: Mapping[str, Callable[[random.Random, Moment], list[Document] | None]] = MappingProxyType(
    {
        "add_actions": _add_actions,
        "cancel_actions": _cancel_actions,
        "retry_action": _retry_action,
        "set_duration": _set_duration,
        "add_precedence": _add_precedence,
        "remove_precedence": _remove_precedence,
        "add_resources": _add_resources,
        "set_capacity": _set_capacity,
        "set_deadline": _set_deadline,
        "set_release": _set_release,
        "add_groups": _add_groups,
        "cancel_groups": _cancel_groups,
        "set_goals": _set_goals,
        "set_state": _set_state,
        "add_state": _add_state,
        "set_objective": _set_objective,
        "observe": _observe,
    }
)


# --- executions -----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Played:
    """One instant of an execution: the task and the plan before, the events, and the repair."""

    task: Task
    schedule: Schedule
    events: tuple[Event, ...]
    at: Number
    step: Step


def solved(task: Task) -> Schedule:
    """The plan as of t = 0, the same on every run."""
    return irc.solve(task, workers=1, time_limit=20)


def play(
    seed: int, operation: str | None, replan: Replan, solve: Solve = solved
) -> Iterator[Played]:
    """An execution with one event of an operation, or with one to five of any (None).

    Ends early where a step has no answer. Raises what `replan` raises.
    """
    rng = random.Random(f"online {operation} {seed}")
    task, schedule, first = _beginning(rng, operation, solve)
    at, events = first
    seen: frozenset[str] = frozenset()
    for k in range(1 if operation else rng.randint(1, 5)):
        if k:
            drawn = _drawn(rng, task, schedule, at, operation, k, seen)
            if drawn is None:
                return
            at, events = drawn
        step = replan(task, schedule, at, events)
        yield Played(task, schedule, events, at, step)
        if not step.schedule.answered:
            return
        task, schedule = step.task, step.schedule
        seen |= {c.action for event in events for c in event.changes if c.op == "observe"}


def _beginning(
    rng: random.Random, operation: str | None, solve: Solve
) -> tuple[Task, Schedule, tuple[Number, tuple[Event, ...]]]:
    """A task with a plan, and what happens first."""
    while True:
        task = online_task(rng)
        if not irc.check(task).ok:
            continue
        schedule = solve(task)
        if not schedule.answered or not schedule.makespan:
            continue
        drawn = _drawn(rng, task, schedule, None, operation, 0)
        if drawn is not None:
            return task, schedule, drawn


def _drawn(
    rng: random.Random,
    task: Task,
    schedule: Schedule,
    since: Number | None,
    operation: str | None,
    k: int,
    seen: frozenset[str] = frozenset(),
) -> tuple[Number, tuple[Event, ...]] | None:
    """A time after `since`, and what happens then; now and then two events at once."""
    for attempt in range(6):
        at = _time(rng, schedule, since)
        kind = operation or rng.choice(OPERATIONS)
        event = next_event(rng, task, schedule, at, kind, 10 * k + attempt, seen)
        if event is None:
            continue
        if rng.random() < 0.85:
            return at, (event,)
        # The second is about the same plan; where the first ends what it names, it is left out.
        kind, number = rng.choice(OPERATIONS), 10 * k + attempt + 500
        more = next_event(rng, task, schedule, at, kind, number, seen)
        if more is not None and _compatible(task, event, more):
            return at, (event, more)
        return at, (event,)
    return None


def _compatible(task: Task, event: Event, more: Event) -> bool:
    """Whether two events of one instant fit one after the other."""
    from irc.diagnostics import InputError
    from irc.events.apply import apply

    endings = {"retry_action", "cancel_actions", "cancel_groups", "observe", "set_duration"}
    if any(c.op in endings for c in event.changes) and any(c.op in endings for c in more.changes):
        return False
    try:
        return check_event(apply(task, event), more).ok
    except InputError:  # An end alone: `apply` would have to be told the start.
        return False


def _time(rng: random.Random, schedule: Schedule, since: Number | None) -> Number:
    """Mostly amid the plan, on a grid of wholes, halves, thirds or quarters."""
    parts = rng.choice((1, 1, 1, 1, 2, 2, 3, 4))
    first = Fraction(since or 0)
    last = max(Fraction(schedule.makespan), first)
    if rng.random() < 0.06:
        return exact(last + rng.randint(1, 2) / Fraction(2))
    # Strictly later: events of one instant are one step.
    low = int(first * parts) + (1 if since is not None else 0)
    return exact(Fraction(rng.randint(low, max(low, int(last * parts))), parts))
