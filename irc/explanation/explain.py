"""Explains a task: a conflict if it has no schedule, otherwise the critical chain."""

from __future__ import annotations

from dataclasses import replace

from irc.checks import run_checks
from irc.diagnostics import InputError, Report
from irc.diagnostics.source import Pointer
from irc.driver.compile import reporting_refusals
from irc.driver.judge import Answer
from irc.driver.solve import solve_task
from irc.explanation.chain import HandOver, Link, critical_chain
from irc.explanation.contention import horizon_without_limits, resource_conflict
from irc.explanation.demand import demand_conflict
from irc.explanation.minimise import Conflict
from irc.explanation.result import ChainStep, Explanation, RenderedStatement, located
from irc.explanation.task_conflict import task_conflict
from irc.explanation.temporal import temporal_conflict
from irc.explanation.wording import in_words, setup_in_words
from irc.model import Task
from irc.passes import run_passes
from irc.passes.mandatory import mandatory_part
from irc.passes.restrict import decide_presence
from irc.problem import Problem
from irc.problem.statements import (
    Kind,
    Side,
    Statement,
    activities_of,
    in_canonical_order,
    pointer_of,
    problem_of,
)
from irc.retiming.slack import slacks
from irc.schedule import Schedule, Status
from irc.targets import Budget, Cancellation, SolveOptions, get_backend
from irc.targets.interrupt import ended_by_interrupt, lost
from irc.targets.refuter import Refuter

TARGET = "cpsat"
"""The target whose solver decides conflicts that time alone does not."""

AFTERWARDS_SHARE = 0.1
"""The part of a time limit that is kept for the critical chain and its words, at most."""


def explain_task(
    task: Task,
    time_limit: float | None = None,
    *,
    cancel: Cancellation | None = None,
    spent: float = 0.0,
) -> Explanation:
    """The explanation of a task: why it has no schedule, or why its schedule is not shorter.

    `time_limit` is in seconds of wall-clock time for the whole explanation, of which some may be
    `spent` already; `cancel` ends it earlier, with what is known by then. Raises `InputError` if
    the task has faults other than that it has no schedule, or an element that the solver's target
    does not support; `EngineMissing` or `EngineFailed` as solving does, and `KeyboardInterrupt`
    where ^C comes before anything is known.
    """
    with ended_by_interrupt(cancel) as ending:
        budget = Budget(time_limit, spent=spent, cancel=ending)
        explanation = explain_within(task, budget)
        if explanation.feasible is None:
            lost(ending)
    done = explanation.status is Status.OPTIMAL or explanation.conflict
    return replace(
        explanation,
        source=task.source,
        seconds=round(budget.elapsed, 3),
        interrupted=budget.is_cancelled and not (done and explanation.minimal),
    )


def explain_within(task: Task, budget: Budget) -> Explanation:
    """The explanation of a task, as part of a longer call."""
    checked = run_checks(task, lint=False)
    if not checked.report.ok and not checked.report.contradicts:
        raise InputError(checked.report)
    # (If the part that every schedule contains is infeasible, so is the whole task.)
    problem, _ = mandatory_part(decide_presence(checked.problem))
    if checked.report.ok:
        return _with_solver(task, problem, checked.problem, budget)
    explanation = _without_solver(task, problem, checked.problem, budget)
    if explanation is None:
        explanation = _of_elements(task, checked.problem, budget, "checks")
        if not explanation.conflict:
            explanation = _by_checks(task, checked.report)
    return replace(explanation, reasons=checked.report.located().errors)


def _without_solver(
    task: Task, problem: Problem, whole: Problem, budget: Budget
) -> Explanation | None:
    """A minimal conflict for the faults of the checks; None if statements do not show it."""
    conflict = temporal_conflict(problem, budget)
    if conflict is not None and _is_about_all(conflict, problem, whole):
        return _infeasible(task, problem, conflict, "time")
    conflict = demand_conflict(problem)
    if conflict is not None and _is_about_all(conflict, problem, whole):
        return _infeasible(task, problem, conflict, "capacity")
    return None


def _is_about_all(conflict: Conflict[Statement], problem: Problem, whole: Problem) -> bool:
    """Whether its statements are all that matters: each activity occurs once, in one way.

    Elsewhere a goal, a choice of modes, a number of occurrences or a set-up plays a part, too.
    """
    if any(s.kind is Kind.CAPACITY and problem.resources[s.of].setups for s in conflict.statements):
        return False
    plain = {
        a.id
        for a in whole.activities
        if not (a.details.optional or a.details.modes or a.details.repeats is not None)
    }
    return all(
        problem.activities[i].id in plain
        for statement in conflict.statements
        for i in activities_of(problem, statement)
    )


def _by_checks(task: Task, report: Report) -> Explanation:
    """Returns why the checks rule every schedule out, where no conflict is known."""
    return Explanation(
        Status.INFEASIBLE,
        task.name,
        task.time_unit,
        minimal=False,
        by="checks",
        reason="; ".join(d.message for d in report.errors),
    )


def _with_solver(
    task: Task, problem: Problem, whole_problem: Problem, budget: Budget
) -> Explanation:
    """The explanation with a solver; `problem` is what every schedule of the whole contains."""
    whole = problem is whole_problem
    # One worker and one seed: the same task gets the same explanation.
    options = SolveOptions(TARGET, time_limit=None, workers=1, seed=0)
    part = budget.at_most(budget.left - min(budget.elapsed, AFTERWARDS_SHARE * budget.limit))
    answer = solve_task(task, options, part)
    if answer.schedule.answered:
        return _feasible(task, problem, answer) if whole else _solved(task, answer)
    found = _unanswered(task, problem, whole_problem, answer, budget)
    return replace(found, reasons=answer.schedule.reasons)


def _unanswered(
    task: Task, problem: Problem, whole: Problem, answer: Answer, budget: Budget
) -> Explanation:
    """Why the solver has found no schedule."""
    if answer.schedule.status is not Status.INFEASIBLE:
        return Explanation(answer.schedule.status, task.name, task.time_unit)
    refuter = None if budget.is_over else get_backend(TARGET).refuter()
    if problem is not whole and not _is_refuted(problem, refuter, budget):
        return _of_elements(task, whole, budget, "solver")
    with reporting_refusals(task):
        conflict = None if refuter is None else resource_conflict(problem, refuter, budget)
    if conflict is None:
        return Explanation(Status.INFEASIBLE, task.name, task.time_unit, minimal=False, by="solver")
    if not _is_about_all(conflict, problem, whole):
        return _of_elements(task, whole, budget, "solver")
    return _infeasible(task, problem, conflict, "solver")


def _of_elements(task: Task, problem: Problem, budget: Budget, by: str) -> Explanation:
    """A conflict among anything that the task says; empty where none was found in time."""
    conflict = task_conflict(task, problem, TARGET, budget)
    found = () if conflict is None else conflict.statements
    rendered = [RenderedStatement(e.kind, e.text, e.pointer) for e in found]
    return Explanation(
        Status.INFEASIBLE,
        task.name,
        task.time_unit,
        conflict=located(sorted(rendered, key=lambda r: r.pointer), task.source),
        minimal=conflict is not None and conflict.minimal,
        by=by,
    )


def _is_refuted(problem: Problem, refuter: Refuter | None, budget: Budget) -> bool:
    """Whether the mandatory part alone has no schedule."""
    if refuter is None:
        return False
    horizon = horizon_without_limits(problem)
    part = budget.at_most(_REFUTING_SECONDS)
    return refuter.decide(problem, horizon, part) is Status.INFEASIBLE


_OF_THE_CLOCK = frozenset(
    (
        *(Kind.TASK_DEADLINE, Kind.GROUP_DEADLINE, Kind.DEADLINE),
        *(Kind.START, Kind.LATEST_START, Kind.EARLIEST_END, Kind.RELEASE),
    )
)
"""The statements that name an hour."""

_REFUTING_SECONDS = 60.0


def _solved(task: Task, answer: Answer) -> Explanation:
    """The explanation of a schedule with state, stock or choices: its value and its proof."""
    schedule = answer.schedule
    first = schedule.objective[0]
    if schedule.status is Status.OPTIMAL:
        proof = f"no schedule is better: proved by {schedule.engine}"
    else:
        proof = "a better schedule may exist"
    return Explanation(
        schedule.status,
        task.name,
        task.time_unit,
        schedule=schedule,
        bound=first.bound,
        proof=f"{proof}; the critical chain is shown only for tasks without state, stock, "
        "calendars and choices",
    )


def _infeasible(
    task: Task, problem: Problem, conflict: Conflict[Statement], by: str
) -> Explanation:
    statements = conflict.statements
    if conflict.excess is None:
        statements = tuple(in_canonical_order(statements))
    rendered = [_rendered(problem, statement) for statement in statements]
    return Explanation(
        Status.INFEASIBLE,
        task.name,
        task.time_unit,
        conflict=located(rendered, task.source),
        minimal=conflict.minimal,
        by=by,
        reason=_reason(problem, conflict),
    )


def _rendered(problem: Problem, statement: Statement) -> RenderedStatement:
    side = None if statement.side is Side.BOTH else str(statement.side)
    return RenderedStatement(
        str(statement.kind),
        in_words(problem, statement),
        pointer_of(problem, statement),
        side,
    )


def _reason(problem: Problem, conflict: Conflict[Statement]) -> str | None:
    """The missing time, or the bound that shows the conflict; None if there is no such number."""
    if conflict.excess is not None:
        return _cycle_in_words(problem, conflict)
    part = problem_of(problem, conflict.statements, horizon_without_limits(problem))
    if part.deadline is None:
        return None
    bound = run_passes(part).bounds.makespan
    if bound.value <= part.deadline:
        return None
    return f"at least {problem.time_text(bound.value)} are needed: {bound.reason}"


def _cycle_in_words(problem: Problem, conflict: Conflict[Statement]) -> str:
    """The reason for a conflict of time alone, a cycle in the temporal network."""
    excess = problem.time_text(conflict.excess or 0)
    kinds = {statement.kind for statement in conflict.statements}
    if not kinds & _OF_THE_CLOCK:
        if any(s.side is Side.MOST for s in conflict.statements):
            return f"their limits are {excess} apart"
        return "they form a cycle: each waits for the previous one, and the first for the last"
    return f"one after another they need {excess} more than there is"


def _feasible(task: Task, problem: Problem, answer: Answer) -> Explanation:
    schedule = answer.schedule
    links = critical_chain(problem, schedule)
    slack = slacks(problem, schedule)
    steps = None if links is None else steps_of(task, problem, links)
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


def steps_of(task: Task, problem: Problem, links: tuple[Link, ...]) -> tuple[ChainStep, ...]:
    """The links of a critical chain in the words and the unit of the task."""
    rendered = located([_rendered_link(problem, link) for link in links], task.source)
    return tuple(
        ChainStep(statement, problem.to_units(link.start), problem.to_units(link.end))
        for statement, link in zip(rendered, links, strict=True)
    )


def _rendered_link(problem: Problem, link: Link) -> RenderedStatement:
    if link.hand_over is not None:
        return _rendered_hand_over(problem, link.hand_over)
    statement = link.difference.statement
    if statement is not None:
        return _rendered(problem, statement)
    name = problem.activities[(link.difference.dst - 1) // 2].id
    origin = problem.activities[(link.difference.dst - 1) // 2].origin
    return RenderedStatement("time", f"{name!r} can start at once", origin)


def _rendered_hand_over(problem: Problem, hand_over: HandOver) -> RenderedStatement:
    resource = problem.resources[hand_over.resource]
    if hand_over.back:
        words = setup_in_words(problem, hand_over)
        return RenderedStatement("no_idle", words, (*resource.origin, "no_idle"))
    if hand_over.setup:
        words = setup_in_words(problem, hand_over)
        return RenderedStatement("setup", words, (*resource.origin, "setups"))
    before, after = (
        problem.activities[i].id for i in (hand_over.before, hand_over.after) if i is not None
    )
    pointer: Pointer = (*resource.origin, "capacity")
    if hand_over.needed:
        return RenderedStatement("hand_over", f"{resource.id!r}: {before!r} → {after!r}", pointer)
    order = f"{resource.id!r}: {before!r} before {after!r}, in the order of the schedule"
    return RenderedStatement("order", order, pointer)


def _proof(answer: Answer, links: tuple[Link, ...] | None) -> str:
    schedule, problem = answer.schedule, answer.problem
    if links is not None and not any(link.hand_over for link in links):
        return "no schedule is shorter: the chain needs no resource, so every schedule contains it"
    least = problem.time_text(problem.bounds.makespan.value)
    if _reaches(schedule, problem):
        return f"no other order is better: {problem.bounds.makespan.reason}"
    if schedule.status is Status.OPTIMAL:
        return f"no other order is better: proved by {schedule.engine}"
    reason = problem.bounds.makespan.reason
    return f"another order may be better: at least {least} are needed ({reason})"


def _reaches(schedule: Schedule, problem: Problem) -> bool:
    return schedule.makespan == problem.to_units(problem.bounds.makespan.value)
