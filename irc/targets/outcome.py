"""Progress and outcome of an engine's run, and the errors of engines and targets."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from irc import outcome
from irc.diagnostics import Code, Diagnostic, did_you_mean
from irc.errors import IrcError
from irc.model.quantities import Number

if TYPE_CHECKING:
    from irc.schedule import Schedule, Status


@dataclass(frozen=True, slots=True)
class Progress:
    """An improving answer while an engine runs. Makespan and bound in ticks."""

    seconds: float
    makespan: int | None
    bound: int
    engine: str


OnProgress = Callable[[Progress], None]


@dataclass(frozen=True, slots=True)
class ObjectiveLevel:
    """The value reached for one objective, and a bound on it given the best earlier objectives.

    Times are in the task's unit. A bound of None means that none is known.
    """

    name: str
    value: Number
    bound: Number | None = None


@dataclass(frozen=True, slots=True)
class Outcome:
    """The result of an engine's run: the proven status and the best schedule found.

    `bound` is a proven lower bound on the makespan in ticks. `levels` are the objectives in their
    order, if there are others than the makespan.
    """

    status: Status
    engine: str
    schedule: Schedule | None = None
    bound: int = 0
    seconds: float = 0.0
    notes: tuple[Diagnostic, ...] = ()
    levels: tuple[ObjectiveLevel, ...] = ()


class EngineMissing(IrcError):
    """The requested engine is not installed; the message says what to do."""

    ends_as = outcome.MISSING


class EngineFailed(IrcError):
    """The engine ran but gave no usable answer; the message says what happened."""

    ends_as = outcome.FAILED


class Refusal(IrcError):
    """A target cannot express a problem, although it supports all of its features."""

    ends_as = outcome.REFUSED

    def __init__(self, message: str, pointer: tuple[str | int, ...] = (), hint: str | None = None):
        super().__init__(message)
        self.diagnostic = Diagnostic(Code.OUT_OF_RANGE, message, pointer, hint)


class UnknownTarget(IrcError):
    """A target or engine that does not exist."""

    ends_as = outcome.MISUSED

    def __init__(self, kind: str, name: str, known: list[str]) -> None:
        hint = did_you_mean(name, known) or f"known are {', '.join(sorted(known))}"
        super().__init__(f"there is no {kind} {name!r}; {hint}")
