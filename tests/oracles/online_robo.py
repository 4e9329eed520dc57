"""A strict judge of Online Robo Challenge episodes, from the raw episode and the steps alone.

It reads the benchmark's JSON itself, and of the project it knows only how actions are called
(`<action>_<item>`). A history is approved where, at every step, the schedule keeps all that was
known then (work, durations, order of processing, stations, robots, stack order, lags, deadlines,
stock), has left what ran as it was, plans nothing before the event, and is worth what an exact
continuation from the choices committed by then is worth. That optimum comes from a model of its
own (CP-SAT), and lexicographically: half-done candidate goals finished, reward, makespan.

Robots are alike, so the model counts them. What is frozen started before the event and has its
robot; whatever starts later takes, in the order of starts, one of the robots that are free then.
"""

from __future__ import annotations

from bisect import bisect_right
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import pairwise
from math import gcd, lcm
from typing import Any

from ortools.sat.python import cp_model

Document = Mapping[str, Any]
_Value = tuple[int | None, Fraction]
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


class UndecidedError(Exception):
    """The exact continuation was not found within the time that was allowed."""


@dataclass(frozen=True)
class Verdict:
    """`faults` is empty where the history is valid at every step.

    `worse` has the steps (by number) that are worth less than an exact continuation, and what is
    possible. `optima` has for each step the best (reward, makespan) from what was committed by
    then (the reward is None where there are no candidate goals), and None where nothing can follow.
    """

    faults: tuple[str, ...]
    worse: Mapping[int, str]
    optima: tuple[_Value | None, ...]

    @property
    def approved(self) -> bool:
        """Whether the history is valid, and its last step worth what an exact one is."""
        return not self.faults and len(self.optima) - 1 not in self.worse


@dataclass(frozen=True)
class _Job:
    """What must be done once: for how long, where, before when, and for which candidate goal."""

    length: Fraction
    station: str | None
    deadline: Fraction | None = None
    candidate: str | None = None


@dataclass
class _Known:
    """All that is known at a moment."""

    durations: Mapping[str, Fraction]
    stations: Mapping[str, int]
    robots: Sequence[str]
    stock: Mapping[str, int]
    items: dict[str, Document] = field(default_factory=dict)
    deadline: Fraction | None = None
    jobs: dict[str, _Job] = field(default_factory=dict)
    lags: list[tuple[str, str, Fraction, Fraction | None]] = field(default_factory=list)
    """(before, after, least, most) from the end of one to the start of the other."""
    goals: dict[str, Document] = field(default_factory=dict)
    states: dict[str, str] = field(default_factory=dict)

    def candidate_jobs(self, goal: str) -> list[str]:
        return [name for name, job in self.jobs.items() if job.candidate == goal]

    def limit(self, job: _Job) -> Fraction | None:
        stated = [d for d in (job.deadline, self.deadline) if d is not None]
        return min(stated, default=None)


@dataclass(frozen=True)
class _Run:
    start: Fraction
    end: Fraction
    resources: Mapping[str, int]
    status: str | None


_Plan = dict[str, _Run]


def judge(episode: Document, simulation: Document, *, seconds: float = 60) -> Verdict:
    """The verdict on what `simulate` printed for an episode.

    Raises `ValueError` for an episode that says what this judge does not know, and
    `UndecidedError` where a continuation takes longer than `seconds`.
    """
    known = _initial(episode["initial_task"])
    moments = _moments(episode["events"])
    steps = simulation["steps"]
    faults: list[str] = []
    worse: dict[int, str] = {}
    optima: list[_Value | None] = []
    expected = [Fraction(0), *(at for at, _ in moments)]
    told = [_time(step["at"]) for step in steps]
    if told != expected:
        return Verdict((f"steps at {_many(told)}, not at {_many(expected)}",), {}, ())
    committed: _Plan = {}
    for k, step in enumerate(steps):
        at = expected[k]
        if k:
            for event in moments[k - 1][1]:
                _reveal(known, event["delta"])
        before = committed
        frozen = {name: run for name, run in before.items() if run.start < at}
        best = _continuation(known, frozen, at, seconds)
        optima.append(best and best.worth)
        faults += [f"step {k}: {said}" for said in _step_faults(known, step, before, at, best)]
        if best is not None and (less := _less(known, step, best)):
            worse[k] = less
        names = [None] if not k else [event.get("id") for event in moments[k - 1][1]]
        if _event_names(step) != names:
            faults.append(f"step {k}: says that its events are {step['event']}, not {names}")
        committed, repeated = _plan(step["schedule"])
        faults += [f"step {k}: {name} is there more than once" for name in repeated]
    if steps and _plan(simulation["final"]) != (committed, []):
        faults.append("the final schedule is not that of the last step")
    return Verdict(tuple(faults), worse, tuple(optima))


def _event_names(step: Document) -> list[Any]:
    told = step["event"]
    if isinstance(told, list):
        return told or [None]
    return [told]


# --- the episode ----------------------------------------------------------------------------------


def _time(raw: Any) -> Fraction:
    return Fraction(str(raw))


def _many(times: Sequence[Fraction]) -> str:
    return ", ".join(map(str, times))


def _initial(task: Document) -> _Known:
    known = _Known(
        {name: _time(value) for name, value in task["action_durations"].items()},
        task["stations"],
        task.get("robots", ()),
        task.get("inventory_limits", {}),
    )
    _reveal(
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


def _moments(events: Sequence[Document]) -> list[tuple[Fraction, list[Document]]]:
    """The events by their times; those of one instant in the order in which they stand."""
    found: dict[Fraction, list[Document]] = defaultdict(list)
    for event in events:
        found[_time(event["trigger_time"])].append(event)
    return sorted(found.items())


def _reveal(known: _Known, delta: Document) -> None:
    unknown = delta.keys() - _DELTAS
    if unknown:
        raise ValueError(f"this judge does not know {sorted(unknown)}")
    known.items.update(delta.get("add_items", {}))
    if delta.get("set_deadline") is not None:
        known.deadline = _time(delta["set_deadline"])
    for delivery in delta.get("add_deliveries", ()):
        _add_delivery(known, delivery)
    for goal in delta.get("add_candidate_goals", ()):
        known.goals[goal["id"]] = goal
        _add_work(known, goal["item"], goal["state"], None, goal["id"])
    for lag in delta.get("add_temporal_constraints", ()):
        ends = [f"{lag[side]['action']}_{lag[side]['item']}" for side in ("before", "after")]
        if not known.jobs.keys() >= set(ends):
            raise ValueError(f"no goal needs one of {ends}")
        most = None if lag.get("max_lag") is None else _time(lag["max_lag"])
        known.lags.append((ends[0], ends[1], _time(lag.get("min_lag", 0)), most))


def _add_delivery(known: _Known, delivery: Document) -> None:
    if delivery.get("reward") is not None:
        raise ValueError(f"this judge does not know rewards of deliveries ({delivery['id']})")
    deadline = None if delivery.get("deadline") is None else _time(delivery["deadline"])
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
    known: _Known, item: str, wanted: str, deadline: Fraction | None, candidate: str | None
) -> None:
    if known.states.setdefault(item, wanted) != wanted:
        raise ValueError(f"{item!r} is wanted in two states")
    chain = _chain(item, known.items[item], wanted)
    for action in chain:
        _add_job(known, action, item, deadline, candidate)
    for first, second in pairwise(chain):
        known.lags.append((f"{first}_{item}", f"{second}_{item}", Fraction(0), None))


def _add_job(
    known: _Known, action: str, item: str, deadline: Fraction | None, candidate: str | None
) -> None:
    name = f"{action}_{item}"
    if name in known.jobs:
        raise ValueError(f"two orders want {name!r}")
    station = _STATION.get(action)
    if station is not None and station not in known.stations:
        raise ValueError(f"there is no {station!r}")
    known.jobs[name] = _Job(known.durations[action], station, deadline, candidate)


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


# --- one step -------------------------------------------------------------------------------------


def _plan(schedule: Document) -> tuple[_Plan, list[str]]:
    """The entries by action, and the actions that are there more than once."""
    plan: _Plan = {}
    repeated = []
    for entry in schedule["actions"]:
        if entry["id"] in plan or entry.get("occurrence", 1) != 1:
            repeated.append(entry["id"])
        plan[entry["id"]] = _Run(
            _time(entry["start"]),
            _time(entry["end"]),
            entry.get("resources", {}),
            entry.get("status"),
        )
    return plan, repeated


@dataclass(frozen=True)
class _Best:
    """An exact continuation: how many half-done goals it finishes, and what it is worth."""

    finished: int
    worth: _Value


def _step_faults(
    known: _Known, step: Document, before: _Plan, at: Fraction, best: _Best | None
) -> Iterator[str]:
    schedule = step["schedule"]
    if schedule["status"] == "infeasible":
        if best is not None:
            yield f"called infeasible, and there is a continuation ({best.worth})"
        return
    if schedule["status"] not in ("optimal", "feasible"):
        yield f"there is no answer ({schedule['status']})"
        return
    plan, _ = _plan(schedule)
    frozen = {name: run for name, run in before.items() if run.start < at}
    yield from _snapshot(step, before, plan, at)
    yield from _history(frozen, plan, at)
    yield from _presence(known, plan)
    yield from _own_times(known, frozen, plan)
    yield from _orders(known, plan)
    yield from _capacities(known, plan)
    yield from _stock(known, plan)
    yield from _value(known, step, frozen, plan, best)


def _snapshot(step: Document, before: _Plan, plan: _Plan, at: Fraction) -> Iterator[str]:
    """What the step says of the old schedule: what had ended, what ran, and what has moved."""
    parts = {
        "completed": {n for n, r in before.items() if r.start < at and r.end <= at},
        "running": {n for n, r in before.items() if r.start < at < r.end},
    }
    for key, names in parts.items():
        if sorted(step[key]) != sorted(names):
            yield f"{key} are {sorted(names)}, and it says {sorted(step[key])}"
    moved = sum(
        name not in plan or (plan[name].start, plan[name].resources) != (run.start, run.resources)
        for name, run in before.items()
        if run.start >= at
    )
    if step["moved"] != moved:
        yield f"{moved} moved, and it says {step['moved']}"


def _history(frozen: _Plan, plan: _Plan, at: Fraction) -> Iterator[str]:
    for name, run in frozen.items():
        now = plan.get(name)
        if now is None:
            yield f"{name}, which had started, is gone"
        elif (now.start, now.end, now.resources) != (run.start, run.end, run.resources):
            yield f"{name} had started, and is not as it was"
        elif run.status == "abandoned" and now.status is None:
            yield f"{name} is no longer abandoned"
    for name, run in plan.items():
        if name not in frozen and run.start < at:
            yield f"{name} is planned for {run.start}, before the event at {at}"
        if name not in frozen and run.status is not None:
            yield f"{name} is {run.status}, and has not started"


def _presence(known: _Known, plan: _Plan) -> Iterator[str]:
    for name in plan.keys() - known.jobs.keys():
        yield f"nobody knows of {name}"
    for name, job in known.jobs.items():
        if job.candidate is None and name not in plan:
            yield f"{name} is missing"
    for goal in known.goals:
        members = known.candidate_jobs(goal)
        present = [name for name in members if name in plan]
        given_up = [name for name in present if plan[name].status == "abandoned"]
        if given_up and given_up != present:
            yield f"of candidate goal {goal} only {given_up} are abandoned"
        if not given_up and present and present != members:
            yield f"of candidate goal {goal} only {present} are there"
    for name, run in plan.items():
        job = known.jobs.get(name)
        if run.status is not None and (run.status != "abandoned" or not (job and job.candidate)):
            yield f"{name} is {run.status!r}"


def _own_times(known: _Known, frozen: _Plan, plan: _Plan) -> Iterator[str]:
    for name, run in plan.items():
        job = known.jobs.get(name)
        if job is None:
            continue
        if run.end - run.start != job.length:
            yield f"{name} takes {run.end - run.start}, not {job.length}"
        limit = known.limit(job)
        if run.start < 0 or (limit is not None and run.end > limit and name not in frozen):
            yield f"{name} is at {run.start}–{run.end}, too early or too late"
        robots = [r for r in run.resources if r in known.robots]
        wanted = {job.station} - {None} | set(robots)
        if len(robots) != bool(known.robots) or dict(run.resources) != dict.fromkeys(wanted, 1):
            yield f"{name} holds {dict(run.resources)}"


def _orders(known: _Known, plan: _Plan) -> Iterator[str]:
    for before, after, least, most in known.lags:
        if before in plan and after in plan:
            gap = plan[after].start - plan[before].end
            if gap < least or (most is not None and gap > most):
                yield f"{gap} lie between {before} and {after}; allowed are {least} to {most}"


def _capacities(known: _Known, plan: _Plan) -> Iterator[str]:
    capacities = {**known.stations, **dict.fromkeys(known.robots, 1)}
    for resource, capacity in capacities.items():
        users = [run for run in plan.values() if run.resources.get(resource)]
        for instant in sorted({run.start for run in users}):
            used = sum(r.resources[resource] for r in users if r.start <= instant < r.end)
            if used > capacity:
                yield f"{used} of {resource} are used at {instant}; it has {capacity}"


def _stock(known: _Known, plan: _Plan) -> Iterator[str]:
    """A goal's cost is taken when its first action starts, and is not given back."""
    taken: dict[str, int] = defaultdict(int)
    for goal, said in known.goals.items():
        if any(name in plan for name in known.candidate_jobs(goal)):
            for name, amount in said.get("cost", {}).items():
                taken[name] += amount
    for name, amount in taken.items():
        if amount > known.stock.get(name, 0):
            yield f"{amount} of {name} are taken; there are {known.stock.get(name, 0)}"


def _value(
    known: _Known, step: Document, frozen: _Plan, plan: _Plan, best: _Best | None
) -> Iterator[str]:
    if best is None:
        yield "there is no continuation, and here is one"
        return
    finished, half_done = _finished(known, plan), _half_done(known, frozen)
    if sum(goal in finished for goal in half_done) != best.finished:
        yield f"of the goals begun, {half_done}, it should finish {best.finished}"
    reward, makespan = worth = _reached(known, plan)
    if _order(worth) < _order(best.worth):
        yield f"is worth {_worth(worth)}, which is better than possible: {_worth(best.worth)}"
    told = {o["name"]: _time(o["value"]) for o in step["schedule"]["objective"]}
    for name, value in (("reward", reward), ("makespan", makespan)):
        if value is not None and told.get(name) != value:
            yield f"says that its {name} is {told.get(name)}, not {value}"
    if step["schedule"]["status"] == "optimal" and worth != best.worth:
        yield "is called optimal, and is not"


def _less(known: _Known, step: Document, best: _Best) -> str | None:
    """What is possible, where the step has less."""
    if step["schedule"]["status"] not in ("optimal", "feasible"):
        return f"nothing, and {_worth(best.worth)} is possible"
    worth = _reached(known, _plan(step["schedule"])[0])
    if _order(worth) <= _order(best.worth):
        return None
    return f"{_worth(worth)}, and {_worth(best.worth)} is possible"


def _finished(known: _Known, plan: _Plan) -> list[str]:
    """The candidate goals that are reached."""
    return [
        goal
        for goal in known.goals
        if (members := known.candidate_jobs(goal))
        and all(name in plan and plan[name].status is None for name in members)
    ]


def _reached(known: _Known, plan: _Plan) -> _Value:
    rewards = [known.goals[goal]["reward"] for goal in _finished(known, plan)]
    last = max((run.end for run in plan.values()), default=Fraction(0))
    return (sum(rewards) if known.goals else None, last)


def _order(worth: _Value) -> tuple[int, Fraction]:
    """Less is better."""
    return -(worth[0] or 0), worth[1]


def _worth(worth: _Value) -> str:
    return str(worth[1]) if worth[0] is None else f"reward {worth[0]}, makespan {worth[1]}"


def _half_done(known: _Known, frozen: _Plan) -> list[str]:
    """The goals of which something has started, and that nobody has given up."""
    return [
        goal
        for goal in known.goals
        if (begun := [n for n in known.candidate_jobs(goal) if n in frozen])
        and all(frozen[name].status is None for name in begun)
    ]


# --- the exact continuation -----------------------------------------------------------------------


def _continuation(known: _Known, frozen: _Plan, at: Fraction, seconds: float) -> _Best | None:
    """The best that can follow from what started before `at`; None where nothing can."""
    model = _Model(known, frozen, at)
    return model.best(seconds)


class _Grid:
    """The times that need be looked at, numbered in order.

    With all choices made, the earliest starts are sums of durations and lags from the event or from
    what is frozen. All lengths are multiples of one unit, so the remainders that those have are the
    only ones; a length moves a time by the same number of places whatever its remainder.
    """

    def __init__(self, lengths: Sequence[Fraction], bases: Sequence[Fraction]) -> None:
        common = lcm(*(length.denominator for length in lengths))
        self.unit = Fraction(gcd(*(int(length * common) for length in lengths)) or 1, common)
        self.remainders = sorted({base % self.unit for base in bases})

    def length(self, length: Fraction) -> int:
        return int(length / self.unit) * len(self.remainders)

    def point(self, time: Fraction) -> int:
        """The last place that is not later than `time`."""
        within = bisect_right(self.remainders, time % self.unit) - 1
        return int(time // self.unit) * len(self.remainders) + within

    def time(self, point: int) -> Fraction:
        whole, within = divmod(point, len(self.remainders))
        return whole * self.unit + self.remainders[within]


class _Model:
    def __init__(self, known: _Known, frozen: _Plan, at: Fraction) -> None:
        self.known, self.frozen = known, frozen
        lengths = [job.length for job in known.jobs.values()]
        lengths += [lag for _, _, least, most in known.lags for lag in (least, most) if lag]
        self.grid = _Grid(lengths, [at, *(run.start for run in frozen.values())])
        longest = sum(max(job.length, Fraction(0)) for job in known.jobs.values())
        lags = sum(max(least, Fraction(0)) for _, _, least, _ in known.lags)
        latest = max([at, *(run.end for run in frozen.values())])
        self.horizon = self.grid.point(latest + longest + lags)
        self.at = self.grid.point(at)
        self.model = cp_model.CpModel()
        self.present = {goal: self.model.new_bool_var(goal) for goal in known.goals}
        self.starts = {name: self._start(name, job) for name, job in known.jobs.items()}
        self.makespan = self.model.new_int_var(0, self.horizon, "makespan")
        self._orders()
        self._capacities()
        self._stock()
        for name in known.jobs:
            self._if_here(self.model.add(self.makespan >= self._end(name)), name)

    def _start(self, name: str, job: _Job) -> Any:
        if name in self.frozen:
            return self.grid.point(self.frozen[name].start)
        start = self.model.new_int_var(self.at, self.horizon, name)
        limit = self.known.limit(job)
        if limit is not None:
            ends = start + self.grid.length(job.length)
            self._if_here(self.model.add(ends <= self.grid.point(limit)), name)
        return start

    def _end(self, name: str) -> Any:
        return self.starts[name] + self.grid.length(self.known.jobs[name].length)

    def _here(self, name: str) -> list[Any]:
        """What decides whether an action happens: nothing where it must, or has started."""
        candidate = self.known.jobs[name].candidate
        return [] if candidate is None or name in self.frozen else [self.present[candidate]]

    def _if_here(self, constraint: Any, *names: str) -> None:
        constraint.only_enforce_if([literal for name in names for literal in self._here(name)])

    def _orders(self) -> None:
        for before, after, least, most in self.known.lags:
            if before in self.frozen and after in self.frozen:
                continue
            gap = self.starts[after] - self._end(before)
            self._if_here(self.model.add(gap >= self.grid.length(least)), before, after)
            if most is not None:
                self._if_here(self.model.add(gap <= self.grid.length(most)), before, after)

    def _capacities(self) -> None:
        working = [name for name, job in self.known.jobs.items() if job.length]
        for station, capacity in self.known.stations.items():
            self._at_most([n for n in working if self.known.jobs[n].station == station], capacity)
        if self.known.robots:
            self._at_most(working, len(self.known.robots))

    def _interval(self, name: str, job: _Job) -> Any:
        start, size, here = self.starts[name], self.grid.length(job.length), self._here(name)
        if here:
            return self.model.new_optional_fixed_size_interval_var(start, size, here[0], name)
        return self.model.new_fixed_size_interval_var(start, size, name)

    def _at_most(self, names: list[str], capacity: int) -> None:
        intervals = [self._interval(name, self.known.jobs[name]) for name in names]
        self.model.add_cumulative(intervals, [1] * len(intervals), capacity)
        self._room(names, capacity)

    def _room(self, names: list[str], capacity: int) -> None:
        """What is still to be done fits between when each unit is free and the makespan.

        This follows from all else, and without it proofs take too long: on a unit there is room
        for whole units of time only, whatever the remainder of the time at which it is free.
        """
        free = [self.grid.point(r.end) for n, r in self.frozen.items() if n in names]
        free = sorted(point for point in free if point > self.at)
        free += [self.at] * (capacity - len(free))
        step = self.grid.length(self.grid.unit)
        rooms = []
        for k, point in enumerate(free):
            room = self.model.new_int_var(0, self.horizon, f"room {k}")
            used = self.model.new_bool_var(f"uses room {k}")
            self.model.add(room == 0).only_enforce_if(~used)
            self.model.add(point + step * room <= self.makespan).only_enforce_if(used)
            rooms.append(room)
        work = []
        for name in names:
            if name not in self.frozen:
                here = self._here(name)
                length = self.grid.length(self.known.jobs[name].length) // step
                work.append(length * here[0] if here else length)
        if work:
            self.model.add(sum(rooms) >= sum(work))

    def _stock(self) -> None:
        taken: dict[str, list[Any]] = defaultdict(list)
        for goal, said in self.known.goals.items():
            begun = any(name in self.frozen for name in self.known.candidate_jobs(goal))
            for stock, amount in said.get("cost", {}).items():
                taken[stock].append(amount if begun else amount * self.present[goal])
        for stock, amounts in taken.items():
            self.model.add(sum(amounts) <= self.known.stock.get(stock, 0))

    def best(self, seconds: float) -> _Best | None:
        given_up = {
            self.known.jobs[name].candidate
            for name, run in self.frozen.items()
            if run.status == "abandoned" and name in self.known.jobs
        }
        for goal in given_up - {None}:
            self.model.add(self.present[goal] == 0)
        half_done = _half_done(self.known, self.frozen)
        finished = self._optimise(sum(self.present[g] for g in half_done), True, seconds)
        if finished is None:
            return None
        reward = sum(said["reward"] * self.present[g] for g, said in self.known.goals.items())
        earned = self._optimise(reward, True, seconds)
        shortest = self._optimise(self.makespan, False, seconds)
        if earned is None or shortest is None:
            raise AssertionError("a continuation was there and is gone")
        return _Best(finished, (earned if self.known.goals else None, self.grid.time(shortest)))

    def _optimise(self, value: Any, greatest: bool, seconds: float) -> int | None:
        """The best of one value, which is kept from then on; None where nothing is possible."""
        self.model.clear_objective()
        if isinstance(value, int):  # There is nothing to choose.
            value = self.model.new_constant(value)
        (self.model.maximize if greatest else self.model.minimize)(value)
        solver = cp_model.CpSolver()
        solver.parameters.max_time_in_seconds = seconds
        solver.parameters.num_workers = 8  # Fewer would leave out the strategies that prove.
        status = solver.solve(self.model)
        if status == cp_model.INFEASIBLE:
            return None
        if status != cp_model.OPTIMAL:
            raise UndecidedError(f"{solver.status_name(status)} after {seconds} s")
        best = round(solver.objective_value)
        self.model.add(value == best)
        return best
