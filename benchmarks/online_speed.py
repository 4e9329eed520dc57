"""Measures one repair of a large running task after a station fails.

    python benchmarks/online_speed.py [--actions 1000 5000] [--resources 20] [--seeds 5]

Tasks of `--actions` actions on `--resources` stations and a crew, with random precedence, are
planned (every other one with all stations equally busy), carried out for a third of the plan, and
then a station is down for a tenth of it. Three repairs of the same moment are measured, from the
event to the judged schedule, with all of lowering and judging, in a process that has repaired a
small task before: one without time for a search, for the first valid schedule and what moves in it;
one that may take a second, and one that may take eight for each 1,000 actions, for the gap to the
proven bound and what still moves. Seconds are wall-clock and, in brackets, processor time. Also a
task of 100 actions whose old order survives.

Ends with status 1 where a row of its own is missed, by processor time: a first schedule within half
a second for 1,000 actions (and 2 s for 5,000), 10 s and 5 % for 1,000 actions, 1 s for 100.
"""

from __future__ import annotations

import argparse
import math
import random
import sys
import time
from dataclasses import dataclass
from fractions import Fraction

import irc
from irc.execution import Execution
from irc.execution.step import Step
from irc.model import Event, Task
from irc.schedule import Schedule


def task_of(rng: random.Random, actions: int, resources: int, even: bool) -> Task:
    """A shop: each action on one of the stations, some with one of several workers.

    `even`: all stations have the same amount of work, so that none alone bounds the makespan.
    """
    stations = [f"station{k}" for k in range(resources - 4)]
    crew = [f"worker{k}" for k in range(4)]
    made, edges = [], []
    for i in range(actions):
        uses: list[dict[str, object]] = [
            {"resource": stations[i % len(stations)] if even else rng.choice(stations)}
        ]
        if rng.random() < 0.2:
            uses.append({"one_of": crew})
        made.append(
            {
                "id": f"a{i}",
                "duration": rng.randint(9, 11) if even else rng.randint(1, 20),
                "uses": uses,
            }
        )
        for _ in range(rng.choice((0, 1, 1, 2))):
            if i:
                before = rng.randrange(max(0, i - 60), i)
                edges.append({"before": f"a{before}", "after": f"a{i}"})
    return Task.model_validate(
        {
            "resources": [
                *({"id": s, "capacity": 1 if even else rng.choice((1, 1, 2))} for s in stations),
                *({"id": w} for w in crew),
            ],
            "actions": made,
            "precedence": edges,
        }
    )


def failure(rng: random.Random, task: Task, makespan: Fraction | int) -> Event:
    """A station is down from a third of the plan on, for a tenth of it."""
    at = round(float(makespan) / 3 * 100) / 100
    station = f"station{rng.randrange(len(task.resources) - 4)}"
    until = int(makespan / 3 + makespan / 10)
    change = {"op": "set_capacity", "resource": station, "capacity": 0, "to": until}
    return Event.model_validate({"at": str(at), "changes": [change]})


@dataclass(frozen=True)
class Repair:
    """A step, and the seconds from the event to its judged schedule: wall-clock and processor."""

    step: Step
    wall: float
    processor: float

    @property
    def gap(self) -> float:
        """The gap between the makespan and the proven bound, as a fraction."""
        first = self.step.schedule.objective[0]
        return float("inf") if not first.bound else float(first.value / first.bound) - 1

    def __str__(self) -> str:
        return f"{self.wall:6.2f} ({self.processor:5.2f}) {self.gap:6.1%} {self.step.moved:5}"


def repaired(task: Task, plan: Schedule, event: Event, seconds: float) -> Repair:
    """A repair with a time limit."""
    execution = Execution(task, plan, time_limit=seconds, workers=2)
    wall, processor = time.perf_counter(), time.process_time()
    execution.apply(event)
    step = execution.replan()
    return Repair(step, time.perf_counter() - wall, time.process_time() - processor)


NO_TIME = 0.01
"""A limit that is over before an engine could begin."""

PLANNING_SECONDS = 10
LONG_SECONDS = 8.0


def first_seconds(actions: int) -> float:
    """The time for a first valid schedule: half a second for 1,000 actions, 2 s for 5,000."""
    return 0.5 * (actions / 1000) ** (math.log(4) / math.log(5))


def large(actions: int, resources: int, seeds: int) -> int:
    """Prints a row for each task of a size; returns the number of rows that are missed."""
    missed = 0
    print(f"{actions} actions: seconds (processor), gap, moved")
    print("seed   plan |  first valid                |  with 1 s                   |  with more")
    for seed in range(seeds):
        rng = random.Random(seed)
        task = task_of(rng, actions, resources, bool(seed % 2))
        plan = irc.solve(task, time_limit=PLANNING_SECONDS * max(1, actions // 2500), workers=2)
        event = failure(rng, task, plan.makespan)
        limits = (NO_TIME, 1.0, LONG_SECONDS * max(1, actions / 1000))
        first, quick, best = (repaired(task, plan, event, limit) for limit in limits)
        missed += first.processor > first_seconds(actions)
        missed += actions <= 1000 and (best.processor > 20 or best.wall > 10 or best.gap > 0.05)
        shown = f"{seed:4} {plan.makespan!s:>6} | {first} | {quick} | {best}"
        print(f"{shown}  {best.step.schedule.status}", flush=True)
    return missed


def small(resources: int, seeds: int) -> int:
    """Prints a row for each task of 100 actions of which one takes longer."""
    missed = 0
    print("100 actions, one takes longer: seconds (processor), gap, moved, status")
    for seed in range(seeds):
        rng = random.Random(1000 + seed)
        task = task_of(rng, 100, resources, bool(seed % 2))
        plan = irc.solve(task, time_limit=10, workers=2)
        at = Fraction(round(plan.makespan / 3 * 100), 100)
        name = next(e.id for e in plan.entries if e.start < at < e.end)
        old = next(a.duration for a in task.actions if a.id == name)
        change = {"op": "set_duration", "action": name, "duration": int(str(old)) + 3}
        event = Event.model_validate({"at": str(float(at)), "changes": [change]})
        repair = repaired(task, plan, event, 10.0)
        missed += repair.processor > 2 or repair.wall > 1
        print(f"{seed:4}  {repair}  {repair.step.schedule.status}", flush=True)
    return missed


def loaded(resources: int) -> None:
    """Repairs a small shop, so that all is loaded: a live executive has repaired before."""
    rng = random.Random(0)
    task = task_of(rng, 100, resources, even=True)
    plan = irc.solve(task, workers=2)
    event = failure(rng, task, plan.makespan)
    for limit in (NO_TIME, 1.0):
        repaired(task, plan, event, limit)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0] if __doc__ else "")
    parser.add_argument("--actions", type=int, nargs="+", default=[1000, 5000])
    parser.add_argument("--resources", type=int, default=20)
    parser.add_argument("--seeds", type=int, default=5)
    options = parser.parse_args()
    loaded(options.resources)
    missed = small(options.resources, options.seeds)
    missed += sum(large(n, options.resources, options.seeds) for n in options.actions)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
