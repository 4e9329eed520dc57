"""The road from a task to an explanation."""

from __future__ import annotations

from dataclasses import replace
from time import perf_counter

from irc.checks import run_checks
from irc.diagnostics import Code, InputError
from irc.diagnostics.source import Pointer
from irc.driver.compile import refusals_told
from irc.driver.judge import Answer
from irc.driver.solve import solve_task
from irc.explanation.chain import HandOver, Link, critical_chain
from irc.explanation.contention import horizon_without_limits, resource_conflict
from irc.explanation.demand import demand_conflict
from irc.explanation.minimise import Conflict
from irc.explanation.result import Explanation, Step, Told, located
from irc.explanation.temporal import temporal_conflict
from irc.explanation.wording import in_words
from irc.model import Task
from irc.passes import run_passes
from irc.passes.mandatory import mandatory_part
from irc.problem import Problem
from irc.problem.statements import (
    Kind,
    Side,
    Statement,
    in_canonical_order,
    pointer_of,
    problem_of,
)
from irc.retiming.slack import slacks
from irc.schedule import Schedule, Status
from irc.targets import Limits, get_backend
from irc.targets.refuter import Refuter

TARGET = "cpsat"
"""The target whose solver decides what time alone does not."""

_INFEASIBLE = frozenset((Code.CYCLE, Code.WINDOW, Code.TOO_LATE, Code.DEMAND, Code.LAGS))
"""Faults of a task that say that it has no schedule: they are explained, not refused."""


def explain_task(task: Task, time_limit: float | None = None) -> Explanation:
    """Why a task has no schedule, or what makes its schedule as long as it is.

    `time_limit` in seconds of wall-clock time for all of it. Raises `InputError` where the task
    has faults of another kind than that it cannot be scheduled, or says what the solver's target
    cannot take; `EngineMissing` or `EngineFailed` as solving does.
    """
    began = perf_counter()
    until = began + (float("inf") if time_limit is None else time_limit)
    checked = run_checks(task, lint=False)
    if any(d.code not in _INFEASIBLE for d in checked.report.errors):
        raise InputError(checked.report)
    # (What cannot hold of the part that every schedule contains cannot hold at all.)
    problem, _ = mandatory_part(checked.problem)
    if not checked.report.ok:
        explanation = _without_solver(task, problem, until)
        if explanation is None:
            raise InputError(checked.report)
    else:
        explanation = _with_solver(task, problem, until, whole=problem is checked.problem)
    return replace(explanation, source=task.source, seconds=round(perf_counter() - began, 3))


def _without_solver(task: Task, problem: Problem, until: float) -> Explanation | None:
    """What the checks found, as a minimal conflict; None where it is not in the lowered task."""
    conflict = temporal_conflict(problem, until)
    if conflict is not None:
        return _infeasible(task, problem, conflict, "time")
    conflict = demand_conflict(problem)
    return None if conflict is None else _infeasible(task, problem, conflict, "capacity")


def _with_solver(task: Task, problem: Problem, until: float, *, whole: bool) -> Explanation:
    """`whole`: the problem is all of the task, not only its mandatory part."""
    # One worker and one seed: the same task gets the same explanation.
    limits = Limits(_left(until), workers=1, seed=0)
    answer = solve_task(task, TARGET, limits=limits)
    if answer.schedule.answered:
        return _feasible(task, problem, answer) if whole else _solved(task, answer)
    if answer.schedule.status is not Status.INFEASIBLE:
        return Explanation(answer.schedule.status, task.name, task.time_unit)
    refuter = get_backend(TARGET).refuter()
    if not whole and not _is_refuted(problem, refuter, until):
        return Explanation(
            Status.INFEASIBLE,
            task.name,
            task.time_unit,
            minimal=False,
            by="solver",
            reason=_RICH,
        )
    with refusals_told(task):
        conflict = None if refuter is None else resource_conflict(problem, refuter, until)
    if conflict is None:
        return Explanation(Status.INFEASIBLE, task.name, task.time_unit, minimal=False, by="solver")
    return _infeasible(task, problem, conflict, "solver")


_RICH = (
    "state, stock, calendars or choices play a part in it; which statements is told only of "
    "durations, precedence, dates and resources"
)


def _is_refuted(problem: Problem, refuter: Refuter | None, until: float) -> bool:
    """Whether the mandatory part alone has no schedule."""
    if refuter is None:
        return False
    seconds = min(_left(until) or _REFUTING_SECONDS, _REFUTING_SECONDS)
    horizon = horizon_without_limits(problem)
    return refuter.decide(problem, horizon, seconds) is Status.INFEASIBLE


_OF_THE_CLOCK = frozenset(
    (Kind.TASK_DEADLINE, Kind.DEADLINE, Kind.START, Kind.LATEST_START, Kind.RELEASE)
)
"""The statements that name an hour."""

_REFUTING_SECONDS = 60.0


def _solved(task: Task, answer: Answer) -> Explanation:
    """Of a task with state, stock or choices: what it came to, and how far that is proven."""
    schedule = answer.schedule
    first = schedule.objective[0]
    if schedule.status is Status.OPTIMAL:
        proof = f"nothing is better: proved by {schedule.engine}"
    else:
        proof = "something better may exist"
    return Explanation(
        schedule.status,
        task.name,
        task.time_unit,
        schedule=schedule,
        bound=first.bound,
        proof=f"{proof}; a chain is told only of tasks without state, stock, calendars and choices",
    )


def _left(until: float) -> float | None:
    left = until - perf_counter()
    return None if left == float("inf") else max(0.01, left)


def _infeasible(task: Task, problem: Problem, conflict: Conflict, by: str) -> Explanation:
    statements = conflict.statements
    if conflict.excess is None:
        statements = tuple(in_canonical_order(statements))
    told = [_told(problem, statement) for statement in statements]
    return Explanation(
        Status.INFEASIBLE,
        task.name,
        task.time_unit,
        conflict=located(told, task.source),
        minimal=conflict.minimal,
        by=by,
        reason=_reason(problem, conflict),
    )


def _told(problem: Problem, statement: Statement) -> Told:
    side = None if statement.side is Side.BOTH else str(statement.side)
    return Told(
        str(statement.kind),
        in_words(problem, statement),
        pointer_of(problem, statement),
        side,
    )


def _reason(problem: Problem, conflict: Conflict) -> str | None:
    """By how much time is short, or which bound says it all; None where there is no such number."""
    if conflict.excess is not None:
        return _way_round(problem, conflict)
    part = problem_of(problem, conflict.statements, horizon_without_limits(problem))
    if part.deadline is None:
        return None
    bound = run_passes(part).bounds.makespan
    if bound.value <= part.deadline:
        return None
    return f"at least {problem.time_text(bound.value)} are needed: {bound.reason}"


def _way_round(problem: Problem, conflict: Conflict) -> str:
    """What a cycle of demands on time comes to."""
    excess = problem.time_text(conflict.excess or 0)
    kinds = {statement.kind for statement in conflict.statements}
    if not kinds & _OF_THE_CLOCK:
        if any(s.side is Side.MOST for s in conflict.statements):
            return f"their limits are {excess} apart"
        return "they go round: each waits for the one before it, and the first for the last"
    return f"one after another they need {excess} more than there is"


def _feasible(task: Task, problem: Problem, answer: Answer) -> Explanation:
    schedule = answer.schedule
    links = critical_chain(problem, schedule)
    slack = slacks(problem, schedule)
    steps = None if links is None else _steps(task, problem, links)
    bound = schedule.objective[0].bound if schedule.objective else None
    return Explanation(
        schedule.status,
        task.name,
        task.time_unit,
        schedule=schedule,
        chain=steps,
        slack={entry.id: problem.to_units(slack[entry.id]) for entry in schedule.entries},
        bound=bound,
        proof=_proof(answer, links),
    )


def _steps(task: Task, problem: Problem, links: tuple[Link, ...]) -> tuple[Step, ...]:
    told = located([_link_told(problem, link) for link in links], task.source)
    return tuple(
        Step(t, problem.to_units(link.start), problem.to_units(link.end))
        for t, link in zip(told, links, strict=True)
    )


def _link_told(problem: Problem, link: Link) -> Told:
    if link.hand_over is not None:
        return _hand_over_told(problem, link.hand_over)
    statement = link.difference.statement
    if statement is not None:
        return _told(problem, statement)
    name = problem.activities[(link.difference.dst - 1) // 2].id
    origin = problem.activities[(link.difference.dst - 1) // 2].origin
    return Told("time", f"{name!r} can start at once", origin)


def _hand_over_told(problem: Problem, hand_over: HandOver) -> Told:
    before, after = (problem.activities[i].id for i in (hand_over.before, hand_over.after))
    resource = problem.resources[hand_over.resource]
    pointer: Pointer = (*resource.origin, "capacity")
    if hand_over.needed:
        return Told("hand_over", f"{resource.id!r}: {before!r} → {after!r}", pointer)
    return Told("order", f"{resource.id!r}: {before!r} before {after!r}, as it was kept", pointer)


def _proof(answer: Answer, links: tuple[Link, ...] | None) -> str:
    schedule, problem = answer.schedule, answer.problem
    if links is not None and not any(link.hand_over for link in links):
        return "nothing is shorter: the chain needs no resource, so every schedule has to keep it"
    least = problem.time_text(problem.bounds.makespan.value)
    if _reaches(schedule, problem):
        return f"no other order is better: {problem.bounds.makespan.reason}"
    if schedule.status is Status.OPTIMAL:
        return f"no other order is better: proved by {schedule.engine}"
    reason = problem.bounds.makespan.reason
    return f"another order may be better: at least {least} are needed ({reason})"


def _reaches(schedule: Schedule, problem: Problem) -> bool:
    return schedule.makespan == problem.to_units(problem.bounds.makespan.value)
