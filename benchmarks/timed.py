"""Solves one task through one target, with the validator's verdict and the seconds."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

from irc.api import validate
from irc.diagnostics import InputError
from irc.driver.solve import solve_task
from irc.model import Task
from irc.model.quantities import Number
from irc.schedule import Schedule, Status
from irc.targets import EngineFailed, SolveOptions


@dataclass(frozen=True)
class Timed:
    """A target's answer, or the reason why there is none."""

    schedule: Schedule | None
    seconds: float
    said: str

    @property
    def valid(self) -> bool:
        """Whether there is an answer, which `solve_timed` has validated."""
        return self.schedule is not None and self.schedule.answered

    @property
    def proven(self) -> bool:
        """Whether the answer is called optimal."""
        return self.schedule is not None and self.schedule.status is Status.OPTIMAL

    def value(self, name: str) -> Number | None:
        """The value of one objective (such as "reward"); None without an answer."""
        if self.schedule is None or not self.schedule.answered:
            return None
        if name == "makespan":
            return self.schedule.makespan
        return next((o.value for o in self.schedule.objective if o.name == name), None)


def solve_timed(
    task: Task, target: str, engine: str, seconds: float, workers: int | None = 1
) -> Timed:
    """Solves with the engine forced to run. An answer that is not valid ends the benchmark."""
    began = time.perf_counter()
    try:
        options = SolveOptions(target, engine, seconds, workers=workers, shortcut=False)
        schedule = solve_task(task, options).schedule
    except InputError as error:
        return Timed(None, time.perf_counter() - began, f"refused: {next(iter(error.report))}")
    except EngineFailed as error:
        return Timed(None, time.perf_counter() - began, f"failed: {error}")
    took = time.perf_counter() - began
    if schedule.answered and not (verdict := validate(task, schedule)).valid:
        raise SystemExit(f"{task.name}: {verdict}")
    return Timed(schedule, took, str(schedule.status))


def spread(seconds: Sequence[float]) -> str:
    """Mean, median and maximum of some seconds."""
    ordered = sorted(seconds)
    if not ordered:
        return "no times"
    middle = (ordered[(len(ordered) - 1) // 2] + ordered[len(ordered) // 2]) / 2
    mean = sum(ordered) / len(ordered)
    return f"mean {mean:.2f} s, median {middle:.2f} s, max {ordered[-1]:.2f} s"
