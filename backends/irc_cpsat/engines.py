"""The engine of this target: ortools' CP-SAT, in this process."""

from __future__ import annotations

import sys
from importlib.util import find_spec
from typing import ClassVar

from irc.local_search.ways import LARGE
from irc.targets import Budget, Engine, Exchange, Outcome, Program, SolveOptions

LOADING_SECONDS = 0.3
LOADED_SECONDS = 0.02


class OrTools(Engine):
    """CP-SAT through ortools' Python package.

    `bounds`, `hints` and `improves` let measurements switch off what the compiler adds to a model,
    and the local search beside it.
    """

    name: ClassVar[str] = "ortools"
    is_repeatable: ClassVar[bool] = True

    def __init__(
        self,
        *,
        bounds: bool = True,
        hints: bool = True,
        improves: bool = True,
        exchange: Exchange | None = None,
    ) -> None:
        self.bounds, self.hints, self.improves = bounds, hints, improves
        self.exchange = exchange

    @property
    def loading_seconds(self) -> float:
        """About what it takes to load ortools, and to build a model."""
        return LOADED_SECONDS if "ortools.sat.python.cp_model" in sys.modules else LOADING_SECONDS

    def sharing(self, exchange: Exchange) -> OrTools:
        """One of several: each has a part of its own, and they exchange schedules and bounds."""
        return OrTools(
            bounds=self.bounds, hints=self.hints, improves=self.improves, exchange=exchange
        )

    def missing(self) -> str | None:
        """The reason why ortools cannot be imported, or None if it can."""
        if find_spec("ortools") is None:
            return "the engine 'ortools' is not installed: pip install ortools"
        return None

    def solve(self, program: Program, options: SolveOptions, budget: Budget) -> Outcome:
        """The objectives in their order; `optimal` and `infeasible` are CP-SAT's own proofs.

        If actions repeat, the model is deepened until there is a schedule, and then to the depth
        that leaves nothing out, if there is one. Large problems are left to local search.
        """
        # (Such a search is ended by the clock.)
        alone = self.improves and self.hints and not options.deterministic
        if alone and len(program.problem.activities) >= LARGE:
            from irc_cpsat.solving.large import large_outcome

            found = large_outcome(program.problem, options.seed, budget, options.on_progress)
            if found is not None:
                return found
        from irc_cpsat.loading import load_cp_model

        load_cp_model()
        from irc_cpsat.solving.deepening import DeepeningSearch

        search = DeepeningSearch(
            self.name,
            program.problem,
            options,
            budget,
            bounds=self.bounds,
            hints=self.hints,
            improves=self.improves,
            exchange=self.exchange,
        )
        return search.run()
