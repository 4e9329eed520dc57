"""What an explanation asks of a solver: a small protocol that a backend may furnish."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

from irc.problem import Problem
from irc.problem.statements import Difference, Statement
from irc.schedule import Status


@dataclass(frozen=True, slots=True)
class Assumptions:
    """A problem with its statements taken out of it, and those statements one by one.

    In `problem` every activity takes any time from 0 on, whenever. Its open demands and capacities
    are there, but hold only under the statement of the use (`uses`, by activity and index of the
    use) and under those of the capacities of *all* members of a pool (`capacities`, by index in
    `Problem.resources`). `differences` are all demands on time. Nothing ends after `horizon` needs
    to.
    """

    problem: Problem
    differences: Sequence[Difference]
    uses: Mapping[tuple[int, int], Statement]
    capacities: Mapping[int, Statement]
    horizon: int


class Refuter(Protocol):
    """A solver that can say why not. `seconds` are of wall-clock time; both are reproducible."""

    def core(self, assumptions: Assumptions, seconds: float) -> frozenset[Statement] | None:
        """Statements that cannot hold together, not necessarily few; None if none were found."""

    def decide(self, problem: Problem, horizon: int, seconds: float) -> Status:
        """Whether the problem has a schedule: `FEASIBLE`, `INFEASIBLE` or `UNKNOWN`.

        `FEASIBLE` only with a schedule that stood up to exact re-timing.
        """
