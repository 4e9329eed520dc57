"""Random small tasks with one element of the vocabulary, on both targets, against exact answers.

Run: PYTHONPATH=tests python -m benchmarks.elements modes --tasks 500 --target cpsat
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests"))

from element_laws import judge_exact, judge_planner
from irc.targets import EngineFailed
from oracles.elements import KINDS, TooHardError


def main() -> int:
    """Prints how the answers ended, and each that is wrong."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("kind", choices=list(KINDS))
    parser.add_argument("--tasks", type=int, default=500)
    parser.add_argument("--first-seed", type=int, default=1000)
    parser.add_argument("--target", choices=["cpsat", "pddl21"], default="cpsat")
    parser.add_argument("--seconds", type=float, default=2.0, help="for each task, on pddl21")
    chosen = parser.parse_args()
    began = time.perf_counter()
    seen: Counter[str] = Counter()
    for seed in range(chosen.first_seed, chosen.first_seed + chosen.tasks):
        try:
            task, best = KINDS[chosen.kind](seed)
        except TooHardError:
            seen["not judged"] += 1
            continue
        try:
            if chosen.target == "cpsat":
                seen[judge_exact(task, best)] += 1
            else:
                seen[judge_planner(task, best, chosen.seconds)] += 1
        except (AssertionError, EngineFailed) as fault:
            seen["wrong"] += 1
            print(f"{chosen.kind} {seed}: {type(fault).__name__}: {fault}")
    shown = ", ".join(f"{count} {how}" for how, count in sorted(seen.items()))
    print(f"{chosen.kind} on {chosen.target}: {shown}; {time.perf_counter() - began:.0f} s")
    return 1 if seen["wrong"] else 0


if __name__ == "__main__":
    sys.exit(main())
