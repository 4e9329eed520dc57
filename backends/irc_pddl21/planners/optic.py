"""OPTIC, an external command."""

from __future__ import annotations

import os
import shutil
from fractions import Fraction
from pathlib import Path
from typing import ClassVar

from irc.problem import Problem
from irc.targets import EngineMissing, Refusal
from irc_pddl21.encoding.time_scale import EPSILON
from irc_pddl21.planners.planner import Planner, PlannerInput

LARGEST = Fraction(2_147_483_647, 1000)
"""OPTIC keeps time in 32-bit milliseconds."""


class OpticPlanner(Planner):
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
        """The reason why there is no OPTIC here, or None if there is."""
        if self._found() is not None:
            return None
        named = os.environ.get("IRC_OPTIC")
        if named:
            return f"the engine 'optic' is missing: $IRC_OPTIC names {named!r}, no such command"
        return (
            "the engine 'optic' is missing: put optic-clp on PATH or name it in $IRC_OPTIC "
            "(no package registry carries it), or use --engine kairos"
        )

    def command(self, given: PlannerInput) -> list[str]:
        """OPTIC searches on after its first plan; a watcher stops it at the bound."""
        found = self._found()
        if found is None:
            raise EngineMissing(self.missing() or "the engine 'optic' is missing")
        first = ["-N"] if given.request.first_plan else []
        return [*found, *first, str(given.domain), str(given.problem_file)]

    def refuse(self, problem: Problem, scale: int) -> None:
        """OPTIC's 32-bit milliseconds must hold the shortest conceivable schedule, and each number
        in the files.
        """
        needed = problem.bounds.makespan.value * scale + 2 * len(problem.activities) * EPSILON
        if needed > LARGEST:
            raise _too_large("the schedule takes at least", problem.bounds.makespan.value * scale)
        written = [a.duration_min for a in problem.activities]
        written += [d for i in range(len(written)) if (d := problem.effective_deadline(i))]
        written += [a.latest_start for a in problem.activities if a.latest_start is not None]
        if max(written, default=0) * scale > LARGEST:
            raise _too_large("the task has times of up to", max(written) * scale)


def _too_large(subject: str, units: int) -> Refusal:
    return Refusal(
        f"{subject} {units} planner time units, but OPTIC's clock ends at {float(LARGEST)}",
        hint="use --engine kairos, or target 'cpsat'",
    )
