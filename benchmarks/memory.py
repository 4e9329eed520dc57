"""Solves tasks one after the other in one process, and prints the memory that is resident.

Half of the tasks are solved by CP-SAT, the others end otherwise: by the critical path, infeasible
by a check, faulty, refused. After the first hundred the memory should not grow.

    python benchmarks/memory.py [--solves 1000] [--target cpsat]
"""

from __future__ import annotations

import argparse
import gc
import sys
from pathlib import Path

import irc

WARM = 100
STEP = 100


def task_number(k: int) -> dict[str, object]:
    """A small task, another one for each number."""
    uses = [{"resource": "oven"}, {"one_of": ["ann", "bob"]}]
    actions = [{"id": f"a{i}", "duration": 1 + (k + i) % 7, "uses": uses} for i in range(6)]
    document: dict[str, object] = {
        "name": f"task {k}",
        "resources": [{"id": "oven", "capacity": 2}, {"id": "ann"}, {"id": "bob"}],
        "actions": actions,
    }
    if k % 10 == 1:
        document["resources"] = [{"id": "oven", "capacity": 9}, {"id": "ann", "capacity": 9}]
        for action in actions:
            action["uses"] = [{"resource": "ann"}]
    if k % 10 == 3:
        document["deadline"] = 2
    if k % 10 == 5:
        document["precedence"] = [["a0", "a1"], ["a1", "a0"]]
    if k % 10 == 7:
        actions[0]["duratio"] = 3
    if k % 10 == 9:
        document["objective"] = ["minimize_nothing"]
    return document


def solve(k: int, target: str) -> None:
    """Solves a task, and forgets the answer."""
    try:
        irc.solve(task_number(k), target, time_limit=5, workers=1)
    except irc.IrcError:
        return


def resident() -> float:
    """The memory of this process that is resident, in MiB (Linux)."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * 4096 / 2**20


def main() -> int:
    """Prints the memory after every hundred solves; exits with 1 if it grows by over 5 MiB."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--solves", type=int, default=1000)
    parser.add_argument("--target", default="cpsat")
    options = parser.parse_args()
    warm = 0.0
    for k in range(options.solves + WARM):
        solve(k, options.target)
        if (k + 1) % STEP == 0:
            gc.collect()
            warm = warm or resident()
            print(f"{k + 1:>6,} solves: {resident():.1f} MiB", flush=True)
    grown = resident() - warm
    print(f"grown by {grown:.1f} MiB in {options.solves:,} solves")
    return 0 if grown <= 5 else 1


if __name__ == "__main__":
    sys.exit(main())
