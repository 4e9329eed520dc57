"""Measures the time that irc adds to CP-SAT's own: `irc.solve` against a model written by hand.

    python benchmarks/overhead.py [--tasks 20] [--seeds 10]

Random job shops, half of them with robots to choose; those are kept that the model written by
hand proves within the time window with one worker. Each (task, seed) is timed in turn: by hand,
through irc with bounds and hints off, through irc as it is. Printed are geometric means, of the
process's own CPU time (one worker, in this process; other work on the machine does not count) and
of wall-clock time.
"""

from __future__ import annotations

import argparse
import math
import random
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from ortools.sat.python import cp_model

from irc.driver.solve import solve_by
from irc.model import Task
from irc.schedule import Status
from irc.targets import Budget, SolveOptions, get_backend
from irc_cpsat.engines import OrTools


def job_shop(seed: int) -> Task:
    """Jobs of consecutive operations on stations.

    Even seeds: one station each, nothing to choose. Odd seeds: fewer, but most operations also
    need one of a few robots.
    """
    rng = random.Random(seed)
    with_robots = seed % 2 == 1
    jobs, steps = (rng.randint(7, 9), rng.randint(5, 6)) if with_robots else (rng.randint(9, 11), 8)
    stations = [
        {"id": f"station{k}", "capacity": rng.choice((1, 1, 1, 2)) if with_robots else 1}
        for k in range(steps)
    ]
    robots = [f"robot{k}" for k in range(rng.randint(3, 5) if with_robots else 0)]
    actions, precedence = [], []
    for j in range(jobs):
        for k, station in enumerate(rng.sample(range(steps), steps)):
            uses: list[dict[str, object]] = [{"resource": f"station{station}"}]
            if with_robots and rng.random() < 0.6:
                uses.append({"one_of": robots})
            actions.append({"id": f"job{j}_{k}", "duration": rng.randint(2, 30), "uses": uses})
            if k:
                edge: dict[str, object] = {"before": f"job{j}_{k - 1}", "after": f"job{j}_{k}"}
                if rng.random() < 0.3:
                    edge["min_lag"] = rng.randint(1, 5)
                precedence.append(edge)
    resources = [*stations, *({"id": r} for r in robots)]
    return Task.model_validate(
        {"actions": actions, "precedence": precedence, "resources": resources}
    )


def whole(time: object) -> int:
    """These tasks have whole times only."""
    if not isinstance(time, int):
        raise TypeError(f"not a whole time: {time!r}")
    return time


def by_hand(task: Task, seed: int, limit: float) -> tuple[bool, int]:
    """(proven, makespan) of the model that a CP-SAT user would write for exactly this task."""
    model = cp_model.CpModel()
    horizon = sum(whole(a.duration) for a in task.actions)
    horizon += sum(whole(e.min_lag) for e in task.precedence)
    starts, ends = {}, {}
    users: dict[str, list[cp_model.IntervalVar]] = {r.id: [] for r in task.resources}
    for action in task.actions:
        size = whole(action.duration)
        start = model.new_int_var(0, horizon, f"start {action.id}")
        end = model.new_int_var(0, horizon, f"end {action.id}")
        interval = model.new_interval_var(start, size, end, action.id)
        starts[action.id], ends[action.id] = start, end
        for use in action.uses:
            if use.resource is not None:
                users[use.resource].append(interval)
                continue
            chosen = []
            for resource in use.alternatives:
                literal = model.new_bool_var("")
                chosen.append(literal)
                users[resource].append(
                    model.new_optional_interval_var(start, size, end, literal, "")
                )
            model.add_exactly_one(chosen)
    for edge in task.precedence:
        model.add(starts[edge.after] >= ends[edge.before] + whole(edge.min_lag))
    for resource in task.resources:
        if resource.capacity == 1:
            model.add_no_overlap(users[resource.id])
        else:
            model.add_cumulative(
                users[resource.id], [1] * len(users[resource.id]), resource.capacity
            )
    makespan = model.new_int_var(0, horizon, "makespan")
    model.add_max_equality(makespan, list(ends.values()))
    model.minimize(makespan)
    solver = cp_model.CpSolver()
    solver.parameters.num_workers = 1
    solver.parameters.random_seed = seed
    solver.parameters.max_time_in_seconds = limit
    return solver.solve(model) == cp_model.OPTIMAL, int(solver.objective_value)


def through_irc(task: Task, seed: int, limit: float, helped: bool) -> tuple[bool, int]:
    """(proven, makespan) through `irc`, with or without its own bounds and hints."""
    engine = OrTools(bounds=helped, hints=helped)
    options, budget = SolveOptions(workers=1, seed=seed), Budget(limit)
    schedule = solve_by(task, get_backend("cpsat"), engine, options, budget).schedule
    return schedule.status is Status.OPTIMAL, int(schedule.makespan)


@dataclass(frozen=True)
class Run:
    """The seconds of CPU and of wall-clock time of a call, and its answer."""

    cpu: float
    wall: float
    answer: tuple[bool, int]


def timed(call: Callable[[], tuple[bool, int]]) -> Run:
    """Runs and times a call."""
    cpu, wall = time.process_time(), time.perf_counter()
    answer = call()
    return Run(time.process_time() - cpu, time.perf_counter() - wall, answer)


def mean(ratios: list[float]) -> float:
    """The geometric mean."""
    return math.exp(sum(map(math.log, ratios)) / len(ratios))


def main() -> None:
    """Prints a line per task and the geometric means."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tasks", type=int, default=20)
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--least", type=float, default=1.0, help="seconds by hand, at least")
    parser.add_argument("--most", type=float, default=60.0, help="seconds by hand, at most")
    parser.add_argument("--first", type=int, default=0, help="first candidate task")
    options = parser.parse_args()
    rows: list[tuple[Run, Run, Run]] = []
    kept, number = 0, options.first - 1
    while kept < options.tasks:
        number += 1
        task = job_shop(number)
        probe = timed(partial(by_hand, task, 0, options.most))
        if not probe.answer[0] or probe.cpu < options.least:
            continue
        kept += 1
        limit = 4 * options.most
        runs = []
        for seed in range(options.seeds):
            hand = timed(partial(by_hand, task, seed, limit))
            off = timed(partial(through_irc, task, seed, limit, False))
            on = timed(partial(through_irc, task, seed, limit, True))
            if not hand.answer == off.answer == on.answer:
                print(f"task {number} seed {seed}: answers differ: {hand}, {off}, {on}")
            runs.append((hand, off, on))
        rows += runs
        print(
            f"task {number}: {len(task.actions)} actions, "
            f"by hand {mean([hand.cpu for hand, _, _ in runs]):.2f} s, {ratios(runs)}",
            flush=True,
        )
    print(f"{kept} tasks × {options.seeds} seeds, one worker, ratio to the model by hand:")
    print(ratios(rows))


def ratios(rows: list[tuple[Run, Run, Run]]) -> str:
    """Both ways through irc against the model by hand, geometric means."""
    means = {
        clock: [
            mean([getattr(row[k], clock) / getattr(row[0], clock) for row in rows]) for k in (1, 2)
        ]
        for clock in ("cpu", "wall")
    }
    return "; ".join(
        f"{clock}: bounds and hints off × {off:.3f}, on × {on:.3f}"
        for clock, (off, on) in means.items()
    )


if __name__ == "__main__":
    main()
