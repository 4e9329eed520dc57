"""One task on a Dask cluster of this machine: two workers for half the time against one.

    python benchmarks/cluster.py [FOLDER] [--seconds 20] [--most 10] [--only TEXT]

Each worker has one thread. On each instance two workers race for `--seconds`, and one worker has
twice as long; the workers are those of two clusters that run all the time, and have solved a task
before. The gap of an answer is how far its makespan is above the better of the two bounds. The
processor seconds of the workers say whether both got the same. Instances are those of a folder
(JSPLIB, FJSPLIB, PSPLIB files), or hard ones that are generated.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "benchmarks"), str(ROOT / "tests")]

from batches.dask_cluster import Cluster  # noqa: E402
from irc.cluster.solving import solve_on_cluster  # noqa: E402
from irc.diagnostics import Findings  # noqa: E402
from irc.frontends.json.document import read_document  # noqa: E402
from irc.model import Task  # noqa: E402
from irc.model.from_document import to_task  # noqa: E402
from irc.targets import SolveOptions  # noqa: E402
from racing.gather import gather  # noqa: E402
from racing.generate import Lehmer, job_shop, job_shop_text  # noqa: E402


@dataclass
class Side:
    """A cluster with some workers, and the sums of what it has reached."""

    cluster: Cluster
    pids: list[int]
    seconds: float
    gaps: list[float] = field(default_factory=list)
    processor: float = 0.0

    def spent(self) -> float:
        """The processor seconds of its workers so far."""
        return sum(map(_spent, self.pids))


def _spent(pid: int) -> float:
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / float(os.sysconf("SC_CLK_TCK"))


def started(folder: Path, workers: int, seconds: float) -> Side:
    """A cluster whose workers are there."""
    folder.mkdir()
    found = Cluster(folder)
    pids = [found.add_worker().pid for _ in range(workers)]
    while (folder / "log").read_text().count("Registered to") < workers:
        time.sleep(0.1)
    return Side(found, pids, seconds)


def solved(side: Side, task: Task) -> tuple[float, float]:
    """(makespan, bound) of a race; the makespan is infinite where nothing was found."""
    before = side.spent()
    options = SolveOptions(time_limit=side.seconds, shortcut=False)
    schedule = solve_on_cluster(task, side.cluster.address, options).schedule
    side.processor += side.spent() - before
    if not schedule.answered:
        return float("inf"), 0.0
    return float(schedule.makespan), float(schedule.objective[0].bound or 0)


def compared(sides: tuple[Side, Side], name: str, task: Task) -> None:
    """Prints both answers on an instance, and keeps their gaps."""
    found = [solved(side, task) for side in sides]
    bound = max(b for _, b in found)
    for side, (value, _) in zip(sides, found, strict=True):
        side.gaps.append(value / bound - 1)
    texts = [
        f"{len(side.pids)} × {side.seconds:g} s: {value:g} (bound {own:g}, gap {side.gaps[-1]:.2%})"
        for side, (value, own) in zip(sides, found, strict=True)
    ]
    print(f"{name}: {'; '.join(texts)}", flush=True)


def read(text: str) -> Task:
    """A task of its JSON text."""
    task = to_task(read_document(text, "task").content, Findings())
    assert task is not None
    return task


def generated(folder: Path) -> None:
    """Job shops of 20 × 15 and 15 × 15."""
    draw = Lehmer(4711)
    for k in range(10):
        shop = job_shop(20 - 5 * (k % 2), 15, draw.whole(1, 2**31 - 2), draw.whole(1, 2**31 - 2))
        (folder / f"shop_{k}.jsp").write_text(job_shop_text(shop))


def main() -> None:
    """Compares on each instance, and prints the sums."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, nargs="?")
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--most", type=int, default=10)
    parser.add_argument("--only", default="", help="names that contain one of these, by commas")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        place = Path(name)
        folder = options.folder or place / "instances"
        if options.folder is None:
            folder.mkdir()
            generated(folder)
        wanted = options.only.split(",")
        chosen = [
            (instance.name, text)
            for instance, text in gather(folder).instances
            if any(part in instance.name for part in wanted)
        ][: options.most]
        two = started(place / "two", 2, options.seconds)
        one = started(place / "one", 1, 2 * options.seconds)
        try:
            for side in (two, one):
                solved(Side(side.cluster, side.pids, options.seconds), read(chosen[0][1]))
            for instance, text in chosen:
                compared((two, one), instance, read(text))
        finally:
            two.cluster.end()
            one.cluster.end()
    for side in (two, one):
        print(
            f"{len(side.pids)} workers, {side.seconds:g} s: sum of gaps {sum(side.gaps):.2%}, "
            f"{side.processor:.0f} processor seconds"
        )


if __name__ == "__main__":
    main()
