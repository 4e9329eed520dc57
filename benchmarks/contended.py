"""Compares both targets on random contended tasks with brute force over integer start times.

    python benchmarks/contended.py [--tasks 200] [--big 30] [--seconds 10] [--engine auto]

`cpsat` must equal brute force on all; `pddl21` is never below the optimum and never called
optimal without a proof; the tasks with big capacities are valid or refused with a reason.
"""

from __future__ import annotations

import argparse
import random
import sys
import time
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from irc.diagnostics import InputError
from irc.driver.solve import solve_task
from irc.model import Task
from irc.schedule import Schedule, Status
from irc.targets import SolveOptions
from oracles.brute_force import optimal_makespan
from oracles.generators import big_capacity_task, random_task


def answer(task: Task, target: str, engine: str, seconds: float) -> Schedule | None:
    """The validated answer of a target with its engine forced to run; None if it refuses."""
    try:
        options = SolveOptions(target, engine, seconds, workers=1, shortcut=False)
        return solve_task(task, options).schedule
    except InputError:
        return None


def verdict(schedule: Schedule | None, optimum: int | None) -> str:
    """The verdict on an answer, given the optimum (None: infeasible); "WRONG …" is a defect."""
    if schedule is None or schedule.status is Status.INFEASIBLE:
        return "infeasible, rightly" if optimum is None else "WRONG: refused or infeasible"
    if schedule.status is Status.UNKNOWN:
        return "no answer (infeasible)" if optimum is None else "no answer"
    if optimum is None or schedule.makespan < optimum:
        return "WRONG: better than possible"
    if schedule.makespan == optimum:
        return "optimal, proven" if schedule.status is Status.OPTIMAL else "optimal, not proven"
    if schedule.status is Status.OPTIMAL:
        return "WRONG: called optimal"
    return "valid, longer"


def main() -> None:
    """Prints the number of each verdict."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tasks", type=int, default=200)
    parser.add_argument("--big", type=int, default=30)
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--engine", default="auto")
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--targets", nargs="*", default=["cpsat", "pddl21"])
    options = parser.parse_args()
    families = (("contended", random_task, options.tasks), ("big", big_capacity_task, options.big))
    for family, draw, count in families:
        tasks = [draw(random.Random(options.first + k)) for k in range(count)]
        optima = [optimal_makespan(task) for task in tasks]
        for target in options.targets:
            engine = options.engine if target == "pddl21" else "auto"
            counts: Counter[str] = Counter()
            gap, began = 0.0, time.perf_counter()
            for k, (task, optimum) in enumerate(zip(tasks, optima, strict=True)):
                schedule = answer(task, target, engine, options.seconds)
                said = verdict(schedule, optimum)
                counts[said] += 1
                if schedule is not None and schedule.answered and optimum:
                    gap += float(schedule.makespan - optimum) / optimum
                if said.startswith("WRONG"):
                    print(f"{family} {options.first + k}: {said}, optimum {optimum}")
            seconds = time.perf_counter() - began
            print(f"{family}, {target}: {dict(sorted(counts.items()))}")
            print(f"  mean gap {100 * gap / max(1, count):.2f} %, {seconds:.0f} s", flush=True)


if __name__ == "__main__":
    main()
