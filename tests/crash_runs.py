"""Kills `irc run` while it is being told things, and looks at what its journal brings back."""

from __future__ import annotations

import contextlib
import json
import os
import random
import signal
import subprocess
import sys
import threading
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from irc.driver.solve import solve_task
from irc.execution import Execution
from irc.model import Task
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
    sent: int = 0
    replayed: int = 0
    unacknowledged_kept: int = 0

    def __post_init__(self) -> None:
        self.file = self.folder / "task.json"
        self.journal = self.folder / "run.journal"
        self.file.write_text(json.dumps(TASK), encoding="utf-8")
        task = Task.model_validate(TASK)
        first = solve_task(task, SolveOptions(time_limit=30, workers=1)).schedule
        self.uninterrupted = Session.start(Execution(task, first, time_limit=30.0, workers=1))

    def start(self) -> subprocess.Popen[bytes]:
        """A new process on the same journal."""
        command = [sys.executable, "-m", "irc", "run", str(self.file), "--stdio"]
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
        requests = [json.loads(line)["entry"] for line in self.journal.read_text().splitlines()][1:]
        ids = [entry["request"]["id"] for entry in requests]
        known = len(self.acknowledged)
        if ids[:known] != self.acknowledged or greeting["recovered"] != len(ids):
            raise LostError(f"{self.acknowledged} were acknowledged, {ids} are there")
        if len(ids) > known + 1:
            raise LostError(f"{ids[known:]} are there, and only one of them can be")
        self.unacknowledged_kept += len(ids) - known
        self.acknowledged = ids
        for entry in requests[self.replayed :]:
            answer = self.uninterrupted.answer(json.dumps(entry["request"]).encode())
            if not answer.document["ok"]:
                raise LostError(f"accepted before, refused now: {answer.line()}")
        self.replayed = len(requests)
        there, expected = greeting["state"], self.uninterrupted.state()
        if _timeless(there) != _timeless(expected):
            raise LostError(f"the state is {there} and should be {expected}")
        if greeting["now"] != self.uninterrupted.greeting()["now"]:
            raise LostError(f"it is {greeting['now']}")

    def _talk(self, process: subprocess.Popen[bytes]) -> None:
        assert process.stdin is not None
        while True:
            self.sent += 1
            made = request(self.draw, self.sent)
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
            time.sleep(self.draw.uniform(0.0, 0.25))
        else:
            self._wait_for_growth(self.draw.randint(1, 12))
        os.kill(process.pid, signal.SIGKILL)

    def _wait_for_growth(self, times: int) -> None:
        """Until the journal has grown so many times: between a write and what is told of it."""
        size, end = os.stat(self.journal).st_size, time.monotonic() + 2.0
        while times and time.monotonic() < end:
            now = os.stat(self.journal).st_size
            times -= now != size
            size = now


def _timeless(state: dict[str, Any]) -> dict[str, Any]:
    """A state without how long its schedule took to find."""
    return {**state, "schedule": {**state["schedule"], "seconds": None}}
