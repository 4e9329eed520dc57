"""Measures the effect of each part of the PDDL2.1 strategies on random tasks and given files.

    python benchmarks/pddl_strategies.py [--family crowded] [--tasks 200] [--first 0]
        [--seconds 10] [--engine auto] [--without bound steps …] [FILES …]

Families: `crowded` and `contended` (6 to 20 jobs, robots, lags), `state` (small tasks with state,
choices, stock, calendars, groups), `rewards` (15 to 40 optional orders), `cellars` (matches).
`cpsat` gives the optimum. Each `--without` leaves a part of the strategies out.
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

from irc.diagnostics import InputError
from irc.driver.compile import lower_for
from irc.driver.judge import finish
from irc.driver.solve import solve_task
from irc.frontends.files import read_task
from irc.model import Task
from irc.schedule import Schedule, Status
from irc.targets import Budget, EngineFailed, Program, Refusal, SolveOptions, get_backend
from irc.validation import validate
from irc_pddl21.engines import Portfolio
from irc_pddl21.planners.aries import AriesPlanner
from irc_pddl21.planners.kairos import KairosPlanner
from irc_pddl21.planners.optic import OpticPlanner
from irc_pddl21.search.planner_session import Tactics
from irc_pddl21.search.strategy import solve_with
from oracles.generators import contended_task
from oracles.state_generators import crowded_task, match_cellar, reward_task, state_task

PLANNERS = {"kairos": KairosPlanner(), "aries": AriesPlanner(), "optic": OpticPlanner()}


def _contended(seed: int) -> Task:
    rng = random.Random(f"strategy {seed}")
    return contended_task(rng, rng.randint(6, 20))


FAMILIES = {
    "contended": _contended,
    "crowded": crowded_task,
    "state": state_task,
    "rewards": reward_task,
    "cellars": match_cellar,
}


def answer(task: Task, engine: str, seconds: float, tactics: Tactics) -> Schedule:
    """The answer of one planner, or of the portfolio, not yet validated."""
    backend = get_backend("pddl21")
    program = Program(backend, task, lower_for(task, backend))
    options, budget = SolveOptions(workers=1), Budget(seconds)
    if engine == "auto":
        runner = backend.engines()["auto"]
        assert isinstance(runner, Portfolio)
        outcome = runner.solve(program, options, budget)
    else:
        outcome = solve_with(PLANNERS[engine], program, options, budget, tactics)
    return finish(task, program.problem, outcome, "pddl21", outcome.seconds)


def values(schedule: Schedule) -> list[float]:
    """The objectives, each so that less is better."""
    return [float(-o.value if o.name == "reward" else o.value) for o in schedule.objective]


def verdict(task: Task, schedule: Schedule | None, best: Schedule) -> str:
    """The verdict on an answer, given the optimum; "WRONG …" is a defect."""
    if schedule is None or not schedule.answered:
        none = best.status is Status.INFEASIBLE
        return "no answer (infeasible)" if none else "no answer"
    if not validate(task, schedule).valid:
        return "WRONG: not valid"
    if best.status is Status.INFEASIBLE:
        return "WRONG: infeasible"
    if best.status is not Status.OPTIMAL:
        return "valid, optimum unknown"
    proven = schedule.status is Status.OPTIMAL
    if values(schedule) == values(best):
        return "optimal, proven" if proven else "optimal, not proven"
    if values(schedule) < values(best):
        return "WRONG: better than the optimum"
    return "WRONG: called optimal" if proven else "valid, not optimal"


def gap(schedule: Schedule, best: Schedule) -> float:
    """The distance of the first objective from the optimum, as a fraction of it."""
    mine, theirs = values(schedule)[0], values(best)[0]
    return abs(mine - theirs) / abs(theirs) if theirs else abs(mine - theirs)


def main() -> None:
    """Prints the number of each verdict, the mean gap, and the seconds of solving."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", nargs="*", type=Path)
    parser.add_argument("--tasks", type=int, default=200)
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--family", choices=FAMILIES, default="crowded")
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--engine", default="auto")
    parser.add_argument("--without", nargs="*", default=[])
    parser.add_argument("--show", action="store_true")
    options = parser.parse_args()
    tactics = Tactics(**dict.fromkeys(options.without, False))
    if options.files:
        tasks = [read_task(path).task for path in options.files]
    else:
        draw = FAMILIES[options.family]
        tasks = [draw(seed) for seed in range(options.first, options.first + options.tasks)]
    counts: Counter[str] = Counter()
    gaps: list[float] = []
    seconds: list[float] = []
    for k, task in enumerate(tasks, start=options.first):
        try:
            best = solve_task(task, SolveOptions(time_limit=30, workers=1)).schedule
        except InputError:
            counts["faulty"] += 1
            continue
        began = time.perf_counter()
        try:
            schedule = answer(task, options.engine, options.seconds, tactics)
        except (InputError, Refusal) as error:
            counts["refused"] += 1
            print(f"{k}: {error}")
            continue
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
