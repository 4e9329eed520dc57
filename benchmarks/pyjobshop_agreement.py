"""Random problems of PyJobShop, solved by itself and through irc's importer: equal optima.

They have the constraints on orders, selections and dates that the importer has to say in other
words, or (`--kind resources`) resources of all kinds with breaks, tasks that pause or idle, modes
that take nothing, set-ups, and dependent choices. Needs PyJobShop (the extra `league`).

Run: python -m benchmarks.pyjobshop_agreement --problems 300 [--kind resources]
"""

from __future__ import annotations

import argparse
import json
import random
import sys
import time
from collections import Counter
from typing import Any

import irc
from irc.diagnostics import InputError
from irc.frontends.importers.pyjobshop import import_pyjobshop

Document = dict[str, Any]

_OBJECTIVES = ("weight_makespan", "weight_total_tardiness", "weight_tardy_jobs")


def random_problem(seed: int) -> Document:
    """A problem of 3 to 5 tasks on two machines."""
    rng = random.Random(seed)
    count = rng.randint(3, 5)
    flow = rng.random() < 0.5
    if flow:
        count = 4 if count < 5 else 6
    tasks: list[Document] = []
    modes: list[Document] = []
    for k in range(count):
        task: Document = {"optional": rng.random() < 0.35}
        if rng.random() < 0.3:
            task["earliest_start"] = rng.randint(0, 4)
        tasks.append(task)
        machines = [k % 2] if flow else rng.choice(([0], [1], [0, 1]))
        modes += [
            {"task": k, "resources": [machine], "duration": rng.randint(1, 4)}
            for machine in machines
        ]
    constraints: Document = {}
    if flow:
        row: Document = {"machine1": 0, "machine2": 1}
        if rng.random() < 0.5:
            users = [[k for k in range(count) if k % 2 == m] for m in (0, 1)]
            rng.shuffle(users[1])
            row |= {"tasks1": users[0], "tasks2": users[1]}
        constraints["same_sequence"] = [row]
    pairs = [(a, b) for a in range(count) for b in range(count) if a != b]
    for key, chance in (("consecutive", 0.6), ("end_before_start", 0.6)):
        if rng.random() < chance:
            chosen = rng.sample(pairs, rng.randint(1, 2))
            constraints[key] = [{"task1": a, "task2": b} for a, b in chosen]
    for key in ("select_all_or_none", "select_at_least_one", "select_exactly_one"):
        if rng.random() < 0.4:
            row = {"tasks": rng.sample(range(count), 2)}
            if rng.random() < 0.5:
                row["condition_task"] = rng.randrange(count)
            constraints[key] = [row]
    jobs: list[Document] = []
    if rng.random() < 0.7:
        jobs = [{"weight": rng.randint(1, 3)} for _ in range(2)]
        for job in jobs:
            if rng.random() < 0.8:
                job["due_date"] = rng.randint(0, 6)
            if rng.random() < 0.2:
                job["deadline"] = rng.randint(8, 12)
        for task in tasks:
            task["job"] = rng.randrange(2)
    objective = {rng.choice(_OBJECTIVES if jobs else _OBJECTIVES[:1]): rng.randint(1, 3)}
    if any("due_date" not in job for job in jobs):
        objective = {"weight_makespan": 1}
    return {
        "jobs": jobs,
        "resources": [{"type": "machine"}, {"type": "machine"}],
        "tasks": tasks,
        "modes": modes,
        "constraints": constraints,
        "objective": objective,
    }


def random_resources(seed: int) -> Document:
    """A problem of 3 to 4 tasks on a machine, a renewable resource and a stock."""
    rng = random.Random(seed)
    count = rng.randint(3, 4)
    resources: list[Document] = [
        {"type": "machine"},
        {"type": "renewable", "capacity": rng.randint(1, 3)},
        {"type": "consumable", "capacity": rng.randint(2, 6)},
    ]
    for resource in resources:
        if rng.random() < 0.5:
            begin = rng.randint(0, 4)
            resource["breaks"] = [[begin, begin + rng.randint(1, 3)]]
            if rng.random() < 0.4:
                again = resource["breaks"][0][1] + rng.randint(1, 3)
                resource["breaks"].append([again, again + rng.randint(1, 3)])
    if "breaks" not in resources[0] and rng.random() < 0.3:
        resources[0]["no_idle"] = True
    tasks: list[Document] = []
    for _ in range(count):
        task: Document = {}
        for flag, chance in (("allow_breaks", 0.4), ("allow_idle", 0.25), ("optional", 0.1)):
            if rng.random() < chance:
                task[flag] = True
        if rng.random() < 0.3:
            task["earliest_start"] = rng.randint(0, 4)
        if rng.random() < 0.2:
            task["earliest_end"] = rng.randint(4, 12)
        if rng.random() < 0.15:
            task["latest_start"] = rng.randint(4, 8)
        tasks.append(task)
    modes: list[Document] = []
    for k in range(count):
        for _ in range(rng.randint(1, 2)):
            used = sorted(rng.sample(range(3), rng.randint(1, 2)))
            demands = [rng.randint(0, min(2, resources[r].get("capacity", 0))) for r in used]
            mode = {"task": k, "resources": used, "duration": rng.randint(1, 4)}
            modes.append(mode | {"demands": demands})
    constraints: Document = {}
    pairs = [(a, b) for a in range(count) for b in range(count) if a != b]
    if rng.random() < 0.4:
        constraints["setup_times"] = [
            {"machine": 0, "task1": a, "task2": b, "duration": rng.randint(1, 3)}
            for a, b in rng.sample(pairs, 3)
        ]
    for key, chance in (
        *(("end_before_start", 0.5), ("start_at_start", 0.15), ("end_before_end", 0.2)),
        *(("identical_resources", 0.15), ("different_resources", 0.15)),
    ):
        if rng.random() < chance:
            a, b = rng.choice(pairs)
            constraints[key] = [{"task1": a, "task2": b}]
    return {
        "jobs": [],
        "resources": resources,
        "tasks": tasks,
        "modes": modes,
        "constraints": constraints,
        "objective": {"weight_makespan": 1},
    }


def by_pyjobshop(document: Document) -> int | None:
    """The optimum by PyJobShop's own model; None: infeasible."""
    from pyjobshop import Model

    model = Model()
    used = {task.get("job") for task in document["tasks"]}
    jobs = [model.add_job(**job) if j in used else None for j, job in enumerate(document["jobs"])]
    machines = [_resource(model, resource) for resource in document["resources"]]
    tasks = [
        model.add_task(
            job=None if task.get("job") is None else jobs[task["job"]],
            **{key: value for key, value in task.items() if key != "job"},
        )
        for task in document["tasks"]
    ]
    for mode in document["modes"]:
        chosen = [machines[k] for k in mode["resources"]]
        model.add_mode(tasks[mode["task"]], chosen, mode["duration"], mode.get("demands"))
    for key, rows in document["constraints"].items():
        for row in rows:
            given = {
                name: [tasks[k] for k in value]
                if isinstance(value, list)
                else value
                if name == "duration"
                else (machines if name.startswith("machine") else tasks)[value]
                for name, value in row.items()
            }
            getattr(model, f"add_{key.removesuffix('s') if key == 'setup_times' else key}")(**given)
    model.set_objective(**document["objective"])
    result = model.solve(display=False, num_workers=1, time_limit=30)
    if str(result.status.value).lower() == "infeasible":
        return None
    if str(result.status.value).lower() != "optimal":
        raise RuntimeError(f"PyJobShop says {result.status}")
    return round(result.objective)


def _resource(model: Any, resource: Document) -> Any:
    """Adds a resource to a model of PyJobShop."""
    more = {key: value for key, value in resource.items() if key != "type"}
    if "breaks" in more:
        more["breaks"] = [tuple(span) for span in more["breaks"]]
    return getattr(model, f"add_{resource['type']}")(**more)


def through_irc(document: Document) -> int | str | None:
    """The optimum through the importer; None: infeasible; a text: refused."""
    try:
        ((_, task),) = import_pyjobshop(json.dumps(document), "problem.json")
    except InputError as refusal:
        return str(refusal.report.errors[0].message)
    if not irc.check(task).ok:
        if {d.code.id[:4] for d in irc.check(task).errors} != {"IRC3"} and "IRC219" not in {
            d.code.id for d in irc.check(task).errors
        }:
            raise RuntimeError(str(irc.check(task)))
        return None
    schedule = irc.solve(task, time_limit=30, workers=1)
    if not schedule.answered:
        return None if str(schedule.status) == "infeasible" else str(schedule.status)
    (weight,) = document["objective"].values()
    return int(schedule.objective[0].value) * int(weight)


def main() -> int:
    """Prints how many agree, how many are refused, and each that differs."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--problems", type=int, default=300)
    parser.add_argument("--first-seed", type=int, default=0)
    parser.add_argument("--kind", choices=["orders", "resources"], default="orders")
    chosen = parser.parse_args()
    generate = random_problem if chosen.kind == "orders" else random_resources
    seen: Counter[str] = Counter()
    began = time.perf_counter()
    for seed in range(chosen.first_seed, chosen.first_seed + chosen.problems):
        document = generate(seed)
        expected = by_pyjobshop(document)
        found = through_irc(document)
        if isinstance(found, str):
            seen[f"refused: {found}"] += 1
        elif found == expected:
            seen["infeasible" if found is None else "equal"] += 1
        else:
            seen["different"] += 1
            print(f"{seed}: {found} instead of {expected}: {json.dumps(document)}")
    for how, count in sorted(seen.items()):
        print(f"{count:5} {how}")
    print(f"{time.perf_counter() - began:.0f} s")
    return 1 if seen["different"] else 0


if __name__ == "__main__":
    sys.exit(main())
