"""Progress and outcome of an engine's run, and the errors of engines and targets."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING

from irc import outcome
from irc.diagnostics import Code, Diagnostic, did_you_mean
from irc.errors import IrcError
from irc.model.quantities import Number
from irc.model.times import format_number

if TYPE_CHECKING:
    from irc.schedule import Schedule, Status


@dataclass(frozen=True, slots=True)
class ObjectiveLevel:
    """The value reached for one objective, and a bound on it given the best earlier objectives.

    Times are in the task's unit. A bound of None means that none is known.
    """

    name: str
    value: Number
    bound: Number | None = None

    @property
    def gap(self) -> float | None:
        """How far value and bound are apart, from 0 (proven best) to 1; None without a bound."""
        if self.bound is None:
            return None
        if self.value == self.bound:
            return 0.0
        value, bound = Fraction(self.value), Fraction(self.bound)
        return float(abs(value - bound) / max(abs(value), abs(bound)))


@dataclass(frozen=True, slots=True)
class Progress:
    """A better answer, or a better bound on it, while an engine runs.

    `seconds` count from when the call began. `objective` names what is being improved, and `value`,
    `bound` and `gap` are its own; `levels` have it with the objectives before it, or all of them,
    in their order. Engines give `found`, which makes the schedule of this answer; it is lost when a
    progress is pickled.
    """

    seconds: float
    engine: str
    objective: str
    levels: tuple[ObjectiveLevel, ...]
    found: Callable[[], Schedule] | None = field(default=None, repr=False, compare=False)

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.seconds, self.engine, self.objective, self.levels)

    @property
    def level(self) -> ObjectiveLevel:
        """The objective that is being improved."""
        return next(level for level in self.levels if level.name == self.objective)

    @property
    def value(self) -> Number:
        """The value of the objective that is being improved."""
        return self.level.value

    @property
    def bound(self) -> Number | None:
        """A proven bound on it; None where none is known."""
        return self.level.bound

    @property
    def gap(self) -> float | None:
        """How far the two are apart, from 0 (proven the best) to 1; None without a bound."""
        return self.level.gap

    def _repr_html_(self) -> str:
        """The values reached so far, their bounds and how far the two are apart, for notebooks."""
        from irc.display.html import heading, table

        rows = [
            (
                level.name.replace("_", " "),
                format_number(level.value),
                "" if level.bound is None else format_number(level.bound),
                "" if level.gap is None else f"{100 * level.gap:.1f} %",
            )
            for level in self.levels
        ]
        columns = ("objective", "value", "bound", "gap")
        return heading(f"{self.engine}, after {self.seconds:.1f} s") + table(columns, rows)

    def schedule(self) -> Schedule:
        """The schedule of this answer, exact and validated; it is made when it is asked for.

        Raises `EngineFailed` where the validator rejects it, or where it is not to be had.
        """
        if self.found is None:
            raise EngineFailed("this progress is a copy, which has no schedule")
        return self.found()


OnProgress = Callable[[Progress], None]


@dataclass(frozen=True, slots=True)
class Outcome:
    """The result of an engine's run: the proven status and the best schedule found.

    `bound` is a proven lower bound on the makespan in ticks. `levels` are the objectives in their
    order, if there are others than the makespan. A deterministic run `is_cut` where the clock ended
    it before its work was done.
    """

    status: Status
    engine: str
    schedule: Schedule | None = None
    bound: int = 0
    seconds: float = 0.0
    notes: tuple[Diagnostic, ...] = ()
    levels: tuple[ObjectiveLevel, ...] = ()
    is_cut: bool = False


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
