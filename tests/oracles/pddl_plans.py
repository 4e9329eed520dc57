"""Two opinions on plans of the original domain and problem: unified-planning's validator and ours.

Ours (`pddl_validity`) knows all of PDDL2.1, level 3; unified-planning's is by other people.
"""

from __future__ import annotations

import re
import warnings
from pathlib import Path
from typing import Any

from oracles.pddl_validity import reason_against


class Judge:
    """Validates plan texts for one domain and problem."""

    def __init__(self, folder: Path) -> None:
        from unified_planning.environment import get_environment
        from unified_planning.io import PDDLReader

        get_environment().credits_stream = None
        self.reader = PDDLReader()
        domain, problem = (
            (folder / f"{name}.pddl").read_text("utf-8") for name in ("domain", "problem")
        )
        self.texts = domain, problem
        # A metric says nothing about validity, and it cannot read some.
        problem = re.sub(r"\(:metric (?:[^()]|\((?:[^()]|\([^()]*\))*\))*\)", "", problem)
        self.problem = self.reader.parse_problem_string(domain, problem)

    def accepts(self, plan_text: str) -> bool:
        """Whether the plan is valid."""
        from unified_planning.engines import ValidationResultStatus
        from unified_planning.shortcuts import PlanValidator

        plan = self.reader.parse_plan_string(self.problem, plan_text)
        with warnings.catch_warnings():
            # It warns that it may not support a metric or function, neither of which it needs.
            warnings.simplefilter("ignore", UserWarning)
            with PlanValidator(name="up_time_triggered_validator") as validator:
                result: Any = validator.validate(self.problem, plan)
        return bool(result.status is ValidationResultStatus.VALID)

    def finds_valid(self, plan_text: str) -> bool:
        """Whether our own judge accepts the plan."""
        return reason_against(*self.texts, plan_text) is None
