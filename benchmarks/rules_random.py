"""Random tasks with state, resources, stock and changes of the world, against brute force.

    python benchmarks/rules_random.py [--count 1000] [--first 0] [--target cpsat --target pddl21]
                                      [--time-limit 5]

Each task (`tests/oracles/rules_random.py`) is solved on each target, and then the world changes at
an instant of the plan. Every answer must be valid, no better than the optimum of brute force, and
what is called optimal, or infeasible, must be so. Ends with status 1 on any fault.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

import irc
from irc.execution import replan
from irc.model import Task
from irc.schedule import Schedule, Status
from irc.targets import EngineFailed, SolveOptions
from oracles.online_judge import judge_step
from oracles.rules_random import rules_event, rules_task
from oracles.state_brute_force import Optimum, TooLargeError, optimum


def judge_plan(task: Task, schedule: Schedule, best: Optimum | None) -> str | None:
    """What is wrong with an answer to a task; None: nothing."""
    if schedule.status in (Status.UNKNOWN, Status.FAILED):
        return None
    if schedule.status is Status.INFEASIBLE:
        return None if best is None else f"called infeasible, and {best.vector} is possible"
    verdict = irc.validate(task, schedule)
    if not verdict.valid:
        return f"not valid: {verdict.violations[0].message}"
    if best is None:
        return "an answer, and brute force proves that there is none"
    least = best.vector[0]
    if schedule.makespan < least:
        return f"{schedule.makespan}, and only {least} is possible"
    if schedule.status is Status.OPTIMAL and schedule.makespan != least:
        return f"{schedule.makespan} is called optimal, and {least} is possible"
    return None


def play(seed: int, options: SolveOptions, figures: Counter[str]) -> list[str]:
    """Solves a task, and goes on after a change of the world; returns the faults."""
    task, target = rules_task(seed), options.target
    try:
        best = optimum(task, max_situations=60_000)
    except TooLargeError:
        figures["too large"] += 1
        return []
    try:
        schedule = irc.solve(task, options=options)
        figures[f"{target} {schedule.status}"] += 1
        fault = judge_plan(task, schedule, best)
        if fault is not None:
            return [fault]
        event = rules_event(seed, schedule) if schedule.answered else None
        if event is None:
            return []
        step = replan(task, schedule, event.at, [event], options=options)
    except EngineFailed as error:
        return [f"failed: {error}"]
    except irc.InputError as error:
        figures[f"{target} refused"] += 1
        print(f"seed {seed} on {target} is refused: {error}".splitlines()[0], flush=True)
        return []
    figures[f"{target} after the event {step.schedule.status}"] += 1
    if step.schedule.status in (Status.UNKNOWN, Status.FAILED):
        return []
    judged = judge_step(task, schedule, step, [event], max_situations=60_000)
    figures[f"{target} compared after the event"] += judged.compared
    return judged.faults


def main() -> int:
    """Runs all and prints what came of them."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--target", action="append", default=[])
    parser.add_argument("--time-limit", type=float, default=5)
    options = parser.parse_args()
    figures: Counter[str] = Counter()
    faults = 0
    for seed in range(options.first, options.first + options.count):
        for target in options.target or ["cpsat", "pddl21"]:
            how = SolveOptions(target, time_limit=options.time_limit)
            for fault in play(seed, how, figures):
                faults += 1
                print(f"seed {seed} on {target}: {fault}", flush=True)
    for name, count in sorted(figures.items()):
        print(f"{name:40} {count:6}")
    print(f"{'faults':40} {faults:6}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
