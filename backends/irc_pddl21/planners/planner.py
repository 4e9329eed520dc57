"""A planner: a command that reads two PDDL files and prints plans."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from types import MappingProxyType
from typing import Any, ClassVar, NamedTuple

from irc.problem import Problem
from irc.targets import Budget, Program, SolveOptions
from irc_pddl21.encoding.time_scale import EPSILON

DEFAULT_SECONDS = 60.0
"""The time limit where none is given: these planners search on after their best plan."""

LEAST_SECONDS = 0.1
"""The least time for a run: with less time left, only the first one begins."""


def limited(budget: Budget) -> Budget:
    """The rest of a budget, from now on; `DEFAULT_SECONDS` if it has no limit."""
    return budget.share(1) if budget.is_limited else budget.at_most(DEFAULT_SECONDS)


class PlanRequest(NamedTuple):
    """The plan that a planner is asked for.

    `problem` is the one it reads: the program's own, or one with fewer alternatives or an earlier
    deadline.
    `first_plan`: any plan of it will do. A plan whose makespan is `enough` (ticks) ends the run.
    `search` is one of the planner's kinds of search, "" its usual one. `shortened`: with actions
    that are shorter by the slack; see `irc_pddl21.decoding.rounding`. `original`: it reads the PDDL
    that the task was made of. `limits` are the greatest set-up time (ticks) and cost, by the short
    names of the objectives.
    """

    problem: Problem
    first_plan: bool
    enough: int
    search: str = ""
    shortened: bool = False
    original: bool = False
    limits: Mapping[str, int] = MappingProxyType({})


@dataclass(frozen=True, slots=True)
class PlannerInput:
    """The input of one run: a request, two files, the meaning of their names, what it may use."""

    request: PlanRequest
    program: Program
    names: Mapping[str, Any]
    domain: Path
    problem_file: Path
    options: SolveOptions
    seconds: float

    @property
    def target(self) -> Fraction:
        """A plan of this length (planner time) re-times to enough; half a tick is for drift."""
        scale: int | Fraction = self.names["planner_units_per_tick"]
        return (self.request.enough + Fraction(1, 2)) * scale


class Planner(ABC):
    """A planner: its command line, its epsilon, and the numbers that its clock can hold."""

    name: ClassVar[str]

    epsilon: ClassVar[Fraction] = EPSILON

    under_deadlines: ClassVar[bool] = True
    """Whether it finds plans under hard deadlines quickly."""

    searches: ClassVar[tuple[str, ...]] = ("",)
    """The kinds of search to try in turn where one plan is wanted."""

    lifted_searches: ClassVar[tuple[str, ...]] = ("",)
    """Those for PDDL that somebody wrote, the greediest first."""

    @abstractmethod
    def missing(self) -> str | None:
        """The reason why the planner cannot run here and how to get it, or None if it can."""

    @abstractmethod
    def command(self, given: PlannerInput) -> list[str]:
        """The command line to execute."""

    def environment(self, given: PlannerInput) -> Mapping[str, str] | None:
        """The child's environment; None for this process's own."""
        return None

    @abstractmethod
    def refuse(self, problem: Problem, scale: int) -> None:
        """Raises `Refusal` where the planner cannot hold the problem's numbers."""
