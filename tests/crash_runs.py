"""Kills `irc run` while it is being told things, and looks at what its journal brings back.

The journal that is left is also damaged in many ways: what it brings back must be all that was
acknowledged, or nothing at all.
"""

from __future__ import annotations

import contextlib
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from irc.diagnostics import InputError
from irc.driver.solve import solve_task
from irc.execution import Execution
from irc.model import Task
from irc.schedule import Schedule
from irc.service.journal import Journal
from irc.service.session import Session
from irc.targets import SolveOptions

TASK: dict[str, Any] = {
    "name": "crashing kitchen",
    "resources": [{"id": "oven", "capacity": 2}, {"id": "cook1"}, {"id": "cook2"}],
    "actions": [
        {
            "id": f"dish{k}",
            "duration": 3 + k % 4,
            "uses": [{"resource": "oven"}, {"one_of": ["cook1", "cook2"]}],
        }
        for k in range(8)
    ],
    "precedence": [["dish0", "dish3"], ["dish1", "dish4"], ["dish2", "dish6"]],
}
MODES = ("after a while", "as the journal grows")
WAIT_SECONDS = 60.0

SMALL = """
import irc.cli, irc.service.journal, irc.service.session
irc.service.session.MOST_REQUESTS = 7
irc.service.session.FEWEST_REQUESTS = 7
irc.service.journal.COMPACT_ABOVE = 20_000
irc.cli.main()
"""
"""`irc` with snapshots and shortening after so few requests that a crash can hit them."""


class LostError(AssertionError):
    """Something that was acknowledged is not there after a crash."""


def request(draw: random.Random, number: int) -> dict[str, Any]:
    """A request such as an executive makes; some are wrong."""
    name = f"r{number}"
    event = draw.choice(
        [
            [{"op": "set_capacity", "resource": "oven", "capacity": draw.randint(1, 2)}],
            [{"op": "set_duration", "action": f"dish{draw.randrange(8)}", "duration": 4}],
            [{"op": "cancel_actions", "actions": [f"dish{draw.randrange(8)}"]}],
            [
                {
                    "op": "add_actions",
                    "actions": [
                        {"id": name, "duration": draw.randint(1, 5), "uses": [{"resource": "oven"}]}
                    ],
                }
            ],
            [{"op": "cancel_actions", "actions": ["no such dish"]}],
        ]
    )
    made: dict[str, Any] = draw.choice(
        [
            {"do": "advance", "to": number * 0.1},
            {"do": "advance", "to": f"{number}/10"},
            {"do": "apply", "event": {"changes": event}, "replan": draw.random() < 0.3},
            {"do": "apply", "event": {"changes": event}},
            {"do": "observe", "action": f"dish{draw.randrange(8)}", "started": number * 0.1},
            {"do": "replan"},
            {"do": "state"},
            {"do": "fly"},
        ]
    )
    return {**made, "id": name}


@dataclass
class Kitchen:
    """One journal, the processes that write it one after the other, and what they promised."""

    folder: Path
    draw: random.Random
    acknowledged: list[str] = field(default_factory=list)
    requests: dict[str, dict[str, Any]] = field(default_factory=dict)
    replayed: int = 0
    unacknowledged_kept: int = 0
    shortened: int = 0
    damaged: Counter[str] = field(default_factory=Counter)

    def __post_init__(self) -> None:
        self.file = self.folder / "task.json"
        self.journal = self.folder / "run.journal"
        self.file.write_text(json.dumps(TASK), encoding="utf-8")
        self.task = Task.model_validate(TASK)
        self.options = SolveOptions(time_limit=30, workers=1)
        first = solve_task(self.task, self.options).schedule
        self.uninterrupted = Session.start(Execution(self.task, first, options=self.options))

    def start(self) -> subprocess.Popen[bytes]:
        """A new process on the same journal."""
        command = [sys.executable, "-c", SMALL, "run", str(self.file), "--stdio"]
        return subprocess.Popen(
            [*command, "--journal", str(self.journal), "--workers", "1", "--time-limit", "30"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env={**os.environ, "PYTHONUTF8": "1"},
        )

    def crash(self, mode: str) -> None:
        """Starts a process, tells it things until it is killed, and checks what is left."""
        process = self.start()
        try:
            greeting = self.read(process)
            self.check(greeting)
            killer = threading.Thread(target=self._kill, args=(process, mode), daemon=True)
            killer.start()
            self._talk(process)
            killer.join(WAIT_SECONDS)
        finally:
            process.kill()
            process.wait(WAIT_SECONDS)
            for stream in (process.stdin, process.stdout):
                assert stream is not None
                with contextlib.suppress(BrokenPipeError):  # killed while this was being sent
                    stream.close()

    def check(self, greeting: dict[str, Any]) -> None:
        """Whether a process that has just begun knows what the ones before it promised.

        A request in flight when the process was killed may be there or not. The state must be
        that of a process that was never killed and was told the same.
        """
        more = greeting["recovered"] - len(self.acknowledged)
        if more not in (0, 1):
            raise LostError(f"{len(self.acknowledged)} were acknowledged: {greeting}")
        if more:
            self.acknowledged.append(list(self.requests)[-1])
            self.unacknowledged_kept += 1
        last = self.acknowledged[-1] if self.acknowledged else None
        if greeting["last_id"] != last:
            raise LostError(f"the last one is {greeting['last_id']}, not {last}")
        for name in self.acknowledged[self.replayed :]:
            answer = self.uninterrupted.answer(json.dumps(self.requests[name]).encode())
            if not answer.document["ok"]:
                raise LostError(f"accepted before, refused now: {answer.line()}")
        self.replayed = len(self.acknowledged)
        there, expected = greeting["state"], self.uninterrupted.state()
        if _timeless(there) != _timeless(expected):
            raise LostError(f"the state is {there} and should be {expected}")
        if greeting["now"] != self.uninterrupted.greeting()["now"]:
            raise LostError(f"it is {greeting['now']}")
        self.shortened += b'"seq": 1,' not in self.journal.read_bytes() and self.replayed > 0

    def look(self) -> None:
        """Checks what a copy of the journal brings back in this process."""
        copy = self.folder / "copy.journal"
        shutil.copy(self.journal, copy)
        journal, found = Journal.open(copy)
        with journal:
            if found is None:  # It was killed before the first line was there.
                return
            session = Session.resume(self._begun, self.task, journal, found)
            self.check(json.loads(json.dumps(session.greeting())))

    def damage(self, times: int) -> None:
        """Damages copies of the journal: each is refused as it is, or brings back everything.

        `look` must have been called since the last crash.
        """
        copy = self.folder / "copy.journal"
        data = copy.read_bytes()
        if not data:
            return
        for _ in range(times):
            how = self.draw.choice(tuple(DAMAGE))
            changed = DAMAGE[how](self.draw, data)
            copy.write_bytes(changed)
            try:
                journal, found = Journal.open(copy)
            except InputError:
                self.damaged["refused"] += changed != data
            else:
                with journal:
                    assert found is not None
                    session = Session.resume(self._begun, self.task, journal, found)
                if _timeless(session.state()) != _timeless(self.uninterrupted.state()):
                    raise LostError(f"{how}: {session.greeting()}")
                self.damaged["mended"] += changed != data
            if copy.read_bytes() != changed:
                raise LostError(f"{how}: the damaged file was changed")

    def _begun(self, first: Schedule) -> Execution:
        return Execution(self.task, first, options=self.options)

    def _talk(self, process: subprocess.Popen[bytes]) -> None:
        assert process.stdin is not None
        while True:
            made = request(self.draw, len(self.requests) + 1)
            self.requests[made["id"]] = made
            try:
                process.stdin.write(json.dumps(made).encode() + b"\n")
                process.stdin.flush()
            except BrokenPipeError:
                return
            answer = self.read(process)
            if not answer:
                return
            if answer["ok"] and made["do"] != "state":
                self.acknowledged.append(made["id"])

    def read(self, process: subprocess.Popen[bytes]) -> dict[str, Any]:
        """The next answer; empty where the process is gone, or was killed in the middle of it."""
        assert process.stdout is not None
        line = process.stdout.readline()
        if not line.endswith(b"\n"):
            return {}
        answer: dict[str, Any] = json.loads(line)
        return answer

    def _kill(self, process: subprocess.Popen[bytes], mode: str) -> None:
        if mode == MODES[0]:
            time.sleep(self.draw.uniform(0.0, 1.0))
        else:
            self._wait_for_growth(self.draw.randint(1, 20))
        os.kill(process.pid, signal.SIGKILL)

    def _wait_for_growth(self, times: int) -> None:
        """Until the journal has grown so many times: between a write and what is told of it."""
        size, end = os.stat(self.journal).st_size, time.monotonic() + 2.0
        while times and time.monotonic() < end:
            now = os.stat(self.journal).st_size
            times -= now != size
            size = now


def _flip(draw: random.Random, data: bytes) -> bytes:
    changed = bytearray(data)
    for _ in range(draw.choice((1, 1, 1, 2, 5, 50))):
        changed[draw.randrange(len(data))] ^= draw.randrange(1, 256)
    return bytes(changed)


def _overwrite(draw: random.Random, data: bytes) -> bytes:
    """Some bytes are others; of the last line not all to its end, as if it had been torn."""
    begin = draw.randrange(len(data) - 1)
    end = min(len(data) - 1, begin + draw.choice((1, 3, 20, 500)))
    return data[:begin] + draw.randbytes(end - begin) + data[end:]


def _lines(draw: random.Random, data: bytes) -> bytes:
    """A line is gone, there twice, or has changed places with another; never the last one."""
    lines = data.splitlines(keepends=True)
    k, j = draw.randrange(len(lines) - 1), draw.randrange(len(lines) - 1)
    lines[k : k + 1] = draw.choice(([], [lines[k]] * 2, [lines[j]], [b"\n"], [b"{}\n"]))
    return b"".join(lines)


def _split(draw: random.Random, data: bytes) -> bytes:
    at = draw.randrange(len(data))
    return data[:at] + draw.choice((b"\n", b"\0", b"x" * 30)) + data[at:]


DAMAGE: dict[str, Callable[[random.Random, bytes], bytes]] = {
    "bits flipped": _flip,
    "bytes overwritten": _overwrite,
    "lines mixed up": _lines,
    "bytes put between": _split,
}
"""A file that is only cut at its end looks like one after a crash, so that is none of them."""


def _timeless(state: dict[str, Any]) -> dict[str, Any]:
    """A state without how long its schedule took to find."""
    return {**state, "schedule": {**state["schedule"], "seconds": None}}
