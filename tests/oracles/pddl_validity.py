"""Judges a plan on the PDDL that it is for, by the semantics of PDDL2.1, level 3.

It reads the domain, the problem and the plan by itself and simulates the plan: no grounding, no
task, and no code of irc. Fox and Long, "PDDL2.1: an extension to PDDL for expressing temporal
planning domains", 2003, section 8:

- All that happens at one time is one happening. Nothing that happens may touch what else then
  happens reads or sets, unless both add to a number. (A condition holds if it is true whatever the
  touched facts are: so one true alternative that nothing touches makes a disjunction true.)
- `epsilon`: the same holds for happenings that are nearer to each other than this.
- An `over all` condition holds after each happening from the start until before the end.
- Timed initial literals are happenings. Goals hold after all that the plan does.
- Durations may be off by `tolerance`, because plans are printed with few digits.
"""

from __future__ import annotations

import operator
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import product
from typing import Any, NamedTuple

Item = Any
"""A word, or a list of items."""

Atom = tuple[str, ...]
Objects = Mapping[str, str]


class NotJudgedError(ValueError):
    """PDDL beyond level 3, which this judge does not understand."""


class RejectedError(ValueError):
    """The plan is not valid."""


def reason_against(
    domain: str,
    problem: str,
    plan: str,
    *,
    epsilon: Fraction = Fraction(0),
    tolerance: Fraction = Fraction(1, 1000),
) -> str | None:
    """Why a plan is not valid; None if it is. Raises `NotJudgedError`."""
    world = _World(_read(domain), _read(problem))
    try:
        _Simulation(world, list(_plan_steps(plan)), epsilon, tolerance).run()
    except RejectedError as error:
        return str(error)
    return None


# --- reading --------------------------------------------------------------------------------------


def _read(text: str) -> list[Item]:
    stack: list[list[Item]] = [[]]
    for token in re.findall(r"[()]|[^\s()]+", re.sub(r";[^\n]*", "", text).lower()):
        if token == "(":
            stack.append([])
        elif token == ")":
            done = stack.pop()
            stack[-1].append(done)
        else:
            stack[-1].append(token)
    (whole,) = stack[0]
    return list(whole)


class _Step(NamedTuple):
    start: Fraction
    name: str
    objects: tuple[str, ...]
    lasts: Fraction


_LINE = re.compile(r"^\s*([\d.]+)\s*:\s*\(([^()]*)\)\s*(?:\[\s*([\d.]+)\s*\])?\s*$")


def _plan_steps(text: str) -> Iterator[_Step]:
    for raw in text.splitlines():
        line = raw.split(";")[0]
        if not line.strip():
            continue
        found = _LINE.match(line)
        if found is None:
            raise NotJudgedError(f"not a line of a plan: {line!r}")
        name, *objects = found[2].lower().split()
        yield _Step(Fraction(found[1]), name, tuple(objects), Fraction(found[3] or 0))


def _typed(items: Iterable[Item]) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Each name with its types; none where no type is given."""
    names: list[str] = []
    rest = iter(items)
    for item in rest:
        if item != "-":
            names.append(item)
            continue
        kind = next(rest)
        types = (kind,) if isinstance(kind, str) else tuple(kind[1:])
        yield from ((name, types) for name in names)
        names = []
    yield from ((name, ()) for name in names)


class _World:
    """What the two files say."""

    def __init__(self, domain: list[Item], problem: list[Item]) -> None:
        self.parents: dict[str, set[str]] = {}
        self.objects: dict[str, set[str]] = {}
        self.actions: dict[str, dict[str, Item]] = {}
        self.facts: set[Atom] = set()
        self.numbers: dict[Atom, Fraction] = {}
        self.timed: list[tuple[Fraction, Item]] = []
        self.goal: Item = ["and"]
        sections = [s for part in (domain, problem) for s in part[2:]]
        for section in sections:
            self._section(section)

    def _section(self, section: list[Item]) -> None:
        head, *rest = section
        if head == ":types":
            for name, above in _typed(rest):
                self.parents.setdefault(name, set()).update(above)
        elif head in (":constants", ":objects"):
            for name, types in _typed(rest):
                self.objects.setdefault(name, set()).update(types or ("object",))
        elif head in (":action", ":durative-action"):
            parts = dict(zip(rest[1::2], rest[2::2], strict=True))
            self.actions[rest[0]] = {"kind": head, **parts}
        elif head == ":init":
            for item in rest:
                self._initial(item)
        elif head == ":goal":
            (self.goal,) = rest
        elif head in (":derived", ":constraints", ":process", ":event"):
            raise NotJudgedError(head)

    def _initial(self, item: Item) -> None:
        if item[0] == "=":
            name = item[1] if isinstance(item[1], list) else [item[1]]
            self.numbers[tuple(name)] = Fraction(item[2])
        elif item[0] == "at" and len(item) == 3 and re.match(r"[\d.]+\Z", str(item[1])):
            self.timed.append((Fraction(item[1]), item[2]))
        elif item[0] == "and":
            for part in item[1:]:
                self._initial(part)
        elif item[0] != "not":
            self.facts.add(tuple(item))

    def is_of(self, name: str, types: Iterable[str]) -> bool:
        """Whether an object is of one of these types (of any, if there are none)."""
        wanted = set(types) or {"object"}
        waiting, seen = list(self.objects.get(name, ())), set()
        while waiting:
            kind = waiting.pop()
            if kind not in seen:
                seen.add(kind)
                waiting += self.parents.get(kind, ())
        return name in self.objects and ("object" in wanted or bool(seen & wanted))

    def choices(self, parameters: Iterable[Item]) -> Iterator[dict[str, str]]:
        """Each choice of objects for the variables of a quantifier."""
        named = list(_typed(parameters))
        ways = [[o for o in self.objects if self.is_of(o, types)] for _, types in named]
        for chosen in product(*ways):
            yield dict(zip((name for name, _ in named), chosen, strict=True))


# --- states and formulas --------------------------------------------------------------------------

_COMPARED: dict[str, Callable[[Fraction, Fraction], bool]] = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "=": operator.eq,
}


@dataclass
class _View:
    """A state as something that happens sees it: `touched` is what else may be changing."""

    world: _World
    facts: set[Atom]
    numbers: dict[Atom, Fraction]
    touched: frozenset[Atom]
    lasts: Fraction = Fraction(0)

    def holds(self, item: Item, objects: Objects) -> bool | None:
        """Whether a condition holds; None if that depends on what is touched."""
        if not item:
            return True
        head, *rest = item
        if head == "and":
            return _all(self.holds(part, objects) for part in rest)
        if head == "or":
            return _not(_all(_not(self.holds(part, objects)) for part in rest))
        if head == "not":
            return _not(self.holds(rest[0], objects))
        if head == "imply":
            return self.holds(["or", ["not", rest[0]], rest[1]], objects)
        if head in ("forall", "exists"):
            found = [
                self.holds(rest[1], {**objects, **more}) for more in self.world.choices(rest[0])
            ]
            if head == "forall":
                return _all(found)
            return _not(_all(map(_not, found)))
        if head in _COMPARED:
            return self._compared(head, rest[0], rest[1], objects)
        if head in ("preference", "always", "sometime", "within"):
            raise NotJudgedError(head)
        atom = _atom(item, objects)
        return None if atom in self.touched else atom in self.facts

    def _compared(self, head: str, left: Item, right: Item, objects: Objects) -> bool | None:
        if head == "=" and all(
            isinstance(x, str) and objects.get(x, x) in self.world.objects for x in (left, right)
        ):
            return objects.get(left, left) == objects.get(right, right)
        if any(name in self.touched for part in (left, right) for name in self.read(part, objects)):
            return None
        one, two = self.number(left, objects), self.number(right, objects)
        return one is not None and two is not None and _COMPARED[head](one, two)

    def read(self, item: Item, objects: Objects) -> Iterator[Atom]:
        """The numbers that an expression reads."""
        if isinstance(item, str):
            if item[0].isalpha():
                yield (item,)
        elif item[0] in ("+", "-", "*", "/"):
            for part in item[1:]:
                yield from self.read(part, objects)
        else:
            yield _atom(item, objects)

    def number(self, item: Item, objects: Objects) -> Fraction | None:
        """The value of an expression; None if it has none."""
        if item == "?duration" or item == ["?duration"]:
            return self.lasts
        if item == "#t":
            raise NotJudgedError("#t")
        if isinstance(item, str):
            return self.numbers.get((item,)) if item[0].isalpha() else Fraction(item)
        if item[0] not in ("+", "-", "*", "/"):
            return self.numbers.get(_atom(item, objects))
        values = [self.number(part, objects) for part in item[1:]]
        if None in values:
            return None
        total, *more = [value for value in values if value is not None]
        if not more:
            return -total
        for value in more:
            if item[0] == "/" and not value:
                return None
            total = _APPLIED[item[0]](total, value)
        return total


_APPLIED: dict[str, Callable[[Fraction, Fraction], Fraction]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
}


def _atom(item: Item, objects: Objects) -> Atom:
    return tuple(objects.get(word, word) for word in item)


def _not(value: bool | None) -> bool | None:
    return None if value is None else not value


def _all(values: Iterable[bool | None]) -> bool | None:
    found = list(values)
    return False if False in found else None if None in found else True


# --- what happens ---------------------------------------------------------------------------------


@dataclass
class _Effects:
    """The changes of one thing that happens. `set`: numbers assigned; `added`: increased."""

    adds: set[Atom] = field(default_factory=set)
    deletes: set[Atom] = field(default_factory=set)
    set: dict[Atom, Fraction] = field(default_factory=dict)
    added: dict[Atom, Fraction] = field(default_factory=dict)


@dataclass
class _Changes:
    """All that a thing may change, whether the conditions of its effects hold or not."""

    true: set[Atom] = field(default_factory=set)
    false: set[Atom] = field(default_factory=set)
    assigned: set[Atom] = field(default_factory=set)
    added: set[Atom] = field(default_factory=set)

    def all(self) -> set[Atom]:
        """The facts and numbers."""
        return self.true | self.false | self.assigned | self.added

    def against(self, other: _Changes) -> set[Atom]:
        """What cannot be changed at once in these two ways."""
        ours = self.true & other.false | self.false & other.true
        numbers = self.assigned | self.added, other.assigned | other.added
        return ours | numbers[0] & other.assigned | self.assigned & numbers[1]


@dataclass
class _Snap:
    """A start, an end, an instantaneous action or a timed literal. `at`: "start", "end" or ""."""

    time: Fraction
    text: str
    at: str
    step: _Step | None = None
    objects: dict[str, str] = field(default_factory=dict)
    effect: Item = ()
    condition: Item = ()
    changes: _Changes = field(default_factory=lambda: _Changes())


class _Simulation:
    def __init__(
        self, world: _World, steps: list[_Step], epsilon: Fraction, tolerance: Fraction
    ) -> None:
        self.world, self.epsilon, self.tolerance = world, epsilon, tolerance
        self.facts, self.numbers = set(world.facts), dict(world.numbers)
        self.snaps = [snap for step in steps for snap in self._snaps(step)]
        self.end = max((snap.time for snap in self.snaps), default=Fraction(0))
        self.running: list[_Snap] = []
        for time, literal in world.timed:
            self.snaps.append(_Snap(time, f"the literal at {float(time)}", "", effect=literal))
        for snap in self.snaps:
            snap.changes = self._changes(snap)
        self.snaps.sort(key=lambda snap: snap.time)

    def run(self) -> None:
        """Raises `RejectedError`."""
        # (What the clock does after the plan cannot undo what the plan has reached.)
        k = 0
        while k < len(self.snaps) and self.snaps[k].time <= self.end:
            time = self.snaps[k].time
            now = []
            while k < len(self.snaps) and self.snaps[k].time == time:
                now.append(self.snaps[k])
                k += 1
            self._happening(time, now)
        if self._view(frozenset()).holds(self.world.goal, {}) is not True:
            raise RejectedError("the goal does not hold in the end")

    def _snaps(self, step: _Step) -> Iterator[_Snap]:
        action = self.world.actions.get(step.name)
        text = f"{float(step.start)}: ({' '.join((step.name, *step.objects))})"
        if action is None:
            raise RejectedError(f"{text}: there is no such action")
        named = list(_typed(action.get(":parameters", ())))
        if len(named) != len(step.objects):
            raise RejectedError(f"{text}: takes {len(named)} objects")
        for (name, types), item in zip(named, step.objects, strict=True):
            if not self.world.is_of(item, types):
                raise RejectedError(f"{text}: {item} cannot be {name}")
        objects = dict(zip((name for name, _ in named), step.objects, strict=True))
        effect = action.get(":effect", ())
        if action["kind"] == ":action":
            condition = action.get(":precondition", ())
            yield _Snap(step.start, text, "", step, objects, effect, condition)
            return
        condition = action.get(":condition", ())
        for at, time in (("start", step.start), ("end", step.start + step.lasts)):
            yield _Snap(time, f"{text}, {at}", at, step, objects, effect, condition)

    def _view(self, touched: frozenset[Atom], snap: _Snap | None = None) -> _View:
        lasts = snap.step.lasts if snap is not None and snap.step is not None else Fraction(0)
        return _View(self.world, self.facts, self.numbers, touched, lasts)

    def _changes(self, snap: _Snap) -> _Changes:
        made = _Changes()
        for _, effect, objects in self._flat(snap.effect, snap.at, snap.objects, ()):
            if effect[0] in ("increase", "decrease"):
                made.added.add(_target(effect, objects))
            elif effect[0] == "assign":
                made.assigned.add(_target(effect, objects))
            elif effect[0] == "not":
                made.false.add(_atom(effect[1], objects))
            else:
                made.true.add(_atom(effect, objects))
        return made

    def _flat(
        self, effect: Item, at: str, objects: dict[str, str], conditions: tuple[Item, ...]
    ) -> Iterator[tuple[tuple[Item, ...], Item, dict[str, str]]]:
        """The effects at a time, each with its conditions and objects."""
        if not effect:
            return
        head, *rest = effect
        if head == "and":
            for part in rest:
                yield from self._flat(part, at, objects, conditions)
        elif head == "forall":
            for more in self.world.choices(rest[0]):
                yield from self._flat(rest[1], at, {**objects, **more}, conditions)
        elif head == "when":
            yield from self._flat(rest[1], at, objects, (*conditions, rest[0]))
        elif at and head == "at" and rest[0] in ("start", "end") and isinstance(rest[1], list):
            if rest[0] == at:
                yield from self._flat(rest[1], "", objects, conditions)
        elif head in ("scale-up", "scale-down"):
            raise NotJudgedError(head)
        elif at:
            raise NotJudgedError(f"an effect without a time: {head}")
        else:
            yield conditions, effect, objects

    # --- one happening ----------------------------------------------------------------------------

    def _happening(self, time: Fraction, now: list[_Snap]) -> None:
        near = [
            snap for snap in self.snaps if abs(snap.time - time) < self.epsilon or snap.time == time
        ]
        made = []
        for snap in now:
            others = [o for o in near if o is not snap and (o.time == time or o.step != snap.step)]
            touched = frozenset(atom for other in others for atom in other.changes.all())
            view = self._view(touched, snap)
            self._check_conditions(snap, view)
            self._check_interference(snap, others)
            made.append(self._effects(snap, view))
        for effects in made:
            self.facts -= effects.deletes - effects.adds
        for effects in made:
            self.facts |= effects.adds
            self.numbers.update(effects.set)
        for effects in made:
            for name, amount in effects.added.items():
                if name not in self.numbers:
                    raise RejectedError(f"{' '.join(name)} has no value to add to")
                self.numbers[name] += amount
        self.running += [snap for snap in now if snap.at == "start"]
        ended = {id(snap.step) for snap in now if snap.at == "end"}
        self.running = [snap for snap in self.running if id(snap.step) not in ended]
        for snap in self.running:
            for part, objects in self._timed(snap.condition, "all", snap.objects):
                if self._view(frozenset(), snap).holds(part, objects) is not True:
                    raise RejectedError(f"{snap.text}: {part} does not hold after {float(time)}")

    def _check_conditions(self, snap: _Snap, view: _View) -> None:
        if snap.step is None:
            return
        if snap.at == "start":
            self._check_duration(snap, view)
        parts = self._timed(snap.condition, snap.at, snap.objects)
        for part, objects in parts if snap.at else [(snap.condition, snap.objects)]:
            holds = view.holds(part, objects)
            if holds is None:
                raise RejectedError(f"{snap.text}: {part} changes at that very time")
            if not holds:
                raise RejectedError(f"{snap.text}: {part} does not hold")

    def _timed(
        self, item: Item, at: str, objects: dict[str, str]
    ) -> Iterator[tuple[Item, dict[str, str]]]:
        """The parts of a durative action's condition at a time."""
        if not item:
            return
        head, *rest = item
        if head == "and":
            for part in rest:
                yield from self._timed(part, at, objects)
        elif head == "forall":
            for more in self.world.choices(rest[0]):
                yield from self._timed(rest[1], at, {**objects, **more})
        elif head in ("at", "over") and rest[0] in ("start", "end", "all"):
            if rest[0] == at:
                yield rest[1], objects
        else:
            raise NotJudgedError(f"a condition without a time: {head}")

    def _check_duration(self, snap: _Snap, view: _View) -> None:
        assert snap.step is not None
        constraint = self.world.actions[snap.step.name][":duration"]
        waiting = [constraint]
        while waiting:
            part = waiting.pop()
            if not part:
                continue
            if part[0] == "and":
                waiting += part[1:]
                continue
            if part[0] == "at":
                if part[1] == "end":
                    raise NotJudgedError("a constraint on a duration at the end")
                waiting.append(part[2])
                continue
            names = [n for side in part[1:] for n in view.read(side, snap.objects)]
            if any(name in view.touched for name in names):
                raise RejectedError(f"{snap.text}: its duration changes at that very time")
            left, right = (view.number(side, snap.objects) for side in part[1:])
            if left is None or right is None:
                raise RejectedError(f"{snap.text}: its duration has no value")
            off = right - left if part[0] in (">=", ">") else left - right
            if (abs(off) if part[0] == "=" else off) > self.tolerance:
                raise RejectedError(f"{snap.text}: {float(left)} {part[0]} {float(right)} is false")

    @staticmethod
    def _check_interference(snap: _Snap, others: list[_Snap]) -> None:
        for other in others:
            both = snap.changes.against(other.changes)
            if both:
                raise RejectedError(f"{snap.text} and {other.text} change the same: {min(both)}")

    def _effects(self, snap: _Snap, view: _View) -> _Effects:
        made = _Effects()
        for conditions, effect, objects in self._flat(snap.effect, snap.at, snap.objects, ()):
            met = _all(
                view.holds(part, more)
                for condition in conditions
                for part, more in self._own(condition, snap.at, objects)
            )
            if met is None:
                raise RejectedError(f"{snap.text}: {conditions} changes at that very time")
            if not met:
                continue
            if effect[0] in ("increase", "decrease", "assign"):
                self._change(snap, view, effect, objects, made)
            elif effect[0] == "not":
                made.deletes.add(_atom(effect[1], objects))
            else:
                made.adds.add(_atom(effect, objects))
        return made

    def _own(
        self, condition: Item, at: str, objects: dict[str, str]
    ) -> Iterable[tuple[Item, dict[str, str]]]:
        """The parts of a `when`, of which those of a durative action may say their time."""
        if condition and condition[0] in ("at", "over") and condition[1] in ("start", "end", "all"):
            if condition[1] != at:
                raise NotJudgedError("an effect whose condition is at another time")
            return [(condition[2], objects)]
        if condition and condition[0] == "and":
            return [found for part in condition[1:] for found in self._own(part, at, objects)]
        return [(condition, objects)]

    @staticmethod
    def _change(snap: _Snap, view: _View, effect: Item, objects: Objects, made: _Effects) -> None:
        target = _target(effect, objects)
        read = set(view.read(effect[2], objects))
        if read & view.touched:
            raise RejectedError(f"{snap.text}: what it adds changes at that very time")
        amount = view.number(effect[2], objects)
        if amount is None:
            raise RejectedError(f"{snap.text}: {effect[2]} has no value")
        if effect[0] == "assign":
            made.set[target] = amount
        else:
            sign = 1 if effect[0] == "increase" else -1
            made.added[target] = made.added.get(target, Fraction(0)) + sign * amount


def _target(effect: Item, objects: Objects) -> Atom:
    return _atom(effect[1] if isinstance(effect[1], list) else [effect[1]], objects)
