"""A racer: one search of a race, in a worker of the cluster.

The racer is a task of the worker. The race reaches it while it runs by `meet` and `leave`, which
Dask runs in the worker's event loop: so nothing is kept on the scheduler, and what a racer found
stays at home when its worker dies.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from threading import Event, Lock, Thread
from typing import Any

from irc.errors import IrcError
from irc.model import Task
from irc.schedule import Schedule, Status
from irc.targets import (
    Budget,
    Cancellation,
    EngineFailed,
    Exchange,
    Part,
    Progress,
    SolveOptions,
    get_backend,
)

SILENCE_SECONDS = 10.0
"""A racer that nobody has met for this long ends: its race is over, or has lost it."""

_LOOK_SECONDS = 0.1
"""Between two looks at what there is to send."""


@dataclass(frozen=True, slots=True)
class Request:
    """The work of a racer: a task, the options of the race but its time, and its part."""

    race: str
    task: Task
    options: Mapping[str, Any]
    seconds: float | None
    part: Part


@dataclass(slots=True)
class News:
    """News of a racer: documents of schedules, list schedules and bounds in ticks.

    `document` is the best schedule since it was last met. `ended` is the racer's status, once it
    has one, and `failure` says why it has none.
    """

    bound: int = 0
    best: tuple[int, Any] | None = None
    document: Mapping[str, Any] | None = None
    ended: str | None = None
    failure: str | None = None


@dataclass
class Racer:
    """A search of this process, and what it has to tell."""

    request: Request
    exchange: Exchange
    cancel: Cancellation = field(default_factory=Cancellation)
    over: Event = field(default_factory=Event)
    left: Event = field(default_factory=Event)
    heard: Budget = field(default_factory=lambda: Budget(SILENCE_SECONDS))
    _lock: Lock = field(default_factory=Lock)
    _progress: Progress | None = None
    _document: Mapping[str, Any] | None = None
    _ended: str | None = None
    _failure: str | None = None
    _sent: int | None = None

    def run(self) -> None:
        """Searches until the time is over, the race is, or nobody asks any more."""
        watching = Thread(target=self._watch, name="irc-racer", daemon=True)
        watching.start()
        try:
            schedule = self._solved()
            with self._lock:
                if schedule.answered:
                    self._document = schedule.to_dict()
                self._ended = str(schedule.status)
        except (IrcError, OSError, MemoryError) as error:
            with self._lock:
                self._failure = f"{type(error).__name__}: {error}"
        finally:
            self.over.set()
            watching.join()

    def _solved(self) -> Schedule:
        from irc.driver.solve import solve_by

        request = self.request
        options = SolveOptions(
            **request.options,
            time_limit=request.seconds,
            shortcut=False,
            on_progress=self._tell,
            cancel=self.cancel,
        )
        backend = get_backend(options.target)
        engine = backend.engine(options.engine).sharing(self.exchange)
        return solve_by(request.task, backend, engine, options, options.budget()).schedule

    def _tell(self, progress: Progress) -> None:
        self._progress = progress

    def _watch(self) -> None:
        """Makes the documents of better schedules, and ends the search that nobody asks for."""
        made: Progress | None = None
        while not self.over.wait(_LOOK_SECONDS):
            if self.heard.is_over:
                self.cancel.cancel()
            progress = self._progress
            if progress is None or progress is made:
                continue
            made = progress
            try:
                document = progress.schedule().to_dict()
            except EngineFailed as error:
                with self._lock:
                    self._failure = str(error)
                self.cancel.cancel()
                return
            with self._lock:
                if self._ended is None:
                    self._document = document

    def meet(self, news: News) -> News:
        """Takes what others have found, and tells what is new here."""
        self.heard = Budget(SILENCE_SECONDS)
        self.exchange.prove(news.bound)
        if news.best is not None:
            self.exchange.offer(*news.best)
        best = self.exchange.best
        known = best is None or best[0] == self._sent or best is news.best
        self._sent = self._sent if best is None else best[0]
        with self._lock:
            own = News(
                self.exchange.bound,
                None if known else best,
                self._document,
                self._ended,
                self._failure,
            )
            self._document = None
        return own


_RACERS: dict[tuple[str, str], Racer] = {}
"""The racers of this process, by race and worker: several workers may share a process."""


def race(request: Request) -> None:
    """Runs a racer; a task of Dask."""
    from distributed import get_worker

    key = request.race, str(get_worker().address)
    racer = Racer(request, Exchange(request.part))
    _RACERS[key] = racer
    try:
        racer.run()
        while not (racer.left.wait(_LOOK_SECONDS) or racer.heard.is_over):
            pass  # The last news has still to be fetched, if somebody is there to fetch it.
    finally:
        del _RACERS[key]


def meet(race: str, news: News, dask_worker: Any) -> News | None:
    """Meets the racer of a worker; None: it has not begun, or has gone."""
    racer = _RACERS.get((race, str(dask_worker.address)))
    return None if racer is None else racer.meet(news)


def leave(race: str, dask_worker: Any) -> None:
    """Ends the racer of a worker."""
    racer = _RACERS.get((race, str(dask_worker.address)))
    if racer is not None:
        racer.cancel.cancel()
        racer.left.set()


def is_certain(status: str | None) -> bool:
    """Whether a racer's status ends the race."""
    return status in (Status.OPTIMAL, Status.INFEASIBLE)
