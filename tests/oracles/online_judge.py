"""Judges histories of running tasks: what began stays, and what is planned is the best there is.

Knows of `irc.execution` only what it says (steps) and `apply`, which has tests of its own; what is
frozen, what moved, what is worth what, and the best continuation are worked out here and in
`oracles.online_continuation`. The validator is asked as a second, independent opinion.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import irc
from irc.events.apply import apply
from irc.execution.step import Step
from irc.model import Event, Task
from irc.model.events import AddActions, Observe
from irc.model.quantities import Number
from irc.schedule import Entry, Schedule, Status
from oracles.online_continuation import (
    CANCELLED,
    Continuation,
    Frozen,
    NotCompared,
    TooLargeError,
    cancelled,
    continuation,
    frozen,
    values,
)

_TOLD = {
    "minimize_makespan": "makespan",
    "minimize_tardiness": "tardiness",
    "maximize_reward": "reward",
    "minimize_cost": "cost",
}


@dataclass
class Judgement:
    """What was found out about a step. `why_not` says why no optimum was compared."""

    faults: list[str] = field(default_factory=list)
    infeasible: bool = False
    compared: bool = False
    equal: bool = False
    why_not: str | None = None
    worse: str | None = None
    """What is possible, where an answer that is not called optimal is worth less."""
    over: frozenset[str] = frozenset()
    """All actions that have been cancelled, by this step and before."""


def judge_step(
    before: Task,
    old: Schedule,
    step: Step,
    events: Sequence[Event],
    over: frozenset[str] = frozenset(),
    *,
    max_situations: int = 150_000,
) -> Judgement:
    """Judges one repair of `old`, a schedule of `before`, after events of one instant.

    `over` are the actions that earlier steps cancelled.
    """
    at = step.at
    found = Judgement(over=over | cancelled(before, events))
    task = _revised(before, old, events)
    if task != step.task:
        found.faults.append("task: the task in force is not the one that the events make")
    status = step.schedule.status
    if status in (Status.UNKNOWN, Status.FAILED):
        found.faults.append(f"status: no answer, {status}")
        return found
    found.infeasible = status is Status.INFEASIBLE
    try:
        facts = frozen(before, task, old, at, events)
    except NotCompared as error:
        found.why_not = str(error)
        return found
    if not found.infeasible:
        found.faults += _history(facts, step.schedule, at)
        found.faults += _ranks_of_the_past(facts, step.schedule) if task.state else ()
        found.faults += _snapshot(old, facts, step, found.over, at)
        found.faults += _valid(task, old, facts, step, at)
    _compare(found, task, facts, step, _world(before, task, events), max_situations)
    if not found.infeasible:
        found.faults += _needlessly_moved(task, old, facts, step, found.over, at)
    return found


def _revised(task: Task, old: Schedule, events: Sequence[Event]) -> Task:
    starts: dict[str, Number] = {e.id: e.start for e in old.entries if e.occurrence == 1}
    again = {had.repetition for had in task.lapsed}
    # What was observed is written last: it holds whatever the other events of the instant say.
    for event in sorted(events, key=_only_observes):
        task = apply(task, event, starts)
    new = {had.repetition for had in task.lapsed} - again - {None}
    if not new:
        return task
    # It is too late for a repetition to come before what has happened.
    at = max(task.number(event.at) for event in events)
    begun = {e.id for e in old.entries if e.start < at}
    over = {e.id for e in old.entries if e.start < at and e.end <= at}
    kept = [
        p
        for p in task.precedence
        if not (p.before in new and p.after in (over if p.type.endswith("-finish") else begun))
    ]
    return task.model_copy(update={"precedence": tuple(kept)})


def _only_observes(event: Event) -> bool:
    return all(isinstance(change, Observe) for change in event.changes)


def _world(before: Task, task: Task, events: Sequence[Event]) -> list[str]:
    """The actions that stand for changes of the world: they came in, and no event added them."""
    known = {action.id for action in before.actions}
    known |= {
        action.id
        for event in events
        for change in event.changes
        if isinstance(change, AddActions)
        for action in change.actions
    }
    known |= {had.repetition for had in task.lapsed if had.repetition is not None}
    return [action.id for action in task.actions if action.id not in known]


def _history(facts: Sequence[Frozen], schedule: Schedule, at: Number) -> Iterator[str]:
    """What has started is as it was, or as the events say; nothing else is in the past."""
    now = {(e.id, e.occurrence): e for e in schedule.entries}
    for fact in facts:
        entry = now.pop((fact.entry.id, fact.entry.occurrence), None)
        name = fact.entry.id
        if entry is None:
            yield f"history: {name}, which had started, is gone"
        elif _way(entry) != _way(fact.entry):
            yield f"history: {name} had started, and is not as it was: {entry}"
        elif not fact.least <= entry.end <= fact.most:
            yield f"history: {name} ends at {entry.end}, not in [{fact.least}, {fact.most}]"
        elif (entry.status == CANCELLED) != (fact.entry.status == CANCELLED):
            yield f"history: {name} has the status {entry.status}, not {fact.entry.status}"
    for entry in now.values():
        if entry.start < at:
            yield f"past: {entry.id} is planned for {entry.start}, before the event at {at}"
        if entry.status is not None:
            yield f"status: {entry.id} is {entry.status}, and has not started"


def _ranks_of_the_past(facts: Sequence[Frozen], schedule: Schedule) -> Iterator[str]:
    """What is completed has the ranks that it had."""
    now = {(e.id, e.occurrence): e for e in schedule.entries}
    for fact in facts:
        entry = now.get((fact.entry.id, fact.entry.occurrence))
        if entry is None or None in fact.ranks:
            continue
        found = (entry.rank, entry.last_rank)
        if found != fact.ranks:
            yield f"history: {entry.id} had the ranks {fact.ranks}, and has {found}"


def _way(entry: Entry) -> tuple[object, ...]:
    return entry.start, entry.mode, dict(entry.resources)


def _snapshot(
    old: Schedule, facts: Sequence[Frozen], step: Step, over: frozenset[str], at: Number
) -> Iterator[str]:
    """What the step says of the history that it repairs."""
    completed = {f.entry.id for f in facts if f.is_settled and f.least <= at}
    running = {f.entry.id for f in facts if not f.is_settled or f.least > at}
    for what, told, true in (
        ("completed", (*step.completed, *step.stopped), completed),
        ("running", step.running, running),
    ):
        if set(told) != true:
            yield f"snapshot: {what} are {sorted(true)}, and it says {sorted(told)}"
    begun = {(f.entry.id, f.entry.occurrence) for f in facts}
    now = {(e.id, e.occurrence): e for e in step.schedule.entries}
    moved = sum(
        key not in now or _way(now[key]) != _way(entry)
        for entry in old.entries
        if (key := (entry.id, entry.occurrence)) not in begun and entry.id not in over
    )
    if moved != step.moved:
        yield f"moved: {moved} moved, and it says {step.moved}"
    told = next((o.value for o in step.schedule.objective if o.name == "changes"), moved)
    if told != moved:
        yield f"moved: {moved} moved, and the changes are said to be {told}"


def _verdict(task: Task, schedule: Schedule, at: Number) -> list[str]:
    """What the validator has against a schedule, but for what history alone is to blame for."""
    verdict = irc.validate(task, schedule, at=at)
    return [] if verdict.valid else [f"{v.rule}: {v.message}" for v in verdict.violations]


def _valid(
    task: Task, old: Schedule, facts: Sequence[Frozen], step: Step, at: Number
) -> Iterator[str]:
    for message in _verdict(task, step.schedule, at):
        yield f"validator: {message}"
    true = values(task, step.schedule.entries)
    told = {o.name: o.value for o in step.schedule.objective}
    for name in task.objective:
        if name in _TOLD and told.get(_TOLD[name]) != true[name]:
            yield f"objective: {_TOLD[name]} is {true[name]}, and it says {told.get(_TOLD[name])}"


def _compare(
    found: Judgement,
    task: Task,
    facts: Sequence[Frozen],
    step: Step,
    world: Sequence[str],
    max_situations: int,
) -> None:
    """Against the exact continuation, where that can be had."""
    try:
        exact = continuation(task, facts, step.at, found.over, world, max_situations=max_situations)
    except NotCompared as error:
        found.why_not = str(error)
        return
    except TooLargeError:
        found.why_not = "too large"
        return
    found.compared = True
    before = len(found.faults)
    if step.left_out:
        if exact.best is not None:
            found.faults.append(
                f"compare: {step.left_out} left out, and {_shown(exact)} is possible"
            )
    elif exact.best is None:
        if not found.infeasible:
            found.faults.append("compare: an answer, and brute force proves that there is none")
    elif found.infeasible:
        found.faults.append(f"compare: called infeasible, and {_shown(exact)} is possible")
    else:
        found.faults += _compared(found, task, exact, step)
    found.equal = len(found.faults) == before and found.worse is None


def _compared(
    found: Judgement,
    task: Task,
    exact: Continuation,
    step: Step,
) -> Iterator[str]:
    assert exact.best is not None
    true = values(task, step.schedule.entries)
    reached = tuple(true[name] for name in exact.objective)
    if len(step.abandoned) != exact.abandoned:
        yield f"abandoned: {[*step.abandoned]}, where {exact.abandoned} would do"
        return
    if reached == exact.best.vector or task.objective[0] == "minimize_changes":
        return
    signs = [-1 if name == "maximize_reward" else 1 for name in exact.objective]
    better = [s * v for s, v in zip(signs, reached, strict=True)] < [
        s * v for s, v in zip(signs, exact.best.vector, strict=True)
    ]
    if better:
        yield f"compare: {reached}, and only {_shown(exact)} is possible"
    elif step.schedule.status is Status.OPTIMAL:
        yield f"compare: {reached} (called optimal), and {_shown(exact)} is optimal"
    else:
        found.worse = f"{reached}, and {_shown(exact)} is optimal"


def _shown(exact: Continuation) -> str:
    if exact.best is None:
        return "nothing"
    plan = ", ".join(f"{e.id} {e.start}–{e.end}" for e in exact.best.schedule.entries)
    return f"{exact.best.vector} for {exact.objective} [{plan}]"


def _needlessly_moved(
    task: Task,
    old: Schedule,
    facts: Sequence[Frozen],
    step: Step,
    over: frozenset[str],
    at: Number,
) -> Iterator[str]:
    """Where the old plan is still valid and as good, nothing moves in what is called optimal."""
    if (
        step.schedule.status is not Status.OPTIMAL
        or not step.moved
        or step.abandoned
        or step.left_out
        or any(not f.is_settled for f in facts)
    ):
        return
    begun = {(f.entry.id, f.entry.occurrence) for f in facts}
    kept = [e for e in old.entries if (e.id, e.occurrence) not in begun and e.id not in over]
    if any(e.start < at for e in kept):
        return
    same = Schedule((*(f.entry for f in facts), *kept))
    cut = [n for n in task.objective if n != "minimize_changes"]
    if _order(values(task, same.entries), cut) > _order(values(task, step.schedule.entries), cut):
        return
    if not _verdict(task, same, at):
        yield f"stability: {step.moved} moved, and the old plan is still valid and as good"


def _order(worth: Mapping[str, Number], objective: Sequence[str]) -> tuple[Number, ...]:
    return tuple(-worth[n] if n == "maximize_reward" else worth[n] for n in objective)
