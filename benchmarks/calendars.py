"""Two hundred actions over twelve weeks of shifts: proven, or how far from the bound, in 30 s.

Jobs of four to six steps go through machines that work in one, two or three shifts from Monday to
Friday, with holidays and a change of clocks; the longer steps may pause. Beside irc stands a model
for CP-SAT written by hand: a choice for each two open times in which a step can start and end.
`python benchmarks/calendars.py [--tasks 20] [--seconds 30] [--processor]`

With `--processor` each gets the seconds as processor time, for each of its two workers, and as much
time on the clock as it takes to have it on a busy machine.
"""

from __future__ import annotations

import argparse
import random
import time
from itertools import accumulate
from statistics import mean
from typing import Any

from ortools.sat.python import cp_model

import irc
from irc.lowering.lower import lower
from irc.model import Task
from irc.targets import Cancellation
from racing.spending import when_spent

WORKERS = 2
MOST_PACE = 20
"""On a busy machine, a run gets up to that many times the wall-clock time."""

ACTIONS = 200
SHIFTS = {
    "early": [("06:00", "14:00")],
    "two": [("06:00", "14:00"), ("14:00", "22:00")],
    "night": [("22:00", "06:00")],
}
WEEK = ["mon", "tue", "wed", "thu", "fri"]


def shop(seed: int) -> dict[str, Any]:
    """A task of 200 steps on eight machines."""
    rng = random.Random(seed)
    calendars = [
        {
            "id": name,
            "time_zone": "Europe/Berlin",
            "open": [{"days": WEEK, "from": a, "to": b} for a, b in parts],
            "closed": ["2026-10-03", "2026-11-01"],
        }
        for name, parts in SHIFTS.items()
    ]
    names = list(SHIFTS)
    machines = [{"id": f"m{k}", "calendar": names[k % 3]} for k in range(8)]
    actions: list[dict[str, Any]] = []
    precedence = []
    job = 0
    while len(actions) < ACTIONS:
        steps = min(rng.randint(4, 6), ACTIONS - len(actions))
        route = rng.sample(range(8), steps)
        for step, machine in enumerate(route):
            actions.append(
                {
                    "id": f"j{job} s{step}",
                    "duration": rng.randint(16, 72) / 2
                    if rng.random() < 0.6
                    else rng.randint(2, 7),
                    "uses": [{"resource": f"m{machine}"}],
                }
            )
            if actions[-1]["duration"] > 7:
                actions[-1]["breaks"] = "pause"
            if step:
                precedence.append([f"j{job} s{step - 1}", f"j{job} s{step}"])
        job += 1
    return {
        "name": f"shop {seed}",
        "time_unit": "h",
        "origin": "2026-09-07T06:00:00+02:00",
        "calendars": calendars,
        "resources": machines,
        "actions": actions,
        "precedence": precedence,
    }


def by_irc(document: dict[str, Any], seconds: float, processor: bool) -> irc.Schedule:
    """irc's schedule."""
    cancel = Cancellation()
    limit = seconds
    if processor:
        when_spent(time.process_time() + WORKERS * seconds, cancel.cancel)
        limit *= MOST_PACE
    task = irc.Task.from_dict(document)
    return task.solve(time_limit=limit, workers=WORKERS, cancel=cancel)


def by_hand(
    document: dict[str, Any], seconds: float, processor: bool
) -> tuple[float | None, float]:
    """(makespan, bound) in hours of a model written by hand, over half hours."""
    problem = lower(Task.model_validate(document))
    horizon = problem.horizon or 0
    model = cp_model.CpModel()
    on: dict[int, list[Any]] = {}
    starts, ends = [], []
    for activity in problem.activities:
        (use,) = activity.uses
        r = use.alternatives[0]
        opened = [(w.start, w.end) for w in problem.resources[r].windows]
        before = list(accumulate((b - a for a, b in opened), initial=0))
        work = activity.details.work[0][0] if activity.details.work else activity.duration_min
        start = model.new_int_var(0, horizon, "")
        end = model.new_int_var(0, horizon, "")
        choices = []
        for k, (a, b) in enumerate(opened):
            if not activity.details.work:
                if b - a >= work:
                    x = model.new_bool_var("")
                    model.add_linear_constraint(start, a, b - work).only_enforce_if(x)
                    model.add(end == start + work).only_enforce_if(x)
                    choices.append(x)
                continue
            for m in range(k, len(opened)):
                # It starts in open time k and ends in open time m.
                low = max(a, a + before[m] - before[k] - work + 1)
                high = min(b - 1, a + before[m + 1] - before[k] - work)
                if low <= high:
                    x = model.new_bool_var("")
                    gap = opened[m][0] - before[m] - (a - before[k])
                    model.add_linear_constraint(start, low, high).only_enforce_if(x)
                    model.add(end == start + work + gap).only_enforce_if(x)
                    choices.append(x)
                if before[m] - before[k] > work:
                    break
        model.add_exactly_one(choices)
        size = model.new_int_var(work, horizon, "")
        on.setdefault(r, []).append(model.new_interval_var(start, size, end, ""))
        starts.append(start)
        ends.append(end)
    for intervals in on.values():
        model.add_no_overlap(intervals)
    for arc in problem.arcs:
        model.add(starts[arc.after] >= ends[arc.before])
    makespan = model.new_int_var(0, horizon, "")
    model.add_max_equality(makespan, ends)
    model.minimize(makespan)
    solver = cp_model.CpSolver()
    solver.parameters.max_time_in_seconds = seconds
    solver.parameters.num_workers = WORKERS
    if processor:
        solver.parameters.max_time_in_seconds = MOST_PACE * seconds
        when_spent(time.process_time() + WORKERS * seconds, solver.stop_search)
    status = solver.solve(model)
    hours = float(problem.tick)
    found = (
        solver.objective_value * hours if status in (cp_model.OPTIMAL, cp_model.FEASIBLE) else None
    )
    return found, solver.best_objective_bound * hours


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--tasks", type=int, default=20)
    parser.add_argument("--seconds", type=float, default=30)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--alone", action="store_true", help="without the model written by hand")
    parser.add_argument("--processor", action="store_true", help="count processor time")
    given = parser.parse_args()
    gaps, ratios = [], []
    for seed in range(given.first, given.first + given.tasks):
        document = shop(seed)
        clock = time.process_time if given.processor else time.perf_counter
        begun = clock()
        schedule = by_irc(document, given.seconds, given.processor)
        took = clock() - begun
        found = float(schedule.makespan) if schedule.answered else None
        bound = float(schedule.objective[0].bound or 0) if schedule.answered else 0.0
        gap = 1.0 if found is None else (found - bound) / found
        gaps.append(gap)
        line = f"{document['name']}: {schedule.status}, {found} h, bound {bound}, "
        line += f"gap {gap:.2%}, {took:.1f} s"
        if not given.alone:
            other, other_bound = by_hand(document, given.seconds, given.processor)
            line += f"; by hand {other} h, bound {other_bound}"
            if found and other:
                ratios.append(found / other)
        print(line, flush=True)
    within = sum(gap <= 0.01 for gap in gaps)
    print(f"proven or within 1 %: {within} of {len(gaps)}, mean gap {mean(gaps):.2%}")
    if ratios:
        print(f"makespan to that of the model written by hand: {mean(ratios):.4f} on average")


if __name__ == "__main__":
    main()
