"""A batch resource against hand-written CP-SAT models: how long each takes to prove the optimum.

An oven with loads of one family, jobs with amounts, releases and due dates. The models: irc's own;
`slots`, the usual one, with a variable load for each job and loads in order; `pairs`, with a
choice for each two jobs (before, after, together).

Run: python -m benchmarks.loads --jobs 12 --instances 10 --seconds 30
"""

from __future__ import annotations

import argparse
import random
import sys
import time
from collections.abc import Callable
from itertools import combinations
from typing import Any, NamedTuple

import irc

Document = dict[str, Any]


class Job(NamedTuple):
    """A job of the oven."""

    family: int
    amount: int
    release: int
    due: int
    weight: int


class Instance(NamedTuple):
    """An oven and its jobs; `lengths` are the durations of families."""

    capacity: int
    lengths: tuple[int, ...]
    jobs: tuple[Job, ...]
    tardiness: bool


Found = tuple[int | None, bool, float]
"""The best value, whether it is proven, the seconds."""


def random_instance(seed: int, jobs: int) -> Instance:
    """An instance; every second one has weighted tardiness as its objective."""
    rng = random.Random(seed)
    lengths = tuple(rng.randint(10, 30) for _ in range(3))
    made = tuple(
        Job(
            rng.randrange(3),
            rng.randint(1, 6),
            rng.randint(0, 4 * jobs),
            rng.randint(20, 30 + 5 * jobs),
            rng.randint(1, 5),
        )
        for _ in range(jobs)
    )
    return Instance(10, lengths, made, seed % 2 == 1)


def by_irc(instance: Instance, seconds: float, workers: int) -> Found:
    """By this compiler."""
    actions = [
        {
            "id": f"j{k}",
            "duration": instance.lengths[job.family],
            "release": job.release,
            "due": job.due,
            "weight": job.weight,
            "uses": [{"resource": "oven", "amount": job.amount, "family": f"f{job.family}"}],
        }
        for k, job in enumerate(instance.jobs)
    ]
    task = irc.Task(
        resources=[{"id": "oven", "kind": "batch", "capacity": instance.capacity}],
        actions=actions,
        objective="minimize_tardiness" if instance.tardiness else "minimize_makespan",
    )
    began = time.perf_counter()
    schedule = irc.solve(task, time_limit=seconds, workers=workers)
    spent = time.perf_counter() - began
    if not schedule.answered:
        return None, False, spent
    return int(schedule.objective[0].value), str(schedule.status) == "optimal", spent


def by_slots(instance: Instance, seconds: float, workers: int) -> Found:
    """A load for each job, loads in the order of their starts."""
    from ortools.sat.python import cp_model

    model = cp_model.CpModel()
    horizon = _horizon(instance)
    jobs, slots = instance.jobs, range(len(instance.jobs))
    starts = [model.new_int_var(0, horizon, "") for _ in slots]
    sizes = [model.new_int_var(0, max(instance.lengths), "") for _ in slots]
    in_slot = [[model.new_bool_var("") for _ in slots] for _ in jobs]
    of_family = [[model.new_bool_var("") for _ in instance.lengths] for _ in slots]
    for b in slots:
        model.add_at_most_one(of_family[b])
        model.add(
            sizes[b] == sum(p * f for p, f in zip(instance.lengths, of_family[b], strict=True))
        )
        amounts = (job.amount * in_slot[j][b] for j, job in enumerate(jobs))
        model.add(sum(amounts) <= instance.capacity)
        if b:
            model.add(starts[b] >= starts[b - 1] + sizes[b - 1])
    ends = []
    for j, job in enumerate(jobs):
        model.add_exactly_one(in_slot[j])
        start = model.new_int_var(job.release, horizon, "")
        for b in slots:
            model.add_implication(in_slot[j][b], of_family[b][job.family])
            model.add(start == starts[b]).only_enforce_if(in_slot[j][b])
        ends.append(start + instance.lengths[job.family])
    return _solved(model, instance, ends, seconds, workers)


def by_pairs(instance: Instance, seconds: float, workers: int) -> Found:
    """A choice for each two jobs, and a cumulative."""
    from ortools.sat.python import cp_model

    model = cp_model.CpModel()
    horizon = _horizon(instance)
    starts = [model.new_int_var(job.release, horizon, "") for job in instance.jobs]
    lengths = [instance.lengths[job.family] for job in instance.jobs]
    intervals = [
        model.new_fixed_size_interval_var(s, p, "") for s, p in zip(starts, lengths, strict=True)
    ]
    model.add_cumulative(intervals, [job.amount for job in instance.jobs], instance.capacity)
    for i, j in combinations(range(len(instance.jobs)), 2):
        before, after = model.new_bool_var(""), model.new_bool_var("")
        choices = [before, after]
        model.add(starts[i] + lengths[i] <= starts[j]).only_enforce_if(before)
        model.add(starts[j] + lengths[j] <= starts[i]).only_enforce_if(after)
        if instance.jobs[i].family == instance.jobs[j].family:
            together = model.new_bool_var("")
            model.add(starts[i] == starts[j]).only_enforce_if(together)
            choices.append(together)
        model.add_exactly_one(choices)
    ends = [s + p for s, p in zip(starts, lengths, strict=True)]
    return _solved(model, instance, ends, seconds, workers)


def _horizon(instance: Instance) -> int:
    work = sum(instance.lengths[job.family] for job in instance.jobs)
    return max(job.release for job in instance.jobs) + work


def _solved(model: Any, instance: Instance, ends: list[Any], seconds: float, workers: int) -> Found:
    from ortools.sat.python import cp_model

    horizon = _horizon(instance)
    if instance.tardiness:
        late = [model.new_int_var(0, horizon, "") for _ in ends]
        for job, tardiness, end in zip(instance.jobs, late, ends, strict=True):
            model.add(tardiness >= end - job.due)
        model.minimize(sum(job.weight * t for job, t in zip(instance.jobs, late, strict=True)))
    else:
        makespan = model.new_int_var(0, horizon, "")
        for end in ends:
            model.add(makespan >= end)
        model.minimize(makespan)
    solver = cp_model.CpSolver()
    solver.parameters.max_time_in_seconds = seconds
    solver.parameters.num_workers = workers
    began = time.perf_counter()
    status = solver.solve(model)
    spent = time.perf_counter() - began
    if status not in (cp_model.OPTIMAL, cp_model.FEASIBLE):
        return None, False, spent
    return round(solver.objective_value), status == cp_model.OPTIMAL, spent


MODELS: dict[str, Callable[[Instance, float, int], Found]] = {
    "irc": by_irc,
    "slots": by_slots,
    "pairs": by_pairs,
}


def main() -> int:
    """Prints a row for each instance, and the sums."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--jobs", type=int, default=12)
    parser.add_argument("--instances", type=int, default=10)
    parser.add_argument("--first-seed", type=int, default=0)
    parser.add_argument("--seconds", type=float, default=30.0)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--models", nargs="+", choices=list(MODELS), default=list(MODELS))
    chosen = parser.parse_args()
    proven = dict.fromkeys(chosen.models, 0)
    spent = dict.fromkeys(chosen.models, 0.0)
    gaps = dict.fromkeys(chosen.models, 0.0)
    wrong = 0
    for seed in range(chosen.first_seed, chosen.first_seed + chosen.instances):
        instance = random_instance(seed, chosen.jobs)
        found = {m: MODELS[m](instance, chosen.seconds, chosen.workers) for m in chosen.models}
        known = [value for value, _, _ in found.values() if value is not None]
        best = min(known, default=0)
        for name, (value, optimal, seconds) in found.items():
            proven[name] += optimal
            spent[name] += seconds
            if value is not None:
                gaps[name] += (value - best) / max(best, 1)
                wrong += optimal and value != best
        row = ", ".join(f"{m} {v}{'' if o else '?'} {s:.1f} s" for m, (v, o, s) in found.items())
        print(f"{seed}: {row}", flush=True)
    for name in chosen.models:
        print(
            f"{name}: {proven[name]} of {chosen.instances} proven, mean gap to the best "
            f"{gaps[name] / chosen.instances:.2%}, {spent[name]:.0f} s"
        )
    print(f"{wrong} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
