"""Measures contended tasks of 10,000 and 100,000 activities: whole `irc solve` processes.

    python benchmarks/large.py [--limits 60 300] [--names shop_100x100 project_10000 ...]
        [--processor] [--alone]

Job shops are by Taillard's formula; projects have four resources and, as in ProGen, one to three
predecessors for an activity, among the sixty before it. By default each of 10,000 activities has
60 s, each of 100,000 has 300 s. Printed are makespan, proven bound and gap, wall-clock and
processor time, and peak memory. With `--processor` the clock of the time limits is the processor
time of the process, so that a busy machine changes nothing; with `--alone` only the search is
measured: lists and windows in this process, until they have used the limit in processor time.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from irc.driver.compile import lower_for
from irc.frontends.files import read_task
from irc.local_search.search import search_of
from irc.targets import get_backend
from racing.generate import Lehmer, job_shop, job_shop_text
from size import measure

SHOPS = {"shop_100x100": (100, 100), "shop_500x20": (500, 20), "shop_1000x100": (1000, 100)}
LIMITS = (60.0, 300.0)
"""The seconds for 10,000 activities, and for more."""
PROJECTS = {
    "project_10000": (10_000, 0.05),
    "project_100000": (100_000, 0.05),
    "project_100000_ample": (100_000, 0.2),
}
"""The activities, and the strength of the resources: see `project`."""
REACH = 60
"""A predecessor is at most so many activities earlier: ProGen's networks of 100,000 would have no
end of parallel work."""


def project(activities: int, seed: int, strength: float, complexity: float = 1.8) -> dict[str, Any]:
    """A project in the manner of ProGen: see `racing.generate.project`; each takes two resources.

    `strength` is between capacities as small as can be and the peak of the earliest schedule.
    """
    draw = Lehmer(seed)
    durations = [draw.whole(1, 10) for _ in range(activities)]
    requests = [_requests(draw) for _ in range(activities)]
    arcs = _arcs(draw, activities, complexity)
    starts = [0] * activities
    for i, j in sorted(arcs, key=lambda arc: arc[1]):
        starts[j] = max(starts[j], starts[i] + durations[i])
    capacities = [
        10 + round(strength * (_peak(starts, durations, [q[r] for q in requests]) - 10))
        for r in range(4)
    ]
    return {
        "resources": [{"id": f"R{r}", "capacity": c} for r, c in enumerate(capacities)],
        "actions": [
            {
                "id": f"a{i}",
                "duration": durations[i],
                "uses": [{"resource": f"R{r}", "amount": n} for r, n in enumerate(q) if n],
            }
            for i, q in enumerate(requests)
        ],
        "precedence": [{"before": f"a{i}", "after": f"a{j}"} for i, j in sorted(arcs)],
    }


def _requests(draw: Lehmer) -> list[int]:
    left = [0, 1, 2, 3]
    chosen = [left.pop(draw.whole(0, len(left) - 1)) for _ in range(2)]
    return [draw.whole(1, 10) if r in chosen else 0 for r in range(4)]


def _arcs(draw: Lehmer, n: int, complexity: float) -> set[tuple[int, int]]:
    """Precedences from lower to higher numbers: at most three from and three to an activity."""
    arcs: set[tuple[int, int]] = set()
    after, before = [0] * n, [0] * n

    def add(i: int, j: int) -> bool:
        if after[i] >= 3 or before[j] >= 3 or (i, j) in arcs:
            return False
        arcs.add((i, j))
        after[i] += 1
        before[j] += 1
        return True

    for j in range(3, n):
        any(add(draw.whole(max(0, j - REACH), j - 1), j) for _ in range(9))
    for _ in range(50 * n):
        if len(arcs) >= complexity * n:
            break
        i = draw.whole(0, n - 2)
        add(i, draw.whole(i + 1, min(n - 1, i + REACH)))
    return arcs


def _peak(starts: list[int], durations: list[int], amounts: list[int]) -> int:
    changes: dict[int, int] = {}
    for start, duration, amount in zip(starts, durations, amounts, strict=True):
        changes[start] = changes.get(start, 0) + amount
        changes[start + duration] = changes.get(start + duration, 0) - amount
    used = most = 0
    for time_ in sorted(changes):
        used += changes[time_]
        most = max(most, used)
    return most


def written(name: str, folder: Path) -> Path:
    """The file of an instance, as JSON or in the format of job shops."""
    if name in SHOPS:
        jobs, machines = SHOPS[name]
        path = folder / f"{name}.jsp"
        shop = job_shop(jobs, machines, 840612802 + jobs, 398197754 + machines)
        path.write_text(job_shop_text(shop))
        return path
    size, strength = PROJECTS[name]
    path = folder / f"{name}.json"
    path.write_text(json.dumps(project(size, 840612802 + size, strength)))
    return path


PROCESSOR_CLOCK = """
import time
from irc.targets import budget
budget.seconds_since_start = lambda waited=False: time.process_time()
budget.Budget.__init__.__kwdefaults__["clock"] = time.process_time
from irc.cli import main
main()
"""
"""A program that is `irc` with processor time as the clock of its limits."""


def whole_process(path: Path, limit: float, *, by_processor: bool = False) -> str:
    """The row of `irc solve` as a process of its own."""
    out = path.with_suffix(".schedule.json")
    irc = [sys.executable, *(["-c", PROCESSOR_CLOCK] if by_processor else ["-m", "irc"])]
    spent = measure([*irc, "solve", str(path), "--time-limit", str(limit), "-o", str(out)])
    first = json.loads(out.read_text())["objective"][0]
    gap = 100 * (first["value"] - first["bound"]) / first["bound"]
    return (
        f"{limit:.0f} s: {first['value']:,} bound {first['bound']:,} ({gap:.1f} %), "
        f"{spent.wall:.1f} s ({spent.cpu:.1f} s of CPU), {spent.memory:.2f} GiB"
    )


def search_alone(path: Path, limit: float) -> str:
    """The row of the search in this process, by processor time."""
    problem = lower_for(read_task(path).task, get_backend("cpsat"))
    search = search_of(problem)
    began = time.process_time()
    first: int | None = None
    bound = problem.bounds.makespan.value
    while time.process_time() - began < limit:
        search.step()
        first = search.value if first is None else first
        if search.value is not None and search.value <= bound:
            break
    seconds = time.process_time() - began
    return f"lists {first}, windows {search.value} bound {bound}, {seconds:.1f} s of CPU"


def main() -> None:
    """Prints one row for each instance."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0] if __doc__ else "")
    parser.add_argument("--limits", type=float, nargs=2, default=LIMITS)
    parser.add_argument("--names", nargs="*", default=[*SHOPS, *PROJECTS])
    parser.add_argument("--processor", action="store_true")
    parser.add_argument("--alone", action="store_true")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        for instance in options.names:
            path = written(instance, Path(name))
            limit = options.limits["100000" in instance or "1000x" in instance]
            if options.alone:
                row = search_alone(path, limit)
            else:
                row = whole_process(path, limit, by_processor=options.processor)
            print(f"{instance}: {row}", flush=True)


if __name__ == "__main__":
    main()
