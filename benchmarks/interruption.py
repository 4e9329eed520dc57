"""Interrupts commands at random times and checks what they leave behind.

    python benchmarks/interruption.py [--times 100] [--seed 0] [--commands solve explain …]
        [--targets cpsat pddl21] [--actions 20 60 200] [--within 4] [--allowed 1]

Each time one of the commands is begun on a random shop, with files to write, and gets ^C (or, one
time in four, SIGTERM) at a random moment of its first seconds, counted from when it handles signals
(a few hundredths of a second after Python begins). Judged are the seconds until it has ended, its
exit status, what it printed (a schedule is validated again; what is interrupted is not called
optimal), that every file is as before or new and whole, and that no process and no temporary file
is left. Ends with status 1 where anything is wrong.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import secrets
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import irc
from irc.model import Task
from online_speed import failure, task_of

COMMANDS = ("solve", "explain", "simulate", "replan", "batch")
SIGNALS = (signal.SIGINT, signal.SIGINT, signal.SIGINT, signal.SIGTERM)
OLD = '{"old": true}\n'
"""What stands in the files before a command writes them."""


@dataclass(frozen=True)
class Shop:
    """A task of some size, with an event, a plan and a task that has no schedule."""

    eventful: Path
    impossible: Path
    plan: Path
    task: Task
    at: str

    @classmethod
    def written(cls, folder: Path, size: int, seed: int) -> Shop:
        """The files of a random shop in which a station fails."""
        rng = random.Random(f"{size} {seed}")
        made = task_of(rng, size, 20 if size >= 100 else 6, True)
        plan = irc.solve(made, time_limit=2)
        event = failure(rng, made, plan.makespan)
        shown: dict[str, Any] = {"mode": "json", "by_alias": True, "exclude_unset": True}
        document = made.model_dump(**shown)
        eventful = {**document, "events": [event.model_dump(**shown)]}
        cases = {
            "eventful": eventful,
            "impossible": {**document, "deadline": int(plan.makespan * 3 / 4)},
            "plan": {**plan.to_dict(), "task_sha256": None},
        }
        paths = {name: folder / f"{name}_{size}.json" for name in cases}
        for name, path in paths.items():
            path.write_text(json.dumps(cases[name]), encoding="utf-8")
        return cls(**paths, task=Task.model_validate(eventful), at=str(event.at))


@dataclass
class Run:
    """One command, interrupted."""

    arguments: list[str]
    signal: int
    after: float
    folder: Path
    seconds: float = 0.0
    status: int = 0
    output: str = ""
    faults: list[str] = field(default_factory=list)
    ended_before: bool = False

    def carry_out(self) -> None:
        """Runs the command, interrupts it, and looks for processes that it left."""
        token = secrets.token_hex(8)
        scratch = self.folder / "tmp"
        scratch.mkdir()
        environment = {**os.environ, "IRC_INTERRUPTION": token, "TMPDIR": str(scratch)}
        command = [sys.executable, "-m", "irc", *self.arguments]
        with subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment
        ) as process:
            while process.poll() is None and not catches(process.pid):
                time.sleep(0.002)
            try:
                out, errors = process.communicate(timeout=self.after)
                self.ended_before = True
            except subprocess.TimeoutExpired:
                began = time.perf_counter()
                process.send_signal(self.signal)
                out, errors = process.communicate()
                self.seconds = time.perf_counter() - began
        self.status, self.output = process.returncode, out.decode()
        # (It had its answer, and the signal came while it ended.)
        usual = self.status in (0, 1, 3) and '"interrupted": true' not in self.output
        self.ended_before |= usual and self.seconds < 0.5
        if b"Traceback" in errors:
            self.faults.append(f"a traceback: {errors.decode()[-300:]}")
        self.faults += [f"process {pid} is left" for pid in bearers(token)]
        self.faults += [f"{path.name} is left" for path in scratch.iterdir()]

    def judge(self, shop: Shop, allowed: float) -> None:
        """Checks times, status, files and output."""
        if self.ended_before:
            return
        if self.seconds > allowed:
            self.faults.append(f"it took {self.seconds:.2f} s")
        if self.status != 128 + self.signal:
            self.faults.append(f"exit status {self.status}")
        written = self.folder / "written"
        for path in written.rglob("*"):
            if path.is_dir():
                continue
            try:
                text = path.read_text(encoding="utf-8")
                documents = [json.loads(part) for part in _parts(path, text)]
            except ValueError:
                self.faults.append(f"{path.name} is not whole")
                continue
            if path.suffix == ".jsonl":
                self._judge_results(shop, documents)
                continue
            (document,) = documents
            if path.name.startswith("."):
                self.faults.append(f"{path.name} is left")
            if path.name == "out.json" and document != json.loads(OLD):
                self._judge_schedule(shop, document)
        if self.output and self.arguments[0] == "batch":
            self._judge_lines(shop)
        elif self.output:
            self._judge_output(shop)

    def _judge_lines(self, shop: Shop) -> None:
        """The results that a batch printed, one on each line; or why there are none."""
        if not self.answered:
            return
        try:
            self._judge_results(shop, [json.loads(line) for line in self.output.splitlines()])
        except ValueError:
            self.faults.append("a line that it printed is not whole")

    def _judge_results(self, shop: Shop, results: list[dict[str, Any]]) -> None:
        for result in results:
            if "irc_result" in result and result.get("schedule") is not None:
                self._judge_schedule(shop, result["schedule"])

    def _judge_output(self, shop: Shop) -> None:
        try:
            document = json.loads(self.output)
        except ValueError:
            self.faults.append("what it printed is not whole")
            return
        if "irc_simulation" in document:
            for step in document["steps"]:
                self._judge_schedule(shop, step["schedule"])
        elif "irc_step" in document:
            self._judge_schedule(shop, document["schedule"])
        elif "irc_schedule" in document:
            self._judge_schedule(shop, document)

    def _judge_schedule(self, shop: Shop, document: dict[str, Any]) -> None:
        schedule = irc.Schedule.from_dict({**document, "task_sha256": None})
        if schedule.interrupted and schedule.status == "optimal":
            self.faults.append("interrupted, and yet optimal")
        if not schedule.answered or document["task_sha256"] is None:
            return
        revised = irc.apply(shop.task, shop.task.events[0])
        for task in (shop.task, revised):
            if irc.validate(task, schedule, shop.at if task is revised else None).valid:
                return
        self.faults.append("its schedule is not valid")

    @property
    def answered(self) -> bool:
        """Whether it printed anything but that it was interrupted."""
        return bool(self.output) and '"irc_error"' not in self.output[:40]


def _parts(path: Path, text: str) -> list[str]:
    """The documents in a file: one, or one on each line."""
    return text.splitlines() if path.suffix == ".jsonl" else [text]


def catches(pid: int) -> bool:
    """Whether a process has a handler for SIGTERM, and so has begun to be a command of irc."""
    try:
        status = Path(f"/proc/{pid}/status").read_text(encoding="utf-8")
    except OSError:
        return False
    caught = next(line for line in status.splitlines() if line.startswith("SigCgt"))
    return bool(int(caught.split()[1], 16) >> (signal.SIGTERM - 1) & 1)


def bearers(token: str) -> list[int]:
    """The processes that have a token in their environment."""
    found = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                if token.encode() in (entry / "environ").read_bytes():
                    found.append(int(entry.name))
            except OSError:
                continue
    return found


def planned(rng: random.Random, shop: Shop, folder: Path, options: argparse.Namespace) -> Run:
    """A command on a shop that is to be interrupted at a random time."""
    written = folder / "written"
    written.mkdir(parents=True)
    out, steps = written / "out.json", written / "steps"
    out.write_text(OLD, encoding="utf-8")
    command = rng.choice(options.commands)
    limited = ["--time-limit", "30", "--format", "json"]
    target = ["--target", rng.choice(options.targets), "-o", str(out)]
    arguments = {
        "solve": ["solve", str(shop.eventful), *target, *limited],
        "explain": ["explain", str(rng.choice([shop.eventful, shop.impossible])), *limited],
        "simulate": ["simulate", str(shop.eventful), *target, "--steps", str(steps), *limited],
        "replan": [
            *("replan", str(shop.eventful), "--schedule", str(shop.plan), "--at", shop.at),
            *(*target, "--task-output", str(written / "task.json"), *limited),
        ],
        "batch": [
            *("batch", str(shop.eventful), str(shop.impossible), "-t", "cpsat", "-t", "pddl21"),
            *("-o", str(written / "results.jsonl"), "--schedules", "--no-shortcut", *limited),
        ],
    }[command]
    after = rng.uniform(0.0, options.within)
    return Run(arguments, rng.choice(SIGNALS), after, folder)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0] if __doc__ else "")
    parser.add_argument("--times", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--commands", nargs="+", default=COMMANDS, choices=COMMANDS)
    parser.add_argument("--targets", nargs="+", default=["cpsat", "pddl21"])
    parser.add_argument("--actions", type=int, nargs="+", default=[20, 60, 200])
    parser.add_argument("--within", type=float, default=4.0)
    parser.add_argument("--allowed", type=float, default=1.0)
    options = parser.parse_args()
    rng = random.Random(options.seed)
    runs: list[Run] = []
    counts: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as whole:
        shops = [Shop.written(Path(whole), n, options.seed) for n in options.actions]
        while sum(not run.ended_before for run in runs) < options.times:
            shop = rng.choice(shops)
            run = planned(rng, shop, Path(whole, f"run{len(runs)}"), options)
            run.carry_out()
            run.judge(shop, options.allowed)
            runs.append(run)
            if run.ended_before:
                continue
            counts[f"{run.arguments[0]}, {'answered' if run.answered else 'nothing yet'}"] += 1
            if run.faults:
                print(f"run {len(runs) - 1}: {run.arguments[:4]} {run.signal} at {run.after:.2f} s")
                print("   " + "; ".join(run.faults), flush=True)
    seconds = sorted(run.seconds for run in runs if not run.ended_before)
    wrong = sum(bool(run.faults) for run in runs)
    print(f"seed {options.seed}: {len(seconds)} interrupted, {wrong} with a fault")
    load = ", ".join(f"{value:.1f}" for value in os.getloadavg())
    print(f"load of the machine over 1, 5 and 15 minutes: {load} on {os.cpu_count()} processors")
    print(f"seconds: median {seconds[len(seconds) // 2]:.2f}, max {seconds[-1]:.2f}")
    for what, count in sorted(counts.items()):
        print(f"  {what}: {count}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
