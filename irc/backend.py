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
from functools import cache, cached_property
from importlib import import_module
from typing import TYPE_CHECKING, Any, ClassVar, TypedDict

from irc._version import __version__
from irc.diagnostics import Code, Diagnostic, InputError, Report, did_you_mean
from irc.errors import IrcError, OptionError
from irc.features import Feature, FeatureUse, features_of
from irc.model import Task
from irc.problem import Problem
from irc.times import Number, TimeError, exact, format_number, parse_number

if TYPE_CHECKING:
    from irc.explanation.refuter import Refuter
    from irc.schedule import Schedule, Status

MANIFEST_VERSION = "1"
MANIFEST_FILE = "manifest.json"


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
        from irc.canonical import canonical_sha256, canonical_task

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

        Raises `irc.retime.AnswerError` where there is none.
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
        """A raw answer → the exact schedule. Raises `irc.retime.AnswerError` if there is none."""

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


class Refusal(IrcError):
    """This target cannot express this problem, though it knows all of its features."""

    def __init__(self, message: str, pointer: tuple[str | int, ...] = (), hint: str | None = None):
        super().__init__(message)
        self.diagnostic = Diagnostic(Code.OUT_OF_RANGE, message, pointer, hint)


_OWN = {"cpsat": ("irc_cpsat", "CpSat"), "pddl21": ("irc_pddl21", "Pddl21")}
"""Our own entry points, so that using them need not read every installed distribution."""


@cache
def backends() -> Mapping[str, Backend]:
    """All installed backends by name."""
    from importlib.metadata import entry_points

    found = sorted(entry_points(group="irc.backends"), key=lambda point: point.name)
    return {point.name: point.load()() for point in found}


def get_backend(name: str) -> Backend:
    """The backend called `name`. Raises `UnknownTarget` with a suggestion if there is none."""
    if name in _OWN:
        module, class_name = _OWN[name]
        own: Backend = getattr(import_module(module), class_name)()
        return own
    if name not in backends():
        raise UnknownTarget("target", name, list(backends()))
    return backends()[name]


class UnknownTarget(IrcError):
    """A target or engine that does not exist."""

    def __init__(self, kind: str, name: str, known: list[str]) -> None:
        hint = did_you_mean(name, known) or f"known are {', '.join(sorted(known))}"
        super().__init__(f"there is no {kind} {name!r}; {hint}")


def refused_features(task: Task, backend: Backend) -> dict[Feature, FeatureUse]:
    """The features of a task that a backend cannot take, each with its first place."""
    refused: dict[Feature, FeatureUse] = {}
    supports = backend.supports
    for use in features_of(task):
        if use.feature not in supports:
            refused.setdefault(use.feature, use)
    return refused


def require_support(task: Task, backend: Backend) -> None:
    """Raises `InputError` naming every feature the backend cannot take, its place, and who can."""
    refused = refused_features(task, backend)
    if not refused:
        return
    diagnostics = []
    for feature, use in refused.items():
        able = [b.name for b in backends().values() if feature in b.supports]
        hint = f"targets that can: {', '.join(able)}" if able else "no installed target can yet"
        diagnostics.append(
            Diagnostic(
                Code.UNSUPPORTED,
                f"{use.element}: target {backend.name!r} cannot take {feature.value}",
                use.pointer,
                hint,
            )
        )
    raise InputError(Report(tuple(diagnostics), task.source))
