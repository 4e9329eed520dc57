"""aries through unified-planning, in a child process."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from fractions import Fraction
from importlib.util import find_spec
from pathlib import Path
from typing import ClassVar

from irc.problem import Problem
from irc.problem.horizon import safe_horizon
from irc.targets import Refusal
from irc_pddl21.planners.planner import Planner, PlannerInput

LARGE_EPSILON = Fraction(1, 10)
LARGEST = 100_000_000
"""aries counts tenths of a unit in 32 bits."""


class AriesPlanner(Planner):
    """aries through unified-planning (pip install irc-compiler[up])."""

    name: ClassVar[str] = "aries"
    epsilon: ClassVar[Fraction] = LARGE_EPSILON
    under_deadlines: ClassVar[bool] = False

    def missing(self) -> str | None:
        """The reason why aries cannot be imported, or None if it can."""
        if find_spec("unified_planning") is None or find_spec("up_aries") is None:
            return "the engine 'aries' is missing: pip install 'irc-compiler[up]'"
        return None

    def command(self, given: PlannerInput) -> list[str]:
        """The worker script (`-P` keeps this folder off the path)."""
        return [
            sys.executable,
            "-P",
            str(Path(__file__).with_name("aries_worker.py")),
            str(given.domain),
            str(given.problem_file),
            f"{given.seconds:.3f}",
        ]

    def environment(self, given: PlannerInput) -> Mapping[str, str]:
        """The horizon for aries, which plans up to 10,000 units by default."""
        horizon = _planner_horizon(given.request.problem, given.names["planner_units_per_tick"])
        return {**os.environ, "ARIES_PLANNING_HORIZON": str(horizon)}

    def refuse(self, problem: Problem, scale: int) -> None:
        """aries' 32-bit tenths must hold the horizon."""
        if _planner_horizon(problem, scale) > LARGEST:
            raise Refusal(
                "the times of this task are beyond aries' 32-bit clock",
                hint="use target 'cpsat'",
            )


def _planner_horizon(problem: Problem, scale: int) -> int:
    return (safe_horizon(problem) + 1) * scale + len(problem.activities)
