"""Robotouille: the six kitchens, imported, solved and validated.

python benchmarks/robotouille.py [--target cpsat|pddl21] [--engine auto] [--seconds 120]
    [--data FILE] [--first N]
"""

from __future__ import annotations

import argparse
from pathlib import Path

from irc.frontends.importers.robotouille import import_robotouille
from timed import solve_timed

DATA = Path(__file__).resolve().parents[2] / "shared" / "data" / "robotouille_6.json"


def main() -> None:
    """Prints a line for each kitchen, and how many have a valid schedule."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--target", default="pddl21", choices=["cpsat", "pddl21"])
    parser.add_argument("--engine", default="auto")
    parser.add_argument("--seconds", type=float, default=120.0)
    parser.add_argument("--data", type=Path, default=DATA)
    parser.add_argument("--first", type=int, help="only so many of them")
    options = parser.parse_args()
    tasks = list(import_robotouille(options.data.read_text("utf-8"), options.data.name))
    tasks = tasks[: options.first]
    valid = 0
    for name, task in tasks:
        answer = solve_timed(task, options.target, options.engine, options.seconds, None)
        valid += answer.valid
        makespan = answer.value("makespan")
        print(
            f"{name}: {len(task.actions)} actions, {answer.said}, makespan {makespan}, "
            f"{answer.seconds:.1f} s",
            flush=True,
        )
    print(f"{options.target}: {valid} of {len(tasks)} valid")


if __name__ == "__main__":
    main()
