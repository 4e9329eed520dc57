"""Measures `irc explain` on infeasible tasks of 100 actions that share resources.

    python benchmarks/explain.py [--limit 60] [--tasks 3] [--unchecked]
    python benchmarks/explain.py --combined 60 [--first SEED]
    python benchmarks/explain.py --late 20

Five families, three tasks each: jobs on stations and robots with a deadline one tick too early; the
same with enough time, but three jobs of one station in a window too small for them; job shops with
less time than their busiest station needs; crews with amounts and two deliveries at the same fixed
time; batches whose steps may not wait. Each conflict is checked again, statement by statement, by
solving the rest of the task's document.

With `--combined` the tasks are small and random, with two or three features each (calendars, modes,
stock, state, choices), and brute force has found them impossible. With `--late` late jobs of random
shops are explained, and each change that is suggested is verified by solving again.
"""

from __future__ import annotations

import argparse
import itertools
import json
import random
import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from irc.explanation import Explanation, explain_task
from irc.model import Task
from oracles.conflicts import faults_of
from oracles.element_conflicts import faults_of_elements, impossible
from oracles.generators import contended_task
from oracles.late_work import faults_of as late_faults_of
from oracles.late_work import shop

Document = dict[str, Any]


def too_little_time(rng: random.Random) -> Document:
    """Contended jobs with one tick less than the work of their robots takes."""
    document = _contended(rng)
    robots = sum("robot" in r["id"] for r in document["resources"])
    work = sum(a["duration"] for a in document["actions"] if any("one_of" in u for u in a["uses"]))
    return {**document, "deadline": -(-work // robots) - 1}


def crowded_window(rng: random.Random) -> Document:
    """Contended jobs with enough time, except for three of one station."""
    document = _contended(rng)
    station = rng.choice([r["id"] for r in document["resources"] if "station" in r["id"]])
    capacity = next(r["capacity"] for r in document["resources"] if r["id"] == station)
    actions = document["actions"]
    for action in rng.sample(actions, 2 * capacity + 1):
        action["uses"] = [{"resource": station}]
        action["duration"] = 6
        action["release"] = 40
        action["deadline"] = 55
    names = {a["id"] for a in actions if "release" in a}
    document["precedence"] = [
        p for p in document["precedence"] if not {p["before"], p["after"]} & names
    ]
    return document


def job_shop(rng: random.Random) -> Document:
    """20 jobs of 5 steps with one tick less than the busiest station needs."""
    work = [0] * 5
    actions: list[Document] = []
    precedence: list[Document] = []
    for j in range(20):
        order = rng.sample(range(5), 5)
        for k, station in enumerate(order):
            length = rng.randint(1, 20)
            work[station] += length
            uses = [{"resource": f"station {station}"}]
            actions.append({"id": f"job {j} step {k}", "duration": length, "uses": uses})
            if k:
                precedence.append({"before": f"job {j} step {k - 1}", "after": f"job {j} step {k}"})
    resources = [{"id": f"station {s}"} for s in range(5)]
    parts = {"resources": resources, "actions": actions, "precedence": precedence}
    return {**parts, "deadline": max(work) - 1}


def fixed_deliveries(rng: random.Random) -> Document:
    """Crews with amounts, and two fixed starts that collide."""
    actions: list[Document] = []
    precedence = []
    for i in range(100):
        uses = [{"resource": rng.choice("abc"), "amount": rng.randint(1, 3)}]
        actions.append({"id": f"step {i}", "duration": rng.randint(1, 9), "uses": uses})
        if i and rng.random() < 0.5:
            precedence.append([f"step {rng.randrange(i)}", f"step {i}"])
    uses = [{"resource": "a", "amount": 3}]
    actions[20] |= {"start": 200, "duration": 10, "uses": uses}
    actions[70] |= {"start": 205, "duration": 10, "uses": uses}
    precedence = [p for p in precedence if not {"step 20", "step 70"} & {*p}]
    resources = [{"id": name, "capacity": 5} for name in "abc"]
    return {"resources": resources, "actions": actions, "precedence": precedence}


def no_wait(rng: random.Random) -> Document:
    """25 batches of 4 steps without a wait between them, the mixer's time cut by one."""
    actions: list[Document] = []
    precedence = []
    work = 0
    for b in range(25):
        for k, station in enumerate(("mixer", "oven", "cooler", "packer")):
            length = rng.randint(5, 9) if station == "mixer" else rng.randint(1, 5)
            work += length if station == "mixer" else 0
            uses = [{"resource": station}]
            actions.append({"id": f"{station} {b}", "duration": length, "uses": uses})
            if k:
                before = actions[-2]["id"]
                precedence.append({"before": before, "after": f"{station} {b}", "max_lag": 1})
    resources = [{"id": s} for s in ("mixer", "oven", "cooler", "packer")]
    parts = {"resources": resources, "actions": actions, "precedence": precedence}
    return {**parts, "deadline": work + 2}


def _contended(rng: random.Random) -> Document:
    task = contended_task(rng, 100)
    return task.model_dump(mode="json", by_alias=True, exclude_unset=True)


FAMILIES: tuple[Callable[[random.Random], Document], ...] = (
    too_little_time,
    crowded_window,
    job_shop,
    fixed_deliveries,
    no_wait,
)


def _checked(task: Task, found: Explanation) -> str:
    if not found.conflict:
        return "NO CONFLICT"
    return "; ".join(faults_of(task, found)) or "verified by removal"


def combined(count: int, first: int, limit: float) -> None:
    """Prints what is wrong with the conflicts of random tasks, and how many are right."""
    right, taken = 0, []
    for document in itertools.islice(impossible(itertools.count(first)), count):
        began = time.perf_counter()
        found = explain_task(Task.model_validate(document), limit)
        taken.append(time.perf_counter() - began)
        faults = faults_of_elements(document, found)
        right += not faults
        if faults:
            print(json.dumps(document), faults, flush=True)
    median, most = statistics.median(taken), max(taken)
    print(f"{right}/{count} minimal by removal; median {median:.2f} s, max {most:.2f} s")


def late_work(count: int, first: int) -> None:
    """Prints what is wrong with the explanations of late jobs, and how many there were."""
    explained, wrong = 0, []
    for seed in itertools.count(first):
        faults, late = late_faults_of(shop(seed))
        explained += late
        wrong += faults
        if explained >= count:
            break
    print(f"{explained} late jobs explained; faults: {wrong or 'none'}")


def main() -> None:
    """Prints a line for each task, and the median and greatest time."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--limit", type=float, default=60.0)
    parser.add_argument("--tasks", type=int, default=3, help="of each family")
    parser.add_argument("--unchecked", action="store_true", help="without the check by removal")
    parser.add_argument("--combined", type=int, help="so many random tasks with several features")
    parser.add_argument("--late", type=int, help="so many late jobs of random shops")
    parser.add_argument("--first", type=int, default=0, help="the first seed of --combined")
    options = parser.parse_args()
    if options.combined is not None:
        combined(options.combined, options.first, options.limit)
        return
    if options.late is not None:
        late_work(options.late, options.first)
        return
    taken = []
    for draw in FAMILIES:
        for seed in range(options.tasks):
            task = Task.model_validate(draw(random.Random(seed)))
            began, began_cpu = time.perf_counter(), time.process_time()
            found = explain_task(task, options.limit)
            seconds = time.perf_counter() - began
            cpu = time.process_time() - began_cpu
            taken.append((seconds, cpu))
            said = "not checked" if options.unchecked else _checked(task, found)
            minimal = "minimal" if found.minimal else "NOT PROVEN MINIMAL"
            print(
                f"{draw.__name__} {seed}: {seconds:.2f} s (CPU {cpu:.2f} s), {found.status} "
                f"by {found.by}, {len(found.conflict)} statements, {minimal}; {said}",
                flush=True,
            )
    for what, times in zip(("wall clock", "CPU"), zip(*taken, strict=True), strict=True):
        median, most = statistics.median(times), max(times)
        print(f"{len(taken)} tasks, {what}: median {median:.2f} s, max {most:.2f} s")


if __name__ == "__main__":
    main()
