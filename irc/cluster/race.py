"""A race: each worker of a cluster searches for one task, and all of them exchange what they find.

Every worker gets a racer: one search with a seed, a part and all threads of its own. For each of
them there is a contact at home, a thread that meets it several times a second: it brings the best
schedule and bound that are known, and takes home what the racer has found. The answer is the best
of all; the driver validates it like that of any other engine.
"""

from __future__ import annotations

import math
import uuid
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from threading import Event, Lock, Thread
from typing import TYPE_CHECKING, Any, ClassVar

from irc.cluster.connecting import POLL_SECONDS, ClusterError, close, connected
from irc.cluster.racer import News, Request, is_certain, leave, meet, race
from irc.diagnostics import Code, Diagnostic
from irc.model.quantities import Number
from irc.outcome import FAILED
from irc.problem.objective_values import in_units
from irc.schedule import Schedule, Status
from irc.targets import (
    Budget,
    Cancellation,
    Engine,
    EngineFailed,
    Exchange,
    ObjectiveLevel,
    Outcome,
    Part,
    Program,
    Progress,
    SolveOptions,
)

if TYPE_CHECKING:
    from distributed import Client, Future

MEET_SECONDS = 0.25
"""Between two meetings with a racer."""

LOOK_SECONDS = 1.0
"""Between two looks at which workers there are."""

LEAVE_SECONDS = 0.4
"""How long the end of the racers is waited for; then they end by themselves."""

WORKERLESS_SECONDS = 5.0
"""A race that has lost all of its workers ends if no other is there by then."""

LAST_SECONDS = 0.5
"""Racers end this much earlier than the race, so that their last words are heard."""


SEED_STEP = 1_000
"""Between the seeds of two racers: each thread of a racer takes the next seed from its own on."""

SEEDS = 1 << 31
"""Seeds are less than this."""


class ClusterLost(ClusterError):
    """The cluster went away during a race that had found nothing yet."""

    ends_as = FAILED


class ClusterEngine(Engine):
    """An engine whose search is a race on the workers of a Dask cluster."""

    name: ClassVar[str] = "cluster"

    def __init__(self, scheduler: str, engine: Engine) -> None:
        self.scheduler, self.engine = scheduler, engine

    def missing(self) -> str | None:
        """The reason why the engine of the racers is missing here, where answers are read."""
        return self.engine.missing()

    def solve(self, program: Program, options: SolveOptions, budget: Budget) -> Outcome:
        """The best answer of all racers within the budget.

        Raises `LibraryMissing`, `ClusterError`, and `EngineFailed` where no racer could search.
        """
        cancel = budget.cancel or Cancellation()
        client = connected(self.scheduler, cancel, "irc-race", solvers=True)
        if client is None:
            return Outcome(Status.UNKNOWN, self.engine.name)
        running = Race(client, program, options, budget, self.engine.name)
        try:
            return running.run()
        finally:
            running.end()
            close(client, 0.1)


@dataclass
class Contact:
    """A worker that has a racer: how it has ended, or why it was lost."""

    worker: str
    threads: int
    part: Part
    future: Future | None = None
    thread: Thread | None = None
    brought: tuple[int, Any] | None = None
    ended: str | None = None
    failure: str | None = None
    is_lost: bool = False
    why: str | None = None

    @property
    def is_over(self) -> bool:
        """Whether nothing more comes from it."""
        return self.is_lost or self.ended is not None or self.failure is not None


@dataclass
class Race:
    """The race for one program; `run` returns its outcome, and `end` ends all racers."""

    client: Client
    program: Program
    options: SolveOptions
    budget: Budget
    engine: str
    name: str = field(default_factory=lambda: uuid.uuid4().hex)
    exchange: Exchange = field(default_factory=Exchange)
    contacts: dict[str, Contact] = field(default_factory=dict)
    best: Schedule | None = None
    workerless: Budget | None = None
    gone: str | None = None
    _is_ending: Event = field(default_factory=Event)
    _lock: Lock = field(default_factory=Lock)
    _error: BaseException | None = None

    def run(self) -> Outcome:
        """The outcome when the budget is over, an answer is proven, or all racers have ended."""
        look = Budget(0)
        while not self.budget.is_over and self._error is None:
            if look.is_over:
                look = Budget(LOOK_SECONDS)
                if not self._begin_where_new():
                    break
            if self._is_decided or self._is_over():
                break
            self._is_ending.wait(POLL_SECONDS)
        self.end()
        if self._error is not None:
            raise self._error
        return self._outcome()

    @property
    def _is_refuted(self) -> bool:
        """Whether a racer has proven that there is no schedule."""
        return any(c.ended == Status.INFEASIBLE for c in self.contacts.values())

    @property
    def _is_decided(self) -> bool:
        if any(is_certain(c.ended) for c in self.contacts.values()):
            return True
        if self.best is None or len(self.program.problem.objectives) > 1:
            return False
        first = self._levels(self.best)[0]
        return first.bound is not None and first.value == first.bound

    def _is_over(self) -> bool:
        """Whether all racers have ended; where all were lost, workers may come back for a while."""
        if not all(contact.is_over for contact in self.contacts.values()):
            self.workerless = None
            return False
        if any(not contact.is_lost for contact in self.contacts.values()):
            return True
        self.workerless = self.workerless or Budget(WORKERLESS_SECONDS)
        return self.workerless.is_over

    def _begin_where_new(self) -> bool:
        """Gives a racer to each worker that has none; False: the scheduler went away."""
        try:
            workers: dict[str, int] = self.client.nthreads()
        except Exception as error:  # noqa: BLE001 - whatever a lost connection raises
            self.gone = f"{type(error).__name__}: {error}"
            return False
        for address, contact in self.contacts.items():
            contact.is_lost = contact.is_lost or address not in workers
        new = {a: n for a, n in sorted(workers.items()) if a not in self.contacts}
        count = len(self.contacts) + len(new)
        for address, threads in new.items():
            part = Part(len(self.contacts), count)
            contact = self.contacts[address] = Contact(address, threads, part)
            contact.thread = Thread(
                target=self._keep, args=(contact,), name="irc-contact", daemon=True
            )
            contact.thread.start()
        return True

    def _request(self, contact: Contact) -> Request:
        options, left = self.options, self.budget.left
        chosen = {
            "target": self.program.target,
            "engine": self.engine,
            "memory_limit": options.memory_limit,
            "workers": min(options.workers or contact.threads, contact.threads),
            "seed": (options.seed + SEED_STEP * contact.part.number) % SEEDS,
        }
        seconds = max(POLL_SECONDS, left - LAST_SECONDS) if self.budget.is_limited else None
        return Request(self.name, self.program.task, chosen, seconds, contact.part)

    def _keep(self, contact: Contact) -> None:
        """Keeps the contact to a racer: a thread."""
        try:
            contact.future = self.client.submit(
                race, self._request(contact), workers=[contact.worker], pure=False
            )
            while not (self._is_ending.wait(MEET_SECONDS) or contact.is_over):
                self._meet(contact)
            self.client.run(leave, self.name, workers=[contact.worker])
        except Exception as error:  # noqa: BLE001 - whatever is raised where a worker has gone
            if not self._is_ending.is_set():
                contact.is_lost = True
                contact.why = f"{type(error).__name__}: {error}"

    def _meet(self, contact: Contact) -> None:
        known = self.exchange.best
        ours = News(self.exchange.bound, None if known is contact.brought else known)
        (theirs,) = self.client.run(meet, self.name, ours, workers=[contact.worker]).values()
        if theirs is not None:
            contact.brought = known
            self._take(contact, theirs)
        elif contact.future is not None and contact.future.status == "error":
            contact.failure = str(contact.future.exception(timeout=LEAVE_SECONDS))

    def _take(self, contact: Contact, theirs: News) -> None:
        """Takes home what a racer has found."""
        self.exchange.prove(theirs.bound)
        if theirs.best is not None:
            self.exchange.offer(*theirs.best)
        if theirs.document is not None:
            self._take_schedule(Schedule.from_dict(theirs.document))
        contact.ended, contact.failure = theirs.ended, theirs.failure

    def _take_schedule(self, schedule: Schedule) -> None:
        with self._lock:
            if self.best is not None and _rank(schedule) >= _rank(self.best):
                return
            self.best = schedule
            tell = self.options.on_progress
            if tell is None or self._error is not None:
                return
            levels = self._levels(schedule)
            name, seconds = levels[0].name, self.budget.elapsed
            try:
                tell(Progress(seconds, self.engine, name, levels, lambda: schedule))
            except BaseException as error:  # noqa: BLE001 - it is raised where the call waits
                self._error = error

    def _levels(self, schedule: Schedule) -> tuple[ObjectiveLevel, ...]:
        """The values of a schedule, with the best bound on the first one that any racer has."""
        levels = tuple(ObjectiveLevel(o.name, o.value, o.bound) for o in schedule.objective)
        first = levels[0]
        if first.name == "reward" or not self.exchange.bound:
            return levels
        bound = in_units(self.program.problem, first.name, self.exchange.bound)
        return (replace(first, bound=max(bound, first.bound or bound)), *levels[1:])

    def _outcome(self) -> Outcome:
        notes = tuple(self._notes())
        seconds, best, bound = self.budget.elapsed, self.best, self.exchange.bound
        if best is None:
            if self._is_refuted:
                return Outcome(Status.INFEASIBLE, self.engine, notes=notes, seconds=seconds)
            failures = [c.failure for c in self.contacts.values() if c.failure is not None]
            if failures and len(failures) == len(self.contacts):
                raise EngineFailed(f"no worker of the cluster could search: {failures[0]}")
            if self.gone is not None:
                raise ClusterLost(f"the cluster went away, and no schedule was found: {self.gone}")
            return Outcome(Status.UNKNOWN, self.engine, notes=notes, seconds=seconds)
        if self._is_refuted:
            raise EngineFailed("a worker refutes a schedule that another one has found")
        levels = self._levels(best)
        is_makespan = self.program.problem.objectives[0] == "makespan"
        return Outcome(
            best.status if best.status is Status.OPTIMAL else Status.FEASIBLE,
            self.engine,
            best,
            bound if is_makespan else 0,
            seconds,
            notes,
            levels,
        )

    def _notes(self) -> Sequence[Diagnostic]:
        """The workers that failed or were lost on the way, with the reasons."""
        found = [
            Diagnostic(Code.NO_ANSWER, f"worker {c.worker} failed: {c.failure}")
            for c in self.contacts.values()
            if c.failure is not None
        ]
        if self.gone is not None:
            text = f"the cluster went away ({self.gone}); what it had found counts"
            return [Diagnostic(Code.NO_ANSWER, text)]
        lost = [contact for contact in self.contacts.values() if contact.is_lost]
        if lost:
            were = f"{len(lost)} of {len(self.contacts)} workers were lost"
            text = f"{were} ({lost[0].why or 'gone'}); what they had found counts"
            found.append(Diagnostic(Code.NO_ANSWER, text))
        return found

    def end(self) -> None:
        """Ends all racers, and waits for it a little: those that are not reached end later."""
        if self._is_ending.is_set():
            return
        self._is_ending.set()
        patience = Budget(LEAVE_SECONDS)
        for contact in self.contacts.values():
            if contact.thread is not None:
                contact.thread.join(patience.left)
        futures = [c.future for c in self.contacts.values() if c.future is not None]
        for future in futures:
            future.release()


def _rank(schedule: Schedule) -> tuple[list[Number], bool, list[float]]:
    """Less is better: objective values in their order, then proofs, then gaps."""
    known = schedule.objective
    costs: list[Number] = [-o.value if o.name == "reward" else o.value for o in known]
    gaps = [math.inf if o.bound is None else abs(float(o.value) - float(o.bound)) for o in known]
    return costs, schedule.status is not Status.OPTIMAL, gaps
