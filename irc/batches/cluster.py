"""Runs trials on the workers of a Dask cluster.

The scheduler gives a trial to another worker where one dies; a trial that takes several workers
with it has failed. Workers need the same version of irc, and no file of this machine: trials are
sent as texts. A trial that is cancelled while a worker solves it goes on to its time limit there.
"""

from __future__ import annotations

import queue
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from irc.batches.answering import answered
from irc.batches.local import MOST_CHARACTERS, POLL_SECONDS, Answered
from irc.batches.result import ended_as, fault_of
from irc.batches.trial import Trial
from irc.cluster import connecting
from irc.cluster.connecting import ClusterError, close, connected
from irc.outcome import FAILED
from irc.targets import Budget, Cancellation

if TYPE_CHECKING:
    from distributed import Client, Future

WORKERLESS_SECONDS = 30.0
"""A cluster that has no worker for this long is lost."""

AHEAD = 3
"""Trials that each thread of the cluster is given in advance."""

_LOOK_SECONDS = 1.0
"""Between two looks at the workers."""


class ClusterLost(ClusterError):
    """The cluster went away; `unfinished` are the trials that it had not answered."""

    ends_as = FAILED

    def __init__(self, message: str, unfinished: list[Trial]) -> None:
        super().__init__(message)
        self.unfinished = unfinished


@dataclass(frozen=True, slots=True)
class ClusterOptions:
    """The address of the scheduler, such as "tcp://10.0.0.5:8786", and what answers have."""

    scheduler: str
    schedules: bool = False
    workerless_seconds: float = WORKERLESS_SECONDS


def run_on_cluster(
    trials: Iterator[Trial], options: ClusterOptions, cancel: Cancellation
) -> Iterator[Answered]:
    """The answers of all trials as they come; once cancelled, no more of them.

    Raises `LibraryMissing` without the extra `cluster`, `ClusterError` where the scheduler cannot
    be reached or its workers have no or another irc, and `ClusterLost` if it goes away.
    """
    client = connected(options.scheduler, cancel, "irc-batch")
    if client is None:
        return
    try:
        yield from _Cluster(client, options).answers(trials, cancel)
    finally:
        close(client)


@dataclass
class _Cluster:
    """A connection with the trials that the cluster has."""

    client: Client
    options: ClusterOptions
    done: queue.SimpleQueue[Future] = field(default_factory=queue.SimpleQueue)
    given: dict[str, tuple[Trial, Future]] = field(default_factory=dict)
    workerless: Budget | None = None
    next_look: Budget = field(default_factory=lambda: Budget(0))
    room: int = AHEAD

    def answers(self, trials: Iterator[Trial], cancel: Cancellation) -> Iterator[Answered]:
        exhausted = False
        while not cancel.is_cancelled:
            self._look()
            while not exhausted and self._has_room and not cancel.is_cancelled:
                trial = next(trials, None)
                exhausted = trial is None
                if trial is not None and (fault := fault_of(trial)) is not None:
                    yield trial, fault
                elif trial is not None:
                    self._give(trial)
            if not self.given:
                return
            with suppress(queue.Empty):
                yield self._taken(self.done.get(timeout=POLL_SECONDS))

    @property
    def _has_room(self) -> bool:
        size = sum(trial.size for trial, _ in self.given.values())
        return len(self.given) < self.room and (size < MOST_CHARACTERS or not self.given)

    def _give(self, trial: Trial) -> None:
        try:
            future = self.client.submit(
                answered, trial.request(), self.options.schedules, pure=False
            )
        except Exception as error:  # noqa: BLE001 - whatever a lost connection raises
            raise self._lost(f"it takes no more trials ({error})", trial) from None
        self.given[future.key] = (trial, future)
        future.add_done_callback(self.done.put)

    def _taken(self, future: Future) -> Answered:
        """The trial that a future was given for, with its answer."""
        trial, _ = self.given[future.key]
        if future.status == "finished":
            try:
                answer: Mapping[str, Any] = future.result(timeout=connecting.CONNECT_SECONDS)
            except Exception as error:  # noqa: BLE001 - the result was lost with its worker
                raise self._lost(f"an answer cannot be fetched ({error})") from None
        elif future.status == "error":
            died = future.exception(timeout=connecting.CONNECT_SECONDS)
            answer = ended_as(FAILED, f"on the cluster: {type(died).__name__}: {died}")
        else:
            raise self._lost(f"a trial is {future.status}")
        del self.given[future.key]
        return trial, answer

    def _look(self) -> None:
        """Looks at the scheduler and its workers from time to time. Raises `ClusterLost`."""
        if self.client.status != "running":
            raise self._lost("the connection to the scheduler is closed")
        if not self.next_look.is_over:
            return
        self.next_look = Budget(_LOOK_SECONDS)
        # (`scheduler_info` may return what the client has meanwhile asked for itself: no workers.)
        workers: dict[str, int] = self.client.nthreads()
        self.room = AHEAD * sum(workers.values())
        if workers:
            self.workerless = None
            return
        self.workerless = self.workerless or Budget(self.options.workerless_seconds)
        if self.workerless.is_over:
            raise self._lost("it has no workers any more")

    def _lost(self, reason: str, *more: Trial) -> ClusterLost:
        unfinished = [*(trial for trial, _ in self.given.values()), *more]
        message = f"the cluster {self.options.scheduler} went away: {reason}"
        return ClusterLost(message, unfinished)
