"""What a backend, a program and an engine are, and how backends are found.

A third party's backend is a package with an entry point in the group `irc.backends`; ours are
found in the same way.
"""

from __future__ import annotations

import json
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, TypedDict

from irc._version import __version__
from irc.diagnostics import Diagnostic, did_you_mean
from irc.errors import OptionError
from irc.model import Task
from irc.model.features import Feature
from irc.model.times import TimeError, exact, format_number, parse_number
from irc.problem import Problem
from irc.targets.outcome import (
    Limits,
    OnProgress,
    Outcome,
    UnknownTarget,
)

if TYPE_CHECKING:
    from irc.schedule import Schedule
    from irc.targets.refuter import Refuter

MANIFEST_VERSION = "1"
MANIFEST_FILE = "manifest.json"


def require_seconds(time_limit: float | None) -> None:
    """Raises `OptionError` where a time limit leaves no time."""
    if time_limit is not None and not time_limit > 0:
        raise OptionError(f"time_limit must be more than 0 seconds, not {time_limit}")


def read_share(value: float | Fraction | str) -> Fraction:
    """A share of something as a number or a text: 0.05, "0.05" and "5%" are the same.

    More than the whole is said in percent, or as a `Fraction`, so that 5 is never taken for 5 %.
    Raises `OptionError`.
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
    stability: float | Fraction | str
    on_progress: OnProgress | None


class SolveKeywords(EngineKeywords, total=False):
    """The fields of `SolveOptions`, as keyword arguments."""

    target: str


@dataclass(frozen=True, slots=True)
class SolveOptions:
    """How a task is solved: the same in `solve`, `replan`, `simulate` and `Execution`.

    `time_limit` is wall-clock seconds for each time that something is planned (None: no limit),
    `memory_limit` MB. With `shortcut` a task without contention is solved by its critical path
    alone. `stability` is by how much, as a fraction (0.05 or "5%"), the last objective may get
    worse so that less of a running plan moves. Raises `OptionError`.
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

    def __post_init__(self) -> None:
        require_seconds(self.time_limit)
        for name, least in (("memory_limit", 1), ("workers", 1), ("seed", 0)):
            value = getattr(self, name)
            if value is not None and value < least:
                raise OptionError(f"{name} must be at least {least}, not {value}")
        object.__setattr__(self, "stability", read_share(self.stability))

    @classmethod
    def of(
        cls, options: SolveOptions | None, more: Mapping[str, Any], target: str | None = None
    ) -> SolveOptions:
        """These options with others in their place. Raises `TypeError` for an unknown name."""
        for name in more:
            if name not in cls.__slots__:
                hint = did_you_mean(name, cls.__slots__) or f"known are {', '.join(cls.__slots__)}"
                raise TypeError(f"there is no option {name!r}; {hint}")
        named = more if target is None else {**more, "target": target}
        return replace(options or cls(), **named)

    @property
    def limits(self) -> Limits:
        """What an engine may spend each time."""
        return Limits(self.time_limit, self.memory_limit, self.workers, self.seed)

    @property
    def share(self) -> Fraction:
        """The stability as an exact number."""
        return read_share(self.stability)


@dataclass(frozen=True)
class Program:
    """A task in a target's own language, with the way back.

    `notes` tell what of the task is not in it because it is not known as of t = 0. `judge` says
    what is wrong with a schedule of the problem (None: nothing); it is given where the problem is
    only a part of the task, which the validator could not judge it by.
    """

    backend: Backend
    task: Task
    problem: Problem
    notes: tuple[Diagnostic, ...] = ()
    judge: Callable[[Schedule], str | None] | None = None

    @property
    def target(self) -> str:
        """The backend's name."""
        return self.backend.name

    @cached_property
    def _encoded(self) -> tuple[Mapping[str, str], Mapping[str, Any]]:
        return self.backend.encode(self.problem)

    @property
    def files(self) -> Mapping[str, str]:
        """File name → text, the same bytes for the same task. Raises `Refusal`."""
        return self._encoded[0]

    @property
    def names(self) -> Mapping[str, Any]:
        """What the names and numbers in the files stand for. Raises `Refusal`."""
        return self._encoded[1]

    @cached_property
    def manifest(self) -> dict[str, Any]:
        """Everything needed to read an answer later: the canonical task, names, tick, versions."""
        from irc.model.canonical import canonical_sha256, canonical_task

        canonical = canonical_task(self.task)
        return {
            "irc_manifest": MANIFEST_VERSION,
            "irc_version": __version__,
            "target": self.target,
            "task_sha256": canonical_sha256(canonical),
            "tick": format_number(self.problem.to_units(1)),
            "time_unit": self.problem.time_unit,
            "bound": {
                "makespan": self.problem.bound.value,
                "reason": self.problem.bound.reason,
            },
            "names": self.names,
            "task": canonical,
        }

    def manifest_text(self) -> str:
        """The manifest as JSON text, one line for each of its parts; same task, same bytes."""
        parts = (
            f"{json.dumps(key)}: {json.dumps(value, ensure_ascii=False, allow_nan=False)}"
            for key, value in self.manifest.items()
        )
        return "{" + ",\n".join(parts) + "}\n"

    def decode(self, answer: str) -> Schedule:
        """The exact schedule that an engine's raw answer stands for (not yet validated).

        Raises `irc.retiming.retime.AnswerError` where there is none.
        """
        return self.backend.decode(self.problem, self.names, answer)


class Engine(ABC):
    """Something that answers programs of one target."""

    name: ClassVar[str]

    @abstractmethod
    def missing(self) -> str | None:
        """Why the engine cannot run here and how to get it, or None if it can."""

    @abstractmethod
    def solve(
        self, program: Program, limits: Limits, on_progress: OnProgress | None = None
    ) -> Outcome:
        """Runs within the limits and hands back the best answer with an honest status.

        Raises `EngineFailed` where the engine breaks down without any answer.
        """


class Backend(ABC):
    """A target: what it can take, how a problem is written in it, and who answers."""

    name: ClassVar[str]
    supports: ClassVar[frozenset[Feature]]

    begins_now: ClassVar[bool] = False
    """Whether, when a running task is planned anew, its engines are better given what is left of
    it, with the present as time 0, than the whole history with what has begun fixed."""

    proves: ClassVar[bool] = True
    """Whether its engines can prove, as a rule, that there is no schedule."""

    def __eq__(self, other: object) -> bool:
        """Equal where they are the same target: two objects of one class with the same contents."""
        return type(self) is type(other) and self.__dict__ == other.__dict__

    def __hash__(self) -> int:
        return hash(type(self))

    @abstractmethod
    def encode(self, problem: Problem) -> tuple[Mapping[str, str], Mapping[str, Any]]:
        """The files (name → text) and what the names and numbers in them stand for.

        Pure and deterministic. Raises `Refusal` for what this target cannot express.
        """

    @abstractmethod
    def decode(self, problem: Problem, names: Mapping[str, Any], answer: str) -> Schedule:
        """A raw answer → the exact schedule. Raises `irc.retiming.retime.AnswerError` if there is none."""

    @abstractmethod
    def engines(self) -> Mapping[str, Engine]:
        """The engines by name; the one called "auto" is the default."""

    def engine(self, name: str = "auto") -> Engine:
        """The engine called `name`. Raises `UnknownTarget` with a suggestion if there is none."""
        engines = self.engines()
        if name not in engines:
            raise UnknownTarget("engine", name, list(engines))
        return engines[name]

    def refuter(self) -> Refuter | None:
        """What can say why a problem of this target has no schedule, for `irc explain`, if any."""
        return None
