"""The independent validator: is a schedule valid for a task (docs/semantics.md)?

It knows the task and the schedule and nothing else: no solver, no compiled form, no re-timing. All
arithmetic is exact. Cost is near linear in the size of both, but for two questions that are NP-hard
and therefore bounded: ranks where none are given (`irc.validation.ranks`), and choices among
different amounts (`irc.validation.choices`). Where a bound is reached the verdict says "undecided".
"""

from __future__ import annotations

from irc.model import Task
from irc.model.quantities import Number, TimeError
from irc.schedule import Schedule
from irc.validation.bound_schedule import (
    BoundSchedule,
    InexactTimeError,
    UncheckedTaskError,
    bind,
)
from irc.validation.breaks import check_breaks
from irc.validation.choices import check_choices
from irc.validation.objectives import check_stated, objective_values
from irc.validation.open_times import UnreadableCalendarError
from irc.validation.presence import check_presence
from irc.validation.resources import check_capacity
from irc.validation.timing import check_precedence, check_windows
from irc.validation.verdict import RULES, SHOWN_PER_RULE, Verdict, Violation, Violations

__all__ = [
    "RULES",
    "SHOWN_PER_RULE",
    "InexactTimeError",
    "UncheckedTaskError",
    "Verdict",
    "Violation",
    "validate",
]


def _check_together(bound: BoundSchedule, violations: Violations) -> None:
    """Checks what only some tasks have; its modules are loaded for these."""
    if bound.task.select or bound.task.couplings:
        from irc.validation.couplings import check_choices_together

        check_choices_together(bound, violations)


def _check_setups(bound: BoundSchedule, violations: Violations) -> None:
    if any(r.setups is not None or r.no_idle for r in bound.resources.values()):
        from irc.validation.setups import check_idle, check_setups

        check_setups(bound, violations)
        check_idle(bound, violations)


def _check_sequences(bound: BoundSchedule, violations: Violations) -> None:
    if bound.task.sequences:
        from irc.validation.sequences import check_sequences

        check_sequences(bound, violations)


def _check_loads(bound: BoundSchedule, violations: Violations) -> None:
    if any(r.kind == "batch" for r in bound.resources.values()):
        from irc.validation.loads import check_loads

        check_loads(bound, violations)


def _check_stock(bound: BoundSchedule, violations: Violations) -> None:
    if any(r.kind == "reservoir" for r in bound.resources.values()):
        from irc.validation.stock import check_reservoirs

        check_reservoirs(bound, violations)


def _check_state(bound: BoundSchedule, violations: Violations) -> None:
    if bound.ranked or bound.variables or bound.task.goals:
        from irc.validation.state import check_goals, check_state

        check_state(bound, violations)
        check_goals(bound, violations)


_CHECKS = (
    check_presence,
    check_windows,
    _check_together,
    check_breaks,
    check_precedence,
    check_choices,
    check_capacity,
    _check_setups,
    _check_sequences,
    _check_loads,
    _check_stock,
    _check_state,
)
"""In the order of the rules."""


def validate(task: Task, schedule: Schedule, at: Number | None = None) -> Verdict:
    """Judges `schedule` as an answer to `task`, as of t = 0: the task's events are not applied.

    It finds all violations, not only the first. The task must have been checked: a task that
    refers to a name it does not define raises `UncheckedTaskError`. A time in the schedule, or
    `at`, that is not an `int` or a `Fraction` raises `InexactTimeError`.

    With `at`, in the task's unit, entries that began before it are history. A violation that the
    history alone has too does not make the schedule invalid: `Verdict.carried` reports it
    (`irc.validation.history`).

    >>> from irc.schedule import Entry
    >>> task = Task(actions=[{"id": "cut", "duration": 3}, {"id": "stack", "duration": 1}],
    ...             precedence=[("cut", "stack")])
    >>> print(validate(task, Schedule((Entry("cut", 0, 3), Entry("stack", 3, 4)))))
    valid: makespan 4 s
    >>> print(validate(task, Schedule((Entry("cut", 0, 3), Entry("stack", 2, 3)))))
    not valid, 1 violation:
      rule 3, precedence: 'stack' starts at 2 s, but must not start before 3 s: the end of 'cut'
    """
    try:
        return _validate(task, schedule, at)
    except (TimeError, UnreadableCalendarError) as error:
        raise UncheckedTaskError(f"the task has a time that cannot be used: {error}") from error


def still_holds(verdict: Verdict, schedule: Schedule) -> bool:
    """Whether a verdict on the entries of a schedule holds with the values that this one states.

    The verdict is one on the same entries, of the same task and time, that stated no values.
    """
    violations = Violations(verdict.time_unit)
    check_stated(schedule, verdict.objective, violations)
    return not violations


def _validate(task: Task, schedule: Schedule, at: Number | None) -> Verdict:
    if task.columns is not None and at is None:
        from irc.validation.columns import values_if_valid

        if (known := values_if_valid(task.columns, schedule)) is not None:
            return Verdict((), known, time_unit=task.time_unit)
    bound = bind(task, schedule, at)
    violations = Violations(task.time_unit)
    for check in _CHECKS:
        check(bound, violations)
    values = objective_values(bound)
    check_stated(schedule, values, violations)
    return Verdict(
        violations.found,
        values,
        violations.omitted,
        task.time_unit,
        at,
        violations.carried,
        violations.carried_omitted,
    )
