"""One step of repair: keeps the history and plans the open part again, on either target."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from irc.diagnostics import Code, Diagnostic, Findings, InputError, Report
from irc.driver.compile import reporting_refusals
from irc.driver.judge import explained, finish, reasons_for
from irc.events.suspend import suspended
from irc.execution.abandonment import best_continuation
from irc.execution.conflicts import overloaded
from irc.execution.continuation import Repair
from irc.execution.freeze import FrozenProblem, freeze
from irc.execution.history import History, ids
from irc.execution.infeasibility import what_is_in_the_way
from irc.execution.lowered import Lowered, lowered
from irc.execution.step import Step, moved
from irc.execution.stuck import in_words, what_is_stuck
from irc.model import Event, Task
from irc.model.canonical import task_sha256
from irc.model.garbage import without_garbage
from irc.model.quantities import Number
from irc.model.world_changes import is_world_change
from irc.passes.contention import merge_pools
from irc.problem import Problem
from irc.problem.choices import UnexplainedError
from irc.schedule import LeftOut, Status
from irc.targets import (
    Backend,
    Budget,
    Engine,
    EngineFailed,
    SolveOptions,
    get_backend,
    require_support,
)
from irc.targets.interrupt import ended_by_interrupt, lost

if TYPE_CHECKING:
    from irc.validation import Verdict

__all__ = ["Step", "solve_step"]

CHOICES_APART = 400
"""With more alternatives than this in all, pools are merged though moves within a pool count.
Members are then assigned after solving; each action gets its previous member if that is free."""


def solve_step(
    task: Task,
    history: History,
    at: Number,
    options: SolveOptions,
    events: tuple[Event, ...] = (),
    budget: Budget | None = None,
    *,
    since: Budget | None = None,
    known: Lowered | None = None,
) -> Step:
    """The best continuation of a history at `at`, for the task as it is in force.

    What cannot go on whatever else is done, because its resource is gone for good, say, is named
    and left out, and the rest is continued. `history` is as it is taken to be at `at`. `budget`
    replaces the time limit and the cancellation of the options; the limit counts from when the
    budget `since` was made. `known` is a problem that may be that of the task. Raises `InputError`
    (the target refuses the task, or the history does not fit it), `UnknownTarget`, `EngineMissing`
    or `EngineFailed`, and `KeyboardInterrupt` where ^C comes before there is any answer.
    """
    if budget is not None:
        return _step(task, history, at, options, events, budget, known)
    with ended_by_interrupt(options.cancel) as cancel:
        budget = replace(options, cancel=cancel).budget(since=since)
        step = _step(task, history, at, options, events, budget, known)
        if step.schedule.status is Status.UNKNOWN:
            lost(cancel)
    return step


def _step(
    task: Task,
    history: History,
    at: Number,
    options: SolveOptions,
    events: tuple[Event, ...],
    budget: Budget,
    known: Lowered | None,
) -> Step:
    backend = get_backend(options.target)
    engine = backend.engine(options.engine)
    require_support(task, backend)
    means = _Means(backend, engine, options, budget)
    problem, frozen = _lowered(task, history, at, means, known)
    stuck = what_is_stuck(frozen, problem)
    if not stuck:
        return _continued(task, (problem, frozen), history, at, means, events)
    names = frozenset(stuck.actions) | stuck.others
    rest = suspended(task, names, stuck.goals, at)
    cancelled = {**history.cancelled, **dict.fromkeys(names, at)}
    without = replace(history, cancelled=cancelled)
    step = _continued(rest, _lowered(rest, without, at, means), without, at, means, events)
    left_out: tuple[LeftOut, ...] = (*stuck.actions, *stuck.goals)
    schedule, gone = replace(step.schedule, task_sha256=task_sha256(task)), step.moved
    if schedule.answered:
        schedule = replace(schedule, left_out=left_out)
        gone = moved(history.state(at).open, schedule, history)
    stopped = [had.action for had in task.lapsed if had.repetition is None]
    notes = (*in_words(stuck, stopped), *step.notes)
    return replace(step, task=task, schedule=schedule, notes=notes, moved=gone)


@dataclass(frozen=True, slots=True)
class _Means:
    """The means by which a step is solved."""

    backend: Backend
    engine: Engine
    options: SolveOptions
    budget: Budget


@without_garbage()
def _lowered(
    task: Task, history: History, at: Number, means: _Means, known: Lowered | None = None
) -> tuple[Problem, FrozenProblem]:
    """The problem of a task, and the same with the history fixed."""
    state = history.state(at)
    instants = [at, *(t for e in history.entries.values() for t in (e.start, e.end))]
    instants += history.least_ends.values()
    problem = lowered(task, instants, known).problem
    previous = replace(problem.previous, stability=means.options.share)
    problem = replace(problem, previous=previous)
    if means.backend.begins_now or not state.open or _choices(problem) > CHOICES_APART:
        problem = merge_pools(problem, overloaded(problem, state.running))
    return problem, _frozen(task, problem, history, at)


def _continued(
    task: Task,
    lowered: tuple[Problem, FrozenProblem],
    history: History,
    at: Number,
    means: _Means,
    events: tuple[Event, ...],
) -> Step:
    """The best continuation of all that the task still asks for."""
    problem, frozen = lowered
    state, options = history.state(at), means.options
    repair = Repair(task, frozen, history, at, means.backend, means.engine, options, means.budget)
    with reporting_refusals(task):
        outcome, whole, given_up = best_continuation(repair)
    if outcome.status is Status.INFEASIBLE:
        why = what_is_in_the_way(repair) or outcome.notes or (_no_continuation(outcome.engine),)
        outcome = replace(outcome, notes=why)
    if outcome.schedule is not None:
        marked = repair.with_status(outcome.schedule, given_up)
        outcome = replace(outcome, schedule=marked)
    budget = means.budget
    schedule = finish(
        task, whole, outcome, means.backend.name, budget.elapsed, cancelled=budget.is_cancelled
    )
    notes = reasons_for(task, outcome)
    schedule = explained(schedule, notes)
    if schedule.answered:
        notes = (*notes, *_carried(repair.verdict_on(schedule)))
    return Step(
        at,
        events,
        ids(state.completed),
        ids(state.running),
        moved(state.open, schedule, history) if schedule.answered else 0,
        schedule,
        task,
        notes,
        tuple(problem.groups[k].id for k in given_up),
        ids(state.stopped),
    )


def _no_continuation(engine: str) -> Diagnostic:
    """The reason for a history without continuation where no limit in the way was found."""
    return Diagnostic(
        Code.NO_CONTINUATION,
        f"no schedule continues what has run: proved by {engine}",
        hint="undo or relax what the last events changed",
    )


def _choices(problem: Problem) -> int:
    """The number of alternatives of all uses together."""
    return sum(
        len(demand.alternatives)
        for activity in problem.activities
        for demand in activity.open_demands
        if len(demand.alternatives) > 1
    )


def _frozen(task: Task, problem: Problem, history: History, at: Number) -> FrozenProblem:
    try:
        changes = {a.id for a in task.actions if is_world_change(a, task.clock)}
        return freeze(problem, history, at, problem.whole_ticks(at), changes)
    except UnexplainedError as error:
        entry = error.entry
        findings = Findings()
        held = ", ".join(sorted(entry.resources)) or "nothing"
        findings.add(
            Code.BAD_SCHEDULE,
            f"{entry.id!r} has begun, but the schedule says that it holds {held}"
            + (f" in mode {entry.mode!r}" if entry.mode is not None else "")
            + ", which the task does not allow",
            hint="give the schedule that is being carried out, as written by `irc solve`",
        )
        raise InputError(Report(tuple(findings.items), task.source)) from None


def _carried(verdict: Verdict) -> list[Diagnostic]:
    """The conflicts that the history alone causes. Raises `EngineFailed` for any others."""
    if not verdict.valid:
        reasons = "; ".join(v.message for v in verdict.violations[:3])
        raise EngineFailed(f"the answer was rejected by the validator: {reasons}")
    return [
        Diagnostic(
            Code.CARRIED,
            violation.message,
            hint="it has begun already, so it continues; no open action may make it worse",
        )
        for violation in verdict.carried
    ]
