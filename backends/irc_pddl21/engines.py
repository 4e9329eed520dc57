"""The engines of this target: each planner by itself, and the portfolio of those that are here."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import replace
from typing import ClassVar

from irc.diagnostics import Code, Diagnostic
from irc.targets import (
    Engine,
    EngineFailed,
    EngineMissing,
    Limits,
    OnProgress,
    Outcome,
    Program,
    Refusal,
)
from irc_pddl21.planners import Aries, Kairos, Optic
from irc_pddl21.runs import DEFAULT_SECONDS, Planner
from irc_pddl21.strategy import better, proven

__all__ = ["Aries", "Kairos", "Optic", "Portfolio", "all_engines"]


class Portfolio(Engine):
    """One planner after another within one time limit, until the bound is met; the best is kept.

    OPTIC where there is one, else kairos; then aries; then kairos where OPTIC had its place, at
    once if OPTIC gave nothing.
    """

    name: ClassVar[str] = "auto"

    first_share = 0.85
    """Of the time limit, for the first planner while another is waiting."""

    def __init__(self, planners: tuple[Planner, ...]) -> None:
        self.planners = planners

    def missing(self) -> str | None:
        """Why none of them can run."""
        reasons = [planner.missing() for planner in self.planners]
        return None if None in reasons else "; ".join(r for r in reasons if r)

    def _lineup(self) -> list[Planner]:
        here = [p for p in self.planners if p.missing() is None]
        main = [p for p in here if p.name != Aries.name]
        return main[:1] + [p for p in here if p.name == Aries.name]

    def solve(
        self, program: Program, limits: Limits, on_progress: OnProgress | None = None
    ) -> Outcome:
        """The best answer of all; raises what the last planner raised if none answers."""
        began = time.perf_counter()
        total = DEFAULT_SECONDS if limits.seconds is None else limits.seconds
        best: Outcome | None = None
        notes: list[Diagnostic] = []
        trouble: Exception | None = None
        queue = self._lineup()
        fallback = [p for p in self.planners if p not in queue and p.missing() is None]
        while queue:
            planner = queue.pop(0)
            left = total - (time.perf_counter() - began)
            if left < 0.1:
                break
            share = left * self.first_share if queue or fallback else left
            try:
                outcome = planner.solve(program, replace(limits, seconds=share), on_progress)
            except (EngineFailed, EngineMissing, Refusal) as error:
                trouble = error
                notes.append(Diagnostic(Code.NO_ANSWER, f"{planner.name}: {error}"))
            else:
                notes += outcome.notes
                best = better(program.problem, best, outcome)
                if proven(program.problem, best):
                    break
            if not queue or best is None or best.schedule is None:
                queue, fallback = fallback[:1] + queue, fallback[1:]
        if best is None:
            raise trouble or EngineFailed("no planner answered in time")
        return replace(best, notes=tuple(notes), seconds=time.perf_counter() - began)


def all_engines() -> Mapping[str, Engine]:
    """The engines of this target by name."""
    planners = (Optic(), Kairos(), Aries())
    return {"auto": Portfolio(planners), **{p.name: p for p in planners}}
