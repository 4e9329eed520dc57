"""Random tasks: contended ones for the solvers, hostile names, and the whole IR for hypothesis.

A new element of the IR goes into whole tasks with one entry of `WHOLE_FEATURES`: a strategy of what
is added, and a function that puts it into a document. A task has two such features at most, so an
element that few tasks have costs the others nothing. (Drawn for every task, the optional fields of
a few elements make documents larger than what hypothesis allows one example: it throws most of them
away and seems to hang.) A field that names something goes into `_REFERENCES`, too. Small tasks that
combine features, with exact optima, are in `oracles.combined`, whose `FEATURES` works likewise.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from typing import Any, NamedTuple

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
    for i in range(max(rng.randint(*setting.actions) for _ in range(2))):
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
    _draw_latest_starts(rng, setting, draft)
    return Task.model_validate(document)


def big_capacity_task(rng: random.Random, **knobs: Any) -> Task:
    """As `random_task`, with capacities of 20 to 100 and amounts above 1 that contend for them."""
    return random_task(rng, **{"capacities": (20, 100), "resources": (1, 2), **knobs})


def contended_task(rng: random.Random, n: int) -> Task:
    """A feasible task of `n` jobs on stations, most with one of two or three robots, and lags."""
    robots = [f"robot{i + 1}" for i in range(2 if n < 12 else 3)]
    stations = [f"station{i + 1}" for i in range(max(2, n // 4))]
    actions: list[Document] = []
    precedence: list[Document] = []
    for i in range(n):
        uses: list[Document] = [{"resource": rng.choice(stations)}]
        if rng.random() < 0.8:
            uses.append({"one_of": robots})
        actions.append({"id": f"job{i + 1}", "duration": rng.randint(1, 9), "uses": uses})
        for before in rng.sample(range(i), min(i, rng.choice((0, 0, 1, 1, 2)))):
            arc: Document = {"before": f"job{before + 1}", "after": f"job{i + 1}"}
            if rng.random() < 0.4:
                arc["min_lag"] = rng.randint(1, 4)
            precedence.append(arc)
    resources: list[Document] = [{"id": robot} for robot in robots]
    resources += [{"id": s, "capacity": rng.choice((1, 1, 1, 2))} for s in stations]
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
    for _ in range(rng.choice((0, 1, 1, 1, 1, 2, 2)) if room else 0):
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
    if most >= 5:
        return rng.randint(max(2, most // 3), max(2, most * 3 // 4))
    return rng.randint(1, most) if rng.random() < 0.4 else 1


def _draw_arcs(rng: random.Random, setting: Knobs, i: int) -> list[Document]:
    if not setting.precedence:
        return []
    arcs: list[Document] = []
    for j in rng.sample(range(i), min(i, rng.choice((0, 0, 0, 1, 1, 2)))):
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


def _draw_latest_starts(rng: random.Random, setting: Knobs, draft: _Draft) -> None:
    """Last of all, so that a seed draws all else as it did before there were any."""
    for action in draft.actions:
        start, _ = draft.spans[int(action["id"][1:]) - 1]
        if setting.windows and rng.random() < 0.15:
            action["latest_start"] = start + rng.randint(0, 4)


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
    **dict.fromkeys(("before", "after", "action", "actions", "goals", "repetition"), "action"),
    **dict.fromkeys(("resource", "resources", "one_of"), "resource"),
    **dict.fromkeys(("group", "groups"), "group"),
    "var": "state",
    "mode": "mode",
    "calendar": "calendar",
}
"""Fields whose text (or list of texts) names something, and the name space it is in."""

_OWNERS = {
    "actions": "action",
    "changes": "action",
    "resources": "resource",
    "groups": "group",
    "state": "state",
    "modes": "mode",
    "events": "event",
    "calendars": "calendar",
}
"""Lists whose objects have an `id`, and its name space."""


def hostile_names(task: Task, rng: random.Random) -> Task:
    """`task` with every id replaced by a hostile one, in all places alike.

    Actions, resources, groups, state variables, modes and events have name spaces of their own,
    so an action and a resource may now have the same name.
    """

    def fresh(space: str, old: str, taken: Collection[str]) -> str:
        free = [name for name in HOSTILE_NAMES if name not in taken]
        return rng.choice(free) if free else "(" * (len(taken) + 1)

    document = task.model_dump(mode="json", by_alias=True, exclude_unset=True)
    return Task.model_validate(_Renamer(fresh).renamed(document))


@dataclass
class _Renamer:
    """Asks `fresh(space, old name, names taken)` for a new name once for each old one."""

    fresh: Callable[[str, str, Collection[str]], str]
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
            names[old] = self.fresh(space, old, names.values())
        return names[old]


# --- the whole IR, for hypothesis ---------------------------------------------------------------

_Strategy = st.SearchStrategy[Any]

_ACTIONS, _LATE_ACTIONS = ("action 1", "action 2"), ("action 3",)
_RENEWABLES, _RESERVOIRS, _GROUPS = ("robot 1", "robot 2"), ("stock 1",), ("order 1",)
_STATE: dict[str, list[bool | str]] = {
    "fact 1": [False, True],
    "fact 2": ["raw", "grilled", ""],
    "fact 3": [True, "true", ") (:goal", "1"],
}
_ZONES = (None, "", "Z", "+05:30")
"""No origin at all, or the time zone of the origin and of every date-time beside it."""

_CHARACTERS = st.characters(exclude_categories=["Cs"])
_TEXTS = st.text(_CHARACTERS, max_size=20)
_NAMES = st.sampled_from(HOSTILE_NAMES) | st.text(_CHARACTERS, min_size=1, max_size=20)
_NAME_LISTS = st.fixed_dictionaries(
    {
        space: st.lists(_NAMES, max_size=4, unique=True)
        for space in ("action", "resource", "state", "group")
    }
)
_AMOUNTS = st.integers(1, 10**9)
_INTEGERS = st.integers(-(10**12), 10**12)
_UNITS = st.sampled_from(["ms", "s", "min", "h", "days", "weeks", "months", "years"])
_WITH_UNITS = (
    st.builds("{} {}".format, st.integers(0, 10**6), _UNITS)
    | st.builds("{}.{} {}".format, st.integers(0, 99), st.integers(0, 999), _UNITS)
    | st.builds("{} h {} min".format, st.integers(0, 99), st.integers(0, 59))
)
_SPANS = (
    st.integers(0, 20)
    | st.integers(0, 10**12)
    | st.sampled_from([0.1, 0.25, 2.5, 1e-6])
    | st.builds("{}/{}".format, st.integers(0, 99), st.integers(1, 99))
    | st.builds("{}.{}".format, st.integers(0, 99), st.integers(0, 99))
    | st.builds("PT{}H{}M".format, st.integers(0, 99), st.integers(0, 59))
    | _WITH_UNITS
)
_LAGS = _SPANS | st.integers(-20, -1) | st.builds("-{}".format, _WITH_UNITS)
_DURATIONS = _SPANS | st.fixed_dictionaries({"min": _SPANS, "max": _SPANS})
_JSON = st.recursive(
    st.none() | st.booleans() | _INTEGERS | _TEXTS,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(_TEXTS, inner, max_size=3),
    max_leaves=5,
)
"""Free-form data. Without floats, which a careful reader turns into decimals."""


def tasks() -> st.SearchStrategy[Task]:
    """Tasks over the whole IR: every field, every way to write a time, every operation of events.

    References name what the task (or one of its events) declares, with the right kind. Nothing
    else is promised: a task may well be contradictory.
    """
    return documents().map(Task.model_validate)


def documents() -> st.SearchStrategy[Document]:
    """The JSON documents behind `tasks`: JSON's own types only, and now and then an alias."""
    small = st.fixed_dictionaries(
        {
            "actions": _each(_ACTIONS, lambda name: _object(id=st.just(name), duration=_DURATIONS)),
            "precedence": st.lists(_ARCS, max_size=4),
        }
    )
    kinds = st.one_of([small, *(_with_features(zone) for zone in _ZONES)])
    return st.builds(_with_names, kinds, _NAME_LISTS)


def _with_names(document: Document, names: Mapping[str, Sequence[str]]) -> Document:
    """`document` with as many names replaced as there are; the others keep their plain ones."""

    def fresh(space: str, old: str, taken: Collection[str]) -> str:
        return next((name for name in names.get(space, ()) if name not in taken), old)

    renamed: Document = _Renamer(fresh).renamed(document)
    return renamed


def _object(optional: Mapping[str, _Strategy] | None = None, **fields: _Strategy) -> _Strategy:
    return st.fixed_dictionaries(fields, optional=dict(optional or {}))


def _each(names: Iterable[str], element: Callable[[str], _Strategy]) -> _Strategy:
    return st.tuples(*(element(name) for name in names)).map(list)


def _some(names: Sequence[str], least: int = 0) -> _Strategy:
    return st.lists(st.sampled_from(names), min_size=least, max_size=3, unique=True)


def _valued(**fields: _Strategy) -> _Strategy:
    """Objects that give a state variable one of its values."""
    return st.one_of(
        [
            _object({}, **fields, var=st.just(var), value=st.sampled_from(values))
            for var, values in _STATE.items()
        ]
    )


_ANY_ACTION, _ANY_RENEWABLE = st.sampled_from(_ACTIONS), st.sampled_from(_RENEWABLES)
_GOALS = st.lists(_ANY_ACTION | _valued(), max_size=2)
_OBJECTIVE_NAMES = st.sampled_from(
    [
        *("minimize_makespan", "minimize_tardiness", "maximize_reward"),
        *("minimize_cost", "minimize_changes"),
    ]
)
_OBJECTIVES = _OBJECTIVE_NAMES | st.lists(_OBJECTIVE_NAMES, min_size=1, max_size=5, unique=True)
_ARCS = (
    _object(
        {"type": st.sampled_from(_TYPES), "min_lag": _LAGS, "max_lag": _LAGS},
        before=_ANY_ACTION,
        after=_ANY_ACTION,
    )
    | _object({"lag": _LAGS, "max_lag": _LAGS}, predecessor=_ANY_ACTION, successor=_ANY_ACTION)
    | st.lists(_ANY_ACTION, min_size=2, max_size=2)
)
_USES = st.lists(
    _object({"amount": _AMOUNTS}, resource=_ANY_RENEWABLE)
    | _object({"amount": _AMOUNTS}, one_of=_some(_RENEWABLES, least=1)),
    max_size=2,
)
_STOCK_CHANGES = st.lists(
    _object(
        {"amount": _AMOUNTS, "at": st.sampled_from(["start", "end"])},
        resource=st.sampled_from(_RESERVOIRS),
    ),
    max_size=2,
)
_OCCURS = st.sampled_from(["once", "optional"]) | _object(
    {"min": st.integers(0, 5), "max": st.integers(0, 5)}
)
_CONDITIONS = st.lists(_valued(at=st.sampled_from(["start", "all", "end"])), max_size=2)
_EFFECTS = st.lists(_valued(at=st.sampled_from(["start", "end"])), max_size=2)
_MODES = st.lists(
    _object(
        {
            "label": _TEXTS,
            "uses": _USES,
            "consumes": _STOCK_CHANGES,
            "produces": _STOCK_CHANGES,
            "conditions": _CONDITIONS,
            "effects": _EFFECTS,
            "cost": _INTEGERS,
        },
        id=_NAMES,
        duration=_DURATIONS,
    ),
    min_size=1,
    max_size=3,
    unique_by=lambda mode: mode["id"],
)


def _whole_document(zone: str | None) -> _Strategy:
    instants = _SPANS if zone is None else _SPANS | _dates(zone)
    parts = _object(
        {
            "irc": st.just("1"),
            "name": _TEXTS,
            "description": _TEXTS,
            "time_unit": st.sampled_from(["ms", "s", "min", "hour", "day", "month"]),
            "days_per_month": st.integers(1, 31),
            "deadline": instants,
            "metadata": st.dictionaries(_TEXTS, _JSON, max_size=3),
            "goals": _GOALS,
            "objective": _OBJECTIVES,
        },
        resources=st.tuples(
            *(_renewable(name, instants) for name in _RENEWABLES),
            *(_reservoir(name) for name in _RESERVOIRS),
        ).map(list),
        state=_each(_STATE, _variable),
        actions=_each(_ACTIONS, lambda name: _action(name, instants)),
        groups=_each(_GROUPS, lambda name: _group(name, instants)),
        events=st.lists(_event(instants), max_size=2),
    )
    arcs = st.lists(_ARCS, max_size=4)
    spelling = _object(precedence=arcs) | _object(dependencies=arcs)
    origin = st.just({}) if zone is None else st.fixed_dictionaries({"origin": _dates(zone)})
    return st.builds(
        lambda *said: {k: v for part in said for k, v in part.items()}, parts, spelling, origin
    )


def _dates(zone: str) -> _Strategy:
    dates = st.datetimes(min_value=datetime(1990, 1, 1), max_value=datetime(2100, 1, 1))
    return dates.map(lambda date: date.isoformat() + zone)


def _renewable(name: str, instants: _Strategy) -> _Strategy:
    capacities = st.integers(0, 10**9)
    window = st.fixed_dictionaries({"from": instants, "to": instants, "capacity": capacities})
    return _object(
        {
            "kind": st.just("renewable"),
            "label": _TEXTS,
            "description": _TEXTS,
            "capacity": capacities,
            "availability": st.lists(window, max_size=2),
        },
        id=st.just(name),
    )


def _reservoir(name: str) -> _Strategy:
    return _object(
        {"label": _TEXTS, "initial": _INTEGERS, "min": _INTEGERS, "max": _INTEGERS},
        id=st.just(name),
        kind=st.just("reservoir"),
    )


def _variable(name: str) -> _Strategy:
    initial = {"initial": st.sampled_from(_STATE[name])}
    spelled = _object(initial, id=st.just(name), values=st.just(_STATE[name]))
    if _STATE[name] == [False, True]:
        return _object(initial, id=st.just(name)) | spelled
    return spelled


def _group(name: str, instants: _Strategy) -> _Strategy:
    return _object(
        {
            "label": _TEXTS,
            "required": st.booleans(),
            "reward": _INTEGERS,
            "deadline": instants,
            "due": instants,
            "weight": _AMOUNTS,
        },
        id=st.just(name),
        actions=_some(_ACTIONS),
    )


def _action(name: str, instants: _Strategy) -> _Strategy:
    optional = {
        "label": _TEXTS,
        "description": _TEXTS,
        "occurs": _OCCURS,
        "uses": _USES,
        "consumes": _STOCK_CHANGES,
        "produces": _STOCK_CHANGES,
        "release": instants,
        "deadline": instants,
        "due": instants,
        "weight": _AMOUNTS,
        "start": instants,
        "latest_start": instants,
        "earliest_end": instants,
        "conditions": _CONDITIONS,
        "effects": _EFFECTS,
        "reward": _INTEGERS,
        "cost": _INTEGERS,
    }
    return _object(optional, id=st.just(name), duration=_DURATIONS) | _object(
        optional, id=st.just(name), modes=_MODES
    )


def _event(instants: _Strategy) -> _Strategy:
    """An event with any operations; what it adds has names that the task itself does not use."""
    action, limit = _ANY_ACTION, instants | st.none()
    pairs = st.lists(_object(before=action, after=action), max_size=2)
    observed = {"started": instants, "finished": instants, "occurrence": st.integers(1, 3)}
    extra = _object(id=st.just("fact 4"), values=st.just(["off", "on"]), initial=st.just("off"))
    changes = [
        _change("add_actions", actions=_each(_LATE_ACTIONS, lambda name: _action(name, instants))),
        _change("cancel_actions", actions=_some(_ACTIONS)),
        _change("set_duration", action=action, duration=_DURATIONS),
        _change("add_precedence", precedence=st.lists(_ARCS, max_size=2)),
        _change("remove_precedence", precedence=pairs),
        _change("add_resources", resources=_each(["robot 3"], lambda r: _renewable(r, instants))),
        _change(
            "set_capacity",
            {"from": instants, "to": instants},
            resource=_ANY_RENEWABLE,
            capacity=st.integers(0, 9),
        ),
        _change("set_deadline", deadline=limit),
        _change("set_deadline", deadline=limit, action=action),
        _change("set_deadline", deadline=limit, group=st.sampled_from(_GROUPS)),
        _change("set_release", action=action, release=instants),
        _change("add_groups", groups=_each(["order 2"], lambda name: _group(name, instants))),
        _change("cancel_groups", groups=_some(_GROUPS)),
        _change("set_goals", goals=_GOALS),
        _valued(op=st.just("set_state")),
        _change("add_state", state=st.tuples(extra).map(list)),
        _change("set_objective", objective=_OBJECTIVES),
        _change("observe", observed, action=action),
    ]
    return _object({"id": _NAMES}, at=instants, changes=_subset(changes))


def _subset(elements: Sequence[_Strategy]) -> _Strategy:
    """Each of `elements` with a chance of its own: lists would favour a few of them."""
    return st.tuples(*[st.integers(1, 4)] * len(elements)).flatmap(
        lambda picks: st.tuples(
            *(element for element, pick in zip(elements, picks, strict=True) if pick == 4)
        ).map(list)
    )


def _change(
    op: str, optional: Mapping[str, _Strategy] | None = None, **fields: _Strategy
) -> _Strategy:
    return _object(optional, op=st.just(op), **fields)


# --- features of whole tasks: a new element of the IR goes here ---------------------------------


class WholeFeature(NamedTuple):
    """What a whole task may have besides.

    `drawn` is the strategy of what is added, given that of instants, and `put` adds it to a
    document.
    """

    drawn: Callable[[_Strategy], _Strategy]
    put: Callable[[Document, Any], None]


def _with_features(zone: str | None) -> _Strategy:
    """Whole documents with two features at most."""
    instants = _SPANS if zone is None else _SPANS | _dates(zone)

    def drawn(names: Sequence[str]) -> _Strategy:
        parts = (st.tuples(st.just(n), WHOLE_FEATURES[n].drawn(instants)) for n in names)
        return st.tuples(*parts)

    def put(document: Document, additions: Sequence[tuple[str, Any]]) -> Document:
        for name, added in additions:
            WHOLE_FEATURES[name].put(document, added)
        return document

    chosen = st.lists(st.sampled_from(sorted(WHOLE_FEATURES)), max_size=2, unique=True)
    return st.builds(put, _whole_document(zone), chosen.flatmap(drawn))


def _sets(*keys: str | int) -> Callable[[Document, Any], None]:
    """Sets what is drawn at a place in the document."""

    def put(document: Document, added: Any) -> None:
        part: Any = document
        for key in keys[:-1]:
            part = part[key]
        part[keys[-1]] = added

    return put


def _adds(*keys: str | int) -> Callable[[Document, Any], None]:
    """Adds the members, or the elements, that are drawn to those at a place in the document."""

    def put(document: Document, added: Any) -> None:
        part: Any = document
        for key in keys:
            part = part.setdefault(key, []) if isinstance(part, dict) else part[key]
        if isinstance(part, list):
            part.extend(added)
        else:
            part.update(added)

    return put


def _changed_by_event(*changes: _Strategy) -> WholeFeature:
    """Changes that an event of its own makes."""
    return WholeFeature(
        lambda instants: st.tuples(_object(at=instants, changes=st.tuples(*changes).map(list))),
        _adds("events"),
    )


_LAPSED = _object(
    {
        "occurs": _OCCURS,
        "deadline": _SPANS,
        "precedence": st.lists(_ARCS, max_size=1),
        "groups": _each(
            ["order 3"], lambda name: _object(id=st.just(name), actions=_some(_ACTIONS))
        ),
        "goal": st.booleans(),
        "repetition": _ANY_ACTION,
    },
    action=_ANY_ACTION,
)

_NUMBERS = st.integers(-9, 9) | st.sampled_from([0.5, "1/3", "2.5"])
_NUMBER = "number 1"
_NUMBER_TESTS = st.one_of(
    _object({"at_most": _NUMBERS}, var=st.just(_NUMBER), at_least=st.integers(-9, -8)),
    _object(var=st.just(_NUMBER), at_most=_NUMBERS),
    _object(var=st.just(_NUMBER), equals=_NUMBERS),
)


def _put_number(document: Document, added: Any) -> None:
    """A number, and for each of its other parts a place that it goes to."""
    variable, (at, test), (end, kind, amount), goal = added
    document["state"].append(variable)
    action = document["actions"][0]
    action.setdefault("conditions", []).append({"at": at, **test})
    action.setdefault("effects", []).append({"at": end, "var": _NUMBER, kind: amount})
    document.setdefault("goals", []).append(goal)


def _numbers(_instants: _Strategy) -> _Strategy:
    bounds = {"initial": _NUMBERS, "min": st.integers(-99, -50), "max": st.integers(50, 99)}
    return st.tuples(
        _object(bounds, id=st.just(_NUMBER), kind=st.just("number")),
        st.tuples(st.sampled_from(["start", "all", "end"]), _NUMBER_TESTS),
        st.tuples(st.sampled_from(["start", "end"]), st.sampled_from(["add", "set"]), _NUMBERS),
        _NUMBER_TESTS,
    )


_FAMILIES = st.sampled_from(["red", "blue"])
_SETUP_TIMES = st.lists(
    _object(
        {"time": st.integers(0, 9), "cost": st.integers(0, 9)},
        **{"from": _FAMILIES | st.just("*"), "to": _FAMILIES | st.just("*")},
    ),
    min_size=1,
    max_size=2,
    unique_by=lambda row: (row["from"], row["to"]),
)


def _put_setups(document: Document, added: Any) -> None:
    setups, family = added
    document["resources"][0]["setups"] = setups
    use = {"resource": document["resources"][0]["id"], "family": family}
    document["actions"][0].setdefault("uses", []).append(use)


def _put_mode(document: Document, added: Any) -> None:
    """What a mode adds; an action without modes gets one."""
    action = document["actions"][1]
    if "modes" not in action:
        action["modes"] = [{"id": "only", "duration": action.pop("duration")}]
    action["modes"][0].update(added)


_DAY_TIMES = st.builds("{:02}:{:02}".format, st.integers(0, 23), st.integers(0, 59))
_WEEKLY = st.lists(
    _object(
        {"days": st.lists(st.sampled_from(["mon", "wed", "sun"]), max_size=2, unique=True)},
        **{"from": _DAY_TIMES, "to": _DAY_TIMES},
    ),
    min_size=1,
    max_size=2,
)
_CYCLE = st.tuples(_object(**{"from": st.integers(0, 3), "to": st.integers(4, 6)})).map(list)
_CLOSED = st.lists(
    st.just("2026-12-25")
    | st.just({"from": "2026-12-26", "to": "2026-12-27T10:00"})
    | _object(**{"from": st.integers(0, 20), "to": st.integers(21, 40)}),
    max_size=2,
)


def _calendars(_instants: _Strategy) -> _Strategy:
    """A calendar by the week or in a cycle, and how an action keeps to it."""
    also = {"label": _TEXTS, "description": _TEXTS, "closed": _CLOSED}
    zoned = {**also, "time_zone": st.sampled_from(["Europe/Berlin", "UTC"])}
    return st.tuples(
        _object(zoned, id=st.just("calendar 1"), open=_WEEKLY)
        | _object(also, id=st.just("calendar 1"), every=st.integers(7, 24), open=_CYCLE),
        _object({"breaks": st.sampled_from(["avoid", "pause"]), "max_pause": st.integers(0, 99)}),
    )


def _put_calendar(document: Document, added: Any) -> None:
    calendar, breaks = added
    document.setdefault("calendars", []).append(calendar)
    for part, more in ((document["resources"][0], {}), (document["actions"][0], breaks)):
        part.update(more, calendar=calendar["id"])


_FACT = "fact 2"

WHOLE_FEATURES: dict[str, WholeFeature] = {
    "resolution": WholeFeature(
        lambda _: st.sampled_from([1, "1 ms", "1/7", 0.25]), _sets("resolution")
    ),
    "on failure": WholeFeature(
        lambda _: st.sampled_from(["resume", "restart"]), _sets("actions", 0, "on_failure")
    ),
    "lapsed": WholeFeature(lambda _: st.tuples(_LAPSED), _adds("lapsed")),
    "timed changes": WholeFeature(
        lambda instants: st.lists(
            _object(at=instants, value=st.sampled_from(_STATE[_FACT])), min_size=1, max_size=2
        ),
        _sets("state", list(_STATE).index(_FACT), "changes"),
    ),
    "retried": _changed_by_event(
        _change(
            "retry_action",
            {"id": st.just("again"), "done": _SPANS, "mode": _NAMES},
            action=_ANY_ACTION,
        )
    ),
    "observed": _changed_by_event(
        _change(
            "observe",
            {
                "status": st.sampled_from(["not_begun", "running", "finished", "failed"]),
                "expected_end": _SPANS,
                "mode": _NAMES,
                "resources": _some(_RENEWABLES),
            },
            action=_ANY_ACTION,
        )
    ),
    "mode elements": WholeFeature(
        lambda _: _object(
            {
                "cost": _INTEGERS,
                "consumes": _STOCK_CHANGES,
                "produces": _STOCK_CHANGES,
                "conditions": _CONDITIONS,
                "effects": _EFFECTS,
            }
        ),
        _put_mode,
    ),
    "no idle time": WholeFeature(lambda _: st.just(True), _sets("resources", 0, "no_idle")),
    "numbers": WholeFeature(_numbers, _put_number),
    "calendars": WholeFeature(_calendars, _put_calendar),
    "set-ups": WholeFeature(
        lambda _: st.tuples(_object({"initial": _FAMILIES}, times=_SETUP_TIMES), _FAMILIES),
        _put_setups,
    ),
}
"""What whole tasks may have besides, by name."""
