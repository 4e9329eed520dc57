"""The engine of this target: ortools' CP-SAT, in this process."""

from __future__ import annotations

from importlib.util import find_spec
from typing import ClassVar

from irc.targets import Engine, Limits, OnProgress, Outcome, Program


class OrTools(Engine):
    """CP-SAT through ortools' Python package."""

    name: ClassVar[str] = "ortools"

    def missing(self) -> str | None:
        """The reason why ortools cannot be imported, or None if it can."""
        if find_spec("ortools") is None:
            return "the engine 'ortools' is not installed: pip install ortools"
        return None

    def solve(
        self, program: Program, limits: Limits, on_progress: OnProgress | None = None
    ) -> Outcome:
        """The objectives in their order; `optimal` and `infeasible` are CP-SAT's own proofs.

        If actions repeat, the model is deepened until there is a schedule, and then to the depth
        that leaves nothing out, if there is one.
        """
        from irc_cpsat.solving.deepening import DeepeningSearch

        return DeepeningSearch(self.name, program.problem, limits, on_progress).run()
