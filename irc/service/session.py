"""A session of `irc run`: requests in, answers out, and a journal that survives the process.

A request is either accepted as a whole and on disk before its answer, or its answer is an error and
it changes nothing. The journal has the requests as they were sent and the schedule of every step,
so that replaying it solves nothing and ends in the same state.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, Self

from irc._version import __version__
from irc.diagnostics import Code, Diagnostic, InputError, Report
from irc.execution.execution import Execution
from irc.execution.simulation import in_order
from irc.frontends.events import PlacedEvent
from irc.frontends.json.value import read_value
from irc.model import Event, Task
from irc.model.canonical import task_sha256, written_task
from irc.model.times import json_number
from irc.outcome import Outcome
from irc.schedule import Schedule
from irc.schedule.reading import schedule_from_json
from irc.service.journal import Journal, JournalError, Recovered
from irc.service.protocol import (
    MAX_LINE,
    Request,
    decode_request,
    event_of,
    is_id,
    observation_of,
    time_of,
    to_request,
)
from irc.service.same_task import require_task
from irc.service.snapshot import SnapshotError, from_snapshot, to_snapshot
from irc.targets import Budget, EngineFailed, EngineMissing, UnknownTarget

RUN_VERSION = "1"

MOST_REQUESTS, FEWEST_REQUESTS, ACTIONS_REPLAYED = 50, 10, 10_000
"""A snapshot follows 50 requests, or fewer for a task of more than 200 actions, down to 10."""


@dataclass(frozen=True)
class Reply:
    """The answer to one request, and whether the session ends with it."""

    document: Mapping[str, Any]
    last: bool = False

    def line(self) -> str:
        """The answer as one line of JSON."""
        return json.dumps(self.document, ensure_ascii=False, allow_nan=False)


@dataclass
class Session:
    """An execution that is held open. `start` or `resume` makes one."""

    execution: Execution
    journal: Journal | None = None
    notes: tuple[Diagnostic, ...] = ()
    recovered: int = 0
    """The number of replayed requests."""
    last_id: Any = None
    """The "id" of the last request that was accepted."""
    happened: tuple[Event, ...] = ()
    """The events of the last request that was accepted."""
    _accepted: int = 0
    _since_snapshot: int = 0

    @classmethod
    def start(cls, execution: Execution, journal: Journal | None = None) -> Self:
        """A session that begins with an execution at its start."""
        if journal is not None:
            task = execution.task
            journal.begin(
                {
                    "task": task.name,
                    "task_sha256": task_sha256(task),
                    "document": written_task(task),
                    "schedule": execution.schedule.to_dict(),
                    "presume": execution.presume,
                }
            )
        return cls(execution, journal, execution.take_notes())

    @classmethod
    def resume(
        cls, make: Callable[[Schedule], Execution], task: Task, journal: Journal, found: Recovered
    ) -> Self:
        """The session in a journal. `make` makes the execution from its first schedule.

        Raises `InputError` if the journal belongs to another task or cannot be replayed.
        """
        schedule = first_schedule(task, found)
        session, requests = cls._begun(make(schedule), found)
        for number, text in requests:
            try:
                entry, _ = read_value(text, "<journal>")
                session._replay(entry)
            except (InputError, KeyError, TypeError) as error:
                raise _not_replayed(number, error, found) from None
        session.journal = journal
        return session

    @classmethod
    def _begun(cls, first: Execution, found: Recovered) -> tuple[Self, tuple[tuple[int, str], ...]]:
        """(the session at the last snapshot that can be read, the requests since).

        `first` is the execution at its start, for a journal without one.
        """
        for start in found.starts():
            if start.snapshot is None:
                return cls(first, None, (*found.notes, *first.take_notes())), start.requests
            try:
                saved, _ = read_value(start.snapshot, "<journal>")
                saved = saved["snapshot"]
                execution = from_snapshot(saved["execution"], first.options)
                session = cls(execution, None, found.notes, saved["recovered"], saved["last_id"])
            except (InputError, KeyError, SnapshotError, TypeError):
                continue  # Of another version; an earlier one, or the beginning, does as well.
            return session, start.requests
        raise InputError(_of_another_version(found))

    def save(self) -> str | None:
        """Writes a snapshot to the journal if enough requests have come since the last one.

        Returns why it could not be written, if it could not: nothing is lost by that.
        """
        size = len(self.execution.unobserved.actions)
        every = max(FEWEST_REQUESTS, min(MOST_REQUESTS, ACTIONS_REPLAYED // (size + 1)))
        if self.journal is None or self._since_snapshot < every:
            return None
        self._since_snapshot = 0
        known = {"recovered": self.recovered + self._accepted, "last_id": self.last_id}
        try:
            self.journal.save(_one_line({**known, "execution": to_snapshot(self.execution)}))
        except OSError as error:
            return f"no snapshot could be added to the journal: {error.strerror or error}"
        return None

    def greeting(self) -> dict[str, Any]:
        """The first message: the state of the execution, and the number of replayed requests."""
        return {
            "ok": True,
            "irc_run": RUN_VERSION,
            "recovered": self.recovered,
            "last_id": self.last_id,
            **self._now_and_notes(self.notes),
            "state": self.state(),
        }

    def answer(self, line: bytes) -> Reply:
        """The answer to one request. Raises `irc.service.journal.JournalError`, which ends it."""
        name: Any = None
        arrived = Budget()
        self.happened = ()
        before = self.execution.copy()
        try:
            raw, source = decode_request(line)
            name = raw.get("id") if is_id(raw.get("id")) else None
            request = to_request(raw, source)
            if request.do == "stop":
                return Reply(_with_id(name, {"ok": True, **self._now_and_notes()}), last=True)
            if request.do == "state":
                answer = {"ok": True, **self._now_and_notes(), "state": self.state()}
                return Reply(_with_id(name, answer))
            document = self._do(request, arrived)
        except InputError as error:
            self.execution = before
            message = error.report.errors[0].message
            return Reply(_with_id(name, self._refused(message, error.outcome, error.report)))
        except (EngineFailed, EngineMissing, UnknownTarget) as error:
            self.execution = before
            return Reply(_with_id(name, self._refused(str(error), error.outcome)))
        try:
            self._record(source.text, document.get("step"))
        except JournalError:
            self.execution = before
            raise
        self.last_id = name
        return Reply(_with_id(name, document))

    def too_long(self) -> Reply:
        """The answer to a line that is too long for a request."""
        message = f"a request may have at most {MAX_LINE:,} bytes"
        finding = Diagnostic(Code.TOO_LARGE, message, hint="send it in several requests")
        report = Report((finding,))
        return Reply(self._refused(message, report.outcome, report))

    def broken(self, message: str) -> Reply:
        """The last answer, if the journal can no longer be written."""
        return Reply(self._refused(message, JournalError(message).outcome), last=True)

    def state(self) -> dict[str, Any]:
        """The state of the execution: the completed, running and open actions, and the plan."""
        execution = self.execution
        state = execution.state()
        return {
            "completed": [entry.id for entry in state.completed],
            "running": [entry.id for entry in state.running],
            "stopped": [entry.id for entry in state.stopped],
            "open": [entry.id for entry in state.open],
            "replan_needed": execution.replan_needed,
            "events": [
                {"id": event.id, "at": json_number(execution.task.number(event.at))}
                for event in in_order(execution.task)
            ],
            "task_sha256": task_sha256(execution.task),
            "schedule": execution.schedule.to_dict(),
        }

    def _refused(
        self, message: str, outcome: Outcome, report: Report | None = None
    ) -> dict[str, Any]:
        """An answer with an error message, and every finding if the request is faulty."""
        found = [] if report is None else report.to_list()
        now = json_number(self.execution.now)
        error = {"message": message, "diagnostics": found}
        return {"ok": False, "now": now, "error": error, "outcome": outcome.to_dict()}

    def _now_and_notes(self, notes: Sequence[Diagnostic] = ()) -> dict[str, Any]:
        return {"now": json_number(self.execution.now), "notes": [d.to_dict() for d in notes]}

    def _do(self, request: Request, arrived: Budget) -> dict[str, Any]:
        """The answer to a request, with the step if it replanned, after changing the execution."""
        known = len(self.execution.pending)
        notes = self._change(request)
        self.happened = self.execution.pending[known:]
        if not request.replan:
            return {"ok": True, **self._now_and_notes(notes)}
        step = self.execution.replan(since=arrived)
        answer = {"ok": True, **self._now_and_notes((*notes, *step.notes))}
        return {**answer, "step": step.to_dict()}

    def _change(self, request: Request) -> tuple[Diagnostic, ...]:
        """The notes on a request, after changing the execution, before planning again."""
        change = _CHANGES.get(request.do)
        return () if change is None else change(self, request)

    def _advance(self, request: Request) -> tuple[Diagnostic, ...]:
        to = time_of(request, "to", self.execution.unobserved)
        try:
            self.execution.advance(to)
        except InputError as error:
            raise InputError(_placed(error.report, request, "to")) from None
        return tuple(_placed(Report(self.execution.take_notes()), request, "to").located())

    def _observe(self, request: Request) -> tuple[Diagnostic, ...]:
        execution = self.execution
        try:
            report = execution.apply(observation_of(request, execution.unobserved, execution.now))
        except InputError as error:
            raise InputError(_placed(error.report, request)) from None
        return tuple(_placed(report, request).located())

    def _apply(self, request: Request) -> tuple[Diagnostic, ...]:
        execution = self.execution
        event = event_of(request, execution.task, execution.now)
        placed = PlacedEvent(event, ("event",), request.source)
        try:
            report = execution.apply(event)
        except InputError as error:
            raise InputError(placed.anchored(error.report)) from None
        return tuple(placed.anchored(report).located())

    def _record(self, request: str, step: Mapping[str, Any] | None) -> None:
        if self.journal is None:
            return
        result = "" if step is None else f', "step": {json.dumps(step)}'
        self.journal.append(f'{{"request": {request.strip()}{result}}}')
        self._accepted += 1
        self._since_snapshot += 1

    def _replay(self, entry: Mapping[str, Any]) -> None:
        request = to_request(entry["request"], read_value("{}", "<journal>")[1])
        self._change(request)
        if request.replan:
            schedule = schedule_from_json(entry["step"]["schedule"])
            if schedule.answered:
                self.execution.adopt(schedule)
            else:
                self.execution.reject()
        self.recovered += 1
        self._since_snapshot += 1
        self.last_id = request.id


_CHANGES: Mapping[str, Callable[[Session, Request], tuple[Diagnostic, ...]]] = MappingProxyType(
    {"advance": Session._advance, "observe": Session._observe, "apply": Session._apply}
)


def first_schedule(task: Task, found: Recovered) -> Schedule:
    """The first schedule of a journal. Raises `InputError` if it belongs to another task."""
    require_task(task, found.header)
    return schedule_from_json(found.header.get("schedule") or {})


def _one_line(document: Mapping[str, Any]) -> str:
    """A document as JSON on one line."""
    return json.dumps(document, ensure_ascii=False, allow_nan=False)


def _of_another_version(found: Recovered) -> Report:
    """The report for a journal that has only snapshots which cannot be read."""
    writer = found.header.get("irc")
    return _bad_journal(
        Code.JOURNAL_VERSION,
        f"no snapshot of the journal can be read; irc {writer} wrote it, and this is {__version__}",
        "continue it with the version of irc that wrote it",
    )


def _writer(found: Recovered) -> str:
    """The version of irc that began a journal, in brackets, if another one continues it."""
    writer = found.header.get("irc")
    return f" (irc {writer})" if isinstance(writer, str) and writer != __version__ else ""


def _bad_journal(code: Code, message: str, hint: str) -> Report:
    return Report((Diagnostic(code, message, hint=hint),))


def _not_replayed(line: int, error: Exception, found: Recovered) -> InputError:
    """The error for an undamaged journal whose requests are no longer accepted."""
    if isinstance(error, InputError) and error.report.errors:
        reason = error.report.errors[0].message
    else:
        reason = "it is not an entry of `irc run`"
    return InputError(
        _bad_journal(
            Code.BAD_JOURNAL,
            f"line {line} of the journal cannot be replayed: {reason}",
            f"continue it with the version of irc that wrote it{_writer(found)}",
        )
    )


def _placed(report: Report | None, request: Request, field: str | None = None) -> Report:
    """A report on the elements that a request names, placed in the request's text."""
    if report is None:
        return Report()

    def there(d: Diagnostic) -> Diagnostic:
        known = (part for part in reversed(d.pointer) if part in request.raw)
        key = field or next(known, None)
        return replace(d, pointer=() if key is None else (key,), fix=())

    return Report(tuple(map(there, report)), request.source)


def _with_id(name: Any, document: dict[str, Any]) -> dict[str, Any]:
    """An answer with the request's "id" after "ok", if it has one."""
    if name is None:
        return document
    return {"ok": document["ok"], "id": name, **document}
