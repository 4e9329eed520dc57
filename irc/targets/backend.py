"""The interfaces of backends, programs and engines.

A backend is a package with an entry point in the group `irc.backends`; irc finds its own backends
in the same way as those of third parties.
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
from irc.targets.budget import Budget
from irc.targets.exchange import Exchange
from irc.targets.options import SolveOptions
from irc.targets.outcome import Outcome, UnknownTarget

if TYPE_CHECKING:
    from irc.schedule import Schedule
    from irc.targets.refuter import Refuter

MANIFEST_VERSION = "1"
MANIFEST_FILE = "manifest.json"


@dataclass(frozen=True)
class Program:
    """A task in a target's own language, with the way back.

    `notes` name parts of the task that are not in the program, because they are not known at
    t = 0. `judge` returns the fault of a schedule of the problem (None: there is none); it is given
    if the problem is only a part of the task, so that the validator cannot judge the schedule.
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
        """The meaning of the names and numbers in the files. Raises `Refusal`."""
        return self._encoded[1]

    @cached_property
    def manifest(self) -> dict[str, Any]:
        """The data needed to read an answer later: the canonical task, names, tick, versions."""
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
        """The manifest as JSON text, one line for each part; the same bytes for the same task."""
        parts = (
            f"{json.dumps(key)}: {json.dumps(value, ensure_ascii=False, allow_nan=False)}"
            for key, value in self.manifest.items()
        )
        return "{" + ",\n".join(parts) + "}\n"

    def decode(self, answer: str) -> Schedule:
        """The exact schedule of an engine's raw answer, not yet validated.

        Raises `irc.problem.decisions.AnswerError` if the answer has none.
        """
        return self.backend.decode(self.problem, self.names, answer)


class Engine(ABC):
    """A solver or planner that answers programs of one target."""

    name: ClassVar[str]

    is_repeatable: ClassVar[bool] = False
    """Whether it can count work instead of time, so that an answer can be had again."""

    @property
    def loading_seconds(self) -> float:
        """About how long it takes until the engine can begin to search; 0 where it is at once.

        With less time left it is not asked, if the compiler has a schedule of its own.
        """
        return 0.0

    def can_begin(self, budget: Budget) -> bool:
        """Whether the budget lasts until the engine has been loaded, as busy as the machine is."""
        return not budget.is_over and budget.left >= self.loading_seconds * budget.slowness

    def sharing(self, exchange: Exchange) -> Engine:
        """The engine as one of several that search for one problem and exchange what they find.

        An engine that cannot exchange searches alone, which is what this one does.
        """
        return self

    @abstractmethod
    def missing(self) -> str | None:
        """The reason why the engine cannot run here and how to install it; None if it can run."""

    @abstractmethod
    def solve(self, program: Program, options: SolveOptions, budget: Budget) -> Outcome:
        """Runs until the budget is over and returns the best answer with its proven status.

        Of the options an engine needs `memory_limit`, `workers`, `seed` and `on_progress`; its time
        is that of the budget alone. The budget can be cancelled at any moment
        (`Budget.is_cancelled`): then the engine returns what it has within about half a second.
        Raises `EngineFailed` if the engine breaks down without any answer.
        """


class Backend(ABC):
    """A target: the features it supports, its encoding of problems, and its engines."""

    name: ClassVar[str]
    supports: ClassVar[frozenset[Feature]]

    begins_now: ClassVar[bool] = False
    """Whether replanning gives its engines the residual problem, with the present as time 0,
    instead of the whole problem with the history fixed."""

    proves: ClassVar[bool] = True
    """Whether its engines can usually prove that a problem has no schedule."""

    def __eq__(self, other: object) -> bool:
        """Equal where they are the same target: two objects of one class with the same contents."""
        return type(self) is type(other) and self.__dict__ == other.__dict__

    def __hash__(self) -> int:
        return hash(type(self))

    @abstractmethod
    def encode(self, problem: Problem) -> tuple[Mapping[str, str], Mapping[str, Any]]:
        """The files (name → text) and the meaning of the names and numbers in them.

        Pure and deterministic. Raises `Refusal` for a problem that this target cannot express.
        """

    @abstractmethod
    def decode(self, problem: Problem, names: Mapping[str, Any], answer: str) -> Schedule:
        """Returns the exact schedule of a raw answer.

        Raises `irc.problem.decisions.AnswerError` if the answer has none.
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

    def greatest_horizon(self, problem: Problem) -> int | None:
        """The greatest horizon, in ticks, that its engines can hold; None: any.

        A running task refuses what would take its times beyond it.
        """
        return None

    def refuter(self) -> Refuter | None:
        """The solver that proves for `irc explain` why a problem has no schedule, if any."""
        return None
