"""The exact best continuation of an execution about orders: a model of its own, in CP-SAT.

Robots are alike and do not fail, so the model counts those that are free: what has begun holds one
until its end, and whatever starts later takes one of the others in the order of starts.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import lcm
from typing import Any

from ortools.sat.python import cp_model

from oracles.online_orders_kitchen import Kitchen, Plan


class UndecidedError(Exception):
    """The exact continuation was not found within the time that was allowed."""


class NotCompared(Exception):
    """What keeps an execution from being compared."""


@dataclass(frozen=True)
class Best:
    """How many half-done orders can be finished together, and what is possible then.

    `makespan` is None where nobody asks for it.
    """

    finished: int
    reward: int
    makespan: Fraction | None


class Continuation:
    """What can follow after what has begun by `at`."""

    def __init__(self, kitchen: Kitchen, begun: Plan, at: Fraction, seconds: float = 60) -> None:
        self.kitchen, self.begun, self.seconds = kitchen, begun, seconds
        self.scale = lcm(*(time.denominator for time in self._times(at)))
        self.at = self._ticks(at)
        self.model = cp_model.CpModel()
        self.present: dict[str, Any] = {
            g: self.model.new_constant(1)
            if all(n in begun for n in said["actions"])
            else self.model.new_bool_var(g)
            for g, said in kitchen.groups.items()
        }
        self.open = [n for n in kitchen.actions if n not in begun and n not in kitchen.over]
        self.horizon = self._horizon()
        self.starts = {name: self._start(name) for name in self.open}
        self._lags()
        for resource, said in kitchen.resources.items():
            if said.get("kind") == "reservoir":
                self._stock(resource, said["initial"])
            elif not resource.startswith("robot"):
                self._capacity([resource], [n for n in self.open if self._needs(n, resource)])
        robots = [r for r in kitchen.resources if r.startswith("robot")]
        self._capacity(robots, [n for n in self.open if self._needs(n, None)])
        self.last = self.model.new_int_var(0, self.horizon, "makespan")
        for run in begun.values():
            self.model.add(self.last >= self._ticks(run.end))
        for name in self.open:
            self._if_here(self.model.add(self.last >= self._end(name)), name)

    # --- time ------------------------------------------------------------------------------------

    def _times(self, at: Fraction) -> Iterator[Fraction]:
        yield at
        yield from (time for run in self.begun.values() for time in (run.start, run.end))
        yield from (self.kitchen.duration(name) for name in self.kitchen.actions)
        yield from (lag for arc in self.kitchen.lags for lag in arc[2:] if lag is not None)
        yield from (t for ws in self.kitchen.windows.values() for w in ws for t in w[:2] if t)
        yield from (self.kitchen.limit(name) for name in self.kitchen.actions)

    def _ticks(self, time: Fraction) -> int:
        return int(time * self.scale)

    def _horizon(self) -> int:
        latest = [self.at, *(self._ticks(run.end) for run in self.begun.values())]
        latest += [
            self._ticks(t) for ws in self.kitchen.windows.values() for w in ws for t in w[:2] if t
        ]
        work = sum(self._length(name) for name in self.open)
        return max(latest) + work + sum(self._ticks(arc[2]) for arc in self.kitchen.lags)

    def _length(self, name: str) -> int:
        return self._ticks(self.kitchen.duration(name))

    def _start(self, name: str) -> Any:
        start = self.model.new_int_var(self.at, self.horizon, name)
        limit = self._ticks(self.kitchen.limit(name))
        self._if_here(self.model.add(start + self._length(name) <= limit), name)
        return start

    def _end(self, name: str) -> Any:
        return self.starts[name] + self._length(name)

    # --- what must hold --------------------------------------------------------------------------

    def _here(self, name: str) -> list[Any]:
        """What decides whether an action happens; nothing where it must, or has begun."""
        group = self.kitchen.group_of(name)
        return [] if group is None or name in self.begun else [self.present[group]]

    def _if_here(self, constraint: Any, *names: str) -> None:
        constraint.only_enforce_if([literal for name in names for literal in self._here(name)])

    def _lags(self) -> None:
        """What only concerns what has begun, or what was cancelled, binds nothing."""
        for before, after, least, most in self.kitchen.lags:
            if {before, after} & self.kitchen.over or {before, after} <= self.begun.keys():
                continue
            first = self.begun[before].end if before in self.begun else None
            start = self.begun[after].start if after in self.begun else None
            gap = (self._ticks(start) if start is not None else self.starts[after]) - (
                self._ticks(first) if first is not None else self._end(before)
            )
            self._if_here(self.model.add(gap >= self._ticks(least)), before, after)
            if most is not None:
                self._if_here(self.model.add(gap <= self._ticks(most)), before, after)

    def _needs(self, name: str, resource: str | None) -> bool:
        """Whether an action needs a station; or any one of the robots (None)."""
        uses = self.kitchen.actions[name]["uses"]
        return any(
            "one_of" in use if resource is None else use.get("resource") == resource for use in uses
        )

    def _capacity(self, resources: list[str], names: list[str]) -> None:
        """What is free of the resources together; what has begun holds what it holds."""
        if not names:
            return
        points = {self.at, self.horizon}
        points |= {self._ticks(run.end) for run in self.begun.values()}
        windows = [w for r in resources for w in self.kitchen.windows.get(r, ())]
        points |= {self._ticks(t) for w in windows for t in w[:2] if t is not None}
        ordered = sorted(point for point in points if self.at <= point <= self.horizon)
        free = [sum(self._free(r, begin) for r in resources) for begin in ordered]
        most = max(free)
        intervals, demands = [], []
        for name in names:
            intervals.append(self._interval(name))
            demands.append(1)
        for (begin, end), left in zip(pairwise(ordered), free, strict=False):
            if left < most:
                intervals.append(self.model.new_fixed_size_interval_var(begin, end - begin, ""))
                demands.append(most - left)
        self.model.add_cumulative(intervals, demands, most)

    def _free(self, resource: str, tick: int) -> int:
        time = Fraction(tick, self.scale)
        held = sum(
            run.resources.get(resource, 0)
            for run in self.begun.values()
            if run.start <= time < run.end
        )
        return max(0, self.kitchen.capacity(resource, time) - held)

    def _interval(self, name: str) -> Any:
        start, size, here = self.starts[name], self._length(name), self._here(name)
        if here:
            return self.model.new_optional_fixed_size_interval_var(start, size, here[0], name)
        return self.model.new_fixed_size_interval_var(start, size, name)

    def _stock(self, stock: str, initial: int) -> None:
        times: list[Any] = []
        amounts: list[int] = []
        here: list[Any] = []
        for name, run in self.begun.items():
            for time, amount in self.kitchen.changes(name, run, stock):
                times.append(self._ticks(time))
                amounts.append(amount)
                here.append(True)
        self._require_history(times, amounts, initial)
        for name in self.open:
            action = self.kitchen.actions[name]
            for key, sign, time in (
                ("consumes", -1, self.starts[name]),
                ("produces", 1, self._end(name)),
            ):
                for change in action.get(key, ()):
                    if change["resource"] == stock:
                        times.append(time)
                        amounts.append(sign * change["amount"])
                        here.append((self._here(name) or [True])[0])
        if times:
            self.model.add_reservoir_constraint_with_active(
                times, amounts, here, -initial, sum(map(abs, amounts))
            )

    @staticmethod
    def _require_history(times: list[Any], amounts: list[int], initial: int) -> None:
        for now in times:
            if sum(a for t, a in zip(times, amounts, strict=True) if t <= now) + initial < 0:
                raise NotCompared("a conflict about stock that is carried")

    # --- answers ---------------------------------------------------------------------------------

    def best(self) -> Best | None:
        """The best of all; None where nothing can follow."""
        half_done = self.kitchen.half_done(self.begun)
        finished = self._most(sum(self.present[g] for g in half_done))
        if finished is None:
            return None
        reward = self._most(
            sum(said["reward"] * self.present[g] for g, said in self.kitchen.groups.items())
        )
        assert reward is not None
        if "minimize_makespan" not in self.kitchen.objective:
            return Best(finished, reward, None)
        last = self._most(-self.last)
        assert last is not None
        return Best(finished, reward, Fraction(-last, self.scale))

    def can_have(self, order: str) -> bool:
        """Whether an order is possible beside what must be (ask before, or after, `best`).

        After `best` as many half-done orders are finished, and the reward is no less.
        """
        model = self.model.clone()
        model.clear_objective()
        model.add(self.present[order] == 1)
        return self._solved(model)[1] != cp_model.INFEASIBLE

    def _most(self, value: Any) -> int | None:
        """The greatest value, which is kept from then on; None where nothing is possible."""
        if isinstance(value, int):  # There is nothing to choose.
            value = self.model.new_constant(value)
        self.model.maximize(value)
        solver, status = self._solved(self.model)
        if status == cp_model.INFEASIBLE:
            return None
        best = round(solver.objective_value)
        self.model.clear_objective()
        self.model.add(value == best)
        return best

    def _solved(self, model: cp_model.CpModel) -> tuple[cp_model.CpSolver, Any]:
        solver = cp_model.CpSolver()
        solver.parameters.max_time_in_seconds = self.seconds
        solver.parameters.num_workers = 8  # Fewer would leave out the strategies that prove.
        status = solver.solve(model)
        if status not in (cp_model.INFEASIBLE, cp_model.OPTIMAL):
            raise UndecidedError(f"{solver.status_name(status)} after {self.seconds} s")
        return solver, status
