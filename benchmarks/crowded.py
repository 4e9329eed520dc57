"""Compares `pddl21` with `cpsat` on random crowded tasks (6 to 20 jobs, robots, lags).

python benchmarks/crowded.py [--tasks 200] [--first 0] [--seconds 10] [--engine auto]
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from oracles.state_generators import crowded_task
from timed import solve_timed, spread

CPSAT_SECONDS = 60.0


def main() -> None:
    """Prints the numbers of valid, optimal and proven answers, the mean gap and the times."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tasks", type=int, default=200)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--engine", default="auto")
    options = parser.parse_args()
    seconds: list[float] = []
    gaps: list[float] = []
    valid = optimal = proven = unproven_reference = 0
    for seed in range(options.first, options.first + options.tasks):
        task = crowded_task(seed)
        best = solve_timed(task, "cpsat", "auto", CPSAT_SECONDS)
        answer = solve_timed(task, "pddl21", options.engine, options.seconds)
        seconds.append(answer.seconds)
        least, makespan = best.value("makespan"), answer.value("makespan")
        unproven_reference += not best.proven
        if least is None or makespan is None:
            print(f"{seed}: {answer.said}; cpsat {best.said}", flush=True)
            continue
        valid += 1
        optimal += makespan == least
        proven += answer.proven
        gaps.append(float(makespan - least) / float(least))
        if best.proven and (makespan < least or (answer.proven and makespan != least)):
            print(f"{seed}: WRONG: {makespan}, {answer.said}; cpsat {least}", flush=True)
    gap = 100 * sum(gaps) / len(gaps) if gaps else float("nan")
    print(
        f"pddl21: {options.tasks} tasks, {valid} valid, {optimal} = cpsat, {proven} proven; "
        f"mean gap {gap:.2f} % of {len(gaps)}; {spread(seconds)}; "
        f"cpsat left {unproven_reference} unproven"
    )


if __name__ == "__main__":
    main()
