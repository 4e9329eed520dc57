"""The engines of this target: each planner by itself, and the portfolio of the installed ones."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import ClassVar

from irc.diagnostics import Code, Diagnostic
from irc.schedule import Status
from irc.targets import (
    Budget,
    Engine,
    EngineFailed,
    EngineMissing,
    Outcome,
    Program,
    Refusal,
    SolveOptions,
)
from irc_pddl21.planners.aries import AriesPlanner
from irc_pddl21.planners.kairos import KairosPlanner
from irc_pddl21.planners.optic import OpticPlanner
from irc_pddl21.planners.planner import LEAST_SECONDS, Planner, limited
from irc_pddl21.search.strategy import better, proven, solve_with


class PlannerEngine(Engine):
    """One planner, with the strategies that make good plans of its quick ones."""

    planner: ClassVar[Planner]

    def missing(self) -> str | None:
        """The reason why the planner cannot run here and how to get it, or None if it can."""
        return self.planner.missing()

    def solve(self, program: Program, options: SolveOptions, budget: Budget) -> Outcome:
        """The best answer this planner gives within the budget, by the strategy of the task."""
        return solve_with(self.planner, program, options, budget)


class Optic(PlannerEngine):
    """OPTIC, an external command."""

    name: ClassVar[str] = OpticPlanner.name
    planner: ClassVar[Planner] = OpticPlanner()


class Kairos(PlannerEngine):
    """kairos (pip install kairos-planner)."""

    name: ClassVar[str] = KairosPlanner.name
    planner: ClassVar[Planner] = KairosPlanner()


class Aries(PlannerEngine):
    """aries (pip install irc-compiler[up])."""

    name: ClassVar[str] = AriesPlanner.name
    planner: ClassVar[Planner] = AriesPlanner()


class Portfolio(Engine):
    """One planner after another within one budget, until the bound is met; the best is kept.

    OPTIC where there is one, else kairos; then aries; then kairos where OPTIC had its place, at
    once if OPTIC gave nothing.
    """

    name: ClassVar[str] = "auto"

    first_share = 0.85
    """Of the time left, for the first planner while another is waiting."""

    def __init__(self, planners: tuple[PlannerEngine, ...]) -> None:
        self.planners = planners

    def missing(self) -> str | None:
        """The reason why none of them can run, or None."""
        reasons = [planner.missing() for planner in self.planners]
        return None if None in reasons else "; ".join(r for r in reasons if r)

    def _lineup(self) -> list[PlannerEngine]:
        here = [p for p in self.planners if p.missing() is None]
        main = [p for p in here if p.name != Aries.name]
        return main[:1] + [p for p in here if p.name == Aries.name]

    def solve(self, program: Program, options: SolveOptions, budget: Budget) -> Outcome:
        """The best answer of all; raises what the last planner raised if none answers."""
        budget = limited(budget)
        best: Outcome | None = None
        notes: list[Diagnostic] = []
        failure: Exception | None = None
        queue = self._lineup()
        fallback = [p for p in self.planners if p not in queue and p.missing() is None]
        while queue:
            if budget.is_cancelled or (budget.left < LEAST_SECONDS and (best or failure)):
                break
            planner = queue.pop(0)
            share = self.first_share if queue or fallback else 1
            try:
                outcome = planner.solve(program, options, budget.share(share))
            except (EngineFailed, EngineMissing, Refusal) as error:
                failure = error
                notes.append(Diagnostic(Code.NO_ANSWER, f"{planner.name}: {error}"))
            else:
                notes += outcome.notes
                best = better(program.problem, best, outcome)
                if proven(program.problem, best):
                    break
            if not queue or best is None or best.schedule is None:
                queue, fallback = fallback[:1] + queue, fallback[1:]
        if best is None and budget.is_cancelled:
            return Outcome(Status.UNKNOWN, self.name, notes=tuple(notes), seconds=budget.elapsed)
        if best is None:
            raise failure or EngineFailed("no planner answered in time")
        return replace(best, notes=tuple(notes), seconds=budget.elapsed)


def all_engines() -> Mapping[str, Engine]:
    """The engines of this target by name."""
    planners = (Optic(), Kairos(), Aries())
    return {"auto": Portfolio(planners), **{p.name: p for p in planners}}
