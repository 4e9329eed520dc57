"""Trials: a task for one target and one engine, and how it is to be solved."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, NamedTuple

from irc.diagnostics import Report
from irc.errors import OptionError
from irc.targets import Cancellation, SolveOptions, UnknownTarget, get_backend, require_seconds

AUTO = "auto"
"""The engine that a target chooses itself."""


class Pairing(NamedTuple):
    """A target and one of its engines."""

    target: str
    engine: str


def pairings(targets: Iterable[str], engines: Iterable[str]) -> tuple[Pairing, ...]:
    """Each target with each of the engines that it has, in the order given, each pair once.

    Raises `UnknownTarget` for an unknown target, and for an engine that none of the targets has;
    `OptionError` where a target has none of the engines.
    """
    chosen = {target: get_backend(target).engines() for target in targets}
    wanted = list(dict.fromkeys(engines))
    for engine in wanted:
        if not any(engine in known for known in chosen.values()):
            names = sorted({name for known in chosen.values() for name in known})
            raise UnknownTarget("engine", engine, names)
    found = [Pairing(t, e) for t, known in chosen.items() for e in wanted if e in known]
    for target in chosen:
        if all(pair.target != target for pair in found):
            raise OptionError(
                f"target {target!r} has none of the engines {', '.join(wanted)}; "
                f"it has {', '.join(chosen[target])}"
            )
    return tuple(found)


@dataclass(frozen=True, slots=True)
class TrialOptions:
    """The options of every trial of a batch, as in `SolveOptions`; `workers` are threads.

    An engine has one thread by default, because the processes share the cores.
    """

    time_limit: float | None = 60.0
    memory_limit: int | None = None
    workers: int = 1
    seed: int = 0
    shortcut: bool = True

    def __post_init__(self) -> None:
        require_seconds(self.time_limit)
        self.solving(Pairing("cpsat", AUTO), None)

    def solving(self, pair: Pairing, cancel: Cancellation | None) -> SolveOptions:
        """The options of one trial. Raises `OptionError` where a value is not allowed."""
        return SolveOptions(**asdict(self), target=pair.target, engine=pair.engine, cancel=cancel)

    def to_dict(self) -> dict[str, Any]:
        """The object `options` of a result."""
        return asdict(self)


@dataclass(frozen=True, slots=True)
class TaskText:
    """A task as it is sent to another process: a text, the format and the name of the text.

    `problem` is the text and the name of the problem file of a PDDL domain.
    """

    format: str
    text: str = field(repr=False)
    name: str
    problem: tuple[str, str] | None = field(default=None, repr=False)

    @property
    def size(self) -> int:
        """The number of characters."""
        return len(self.text) + (len(self.problem[0]) if self.problem else 0)


@dataclass(frozen=True, slots=True)
class BatchTask:
    """A task of a batch: its name, the digest of its contents, and its text or what is wrong."""

    name: str
    sha256: str
    source: TaskText | Report


class TrialKey(NamedTuple):
    """The identity of a trial: a result of one is a result of any other with the same key."""

    task: str
    sha256: str
    target: str
    engine: str
    options: tuple[tuple[str, Any], ...]


@dataclass(frozen=True, slots=True)
class Trial:
    """A task that can be read, for one target and one engine."""

    task: BatchTask
    pair: Pairing
    options: TrialOptions

    @property
    def key(self) -> TrialKey:
        """The identity of the trial."""
        return trial_key(self.task.name, self.task.sha256, self.pair, self.options.to_dict())

    @property
    def size(self) -> int:
        """About the number of characters that are sent to another process."""
        return self.task.source.size if isinstance(self.task.source, TaskText) else 0

    def request(self) -> dict[str, Any]:
        """The request to a worker: plain values, which JSON and pickle can hold."""
        if not isinstance(self.task.source, TaskText):
            raise TypeError(f"{self.task.name} cannot be read")
        return {
            "source": asdict(self.task.source),
            "pair": list(self.pair),
            "options": self.options.to_dict(),
        }


def trial_key(task: str, sha256: str, pair: Pairing, options: Mapping[str, Any]) -> TrialKey:
    """The identity of a trial with these parts."""
    return TrialKey(task, sha256, *pair, tuple(sorted(options.items())))
