"""How an engine's run ends: limits, progress, outcome, and the errors of engines and targets."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from irc.diagnostics import Code, Diagnostic, did_you_mean
from irc.errors import IrcError
from irc.model.quantities import Number

if TYPE_CHECKING:
    from irc.schedule import Schedule, Status


@dataclass(frozen=True, slots=True)
class Limits:
    """What an engine may spend: wall-clock seconds, memory, threads; and its random seed.

    `bounds` and `hints` let measurements switch off what the compiler adds to a model.
    """

    seconds: float | None = None
    memory_mb: int | None = None
    workers: int | None = None
    seed: int = 0
    bounds: bool = True
    hints: bool = True


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
    """The value reached for one objective, and a bound on it among the best of those before it.

    In the task's unit where it is a time. A bound of None: none is known.
    """

    name: str
    value: Number
    bound: Number | None = None


@dataclass(frozen=True, slots=True)
class Outcome:
    """How an engine's run ended: an honest status and the best schedule seen.

    `bound` is a proven lower bound on the makespan in ticks. `levels` are the objectives in their
    order, where there is more to say than that.
    """

    status: Status
    engine: str
    schedule: Schedule | None = None
    bound: int = 0
    seconds: float = 0.0
    notes: tuple[Diagnostic, ...] = ()
    levels: tuple[ObjectiveLevel, ...] = ()


class EngineMissing(IrcError):
    """The engine asked for is not installed; the text says what to do."""


class EngineFailed(IrcError):
    """The engine ran but gave nothing that can be used; the text says what happened."""


class Refusal(IrcError):
    """This target cannot express this problem, though it knows all of its features."""

    def __init__(self, message: str, pointer: tuple[str | int, ...] = (), hint: str | None = None):
        super().__init__(message)
        self.diagnostic = Diagnostic(Code.OUT_OF_RANGE, message, pointer, hint)


class UnknownTarget(IrcError):
    """A target or engine that does not exist."""

    def __init__(self, kind: str, name: str, known: list[str]) -> None:
        hint = did_you_mean(name, known) or f"known are {', '.join(sorted(known))}"
        super().__init__(f"there is no {kind} {name!r}; {hint}")
