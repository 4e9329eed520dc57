"""Executions of tasks with every pair of elements: each step against trying every continuation.

A task is carried out by a schedule of it, often not its best one, until a time at which some event
may come that the history can bear: another deadline or release, one more action. What the step says
must be the best of all that continues the history; where the oracle finds that too hard, two
validators and a look at the history judge it.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from typing import Any

from pydantic import ValidationError

import irc
from irc.diagnostics import InputError
from irc.execution.step import Step
from irc.model import Event, Task
from irc.schedule import Entry, Schedule, Status
from irc.targets import EngineFailed
from irc.validation import validate
from oracles.combined import document_with
from oracles.exhaustive import Judge, Past, Placed, TooHardError, World, best_of, fits

_TRIES = 300


def some_schedule(task: Task, rng: random.Random) -> Schedule | None:
    """Some valid schedule with early starts, drawn at random; None if none is found.

    Of a task in which ranks count it is one of irc, which gives ranks.
    """
    if task.state or any(r.kind == "reservoir" for r in task.resources):
        found = irc.solve(task, workers=1)
        return found if found.answered and found.entries else None
    try:
        world = World(task, 50_000)
        choices = list(world.choices())
        for _ in range(_TRIES if choices else 0):
            placed: list[Placed] = []
            for way, number in rng.choice(choices):
                spans = [
                    span
                    for span in world.places(way, number)
                    if fits(world, Placed(way, number, *span), placed)
                ]
                if not spans:
                    break
                placed.append(Placed(way, number, *rng.choice(spans[:4])))
            else:
                if placed and Judge(world, placed).accepts():
                    return Schedule(tuple(_entry(world, p) for p in placed))
    except (TooHardError, ValueError):
        return None
    return None


def _entry(world: World, placed: Placed) -> Entry:
    mode, times = placed.way.mode, [t * world.tick for t in (placed.start, placed.end)]
    start, end = (int(t) if t.denominator == 1 else t for t in times)
    return Entry(placed.name, start, end, placed.way.holds, mode and mode.id, placed.number)


def some_change(task: Task, rng: random.Random, at: int) -> list[dict[str, Any]]:
    """A change that the history can bear, or none."""
    kind = rng.choice(("none", "deadline", "release", "new", "new"))
    if kind == "deadline":
        return [{"op": "set_deadline", "deadline": at + rng.randint(1, 8)}]
    if kind == "release":
        action = rng.choice(task.actions).id
        return [{"op": "set_release", "action": action, "release": at + rng.randint(1, 3)}]
    if kind == "new":
        new: dict[str, Any] = {"id": "new", "duration": rng.randint(0, 3)}
        held = [r for r in task.resources if r.kind != "reservoir"]
        if held:
            new["uses"] = [{"resource": rng.choice(held).id}]
        return [{"op": "add_actions", "actions": [new]}]
    return []


def judged_step(pair: Sequence[str], seed: int, target: str = "cpsat", seconds: float = 20) -> str:
    """In a few words how a step of an execution was; it begins with "wrong" or "crash" if it is."""
    rng = random.Random(f"online {pair} {seed}")
    try:
        task = Task.model_validate(document_with(pair, seed))
    except ValidationError:
        return "not judged: no task"
    if not irc.check(task).ok:
        return "not judged: no task"
    plan = some_schedule(task, rng)
    if plan is None or not validate(task, plan).valid:
        return "not judged: no schedule" if plan is None else "not judged: the validator differs"
    at = rng.randint(1, max(1, int(plan.makespan)))
    changes = some_change(task, rng, at)
    events = [Event.model_validate({"at": at, "changes": changes})] if changes else []
    try:
        step = irc.replan(task, plan, at, events, target=target, time_limit=seconds, workers=1)
    except InputError as refusal:
        return f"refused by {', '.join(sorted({d.code.id for d in refusal.report.errors}))}"
    except (EngineFailed, ArithmeticError, LookupError, AssertionError) as error:
        return f"crash: {type(error).__name__}: {error}"
    return _judged(task, plan, step, at)


def _judged(task: Task, plan: Schedule, step: Step, at: int) -> str:
    begun = [e for e in plan.entries if e.start < at]
    found = step.schedule
    if found.answered:
        kept = {(e.id, e.occurrence): e for e in found.entries}
        for entry in begun:
            now = kept.get((entry.id, entry.occurrence))
            if now is None or not _same(entry, now, at):
                return f"wrong: the history of {entry.id!r} is another one"
        if not validate(step.task, found, at=at).valid:
            return f"wrong: not valid: {validate(step.task, found, at=at)}"
    try:
        best = best_of(step.task, past=Past(at, begun))
    except TooHardError:
        return f"{found.status}, too hard for the oracle"
    except ValueError:
        return "not judged by the oracle"
    if not found.answered:
        return "infeasible" if best is None else f"wrong: {found.status}, where {best} is possible"
    values = [o.value for o in found.objective][: len(task.objective)]
    odd = step.left_out or step.notes or any(e.status not in (None, "begun") for e in found.entries)
    if best is None:
        return "goes on without something" if odd else "wrong: no continuation is valid"
    if found.status is Status.OPTIMAL and values != list(best):
        return f"wrong: {values} instead of {list(best)}"
    return str(found.status)


def _same(before: Entry, now: Entry, at: int) -> bool:
    same = (before.start, before.mode) == (now.start, now.mode)
    ended = before.end == now.end if before.end <= at else now.end >= at
    return same and ended and dict(before.resources) == dict(now.resources)
