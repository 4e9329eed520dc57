"""AsyncPlan-XXL through both targets, engines forced to run, every answer validated.

    python benchmarks/asyncplan.py [--target cpsat|pddl21] [--engine E] [--data DIR] [--sizes N …]

For `pddl21` the planner's raw plan is judged too: each action once, every precedence met, and
unified-planning's own validator on the emitted text.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from irc.diagnostics import InputError
from irc.driver.solve import solve_task
from irc.frontends.importers.asyncplan import import_asyncplan
from irc.model import Task
from irc.schedule import Status
from irc.targets import SolveOptions
from raw_plans import raw_plan_faults

DATA = Path(__file__).resolve().parents[2] / "shared" / "data" / "asyncplan_xxl"


def instances(data: Path, sizes: Sequence[int] = ()) -> list[tuple[str, Task]]:
    """All tasks of the benchmark, or those of some sizes, smallest graphs first."""
    files = {int(f.stem.removeprefix("nodes")): f for f in data.glob("nodes*.json")}
    return [
        pair
        for size, file in sorted(files.items())
        if not sizes or size in sizes
        for pair in import_asyncplan(file.read_text("utf-8"), file.name)
    ]


def main() -> None:
    """Prints a line for each size, and the totals."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--target", default="cpsat")
    parser.add_argument("--engine", default="auto")
    parser.add_argument("--data", type=Path, default=DATA)
    parser.add_argument("--seconds", type=float, default=30.0)
    parser.add_argument("--sizes", type=int, nargs="*", default=[], help="of these sizes alone")
    options = parser.parse_args()
    how = SolveOptions(options.target, options.engine, options.seconds, workers=1, shortcut=False)
    counts: Counter[str] = Counter()
    seconds = []
    for name, task in instances(options.data, options.sizes):
        began = time.perf_counter()
        counts["tasks"] += 1
        try:
            answer = solve_task(task, how)
        except InputError as error:
            counts["refused"] += 1
            print(f"{name}: {error.report.errors[0].message}")
            continue
        seconds.append(time.perf_counter() - began)
        right = answer.schedule.makespan == task.metadata["answer"]
        counts["valid"] += bool(answer.schedule.entries)
        counts["= answer"] += right
        counts["optimal"] += answer.schedule.status is Status.OPTIMAL
        if not right or answer.schedule.status is not Status.OPTIMAL:
            print(f"{name}: {answer.schedule.status} {answer.schedule.makespan}")
        if options.target == "pddl21":
            faults = raw_plan_faults(task, options.engine)
            counts["raw plan accepted"] += not faults
            if faults:
                print(f"{name}: {faults[:3]}")
    print(dict(counts))
    print(
        f"solving: median {statistics.median(seconds):.3f} s, "
        f"max {max(seconds):.3f} s, total {sum(seconds):.1f} s"
    )


if __name__ == "__main__":
    main()
