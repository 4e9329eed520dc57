"""Runs a competitor on an instance in a process of its own, with equal processor time for all."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from racing.instance import Instance, faults, length
from racing.through_irc import WITHOUT

HERE = Path(__file__).resolve().parent
ENOUGH = 0.9
"""A run that was not proven and had less than this part of its processor time is done again."""
MOST_RUNS = 3
MOST_PACE = 20.0
"""On a busy machine, a run gets up to that many times the wall-clock time."""


@dataclass(frozen=True)
class Race:
    """What every competitor of a race is given."""

    seconds: float
    workers: int

    @property
    def processor_seconds(self) -> float:
        """The processor time of a run."""
        return self.seconds * self.workers


@dataclass
class Run:
    """The answer of a competitor: its trace, with times in processor seconds for each worker."""

    instance: str
    family: str
    competitor: str
    seed: int
    value: int | None = None
    bound: int | None = None
    proven: bool = False
    first: float | None = None
    best: float | None = None
    trace: list[tuple[float, int]] = field(default_factory=list)
    cpu: float = 0.0
    wall: float = 0.0
    fault: str = ""


def command(name: str, instance: Path, task: Path) -> list[str]:
    """The command of a competitor: `plain`, `pyjobshop`, `irc` or `irc-PART+PART`."""
    if name == "plain":
        return [str(HERE / "plain.py"), str(instance)]
    if name == "pyjobshop":
        return ["-m", "racing.through_pyjobshop", str(instance)]
    kind, _, parts = name.partition("-")
    if kind != "irc" or not {*filter(None, parts.split("+"))} <= {*WITHOUT}:
        raise ValueError(
            f"there is no competitor {name!r}: known are plain, pyjobshop, irc, and irc- with "
            f"{', '.join(WITHOUT)}, joined by +"
        )
    return ["-m", "racing.through_irc", str(instance), str(task), "--parts", parts or "all"]


class Runner:
    """Runs competitors; on a busy machine it gives all of them more wall-clock time."""

    def __init__(self, race: Race, folder: Path) -> None:
        self.race, self.folder = race, folder
        waiting = (os.getloadavg()[0] + race.workers) / max(race.workers, os.cpu_count() or 1)
        self._pace = min(MOST_PACE, max(1.0, waiting))

    def run(self, name: str, instance: Instance, paths: tuple[Path, Path], seed: int) -> Run:
        """The run of a competitor; again, with more time, where others took the processor."""
        for _ in range(MOST_RUNS):
            found, wanted = self._once(name, instance, paths, seed)
            share = found.cpu / self.race.processor_seconds
            if found.proven or found.fault or not wanted or share >= ENOUGH:
                break
            self._pace = min(MOST_PACE, self._pace / max(share, 1 / MOST_PACE))
        if not found.proven and share >= ENOUGH:
            # (The others are likely to need about as long.)
            self._pace = min(MOST_PACE, max(1.0, 1.3 * found.wall / self.race.seconds))
        return found

    def _once(
        self, name: str, instance: Instance, paths: tuple[Path, Path], seed: int
    ) -> tuple[Run, bool]:
        """(the run, whether it went on until its time was over)."""
        limit = self.race.seconds * self._pace
        arguments = [
            *command(name, *paths),
            *("--seconds", str(limit)),
            *("--processor-seconds", str(self.race.processor_seconds)),
            *("--workers", str(self.race.workers)),
            *("--seed", str(seed)),
        ]
        lines, errors, cpu, wall = self._output(arguments, limit)
        found = Run(instance.name, instance.family, name, seed, cpu=cpu, wall=wall)
        parsed = [json.loads(line) for line in lines if line.startswith("{")]
        final = parsed[-1] if parsed and "proven" in parsed[-1] else None
        if final is None:
            found.fault = f"ended without an answer: {errors.strip()[-300:]}"
            return found, False
        found.fault = _judged(instance, final)
        self._read(found, parsed, final)
        return found, wall >= ENOUGH * limit

    def _read(self, found: Run, parsed: Sequence[dict[str, Any]], final: dict[str, Any]) -> None:
        """Takes what was known when the processor time was over."""
        most = self.race.processor_seconds
        for line in parsed:
            at, value, bound = line["cpu"], line.get("value"), line.get("bound")
            late = at > most and line is not final
            if late or (line is final and at > 1.1 * most):
                continue
            if bound is not None:
                found.bound = max(bound, found.bound or 0)
            if value is not None and (found.value is None or value < found.value):
                found.value = value
                found.trace.append((min(at, most) / self.race.workers, value))
        if found.trace:
            found.first, found.best = found.trace[0][0], found.trace[-1][0]
        closed = found.value is not None and found.value == found.bound
        found.proven = closed or (bool(final["proven"]) and final["cpu"] <= 1.1 * most)
        if found.proven:
            found.bound = found.value

    def _output(self, arguments: list[str], limit: float) -> tuple[list[str], str, float, float]:
        """(lines, errors, processor seconds, wall-clock seconds) of a process."""
        out, err = self.folder / "out", self.folder / "err"
        path = os.pathsep.join([str(HERE.parent), *filter(None, [os.environ.get("PYTHONPATH")])])
        began = time.perf_counter()
        with out.open("w") as output, err.open("w") as errors:
            process = subprocess.Popen(
                [sys.executable, *arguments],
                stdout=output,
                stderr=errors,
                env={**os.environ, "PYTHONPATH": path},
            )
            deadline = began + 2 * limit + 60
            while True:
                pid, _, usage = os.wait4(process.pid, os.WNOHANG)
                if pid:
                    process.returncode = 0
                    break
                if time.perf_counter() > deadline:
                    process.kill()
                time.sleep(0.005)
        wall = time.perf_counter() - began
        cpu = usage.ru_utime + usage.ru_stime
        return out.read_text("utf-8").splitlines(), err.read_text("utf-8"), cpu, wall


def _judged(instance: Instance, final: dict[str, Any]) -> str:
    """The faults of a final answer, in a line; empty if there are none."""
    if "starts" not in final:
        return ""
    starts, ways = final["starts"], final["ways"]
    found = faults(instance, starts, ways)
    if (reached := length(instance, starts, ways)) > final["value"]:
        found.append(f"its makespan is {reached}, not {final['value']}")
    bound = final.get("bound")
    if bound is not None and bound > reached:
        found.append(f"its bound {bound} is above its makespan")
    return "; ".join(found[:3])
