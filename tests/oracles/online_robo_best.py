"""The exact best continuation of an online kitchen episode: a model of its own, in CP-SAT.

Robots are alike, so the model counts them. What is frozen started before the event and has its
robot; whatever starts later takes, in the order of starts, one of the robots that are free then.
"""

from __future__ import annotations

from bisect import bisect_right
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import gcd, lcm
from typing import Any

from ortools.sat.python import cp_model

from oracles.online_robo_kitchen import Job, Known, Plan, Worth, half_done_goals


class UndecidedError(Exception):
    """The exact continuation was not found within the time that was allowed."""


@dataclass(frozen=True)
class Best:
    """An exact continuation: how many half-done goals it finishes, and what it is worth."""

    finished: int
    worth: Worth


def continuation(known: Known, frozen: Plan, at: Fraction, seconds: float) -> Best | None:
    """The best that can follow from what started before `at`; None where nothing can."""
    model = Model(known, frozen, at)
    return model.best(seconds)


class Grid:
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


class Model:
    def __init__(self, known: Known, frozen: Plan, at: Fraction) -> None:
        self.known, self.frozen = known, frozen
        lengths = [job.length for job in known.jobs.values()]
        lengths += [lag for _, _, least, most in known.lags for lag in (least, most) if lag]
        self.grid = Grid(lengths, [at, *(run.start for run in frozen.values())])
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

    def _start(self, name: str, job: Job) -> Any:
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

    def _interval(self, name: str, job: Job) -> Any:
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

    def best(self, seconds: float) -> Best | None:
        given_up = {
            self.known.jobs[name].candidate
            for name, run in self.frozen.items()
            if run.status == "abandoned" and name in self.known.jobs
        }
        for goal in given_up - {None}:
            self.model.add(self.present[goal] == 0)
        half_done = half_done_goals(self.known, self.frozen)
        finished = self._optimise(sum(self.present[g] for g in half_done), True, seconds)
        if finished is None:
            return None
        reward = sum(said["reward"] * self.present[g] for g, said in self.known.goals.items())
        earned = self._optimise(reward, True, seconds)
        shortest = self._optimise(self.makespan, False, seconds)
        if earned is None or shortest is None:
            raise AssertionError("a continuation was there and is gone")
        return Best(finished, (earned if self.known.goals else None, self.grid.time(shortest)))

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
