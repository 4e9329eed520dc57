"""Imports, solves and validates the Robo Challenge, and compares with its own optimum.

    python benchmarks/robo.py [--target cpsat|pddl21] [--engine auto] [--seconds 30] [--data DIR]

A makespan task must reach `optimal_makespan`; a reward task `optimal_reward`, and `cpsat` proves
the least makespan for it besides. `proven` counts what the target itself called optimal.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from irc.frontends.importers.robo import import_robo
from irc.model import Task
from timed import Timed, solve_timed, spread

DATA = Path(__file__).resolve().parents[2] / "shared" / "data" / "robo_challenge"


def as_good_as_known(task: Task, answer: Timed) -> bool:
    """Whether the answer has the benchmark's best value. A better one would be a defect."""
    known = task.metadata
    if "optimal_reward" in known:
        return answer.value("reward") == known["optimal_reward"]
    return answer.value("makespan") == known["optimal_makespan"]


def first_is_proven(answer: Timed) -> bool:
    """Whether the bound of the first objective meets its value."""
    if answer.schedule is None or not answer.schedule.objective:
        return False
    first = answer.schedule.objective[0]
    return first.bound == first.value


def main() -> None:
    """Prints how many answers are valid, equal to the known optimum, and proven; and the times."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--target", default="cpsat", choices=["cpsat", "pddl21"])
    parser.add_argument("--engine", default="auto")
    parser.add_argument("--seconds", type=float, default=30.0)
    parser.add_argument("--data", type=Path, default=DATA)
    options = parser.parse_args()
    tasks = [
        task
        for path in sorted(options.data.glob("*.json"))
        for _, task in import_robo(path.read_text("utf-8"), path.name)
    ]
    answers = []
    for task in tasks:
        answer = solve_timed(task, options.target, options.engine, options.seconds)
        answers.append(answer)
        if not as_good_as_known(task, answer) or not answer.proven:
            print(f"{task.name}: {answer.said}, {answer.value('makespan')}", flush=True)
    equal = sum(map(as_good_as_known, tasks, answers))
    print(
        f"{options.target}: {len(tasks)} tasks, {sum(a.valid for a in answers)} valid, "
        f"{equal} = known optimum, {sum(a.proven for a in answers)} proven optimal, "
        f"{sum(map(first_is_proven, answers))} proven in their first objective; "
        f"{spread([a.seconds for a in answers])}"
    )


if __name__ == "__main__":
    main()
