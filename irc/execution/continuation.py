"""Asks an engine for a continuation of a running task.

An engine gets either the whole problem, in which the history is fixed, or the residual problem with
the present as time 0 (`Backend.begins_now`). Either way the answer is of the whole.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from irc.diagnostics import Code, Diagnostic
from irc.driver.asking import STEP_AFTERWARDS_SHARE, asked
from irc.driver.compile import is_hurried
from irc.driver.judge import SHORTCUT_ENGINE, finish
from irc.driver.progress import telling
from irc.driver.quick import QUICK_ENGINE, quick_outcome
from irc.execution.freeze import FrozenProblem, with_groups
from irc.execution.history import History
from irc.execution.least_movement import with_fewer_moves
from irc.execution.numbers import with_limits_held
from irc.execution.residual import PastError, ResidualProblem, residual_problem
from irc.execution.stabilise import stabilised
from irc.execution.state import key_of
from irc.execution.state_conflicts import with_values_held
from irc.execution.warm_start import warm_start
from irc.model import Task
from irc.model.garbage import without_garbage
from irc.model.quantities import Number
from irc.model.world_changes import is_world_change
from irc.passes import bounded_by_stock, order_from_state, resource_bounds, run_passes
from irc.passes.contention import drop_uncontended
from irc.passes.critical_path import heads_and_tails
from irc.passes.grid import bound_on_grid
from irc.passes.mandatory import least_occurrences
from irc.passes.reduction import reduce_transitively
from irc.problem import Problem
from irc.problem.decisions import AnswerError
from irc.problem.objective_values import schedule_values
from irc.retiming.limits import too_late
from irc.retiming.retime import earliest_schedule
from irc.retiming.to_schedule import schedule_of
from irc.schedule import ABANDONED, BEGUN, CANCELLED, Entry, Schedule, Status
from irc.targets import (
    Backend,
    Budget,
    Engine,
    EngineFailed,
    EngineMissing,
    ObjectiveLevel,
    OnProgress,
    Outcome,
    Program,
    Progress,
    SolveOptions,
)

if TYPE_CHECKING:
    from irc.validation import Verdict

Judge = Callable[[Schedule], str | None]

PROVER = "cpsat"
"""The target that proves which groups can be finished, where the chosen target proves nothing."""

AFTERWARDS_SHARE = 0.1
"""The part of the time left that is kept for after the engine: for the prover, if the engine finds
nothing, or for the search for a schedule in which less moves."""

_PASSES = (
    bounded_by_stock,
    reduce_transitively,
    drop_uncontended,
    heads_and_tails,
    resource_bounds,
    bound_on_grid,
)


@dataclass
class Repair:
    """One repair: a frozen problem, the engine that continues it, and the budget."""

    task: Task
    frozen: FrozenProblem
    history: History
    at: Number
    backend: Backend
    engine: Engine
    options: SolveOptions
    budget: Budget
    _last: tuple[Schedule, Verdict] | None = None

    def attempt(self, given_up: Sequence[int]) -> tuple[Outcome, Problem]:
        """The outcome where these groups are given up, and the problem it answers.

        What the history alone does not meet, by stock or by state, open activities meet for it if
        any continuation does; else it is carried. Raises `EngineMissing` or `EngineFailed`.
        """
        found = self.all_met(given_up)
        if found[0].status is not Status.INFEASIBLE or self.frozen.all_carried is None:
            return found
        carried = with_groups(self.frozen, given_up, all_carried=True)
        return self._attempt(carried, given_up)

    def all_met(self, given_up: Sequence[int]) -> tuple[Outcome, Problem]:
        """As `attempt`, where open activities meet all that they may for the history."""
        return self._attempt(with_groups(self.frozen, given_up), given_up)

    def _attempt(self, problem: Problem, given_up: Sequence[int]) -> tuple[Outcome, Problem]:
        frozen = order_from_state(problem)
        whole, impossible = self._passed(frozen)
        if impossible is not None:
            return impossible, whole
        if not whole.has_contention and not any(whole.previous.places):
            return _by_critical_path(whole), whole
        missing = self.engine.missing()
        if missing is not None:
            raise EngineMissing(missing)
        if self.backend.begins_now:
            return self._from_now(frozen, whole, given_up), whole
        if not whole.is_plain:
            found = warm_start(whole, self.frozen.executed, self.history.plan)
            whole = replace(whole, previous=replace(whole.previous, warm_start=found))
        outcome = self._solved(whole, given_up, self._telling(whole, given_up))
        return self._with_fewer_moves(whole, outcome, given_up), whole

    def _with_fewer_moves(
        self, whole: Problem, outcome: Outcome, given_up: Sequence[int]
    ) -> Outcome:
        return with_fewer_moves(
            whole, outcome, lambda s: self.judged(s, given_up) is None, self.budget
        )

    def tried(self, problem: Problem, budget: Budget) -> Outcome:
        """The outcome of another problem of the whole, within a budget of its own.

        Raises `EngineFailed` or `irc.targets.Refusal`.
        """
        whole, impossible = self._passed(problem)
        if impossible is not None:
            return impossible
        if not whole.has_contention:
            return _by_critical_path(whole)
        options = replace(self.options, on_progress=None)
        return self.engine.solve(Program(self.backend, self.task, whole), options, budget)

    @without_garbage()
    def _passed(self, problem: Problem, since: int = 0) -> tuple[Problem, Outcome | None]:
        return _passed(problem, since, hurried=is_hurried(self.budget))

    def with_status(self, schedule: Schedule, given_up: Sequence[int]) -> Schedule:
        """Marks the entries as cancelled, as abandoned where their group is given up, or as begun
        where they were observed to begin now.
        """
        groups, activities = self.frozen.problem.groups, self.frozen.problem.activities
        kept = {i for k, g in enumerate(groups) if k not in given_up for i in g.members}
        lost = {activities[i].id for k in given_up for i in groups[k].members if i not in kept}

        clock = self.task.clock
        world = {action.id for action in self.task.actions if is_world_change(action, clock)}
        begun = {key for key in self.frozen.begun if key[0] not in world}

        def marked(entry: Entry) -> Entry:
            before = self.history.entries.get(key_of(entry))
            cancelled = before is not None and before.status == CANCELLED
            now = entry.start == self.at and key_of(entry) in begun
            own = ABANDONED if entry.id in lost else BEGUN if now else None
            status = CANCELLED if cancelled else own
            return entry if entry.status == status else replace(entry, status=status)

        return replace(schedule, entries=tuple(map(marked, schedule.entries)))

    def _solved(
        self,
        problem: Problem,
        given_up: Sequence[int],
        options: SolveOptions,
        judge: Judge | None = None,
    ) -> Outcome:
        """The engine's outcome, or the compiler's own where there is no time for an engine."""
        program = Program(self.backend, self.task, problem, judge=judge)
        fault = judge or (lambda schedule: self.judged(schedule, given_up))
        if judge is None and options.on_progress is not None:
            self._report_first(problem, given_up, options.on_progress)
        alone = self.backend.proves and not self.backend.begins_now
        part = 1 if alone else 1 - AFTERWARDS_SHARE
        return asked(
            program,
            self.engine,
            options,
            self.budget,
            lambda s: fault(s) is None,
            part,
            STEP_AFTERWARDS_SHARE,
        )

    def _report_first(
        self, problem: Problem, given_up: Sequence[int], on_progress: OnProgress
    ) -> None:
        """Reports the compiler's own schedule, if it is valid, before an engine begins."""
        quick = quick_outcome(problem)
        if quick is None or quick.schedule is None:
            return
        schedule = quick.schedule
        if self.judged(schedule, given_up) is not None:
            return
        name = problem.objectives[0]
        bound = problem.to_units(quick.bound) if name == "makespan" else None
        level = ObjectiveLevel(name, schedule_values(problem, schedule)[name], bound)
        on_progress(Progress(self.budget.elapsed, quick.engine, name, (level,), lambda: schedule))

    def _telling(
        self,
        whole: Problem,
        given_up: Sequence[int],
        residual: ResidualProblem | None = None,
    ) -> SolveOptions:
        """The options that report progress, of the residual problem too, as that of the whole."""

        def approve(outcome: Outcome) -> Schedule:
            assert outcome.schedule is not None
            fault = self.judged(outcome.schedule, given_up)
            if fault is not None:
                raise EngineFailed(f"the answer was rejected by the validator: {fault}")
            marked = replace(outcome, schedule=self.with_status(outcome.schedule, given_up))
            return finish(self.task, whole, marked, self.backend.name, self.budget.elapsed)

        options = telling(self.options, self.budget, approve)
        tell = options.on_progress
        if residual is None or tell is None:
            return options

        def tell_whole(progress: Progress) -> None:
            try:
                merged = residual.merged(whole, progress.schedule())
            except AnswerError:
                return  # The judge says so, too, and the engine goes on.
            values = schedule_values(whole, merged)
            levels = tuple(ObjectiveLevel(name, values[name]) for name in whole.levels)
            tell(replace(progress, levels=levels, found=lambda: merged))

        return replace(options, on_progress=tell_whole)

    def judged(self, schedule: Schedule, given_up: Sequence[int]) -> str | None:
        """The faults of a whole history; None if it is valid, with no plans for the past."""
        begun = self.frozen.begun
        for entry in schedule.entries:
            if entry.start < self.at and key_of(entry) not in begun:
                return f"{entry.id!r} has not begun, and would have before now"
        verdict = self.verdict_on(self.with_status(schedule, given_up))
        return None if verdict.valid else "; ".join(v.message for v in verdict.violations[:2])

    @without_garbage()
    def verdict_on(self, schedule: Schedule) -> Verdict:
        """The validator's verdict on a whole history; it judges the same entries once."""
        from irc.validation import still_holds, validate

        if self._last is not None:
            known, verdict = self._last
            same = (known.entries, known.left_out) == (schedule.entries, schedule.left_out)
            if same and still_holds(verdict, schedule):
                return verdict
        verdict = validate(self.task, schedule, self.at)
        if not schedule.objective:
            self._last = schedule, verdict
        return verdict

    def _from_now(self, frozen: Problem, whole: Problem, given_up: Sequence[int]) -> Outcome:
        """The outcome of the residual problem, with the history before it."""
        now = self.frozen.now
        try:
            held = with_limits_held(with_values_held(frozen))
            residual = residual_problem(held, self.frozen.executed, now)
        except PastError as error:
            return _impossible(str(error))
        left, impossible = self._passed(residual.problem, now)
        if impossible is not None:
            return impossible
        if whole.bounds.makespan.value - now > left.bounds.makespan.value:
            bound = whole.bounds.makespan
            left = left.with_bound(bound.value - now, bound.reason)

        judge = _WithHistory(self, residual, whole, given_up)
        found = (
            self._solved(left, given_up, self._telling(whole, given_up, residual), judge)
            if left.has_contention
            else _by_critical_path(left, now)
        )
        if found.schedule is None:
            own = self._as_before(whole, given_up) if found.status is Status.UNKNOWN else None
            return found if own is None else replace(own, notes=found.notes)
        try:
            merged = residual.merged(whole, found.schedule)
        except AnswerError as error:
            raise EngineFailed(f"the answer does not continue the history: {error}") from None
        outcome = _of_whole(found, left, whole, merged, now)
        if self.budget.is_over:
            return outcome
        kept = stabilised(
            whole,
            merged,
            self.history.entries.values(),
            self.options.share,
            lambda schedule: self.judged(schedule, given_up) is None,
            self.budget,
        )
        return self._with_fewer_moves(whole, _stabilised(outcome, whole, kept), given_up)

    def _as_before(self, whole: Problem, given_up: Sequence[int]) -> Outcome | None:
        """The previous plan, shifted, where it can still be carried out in its order."""
        found = warm_start(whole, self.frozen.executed, self.history.plan)
        if not found:
            return None
        schedule = schedule_of(whole, found)
        if self.judged(schedule, given_up) is not None:
            return None
        return Outcome(Status.FEASIBLE, QUICK_ENGINE, schedule, whole.bounds.makespan.value)


@dataclass(frozen=True, slots=True)
class _WithHistory:
    """Judges a plan of the residual problem together with the history; None if it is valid."""

    repair: Repair
    residual: ResidualProblem
    whole: Problem
    given_up: Sequence[int]

    def __call__(self, schedule: Schedule) -> str | None:
        try:
            merged = self.residual.merged(self.whole, schedule)
        except AnswerError as error:
            return str(error)
        return self.repair.judged(merged, self.given_up)


def _passed(problem: Problem, since: int, *, hurried: bool) -> tuple[Problem, Outcome | None]:
    """The problem after the passes; an outcome where they show that it has no schedule.

    `since` is when its time begins, in ticks.
    """
    try:
        problem = run_passes(problem, _PASSES, lambda: hurried)
    except ValueError:
        return problem, _impossible("the history and the lags of the task contradict each other")
    bound = problem.bounds.makespan
    if problem.deadline is not None and bound.value > problem.deadline:
        least = f"no continuation ends before {problem.time_text(since + bound.value)}"
        return problem, _impossible(f"{least} ({bound.reason})")
    for i, (activity, head) in enumerate(
        zip(problem.activities, problem.bounds.heads, strict=True)
    ):
        if not least_occurrences(activity):
            continue
        late = too_late(problem, i, head, head + activity.duration_min, since)
        if late is not None:
            return problem, _impossible(late)
    return problem, None


def _by_critical_path(problem: Problem, since: int = 0) -> Outcome:
    """The outcome with all activities as early as possible; infeasible if one is too late then."""
    try:
        placed = earliest_schedule(problem)
    except AnswerError as error:
        return _impossible(str(error))
    for i, place in enumerate(placed):
        late = too_late(problem, i, place.start, place.end, since)
        if late is not None:
            return _impossible(late)
    schedule = schedule_of(problem, placed)
    return Outcome(Status.OPTIMAL, SHORTCUT_ENGINE, schedule, problem.bounds.makespan.value)


def _of_whole(found: Outcome, left: Problem, whole: Problem, merged: Schedule, now: int) -> Outcome:
    """The outcome of the residual problem as one of the whole; the history adds to each value."""
    assert found.schedule is not None
    part, all_of_it = schedule_values(left, found.schedule), schedule_values(whole, merged)
    levels = []
    for level in found.levels:
        bound = level.bound
        if bound is not None and level.name == "makespan":
            bound = whole.to_units(now) + bound if bound else None
        elif bound is not None:
            bound += all_of_it[level.name] - part[level.name]
        levels.append(ObjectiveLevel(level.name, all_of_it[level.name], bound))
    bound_now = now + found.bound if found.bound else 0
    return replace(found, schedule=merged, bound=bound_now, levels=tuple(levels))


def _stabilised(outcome: Outcome, whole: Problem, schedule: Schedule) -> Outcome:
    """The outcome with a schedule that moves less: its bounds stay, its values are new."""
    values = schedule_values(whole, schedule)
    levels = tuple(replace(level, value=values[level.name]) for level in outcome.levels)
    status = outcome.status
    if status is Status.OPTIMAL and whole.previous.stability:
        status = Status.FEASIBLE
    return replace(outcome, status=status, schedule=schedule, levels=levels)


def _impossible(why: str) -> Outcome:
    hint = "a later deadline or more capacity would be needed"
    note = Diagnostic(Code.NO_CONTINUATION, why, hint=hint)
    return Outcome(Status.INFEASIBLE, SHORTCUT_ENGINE, notes=(note,))
