"""kairos, a Python package that runs in a child process."""

from __future__ import annotations

import sys
from importlib.util import find_spec
from pathlib import Path
from typing import ClassVar

from irc.problem import Problem
from irc.targets import Refusal
from irc_pddl21.planners.planner import Planner, PlannerInput

LARGEST = 10**13
"""kairos keeps time in doubles, which soon after this lose its epsilon; it then finds nothing."""


class KairosPlanner(Planner):
    """The kairos planner (pip install kairos-planner), embedded."""

    name: ClassVar[str] = "kairos"
    searches: ClassVar[tuple[str, ...]] = ("novelty", "")
    lifted_searches: ClassVar[tuple[str, ...]] = ("goals", "", "lama-novelty", "novelty")

    def missing(self) -> str | None:
        """The reason why kairos cannot be imported, or None if it can."""
        if find_spec("kairos") is None:
            return (
                "the engine 'kairos' is missing: pip install kairos-planner "
                "(it has wheels for Linux only)"
            )
        return None

    def refuse(self, problem: Problem, scale: int) -> None:
        """The epsilon must not get lost in the shortest conceivable schedule."""
        if problem.bounds.makespan.value * scale > LARGEST:
            raise Refusal(
                "the times of this task are beyond what kairos can tell apart",
                hint="use target 'cpsat'",
            )

    def command(self, given: PlannerInput) -> list[str]:
        """The worker script, which loads only kairos (`-P` keeps this folder off the path)."""
        return [
            sys.executable,
            "-P",
            str(Path(__file__).with_name("kairos_worker.py")),
            str(given.domain),
            str(given.problem_file),
            f"{given.seconds:.3f}",
            str(given.options.memory_limit or 0),
            str(float(given.target)),
            str(given.options.workers or 1),
            str(given.options.seed),
            "first" if given.request.first_plan else "best",
            *([given.request.search] if given.request.search else []),
        ]
