"""Runs PyJobShop on one instance of the league.

python -m racing.through_pyjobshop INSTANCE.json [--seconds 10] [--workers 2] [--seed 0]
"""

from __future__ import annotations

import argparse
import json
import time
from importlib import import_module
from typing import Any, ClassVar

from ortools.sat.python import cp_model
from pyjobshop import Model

from racing.plain import Trace
from racing.spending import when_spent


class TracingSolver(cp_model.CpSolver):
    """A solver that prints each better schedule and bound; PyJobShop itself keeps the last only."""

    processor_seconds: ClassVar[float] = 0.0

    def solve(self, model: cp_model.CpModel, solution_callback: Any = None) -> Any:
        """Solves with the callback that prints."""
        when_spent(self.processor_seconds, self.stop_search)
        trace = Trace()
        self.best_bound_callback = trace.on_bound
        return super().solve(model, solution_callback or trace)


def model_of(instance: dict[str, Any]) -> Model:
    """The instance as a user of PyJobShop writes it."""
    model = Model()
    shop = instance["family"] in ("job-shop", "flexible")
    resources = [
        model.add_machine() if shop else model.add_renewable(capacity=capacity)
        for capacity in instance["capacities"]
    ]
    budgets = [model.add_consumable(capacity=budget) for budget in instance["budgets"]]
    tasks = [model.add_task() for _ in instance["jobs"]]
    for task, ways in zip(tasks, instance["jobs"], strict=True):
        for way in ways:
            held = [resources[r] for r, _ in way["holds"]]
            spent = [budgets[k] for k, _ in way["spends"]]
            amounts = [n for _, n in [*way["holds"], *way["spends"]]]
            model.add_mode(task, [*held, *spent], way["duration"], None if shop else amounts)
    for lag in instance["lags"]:
        add = model.add_end_before_start if lag["from_end"] else model.add_start_before_start
        add(tasks[lag["before"]], tasks[lag["after"]], delay=lag["least"])
    return model


def main() -> None:
    """Solves one instance."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("instance")
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--processor-seconds", type=float, default=0.0)
    options = parser.parse_args()
    TracingSolver.processor_seconds = options.processor_seconds
    with open(options.instance, encoding="utf-8") as file:
        instance = json.load(file)
    model = model_of(instance)
    first = [0]
    for ways in instance["jobs"]:
        first.append(first[-1] + len(ways))
    # (The package has a class of this name, too.)
    import_module("pyjobshop.solvers.ortools.CPModel").__dict__["CpSolver"] = TracingSolver
    result = model.solve(
        time_limit=options.seconds,
        display=False,
        num_workers=options.workers,
        random_seed=options.seed,
    )
    final: dict[str, Any] = {
        "cpu": time.process_time(),
        "proven": result.status.value == "Optimal",
        "status": result.status.value,
        "bound": round(result.lower_bound),
    }
    if result.best.tasks:
        final["value"] = round(result.objective)
        final["starts"] = [task.start for task in result.best.tasks]
        final["ways"] = [task.mode - first[i] for i, task in enumerate(result.best.tasks)]
    print(json.dumps(final), flush=True)


if __name__ == "__main__":
    main()
