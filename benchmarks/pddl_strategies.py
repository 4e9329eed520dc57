"""What each part of the PDDL2.1 strategies pays, on random contended tasks and on given files.

    python benchmarks/pddl_strategies.py [--tasks 200] [--seconds 10] [--engine kairos]
        [--without bound tighten …] [FILES …]

Without files the tasks are random ones with 6 to 20 jobs, capacities of 1 and 2, robots and lags.
`cpsat` (60 s, no other limits) says what the optimum is. Each `--without` leaves a part out.
"""

from __future__ import annotations

import argparse
import random
import sys
import time
from collections import Counter
from pathlib import Path
from statistics import median

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from irc.backend import EngineFailed, Limits, Program, get_backend
from irc.compiler import finish, solve_task
from irc.frontends.files import read_task
from irc.model import Task
from irc.pipeline import lower_for
from irc.schedule import Schedule, Status
from irc.validation import validate
from irc_pddl21.engines import Aries, Kairos, Optic, Portfolio
from irc_pddl21.session import Tactics
from irc_pddl21.strategy import solve_with
from oracles.generators import contended_task

PLANNERS = {"kairos": Kairos(), "aries": Aries(), "optic": Optic()}


def random_tasks(count: int) -> list[Task]:
    """Contended tasks of 6 to 20 jobs."""
    rngs = [random.Random(f"strategy {k}") for k in range(count)]
    return [contended_task(rng, rng.randint(6, 20)) for rng in rngs]


def answer(task: Task, engine: str, limits: Limits, tactics: Tactics) -> Schedule:
    """The answer of one planner, or of the portfolio, not yet validated."""
    backend = get_backend("pddl21")
    program = Program(backend, task, lower_for(task, backend))
    if engine == "auto":
        runner = backend.engines()["auto"]
        assert isinstance(runner, Portfolio)
        outcome = runner.solve(program, limits)
    else:
        outcome = solve_with(PLANNERS[engine], program, limits, tactics=tactics)
    return finish(task, program.problem, outcome, "pddl21", outcome.seconds)


def values(schedule: Schedule) -> list[float]:
    """The objectives, each so that less is better."""
    return [float(-o.value if o.name == "reward" else o.value) for o in schedule.objective]


def verdict(task: Task, schedule: Schedule | None, best: Schedule) -> str:
    """How an answer compares with the optimum; "WRONG …" is a defect."""
    if schedule is None or not schedule.answered:
        return "no answer"
    if not validate(task, schedule).valid:
        return "WRONG: not valid"
    if best.status is not Status.OPTIMAL:
        return "valid, optimum unknown"
    proven = schedule.status is Status.OPTIMAL
    if values(schedule) == values(best):
        return "optimal, proven" if proven else "optimal, not proven"
    if values(schedule) < values(best):
        return "WRONG: better than the optimum"
    return "WRONG: called optimal" if proven else "valid, not optimal"


def gap(schedule: Schedule, best: Schedule) -> float:
    """How far the first objective is from the optimum, as a share of it."""
    mine, theirs = values(schedule)[0], values(best)[0]
    return abs(mine - theirs) / abs(theirs) if theirs else abs(mine - theirs)


def main() -> None:
    """Prints how often each verdict was reached, the mean gap, and the seconds of solving."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", nargs="*", type=Path)
    parser.add_argument("--tasks", type=int, default=200)
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--engine", default="kairos")
    parser.add_argument("--without", nargs="*", default=[])
    parser.add_argument("--show", action="store_true")
    options = parser.parse_args()
    tactics = Tactics(**dict.fromkeys(options.without, False))
    if options.files:
        tasks = [read_task(path).task for path in options.files]
    else:
        tasks = random_tasks(options.tasks)
    counts: Counter[str] = Counter()
    gaps: list[float] = []
    seconds: list[float] = []
    for k, task in enumerate(tasks):
        best = solve_task(task, "cpsat", limits=Limits(60.0, workers=1)).schedule
        began = time.perf_counter()
        try:
            schedule = answer(task, options.engine, Limits(options.seconds, workers=1), tactics)
        except EngineFailed as error:
            print(f"{k}: {error}")
            schedule = None
        seconds.append(time.perf_counter() - began)
        said = verdict(task, schedule, best)
        counts[said] += 1
        if schedule is not None and schedule.answered and best.answered:
            gaps.append(gap(schedule, best))
        if options.show or said.startswith("WRONG"):
            found = "-" if schedule is None else [str(o.value) for o in schedule.objective]
            wanted = [str(o.value) for o in best.objective]
            print(f"{k} {task.name}: {said}, {found} of {wanted}, {seconds[-1]:.2f} s", flush=True)
    print(dict(sorted(counts.items())))
    print(
        f"mean gap {100 * sum(gaps) / max(1, len(gaps)):.3f} %, "
        f"median {median(seconds):.2f} s, greatest {max(seconds):.2f} s"
    )


if __name__ == "__main__":
    main()
