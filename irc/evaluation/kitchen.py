"""A Robo kitchen at work: a plan simulated happening by happening, with the first fault in it.

It knows nothing of irc's tasks and schedules, so that it can check those.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from irc.errors import IrcError
from irc.frontends.importers.plan_lines import KITCHEN_ACTIONS, STATION_OF
from irc.methods import PlanLine

Item = Mapping[str, Any]

RESULT_OF = {
    "grill": "grilled",
    "cut": "cut",
    "fry": "fried",
    "boil": "boiled",
    "toast": "toasted",
    "marinate": "marinated",
    "mash": "mashed",
}
_BEFORE = {"cut": "raw", "marinate": "cut", "boil": "raw", "toast": "raw", "mash": "boiled"}
_IN_WORK = {action: f"being {result}" for action, result in RESULT_OF.items()}
_DURATION_TOLERANCE = Fraction(1, 100)


def exact(value: float | int | str) -> Fraction:
    """A number of the data as a fraction: 0.1 is a tenth."""
    return Fraction(str(value))


@dataclass(frozen=True)
class Rules:
    """The rules that bind a plan besides stations, robots and the states of items."""

    lags: bool = True
    durations: bool = True


ALL_RULES = Rules()


@dataclass
class Run:
    """The course of a plan, up to its end or its first fault."""

    fault: str | None = None
    states: dict[str, str] = field(default_factory=dict)
    stacked: list[str] = field(default_factory=list)
    starts: dict[tuple[str, str], Fraction] = field(default_factory=dict)
    ends: dict[tuple[str, str], Fraction] = field(default_factory=dict)

    @property
    def makespan(self) -> Fraction:
        """When the last activity ended."""
        return max(self.ends.values(), default=Fraction(0))

    def done_with(self, item: str) -> Fraction:
        """When the last activity with an item ended; 0 without any."""
        times = (end for (_, name), end in self.ends.items() if name == item)
        return max(times, default=Fraction(0))


class _Fault(IrcError):
    """The plan cannot go on; the text says why."""


def start_state(action: str, item: Item) -> str | None:
    """The state in which an action may start on an item; None where it never may."""
    has = item.get("predicates", ())
    if action == "grill":
        if item.get("grill_requires_marinated"):
            return "marinated"
        return "raw" if "iscookable" in has else _if("iscookableifmarinated" in has, "marinated")
    if action == "fry":
        if item.get("fry_requires_cut"):
            return "cut"
        return "raw" if "isfryable" in has else _if("isfryableifcut" in has, "cut")
    return _BEFORE[action]


def _if(holds: bool, state: str) -> str | None:
    return state if holds else None


def simulate(kitchen: Mapping[str, Any], plan: Sequence[PlanLine], rules: Rules = ALL_RULES) -> Run:
    """The run of a plan in a kitchen with `items`, `stations`, `robots` and `action_durations`.

    What ends at an instant ends before anything starts at it.
    """
    run = _Simulation(kitchen, rules)
    happenings = sorted(
        happening
        for k, line in enumerate(plan)
        for happening in ((line.start, 1, k), (line.end, 0, k))
    )
    try:
        for time, is_start, k in happenings:
            (run.begin if is_start else run.finish)(plan[k], time)
        if rules.lags:
            run.check_lags()
    except _Fault as fault:
        run.state.fault = str(fault)
    return run.state


class _Simulation:
    def __init__(self, kitchen: Mapping[str, Any], rules: Rules) -> None:
        self.kitchen = kitchen
        self.rules = rules
        self.items: Mapping[str, Item] = kitchen["items"]
        self.robots = frozenset(kitchen.get("robots") or ())
        self.state = Run(states={name: item["state"] for name, item in self.items.items()})
        self.used: Counter[str] = Counter()
        self.busy: set[str] = set()

    def begin(self, line: PlanLine, time: Fraction) -> None:
        """Starts an activity. Raises `_Fault` where it cannot start."""
        robot, item = self._who_and_what(line)
        if robot is not None and robot in self.busy:
            raise _Fault(f"at {float(time):g}: robot {robot!r} is busy")
        if self.rules.durations:
            self._check_duration(line)
        if line.action == "stack":
            if self.state.states[item] in _IN_WORK.values():
                raise _Fault(f"at {float(time):g}: {item!r} is {self.state.states[item]}")
        else:
            self._process(line, item, time)
        if robot is not None:
            self.busy.add(robot)
        self.state.starts[line.action, item] = time

    def finish(self, line: PlanLine, time: Fraction) -> None:
        """Ends an activity that has started."""
        robot, item = self._who_and_what(line)
        if robot is not None:
            self.busy.discard(robot)
        if line.action == "stack":
            self.state.stacked.append(item)
        else:
            self.used[STATION_OF[line.action]] -= 1
            self.state.states[item] = RESULT_OF[line.action]
        self.state.ends[line.action, item] = time

    def check_lags(self) -> None:
        """Raises `_Fault` at the first lag that the plan does not keep."""
        for lag in self.kitchen.get("temporal_constraints") or ():
            before, after = ((lag[end]["action"], lag[end]["item"]) for end in ("before", "after"))
            if before not in self.state.ends or after not in self.state.starts:
                raise _Fault(f"the lag from {before} to {after} has no activities")
            if self.state.starts[after] < self.state.ends[before] + exact(lag["min_lag"]):
                raise _Fault(f"{after} starts less than {lag['min_lag']} after {before} ends")

    def _who_and_what(self, line: PlanLine) -> tuple[str | None, str]:
        if line.action not in KITCHEN_ACTIONS:
            raise _Fault(f"there is no action {line.action!r}")
        expected = 2 if self.robots else 1
        if len(line.arguments) != expected:
            raise _Fault(f"{line.action} takes {expected} arguments, not {len(line.arguments)}")
        robot = line.arguments[0] if self.robots else None
        if robot is not None and robot not in self.robots:
            raise _Fault(f"there is no robot {robot!r}")
        if line.item not in self.items:
            raise _Fault(f"there is no item {line.item!r}")
        return robot, line.item

    def _check_duration(self, line: PlanLine) -> None:
        right = exact(self.kitchen["action_durations"][line.action])
        if abs(line.duration - right) > _DURATION_TOLERANCE:
            raise _Fault(f"{line.action} lasts {float(right):g}, not {float(line.duration):g}")

    def _process(self, line: PlanLine, item: str, time: Fraction) -> None:
        expected, found = start_state(line.action, self.items[item]), self.state.states[item]
        if found != expected:
            raise _Fault(f"at {float(time):g}: {item!r} is {found}, expected {expected}")
        station = STATION_OF[line.action]
        capacity = self.kitchen["stations"].get(station, 0)
        if self.used[station] >= capacity:
            raise _Fault(f"at {float(time):g}: station {station!r} is full ({capacity})")
        self.used[station] += 1
        self.state.states[item] = _IN_WORK[line.action]
