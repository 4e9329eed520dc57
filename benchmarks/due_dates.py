"""Weighted tardiness: irc against a plain CP-SAT model and PyJobShop, with equal processor time.

python benchmarks/due_dates.py [--count 10] [--seconds 10] [--workers 2] [--only FAMILY]

Made by formula are `--count` job shops (Taillard's), flexible job shops (in Brandimarte's manner),
projects (in ProGen's manner) and single machines. A job is due at its release plus its work times a
factor of 1.1 to 1.7 (the rule "total work content"); its last operation has the due date and a
weight of 1, 2 or 4 (20, 60 and 20 %, as in Singer and Pinedo, "A computational study of branch and
bound techniques for minimizing the total weighted tardiness in job shops", IIE Transactions 30,
1998). In projects the activities without a successor have one, and every fourth other one, from the
critical path; the due dates of single machines are those of Crauwels, Potts and Van Wassenhove
("Local search heuristics for the single machine total weighted tardiness scheduling problem",
INFORMS Journal on Computing 10, 1998).

Each competitor has `--seconds` of processor time for each worker, in turn, in this process; each
schedule is judged here by the rules of the league. A gap is (value - best) / best, and 1 where
the best is 0 and the value is not. PyJobShop must be installed.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from importlib import import_module
from pathlib import Path
from statistics import fmean
from typing import Any, ClassVar

from ortools.sat.python import cp_model

import irc
from irc.diagnostics import Findings
from irc.model.canonical import written_task
from irc.model.from_document import to_task
from irc.targets import Cancellation
from racing.gather import gather, instance_of
from racing.generate import Lehmer, flexible_text, job_shop, job_shop_text, project
from racing.instance import Instance, faults
from racing.plain import MODELS
from racing.spending import when_spent

MOST_PACE = 20
"""On a busy machine, a run gets up to that many times the wall-clock time."""

SHOPS = ((15, 10), (20, 10), (20, 15), (30, 10))
FLEXIBLE = ((10, 6, 6), (15, 8, 5), (20, 10, 5))
PROJECTS = ((60, 1.5, 0.5, 0.2), (90, 1.8, 0.75, 0.2), (120, 2.1, 1.0, 0.2))
SINGLE = (40, 60, 100)


@dataclass(frozen=True)
class Dated:
    """An instance with (due date, weight) of some jobs, and the same as a task's document."""

    instance: Instance
    dues: dict[int, tuple[int, int]]
    document: dict[str, Any]


@dataclass(frozen=True)
class Answer:
    """Starts and ways of all jobs; `bound` is what was proven."""

    starts: list[int]
    ways: list[int]
    bound: float
    cpu: float


# --- instances ------------------------------------------------------------------------------------


def instances(count: int) -> Iterator[tuple[str, Dated]]:
    """The instances by family."""
    draw = Lehmer(61803398)
    texts: dict[str, str] = {}
    for k in range(count):
        jobs, machines = SHOPS[k % len(SHOPS)]
        seeds = draw.whole(1, 2**31 - 2), draw.whole(1, 2**31 - 2)
        texts[f"shop_{k}.jsp"] = job_shop_text(job_shop(jobs, machines, *seeds))
        sizes = FLEXIBLE[k % len(FLEXIBLE)]
        texts[f"flexible_{k}.fjs"] = flexible_text(*sizes[:2], draw.whole(1, 2**31 - 2), sizes[2])
        setting = PROJECTS[k % len(PROJECTS)]
        texts[f"project_{k}.sm"] = project(*setting, draw.whole(1, 2**31 - 2))
    with tempfile.TemporaryDirectory() as name:
        for file, text in texts.items():
            (Path(name) / file).write_text(text, "utf-8")
        found = gather(Path(name)).instances
    for instance, task in found:
        yield instance.name.split("_")[0], with_dues(instance, json.loads(task), draw)
    for k in range(count):
        yield "single", single_machine(k, draw)


def with_dues(instance: Instance, document: dict[str, Any], draw: Lehmer) -> Dated:
    """The instance with due dates by the work of the longest chain that leads to each job."""
    n = len(instance.jobs)
    follows = {lag.before for lag in instance.lags}
    lasts = [fmean(way.duration for way in ways) for ways in instance.jobs]
    ends = list(lasts)
    for _ in range(n):
        before = list(ends)
        for lag in instance.lags:
            ends[lag.after] = max(ends[lag.after], ends[lag.before] + lag.least + lasts[lag.after])
        if ends == before:
            break
    is_project = instance.family == "rcpsp"
    factor = 1 + draw.whole(10, 70) / 100
    dues: dict[int, tuple[int, int]] = {}
    for i in range(n):
        if i not in follows or (is_project and draw.whole(0, 3) == 0):
            dues[i] = round(factor * ends[i]), (1, 2, 2, 2, 4)[draw.whole(0, 4)]
    return dated(instance, dues, document)


def dated(instance: Instance, dues: dict[int, tuple[int, int]], document: dict[str, Any]) -> Dated:
    """The instance with these due dates, in its document as well."""
    index = {id_: i for i, id_ in enumerate(instance.ids)}
    for action in document["actions"]:
        if (due := dues.get(index[action["id"]])) is not None:
            action["due"], action["weight"] = due
    document["objective"] = "minimize_tardiness"
    return Dated(instance, dues, document)


def single_machine(number: int, draw: Lehmer) -> Dated:
    """Jobs with weights of 1 to 10 on one machine, by the range and the tardiness of due dates."""
    n = SINGLE[number % len(SINGLE)]
    spread = (0.2, 0.6, 1.0)[draw.whole(0, 2)]
    tardy = (0.4, 0.6, 0.8)[draw.whole(0, 2)]
    durations = [draw.whole(1, 100) for _ in range(n)]
    total = sum(durations)
    low, high = (max(0, round(total * (1 - tardy + s * spread / 2))) for s in (-1, 1))
    releases = [draw.whole(0, total // 2) if number % 2 else 0 for _ in range(n)]
    actions = [
        {"id": f"j{k}", "duration": d, "release": releases[k], "uses": [{"resource": "m"}]}
        for k, d in enumerate(durations)
    ]
    document = {"resources": [{"id": "m"}], "actions": actions}
    task = to_task(document, Findings())
    if task is None:
        raise ValueError("the generator wrote a task with faults")
    instance = instance_of(f"single_{number}", task)
    dues = {k: (releases[k] + draw.whole(low, high), draw.whole(1, 10)) for k in range(n)}
    return dated(instance, dues, written_task(task))


def releases_of(given: Dated) -> list[int]:
    """The release of each job."""
    by_id = {a["id"]: a.get("release", 0) for a in given.document["actions"]}
    return [by_id[id_] for id_ in given.instance.ids]


# --- competitors ----------------------------------------------------------------------------------


def by_irc(given: Dated, seconds: float, workers: int) -> Answer | None:
    """irc, with checks, bounds and validation."""
    began = time.process_time()
    cancel = Cancellation()
    when_spent(began + seconds * workers, cancel.cancel)
    task = irc.Task.from_dict(given.document)
    schedule = task.solve(time_limit=MOST_PACE * seconds, workers=workers, cancel=cancel)
    if not schedule.answered:
        return None
    entries = {entry.id: entry for entry in schedule.entries}
    starts, ways = [], []
    for id_, own in zip(given.instance.ids, given.instance.jobs, strict=True):
        taken = {entries[id_].mode, *entries[id_].resources}
        starts.append(int(entries[id_].start))
        ways.append(next((k for k, way in enumerate(own) if way.id in taken), 0))
    bound = float(schedule.objective[0].bound or 0)
    return Answer(starts, ways, bound, time.process_time() - began)


def by_plain(given: Dated, seconds: float, workers: int) -> Answer | None:
    """The plain model of the league, for weighted tardiness instead of the makespan."""
    began = time.process_time()
    raw = asdict(given.instance)
    model, starts, literals = MODELS[raw["family"]](raw)
    horizon = 2 * sum(max(w["duration"] for w in ways) for ways in raw["jobs"])
    for start, release in zip(starts, releases_of(given), strict=True):
        model.add(start >= release)
    late = []
    for i, (due, weight) in given.dues.items():
        own = zip(raw["jobs"][i], literals[i] or [1], strict=True)
        over = model.new_int_var(0, horizon, "")
        model.add(over >= starts[i] + sum(w["duration"] * x for w, x in own) - due)
        late.append(weight * over)
    model.clear_objective()  # type: ignore[no-untyped-call]
    model.minimize(sum(late))
    solver = cp_model.CpSolver()
    solver.parameters.max_time_in_seconds = MOST_PACE * seconds
    solver.parameters.num_workers = workers
    when_spent(began + seconds * workers, solver.stop_search)
    if solver.solve(model) not in (cp_model.OPTIMAL, cp_model.FEASIBLE):
        return None
    return Answer(
        [solver.value(start) for start in starts],
        [next((k for k, x in enumerate(own) if solver.value(x)), 0) for own in literals],
        solver.best_objective_bound,
        time.process_time() - began,
    )


class _EndingSolver(cp_model.CpSolver):
    """The solver that PyJobShop asks, which ends when its processor time is over."""

    over_at: ClassVar[float] = 0.0

    def solve(self, model: cp_model.CpModel, solution_callback: Any = None) -> Any:
        """Solves until the processor time is over."""
        when_spent(self.over_at, self.stop_search)
        return super().solve(model, solution_callback)


def by_pyjobshop(given: Dated, seconds: float, workers: int) -> Answer | None:
    """PyJobShop's own model: what has a due date is a job of its own."""
    from pyjobshop import Model

    began = time.process_time()
    _EndingSolver.over_at = began + seconds * workers
    import_module("pyjobshop.solvers.ortools.CPModel").__dict__["CpSolver"] = _EndingSolver
    instance, model = given.instance, Model()
    machines = instance.family in ("job-shop", "flexible")
    resources = [
        model.add_machine() if machines else model.add_renewable(capacity=capacity)
        for capacity in instance.capacities
    ]
    tasks, first = [], [0]
    for i, (ways, release) in enumerate(zip(instance.jobs, releases_of(given), strict=True)):
        due = given.dues.get(i)
        job = None if due is None else model.add_job(weight=due[1], due_date=due[0])
        tasks.append(model.add_task(job, earliest_start=release))
        first.append(first[-1] + len(ways))
        for way in ways:
            held = [resources[r] for r, _ in way.holds]
            amounts = None if machines else [n for _, n in way.holds]
            model.add_mode(tasks[-1], held, way.duration, amounts)
    for lag in instance.lags:
        model.add_end_before_start(tasks[lag.before], tasks[lag.after], delay=lag.least)
    model.set_objective(weight_total_tardiness=1)
    limit = MOST_PACE * seconds
    result = model.solve(time_limit=limit, num_workers=workers, display=False)
    if not result.best.tasks:
        return None
    places = result.best.tasks
    return Answer(
        [task.start for task in places],
        [task.mode - first[i] for i, task in enumerate(places)],
        result.lower_bound,
        time.process_time() - began,
    )


COMPETITORS: dict[str, Callable[[Dated, float, int], Answer | None]] = {
    "irc": by_irc,
    "plain": by_plain,
    "pyjobshop": by_pyjobshop,
}


# --- figures --------------------------------------------------------------------------------------


def judged(given: Dated, answer: Answer | None) -> int | None:
    """The weighted tardiness of an answer; None without one. Raises `ValueError` at a fault."""
    if answer is None:
        return None
    found = faults(given.instance, answer.starts, answer.ways)
    early = zip(answer.starts, releases_of(given), strict=True)
    if found or any(start < release for start, release in early):
        raise ValueError(f"{given.instance.name}: {found or 'a job starts before its release'}")
    total = 0
    for i, (due, weight) in given.dues.items():
        end = answer.starts[i] + given.instance.jobs[i][answer.ways[i]].duration
        total += weight * max(0, end - due)
    if answer.bound > total + 1e-6:
        raise ValueError(f"{given.instance.name}: bound {answer.bound} above {total}")
    return total


def gap_of(value: int | None, best: int) -> float:
    """How far a value is above the best one."""
    if value is None:
        return 1.0
    return (value - best) / best if best else float(value > 0)


def main() -> None:
    """Races the three, and prints a line for each instance and family."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=10, help="instances of each family")
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--only", default="", help="families whose name contains this")
    options = parser.parse_args()
    gaps: dict[tuple[str, str], list[float]] = {}
    for number, (family, given) in enumerate(instances(options.count)):
        if options.only not in family:
            continue
        order = [*COMPETITORS]
        order = order[number % 3 :] + order[: number % 3]
        answers = {n: COMPETITORS[n](given, options.seconds, options.workers) for n in order}
        values = {name: judged(given, answer) for name, answer in answers.items()}
        best = min((v for v in values.values() if v is not None), default=0)
        shown = []
        for name in COMPETITORS:
            answer = answers[name]
            for key in (family, name), ("all", name):
                gaps.setdefault(key, []).append(gap_of(values[name], best))
            bound = "-" if answer is None else f"{answer.bound:.0f} {answer.cpu:.1f} s"
            shown.append(f"{name} {values[name]} [{bound}]")
        print(f"{given.instance.name}: {', '.join(shown)}", flush=True)
    for (family, name), found in sorted(gaps.items()):
        print(f"{family}, {name}: mean gap {100 * fmean(found):.2f} % of {len(found)}")


if __name__ == "__main__":
    main()
