"""All checks of a task, in one run."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from irc.checks.structure import check_structure
from irc.checks.temporal import check_temporal
from irc.diagnostics import Code, Diagnostic, Findings, Report
from irc.lowering.lower import lower
from irc.model import Task
from irc.model.garbage import without_garbage
from irc.passes.mandatory import mandatory_part
from irc.passes.restrict import decide_presence
from irc.problem import Problem


class Checked(NamedTuple):
    """A checked task: the task, its lowered form and the report of all checks."""

    task: Task
    problem: Problem
    report: Report


@without_garbage()
def run_checks(
    task: Task,
    earlier: Iterable[Diagnostic] = (),
    *,
    lint: bool = True,
    complete: bool = True,
) -> Checked:
    """Checks a task: structure, time, state, stock, and (with `lint`) what is probably a mistake.

    `earlier` are findings from reading the text; they stand first in the report. `complete` is
    false where faulty parts of the text are missing from the task: a value that no effect seems
    to give may then stand in a part that could not be read.
    """
    findings = Findings(list(earlier))
    before = len(findings.items)
    names, times = check_structure(task, findings)
    if task.clock.resolution is not None:
        from irc.checks.resolution import check_resolution, rounding_note

        if check_resolution(task, findings):
            findings.items += rounding_note(task)
    if task.events:
        from irc.checks.events import check_events

        check_events(task, names, times)
    complete = complete and not any(d.code in _DROPS for d in findings.items[before:])
    problem = lower(task)
    # If the part that every schedule contains is infeasible, so is the whole task.
    core, _ = mandatory_part(problem)
    decided = decide_presence(problem)
    required = core if decided is problem else mandatory_part(decided)[0]
    check_temporal(required, findings)
    if decided.has_calendars:
        from irc.checks.open_times import check_open_times

        check_open_times(decided, findings)
    if complete and core is not problem:
        _check_choices(task, problem, findings)
    if lint:
        from irc.checks.lint import check_lint

        check_lint(task, core, findings)
    return Checked(task, problem, Report(tuple(findings.items), task.source))


_DROPS = frozenset(
    (
        Code.MISSING_FIELD,
        Code.BAD_TIME,
        Code.NEGATIVE_TIME,
        Code.EMPTY_RANGE,
        Code.UNKNOWN_NAME,
        Code.DUPLICATE_ID,
        Code.WRONG_KIND,
        Code.GROUPING,
        Code.UNKNOWN_VALUE,
        Code.EMPTY_CHOICE,
        Code.INCOMPLETE,
    )
)
"""Faults for which lowering leaves something out, so that something else may seem to be missing."""


def _check_choices(task: Task, problem: Problem, findings: Findings) -> None:
    """Checks state, stock and occurrences; loads these checks only for tasks that have them."""
    from irc.checks.endless import check_endless, check_number
    from irc.checks.required import check_required, required_activities

    check_number(problem, findings)
    check_endless(problem, findings)
    required = required_activities(problem)
    check_required(problem, required, findings)
    if problem.variables:
        from irc.checks.contradictions import check_contradictions
        from irc.checks.reach import check_reach

        check_contradictions(task, problem, required, findings)
        check_reach(task, problem, required, findings)
    if problem.numbers:
        from irc.checks.numbers import check_levels

        check_levels(task, problem, required, findings)
    if problem.reservoirs:
        from irc.checks.stock import check_stock

        check_stock(task, problem, required, findings)
