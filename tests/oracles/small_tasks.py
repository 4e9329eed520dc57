"""The best values of small tasks, by trying every choice and every start (docs/semantics.md).

Known here: actions of fixed durations, modes with fixed durations and uses, resources of constant
capacity, `one_of`, amounts, finish-start precedence with lags, releases, deadlines, optional
actions, groups, due dates, weights, rewards, costs, all objectives but `minimize_changes`,
couplings, selections, orders of uses and batch resources, and durations in a range. Whatever else
a document says is refused with `ValueError`.

Whole ticks suffice, since all times are whole numbers. Some best schedule ends by the latest date
and all durations and lags behind it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations, product
from typing import Any

Document = dict[str, Any]
Vector = tuple[int, ...]

_TASK = {
    "actions",
    "resources",
    "precedence",
    "groups",
    "objective",
    "couplings",
    "select",
    "deadline",
    "sequences",
}
_ACTION = {
    *("id", "duration", "modes", "uses", "release", "deadline", "occurs", "due", "weight"),
    *("reward", "cost"),
}


@dataclass(frozen=True)
class Choice:
    """How an action is carried out; `held` has (use, resource, amount) of each use.

    A use is named by where it is written: ("", n) of the action, (mode, n) of a mode.
    """

    mode: str | None
    duration: int
    held: tuple[tuple[tuple[str, int], str, int], ...]
    cost: int
    families: tuple[str | None, ...] = ()

    def family(self, resource: str) -> str | None:
        """The family of the use that holds a resource."""
        uses = zip(self.held, self.families, strict=True)
        return next(family for (_, r, _), family in uses if r == resource)

    def resource_of(self, use: tuple[str, int]) -> str | None:
        """The resource that a use holds."""
        return next((r for u, r, _ in self.held if u == use), None)


def best_of(document: Document) -> Vector | None:
    """The lexicographically best values of the objectives; None where nothing is valid."""
    unknown = set(document) - _TASK
    unknown |= {key for action in document["actions"] for key in set(action) - _ACTION}
    if unknown:
        raise ValueError(f"this oracle does not know {sorted(unknown)}")
    best: Vector | None = None
    for chosen in choices(document):
        found = Placement(document, chosen, best).run()
        best = found if found is not None else best
    return None if best is None else _shown(document, best)


def _objectives(document: Document) -> list[list[tuple[int, str]]]:
    listed = document.get("objective", "minimize_makespan")
    levels = listed if isinstance(listed, list) else [listed]
    return [
        [(weight, name) for weight, name in level["sum"]]
        if isinstance(level, dict)
        else [(1, level)]
        for level in levels
    ]


def _shown(document: Document, vector: Vector) -> Vector:
    """The values as they are reported: a reward counts as it is, unless it is a part of a sum."""
    listed = document.get("objective", "minimize_makespan")
    levels = listed if isinstance(listed, list) else [listed]
    return tuple(-v if o == "maximize_reward" else v for v, o in zip(vector, levels, strict=True))


def choices(document: Document) -> Iterator[dict[str, Choice]]:
    """Every choice of presence, modes and resources that keeps groups, couplings and selections."""
    options = [_options(document, action) for action in document["actions"]]
    names = [action["id"] for action in document["actions"]]
    for taken in product(*options):
        chosen = {n: c for n, c in zip(names, taken, strict=True) if c is not None}
        holds = _groups_hold(document, chosen) and _selections_hold(document, chosen)
        if holds and all(_coupling_holds(c, chosen) for c in document.get("couplings", ())):
            yield chosen


def _options(document: Document, action: Document) -> list[Choice | None]:
    in_group = any(
        action["id"] in g["actions"] and not g.get("required", True)
        for g in document.get("groups", ())
    )
    found: list[Choice | None] = [None] if action.get("occurs") == "optional" or in_group else []
    ways = action.get("modes") or [{"id": None, "duration": action["duration"]}]
    for way in ways:
        uses = [(("", n), use) for n, use in enumerate(action.get("uses", ()))]
        uses += [((way["id"], n), use) for n, use in enumerate(way.get("uses", ()))]
        lists = [use.get("one_of") or [use["resource"]] for _, use in uses]
        for taken in product(*lists):
            held = tuple(
                (place, r, use.get("amount", 1))
                for (place, use), r in zip(uses, taken, strict=True)
            )
            cost = action.get("cost", 0) + way.get("cost", 0)
            families = tuple(use.get("family") for _, use in uses)
            found += [
                Choice(way["id"], duration, held, cost, families)
                for duration in _durations(way["duration"])
            ]
    return found


def _durations(duration: Any) -> Iterable[int]:
    if isinstance(duration, dict):
        return range(duration["min"], duration["max"] + 1)
    return [duration]


def _groups_hold(document: Document, chosen: Mapping[str, Choice]) -> bool:
    for group in document.get("groups", ()):
        there = [name in chosen for name in group["actions"]]
        if not all(there) and (any(there) or group.get("required", True)):
            return False
    return True


def _is_there(document: Document, chosen: Mapping[str, Choice], name: str) -> bool:
    for group in document.get("groups", ()):
        if group["id"] == name:
            return all(member in chosen for member in group["actions"])
    return name in chosen


def _selections_hold(document: Document, chosen: Mapping[str, Choice]) -> bool:
    for rule in document.get("select", ()):
        if "if" in rule and not _is_there(document, chosen, rule["if"]):
            continue
        count = sum(_is_there(document, chosen, name) for name in rule["actions"])
        if rule.get("all_or_none") and count not in (0, len(rule["actions"])):
            return False
        if count < rule.get("min", 0) or count > rule.get("max", count):
            return False
    return True


def _coupling_holds(rule: Document, chosen: Mapping[str, Choice]) -> bool:
    if "if" in rule:
        first, then = rule["if"], rule["then"]
        one, other = chosen.get(first["action"]), chosen.get(then["action"])
        if one is None or other is None or not _is_as(one, first):
            return True
        return _is_as(other, then)
    kind, what = ("same", rule["same"]) if "same" in rule else ("different", rule["different"])
    values = []
    for named in rule["actions"]:
        name, use = (named, 0) if isinstance(named, str) else (named["action"], named["use"])
        if name not in chosen:
            continue
        if what == "mode":
            values.append(frozenset([chosen[name].mode]))
        elif isinstance(named, str):
            values.append(frozenset(r for _, r, _ in chosen[name].held))
        else:
            values.append(frozenset([chosen[name].resource_of(("", use))]))
    if kind == "same":
        return len(set(values)) <= 1
    return sum(map(len, values)) == len(frozenset().union(*values))


def _is_as(choice: Choice, said: Document) -> bool:
    if "mode" in said or "modes" in said:
        return choice.mode in said.get("modes", [said.get("mode")])
    if "use" in said:
        return choice.resource_of(("", said["use"])) == said["resource"]
    return any(r == said["resource"] for _, r, _ in choice.held)


def _all_resources(action: Document) -> set[str]:
    parts = (action, *action.get("modes", ()))
    uses = [use for part in parts for use in part.get("uses", ())]
    return {r for use in uses for r in use.get("one_of", [use.get("resource")])}


@dataclass
class Placement:
    """Places the chosen actions one after another, at every start."""

    document: Document
    chosen: Mapping[str, Choice]
    best: Vector | None
    found: Vector | None = None
    starts: dict[str, int] = field(default_factory=dict)

    def run(self) -> Vector | None:
        """The best values with these choices, if they are better than the best so far."""
        self.prepare()
        self._place(list(self.actions))
        return self.found

    def prepare(self) -> None:
        """Looks up what the document says."""
        document = self.document
        self.actions = {a["id"]: a for a in document["actions"] if a["id"] in self.chosen}
        self.levels = _objectives(document)
        self.capacity = {r["id"]: r.get("capacity", 1) for r in document.get("resources", ())}
        self.batches = [r["id"] for r in document.get("resources", ()) if r.get("kind") == "batch"]
        edges = document.get("precedence", ())
        self.edges = [e for e in edges if e["before"] in self.chosen and e["after"] in self.chosen]
        dates = [a.get("release", 0) for a in self.actions.values()]
        dates += [a.get("due", 0) for a in self.actions.values()]
        dates += [g.get("due", 0) for g in document.get("groups", ())]
        lags = sum(abs(e.get("min_lag", 0)) + abs(e.get("max_lag", 0)) for e in self.edges)
        work = sum(c.duration for c in self.chosen.values())
        self.horizon = max([0, *dates]) + work + lags
        if "deadline" in document:
            self.horizon = min(self.horizon, document["deadline"])

    def _place(self, left: Sequence[str]) -> None:
        vector = self._vector()
        if self.best is not None and vector >= self.best:
            return
        if not left:
            if self._orders_hold():
                self.best = self.found = vector
            return
        name, *rest = left
        action, choice = self.actions[name], self.chosen[name]
        last = min(self.horizon, action.get("deadline", self.horizon)) - choice.duration
        for start in range(action.get("release", 0), last + 1):
            self.starts[name] = start
            if self._edges_hold(name) and self._has_room(name):
                self._place(rest)
        self.starts.pop(name, None)

    def _end(self, name: str) -> int:
        return self.starts[name] + self.chosen[name].duration

    def _edges_hold(self, name: str) -> bool:
        for edge in self.edges:
            before, after = edge["before"], edge["after"]
            if name in (before, after) and before in self.starts and after in self.starts:
                lag = self.starts[after] - self._end(before)
                if lag < edge.get("min_lag", 0) or lag > edge.get("max_lag", lag):
                    return False
        return True

    def _has_room(self, name: str) -> bool:
        for time in range(self.starts[name], self._end(name)):
            held: dict[str, int] = {}
            for other, start in self.starts.items():
                if start <= time < self._end(other):
                    for _, r, amount in self.chosen[other].held:
                        held[r] = held.get(r, 0) + amount
            if any(amount > self.capacity[r] for r, amount in held.items()):
                return False
        return all(self._one_load(name, r) for r in self.batches)

    def _one_load(self, name: str, resource: str) -> bool:
        """Whether what overlaps an action in a batch resource has its times and its family."""
        own = self.chosen[name]
        begin, end = self.starts[name], self._end(name)
        if begin == end or all(r != resource for _, r, _ in own.held):
            return True
        for other, start in self.starts.items():
            choice, last = self.chosen[other], self._end(other)
            if other == name or all(r != resource for _, r, _ in choice.held):
                continue
            if start < end and begin < last and start < last:
                alike = choice.family(resource) == own.family(resource)
                if (start, last) != (begin, end) or not alike:
                    return False
        return True

    def holds(self, starts: Mapping[str, int]) -> tuple[bool, bool]:
        """Whether the orders of uses hold at these starts, and whether loads do."""
        self.starts = dict(starts)
        loads = (self._one_load(n, r) for n in starts for r in self.batches)
        return self._orders_hold(), all(loads)

    def _orders_hold(self) -> bool:
        for rule in self.document.get("sequences", ()):
            if "consecutive" in rule:
                named = [rule["resource"]] if "resource" in rule else list(self.capacity)
                for resource in named:
                    users = self._users(resource)
                    first, second = rule["consecutive"]
                    if first in users and second in users:
                        after = users.index(first) + 1
                        if after == len(users) or users[after] != second:
                            return False
                continue
            for one, other in combinations(range(len(rule["same_order"])), 2):
                a, b = self._users(rule["same_order"][one]), self._users(rule["same_order"][other])
                rows = [r for r in self._rows(rule) if r[one] in a and r[other] in b]
                by_first = [a.index(r[one]) for r in rows]
                by_other = [b.index(r[other]) for r in rows]
                for j, k in combinations(range(len(rows)), 2):
                    if (by_first[j] - by_first[k]) * (by_other[j] - by_other[k]) < 0:
                        return False
        return True

    def _users(self, resource: str) -> list[str]:
        """The actions that hold a resource for some time, in order."""
        held = {
            n
            for n, choice in self.chosen.items()
            if choice.duration and any(r == resource for _, r, _ in choice.held)
        }
        return sorted(held, key=lambda n: self.starts[n])

    def _rows(self, rule: Document) -> list[list[str | None]]:
        """For each job of a same order the action that may hold each of its resources."""
        if "jobs" in rule:
            return [list(row) for row in rule["jobs"]]
        groups = [g["actions"] for g in self.document.get("groups", ())]
        alone = {a["id"] for a in self.document["actions"]} - {n for g in groups for n in g}
        names = [*groups, *([n] for n in sorted(alone))]
        may = {a["id"]: _all_resources(a) for a in self.document["actions"]}
        return [
            [next((n for n in job if r in may[n]), None) for r in rule["same_order"]]
            for job in names
        ]

    def _vector(self) -> Vector:
        """The values of what is placed: no level gets better when more is."""
        return tuple(
            sum(weight * self._value(name) for weight, name in level) for level in self.levels
        )

    def _value(self, name: str) -> int:
        if name == "minimize_makespan":
            return max(map(self._end, self.starts), default=0)
        if name == "minimize_cost":
            return sum(choice.cost for choice in self.chosen.values())
        if name == "maximize_reward":
            return -sum(self.actions[n].get("reward", 0) for n in self.chosen) - sum(
                g.get("reward", 0)
                for g in self.document.get("groups", ())
                if all(member in self.chosen for member in g["actions"])
            )
        if name == "minimize_flow_time":
            return sum(self._flow_times())
        late = list(self._lateness())
        if name == "minimize_tardiness":
            return sum(weight * max(0, x) for weight, x in late)
        if name == "minimize_tardy":
            return sum(weight for weight, x in late if x > 0)
        if name == "minimize_max_tardiness":
            return max((weight * x for weight, x in late if x > 0), default=0)
        if name == "minimize_earliness":
            return sum(weight * max(0, -x) for weight, x in late)
        raise ValueError(name)

    def _lateness(self) -> Iterator[tuple[int, int]]:
        for name in self.starts:
            action = self.actions[name]
            if "due" in action:
                yield action.get("weight", 1), self._end(name) - action["due"]
        for group in self.document.get("groups", ()):
            if "due" in group and all(member in self.starts for member in group["actions"]):
                last = max(map(self._end, group["actions"]))
                yield group.get("weight", 1), last - group["due"]

    def _flow_times(self) -> Iterator[int]:
        grouped = {n for g in self.document.get("groups", ()) for n in g["actions"]}
        for name in self.starts:
            action = self.actions[name]
            if name not in grouped:
                yield action.get("weight", 1) * (self._end(name) - action.get("release", 0))
        for group in self.document.get("groups", ()):
            if all(member in self.starts for member in group["actions"]):
                released = min(self.actions[m].get("release", 0) for m in group["actions"])
                last = max(map(self._end, group["actions"]))
                yield group.get("weight", 1) * (last - released)
