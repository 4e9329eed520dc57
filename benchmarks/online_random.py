"""Judges each step of random executions of small tasks, and compares it with brute force.

    python benchmarks/online_random.py [--each 50] [--mixed 500] [--first 0] [--target cpsat]
                                       [--engine auto] [--time-limit 20] [--only OPERATION]
                                       [--repros DIR] [--whole]

For each operation of an event there are `--each` executions with one such event, and `--mixed` ones
with one to five events of any kind. Every step must be a valid merged history or a proof that none
exists, with the objective values of brute force if the task is small enough
(`tests/oracles/online_judge.py`). With `--whole`, `simulate` runs each execution once more and must
give the same. Exits with 1 on any fault; each is printed with the operation and the seed that
replay it (`--only OPERATION --first SEED --each 1`; `--only mixed --first SEED --mixed 1`), and
`--repros` writes its task, schedule and events.
"""

from __future__ import annotations

import argparse
import signal
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from irc.diagnostics import InputError
from irc.execution import replan, simulate
from irc.execution.step import Step
from irc.model import Event, Task
from irc.model.canonical import written_task
from irc.model.quantities import Number
from irc.model.times import json_number
from irc.schedule import Schedule, dump_json
from irc.targets import EngineFailed, SolveOptions
from oracles.online_judge import judge_step
from oracles.online_random import OPERATIONS, Played, play

MIXED = "mixed"


class HangError(Exception):
    """A repair took far longer than its limit."""


_KINDS: dict[type[Exception], str] = {
    InputError: "refused",
    EngineFailed: "failed",
    HangError: "hangs",
}


@contextmanager
def _at_most(seconds: float) -> Iterator[None]:
    """Ends a repair that does not end by itself, if the platform can."""

    def ring(*_: object) -> None:
        raise HangError(f"no end after {seconds:g} s")

    before = signal.signal(signal.SIGALRM, ring) if hasattr(signal, "SIGALRM") else None
    if before is not None:
        signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        if before is not None:
            signal.setitimer(signal.ITIMER_REAL, 0)
            signal.signal(signal.SIGALRM, before)


@dataclass
class Figures:
    """The counts for one operation."""

    counts: Counter[str] = field(default_factory=Counter)
    faults: list[str] = field(default_factory=list)
    why_not: Counter[str] = field(default_factory=Counter)

    def row(self, name: str) -> str:
        c = self.counts
        return (
            f"{name:18} {c['episodes']:8} {c['steps']:6} {c['valid']:6} {c['infeasible']:10} "
            f"{c['compared']:9} {c['equal']:6} {len(self.faults):7}"
        )


HEAD = (
    f"{'operation':18} {'episodes':>8} {'steps':>6} {'valid':>6} {'infeasible':>10} "
    f"{'compared':>9} {'equal':>6} {'faults':>7}"
)


@dataclass(frozen=True)
class Run:
    """The options of repairs, and the folder for faults."""

    options: SolveOptions
    repros: Path | None
    whole: bool
    now: list[tuple[Task, Schedule, Number, Sequence[Event]]] = field(default_factory=list)
    """The step that is being repaired, which is printed if it fails."""

    def replan(self, task: Task, schedule: Schedule, at: Number, events: Sequence[Event]) -> Step:
        self.now[:] = [(task, schedule, at, events)]
        with _at_most(2 * (self.options.time_limit or 60) + 10):
            return replan(task, schedule, at, events, options=self.options)

    def execution(self, seed: int, operation: str, figures: Figures) -> None:
        """Runs one execution and judges each of its steps."""
        figures.counts["episodes"] += 1
        over: frozenset[str] = frozenset()
        played: list[Played] = []
        try:
            for one in play(seed, None if operation == MIXED else operation, self.replan):
                judged = judge_step(one.task, one.schedule, one.step, one.events, over)
                over = judged.over
                played.append(one)
                figures.counts["steps"] += 1
                figures.counts["infeasible"] += judged.infeasible
                figures.counts["valid"] += one.step.schedule.answered
                figures.counts["compared"] += judged.compared
                figures.counts["equal"] += judged.equal
                figures.counts["worse"] += judged.worse is not None
                if self.options.target != "cpsat" and not one.step.schedule.answered:
                    figures.counts["unanswered"] += not judged.infeasible
                    judged.faults[:] = [f for f in judged.faults if not f.startswith("status:")]
                if judged.why_not is not None:
                    figures.why_not[judged.why_not] += 1
                if judged.faults:
                    figures.counts["infeasible"] -= judged.infeasible
                    figures.counts["valid"] -= one.step.schedule.answered
                    self.fault(figures, operation, seed, judged.faults, one.step)
                    return
        except (InputError, EngineFailed, HangError) as error:
            if isinstance(error, InputError) and self.options.target != "cpsat":
                figures.counts["refused"] += 1
                return
            figures.counts["steps"] += 1
            self.fault(figures, operation, seed, [f"{_KINDS[type(error)]}: {error}"], None)
            return
        if self.whole and played:
            try:
                found = list(self.again(played))
            except (InputError, EngineFailed) as error:
                found = [f"simulate: {error}"]
            for fault in found:
                self.fault(figures, operation, seed, [fault], None)

    def again(self, played: Sequence[Played]) -> Iterator[str]:
        """Runs the same execution by `simulate`, which has all events from the beginning."""
        first = played[0]
        events = tuple(event for one in played for event in one.events)
        task = first.task.model_copy(update={"events": events})
        done = simulate(task, schedule=first.schedule, options=self.options)
        plans = [step.schedule for step in done.steps[1:]]
        for k, one in enumerate(played):
            if k >= len(plans) or plans[k].entries != one.step.schedule.entries:
                yield f"simulate: comes to something else in step {k + 1}"
                return

    def fault(
        self,
        figures: Figures,
        operation: str,
        seed: int,
        faults: Sequence[str],
        step: Step | None,
    ) -> None:
        figures.faults.append(f"{operation} seed {seed}")
        for fault in faults:
            print(f"{operation} seed {seed}: {fault}", flush=True)
        if self.repros is None:
            return
        task, schedule, at, events = self.now[0]
        document: dict[str, Any] = {
            "faults": list(faults),
            "at": json_number(at),
            "task": written_task(task),
            "schedule": schedule.to_dict(),
            "events": [
                e.model_dump(mode="json", by_alias=True, exclude_unset=True) for e in events
            ],
            "step": None if step is None else step.to_dict(),
        }
        self.repros.mkdir(parents=True, exist_ok=True)
        (self.repros / f"{operation}_{seed}.json").write_text(dump_json(document), "utf-8")


def main() -> int:
    """Prints each fault, and a line of figures for each operation."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--each", type=int, default=50)
    parser.add_argument("--mixed", type=int, default=500)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--only", choices=[*OPERATIONS, MIXED])
    parser.add_argument("--target", default="cpsat", choices=["cpsat", "pddl21"])
    parser.add_argument("--engine", default="auto")
    parser.add_argument("--time-limit", type=float, default=20.0)
    parser.add_argument("--repros", type=Path)
    parser.add_argument("--whole", action="store_true")
    options = parser.parse_args()
    how = SolveOptions(options.target, options.engine, options.time_limit, workers=1)
    run = Run(how, options.repros, options.whole)
    rows = []
    total = Figures()
    for operation in [options.only] if options.only else [*OPERATIONS, MIXED]:
        figures = Figures()
        count = options.mixed if operation == MIXED else options.each
        for seed in range(options.first, options.first + count):
            run.execution(seed, operation, figures)
        rows.append(figures.row(operation))
        total.counts += figures.counts
        total.faults += figures.faults
        total.why_not += figures.why_not
        print(rows[-1], file=sys.stderr, flush=True)
    print("\n".join([HEAD, *rows, total.row("all")]))
    if total.why_not:
        reasons = "; ".join(f"{why} {n}" for why, n in total.why_not.most_common())
        print(f"not compared: {reasons}")
    for what in ("worse", "unanswered", "refused"):
        if total.counts[what]:
            print(f"{what}: {total.counts[what]}")
    return int(bool(total.faults))


if __name__ == "__main__":
    sys.exit(main())
