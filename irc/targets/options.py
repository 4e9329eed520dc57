"""The options of solving: the same names and units in Python and on the command line."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, TypedDict

from irc.diagnostics import did_you_mean
from irc.errors import OptionError
from irc.model.quantities import TimeError, exact
from irc.model.times import format_number, parse_number
from irc.targets.budget import Budget, Cancellation, Work
from irc.targets.outcome import OnProgress

USUAL_WORK = 5.0
"""The work limit of a deterministic call that names none, in units."""


def require_seconds(time_limit: float | None) -> None:
    """Raises `OptionError` for a time limit of 0 or less."""
    if time_limit is not None and not time_limit > 0:
        raise OptionError(f"time_limit must be more than 0 seconds, not {time_limit}")


def read_share(value: float | Fraction | str) -> Fraction:
    """A share of something as a number or a text: 0.05, "0.05" and "5%" are the same.

    A share above 1 must be in percent or a `Fraction`, so that 5 is never read as 5 %. Raises
    `OptionError`.
    """
    text = str(value).strip()
    try:
        share = parse_number(text.removesuffix("%").rstrip())
    except TimeError:
        raise OptionError(f'expected a fraction such as 0.05 or "5%", not {text!r}') from None
    if text.endswith("%"):
        share = Fraction(share, 100)
    elif share > 1 and not isinstance(value, Fraction):
        raise OptionError(
            f"{text} is more than the whole: write {format_number(exact(Fraction(share, 100)))} or "
            f'"{text}%" for {text} percent, "{format_number(share * 100)}%" for {text} times'
        )
    if share < 0:
        raise OptionError(f"a fraction must not be negative: {text}")
    return Fraction(share)


class EngineKeywords(TypedDict, total=False):
    """The fields of `SolveOptions` but the target, as keyword arguments."""

    engine: str
    time_limit: float | None
    memory_limit: int | None
    workers: int | None
    seed: int
    shortcut: bool
    deterministic: bool
    work_limit: float | None
    stability: float | Fraction | str
    on_progress: OnProgress | None
    cancel: Cancellation | None


class SolveKeywords(EngineKeywords, total=False):
    """The fields of `SolveOptions`, as keyword arguments."""

    target: str


@dataclass(frozen=True, slots=True)
class SolveOptions:
    """The options of solving: the same in `solve`, `replan`, `simulate` and `Execution`.

    `time_limit` is in wall-clock seconds for each plan (None: no limit), `memory_limit` in MB. With
    `shortcut`, a task without contention is solved by its critical path alone. `stability` is how
    much worse the last objective may get, as a fraction (0.05 or "5%"), so that fewer occurrences
    of a running plan move. `cancel` ends the call early, with the best answer so far. A
    `deterministic` call gives the same answer every time: it ends after `work_limit` units of work
    (None: `USUAL_WORK`), and the clock is only a guard. Raises `OptionError`.
    """

    target: str = "cpsat"
    engine: str = "auto"
    time_limit: float | None = 60.0
    memory_limit: int | None = None
    workers: int | None = None
    seed: int = 0
    shortcut: bool = True
    stability: float | Fraction | str = 0
    on_progress: OnProgress | None = None
    cancel: Cancellation | None = None
    deterministic: bool = False
    work_limit: float | None = None

    def __post_init__(self) -> None:
        require_seconds(self.time_limit)
        for name, least in (("memory_limit", 1), ("workers", 1), ("seed", 0)):
            value = getattr(self, name)
            if value is not None and value < least:
                raise OptionError(f"{name} must be at least {least}, not {value}")
        if self.work_limit is not None and not self.deterministic:
            raise OptionError("work_limit is the limit of a deterministic call: set deterministic")
        if self.work_limit is not None and not self.work_limit > 0:
            raise OptionError(f"work_limit must be more than 0 units, not {self.work_limit}")
        object.__setattr__(self, "stability", read_share(self.stability))

    @classmethod
    def of(
        cls, options: SolveOptions | None, more: Mapping[str, Any], target: str | None = None
    ) -> SolveOptions:
        """The options with some of them replaced. Raises `TypeError` for an unknown name."""
        for name in more:
            if name not in cls.__slots__:
                hint = did_you_mean(name, cls.__slots__) or f"known are {', '.join(cls.__slots__)}"
                raise TypeError(f"there is no option {name!r}; {hint}")
        named = more if target is None else {**more, "target": target}
        return replace(options or cls(), **named)

    def budget(self, spent: float = 0.0, *, since: Budget | None = None) -> Budget:
        """The time limit from now on, or from `spent` seconds ago, which `cancel` ends.

        With `since` it counts from when that budget was made.
        """
        if since is not None:
            return since.limited(self.time_limit, self.cancel)
        return Budget(self.time_limit, spent=spent, cancel=self.cancel)

    def require_seconds_only(self, what: str) -> None:
        """Raises `OptionError` where a deterministic call is wanted of `what`, which has none."""
        if self.deterministic:
            raise OptionError(f"{what} cannot be deterministic: it depends on the clock")

    def work(self, guard: Budget) -> Work | None:
        """The work that a deterministic call counts; None where it is to count seconds."""
        return Work(guard) if self.deterministic else None

    @property
    def share(self) -> Fraction:
        """The stability as an exact number."""
        return read_share(self.stability)
