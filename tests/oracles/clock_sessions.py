"""Random running tasks with times as clocks and computations give them, and much worse.

The law: whatever is accepted can be planned with. A time may be refused as it comes in, but no
replanning may fail for a time that was accepted.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from typing import Any

import irc
from irc.diagnostics import InputError
from irc.execution import Execution
from irc.model import Event, Task

Document = dict[str, Any]

_HUGE_AND_TINY = (1e18, 1e-15, 1e12, 1e30, 1764531552.4832478)


def raw_time(rng: random.Random, least: float, most: float) -> Any:
    """A time mostly between two: a raw double, a ratio, a text, now and then a monster."""
    kind = rng.random()
    if kind < 0.5:
        return rng.uniform(least, most)
    if kind < 0.6:
        return round(rng.uniform(least, most), rng.randint(0, 9))
    if kind < 0.7:
        return f"{rng.randint(1, 1000)}/{rng.randint(1, 1000)}"
    if kind < 0.78:
        return f"{rng.uniform(least, most)} ms"
    return rng.choice(_HUGE_AND_TINY) if kind < 0.8 else rng.randint(int(least), int(most) + 1)


def faults_of_session(seed: int, target: str, seconds: float = 5.0) -> Iterator[str]:
    """The replannings of one session that fail, or whose schedule is not valid."""
    rng = random.Random(f"clock {seed}")
    run = _begun(rng, target, seconds)
    for k in range(6 if run is not None else 0):
        assert run is not None
        span = min(max(1.0, float(run.schedule.makespan)), 1e6)
        at = float(run.now) + rng.uniform(0, span / 4)
        event = {"at": at, "changes": [_change(rng, run.task, at, k)]}
        try:
            if rng.random() < 0.2:
                run.advance(at)
            run.apply(Event.model_validate(event))
        except (InputError, ValueError):  # Refused as it came in, also for its shape.
            continue
        step = run.replan()
        if step.schedule.answered:
            verdict = irc.validate(step.task, step.schedule, at=step.at)
            if not verdict.valid:
                yield f"{event}: {verdict}"


def _begun(rng: random.Random, target: str, seconds: float) -> Execution | None:
    size = rng.randint(2, 5)
    lengths = [rng.choice([raw_time(rng, 0.5, 4), rng.randint(1, 4)]) for _ in range(size)]
    document: Document = {
        "time_unit": rng.choice(["s", "min", "h", "ms"]),
        "resources": [{"id": "r1"}, {"id": "r2"}],
        "actions": [
            {"id": f"a{i}", "duration": d, "uses": [{"one_of": ["r1", "r2"]}]}
            for i, d in enumerate(lengths)
        ],
        "precedence": [["a0", "a1"]],
    }
    if rng.random() < 0.3:
        document["resolution"] = rng.choice(["1 ms", "0.1 s", "1 us"])
    task = Task.model_validate(document)
    try:
        schedule = irc.solve(task, target=target, time_limit=seconds)
    except InputError:  # Too short for its resolution, or a monster.
        return None
    if not schedule.answered:
        return None
    return Execution(task, schedule, target=target, time_limit=seconds)


def _change(rng: random.Random, task: Task, at: float, k: int) -> Document:
    name = rng.choice([action.id for action in task.actions])
    new = {"id": f"n{k}", "duration": raw_time(rng, 0.1, 3), "uses": [{"resource": "r1"}]}
    changes: list[Document] = [
        {"op": "observe", "action": name, "started": max(0, at - rng.random())},
        {"op": "observe", "action": name, "status": rng.choice(["running", "failed", "finished"])},
        {"op": "set_duration", "action": name, "duration": raw_time(rng, 0.5, 4)},
        {"op": "set_capacity", "resource": "r1", "capacity": 0, "to": at + rng.uniform(0, 3)},
        {"op": "add_actions", "actions": [{**new, "release": raw_time(rng, 0, 5)}]},
        {"op": "set_deadline", "deadline": raw_time(rng, 10, 30), "action": name},
        {"op": "set_release", "action": name, "release": raw_time(rng, 0, 9)},
        {"op": "retry_action", "action": name},
    ]
    return rng.choice(changes)
