"""Random tasks: contended ones for the solvers, hostile names, and the whole IR for hypothesis."""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from typing import Any

from hypothesis import strategies as st

from irc.model import Task

Document = dict[str, Any]

HOSTILE_NAMES: tuple[str, ...] = (
    # What would end a token, a line, a comment or a text in some target's file.
    '") (:goal',
    "(and (done a) (done b))",
    "a) (:durative-action b",
    "line\nbreak",
    "carriage\r\nreturn",
    "tab\there",
    "; comment",
    "a;b",
    "# comment",
    "// comment",
    '"quoted"',
    "it's",
    "back\\slash",
    "nul\x00byte",
    "bell\x07",
    "\u2028",
    # Reserved words of PDDL2.1, of the DSL, of JSON, of Python.
    *("and", "not", "define", "domain", "problem", "object", "number", "either", "assign"),
    *("total-time", "total-cost", "always", "sometime", "at", "over", "all", "start", "end"),
    *("increase", "minimize", "forall", "imply", "undefined", "?duration", "#t", ":goal"),
    *("action", "resource", "task", "null", "true", "None", "__init__", "__proto__"),
    # Twins: equal but for case, width, composition, or after some simple replacement.
    *("Grill", "grill", "GRILL", "a_b", "a-b", "a b", "a.b", "a__b", "A_B"),
    *(
        "straße",
        "STRASSE",
        "\u0130",
        "i\u0307",
        "\u00e9",
        "e\u0301",
        "\ufb01",
        "fi",
        "\u212b",
        "\u00c5",
    ),
    # Not identifiers.
    *("1st", "007", "3.14", "-1", "-o", "--help", "-", "_", "?x", "!", "=", "*", "a=b", "a,b"),
    *(" ", " leading", "trailing ", "two words", "\t", "\u00a0", "\u200b"),
    *("🤖", "👩‍🍳", "日本語", "مرحبا", "\u202eright-to-left", "\ufeffmark"),
    # Paths, pointers, templates.
    *("../../etc/passwd", "/", "a/b", "~1", "C:\\temp", "CON", "%s", "{0}", "${HOME}", "<b>&amp;"),
    "x" * 300,
    "x" * 299 + "y",
    "é" * 300,
    # What a name mapping itself may produce.
    *("a1", "a2", "n1", "r0", "action_1", "x_1", "x-1"),
)
"""Legal names that a careless target writes out, shortens or folds into one another."""


# --- random tasks -------------------------------------------------------------------------------

_TYPES = ("finish-start", "start-start", "finish-finish", "start-finish")
_TYPE_WEIGHTS = (6, 2, 1, 1)


@dataclass(frozen=True, kw_only=True)
class Knobs:
    """What `random_task` may use. Pairs are inclusive ranges; features are on or off."""

    actions: tuple[int, int] = (2, 8)
    durations: tuple[int, int] = (0, 6)
    resources: tuple[int, int] = (1, 3)
    capacities: tuple[int, int] = (1, 3)
    amounts: bool = True
    one_of: bool = True
    precedence: bool = True
    types: bool = True
    min_lags: bool = True
    max_lags: bool = True
    windows: bool = True
    ranges: bool = True
    fixed_starts: bool = True
    task_deadline: bool = True
    tighten: float = 0.15
    """How often one bound is cut below what the hidden schedule needs: often infeasible."""


@dataclass
class _Draft:
    """The documents of a task in the making, and one schedule that keeps all they say."""

    resources: list[Document] = field(default_factory=list)
    actions: list[Document] = field(default_factory=list)
    precedence: list[Document] = field(default_factory=list)
    spans: list[tuple[int, int]] = field(default_factory=list)
    used: dict[tuple[str, int], int] = field(default_factory=dict)


def random_task(rng: random.Random, **knobs: Any) -> Task:
    """A small contended task, the same for the same state of `rng`; `knobs` are those of `Knobs`.

    Its bounds are drawn around a hidden schedule, so it is feasible, unless one bound was then
    tightened (`tighten`). It stays within what `oracles.brute_force` knows.
    """
    setting = Knobs(**knobs)
    draft = _Draft()
    _draw_resources(rng, setting, draft)
    for i in range(rng.randint(*setting.actions)):
        _draw_action(rng, setting, draft, i)
    _draw_max_lags(rng, setting, draft)
    _draw_windows(rng, setting, draft)
    document: Document = {
        "resources": draft.resources,
        "actions": draft.actions,
        "precedence": draft.precedence,
    }
    last = max((end for _, end in draft.spans), default=0)
    if setting.task_deadline and rng.random() < 0.1:
        document["deadline"] = last + rng.randint(0, 3)
    if draft.actions and rng.random() < setting.tighten:
        _tighten(rng, setting, draft, document)
    _shuffle(rng, document)
    return Task.model_validate(document)


def big_capacity_task(rng: random.Random, **knobs: Any) -> Task:
    """As `random_task`, with capacities of 20 to 100 and amounts above 1 that contend for them."""
    return random_task(rng, **{"capacities": (20, 100), "resources": (1, 2), **knobs})


def contended_task(rng: random.Random, n: int) -> Task:
    """A feasible task of `n` jobs on stations, most with one of two or three robots, and lags."""
    robots = [f"robot{i + 1}" for i in range(rng.randint(2, 3))]
    stations = [f"station{i + 1}" for i in range(max(2, n // 4))]
    actions: list[Document] = []
    precedence: list[Document] = []
    for i in range(n):
        uses: list[Document] = [{"resource": rng.choice(stations)}]
        if rng.random() < 0.7:
            uses.append({"one_of": robots})
        actions.append({"id": f"job{i + 1}", "duration": rng.randint(1, 9), "uses": uses})
        for before in rng.sample(range(i), min(i, rng.choice((0, 1, 1, 2)))):
            lag = {"min_lag": rng.randint(1, 4)} if rng.random() < 0.4 else {}
            precedence.append({"before": f"job{before + 1}", "after": f"job{i + 1}", **lag})
    resources = [{"id": r} for r in robots]
    resources += [{"id": s, "capacity": rng.choice((1, 1, 2))} for s in stations]
    return Task.model_validate(
        {"resources": resources, "actions": actions, "precedence": precedence}
    )


def _draw_resources(rng: random.Random, setting: Knobs, draft: _Draft) -> None:
    for i in range(rng.randint(*setting.resources)):
        draft.resources.append({"id": f"r{i + 1}", "capacity": rng.randint(*setting.capacities)})


def _draw_action(rng: random.Random, setting: Knobs, draft: _Draft, i: int) -> None:
    """One more action, bound to earlier ones, and its place in the hidden schedule."""
    shortest = length = rng.randint(*setting.durations)
    action: Document = {"id": f"a{i + 1}", "duration": length}
    if setting.ranges and rng.random() < 0.08:
        shortest = rng.randint(setting.durations[0], length)
        action["duration"] = {"min": shortest, "max": length + rng.randint(0, 2)}
    action["uses"] = _draw_uses(rng, setting, draft)
    arcs = _draw_arcs(rng, setting, i)
    start = max([0, *(_least_start(arc, draft, length) for arc in arcs)])
    if rng.random() < 0.15:
        start += rng.randint(1, 3)
    held = [(rng.choice(u.get("one_of") or [u["resource"]]), u["amount"]) for u in action["uses"]]
    while not _take(held, start, length, draft):
        start += 1
    draft.actions.append(action)
    draft.precedence += arcs
    draft.spans.append((start, start + length))


def _draw_uses(rng: random.Random, setting: Knobs, draft: _Draft) -> list[Document]:
    uses: list[Document] = []
    room = {r["id"]: r["capacity"] for r in draft.resources}
    for _ in range(rng.choice((0, 1, 1, 1, 2)) if room else 0):
        pool = rng.sample(list(room), rng.randint(2, len(room))) if len(room) > 1 else []
        if not setting.one_of or rng.random() < 0.6:
            pool = []
        where: Document = {"one_of": pool} if pool else {"resource": rng.choice(list(room))}
        named = pool or [where["resource"]]
        amount = _draw_amount(rng, setting, min(room[r] for r in named))
        for r in named:
            room[r] -= amount
            if room[r] == 0:
                del room[r]
        uses.append({**where, "amount": amount})
        if not room:
            break
    return uses


def _draw_amount(rng: random.Random, setting: Knobs, most: int) -> int:
    if not setting.amounts or most == 1:
        return 1
    if most > 5:
        return rng.randint(max(2, most // 5), max(2, most * 3 // 4))
    return rng.randint(1, most) if rng.random() < 0.4 else 1


def _draw_arcs(rng: random.Random, setting: Knobs, i: int) -> list[Document]:
    if not setting.precedence:
        return []
    arcs: list[Document] = []
    for j in rng.sample(range(i), min(i, rng.choice((0, 0, 1, 1, 2)))):
        arc: Document = {"before": f"a{j + 1}", "after": f"a{i + 1}"}
        if setting.types:
            arc["type"] = rng.choices(_TYPES, _TYPE_WEIGHTS)[0]
        if setting.min_lags and rng.random() < 0.4:
            arc["min_lag"] = rng.randint(-4, -1) if rng.random() < 0.3 else rng.randint(1, 4)
        arcs.append(arc)
    return arcs


def _ends(arc: Document) -> tuple[int, int]:
    """Which point of each span an arc binds: 0 the start, 1 the end."""
    before, after = arc.get("type", "finish-start").split("-")
    return int(before == "finish"), int(after == "finish")


def _least_start(arc: Document, draft: _Draft, length: int) -> int:
    of_before, of_after = _ends(arc)
    point = draft.spans[int(arc["before"][1:]) - 1][of_before] + int(arc.get("min_lag", 0))
    return point - of_after * length


def _take(held: Sequence[tuple[str, int]], start: int, length: int, draft: _Draft) -> bool:
    """Enters what an action holds into the hidden schedule, if it fits there."""
    used = dict(draft.used)
    for resource, amount in held:
        for instant in range(start, start + length):
            used[resource, instant] = used.get((resource, instant), 0) + amount
    capacity = {r["id"]: r["capacity"] for r in draft.resources}
    if any(amount > capacity[r] for (r, _), amount in used.items()):
        return False
    draft.used = used
    return True


def _draw_max_lags(rng: random.Random, setting: Knobs, draft: _Draft) -> None:
    for arc in draft.precedence:
        if setting.max_lags and rng.random() < 0.3:
            arc["max_lag"] = _gap(arc, draft) + rng.choice((0, 0, 1, 2, 4))


def _gap(arc: Document, draft: _Draft) -> int:
    of_before, of_after = _ends(arc)
    before, after = (int(arc[side][1:]) - 1 for side in ("before", "after"))
    return draft.spans[after][of_after] - draft.spans[before][of_before]


def _draw_windows(rng: random.Random, setting: Knobs, draft: _Draft) -> None:
    for action, (start, end) in zip(draft.actions, draft.spans, strict=True):
        if setting.windows and rng.random() < 0.2:
            action["release"] = rng.randint(0, start)
        if setting.windows and rng.random() < 0.2:
            action["deadline"] = end + rng.randint(0, 5)
        if setting.fixed_starts and rng.random() < 0.04:
            action["start"] = start
            action.pop("release", None)


def _tighten(rng: random.Random, setting: Knobs, draft: _Draft, document: Document) -> None:
    """Cuts one bound below what the hidden schedule needs, of a kind that is switched on."""
    ways: list[Callable[[], None]] = []
    last = max(draft.spans, key=lambda span: span[1])[1]
    if setting.windows:
        k = rng.randrange(len(draft.actions))
        cut = draft.spans[k][1] - rng.randint(1, 3)
        ways.append(lambda: draft.actions[k].update(deadline=max(0, cut)))
    if setting.max_lags and draft.precedence:
        arc = rng.choice(draft.precedence)
        ways.append(lambda: arc.update(max_lag=_gap(arc, draft) - rng.randint(1, 3)))
    if setting.task_deadline:
        ways.append(lambda: document.update(deadline=max(0, last - rng.randint(1, 4))))
    if ways:
        rng.choice(ways)()


def _shuffle(rng: random.Random, document: Document) -> None:
    """The hidden schedule must not show in the order of the arrays."""
    for part in ("actions", "precedence"):
        rng.shuffle(document[part])


# --- hostile names ------------------------------------------------------------------------------

_REFERENCES = {
    **dict.fromkeys(("before", "after", "action", "actions", "goals"), "action"),
    **dict.fromkeys(("resource", "one_of"), "resource"),
    **dict.fromkeys(("group", "groups"), "group"),
    "var": "state",
}
"""Fields whose text (or list of texts) names something, and the name space it is in."""

_OWNERS = {
    **{"actions": "action", "resources": "resource", "groups": "group", "state": "state"},
    **{"modes": "mode", "events": "event"},
}
"""Lists whose objects have an `id`, and its name space."""


def hostile_names(task: Task, rng: random.Random) -> Task:
    """`task` with every id replaced by a hostile one, in all places alike.

    Actions, resources, groups, state variables, modes and events have name spaces of their own,
    so an action and a resource may now have the same name.
    """
    document = task.model_dump(mode="json", by_alias=True, exclude_unset=True)
    return Task.model_validate(_Renamer(rng).renamed(document))


@dataclass
class _Renamer:
    """Renames what it meets for the first time, and remembers it."""

    rng: random.Random
    known: dict[str, dict[str, str]] = field(default_factory=dict)

    def renamed(self, raw: Any, key: str = "") -> Any:
        """The part of a document that stands under `key`."""
        if isinstance(raw, list):
            return [self.renamed(item, key) for item in raw]
        if isinstance(raw, Mapping):
            return {inner: self._member(raw[inner], inner, key) for inner in raw}
        if isinstance(raw, str) and key in _REFERENCES:
            return self._name(_REFERENCES[key], raw)
        return raw

    def _member(self, raw: Any, key: str, owner: str) -> Any:
        if key == "metadata":
            return raw
        if key == "id" and raw is not None:
            return self._name(_OWNERS[owner], raw)
        return self.renamed(raw, key)

    def _name(self, space: str, old: str) -> str:
        names = self.known.setdefault(space, {})
        if old not in names:
            taken = set(names.values())
            free = [name for name in HOSTILE_NAMES if name not in taken]
            names[old] = self.rng.choice(free) if free else "(" * (len(taken) + 1)
        return names[old]


# --- the whole IR, for hypothesis ---------------------------------------------------------------

_Strategy = st.SearchStrategy[Any]

_EARLIEST, _LATEST = datetime(1990, 1, 1), datetime(2100, 1, 1)
_UNITS = ("ms", "s", "min", "h", "days", "weeks", "months", "years")
_OBJECTIVES = (
    *("minimize_makespan", "minimize_tardiness", "maximize_reward"),
    *("minimize_cost", "minimize_changes"),
)

_TEXTS = st.text(st.characters(exclude_categories=["Cs"]), max_size=20)
_NAMES = st.sampled_from(HOSTILE_NAMES) | _TEXTS.filter(bool) | st.sampled_from(["a", "b", "c"])
_AMOUNTS = st.integers(1, 10**9)
_INTEGERS = st.integers(-(10**12), 10**12)
_QUANTITIES = (
    st.builds("{} {}".format, st.integers(0, 10**6), st.sampled_from(_UNITS))
    | st.builds("{} h {} min".format, st.integers(0, 99), st.integers(0, 59))
    | st.builds("PT{}H{}M".format, st.integers(0, 99), st.integers(0, 59))
    | st.builds("{}.{} {}".format, st.integers(0, 99), st.integers(0, 999), st.sampled_from(_UNITS))
)
_SPANS = (
    st.integers(0, 20)
    | st.integers(0, 10**12)
    | st.sampled_from([0.1, 0.25, 2.5, 1e-6])
    | st.builds("{}/{}".format, st.integers(0, 99), st.integers(1, 99))
    | st.builds("{}.{}".format, st.integers(0, 99), st.integers(0, 99))
    | _QUANTITIES
)
_LAGS = (
    _SPANS
    | st.integers(-20, -1)
    | st.builds("-{}".format, _QUANTITIES.filter(lambda text: text[0] != "P"))
)
_JSON = st.recursive(
    st.none() | st.booleans() | _INTEGERS | _TEXTS,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(_TEXTS, inner, max_size=3),
    max_leaves=5,
)
"""Free-form data. Without floats, which a careful reader turns into decimals."""


@dataclass(frozen=True)
class _Declared:
    """What the parts of a document may name, and how its instants are written."""

    actions: tuple[str, ...]
    resources: tuple[str, ...]
    reservoirs: tuple[str, ...]
    state: Mapping[str, tuple[bool | str, ...]]
    groups: tuple[str, ...]
    instants: _Strategy


def tasks() -> st.SearchStrategy[Task]:
    """Tasks over the whole IR: every field, every way to write a time, every operation of events.

    References name what the task (or one of its events) declares, with the right kind. Nothing
    else is promised: a task may well be contradictory.
    """
    return documents().map(Task.model_validate)


@st.composite
def documents(draw: st.DrawFn) -> Document:
    """The JSON documents behind `tasks`: only JSON's own types; aliases are used now and then."""
    origin, instants = draw(_origins())
    names = draw(st.lists(_NAMES, min_size=1, max_size=5, unique=True))
    stocks = draw(st.lists(_NAMES, max_size=4, unique=True))
    cut = draw(st.integers(0, len(stocks)))
    declared = _Declared(
        actions=tuple(names),
        resources=tuple(stocks[:cut]),
        reservoirs=tuple(stocks[cut:]),
        state=draw(st.dictionaries(_NAMES, _state_values(), max_size=3)),
        groups=tuple(draw(st.lists(_NAMES, max_size=2, unique=True))),
        instants=instants,
    )
    late = draw(st.integers(0, len(names) - 1))
    document: Document = draw(_settings(declared))
    document["actions"] = [draw(_action(declared, name)) for name in names[late:]]
    document["resources"] = [draw(_renewable(declared, r)) for r in declared.resources]
    document["resources"] += [draw(_reservoir(r)) for r in declared.reservoirs]
    document["state"] = [draw(_variable(v, values)) for v, values in declared.state.items()]
    document["groups"] = [draw(_group(declared, name)) for name in declared.groups]
    arcs = draw(st.lists(_arc(declared), max_size=4))
    document[draw(st.sampled_from(["precedence", "dependencies"]))] = arcs
    document["events"] = draw(st.lists(_event(declared, names[:late]), max_size=3))
    return document if origin is None else {**document, "origin": origin}


@st.composite
def _origins(draw: st.DrawFn) -> tuple[str | None, _Strategy]:
    """An `origin` or None, and instants to go with it: with a time zone as the origin has one."""
    zone = draw(st.sampled_from([None, "", "Z", "+05:30"]))
    if zone is None:
        return None, _SPANS
    dates = st.datetimes(min_value=_EARLIEST, max_value=_LATEST).map(
        lambda date: date.isoformat() + zone
    )
    return draw(dates), _SPANS | dates


def _state_values() -> _Strategy:
    several = st.lists(_TEXTS | st.booleans(), min_size=1, max_size=3, unique=True).map(tuple)
    return st.just((False, True)) | several


def _settings(declared: _Declared) -> _Strategy:
    return st.fixed_dictionaries(
        {},
        optional={
            "irc": st.just("1"),
            "name": _TEXTS,
            "description": _TEXTS,
            "time_unit": st.sampled_from(["ms", "s", "min", "hour", "day", "month"]),
            "days_per_month": st.integers(1, 31),
            "deadline": declared.instants,
            "metadata": st.dictionaries(_TEXTS, _JSON, max_size=3),
            "goals": st.lists(_goal(declared), max_size=2),
            "objective": _objective(),
        },
    )


def _objective() -> _Strategy:
    several = st.lists(st.sampled_from(_OBJECTIVES), min_size=1, max_size=5, unique=True)
    return st.sampled_from(_OBJECTIVES) | several


def _goal(declared: _Declared) -> _Strategy:
    present = st.sampled_from(declared.actions)
    return present | _assignment(declared, {}) if declared.state else present


def _assignment(declared: _Declared, others: Mapping[str, _Strategy]) -> _Strategy:
    """An object that gives a state variable one of its values, with `others` beside it."""
    return st.sampled_from(sorted(declared.state)).flatmap(
        lambda var: st.fixed_dictionaries(
            {**others, "var": st.just(var), "value": st.sampled_from(declared.state[var])}
        )
    )


def _duration() -> _Strategy:
    return _SPANS | st.fixed_dictionaries({"min": _SPANS, "max": _SPANS})


def _use(declared: _Declared) -> _Strategy:
    named = st.sampled_from(declared.resources)
    amount = {"amount": _AMOUNTS}
    pool = st.lists(named, min_size=1, max_size=3, unique=True)
    return st.fixed_dictionaries({"resource": named}, optional=amount) | st.fixed_dictionaries(
        {"one_of": pool}, optional=amount
    )


def _few(element: Callable[[_Declared], _Strategy], declared: _Declared, pool: Any) -> _Strategy:
    """A short list of what can only be said where `pool` has something to name."""
    return st.lists(element(declared), max_size=2) if pool else st.just([])


def _mode(declared: _Declared) -> _Strategy:
    return st.fixed_dictionaries(
        {"id": _NAMES, "duration": _duration()},
        optional={"label": _TEXTS, "uses": _few(_use, declared, declared.resources)},
    )


def _modes(declared: _Declared) -> _Strategy:
    return st.lists(_mode(declared), min_size=1, max_size=3, unique_by=lambda mode: mode["id"])


def _stock_change(declared: _Declared) -> _Strategy:
    return st.fixed_dictionaries(
        {"resource": st.sampled_from(declared.reservoirs)},
        optional={"amount": _AMOUNTS, "at": st.sampled_from(["start", "end"])},
    )


def _condition(declared: _Declared) -> _Strategy:
    return _assignment(declared, {"at": st.sampled_from(["start", "all", "end"])})


def _effect(declared: _Declared) -> _Strategy:
    return _assignment(declared, {"at": st.sampled_from(["start", "end"])})


def _occurs() -> _Strategy:
    counts = st.integers(0, 5)
    several = st.fixed_dictionaries({}, optional={"min": counts, "max": counts})
    return st.sampled_from(["once", "optional"]) | several


def _action(declared: _Declared, name: str) -> _Strategy:
    optional = {
        "label": _TEXTS,
        "description": _TEXTS,
        "occurs": _occurs(),
        "uses": _few(_use, declared, declared.resources),
        "consumes": _few(_stock_change, declared, declared.reservoirs),
        "produces": _few(_stock_change, declared, declared.reservoirs),
        "release": declared.instants,
        "deadline": declared.instants,
        "due": declared.instants,
        "weight": _AMOUNTS,
        "start": declared.instants,
        "conditions": _few(_condition, declared, declared.state),
        "effects": _few(_effect, declared, declared.state),
        "reward": _INTEGERS,
        "cost": _INTEGERS,
    }
    own = {"id": st.just(name)}
    return st.fixed_dictionaries(
        {**own, "duration": _duration()}, optional=optional
    ) | st.fixed_dictionaries({**own, "modes": _modes(declared)}, optional=optional)


def _renewable(declared: _Declared, name: str) -> _Strategy:
    window = st.fixed_dictionaries(
        {"from": declared.instants, "to": declared.instants, "capacity": st.integers(0, 100)}
    )
    return st.fixed_dictionaries(
        {"id": st.just(name)},
        optional={
            "kind": st.just("renewable"),
            "label": _TEXTS,
            "description": _TEXTS,
            "capacity": st.integers(0, 10**9),
            "availability": st.lists(window, max_size=2),
        },
    )


def _reservoir(name: str) -> _Strategy:
    return st.fixed_dictionaries(
        {"id": st.just(name), "kind": st.just("reservoir")},
        optional={"label": _TEXTS, "initial": _INTEGERS, "min": _INTEGERS, "max": _INTEGERS},
    )


def _variable(name: str, values: Sequence[bool | str]) -> _Strategy:
    initial = {"initial": st.sampled_from(values)}
    shown: dict[str, _Strategy] = {"id": st.just(name)}
    if values != (False, True):
        shown["values"] = st.just(list(values))
    return st.fixed_dictionaries(shown, optional=initial)


def _group(declared: _Declared, name: str) -> _Strategy:
    members = st.lists(st.sampled_from(declared.actions), max_size=3, unique=True)
    return st.fixed_dictionaries(
        {"id": st.just(name), "actions": members},
        optional={
            "label": _TEXTS,
            "required": st.booleans(),
            "reward": _INTEGERS,
            "deadline": declared.instants,
            "due": declared.instants,
            "weight": _AMOUNTS,
        },
    )


def _arc(declared: _Declared) -> _Strategy:
    named = st.sampled_from(declared.actions)
    more = {"type": st.sampled_from(_TYPES), "max_lag": _LAGS}
    plain = st.fixed_dictionaries(
        {"before": named, "after": named}, optional={**more, "min_lag": _LAGS}
    )
    aliased = st.fixed_dictionaries(
        {"predecessor": named, "successor": named}, optional={**more, "lag": _LAGS}
    )
    return plain | aliased | st.lists(named, min_size=2, max_size=2)


def _event(declared: _Declared, late: Sequence[str]) -> _Strategy:
    changes = st.lists(st.one_of(_changes(declared, late)), max_size=3)
    return st.fixed_dictionaries(
        {"at": declared.instants}, optional={"id": _NAMES, "changes": changes}
    )


def _changes(declared: _Declared, late: Sequence[str]) -> list[_Strategy]:
    """One strategy for each operation that has something to work on; `late` are new actions."""
    action, instant = st.sampled_from(declared.actions), declared.instants
    actions = st.lists(action, max_size=2, unique=True)
    pairs = st.lists(st.fixed_dictionaries({"before": action, "after": action}), max_size=2)
    window = {"from": instant, "to": instant}
    times = {"started": instant, "finished": instant, "occurrence": st.integers(1, 3)}
    found = [
        _change("add_actions", actions=_each(late, lambda name: _action(declared, name))),
        _change("cancel_actions", actions=actions),
        _change("set_duration", action=action, duration=_duration()),
        _change("add_precedence", precedence=st.lists(_arc(declared), max_size=2)),
        _change("remove_precedence", precedence=pairs),
        _change("set_deadline", deadline=instant | st.none()),
        _change("set_deadline", deadline=instant | st.none(), action=action),
        _change("set_release", action=action, release=instant),
        _change("set_goals", goals=st.lists(_goal(declared), max_size=2)),
        _change("set_objective", objective=_objective()),
        _change("observe", times, action=action),
        _change("add_resources", resources=_NAMES.flatmap(_reservoir).map(_one)),
        _change("add_state", state=_NAMES.flatmap(lambda v: _variable(v, ("", "on"))).map(_one)),
        _change("add_groups", groups=_NAMES.flatmap(lambda g: _group(declared, g)).map(_one)),
    ]
    if declared.resources:
        named = st.sampled_from(declared.resources)
        found.append(_change("set_capacity", window, resource=named, capacity=st.integers(0, 9)))
    if declared.groups:
        group = st.sampled_from(declared.groups)
        found.append(_change("set_deadline", deadline=instant, group=group))
        found.append(_change("cancel_groups", groups=st.lists(group, max_size=2, unique=True)))
    if declared.state:
        found.append(_assignment(declared, {"op": st.just("set_state")}))
    return found


def _change(
    op: str, optional: Mapping[str, _Strategy] | None = None, **fields: _Strategy
) -> _Strategy:
    return st.fixed_dictionaries({"op": st.just(op), **fields}, optional=dict(optional or {}))


def _each(names: Sequence[str], element: Callable[[str], _Strategy]) -> _Strategy:
    return st.tuples(*(element(name) for name in names)).map(list)


def _one(item: Any) -> list[Any]:
    return [item]
