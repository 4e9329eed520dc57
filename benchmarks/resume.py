"""Times how long `irc run` takes to stand where a journal of 3,999 requests ends.

For each kind of request a session gets 3,999 of them, as `irc run` does it, one short of the next
snapshot. Its journal is then opened and resumed in a process of its own. Counted is what comes
between the start of reading the journal and the first answer, as time and as processor time;
loading Python's modules and reading the task is not.

    python benchmarks/resume.py [--actions 200] [--requests 3999]
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import irc
from irc.execution import Execution
from irc.schedule import Schedule
from irc.service.journal import Journal
from irc.service.session import Session
from irc.targets import SolveOptions

OPTIONS = SolveOptions(time_limit=5.0, workers=1)
RESOURCES = 10

KINDS: dict[str, Callable[[int, int], dict[str, Any]]] = {
    "advance": lambda k, n: {"do": "advance", "to": f"{k}/1000"},
    "observe": lambda k, n: {"do": "observe", "action": f"a{k % RESOURCES}", "started": 0},
    "change durations": lambda k, n: {
        "do": "apply",
        "event": {
            "changes": [{"op": "set_duration", "action": f"a{k % n}", "duration": 4 + k % 3}]
        },
    },
    "add an action": lambda k, n: {
        "do": "apply",
        "event": {
            "changes": [{"op": "add_actions", "actions": [{"id": f"new {k}", "duration": 3}]}]
        },
    },
}


def document(actions: int) -> dict[str, Any]:
    """A task in which all actions of a resource wait for each other."""
    return {
        "name": "a long run",
        "resources": [{"id": f"r{k}"} for k in range(RESOURCES)],
        "actions": [
            {"id": f"a{k}", "duration": 5, "uses": [{"resource": f"r{k % RESOURCES}"}]}
            for k in range(actions)
        ],
    }


def execution(schedule: Schedule, actions: int) -> Execution:
    """The execution at its start."""
    return Execution(irc.Task.from_dict(document(actions)).ir, schedule, options=OPTIONS)


def write(path: Path, kind: str, actions: int, requests: int) -> None:
    """Tells a session all requests of a kind."""
    made = KINDS[kind]
    first = irc.solve(document(actions), options=OPTIONS)
    journal, _ = Journal.open(path)
    with journal:
        session = Session.start(execution(first, actions), journal)
        for k in range(requests):
            answer = session.answer(json.dumps({**made(k, actions), "id": k}).encode())
            if not answer.document["ok"]:
                raise SystemExit(f"{kind}: {answer.line()}")
            session.save()


def resume(path: Path, actions: int) -> None:
    """Prints the seconds from opening the journal to the first answer."""
    task = irc.Task.from_dict(document(actions)).ir
    json.dumps(Session.start(execution(irc.Schedule(()), actions)).greeting())
    begin, used = time.perf_counter(), time.process_time()
    journal, found = Journal.open(path)
    with journal:
        if found is None:
            raise SystemExit("the journal is empty")
        session = Session.resume(lambda s: execution(s, actions), task, journal, found)
        greeting = json.dumps(session.greeting())
    seconds, used = time.perf_counter() - begin, time.process_time() - used
    print(f"{seconds:.3f} {used:.3f} {session.recovered} {len(greeting)}")


def main() -> None:
    """Prints a line for each kind of request."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--actions", type=int, default=200)
    parser.add_argument("--requests", type=int, default=3999)
    parser.add_argument("--kind", choices=KINDS, action="append")
    parser.add_argument("--resume", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.resume is not None:
        resume(options.resume, options.actions)
        return
    for kind in options.kind or KINDS:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "run.journal"
            write(path, kind, options.actions, options.requests)
            command = [sys.executable, __file__, "--actions", str(options.actions)]
            again = [*command, "--resume", str(path)]
            done = subprocess.run(again, capture_output=True, text=True, check=True)
            seconds, used, recovered, _ = done.stdout.split()
            size = path.stat().st_size / 2**20
            print(
                f"{kind}: {recovered} requests, {size:.1f} MiB, {seconds} s, {used} s CPU",
                flush=True,
            )


if __name__ == "__main__":
    main()
