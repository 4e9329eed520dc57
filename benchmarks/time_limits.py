"""Measures whether time limits hold from end to end: start-up, checks, validation and output too.

    python benchmarks/time_limits.py [--limits 0.5 1 2] [--sizes 20 200 1000] [--commands solve …]
        [--targets cpsat pddl21] [--runs 1] [--seed 0]

Each command is run as a user runs it, in a process of its own, on a shop of so many actions
(`online_speed.task_of`): `solve`, `explain` of it, `explain` of the same with a deadline that
cannot be kept, `replan` after a station fails, `simulate` of that failure (two steps, each with the
limit). A row is the limit, the slowest run, and what was answered. Allowed are the limit, a tenth
of it, and 0.3 s; ends with status 1 where a run takes longer.
"""

from __future__ import annotations

import argparse
import json
import random
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import irc
from online_speed import failure, task_of

COMMANDS = ("solve", "explain", "impossible", "replan", "simulate")
STEPS = {"simulate": 2}
"""How many times a command plans; each may take the limit."""


@dataclass(frozen=True)
class Files:
    """What the commands read, for one size."""

    task: Path
    impossible: Path
    eventful: Path
    plan: Path
    at: str

    @classmethod
    def written(cls, folder: Path, size: int, seed: int) -> Files:
        """The files of a shop of `size` actions, one of whose stations fails."""
        rng = random.Random(seed)
        made = task_of(rng, size, 20 if size >= 100 else 8, False)
        document = made.model_dump(mode="json", by_alias=True, exclude_unset=True)
        plan = irc.solve(made, time_limit=5)
        event = failure(rng, made, plan.makespan).model_dump(
            mode="json", by_alias=True, exclude_unset=True
        )
        least = max(1, int(plan.makespan * 3 / 4))
        cases = {
            "task": document,
            "impossible": {**document, "deadline": least},
            "eventful": {**document, "events": [event]},
            "plan": {**plan.to_dict(), "task_sha256": None},
        }
        paths = {name: folder / f"{name}_{size}.json" for name in cases}
        for name, path in paths.items():
            path.write_text(json.dumps(cases[name]), encoding="utf-8")
        return cls(**paths, at=str(event["at"]))

    def arguments(self, command: str, target: str, limit: float) -> list[str]:
        """The command line without `irc`."""
        limited = ["--time-limit", str(limit), "--format", "json"]
        if command == "explain":
            return ["explain", str(self.task), *limited]
        if command == "impossible":
            return ["explain", str(self.impossible), *limited]
        aimed = ["--target", target, *limited]
        if command == "replan":
            plan = ["--schedule", str(self.plan), "--at", self.at]
            return ["replan", str(self.eventful), *plan, *aimed]
        return [command, str(self.eventful if command == "simulate" else self.task), *aimed]


def answered(text: str) -> str:
    """What a command answered, in a word or two."""
    try:
        document: dict[str, Any] = json.loads(text)
    except ValueError:
        return "no JSON"
    if "steps" in document:
        return ", ".join(step["schedule"]["status"] for step in document["steps"])
    found = document.get("schedule", document)
    return str(found.get("status", found.get("message", "?")))


def timed(arguments: list[str]) -> tuple[float, str]:
    """(seconds from end to end, what was answered)."""
    began = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-m", "irc", *arguments], capture_output=True, text=True, check=False
    )
    return time.perf_counter() - began, answered(done.stdout)


def rows(options: argparse.Namespace) -> Iterator[tuple[str, str, int, float]]:
    """(command, target, size, limit) of the grid; `explain` has one target."""
    for size in options.sizes:
        for command in options.commands:
            targets = ["cpsat"] if command in ("explain", "impossible") else options.targets
            for target in targets:
                for limit in options.limits:
                    yield command, target, size, limit


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0] if __doc__ else "")
    parser.add_argument("--limits", type=float, nargs="+", default=[0.5, 1, 2])
    parser.add_argument("--sizes", type=int, nargs="+", default=[20, 200, 1000])
    parser.add_argument("--commands", nargs="+", default=COMMANDS, choices=COMMANDS)
    parser.add_argument("--targets", nargs="+", default=["cpsat", "pddl21"])
    parser.add_argument("--runs", type=int, default=1)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    late = 0
    print("command     target  actions  limit  allowed  slowest  answers")
    with tempfile.TemporaryDirectory() as folder:
        files = {n: Files.written(Path(folder), n, options.seed) for n in options.sizes}
        for command, target, size, limit in rows(options):
            arguments = files[size].arguments(command, target, limit)
            runs = [timed(arguments) for _ in range(options.runs)]
            slowest = max(seconds for seconds, _ in runs)
            whole = limit * STEPS.get(command, 1)
            allowed = whole * 1.1 + 0.3
            late += slowest > allowed
            said = " | ".join(dict.fromkeys(word for _, word in runs))
            mark = "  LATE" if slowest > allowed else ""
            print(
                f"{command:11} {target:7} {size:7}  {limit:5g}  {allowed:7.2f}  {slowest:7.2f}"
                f"  {said}{mark}",
                flush=True,
            )
    print(f"{late} late")
    return 1 if late else 0


if __name__ == "__main__":
    sys.exit(main())
