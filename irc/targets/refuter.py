"""The protocol of a solver that supports explanations; a backend may have one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

from irc.problem import Problem
from irc.problem.statements import Difference, Statement
from irc.schedule import Status
from irc.targets.budget import Budget


@dataclass(frozen=True, slots=True)
class Assumptions:
    """A problem without its statements, and these statements as separate assumptions.

    In `problem` every activity may start at any time and last any time from 0 on. Its demands and
    the capacities are there, but a demand holds only under the statement of its use (`uses`, by
    activity and index of the use) and under the statements of the capacities of *all* members of
    its pool (`capacities`, by index in `Problem.resources`). `differences` are all statements
    about time. `horizon` is an upper bound on the end of some optimal schedule.
    """

    problem: Problem
    differences: Sequence[Difference]
    uses: Mapping[tuple[int, int], Statement]
    capacities: Mapping[int, Statement]
    horizon: int


class Refuter(Protocol):
    """A solver that proves infeasibility, reproducibly unless the budget ends its search."""

    def core(self, assumptions: Assumptions, budget: Budget) -> frozenset[Statement] | None:
        """Statements that cannot hold together, not necessarily few; None if none were found."""

    def decide(self, problem: Problem, horizon: int, budget: Budget) -> Status:
        """Whether the problem has a schedule: `FEASIBLE`, `INFEASIBLE` or `UNKNOWN`.

        It answers `FEASIBLE` only with a schedule that exact re-timing has confirmed.
        """
