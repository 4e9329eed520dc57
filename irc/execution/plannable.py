"""Whether a target can plan with a task in force: asked before anything is accepted.

A session that accepts a time or a feature with which its target cannot plan would answer no
replanning any more, not even after a restart.
"""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress

from irc.diagnostics import Code, Diagnostic, InputError, Report
from irc.diagnostics.source import Pointer, Source
from irc.lowering.lower import lower
from irc.model import Event, Task
from irc.model.events import CancelActions, CancelGroups, Observe, RemovePrecedence, SetState
from irc.model.quantities import Number, TimeError
from irc.model.resolution import times_of
from irc.model.times import format_number
from irc.problem.horizon import safe_horizon
from irc.targets import get_backend, require_support

_WITHOUT_FEATURES = (Observe, CancelActions, CancelGroups, RemovePrecedence, SetState)
"""Changes that bring no feature for which a target would have to be asked."""


def require_plannable(
    task: Task, event: Event, instants: Iterable[Number], target: str, source: Source | None
) -> None:
    """Raises `InputError` where the target cannot plan with a task that an event has revised.

    `instants` are the times of the history and the present, in the task's unit.
    """
    backend = get_backend(target)
    if not all(isinstance(change, _WITHOUT_FEATURES) for change in event.changes):
        try:
            require_support(task, backend)
        except InputError as error:
            message, hint = error.report.errors[0].message, error.report.errors[0].hint
            fault = Diagnostic(Code.UNSUPPORTED, message, (), hint)
            raise InputError(Report((fault,), source)) from None
    moments = list(instants)
    problem = lower(task, moments)
    greatest = backend.greatest_horizon(problem)
    if greatest is None:
        return
    latest = max((problem.whole_ticks(moment) for moment in moments), default=0)
    reached = safe_horizon(problem) + latest
    if reached > greatest:
        place, text = _longest(task, event)
        message = (
            f"with {text}, the times of this task reach {reached} ticks of "
            f"{format_number(problem.to_units(1))} {task.time_unit}, beyond the {greatest} that "
            f"target {backend.name!r} can hold"
        )
        hint = 'correct the time, or give the task a coarser "resolution"'
        raise InputError(Report((Diagnostic(Code.OUT_OF_RANGE, message, place, hint),), source))


def _longest(task: Task, event: Event) -> tuple[Pointer, str]:
    """The place and the text of the longest time of an event."""
    clock = task.clock
    found: list[tuple[Number, Pointer]] = []
    for place, value in times_of(event):
        with suppress(TimeError):
            found.append((clock.exact(value), place))
    if not found:
        return (), "this event"
    longest, place = max(found, key=lambda f: f[0])
    return place, f"{format_number(longest)} {task.time_unit}"
