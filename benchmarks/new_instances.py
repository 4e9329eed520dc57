"""`irc generate`: statistics, gold answers and texts of new instances.

    python benchmarks/new_instances.py [asyncplan] [robo] [--seeds N] [--count 50] [--sizes N …]

`asyncplan`: for each size and seed, how many standard errors the means of 50 graphs are from those
of AsyncPlan-XXL, and the ratio of the deviations of the number of edges; whether each gold answer
is what CP-SAT proves without the shortcut; whether the English front end reads the same edges and
durations from each text. `robo`: the mean optimum of each axis, and how many gold answers are those
of the exact oracle, a model of its own; of the episodes, how many the strict judge approves when
`irc simulate` runs them, and how many of those are as good as with all events known.
"""

from __future__ import annotations

import argparse
import json
import statistics
import sys
import time
from fractions import Fraction
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from generators.test_asyncplan import edges_of, imported, read_back, seconds_of
from generators.test_kitchens import episode_of, task_of
from irc.driver.solve import solve_task
from irc.execution import simulate
from irc.generators.asyncplan import GeneratedPlan, generate_plan, plan_document
from irc.generators.dag import TABLE, Measured
from irc.generators.gold import with_oracle
from irc.generators.kitchens import AXES
from irc.targets import SolveOptions
from oracles.online_robo import judge
from oracles.online_robo_best import continuation
from oracles.online_robo_kitchen import initial

FORCED = SolveOptions(shortcut=False, workers=1)


def deviations(row: Measured, plans: list[GeneratedPlan]) -> dict[str, float]:
    """The distance of each mean from the data's, in standard errors of the data's mean."""
    found = {
        "edges": [len(plan.dag.edges) for plan in plans],
        "longest": [plan.dag.longest for plan in plans],
        "joins": [plan.dag.joins for plan in plans],
        "parallelism": [sum(plan.durations) / plan.makespan for plan in plans],
    }
    errors = {}
    for name, values in found.items():
        mean, deviation = getattr(row, name)
        errors[name] = (statistics.fmean(values) - mean) / (deviation / len(plans) ** 0.5)
    errors["edges' deviation"] = statistics.stdev(found["edges"]) / row.edges[1]
    return errors


def asyncplan(sizes: list[int], seeds: int, count: int) -> None:
    """A line for each size and seed, and the totals."""
    beyond = cells = gold = texts = total = 0
    for row in (row for row in TABLE if row.size in sizes):
        for seed in range(1, seeds + 1):
            plans = [generate_plan(row.size, seed, index) for index in range(count)]
            errors = deviations(row, plans)
            ratio = errors.pop("edges' deviation")
            beyond += sum(abs(error) > 2 for error in errors.values())
            cells += len(errors)
            for plan in plans:
                document = plan_document(plan)
                task, read = imported(document), read_back(document)
                schedule = solve_task(task, FORCED).schedule
                gold += (schedule.status, schedule.makespan) == ("optimal", document["answer"])
                same = edges_of(read) == edges_of(task)
                texts += same and seconds_of(read) == seconds_of(task)
                total += 1
            shown = ", ".join(f"{name} {error:+.1f}" for name, error in errors.items())
            print(
                f"{row.size:4} seed {seed}: {shown}; deviation of edges × {ratio:.2f}", flush=True
            )
    print(
        f"{cells} means, {beyond} beyond two standard errors; of {total} instances "
        f"{gold} gold = CP-SAT, {texts} texts read back"
    )


def robo(count: int) -> None:
    """A line for each axis."""
    for axis in AXES:
        optima, ratios, equal, approved, reached = [], [], 0, 0, 0
        began = time.perf_counter()
        for index in range(count):
            document, episode = episode_of(axis, 1, index)
            optima.append(float(document["optimal_makespan"]))
            ratios.append(document.get("speedup_ratio", 0))
            start = {**episode["initial_task"], "deadline": document.get("deadline")}
            best = continuation(initial(start), {}, Fraction(0), 60)
            gold = document.get("optimal_reward"), document["optimal_makespan"]
            equal += best is not None and best.worth == gold
            episode = with_oracle(episode, 60)
            oracle = episode["oracle"]
            simulation = simulate(task_of(episode), workers=1, time_limit=20)
            verdict = judge(json.loads(json.dumps(episode)), simulation.to_dict())
            approved += verdict.approved
            final = oracle.get("oracle_final_reward"), oracle["oracle_final_makespan"]
            reached += verdict.optima[-1] == final
        print(
            f"{axis}: {count} kitchens, optimum {statistics.fmean(optima):.2f}, sequential / "
            f"optimal {statistics.fmean(ratios):.2f}, {equal} = oracle; episodes: {approved} "
            f"approved, {reached} as good as with all events known; "
            f"{time.perf_counter() - began:.0f} s",
            flush=True,
        )


def main() -> None:
    """Measures what is named, or both."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("parts", nargs="*", help="asyncplan, robo")
    parser.add_argument("--sizes", type=int, nargs="*", default=[row.size for row in TABLE])
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--count", type=int, default=50)
    parser.add_argument("--kitchens", type=int, default=10)
    options = parser.parse_args()
    parts = options.parts or ["asyncplan", "robo"]
    if "asyncplan" in parts:
        asyncplan(options.sizes, options.seeds, options.count)
    if "robo" in parts:
        robo(options.kitchens)


if __name__ == "__main__":
    main()
