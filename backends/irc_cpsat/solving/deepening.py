"""Iterative deepening: models with more and more occurrences of the actions that repeat."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from ortools.sat.python import cp_model

from irc.diagnostics import Code, Diagnostic
from irc.local_search.search import begins_with_lists, may_apply
from irc.passes.fewer_moves import fewer_moves, knows_moves
from irc.passes.unroll import slots, unroll
from irc.problem import Problem
from irc.schedule import Status
from irc.targets import USUAL_WORK, Budget, EngineFailed, Exchange, Outcome, SolveOptions
from irc_cpsat.encoding.builder import Builder, Hint, Model, OutOfTimeError
from irc_cpsat.encoding.encode import write_model
from irc_cpsat.encoding.hints import hint_at, hinted, without_hint
from irc_cpsat.solving.asking import asked, solver_for
from irc_cpsat.solving.beside import LEAST_SECONDS, Beside
from irc_cpsat.solving.depth import (
    GREATEST_DEPTH,
    SLOTS_LIMIT,
    depths,
    enough,
    fits_a_model,
    within,
)
from irc_cpsat.solving.hinting import complete_hint
from irc_cpsat.solving.improving import Improving
from irc_cpsat.solving.levels import LevelResult, LexicographicResult, solve_levels
from irc_cpsat.solving.outcome import better, outcome_of
from irc_cpsat.solving.parts import improve_parts
from irc_cpsat.solving.reporting import Reporter, tell_hint
from irc_cpsat.solving.rounds import Rounds
from irc_cpsat.solving.solution import Answer, FoundSolution, Reached
from irc_cpsat.solving.variations import vary

_DEPTH_SHARE = 0.4
"""The part of the time left that a depth may take before a greater one is tried."""

_LISTING_SHARE = 0.1
_MOST_LISTING_SECONDS = 20.0
"""The part of the time, and the time, in which a list schedule with set-ups is improved at most."""

_MOST_SEARCHING_SECONDS = 3.0
"""The time that local search has for it at most, where it knows the problem."""

_MOVES_SHARE = 0.1
"""The part of all time left in which the compiler searches for fewer moves itself, at most."""

_PARTS_SHARE = 0.25
"""The part of all time left in which CP-SAT then searches parts for fewer moves, at most. (It ends
where no part has any, which it soon does where there are few moves.)
"""

_MOVES = 40
"""The number of orders that are tried for it at most, for each pair of activities."""

_UNIT_MOVES = 500_000
"""The orders of a unit of work are this, divided by the number of activities."""

_STATE_WORKERS = 8
"""With state, which of CP-SAT's searches succeeds differs from task to task: with fewer workers
than this it leaves the better ones out, whatever the number of processors."""

_HINTED_FROM = 1_000
"""Of fewer activities CP-SAT soon has a schedule of its own."""

_LEAST_SECONDS = 0.1
"""The least time for one model, or the whole limit if that is less."""


class DeepeningSearch:
    """Solves one problem within one budget."""

    def __init__(
        self,
        engine: str,
        problem: Problem,
        options: SolveOptions,
        budget: Budget,
        *,
        bounds: bool = True,
        hints: bool = True,
        improves: bool = True,
        exchange: Exchange | None = None,
    ) -> None:
        self.engine, self.problem, self.options = engine, problem, options
        self._clock = budget.share(1)
        self._work = options.work(budget)
        units = USUAL_WORK if options.work_limit is None else options.work_limit
        self.budget = self._clock if self._work is None else self._work.of(units)
        self._least = min(_LEAST_SECONDS, self.budget.limit)
        self.bounds, self.hints, self.improves = bounds, hints, improves
        # (Of actions that repeat, models of two searches may hold other numbers of occurrences.)
        repeats = any(a.details.repeats is not None for a in problem.activities)
        self.part = None if exchange is None else exchange.part
        self.exchange = None if repeats else exchange
        self._builder: Builder | None = None
        self._improving: Improving | None = None

    def run(self) -> Outcome:
        """The outcome within the budget; of a deterministic run, whether the clock has cut it."""
        outcome = self._run()
        return outcome if self._work is None else replace(outcome, is_cut=self._work.is_cut)

    def _run(self) -> Outcome:
        """The outcome at the first depth with a schedule, or at one that leaves nothing out."""
        best: Outcome | None = None
        depth = 0
        tried = list(depths(self.problem))
        for depth in tried:
            # To refute a depth can take for ever where the next one has an answer at once.
            best = self.solve_at(self.problem, depth, 1.0 if depth == tried[-1] else _DEPTH_SHARE)
            if best.schedule is not None or self.budget.is_over:
                break
        if best is None:
            notes = (_too_many_occurrences(),)
            return Outcome(Status.UNKNOWN, self.engine, seconds=self._clock.elapsed, notes=notes)
        return self._completed(best, depth)

    def solve_at(self, problem: Problem, depth: int, share: float) -> Outcome:
        """The outcome at one depth, within a share of the time that is left."""
        budget = self.budget.share(share)
        unrolled = unroll(problem, depth)
        wanted = self.improves and self.hints and may_apply(unrolled)
        self._improving = self._local_search(unrolled) if wanted else None
        try:
            return self._solved(unrolled, budget)
        finally:
            if self._improving is not None:
                self._improving.end()

    def _solved(self, unrolled: Problem, budget: Budget) -> Outcome:
        """The outcome of an unrolled problem."""
        found = self._listed(unrolled, budget)
        builder = Builder(unrolled, self.bounds, self.hints, found=found)
        builder.is_over = lambda: self.budget.is_over
        self._builder = builder
        try:
            built = write_model(builder)
        except OutOfTimeError as error:
            note = Diagnostic(Code.NO_ANSWER, f"{self.engine}: {error}")
            seconds = self._clock.elapsed
            return Outcome(Status.UNKNOWN, self.engine, notes=(note,), seconds=seconds)
        improving = self._improving
        if improving is None or not improving.is_met:
            complete_hint(built, budget)
        if (improving is None or improving.found is None) and not _hint_helps(unrolled, built):
            without_hint(built)
        if built.hint is not None and self.options.on_progress is not None:
            tell_hint(self.engine, built, self.budget, self.options.on_progress)
        try:
            result = solve_levels(built, self._solve, budget)
        except ValueError as error:
            raise EngineFailed(f"CP-SAT rejects the model: {error}") from None
        return self.outcome_of(unrolled, built, result)

    def _local_search(self, problem: Problem) -> Improving:
        return Improving(problem, self.options.seed, steady=self._work is not None)

    def _listed(self, problem: Problem, budget: Budget) -> Hint | None:
        """A list schedule, improved for a part of the time; None where the quick one will do."""
        improving = self._improving
        # (Whether llvmlite is there must not decide what a deterministic call does.)
        first = self._work is None and self._workers > 1 and begins_with_lists(problem)
        if improving is not None and first:
            # (In a thread of its own: the first search of all is compiled for some time.)
            improving.start()
            improving.wait(budget.share(_LISTING_SHARE).at_most(_MOST_SEARCHING_SECONDS))
            if improving.found is not None:
                return improving.found
        if not (problem.has_setups and self.hints):
            return None
        from irc.passes.setup_schedule import search_of

        search = search_of(problem)
        if search is None:
            return None
        part = budget.share(_LISTING_SHARE).at_most(_MOST_LISTING_SECONDS)
        moves = _MOVES * len(problem.activities) ** 2
        if self._work is not None:
            moves = min(moves, round(part.left * _UNIT_MOVES / len(problem.activities)))
            self._work.add(moves * len(problem.activities) / _UNIT_MOVES)
        search.improve(moves, lambda: part.is_over)
        return search.found

    def outcome_of(self, problem: Problem, built: Model, result: LexicographicResult) -> Outcome:
        """The outcome of one depth's result, at this moment."""
        outcome = outcome_of(self.engine, problem, built, result)
        return replace(outcome, seconds=self._clock.elapsed)

    def _completed(self, best: Outcome, depth: int) -> Outcome:
        """The answer at a depth that leaves nothing out, or a note that this one may."""
        problem = self.problem
        if best.schedule is not None and problem.objectives[0] == "makespan":
            problem = within(problem, problem.whole_ticks(best.schedule.makespan))
        needed = enough(problem, problem.deadline)
        complete = needed is not None and needed <= depth
        proven = best.status in (Status.OPTIMAL, Status.INFEASIBLE)
        if complete and (proven or self.budget.is_over):
            return best
        if needed is not None and fits_a_model(problem, needed) and not self.budget.is_over:
            deeper = self.solve_at(problem, max(needed, depth), 1.0)
            if deeper.schedule is not None:
                return better(best, deeper)
            if deeper.status is Status.INFEASIBLE and best.schedule is None:
                return deeper
        if complete:
            return best
        return _unproven(*self._deeper(best, depth))

    def _deeper(self, best: Outcome, depth: int) -> tuple[Outcome, int]:
        """The best answer at greater depths, while each uses all occurrences that it has."""
        deeper = 2 * depth
        while (
            self.problem.objectives[0] != "makespan"
            and _is_exhausted(self.problem, best, depth)
            and deeper <= GREATEST_DEPTH
            and fits_a_model(self.problem, deeper)
            and not self.budget.is_over
        ):
            found = self.solve_at(self.problem, deeper, _DEPTH_SHARE)
            if found.schedule is None:
                break
            best, depth, deeper = better(best, found), deeper, 2 * deeper
        return best, depth

    def _solve(
        self, built: Model, objective: str, earlier: Sequence[LevelResult], budget: Budget
    ) -> tuple[Any, Answer]:
        if budget.is_cancelled:
            return cp_model.UNKNOWN, Reached(0)
        if objective == "changes" and earlier:
            return self._few_moves(built, earlier, budget)
        budget = budget.at_least(self._least)
        # (Counted work has rounds for both, however little it is.)
        enough = budget.work is not None or budget.left > LEAST_SECONDS
        if self._improving is not None and not earlier and enough:
            return self._beside(built, objective, self._improving, budget)
        return self._asked(built, objective, earlier, budget)

    def _asked(
        self, built: Model, objective: str, earlier: Sequence[LevelResult], budget: Budget
    ) -> tuple[Any, cp_model.CpSolver]:
        """The status and the answer of CP-SAT alone."""
        solver = self._solver(self.options.workers)
        if self.options.on_progress is None:
            return asked(solver, built.model, budget), solver
        return self._reporter(built, objective, earlier).asked(solver, budget), solver

    def _few_moves(
        self, built: Model, earlier: Sequence[LevelResult], budget: Budget
    ) -> tuple[Any, Answer]:
        """The same for the number of moves, after searches for fewer ones."""
        found = self._begin_with_few_moves(built, budget)
        status, solver = self._asked(built, "changes", earlier, budget.at_least(self._least))
        if found is None or status in (cp_model.OPTIMAL, cp_model.MODEL_INVALID):
            return status, solver
        # (Of a large model CP-SAT may not come to its hint in time.)
        value = built.values["changes"]
        if status == cp_model.FEASIBLE and solver.value(value) <= found.value(value):
            return status, solver
        return cp_model.FEASIBLE, Reached(0, found)

    def _begin_with_few_moves(self, built: Model, budget: Budget) -> FoundSolution | None:
        """Makes a schedule with few moves the hint; the best solution of parts, if there is one.

        First the rules of the compiler are tried, then CP-SAT searches parts. (Both for a share of
        the time; how busy the machine is must not decide what a deterministic call does.)
        """
        known = hinted(built)
        if known is None or self._builder is None or not knows_moves(built.problem):
            return None
        if built.problem.previous.stability or self._work is not None:
            return None
        part = self.budget.share(_MOVES_SHARE)
        found = fewer_moves(built.problem, known, lambda: part.is_over)
        if found is not None:
            hint_at(self._builder, built, found)
            complete_hint(built, budget)
        share = self.budget.share(_PARTS_SHARE)
        return improve_parts(built, lambda: self._solver(1), share)

    def _beside(
        self, built: Model, objective: str, improving: Improving, budget: Budget
    ) -> tuple[Any, Answer]:
        """The status and the answer of CP-SAT and local search together."""
        assert self._builder is not None
        kind = Beside if budget.work is None else Rounds
        beside = kind(
            self._builder,
            built,
            improving,
            self._workers,
            budget,
            lambda: self._reporter(built, objective, ()),
            lambda workers, part, reporter, ended: reporter.asked(
                self._solver(workers), part, ended
            ),
            self.exchange,
        )
        return beside.run()

    @property
    def _workers(self) -> int:
        """The number of workers of CP-SAT and local search together."""
        return self.options.workers or os.cpu_count() or 1

    def _solver(self, workers: int | None) -> cp_model.CpSolver:
        solver = solver_for(self.problem, self.options.seed)
        if self.part is not None:
            vary(solver, self.part)
        if self.options.memory_limit is not None:
            solver.parameters.max_memory_in_mb = self.options.memory_limit
        if workers is not None:
            solver.parameters.num_workers = workers
        elif self.problem.has_state:
            solver.parameters.num_workers = max(_STATE_WORKERS, os.cpu_count() or 1)
        return solver

    def _reporter(self, built: Model, objective: str, earlier: Sequence[LevelResult]) -> Reporter:
        reporter = Reporter(
            self.engine, built, objective, earlier, self.budget, self.options.on_progress
        )
        # (Of actions that repeat a model holds some occurrences; more might do better.)
        reporter.proves = all(a.details.repeats is None for a in self.problem.activities)
        return reporter


def _hint_helps(problem: Problem, built: Model) -> bool:
    """Whether CP-SAT is to begin from the list schedule that is known of a problem.

    From its own first schedules it comes to better ones sooner; the horizon, which is no later than
    the list schedule, keeps it from worse ones (docs/benchmarks.md). A list schedule that meets the
    bound is the answer, and of a large problem it may be the only schedule for a long time.
    """
    if built.hint is None or not problem.is_plain or problem.objectives[0] != "makespan":
        return True
    reached = max((int(decision.end) for decision in built.hint[0]), default=0)
    met = reached <= problem.bounds.makespan.value
    return met or len(problem.activities) >= _HINTED_FROM or any(problem.previous.places)


def _is_exhausted(problem: Problem, best: Outcome, depth: int) -> bool:
    """Whether a schedule has all occurrences of a repeated action that a model of a depth holds."""
    if best.schedule is None:
        return False
    count = Counter(entry.id for entry in best.schedule.entries)
    return any(
        count[a.id] >= slots(a, depth) < slots(a, depth + 1)
        for a in problem.activities
        if a.details.repeats is not None
    )


def _unproven(best: Outcome, depth: int) -> Outcome:
    """The outcome without bounds: the proofs hold for this number of occurrences only."""
    levels = tuple(replace(level, bound=None) for level in best.levels)
    best = replace(best, bound=0, levels=levels)
    if best.status not in (Status.OPTIMAL, Status.INFEASIBLE):
        return best
    note = Diagnostic(
        Code.NO_ANSWER,
        f"at most {depth} occurrences of each repeated action were tried; "
        "more of them might do better",
        hint="a deadline of the task, or a 'max' for 'occurs', would make the answer certain",
    )
    status = Status.FEASIBLE if best.schedule is not None else Status.UNKNOWN
    return replace(best, status=status, notes=(*best.notes, note))


def _too_many_occurrences() -> Diagnostic:
    return Diagnostic(
        Code.NO_ANSWER,
        f"the repeated actions of this task have more than {SLOTS_LIMIT} occurrences, "
        "the most that a model is given",
        hint="a longer action that stands for several of them would do",
    )
