"""Tasks printed in the DSL and read back: examples, benchmark data, and thousands of random ones.

    python benchmarks/round_trip.py [--generated 5000] [--seed 1]

For each kind: how many tasks, how many of them came back equal from their text, of how many the
layout of the text was final, and how many were the same once more by way of JSON.
"""

from __future__ import annotations

import argparse
import json
import random
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests"))

from hypothesis import HealthCheck, given, seed, settings  # noqa: E402

from irc.frontends.dsl.formatter import formatted  # noqa: E402
from irc.frontends.dsl.printer import print_task  # noqa: E402
from irc.frontends.dsl.task import dsl_task  # noqa: E402
from irc.frontends.files import parse_task, read_task  # noqa: E402
from irc.frontends.importers.asyncplan import import_asyncplan  # noqa: E402
from irc.model import Task  # noqa: E402
from irc.model.canonical import written_task  # noqa: E402
from irc.schedule import dump_json  # noqa: E402
from oracles.generators import hostile_names, random_task, tasks  # noqa: E402

DATA = ROOT.parent / "shared" / "data"


class Count:
    """The counts for the tasks of one kind."""

    def __init__(self, kind: str) -> None:
        self.kind, self.tasks, self.equal, self.final, self.by_json = kind, 0, 0, 0, 0

    def add(self, task: Task) -> None:
        """Prints and reads one task."""
        self.tasks += 1
        text = print_task(task)
        found = dsl_task(text).task
        self.equal += found == task
        self.final += formatted(text) == text
        if found is not None:
            self.by_json += parse_task(dump_json(written_task(found)), "x.json").task == task

    def show(self) -> None:
        """Prints one line."""
        print(
            f"{self.kind}: {self.tasks} tasks, {self.equal} equal, {self.final} layouts final, "
            f"{self.by_json} equal by way of JSON",
            flush=True,
        )


def files() -> Iterator[Task]:
    """The examples and the golden tasks."""
    folders = (ROOT / "examples", ROOT / "tests" / "golden" / "tasks")
    for path in sorted(p for f in folders for p in f.iterdir() if p.suffix in (".json", ".irc")):
        yield read_task(path).task


def asyncplan() -> Iterator[Task]:
    """The task graphs of AsyncPlan-XXL."""
    for path in sorted((DATA / "asyncplan_xxl").glob("*.json")):
        yield from (task for _, task in import_asyncplan(path.read_text("utf-8"), path.name))


def recorded() -> Iterator[Task]:
    """The recorded answers of language models."""
    for path in sorted((DATA / "recorded" / "nl_ir").glob("*.json")):
        for record in json.loads(path.read_text("utf-8")):
            yield parse_task(record["response"]).task


def generated(number: int, first: int) -> Count:
    """Tasks over the whole IR, drawn by hypothesis."""
    count = Count("generated, the whole IR")

    @seed(first)
    @settings(
        max_examples=number,
        deadline=None,
        database=None,
        suppress_health_check=list(HealthCheck),
    )
    @given(tasks())
    def each(task: Task) -> None:
        count.add(task)

    each()
    return count


def main() -> None:
    """Prints a line for each kind."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--generated", type=int, default=5000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    kinds = {"examples and golden tasks": files()}
    if DATA.is_dir():
        kinds |= {"AsyncPlan-XXL": asyncplan(), "recorded answers": recorded()}
    for kind, found in kinds.items():
        count = Count(kind)
        for task in found:
            count.add(task)
        count.show()
    rng = random.Random(options.seed)
    contended = Count("contended, hostile names")
    for _ in range(options.generated // 5):
        contended.add(hostile_names(random_task(rng), rng))
    contended.show()
    generated(options.generated, options.seed).show()


if __name__ == "__main__":
    main()
