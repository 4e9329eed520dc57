"""What an online kitchen episode says, from the benchmark's raw JSON, as more and more is revealed.

Of the project it is only known how actions are called (`<action>_<item>`).
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import pairwise
from typing import Any

Document = Mapping[str, Any]
Worth = tuple[int | None, Fraction]
"""Reward (None: nothing can earn one) and makespan."""

STACK = "stack"
_STATION = {
    "grill": "grill",
    "cut": "cutting_board",
    "fry": "fryer",
    "boil": "boiler",
    "toast": "toaster",
    "marinate": "marinator",
    "mash": "cutting_board",
}
_MADE_BY = {
    "grilled": "grill",
    "cut": "cut",
    "fried": "fry",
    "boiled": "boil",
    "toasted": "toast",
    "marinated": "marinate",
    "mashed": "mash",
}
_DELTAS = frozenset(
    [
        *("add_items", "add_deliveries", "add_candidate_goals"),
        *("add_temporal_constraints", "set_deadline"),
    ]
)


@dataclass(frozen=True)
class Job:
    """What must be done once: for how long, where, before when, and for which candidate goal."""

    length: Fraction
    station: str | None
    deadline: Fraction | None = None
    candidate: str | None = None


@dataclass
class Known:
    """All that is known at a moment."""

    durations: Mapping[str, Fraction]
    stations: Mapping[str, int]
    robots: Sequence[str]
    stock: Mapping[str, int]
    items: dict[str, Document] = field(default_factory=dict)
    deadline: Fraction | None = None
    jobs: dict[str, Job] = field(default_factory=dict)
    lags: list[tuple[str, str, Fraction, Fraction | None]] = field(default_factory=list)
    """(before, after, least, most) from the end of one to the start of the other."""
    goals: dict[str, Document] = field(default_factory=dict)
    states: dict[str, str] = field(default_factory=dict)

    def candidate_jobs(self, goal: str) -> list[str]:
        return [name for name, job in self.jobs.items() if job.candidate == goal]

    def limit(self, job: Job) -> Fraction | None:
        stated = [d for d in (job.deadline, self.deadline) if d is not None]
        return min(stated, default=None)


@dataclass(frozen=True)
class Run:
    start: Fraction
    end: Fraction
    resources: Mapping[str, int]
    status: str | None


Plan = dict[str, Run]


def time_of(raw: Any) -> Fraction:
    return Fraction(str(raw))


def initial(task: Document) -> Known:
    known = Known(
        {name: time_of(value) for name, value in task["action_durations"].items()},
        task["stations"],
        task.get("robots", ()),
        task.get("inventory_limits", {}),
    )
    reveal(
        known,
        {
            "add_items": task["items"],
            "add_deliveries": task.get("deliveries", ()),
            "add_candidate_goals": task.get("candidate_goals", ()),
            "add_temporal_constraints": task.get("temporal_constraints", ()),
            "set_deadline": task.get("deadline"),
        },
    )
    return known


def moments_of(events: Sequence[Document]) -> list[tuple[Fraction, list[Document]]]:
    """The events by their times; those of one instant in the order in which they stand."""
    found: dict[Fraction, list[Document]] = defaultdict(list)
    for event in events:
        found[time_of(event["trigger_time"])].append(event)
    return sorted(found.items())


def reveal(known: Known, delta: Document) -> None:
    unknown = delta.keys() - _DELTAS
    if unknown:
        raise ValueError(f"this judge does not know {sorted(unknown)}")
    known.items.update(delta.get("add_items", {}))
    if delta.get("set_deadline") is not None:
        known.deadline = time_of(delta["set_deadline"])
    for delivery in delta.get("add_deliveries", ()):
        _add_delivery(known, delivery)
    for goal in delta.get("add_candidate_goals", ()):
        known.goals[goal["id"]] = goal
        _add_work(known, goal["item"], goal["state"], None, goal["id"])
    for lag in delta.get("add_temporal_constraints", ()):
        ends = [f"{lag[side]['action']}_{lag[side]['item']}" for side in ("before", "after")]
        if not known.jobs.keys() >= set(ends):
            raise ValueError(f"no goal needs one of {ends}")
        most = None if lag.get("max_lag") is None else time_of(lag["max_lag"])
        known.lags.append((ends[0], ends[1], time_of(lag.get("min_lag", 0)), most))


def _add_delivery(known: Known, delivery: Document) -> None:
    if delivery.get("reward") is not None:
        raise ValueError(f"this judge does not know rewards of deliveries ({delivery['id']})")
    deadline = None if delivery.get("deadline") is None else time_of(delivery["deadline"])
    for item, state in delivery["required_states"].items():
        _add_work(known, item, state, deadline, None)
    order = list(delivery["stack_order"])
    for item in order:
        _add_job(known, STACK, item, deadline, None)
        state = known.states.get(item, known.items[item]["state"])
        if state != known.items[item]["state"]:
            known.lags.append((f"{_MADE_BY[state]}_{item}", f"{STACK}_{item}", Fraction(0), None))
    for below, above in pairwise(order):
        known.lags.append((f"{STACK}_{below}", f"{STACK}_{above}", Fraction(0), None))


def _add_work(
    known: Known, item: str, wanted: str, deadline: Fraction | None, candidate: str | None
) -> None:
    if known.states.setdefault(item, wanted) != wanted:
        raise ValueError(f"{item!r} is wanted in two states")
    chain = _chain(item, known.items[item], wanted)
    for action in chain:
        _add_job(known, action, item, deadline, candidate)
    for first, second in pairwise(chain):
        known.lags.append((f"{first}_{item}", f"{second}_{item}", Fraction(0), None))


def _add_job(
    known: Known, action: str, item: str, deadline: Fraction | None, candidate: str | None
) -> None:
    name = f"{action}_{item}"
    if name in known.jobs:
        raise ValueError(f"two orders want {name!r}")
    station = _STATION.get(action)
    if station is not None and station not in known.stations:
        raise ValueError(f"there is no {station!r}")
    known.jobs[name] = Job(known.durations[action], station, deadline, candidate)


def _chain(name: str, item: Document, wanted: str) -> list[str]:
    """The processing that makes an item what is wanted, in order."""
    has = frozenset(item.get("predicates", ()))
    chain: list[str] = []
    state = wanted
    while state != item["state"]:
        action = _MADE_BY.get(state)
        source = None if action is None else _needs(action, has, item)
        if action is None or source is None:
            raise ValueError(f"{name!r} cannot become {wanted!r}")
        chain.insert(0, action)
        state = source
    return chain


def _needs(action: str, has: frozenset[str], item: Document) -> str | None:
    """The state that an action starts from; None where the item does not admit it."""
    ways: dict[str, list[tuple[bool, str]]] = {
        "grill": [
            (bool(item.get("grill_requires_marinated")), "marinated"),
            ("iscookable" in has, "raw"),
            ("iscookableifmarinated" in has, "marinated"),
        ],
        "fry": [
            (bool(item.get("fry_requires_cut")), "cut"),
            ("isfryable" in has, "raw"),
            ("isfryableifcut" in has, "cut"),
        ],
        "cut": [("iscuttable" in has, "raw")],
        "marinate": [("ismarinatable" in has, "cut")],
        "boil": [("isboilable" in has, "raw")],
        "mash": [(True, "boiled")],
        "toast": [(True, "raw")],
    }
    return next((source for allowed, source in ways[action] if allowed), None)


def half_done_goals(known: Known, frozen: Plan) -> list[str]:
    """The goals of which something has started, and that nobody has given up."""
    return [
        goal
        for goal in known.goals
        if (begun := [n for n in known.candidate_jobs(goal) if n in frozen])
        and all(frozen[name].status is None for name in begun)
    ]
