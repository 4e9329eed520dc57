"""The runs of one planner on a program: one budget for all of them, the best plan kept."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from irc.diagnostics import Code, Diagnostic
from irc.problem import Problem
from irc.schedule import Schedule, Status
from irc.targets import Budget, EngineFailed, Outcome, Program, Refusal, SolveOptions
from irc_pddl21.objective_values import objective_values
from irc_pddl21.planners.planner import LEAST_SECONDS, Planner, PlanRequest, limited
from irc_pddl21.planners.run import run_planner


@dataclass(frozen=True, slots=True)
class Tactics:
    """Parts of the strategies, so that measurements can switch them off.

    `bound`: ask for a plan under the deadline "makespan = lower bound". `hint`: show the planner
    the order of the list schedule. `tighten`: ask for a plan that is a tick shorter than the best.
    `steps`: ask for one that also differs from it in a few places only. `anytime`: let the planner
    minimise by itself. `shortened`: where state and resources meet, ask with shortened actions too.
    `original`: ask for a plan of the PDDL that the task was made of.
    """

    bound: bool = True
    hint: bool = True
    tighten: bool = True
    steps: bool = True
    anytime: bool = True
    shortened: bool = True
    original: bool = True


ALL_TACTICS = Tactics()


@dataclass
class PlannerSession:
    """Asks one planner for plans of one program, in turn."""

    planner: Planner
    program: Program
    options: SolveOptions
    budget: Budget
    tactics: Tactics = ALL_TACTICS
    best: Schedule | None = None
    notes: list[Diagnostic] = field(default_factory=list)
    runs: int = 0
    of_original: bool = False
    """Whether the best plan is one of the PDDL that the task was made of."""
    limits: dict[str, int] = field(default_factory=dict)
    """The greatest set-up time (ticks) and cost of all plans that are asked for from now on."""
    _error: Exception | None = None

    def __post_init__(self) -> None:
        self.budget = limited(self.budget)

    @property
    def problem(self) -> Problem:
        """The program's own problem."""
        return self.program.problem

    @property
    def left(self) -> float:
        """Seconds until the limit."""
        return self.budget.left

    @property
    def is_over(self) -> bool:
        """Whether there is no time for another run; the first one gets some in any case, unless
        the call was cancelled or there is an answer already.
        """
        begun = self.runs > 0 or self.best is not None
        return self.budget.is_cancelled or (begun and self.left < LEAST_SECONDS)

    def ask(
        self,
        problem: Problem,
        seconds: float,
        *,
        enough: int,
        first_plan: bool = True,
        search: str = "",
        shortened: bool = False,
        original: bool = False,
    ) -> Schedule | None:
        """The plan that one run of the planner on `problem` finds; the best of all is kept."""
        if self.is_over:
            return None
        self.runs += 1
        limits = dict(self.limits)
        request = PlanRequest(problem, first_plan, enough, search, shortened, original, limits)
        budget = self.budget.at_most(seconds)
        try:
            outcome = run_planner(self.planner, self.program, request, self.options, budget)
        except (EngineFailed, Refusal) as error:
            self._error = error
            return None
        self.notes = list(dict.fromkeys([*self.notes, *outcome.notes]))
        if outcome.schedule is not None:
            self.keep(outcome.schedule, original=original)
        return outcome.schedule

    def keep(self, schedule: Schedule, *, original: bool = False) -> None:
        """Remembers a schedule if it is the best so far. `original`: it is of the original PDDL."""
        problem = self.problem
        values = objective_values(problem, schedule)
        if self.best is None or values < objective_values(problem, self.best):
            self.best = schedule
            self.of_original = original

    def outcome(self, status: Status | None = None) -> Outcome:
        """The best plan of all runs. Raises the last run's error where no run gave an answer."""
        name = self.planner.name
        if self.of_original:
            name += ", which read the original PDDL"
        if self.best is not None:
            notes = tuple(n for n in self.notes if n.code is not Code.NO_ANSWER)
            status = status or Status.FEASIBLE
            return Outcome(status, name, self.best, 0, self.budget.elapsed, notes)
        if self._error is not None:
            raise self._error
        return Outcome(Status.UNKNOWN, name, None, 0, self.budget.elapsed, tuple(self.notes))


def ticks(problem: Problem, schedule: Schedule) -> int:
    """The makespan of a schedule, in ticks."""
    return problem.whole_ticks(schedule.makespan)


def with_deadline(problem: Problem, deadline: int) -> Problem:
    """The problem with a deadline that is no later than this."""
    if problem.deadline is not None and problem.deadline <= deadline:
        return problem
    return replace(problem, deadline=deadline)
