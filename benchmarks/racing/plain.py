"""The models that a CP-SAT user would write, one of about thirty lines for each family.

    python benchmarks/racing/plain.py INSTANCE.json [--seconds 10] [--workers 2] [--seed 0]

The instance is one that the league wrote. Printed is a line of JSON for each better schedule or
bound, with the seconds of processor time of this process, and one for the final schedule.
"""

from __future__ import annotations

import argparse
import json
import time
from typing import Any

from ortools.sat.python import cp_model

Raw = dict[str, Any]
Built = tuple[cp_model.CpModel, list[Any], list[list[Any]]]
"""(model, start of each job, literal of each way of each job)."""


def job_shop(instance: Raw) -> Built:
    """Job shops: an interval for each job, no overlap on each machine."""
    model = cp_model.CpModel()
    jobs = [ways[0] for ways in instance["jobs"]]
    horizon = sum(job["duration"] for job in jobs)
    starts = [model.new_int_var(0, horizon, "") for _ in jobs]
    machines: dict[int, list[Any]] = {}
    for job, start in zip(jobs, starts, strict=True):
        interval = model.new_fixed_size_interval_var(start, job["duration"], "")
        machines.setdefault(job["holds"][0][0], []).append(interval)
    for intervals in machines.values():
        model.add_no_overlap(intervals)
    for lag in instance["lags"]:
        first = starts[lag["before"]] + jobs[lag["before"]]["duration"]
        model.add(starts[lag["after"]] >= first + lag["least"])
    makespan = model.new_int_var(0, horizon, "")
    for job, start in zip(jobs, starts, strict=True):
        model.add(makespan >= start + job["duration"])
    model.minimize(makespan)
    return model, starts, [[] for _ in jobs]


def flexible(instance: Raw) -> Built:
    """Flexible job shops: an optional interval for each machine that can do the job."""
    model = cp_model.CpModel()
    jobs = instance["jobs"]
    horizon = sum(max(way["duration"] for way in ways) for ways in jobs)
    starts = [model.new_int_var(0, horizon, "") for _ in jobs]
    ends = [model.new_int_var(0, horizon, "") for _ in jobs]
    machines: dict[int, list[Any]] = {}
    literals = []
    for ways, start, end in zip(jobs, starts, ends, strict=True):
        chosen = [model.new_bool_var("") for _ in ways]
        model.add_exactly_one(chosen)
        for way, literal in zip(ways, chosen, strict=True):
            interval = model.new_optional_interval_var(start, way["duration"], end, literal, "")
            machines.setdefault(way["holds"][0][0], []).append(interval)
        literals.append(chosen)
    for intervals in machines.values():
        model.add_no_overlap(intervals)
    for lag in instance["lags"]:
        model.add(starts[lag["after"]] >= ends[lag["before"]] + lag["least"])
    makespan = model.new_int_var(0, horizon, "")
    model.add_max_equality(makespan, ends)
    model.minimize(makespan)
    return model, starts, literals


def project(instance: Raw) -> Built:
    """Projects with one mode: an interval for each job, a cumulative for each resource."""
    model = cp_model.CpModel()
    jobs = [ways[0] for ways in instance["jobs"]]
    horizon = sum(job["duration"] for job in jobs)
    horizon += sum(max(0, lag["least"]) for lag in instance["lags"] if not lag["from_end"])
    starts = [model.new_int_var(0, horizon, "") for _ in jobs]
    held: dict[int, tuple[list[Any], list[int]]] = {}
    for job, start in zip(jobs, starts, strict=True):
        interval = model.new_fixed_size_interval_var(start, job["duration"], "")
        for resource, amount in job["holds"]:
            intervals, amounts = held.setdefault(resource, ([], []))
            intervals.append(interval)
            amounts.append(amount)
    for resource, (intervals, amounts) in held.items():
        model.add_cumulative(intervals, amounts, instance["capacities"][resource])
    for lag in instance["lags"]:
        since = jobs[lag["before"]]["duration"] if lag["from_end"] else 0
        model.add(starts[lag["after"]] >= starts[lag["before"]] + since + lag["least"])
    makespan = model.new_int_var(0, horizon, "")
    for job, start in zip(jobs, starts, strict=True):
        model.add(makespan >= start + job["duration"])
    model.minimize(makespan)
    return model, starts, [[] for _ in jobs]


def several_modes(instance: Raw) -> Built:
    """Projects with several modes: an optional interval for each, and a sum for each budget."""
    model = cp_model.CpModel()
    jobs = instance["jobs"]
    horizon = sum(max(way["duration"] for way in ways) for ways in jobs)
    starts = [model.new_int_var(0, horizon, "") for _ in jobs]
    ends = [model.new_int_var(0, horizon, "") for _ in jobs]
    held: dict[int, tuple[list[Any], list[int]]] = {}
    spent: dict[int, list[Any]] = {}
    literals = []
    for ways, start, end in zip(jobs, starts, ends, strict=True):
        chosen = [model.new_bool_var("") for _ in ways]
        model.add_exactly_one(chosen)
        for way, literal in zip(ways, chosen, strict=True):
            interval = model.new_optional_interval_var(start, way["duration"], end, literal, "")
            for resource, amount in way["holds"]:
                intervals, amounts = held.setdefault(resource, ([], []))
                intervals.append(interval)
                amounts.append(amount)
            for budget, amount in way["spends"]:
                spent.setdefault(budget, []).append(amount * literal)
        literals.append(chosen)
    for resource, (intervals, amounts) in held.items():
        model.add_cumulative(intervals, amounts, instance["capacities"][resource])
    for budget, amounts_spent in spent.items():
        model.add(sum(amounts_spent) <= instance["budgets"][budget])
    for lag in instance["lags"]:
        model.add(starts[lag["after"]] >= ends[lag["before"]] + lag["least"])
    makespan = model.new_int_var(0, horizon, "")
    model.add_max_equality(makespan, ends)
    model.minimize(makespan)
    return model, starts, literals


MODELS = {
    "job-shop": job_shop,
    "flexible": flexible,
    "rcpsp": project,
    "rcpsp-max": project,
    "multi-mode": several_modes,
}


class Trace(cp_model.CpSolverSolutionCallback):
    """Prints each better schedule and bound."""

    def __init__(self) -> None:
        super().__init__()
        self.value: int | None = None
        self.bound: int | None = None

    def on_solution_callback(self) -> None:
        """Called by CP-SAT for each solution."""
        self.value = round(self.objective_value)
        self.bound = round(self.best_objective_bound)
        self.show()

    def on_bound(self, bound: float) -> None:
        """Called by CP-SAT for each better bound."""
        self.bound = round(bound)
        self.show()

    def show(self) -> None:
        """Prints a line."""
        line = {"cpu": time.process_time(), "value": self.value, "bound": self.bound}
        print(json.dumps(line), flush=True)


def main() -> None:
    """Solves one instance."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("instance")
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--processor-seconds", type=float, default=0.0)
    options = parser.parse_args()
    with open(options.instance, encoding="utf-8") as file:
        instance = json.load(file)
    model, starts, literals = MODELS[instance["family"]](instance)
    solver = cp_model.CpSolver()
    solver.parameters.max_time_in_seconds = options.seconds
    solver.parameters.num_workers = options.workers
    solver.parameters.random_seed = options.seed
    if options.processor_seconds:
        from racing.spending import when_spent

        when_spent(options.processor_seconds, solver.stop_search)
    trace = Trace()
    solver.best_bound_callback = trace.on_bound
    status = solver.solve(model, trace)
    final: dict[str, Any] = {"cpu": time.process_time(), "proven": status == cp_model.OPTIMAL}
    final["bound"] = round(solver.best_objective_bound)
    if status in (cp_model.OPTIMAL, cp_model.FEASIBLE):
        final["value"] = round(solver.objective_value)
        final["starts"] = [solver.value(start) for start in starts]
        final["ways"] = [
            next((k for k, literal in enumerate(own) if solver.value(literal)), 0)
            for own in literals
        ]
    print(json.dumps(final), flush=True)


if __name__ == "__main__":
    main()
