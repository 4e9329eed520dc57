"""Measures large tasks: from JSON to PDDL2.1 on disk, and to an exact schedule.

    python benchmarks/size.py [--actions 100000] [--edges 300000] [--only solve] [--once]

Each is a whole `irc` process; then, unless `--once` is given, the same with twice as many actions
and edges. `--only` measures one of the two commands.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from multiprocessing import get_context
from pathlib import Path
from typing import NamedTuple

from graphs import random_graph


class Spent(NamedTuple):
    """Seconds of wall-clock and of CPU time, and peak memory in GiB, of a whole process.

    On a machine with nothing else to do the two times agree: it is one thread.
    """

    wall: float
    cpu: float
    memory: float


def measure(command: list[str]) -> Spent:
    """The time and memory of a command."""
    began = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    if status:
        raise RuntimeError(f"{command} ended with status {status}")
    cpu = usage.ru_utime + usage.ru_stime
    return Spent(time.perf_counter() - began, cpu, usage.ru_maxrss / 2**20)


def write(path: Path, actions: int, edges: int) -> None:
    """Writes a random task graph into a file."""
    path.write_text(random_graph(actions, edges))


def main() -> None:
    """Prints one row per size and command, and the growth."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--actions", type=int, default=100_000)
    parser.add_argument("--edges", type=int, default=300_000)
    parser.add_argument("--only", choices=["compile", "solve"])
    parser.add_argument("--once", action="store_true")
    options = parser.parse_args()
    irc = str(Path(sys.executable).with_name("irc"))
    rows: dict[str, list[Spent]] = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for factor in (1,) if options.once else (1, 2):
            actions, edges = factor * options.actions, factor * options.edges
            task = folder / f"task{factor}.json"
            # (In a process of its own, whose memory does not count as that of the commands.)
            writing = get_context("spawn").Process(target=write, args=(task, actions, edges))
            writing.start()
            writing.join()
            commands = {
                "compile to pddl21": ["compile", "-t", "pddl21", "-o", str(folder / "out")],
                "solve by critical path": ["solve", "-o", str(folder / "s.json")],
            }
            for label, words in commands.items():
                if options.only not in (None, words[0]):
                    continue
                spent = measure([irc, words[0], str(task), *words[1:]])
                rows.setdefault(label, []).append(spent)
                print(
                    f"{actions:,} actions, {edges:,} edges, {label}: {spent.wall:.1f} s "
                    f"({spent.cpu:.1f} s of CPU), {spent.memory:.2f} GiB",
                    flush=True,
                )
    for label, (one, *twice) in rows.items():
        if not twice:
            continue
        (two,) = twice
        print(
            f"{label}: twice the size costs × {two.wall / one.wall:.2f} "
            f"(CPU × {two.cpu / one.cpu:.2f})"
        )


if __name__ == "__main__":
    main()
