"""Runs trials in worker processes of this machine.

Each worker is asked one trial after the other. A worker that dies is replaced, and its trial is
tried once more; a trial that takes a second worker with it has failed. A worker that goes on far
beyond the time limit is ended, and its trial has failed as well.
"""

from __future__ import annotations

import json
import os
import queue
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import IO, Any

from irc.batches.result import ended_as, fault_of
from irc.batches.trial import Trial
from irc.outcome import FAILED
from irc.targets import Budget, Cancellation
from irc.targets.process import ProcessTree

Answered = tuple[Trial, Mapping[str, Any]]
"""A trial and the answer of a worker."""

ATTEMPTS = 2
"""A trial whose worker dies is given to this many workers."""

AHEAD = 8
"""Trials that are read ahead for each worker, so that none waits for the reading."""

MOST_CHARACTERS = 64_000_000
"""Of longer texts none is read ahead."""

POLL_SECONDS = 0.05

OVERTIME_FACTOR, OVERTIME_SECONDS = 1.2, 15.0
"""How far beyond the time limit a worker may go on before it is ended."""

_LAST_WORDS = 300
"""Characters of standard error that are reported of a worker that died."""


def processor_count() -> int:
    """The number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


@dataclass(frozen=True, slots=True)
class LocalOptions:
    """How many worker processes there are, and whether answers have their schedules."""

    processes: int
    schedules: bool = False


def run_locally(
    trials: Iterator[Trial], options: LocalOptions, cancel: Cancellation
) -> Iterator[Answered]:
    """The answers of all trials as they come; once cancelled, no more of them.

    All workers, and what they started, have ended when the iteration ends, however it does.
    """
    pool = _Pool(options)
    try:
        yield from pool.answers(trials, cancel)
    finally:
        pool.end()


class _Pool:
    """Worker processes, and a thread for each that asks it."""

    def __init__(self, options: LocalOptions) -> None:
        self.options = options
        # (A worker that is ended leaves its temporary files; they go with this folder.)
        self.folder = tempfile.TemporaryDirectory(prefix="irc-batch-", ignore_cleanup_errors=True)
        self.requests: queue.SimpleQueue[Trial | None] = queue.SimpleQueue()
        self.found: queue.SimpleQueue[Answered] = queue.SimpleQueue()
        self.askers: list[_Asker] = []

    def answers(self, trials: Iterator[Trial], cancel: Cancellation) -> Iterator[Answered]:
        running, size, exhausted = 0, 0, False
        while not cancel.is_cancelled:
            while not exhausted and self._has_room(running, size) and not cancel.is_cancelled:
                trial = next(trials, None)
                exhausted = trial is None
                if trial is not None and (fault := fault_of(trial)) is not None:
                    yield trial, fault
                elif trial is not None:
                    running, size = running + 1, size + trial.size
                    self._give(trial)
            if not running:
                return
            with suppress(queue.Empty):
                trial, answer = self.found.get(timeout=POLL_SECONDS)
                running, size = running - 1, size - trial.size
                yield trial, answer
            for asker in self.askers:
                asker.end_if_overdue()

    def _has_room(self, running: int, size: int) -> bool:
        processes = self.options.processes
        return running < processes or (running < processes * AHEAD and size < MOST_CHARACTERS)

    def _give(self, trial: Trial) -> None:
        self.requests.put(trial)
        if len(self.askers) < self.options.processes:
            asker = _Asker(self.requests, self.found, self.options.schedules, self.folder.name)
            self.askers.append(asker)
            asker.start()

    def end(self) -> None:
        """Ends all workers, at the same time, and removes their temporary files."""
        for asker in self.askers:
            asker.ask_to_end()
        for asker in self.askers:
            asker.end()
        self.folder.cleanup()


class _WorkerDied(Exception):
    """The worker process ended before it answered."""


class _Asker(threading.Thread):
    """Asks one worker process after the other, as they die."""

    def __init__(
        self,
        requests: queue.SimpleQueue[Trial | None],
        found: queue.SimpleQueue[Answered],
        schedules: bool,
        folder: str,
    ) -> None:
        super().__init__(name="irc-batch", daemon=True)
        self.requests, self.found, self.schedules = requests, found, schedules
        self.folder = folder
        self.lock = threading.Lock()
        self.worker: _Worker | None = None
        self.over = False
        self.overdue: str | None = None
        self.patience = Budget()

    def run(self) -> None:
        while (trial := self.requests.get()) is not None and not self.over:
            self.found.put((trial, self._answer(trial)))

    def _answer(self, trial: Trial) -> Mapping[str, Any]:
        request = {"trial": trial.request(), "schedules": self.schedules}
        line = json.dumps(request).encode() + b"\n"
        reason, budget = "", Budget()
        for _ in range(ATTEMPTS):
            try:
                return self._asked(trial, line)
            except _WorkerDied as death:
                reason = self.overdue or str(death)
                if self.over or self.overdue:
                    break
        return ended_as(FAILED, reason, budget.elapsed)

    def _asked(self, trial: Trial, line: bytes) -> Mapping[str, Any]:
        limit = trial.options.time_limit
        with self.lock:
            if self.over:
                raise _WorkerDied("the batch has ended")
            self.overdue = None
            worker = self.worker = self.worker or _Worker(self.folder)
            seconds = None if limit is None else limit * OVERTIME_FACTOR + OVERTIME_SECONDS
            self.patience = Budget(seconds)
        try:
            return worker.ask(line)
        except _WorkerDied:
            with self.lock:
                worker.end()
                worker.close()
                self.worker = None
            raise
        finally:
            self.patience = Budget()

    def end_if_overdue(self) -> None:
        """Ends the worker if it has gone on far beyond the time limit."""
        if self.patience.is_over and self.worker is not None:
            self.overdue = f"the worker did not end within {self.patience.limit:g} s and was ended"
            self.worker.end()

    def ask_to_end(self) -> None:
        """Lets the worker end, and this thread with it."""
        self.over = True
        self.requests.put(None)
        with self.lock:
            if self.worker is not None:
                self.worker.tree.ask_to_end()

    def end(self) -> None:
        """Ends the worker, and what it started; the thread has nothing to wait for then."""
        with self.lock:
            worker = self.worker
            if worker is not None:
                worker.end()
        self.join(1.0)
        if worker is not None and not self.is_alive():
            worker.close()


class _Worker:
    """A worker process with its pipes; its temporary files are in a folder."""

    def __init__(self, folder: str) -> None:
        self.errors: IO[bytes] = tempfile.TemporaryFile()  # noqa: SIM115 - `close` closes it
        self.tree = ProcessTree()
        command = [sys.executable, "-P", "-m", "irc.batches.worker"]
        self.process = self.tree.start(command, None, True, None, _environment(folder), self.errors)
        self.pipe_in, self.pipe_out = self.process.stdin, self.process.stdout

    def ask(self, line: bytes) -> Mapping[str, Any]:
        """The answer to a request. Raises `_WorkerDied` where the process ended before it."""
        try:
            _write_all(self.pipe_in, line)
            answer = _read_line(self.pipe_out)
            return dict(json.loads(answer))
        except (OSError, ValueError):  # (Without its end a line is no JSON.)
            raise _WorkerDied(self._last_words()) from None

    def _last_words(self) -> str:
        with suppress(subprocess.TimeoutExpired):
            self.process.wait(1.0)
        code = self.process.returncode
        how = "closed its output" if code is None else f"ended with status {code}"
        if code is not None and code < 0:
            how = f"was ended by {_signal_name(-code)}"
        self.errors.seek(0)
        text = self.errors.read()[-_LAST_WORDS:].decode("utf-8", "replace").strip()
        return f"the worker process {how}" + (f": {text}" if text else "")

    def end(self) -> None:
        """Ends the process with all that it started."""
        self.tree.end()

    def close(self) -> None:
        """Closes the pipes, which nothing reads any more."""
        self.errors.close()
        for stream in (self.pipe_in, self.pipe_out):
            if stream is not None:
                with suppress(OSError):
                    stream.close()


def _write_all(stream: IO[bytes] | None, data: bytes) -> None:
    if stream is None:
        raise OSError("the worker has no input")
    rest = memoryview(data)
    while rest:
        rest = rest[stream.write(rest) :]


def _read_line(stream: IO[bytes] | None) -> bytes:
    """The bytes up to the end of the line, or of the stream (it is not buffered)."""
    if stream is None:
        raise OSError("the worker has no output")
    parts = []
    while part := stream.read(1_048_576):
        parts.append(part)
        if part.endswith(b"\n"):
            break
    return b"".join(parts)


def _signal_name(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"


def _environment(folder: str) -> dict[str, str]:
    """The environment of a worker, with the packages of this process and its temporary folder."""
    path = os.pathsep.join(os.path.abspath(folder) for folder in sys.path)
    return {
        **os.environ,
        "PYTHONPATH": path,
        "PYTHONUTF8": "1",
        **dict.fromkeys(("TMPDIR", "TEMP", "TMP"), folder),
    }
