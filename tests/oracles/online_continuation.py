"""The exact best continuation of a small execution, by freezing the *task* (docs/semantics.md).

What has started by the event becomes actions with a fixed start, an exact duration and named
resources; what is open may not start before the event. Each action thereby has the deadlines that
still concern it, and what only the frozen ones violate is relaxed by exactly as much as they
violate it: a precedence between two of them is left out, a capacity is raised to what they hold.
The result is an ordinary task, and `oracles.state_brute_force` has its optimum.

Half-done groups are tried finished, then with one of them given up, then two: the fewest that leave
any continuation are right, whatever the others would be worth.

Not compared (`NotCompared` says why) are conflicts of frozen actions about stock or state, about
which frozen ranges of durations would have to agree, and what the brute force does not know.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import combinations, pairwise
from typing import Any

from irc.model import Action, DurationRange, Event, Group, Precedence, Resource, Task, Window
from irc.model.events import AddGroups, CancelActions, CancelGroups, Observe, RetryAction
from irc.model.quantities import Number
from irc.schedule import Entry, Schedule
from oracles.online_presumed import not_begun
from oracles.state_brute_force import Optimum, Past, TooLargeError, optimum

CANCELLED = "cancelled"


class NotCompared(Exception):
    """What keeps an execution from being compared."""


@dataclass(frozen=True)
class Frozen:
    """An entry that has started, and when it ends: at any time of [least, most]."""

    entry: Entry
    least: Number
    most: Number
    as_planned: bool = True
    """Whether it started, and ended if it has, when it was to."""

    @property
    def ranks(self) -> tuple[int | None, int | None]:
        """The ranks that its start and its end have had, where these are known.

        What runs for a fixed duration ends with the rank of its start, so that one may be higher.
        """
        if not self.as_planned or self.least != self.most or self.cancelled:
            return None, None
        return self.entry.rank, self.entry.last_rank

    @property
    def is_settled(self) -> bool:
        return self.least == self.most

    @property
    def cancelled(self) -> bool:
        return self.entry.status == CANCELLED


@dataclass(frozen=True)
class Continuation:
    """The best that can follow. `best` is None where nothing can."""

    best: Optimum | None
    objective: tuple[str, ...]
    abandoned: int
    """How many half-done groups have to be given up for that."""


def frozen(
    before: Task, task: Task, schedule: Schedule, at: Number, events: Sequence[Event]
) -> list[Frozen]:
    """What has started by `at`, as the events at `at` have it; they have revised `before`.

    Without an observation that is what was to start before, but for what cannot have.

    Raises `NotCompared` where something is observed that the schedule did not plan.
    """
    old = {(e.id, e.occurrence): e for e in schedule.entries}
    entries = dict(old)
    observed = {}
    for change in (change for event in events for change in event.changes):
        if isinstance(change, Observe):
            key = (change.action, 1)
            if key not in entries:
                raise NotCompared("observed, and not planned")
            entries[key] = observed[key] = _observed(task, entries[key], change)
    fixed = {a.id: task.number(a.start) for a in before.actions if a.start is not None}
    known = {k: e for k, e in old.items() if e.start < at and fixed.get(e.id) == e.start}
    known.update(observed)  # (An observation fixes a start.)
    waiting = not_begun(before, schedule, at, known) if observed else frozenset()
    started = {key for key, e in old.items() if e.start < at} - waiting | observed.keys()
    ended = {key for key in started if entries[key].end <= at}
    gone = cancelled(before, events)
    found = []
    for key in sorted(started):
        entry = entries[key]
        if key in ended or entry.status == CANCELLED:
            planned = old.get(key)
            as_planned = planned is not None and (planned.start, planned.end) == (
                entry.start,
                entry.end,
            )
            found.append(Frozen(entry, entry.end, entry.end, as_planned))
        elif entry.id in gone:
            found.append(Frozen(replace(entry, end=at, status=CANCELLED), at, at))
        else:
            found.append(_running(task, entry, at))
    return found


def _observed(task: Task, entry: Entry, change: Observe) -> Entry:
    length = entry.end - entry.start
    start = entry.start if change.started is None else task.number(change.started)
    end = start + length if change.finished is None else task.number(change.finished)
    return replace(entry, start=start, end=end)


def cancelled(task: Task, events: Sequence[Event]) -> set[str]:
    """The actions of `task` that the events cancel, or that only groups taken back want."""
    named: set[str] = set()
    groups = {group.id: group.actions for group in task.groups}
    for change in (change for event in events for change in event.changes):
        if isinstance(change, AddGroups):
            groups.update((group.id, group.actions) for group in change.groups)
        elif isinstance(change, CancelActions):
            named.update(change.actions)
        elif isinstance(change, RetryAction):
            named.add(change.action)
        elif isinstance(change, CancelGroups):
            members = {name for group in change.groups for name in groups.pop(group, ())}
            named |= members - {name for actions in groups.values() for name in actions}
    return named


def _running(task: Task, entry: Entry, at: Number) -> Frozen:
    action = next(a for a in task.actions if a.id == entry.id)
    duration: Any = action.duration
    if entry.mode is not None:
        duration = next(m.duration for m in action.modes if m.id == entry.mode)
    if isinstance(duration, DurationRange):
        least = max(at, entry.start + task.number(duration.min))
        most = entry.start + task.number(duration.max)
        if most < at:
            raise NotCompared("a range that has passed")
        return Frozen(replace(entry, end=least), least, most)
    end = entry.start + task.number(duration)
    return Frozen(replace(entry, end=end), end, end, as_planned=False)


def continuation(
    task: Task,
    facts: Sequence[Frozen],
    at: Number,
    over: Collection[str] = (),
    world: Collection[str] = (),
    *,
    max_situations: int = 150_000,
) -> Continuation:
    """The best continuation of `facts` from `at`; `over` are the actions that were cancelled.

    `world` are the actions that stand for changes of the world at `at`: facts as well.
    Raises `NotCompared`, or `TooLargeError` from the brute force.
    """
    draft = _Draft(task, facts, at, frozenset(over), world)
    _require_peace(draft, world, max_situations)
    half_done = draft.half_done()
    for count in range(len(half_done) + 1):
        found: list[Optimum] = []
        for given_up in combinations(half_done, count):
            best = _optimum(draft.task(frozenset(given_up)), max_situations, draft.been)
            found += [] if best is None else [best]
        if found:
            best = min(found, key=lambda o: _order(o, draft.objective))
            return Continuation(best, draft.objective, count)
    return Continuation(None, draft.objective, 0)


def _optimum(task: Task, max_situations: int, past: Past) -> Optimum | None:
    try:
        return optimum(task, max_situations=max_situations, past=past)
    except ValueError as error:
        raise NotCompared(str(error)) from error


def _order(found: Optimum, objective: Sequence[str]) -> tuple[Number, ...]:
    signs = [-1 if name == "maximize_reward" else 1 for name in objective]
    return tuple(s * v for s, v in zip(signs, found.vector, strict=True))


def _require_peace(draft: _Draft, world: Collection[str], max_situations: int) -> None:
    """What started must be possible once time and capacity are relaxed, or it is about state."""
    if _optimum(draft.past(world), max_situations, draft.been) is None:
        raise NotCompared("a conflict about stock or state that is carried")


class _Draft:
    """The ordinary task that a continuation is."""

    def __init__(
        self,
        task: Task,
        facts: Sequence[Frozen],
        at: Number,
        over: frozenset[str],
        world: Collection[str],
    ) -> None:
        self.source, self.at, self.over = task, at, over
        self.facts: dict[str, list[Frozen]] = defaultdict(list)
        for fact in facts:
            self.facts[fact.entry.id].append(fact)
        self.actions = {a.id: a for a in task.actions}
        self.been = Past(
            at,
            world,
            {self._name(fact): fact.ranks for fact in facts},
            [resource.id for resource in self._own_time()],
        )
        cut = next((k for k, n in enumerate(task.objective) if n == "minimize_changes"), None)
        self.objective: tuple[str, ...] = task.objective[:cut] or ("minimize_makespan",)

    # --- groups ----------------------------------------------------------------------------------

    def half_done(self) -> list[str]:
        """Optional groups of which something has started, and not all."""
        found = []
        for group in self.source.groups:
            begun = [name for name in group.actions if name in self.facts]
            if group.required or not begun:
                continue
            if set(begun) != set(group.actions):
                found.append(group.id)
        for name in found:
            others = [g for g in self.source.groups if g.id != name]
            members = next(g.actions for g in self.source.groups if g.id == name)
            if any(not set(members).isdisjoint(other.actions) for other in others):
                raise NotCompared("a half-done group that shares actions with another")
        return found

    # --- the task --------------------------------------------------------------------------------

    def past(self, world: Collection[str]) -> Task:
        """Only what has happened, without anything that is wanted."""
        actions = [self._fact(fact) for facts in self.facts.values() for fact in facts]
        actions += [self.actions[name] for name in world]
        return self._made(
            actions=tuple(a.model_copy(update={"deadline": None, "due": None}) for a in actions),
            precedence=tuple(self._precedence({a.id for a in actions}, self.facts)),
            groups=(),
            goals=(),
            objective=("minimize_makespan",),
        )

    def task(self, given_up: frozenset[str]) -> Task:
        """All of it, with the named half-done groups given up."""
        dropped = {g.id for g in self.source.groups if g.id in given_up}
        absent = {
            name
            for g in self.source.groups
            if g.id in dropped
            for name in g.actions
            if name not in self.facts
        }
        groups = [g for g in self.source.groups if g.id not in dropped]
        deciding = {name for g in groups if not g.required for name in g.actions}
        actions = [self._fact(fact) for facts in self.facts.values() for fact in facts]
        for action in self.actions.values():
            if action.id in self.been.world:
                actions.append(action)
            elif action.id not in self.over and action.id not in absent:
                actions += self._open(action, action.id in deciding)
        present = {a.id for a in actions}
        return self._made(
            actions=tuple(actions),
            precedence=tuple(self._precedence(present, ())),
            groups=tuple(self._group(group) for group in groups),
            goals=tuple(self._goals(present)),
            objective=self.objective,
        )

    def _goals(self, present: Collection[str]) -> Iterator[Any]:
        """Those that history has not reached. What was cancelled does not count as there."""
        for goal in self.source.goals:
            facts = self.facts.get(goal, ()) if isinstance(goal, str) else ()
            if all(fact.cancelled for fact in facts):
                if facts and self.actions[goal].occurrence_bounds[1] == 1:
                    raise NotCompared("a goal that was cancelled")
                if isinstance(goal, str) and goal not in present:
                    raise NotCompared("a goal that was cancelled or given up")
                yield goal

    def _made(self, **fields: Any) -> Task:
        return self.source.model_copy(
            update={
                "deadline": None,
                "events": (),
                "resources": (*map(self._resource, self.source.resources), *self._own_time()),
                **fields,
            }
        )

    def _group(self, group: Group) -> Group:
        """Its deadline is with its actions; what has begun is no longer a choice."""
        begun = any(name in self.facts for name in group.actions)
        return group.model_copy(update={"deadline": None, "required": group.required or begun})

    # --- actions ---------------------------------------------------------------------------------

    def _name(self, fact: Frozen) -> str:
        once = self.actions[fact.entry.id].occurrence_bounds[1] == 1
        return fact.entry.id if once else f"{fact.entry.id} #{fact.entry.occurrence}"

    def _fact(self, fact: Frozen) -> Action:
        entry, action = fact.entry, self.actions[fact.entry.id]
        uses = [{"resource": r, "amount": n} for r, n in entry.resources.items() if n]
        fields: dict[str, Any] = {
            "id": self._name(fact),
            "start": entry.start,
            "duration": self._length(fact),
            "uses": [*uses, *self._own_use(action)],
            "conditions": action.conditions,
            "effects": action.effects,
            "consumes": action.consumes,
            "produces": action.produces,
            "cost": action.cost,
            "deadline": None if fact.is_settled else self._later_limit(fact, action),
        }
        if fact.cancelled:
            fields["conditions"] = [c for c in action.conditions if c.at != "end"]
            if fact.least == entry.start:
                raise NotCompared("cancelled as it started")
            fields["effects"] = [e for e in action.effects if e.at != "end"]
            fields["consumes"] = [c for c in action.consumes if c.at != "end"]
            fields["produces"] = [c for c in action.produces if c.at == "start"]
        else:
            fields.update(reward=action.reward, due=action.due, weight=action.weight)
        return Action.model_validate(fields)

    def _length(self, fact: Frozen) -> Any:
        least, most = fact.least - fact.entry.start, fact.most - fact.entry.start
        return least if least == most else {"min": least, "max": most}

    def _open(self, action: Action, decided: bool) -> Iterator[Action]:
        """What may still happen of an action."""
        least, most = action.occurrence_bounds
        if most is None:
            raise NotCompared("occurrences without a maximum")
        done = len(self.facts.get(action.id, ()))
        if done >= most:
            return
        limit = self._limit(action)
        fields: dict[str, Any] = {
            "release": max(self.at, self.source.number(action.release)),
            "deadline": limit,
            "uses": (*action.uses, *self._own_uses(action)),
        }
        if most > 1:
            fields["occurs"] = {"min": max(0, least - done), "max": most - done}
        elif not decided and least == 0:
            fields["occurs"] = "optional"
        stated = {name: getattr(action, name) for name in action.model_fields_set}
        yield Action.model_validate({**stated, **fields})

    def _limit(self, action: Action) -> Number | None:
        """The earliest deadline that concerns an action."""
        stated = [action.deadline, self.source.deadline]
        stated += [g.deadline for g in self.source.groups if action.id in g.actions]
        return min((self.source.number(d) for d in stated if d is not None), default=None)

    def _later_limit(self, fact: Frozen, action: Action) -> Number | None:
        """As `_limit`, for what runs and may still end in time."""
        limit = self._limit(action)
        if limit is not None and limit < fact.least:
            raise NotCompared(
                "a deadline that passes before what runs for as long as it likes ends"
            )
        return limit

    def _own_use(self, action: Action) -> list[dict[str, Any]]:
        return [u.model_dump() for u in self._own_uses(action)]

    def _own_uses(self, action: Action) -> tuple[Any, ...]:
        """Occurrences of one action do not overlap: each holds the action's own time."""
        from irc.model import Use

        if action.occurrence_bounds[1] == 1:
            return ()
        return (Use(resource=f"time of {action.id}"),)

    def _own_time(self) -> list[Resource]:
        many = [a for a in self.actions.values() if a.occurrence_bounds[1] != 1]
        return [Resource(id=f"time of {a.id}") for a in many]

    # --- what frozen actions violate -------------------------------------------------------------

    def _precedence(self, present: Collection[str], only: Collection[str]) -> Iterator[Precedence]:
        for edge in self.source.precedence:
            if edge.before not in present or edge.after not in present:
                continue
            pair = [self.facts.get(name) for name in (edge.before, edge.after)]
            if pair[0] and pair[1]:
                if self._holds(edge, pair[0][0], pair[1][0]):
                    yield edge
            elif not only:
                yield edge

    def _holds(self, edge: Precedence, before: Frozen, after: Frozen) -> bool:
        if before.cancelled or after.cancelled:
            return False
        of_before, of_after = edge.type.split("-")
        gaps = set()
        for first, second in (
            (b, a) for b in _bounds(before, of_before) for a in _bounds(after, of_after)
        ):
            gap = second - first
            least, most = self.source.number(edge.min_lag), edge.max_lag
            gaps.add(least <= gap and (most is None or gap <= self.source.number(most)))
        if len(gaps) > 1 or (gaps == {False} and not (before.is_settled and after.is_settled)):
            if gaps == {False}:
                raise NotCompared("an order of what runs for as long as it likes")
            return True
        return gaps == {True}

    def _resource(self, resource: Resource) -> Resource:
        if resource.kind == "reservoir":
            return resource
        held = [
            f
            for facts in self.facts.values()
            for f in facts
            if f.entry.resources.get(resource.id) and f.entry.start < f.most
        ]
        points = {0, *(f.entry.start for f in held), *(f.most for f in held)}
        for window in resource.availability:
            points |= {self.source.number(window.from_), self.source.number(window.to)}
        windows = []
        raised = False
        for begin, end in pairwise(sorted(points)):
            capacity = self._capacity(resource, begin)
            used = sum(
                f.entry.resources[resource.id]
                for f in held
                if f.entry.start <= begin and end <= f.most
            )
            raised = raised or used > capacity
            windows.append((begin, end, max(used, capacity)))
        if not raised:
            return resource
        if any(not f.is_settled for f in held):
            raise NotCompared("too little capacity for what runs for as long as it likes")
        kept = [
            Window(from_=begin, to=end, capacity=capacity)
            for begin, end, capacity in windows
            if capacity != resource.capacity
        ]
        return resource.model_copy(update={"availability": tuple(kept)})

    def _capacity(self, resource: Resource, instant: Number) -> int:
        for window in resource.availability:
            if self.source.number(window.from_) <= instant < self.source.number(window.to):
                return window.capacity
        return resource.capacity


def _bounds(fact: Frozen, point: str) -> set[Number]:
    return {fact.entry.start} if point == "start" else {fact.least, fact.most}


def values(task: Task, entries: Sequence[Entry]) -> Mapping[str, Number]:
    """What a history is worth: what was cancelled only costs, and only whole groups count."""
    actions = {a.id: a for a in task.actions}
    done = [e for e in entries if e.status != CANCELLED]
    late: Number = 0
    for entry in done:
        late += _late(task, entry.end, actions[entry.id])
    reward = sum(actions[e.id].reward or 0 for e in done)
    ends: dict[str, Number] = {}
    for entry in done:
        ends[entry.id] = max(entry.end, ends.get(entry.id, 0))
    for group in task.groups:
        if group.actions and ends.keys() >= set(group.actions):
            reward += group.reward or 0
            late += _late(task, max(ends[name] for name in group.actions), group)
    return {
        "minimize_makespan": max((e.end for e in entries), default=0),
        "minimize_tardiness": late,
        "maximize_reward": reward,
        "minimize_cost": sum(actions[e.id].cost or 0 for e in entries),
    }


def _late(task: Task, end: Number, part: Action | Group) -> Number:
    if part.due is None:
        return 0
    weight = 1 if part.weight is None else part.weight
    return weight * max(Fraction(0), Fraction(end) - task.number(part.due))


__all__ = [
    "Continuation",
    "Frozen",
    "NotCompared",
    "TooLargeError",
    "cancelled",
    "continuation",
    "frozen",
    "values",
]
