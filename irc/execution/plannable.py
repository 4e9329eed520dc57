"""Whether a target can plan with a task in force: asked before anything is accepted.

A session that accepts a time or a feature with which its target cannot plan would answer no
replanning any more, not even after a restart.
"""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass, field, replace
from fractions import Fraction

from irc.diagnostics import Code, Diagnostic, InputError, Report
from irc.diagnostics.source import Pointer, Source
from irc.execution.lowered import Lowered, lowered
from irc.model import Event, Task
from irc.model.events import CancelActions, CancelGroups, Observe, RemovePrecedence, SetState
from irc.model.quantities import Number, TimeError
from irc.model.resolution import times_of
from irc.model.times import format_number
from irc.problem import Problem
from irc.problem.horizon import safe_horizon
from irc.targets import get_backend, require_support

_WITHOUT_FEATURES = (Observe, CancelActions, CancelGroups, RemovePrecedence, SetState)
"""Changes that bring no feature for which a target would have to be asked."""


@dataclass(frozen=True)
class Plannable:
    """Times with which a target is known to be able to plan: multiples of `step` up to `latest`.

    Both are in the task's unit. `problem` is the last problem that was asked about.
    """

    target: str
    step: Fraction | None = None
    latest: Number = 0
    problem: Lowered | None = field(
        default=None, compare=False, repr=False, metadata={"derived": True}
    )

    def after(
        self, task: Task, event: Event, instants: Iterable[Number], source: Source | None
    ) -> Plannable:
        """Returns the known times after an event has revised the task, which is in force now.

        `instants` are the times of the history. Raises `InputError` where the target cannot plan
        with the task.
        """
        if not all(isinstance(change, _WITHOUT_FEATURES) for change in event.changes):
            _require_support(task, self.target, source)
        elif self._holds(task, event):
            return self
        at = task.number(event.at)
        moments = [*instants, at]
        known = lowered(task, moments)
        problem = known.problem
        greatest = get_backend(self.target).greatest_horizon(problem)
        if greatest is None:
            return replace(self, step=problem.tick, latest=at, problem=known)
        # (Half of the room is for what the next events bring.)
        reached = safe_horizon(problem) + max(map(problem.whole_ticks, moments))
        if reached > greatest:
            raise _too_large(task, event, problem, reached, greatest, self.target, source)
        latest = problem.to_units(max(reached, greatest // 2) // 2)
        return replace(self, step=problem.tick, latest=latest, problem=known)

    def _holds(self, task: Task, event: Event) -> bool:
        """Whether all times of an event are among those with which a target can plan."""
        if self.step is None:
            return False
        for _, value in times_of(event):
            number = task.number(value)
            if number > self.latest or (Fraction(number) / self.step).denominator != 1:
                return False
        return True


def _require_support(task: Task, target: str, source: Source | None) -> None:
    try:
        require_support(task, get_backend(target))
    except InputError as error:
        message, hint = error.report.errors[0].message, error.report.errors[0].hint
        fault = Diagnostic(Code.UNSUPPORTED, message, (), hint)
        raise InputError(Report((fault,), source)) from None


def _too_large(
    task: Task,
    event: Event,
    problem: Problem,
    reached: int,
    greatest: int,
    target: str,
    source: Source | None,
) -> InputError:
    place, text = _longest(task, event)
    message = (
        f"with {text}, the times of this task reach {reached} ticks of "
        f"{format_number(problem.to_units(1))} {task.time_unit}, beyond the {greatest} that "
        f"target {target!r} can hold"
    )
    hint = 'correct the time, or give the task a coarser "resolution"'
    return InputError(Report((Diagnostic(Code.OUT_OF_RANGE, message, place, hint),), source))


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
