"""Writes instances by published generators, as files of the formats that are raced.

The random numbers are those of Taillard's generator throughout, so that the same seeds give the
same instances on every machine and in every language.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from irc.diagnostics import Findings
from irc.frontends.exporters.projects import write_psplib
from irc.model import Task
from irc.model.from_document import to_task


class Lehmer:
    """Taillard's random numbers: X ← 16807 X mod 2^31 − 1 (Bratley, Fox and Schrage 1983).

    Source: E. Taillard, "Benchmarks for basic scheduling problems", EJOR 64 (1993).
    """

    def __init__(self, seed: int) -> None:
        self._state = seed

    def whole(self, low: int, high: int) -> int:
        """A whole number from `low` to `high`."""
        self._state = 16807 * self._state % (2**31 - 1)
        return int(low + self._state / (2**31 - 1) * (high - low + 1))


def job_shop(jobs: int, machines: int, time_seed: int, machine_seed: int) -> list[list[list[int]]]:
    """Taillard's job shop: for each job [machine, duration] of each operation, machines from 0.

    His ten instances of 15 × 15 begin with the seeds 840612802 and 398197754.
    """
    times, order = Lehmer(time_seed), Lehmer(machine_seed)
    durations = [[times.whole(1, 99) for _ in range(machines)] for _ in range(jobs)]
    found = []
    for j in range(jobs):
        visited = list(range(machines))
        for k in range(machines):
            other = order.whole(k, machines - 1)
            visited[k], visited[other] = visited[other], visited[k]
        found.append([[m, d] for m, d in zip(visited, durations[j], strict=True)])
    return found


def job_shop_text(shop: Sequence[Sequence[Sequence[int]]]) -> str:
    """A job shop in the standard format."""
    lines = [" ".join(f"{m} {d}" for m, d in job) for job in shop]
    return "\n".join([f"{len(shop)} {len(shop[0])}", *lines]) + "\n"


def flexible_text(jobs: int, machines: int, seed: int, most: int) -> str:
    """A flexible job shop in the manner of Brandimarte (1993): 5 to 15 operations a job, each on
    1 to `most` machines, a duration of its own on each of them.
    """
    draw = Lehmer(seed)
    lines = [f"{jobs} {machines}"]
    for _ in range(jobs):
        numbers = [draw.whole(5, 15)]
        for _ in range(numbers[0]):
            chosen = _some(draw, machines, draw.whole(1, min(most, machines)))
            base = draw.whole(5, 20)
            numbers.append(len(chosen))
            for machine in chosen:
                numbers += [machine + 1, max(1, base + draw.whole(-base // 3, base // 3))]
        lines.append(" ".join(map(str, numbers)))
    return "\n".join(lines) + "\n"


def _some(draw: Lehmer, size: int, count: int) -> list[int]:
    left = list(range(size))
    return sorted(left.pop(draw.whole(0, len(left) - 1)) for _ in range(count))


RESOURCES = 4
MOST_NEIGHBOURS = 3
"""Of a project: its resources, and the most predecessors and successors of an activity."""


def project(activities: int, complexity: float, factor: float, strength: float, seed: int) -> str:
    """A project in the manner of ProGen, as PSPLIB text.

    `complexity` is the mean number of precedences an activity, `factor` the share of the resources
    that one takes, `strength` from 0 (capacities as small as can be) to 1 (never scarce). Durations
    and requests are 1 to 10. Source: Kolisch, Sprecher, Drexl, "Characterization and generation of
    a general class of resource-constrained project scheduling problems", Management Science 41
    (1995); the settings of PSPLIB are 1.5, 1.8, 2.1; 0.25 … 1; 0.2, 0.5, 0.7, 1.
    """
    draw = Lehmer(seed)
    durations = [draw.whole(1, 10) for _ in range(activities)]
    requests = [_requests(draw, factor) for _ in range(activities)]
    arcs = _network(draw, activities, complexity)
    peaks = _peaks(durations, requests, arcs)
    capacities = []
    for r in range(RESOURCES):
        least = max([1, *(request[r] for request in requests)])
        capacities.append(least + round(strength * (max(least, peaks[r]) - least)))
    return write_psplib(_task(durations, requests, arcs, capacities))


def _requests(draw: Lehmer, factor: float) -> list[int]:
    chosen = set(_some(draw, RESOURCES, max(1, round(factor * RESOURCES))))
    return [draw.whole(1, 10) if r in chosen else 0 for r in range(RESOURCES)]


def _network(draw: Lehmer, n: int, complexity: float) -> list[tuple[int, int]]:
    """Precedences without transitive ones, from lower to higher numbers; three begin, three end."""
    before: list[set[int]] = [set() for _ in range(n)]
    after: list[set[int]] = [set() for _ in range(n)]
    above: list[set[int]] = [set() for _ in range(n)]
    below: list[set[int]] = [set() for _ in range(n)]

    def add(i: int, j: int) -> bool:
        full = len(after[i]) >= MOST_NEIGHBOURS or len(before[j]) >= MOST_NEIGHBOURS
        implied = j in below[i] or any(after[p] & {j, *below[j]} for p in (i, *above[i]))
        if full or implied:
            return False
        after[i].add(j)
        before[j].add(i)
        for up in (i, *above[i]):
            below[up] |= {j, *below[j]}
        for down in (j, *below[j]):
            above[down] |= {i, *above[i]}
        return True

    for j in range(3, n):
        while not before[j]:
            add(draw.whole(0, j - 1), j)
    for i in range(n - 4, -1, -1):
        for _ in range(50):
            if after[i] or add(i, draw.whole(i + 1, n - 1)):
                break
    for _ in range(50 * n):
        if sum(map(len, after)) >= complexity * n:
            break
        i = draw.whole(0, n - 2)
        add(i, draw.whole(i + 1, n - 1))
    return [(i, j) for i in range(n) for j in sorted(after[i])]


def _peaks(
    durations: Sequence[int], requests: Sequence[Sequence[int]], arcs: Sequence[tuple[int, int]]
) -> list[int]:
    """The most that the earliest schedule without capacities takes of each resource at once."""
    starts = [0] * len(durations)
    for i, j in sorted(arcs, key=lambda arc: arc[1]):
        starts[j] = max(starts[j], starts[i] + durations[i])
    return [
        max(
            sum(
                requests[i][r]
                for i, start in enumerate(starts)
                if start <= time < start + durations[i]
            )
            for time in starts
        )
        for r in range(RESOURCES)
    ]


def _task(
    durations: Sequence[int],
    requests: Sequence[Sequence[int]],
    arcs: Sequence[tuple[int, int]],
    capacities: Sequence[int],
) -> Task:
    document = {
        "resources": [{"id": f"R{r + 1}", "capacity": c} for r, c in enumerate(capacities)],
        "actions": [
            {
                "id": f"a{i}",
                "duration": duration,
                "uses": [
                    {"resource": f"R{r + 1}", "amount": n} for r, n in enumerate(requests[i]) if n
                ],
            }
            for i, duration in enumerate(durations)
        ],
        "precedence": [{"before": f"a{i}", "after": f"a{j}"} for i, j in arcs],
    }
    task = to_task(document, Findings())
    if task is None:
        raise ValueError("the generator wrote a task with faults")
    return task


SHOP_SIZES = ((15, 15), (20, 15), (20, 20), (30, 15), (30, 20), (50, 15), (50, 20))
FLEXIBLE_SIZES = ((10, 6, 6), (15, 8, 5), (20, 10, 5), (20, 15, 10))
PROJECT_SIZES = (30, 60, 90, 120)
PROJECT_SETTINGS = ((1.5, 0.5, 0.2), (1.8, 0.75, 0.2), (2.1, 1.0, 0.2), (1.5, 0.75, 0.5))
"""What `write_all` writes; the strengths are those of PSPLIB's harder instances."""


def write_all(folder: Path, count: int, seed: int) -> list[Path]:
    """`count` instances of each size of each family, as files in a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    texts: dict[str, str] = {}
    draw = Lehmer(840612802 + seed)
    for k in range(count):
        for jobs, machines in SHOP_SIZES:
            seeds = draw.whole(1, 2**31 - 2), draw.whole(1, 2**31 - 2)
            name = f"shop_{jobs}x{machines}_{seed + k}.jsp"
            texts[name] = job_shop_text(job_shop(jobs, machines, *seeds))
        for jobs, machines, most in FLEXIBLE_SIZES:
            name = f"flexible_{jobs}x{machines}_{seed + k}.fjs"
            texts[name] = flexible_text(jobs, machines, draw.whole(1, 2**31 - 2), most)
        for size in PROJECT_SIZES:
            setting = PROJECT_SETTINGS[k % len(PROJECT_SETTINGS)]
            name = f"project_{size}_{seed + k}.sm"
            texts[name] = project(size, *setting, draw.whole(1, 2**31 - 2))
    for name, text in texts.items():
        (folder / name).write_text(text, "utf-8")
    return [folder / name for name in texts]
