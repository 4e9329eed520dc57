"""Set-ups: irc side by side with a hand-written circuit model and with PyJobShop.

python benchmarks/setups.py [--shops 30] [--single 20] [--seconds 60] [--workers 2] [--processor]
  [--factory CASE]

Job shops with set-ups between families (makespan) and single machines with a weighted tardiness and
set-ups between any two jobs (as Cicirello's, 2005) are made here; the three solve each of them in
turn. The gap of a value is that to the best value that any of the three has found. `--factory`
reads the case with set-ups as state, writes them as a field, and solves it. PyJobShop must be
installed. With `--processor` each gets the seconds as processor time, for each of its workers, and
as much time on the clock as it takes to have it on a busy machine.
"""

from __future__ import annotations

import argparse
import json
import random
import time
from collections.abc import Callable, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

from ortools.sat.python import cp_model

import irc
from irc.model import Task
from irc.targets import Cancellation
from racing.spending import when_spent

Document = dict[str, Any]


MOST_PACE = 20
"""On a busy machine, a run gets up to that many times the wall-clock time."""


class Limit(NamedTuple):
    """What each of the three is given: seconds on the clock, or of processor time per worker."""

    seconds: float
    workers: int
    processor: bool

    @property
    def on_the_clock(self) -> float:
        """The seconds that it may take on the clock."""
        return self.seconds * MOST_PACE if self.processor else self.seconds

    def now(self) -> float:
        """The time that counts."""
        return time.process_time() if self.processor else time.monotonic()

    def watch(self, end: Callable[[], object]) -> None:
        """Calls `end` when the processor time is over that begins now."""
        if self.processor:
            when_spent(time.process_time() + self.seconds * self.workers, end)


class Found(NamedTuple):
    """The value of an answer, the bound on it, and the seconds that it took."""

    value: float
    bound: float
    seconds: float


# --- instances ------------------------------------------------------------------------------------


def closed(times: dict[tuple[str, str], int], names: list[str]) -> dict[tuple[str, str], int]:
    """Set-up times that keep the triangle inequality."""
    for via in names:
        for a in names:
            for b in names:
                if len({via, a, b}) == 3:
                    times[a, b] = min(times[a, b], times[a, via] + times[via, b])
    return times


def job_shop(seed: int) -> Document:
    """A job shop in which each operation belongs to a family of its machine."""
    rng = random.Random(seed)
    jobs, machines, families = rng.choice(
        ((10, 5, 3), (10, 10, 4), (15, 5, 5), (15, 10, 4), (20, 5, 4), (20, 10, 5))
    )
    names = [f"f{k}" for k in range(families)]
    resources = []
    for m in range(machines):
        times = {(a, b): rng.randint(10, 60) for a in names for b in names if a != b}
        rows = [
            {"from": a, "to": b, "time": t} for (a, b), t in sorted(closed(times, names).items())
        ]
        resources.append({"id": f"m{m}", "setups": {"times": rows}})
    actions, precedence = [], []
    for j in range(jobs):
        route = rng.sample(range(machines), machines)
        for k, m in enumerate(route):
            use = {"resource": f"m{m}", "family": rng.choice(names)}
            actions.append({"id": f"j{j} {k}", "duration": rng.randint(5, 99), "uses": [use]})
            if k:
                precedence.append([f"j{j} {k - 1}", f"j{j} {k}"])
    return {"resources": resources, "actions": actions, "precedence": precedence}


def single_machine(seed: int, jobs: int = 60) -> Document:
    """Weighted tardiness on one machine, with a set-up between any two jobs, no triangles kept."""
    rng = random.Random(seed)
    tightness, spread, severity = (
        rng.choice((0.3, 0.6, 0.9)),
        rng.choice((0.25, 0.75)),
        rng.choice((0.25, 0.75)),
    )
    names = [f"j{k}" for k in range(jobs)]
    rows = [
        {"from": a, "to": b, "time": rng.randint(0, int(200 * severity))}
        for a in (*names, "start")
        for b in names
        if a != b
    ]
    length = jobs * (100 + 100 * severity * 0.6)
    middle = length * (1 - tightness)
    actions = []
    for name in names:
        low = middle * (1 - spread) if rng.random() < tightness else middle
        high = middle if low < middle else middle + (length - middle) * spread
        actions.append(
            {
                "id": name,
                "duration": rng.randint(50, 150),
                "uses": [{"resource": "m", "family": name}],
                "due": rng.randint(int(low), int(high)),
                "weight": rng.randint(0, 10),
            }
        )
    return {
        "resources": [{"id": "m", "setups": {"initial": "start", "times": rows}}],
        "actions": actions,
        "objective": "minimize_tardiness",
    }


# --- the three ------------------------------------------------------------------------------------


def by_irc(document: Document, limit: Limit) -> Found:
    """irc, with a limit on all that it does."""
    begun = limit.now()
    cancel = Cancellation()
    limit.watch(cancel.cancel)
    task = Task.model_validate(document)
    schedule = irc.solve(task, time_limit=limit.on_the_clock, workers=limit.workers, cancel=cancel)
    took = limit.now() - begun
    if not schedule.answered:
        return Found(float("inf"), 0.0, took)
    level = schedule.objective[0]
    return Found(float(level.value), float(level.bound or 0), took)


def tables(document: Document) -> dict[str, Mapping[tuple[str, str], int]]:
    """The set-up time of each two families, by resource."""
    return {
        r["id"]: {(row["from"], row["to"]): row["time"] for row in r["setups"]["times"]}
        for r in document["resources"]
    }


def by_circuit(document: Document, limit: Limit) -> Found:
    """A CP-SAT model as one writes it by hand: a circuit and NoOverlap for each machine."""
    begun, clock = limit.now(), time.monotonic()
    model = cp_model.CpModel()
    actions = document["actions"]
    times = tables(document)
    horizon = sum(a["duration"] for a in actions)
    horizon += len(actions) * max(max(rows.values()) for rows in times.values())
    start = {a["id"]: model.new_int_var(0, horizon, a["id"]) for a in actions}
    end = {a["id"]: start[a["id"]] + a["duration"] for a in actions}
    for before, after in document.get("precedence", ()):
        model.add(start[after] >= end[before])
    for resource in document["resources"]:
        rows = times[resource["id"]]
        own = [a for a in actions if a["uses"][0]["resource"] == resource["id"]]
        family = {a["id"]: a["uses"][0]["family"] for a in own}
        model.add_no_overlap(
            [model.new_fixed_size_interval_var(start[a["id"]], a["duration"], "") for a in own]
        )
        arcs = []
        initial = resource["setups"].get("initial")
        for k, a in enumerate(own, 1):
            first, last = model.new_bool_var(""), model.new_bool_var("")
            arcs += [(0, k, first), (k, 0, last)]
            if initial is not None:
                model.add(start[a["id"]] >= rows[initial, family[a["id"]]]).only_enforce_if(first)
            for n, b in enumerate(own, 1):
                if n != k:
                    arc = model.new_bool_var("")
                    arcs.append((k, n, arc))
                    gap = rows.get((family[a["id"]], family[b["id"]]), 0)
                    model.add(start[b["id"]] >= end[a["id"]] + gap).only_enforce_if(arc)
        model.add_circuit(arcs)
    if document.get("objective") == "minimize_tardiness":
        late = []
        for a in actions:
            over = model.new_int_var(0, horizon, "")
            model.add(over >= end[a["id"]] - a["due"])
            late.append(a["weight"] * over)
        model.minimize(sum(late))
    else:
        makespan = model.new_int_var(0, horizon, "")
        for a in actions:
            model.add(makespan >= end[a["id"]])
        model.minimize(makespan)
    solver = cp_model.CpSolver()
    solver.parameters.num_workers = limit.workers
    left = limit.on_the_clock - (time.monotonic() - clock)
    solver.parameters.max_time_in_seconds = max(0.1, left)
    limit.watch(solver.stop_search)
    status = solver.solve(model)
    found = status in (cp_model.OPTIMAL, cp_model.FEASIBLE)
    value = solver.objective_value if found else float("inf")
    return Found(value, solver.best_objective_bound, limit.now() - begun)


class _EndingSolver(cp_model.CpSolver):
    """The solver that PyJobShop asks, which ends when its processor time is over."""

    limit: ClassVar[Limit] = Limit(0.0, 1, False)

    def solve(self, model: cp_model.CpModel, solution_callback: Any = None) -> Any:
        """Solves until the processor time is over."""
        self.limit.watch(self.stop_search)
        return super().solve(model, solution_callback)


def by_pyjobshop(document: Document, limit: Limit) -> Found:
    """PyJobShop's own model of the same instance."""
    from pyjobshop import Model

    begun, clock = limit.now(), time.monotonic()
    model = Model()
    machines = {r["id"]: model.add_machine(name=r["id"]) for r in document["resources"]}
    tardiness = document.get("objective") == "minimize_tardiness"
    tasks = {}
    for a in document["actions"]:
        if tardiness:
            job = model.add_job(weight=a["weight"], due_date=a["due"])
            tasks[a["id"]] = model.add_task(job, name=a["id"])
        else:
            tasks[a["id"]] = model.add_task(name=a["id"])
        model.add_mode(tasks[a["id"]], machines[a["uses"][0]["resource"]], a["duration"])
    for before, after in document.get("precedence", ()):
        model.add_end_before_start(tasks[before], tasks[after])
    times = tables(document)
    for resource in document["resources"]:
        rows = times[resource["id"]]
        own = [a for a in document["actions"] if a["uses"][0]["resource"] == resource["id"]]
        machine = machines[resource["id"]]
        initial = resource["setups"].get("initial")
        if initial is not None:  # It has no initial set-ups: a task without length stands first.
            origin = model.add_task(latest_end=0, name="origin")
            model.add_mode(origin, machine, 0)
            for b in own:
                gap = rows[initial, b["uses"][0]["family"]]
                model.add_setup_time(machine, origin, tasks[b["id"]], gap)
        for a in own:
            for b in own:
                gap = rows.get((a["uses"][0]["family"], b["uses"][0]["family"]), 0)
                if a is not b and gap:
                    model.add_setup_time(machine, tasks[a["id"]], tasks[b["id"]], gap)
    if tardiness:
        model.set_objective(weight_total_tardiness=1)
    else:
        model.set_objective(weight_makespan=1)
    left = max(0.1, limit.on_the_clock - (time.monotonic() - clock))
    _EndingSolver.limit = limit
    import_module("pyjobshop.solvers.ortools.CPModel").__dict__["CpSolver"] = _EndingSolver
    result = model.solve(time_limit=left, num_workers=limit.workers, display=False)
    return Found(float(result.objective), float(result.lower_bound), limit.now() - begun)


SOLVERS: dict[str, Callable[[Document, Limit], Found]] = {
    "irc": by_irc,
    "circuit": by_circuit,
    "pyjobshop": by_pyjobshop,
}


def compare(kind: str, instances: list[Document], limit: Limit) -> None:
    """Prints a line for each instance, and the mean gaps."""
    gaps: dict[str, list[float]] = {name: [] for name in SOLVERS}
    to_bound: dict[str, list[float]] = {name: [] for name in SOLVERS}
    for number, document in enumerate(instances):
        order = list(SOLVERS)
        order = order[number % 3 :] + order[: number % 3]
        found = {name: SOLVERS[name](document, limit) for name in order}
        best = min(answer.value for answer in found.values())
        for name, answer in found.items():
            gap = (answer.value - best) / best if best else float(answer.value > 0)
            gaps[name].append(gap if answer.value < float("inf") else 1.0)
            value = answer.value
            known = 0 < value < float("inf")
            to_bound[name].append((value - answer.bound) / value if known else float(value > 0))
        line = ", ".join(
            f"{name} {found[name].value:.0f} [{found[name].bound:.0f}] {found[name].seconds:.1f} s"
            for name in SOLVERS
        )
        print(f"{kind} {number}: {line}", flush=True)
    for name in SOLVERS:
        print(
            f"{kind}, {name}: mean gap to the best {100 * mean(gaps[name]):.2f} %, "
            f"to its own bound {100 * mean(to_bound[name]):.2f} %"
        )


def mean(values: list[float]) -> float:
    """The mean; not a number where there are no values."""
    return sum(values) / len(values) if values else float("nan")


# --- the factory ----------------------------------------------------------------------------------


def factory(path: Path) -> Document:
    """The factory whose paint booth is changed over by actions, with set-ups as a field instead."""
    document: Document = json.loads(path.read_text("utf-8"))
    (variable,) = document.pop("state")
    changes = [a for a in document["actions"] if a.get("effects")]
    booth = changes[0]["uses"][0]["resource"]
    rows = [
        {"from": a["conditions"][0]["value"], "to": a["effects"][0]["value"], "time": a["duration"]}
        for a in changes
    ]
    kept = [a for a in document["actions"] if not a.get("effects")]
    for action in kept:
        for condition in action.pop("conditions", ()):
            for use in action["uses"]:
                if use.get("resource") == booth:
                    use["family"] = condition["value"]
    document["actions"] = kept
    for resource in document["resources"]:
        if resource["id"] == booth:
            resource["setups"] = {"initial": variable["initial"], "times": rows}
    return document


def main() -> None:
    """Compares the three, or solves the factory."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--shops", type=int, default=30)
    parser.add_argument("--single", type=int, default=20)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--factory", type=Path)
    parser.add_argument("--processor", action="store_true", help="count processor time")
    options = parser.parse_args()
    limit = Limit(options.seconds, options.workers, options.processor)
    seeds = range(options.first, options.first + options.shops)
    compare("shop", [job_shop(s) for s in seeds], limit)
    seeds = range(options.first, options.first + options.single)
    compare("single", [single_machine(s) for s in seeds], limit)
    if options.factory is not None:
        document = factory(options.factory)
        schedule = irc.solve(
            Task.model_validate(document), time_limit=options.seconds, workers=options.workers
        )
        print(
            "factory:",
            ", ".join(f"{o.name} {o.value} (bound {o.bound})" for o in schedule.objective),
        )


if __name__ == "__main__":
    main()
