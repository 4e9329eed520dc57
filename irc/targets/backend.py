"""What a backend, a program and an engine are, and how backends are found.

A third party's backend is a package with an entry point in the group `irc.backends`; ours are
found in the same way.
"""

from __future__ import annotations

import json
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

from irc._version import __version__
from irc.diagnostics import Diagnostic
from irc.model import Task
from irc.model.features import Feature
from irc.model.times import format_number
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
                "makespan": self.problem.bounds.makespan.value,
                "reason": self.problem.bounds.makespan.reason,
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

        Raises `irc.problem.decisions.AnswerError` where there is none.
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
        """Returns the exact schedule of a raw answer.

        Raises `irc.problem.decisions.AnswerError` where there is none.
        """

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
