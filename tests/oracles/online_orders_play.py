"""Plays executions about orders: what happens is drawn for the plan of that time, and judged."""

from __future__ import annotations

import json
import random
import time
from collections.abc import Iterator
from copy import deepcopy
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import irc
from irc.execution import Execution
from irc.model import Event, Task
from irc.targets import SolveOptions
from oracles.online_orders import next_event, orders_task
from oracles.online_orders_judge import Judgement, judge
from oracles.online_orders_kitchen import Kitchen, plan_of

Document = dict[str, Any]

OPTIONS = SolveOptions(time_limit=20, workers=1)


@dataclass(frozen=True)
class Played:
    """A step of an execution, and what is to be said of it. `task` is as it was at first."""

    task: Document
    events: list[Document]
    before: Document
    step: Document
    judged: Judgement
    seconds: float

    @property
    def event(self) -> Document:
        """The one that this step is about."""
        return self.events[-1]

    def document(self) -> Document:
        """All of it, to be written down."""
        return {
            "task": {**self.task, "events": self.events},
            "before": self.before,
            "step": self.step,
            "faults": self.judged.faults,
        }


def play(seed: int, options: SolveOptions = OPTIONS) -> Iterator[Played]:
    """An execution with one to four events; ends early where a step has no answer.

    Raises what the solver and the replanner raise.
    """
    rng = random.Random(f"orders {seed}")
    document = orders_task(rng)
    task = Task.model_validate(deepcopy(document))
    kitchen = Kitchen.of(deepcopy(document))
    first = irc.solve(task, options=options)
    if not first.answered:
        return
    execution = Execution(task, first, options=options)
    before = _json(first.to_dict())
    events: list[Document] = []
    at = Fraction(0)
    for number in range(1, 1 + rng.randint(1, 4)):
        old = plan_of(before)
        event = next_event(rng, kitchen, old, at, number)
        if event is None:
            return
        events.append(event)
        at = Fraction(event["at"])
        begun, new = kitchen.take(deepcopy(event), old)
        began = time.perf_counter()
        execution.apply(Event.model_validate(deepcopy(event)))
        step = _json(execution.replan().to_dict())
        seconds = time.perf_counter() - began
        still = {name: run for name, run in old.items() if name not in kitchen.over}
        judged = judge(kitchen, begun, still, new, at, step)
        yield Played(document, list(events), before, step, judged, seconds)
        if not judged.answered or judged.faults:
            return
        before = step["schedule"]


def _json(document: Document) -> Document:
    """The same with exact numbers."""
    read: Document = json.loads(json.dumps(document), parse_float=Fraction)
    return read
