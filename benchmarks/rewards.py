"""Random orders under a deadline: 15 to 40 optional groups with rewards, stations and stock.

    python benchmarks/rewards.py [--tasks 50] [--seconds 10] [--engine auto] [--targets cpsat …]

`cpsat` must prove each optimal. `pddl21` must be valid, must never be called optimal without a
proof, and is measured by how much reward it misses. In every seventh task nothing fits.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from oracles.state_generators import reward_task
from timed import Timed, solve_timed, spread

CPSAT_SECONDS = 60.0


def main() -> None:
    """Prints for each target: answers, proofs, empty selections, reward missed, times."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tasks", type=int, default=50)
    parser.add_argument("--seconds", type=float, default=10.0, help="of pddl21")
    parser.add_argument("--engine", default="auto", help="of pddl21")
    parser.add_argument("--targets", nargs="*", default=["cpsat", "pddl21"])
    options = parser.parse_args()
    tasks = [reward_task(seed) for seed in range(options.tasks)]
    best = [solve_timed(task, "cpsat", "auto", CPSAT_SECONDS) for task in tasks]
    answers = {"cpsat": best}
    if "pddl21" in options.targets:
        answers["pddl21"] = [
            solve_timed(task, "pddl21", options.engine, options.seconds) for task in tasks
        ]
    for target in options.targets:
        show(target, answers[target], best)


def show(target: str, answers: list[Timed], best: list[Timed]) -> None:
    """Prints the figures of one target; a reward above the proven one is called WRONG."""
    missed = []
    for seed, (answer, reference) in enumerate(zip(answers, best, strict=True)):
        reward, most = answer.value("reward"), reference.value("reward")
        if reward is None or most is None or not reference.proven:
            print(f"{target} {seed}: {answer.said}; cpsat {reference.said}")
            continue
        if reward > most or (answer.proven and reward != most):
            print(f"{target} {seed}: WRONG: reward {reward} of {most}, {answer.said}")
        missed.append(0.0 if most == 0 else float(most - reward) / float(most))
    empty = sum(a.schedule is not None and a.valid and not a.schedule.entries for a in answers)
    gap = 100 * sum(missed) / len(missed) if missed else float("nan")
    print(
        f"{target}: {len(answers)} tasks, {sum(a.valid for a in answers)} valid, "
        f"{sum(a.proven for a in answers)} proven optimal, {empty} empty selections, "
        f"mean reward missed {gap:.2f} % of {len(missed)} compared; "
        f"{spread([a.seconds for a in answers])}",
        flush=True,
    )


if __name__ == "__main__":
    main()
