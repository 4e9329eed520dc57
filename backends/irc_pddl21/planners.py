"""The planners: OPTIC, kairos and aries, how each is called and what its clock can hold."""

from __future__ import annotations

import os
import shutil
import sys
from collections.abc import Mapping
from fractions import Fraction
from importlib.util import find_spec
from pathlib import Path
from typing import ClassVar

from irc.problem import Problem
from irc.problem.horizon import safe_horizon
from irc.targets import EngineMissing, Refusal
from irc_pddl21.encode import EPSILON
from irc_pddl21.runs import Job, Planner

OPTIC_LARGEST = Fraction(2_147_483_647, 1000)
"""OPTIC keeps time in 32-bit milliseconds."""

KAIROS_LARGEST = 10**13
"""kairos keeps time in doubles, which soon after this lose its epsilon; it then finds nothing."""

ARIES_EPSILON = Fraction(1, 10)
ARIES_LARGEST = 100_000_000
"""aries counts tenths of a unit in 32 bits."""


class Optic(Planner):
    """OPTIC, an external command: `$IRC_OPTIC`, or `optic-clp` on PATH, or through planutils."""

    name: ClassVar[str] = "optic"

    def _found(self) -> list[str] | None:
        named = os.environ.get("IRC_OPTIC")
        if named:
            return [named] if shutil.which(named) else None
        for command in ("optic-clp", "optic-cplex", "optic"):
            path = shutil.which(command)
            if path is not None:
                return [path]
        planutils = shutil.which("planutils")
        if planutils and Path.home().joinpath(".planutils", "packages", "optic").is_dir():
            return [planutils, "run", "optic", "--"]
        return None

    def missing(self) -> str | None:
        """Why there is no OPTIC here."""
        if self._found() is not None:
            return None
        named = os.environ.get("IRC_OPTIC")
        if named:
            return f"the engine 'optic' is missing: $IRC_OPTIC names {named!r}, no such command"
        return (
            "the engine 'optic' is missing: put optic-clp on PATH or name it in $IRC_OPTIC "
            "(no package registry carries it), or use --engine kairos"
        )

    def command(self, job: Job) -> list[str]:
        """OPTIC searches on after its first plan; the watcher stops it at the bound."""
        found = self._found()
        if found is None:
            raise EngineMissing(self.missing() or "the engine 'optic' is missing")
        first = ["-N"] if job.wish.first_plan else []
        return [*found, *first, str(job.domain), str(job.problem_file)]

    def refuse(self, problem: Problem, scale: int) -> None:
        """OPTIC's 32-bit milliseconds must hold the shortest conceivable schedule, and each number
        in the files.
        """
        needed = problem.bound.value * scale + 2 * len(problem.activities) * EPSILON
        if needed > OPTIC_LARGEST:
            raise _beyond_optic("the schedule takes at least", problem.bound.value * scale)
        written = [a.duration_min for a in problem.activities]
        written += [d for i in range(len(written)) if (d := problem.effective_deadline(i))]
        if max(written, default=0) * scale > OPTIC_LARGEST:
            raise _beyond_optic("the task has times of up to", max(written) * scale)


def _beyond_optic(what: str, units: int) -> Refusal:
    return Refusal(
        f"{what} {units} planner time units, but OPTIC's clock ends at {float(OPTIC_LARGEST)}",
        hint="use --engine kairos, or target 'cpsat'",
    )


class Kairos(Planner):
    """The kairos planner (pip install kairos-planner), embedded."""

    name: ClassVar[str] = "kairos"
    searches: ClassVar[tuple[str, ...]] = ("novelty", "")

    def missing(self) -> str | None:
        """Why kairos cannot be imported, if it cannot."""
        if find_spec("kairos") is None:
            return (
                "the engine 'kairos' is missing: pip install kairos-planner "
                "(it has wheels for Linux only)"
            )
        return None

    def refuse(self, problem: Problem, scale: int) -> None:
        """The epsilon must not get lost in the shortest conceivable schedule."""
        if problem.bound.value * scale > KAIROS_LARGEST:
            raise Refusal(
                "the times of this task are beyond what kairos can tell apart",
                hint="use target 'cpsat'",
            )

    def command(self, job: Job) -> list[str]:
        """The worker script, which loads nothing but kairos."""
        return [
            sys.executable,
            "-P",
            str(Path(__file__).with_name("kairos_worker.py")),
            str(job.domain),
            str(job.problem_file),
            f"{job.seconds:.3f}",
            str(job.limits.memory_mb or 0),
            str(float(job.target)),
            str(job.limits.workers or 1),
            str(job.limits.seed),
            "first" if job.wish.first_plan else "best",
            *([job.wish.search] if job.wish.search else []),
        ]


class Aries(Planner):
    """aries through unified-planning (pip install irc-compiler[up])."""

    name: ClassVar[str] = "aries"
    epsilon: ClassVar[Fraction] = ARIES_EPSILON
    under_deadlines: ClassVar[bool] = False

    def missing(self) -> str | None:
        """Why aries cannot be imported, if it cannot."""
        if find_spec("unified_planning") is None or find_spec("up_aries") is None:
            return "the engine 'aries' is missing: pip install 'irc-compiler[up]'"
        return None

    def command(self, job: Job) -> list[str]:
        """The worker script."""
        return [
            sys.executable,
            "-P",
            str(Path(__file__).with_name("aries_worker.py")),
            str(job.domain),
            str(job.problem_file),
            f"{job.seconds:.3f}",
        ]

    def environment(self, job: Job) -> Mapping[str, str]:
        """aries plans up to a horizon of 10,000 units unless told otherwise."""
        horizon = _planner_horizon(job.wish.problem, job.names["planner_units_per_tick"])
        return {**os.environ, "ARIES_PLANNING_HORIZON": str(horizon)}

    def refuse(self, problem: Problem, scale: int) -> None:
        """aries' 32-bit tenths must hold the horizon."""
        if _planner_horizon(problem, scale) > ARIES_LARGEST:
            raise Refusal(
                "the times of this task are beyond aries' 32-bit clock",
                hint="use target 'cpsat'",
            )


def _planner_horizon(problem: Problem, scale: int) -> int:
    return (safe_horizon(problem) + 1) * scale + len(problem.activities)
