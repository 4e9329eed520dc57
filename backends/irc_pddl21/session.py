"""A planner at work on a program: one time limit over all of its runs, the best plan kept."""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace

from irc.diagnostics import Code, Diagnostic
from irc.problem import Problem
from irc.schedule import Schedule, Status
from irc.targets import EngineFailed, Limits, OnProgress, Outcome, Program, Refusal
from irc_pddl21.runs import DEFAULT_SECONDS, Planner, Wish
from irc_pddl21.worth import worth_of

LEAST_SECONDS = 0.1
"""With less time than this no run is begun."""


@dataclass(frozen=True, slots=True)
class Tactics:
    """Parts of the strategies, so that measurements can switch them off.

    `bound`: ask for a plan under the deadline "makespan = lower bound". `hint`: show the planner
    the order of the list schedule. `tighten`: ask for a plan that is a tick shorter than the best.
    `steps`: ask for one that also differs from it in a few places only. `anytime`: let the planner
    minimise by itself. `loose`: where state and resources meet, ask with loose text as well.
    """

    bound: bool = True
    hint: bool = True
    tighten: bool = True
    steps: bool = True
    anytime: bool = True
    loose: bool = True


ALL_TACTICS = Tactics()


@dataclass
class Session:
    """Runs of one planner on one program, in turn."""

    planner: Planner
    program: Program
    limits: Limits
    on_progress: OnProgress | None = None
    tactics: Tactics = ALL_TACTICS
    best: Schedule | None = None
    notes: list[Diagnostic] = field(default_factory=list)
    runs: int = 0
    _trouble: Exception | None = None
    _began: float = field(default_factory=time.perf_counter)

    @property
    def problem(self) -> Problem:
        """The program's own problem."""
        return self.program.problem

    @property
    def spent(self) -> float:
        """Seconds since the session began."""
        return time.perf_counter() - self._began

    @property
    def left(self) -> float:
        """Seconds until the limit."""
        total = DEFAULT_SECONDS if self.limits.seconds is None else self.limits.seconds
        return max(0.0, total - self.spent)

    @property
    def is_over(self) -> bool:
        """Whether there is no time for another run; the first one always gets some."""
        return self.runs > 0 and self.left < LEAST_SECONDS

    def ask(
        self,
        problem: Problem,
        seconds: float,
        *,
        enough: int,
        first_plan: bool = True,
        search: str = "",
        loose: bool = False,
    ) -> Schedule | None:
        """One run of the planner on `problem`, and what it found; the best of all is kept."""
        if self.is_over:
            return None
        self.runs += 1
        wish = Wish(problem, first_plan, enough, search, loose)
        given = max(LEAST_SECONDS, min(seconds, self.left))
        try:
            outcome = self.planner.attempt(self.program, wish, self.limits, given, self.on_progress)
        except (EngineFailed, Refusal) as error:
            self._trouble = error
            return None
        self.notes = list(dict.fromkeys([*self.notes, *outcome.notes]))
        if outcome.schedule is not None:
            self.keep(outcome.schedule)
        return outcome.schedule

    def keep(self, schedule: Schedule) -> None:
        """Remembers a schedule if it is the best so far."""
        problem = self.problem
        if self.best is None or worth_of(problem, schedule) < worth_of(problem, self.best):
            self.best = schedule

    def outcome(self, status: Status | None = None) -> Outcome:
        """What the session came to. Raises the last run's trouble where no run gave an answer."""
        name = self.planner.name
        if self.best is not None:
            told = tuple(n for n in self.notes if n.code is not Code.NO_ANSWER)
            status = status or Status.FEASIBLE
            return Outcome(status, name, self.best, 0, self.spent, told)
        if self._trouble is not None:
            raise self._trouble
        return Outcome(Status.UNKNOWN, name, None, 0, self.spent, tuple(self.notes))


def ticks(problem: Problem, schedule: Schedule) -> int:
    """The makespan of a schedule, in ticks."""
    return int(schedule.makespan / problem.tick)


def with_deadline(problem: Problem, deadline: int) -> Problem:
    """The problem with a deadline that is no later than this."""
    if problem.deadline is not None and problem.deadline <= deadline:
        return problem
    return replace(problem, deadline=deadline)
