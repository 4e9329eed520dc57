"""What a backend, a program and an engine are, and how backends are found.

A third party's backend is a package with an entry point in the group `irc.backends`; ours are
found in the same way.
"""

from __future__ import annotations

import json
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from importlib import import_module
from typing import TYPE_CHECKING, Any, ClassVar

from irc._version import __version__
from irc.diagnostics import Code, Diagnostic, InputError, Report, did_you_mean
from irc.errors import IrcError
from irc.features import Feature, FeatureUse, features_of
from irc.model import Task
from irc.problem import Problem
from irc.times import Number, format_number

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
