"""Random sessions of an executive that reports late, out of order, wrongly and again.

`play` carries out a small random task: plans, observations of all sorts, capacities and states
that change. Each step is judged by what was observed, worked out here in another way than in
`irc.execution`, and by the validator: what counts of the observations stands in the schedule,
nothing is planned for the past, and nothing that is only presumed contradicts what is known.
"""

from __future__ import annotations

import random
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import irc
from irc.diagnostics import InputError
from irc.execution import Execution
from irc.execution.step import Step
from irc.model import Event, Task
from irc.model.quantities import Number, exact
from irc.model.times import json_number
from irc.model.world_changes import is_world_change
from irc.schedule import Entry
from irc.targets import EngineFailed, SolveOptions
from oracles.online_presumed import not_begun
from oracles.online_random import online_task

Key = tuple[str, int]

SPARE = 1.0
"""Seconds that a step may take beyond its limit, on a busy machine."""


@dataclass(frozen=True)
class Told:
    """One observation that was accepted: the time it is of, its number, and the change."""

    at: Number
    number: int
    change: dict[str, Any]


@dataclass
class Session:
    """What came of a session."""

    steps: int = 0
    accepted: int = 0
    refused: int = 0
    corrected: int = 0
    unanswered: int = 0
    left_out: int = 0
    slowest: float = 0.0
    faults: list[str] = field(default_factory=list)


def play(seed: int, options: SolveOptions, rounds: int = 6) -> Session:
    """Plays one session and judges each of its steps."""
    rng = random.Random(f"reality {seed}")
    found = Session()
    task = online_task(rng)
    try:
        plan = irc.solve(task, options=options)
    except InputError:
        return found
    if not plan.answered:
        return found
    presume = rng.choice(("assume", "confirm"))
    execution = Execution(task, plan, presume=presume, options=options)  # type: ignore[arg-type]
    told: dict[Key, list[Told]] = {}
    changed: set[str] = set()
    number = 0
    for _ in range(rounds):
        execution.advance(exact(execution.now + rng.choice((0, 1, 1, 2, Fraction(1, 2)))))
        for _ in range(rng.randint(1, 3)):
            number += 1
            _send(rng, execution, number, told, changed, found)
        if rng.random() < 0.8:
            _step(execution, told, changed, found, seed)
    return found


def presumptions(seed: int, options: SolveOptions, tries: int = 12) -> Iterator[str]:
    """What is wrong with the facts after random observations of one random plan, again and again.

    Nothing is planned anew, so this is quick.
    """
    rng = random.Random(f"presumed {seed}")
    task = online_task(rng)
    if not irc.check(task).ok or not (plan := irc.solve(task, options=options)).answered:
        return
    for _ in range(tries):
        execution = Execution(task, plan, options=options)
        execution.advance(exact(Fraction(plan.makespan) * rng.randint(1, 8) / 6))
        told: dict[Key, list[Told]] = {}
        for number in range(1, rng.randint(2, 4)):
            at = execution.now
            raw, key = _observation(rng, execution, at)
            try:
                execution.apply(Event.model_validate({"at": json_number(at), "changes": [raw]}))
            except InputError:
                continue
            told.setdefault(key, []).append(Told(at, number, raw))
            for fault in _presumption(execution, told):
                yield f"seed {seed} at {at}: {fault} after {told}"


def _send(
    rng: random.Random,
    execution: Execution,
    number: int,
    told: dict[Key, list[Told]],
    changed: set[str],
    found: Session,
) -> None:
    before, at = execution.copy(), execution.now
    if rng.random() < 0.12:
        raw = _change(rng, execution.task)
        key = None
    else:
        if rng.random() < 0.3:
            at = exact(at - min(at, rng.choice((1, 2))))
        raw, key = _observation(rng, execution, at)
    event = Event.model_validate({"at": json_number(at), "changes": [raw]})
    try:
        report = execution.apply(event)
    except InputError as error:
        found.refused += 1
        if execution != before:
            found.faults.append(f"refused, and not as before: {error}")
        return
    found.accepted += 1
    if key is None:
        changed.add(str(raw.get("resource", raw.get("var"))))
    else:
        found.corrected += any(d.code.id == "IRC712" for d in report)
        told.setdefault(key, []).append(Told(at, number, raw))


def _change(rng: random.Random, task: Task) -> dict[str, Any]:
    renewable = [r for r in task.resources if r.kind == "renewable"]
    if task.state and (not renewable or rng.random() < 0.5):
        variable = rng.choice(task.state)
        return {"op": "set_state", "var": variable.id, "value": rng.choice(variable.values)}
    if not renewable:
        return {"op": "set_objective", "objective": ["minimize_makespan"]}
    resource = rng.choice(renewable)
    capacity = rng.choice((0, 1, resource.capacity))
    return {"op": "set_capacity", "resource": resource.id, "capacity": capacity}


def _observation(
    rng: random.Random, execution: Execution, at: Number
) -> tuple[dict[str, Any], Key]:
    task = execution.task
    entries = [e for e in execution.schedule.entries if e.status is None] or [Entry("nobody", 0, 1)]
    likely = [e for e in entries if e.start <= at + 1]
    entry = rng.choice(likely if likely and rng.random() < 0.9 else entries)
    raw: dict[str, Any] = {"op": "observe", "action": entry.id}
    if entry.occurrence != 1:
        raw["occurrence"] = entry.occurrence
    kind = rng.choice(("started", "finished", "running", "not_begun", "failed", "way", "both"))

    def past(near: Number) -> Any:
        return json_number(exact(max(0, near + rng.choice((-2, -1, 0, 0, 0, 1, 2)))))

    if kind in ("started", "both") or rng.random() < 0.3:
        raw["started"] = past(min(entry.start, at))
    if kind in ("finished", "both"):
        raw["finished"] = past(min(entry.end, at))
    if kind in ("running", "not_begun", "failed"):
        raw["status"] = kind
    if kind == "running" and rng.random() < 0.5:
        raw["expected_end"] = json_number(exact(at + rng.randint(1, 4)))
    if kind == "not_begun":
        raw.pop("started", None)
    if kind == "way":
        action = next((a for a in task.actions if a.id == entry.id), None)
        uses = action.uses if action is not None else ()
        raw["resources"] = [rng.choice(u.alternatives) for u in uses][:1]
        if action is not None and action.modes:
            raw["mode"] = rng.choice(action.modes).id
    return raw, (entry.id, entry.occurrence)


def _step(
    execution: Execution,
    told: dict[Key, list[Told]],
    changed: set[str],
    found: Session,
    seed: int,
) -> None:
    limit = execution.options.time_limit or 0
    found.faults += [f"seed {seed} at {execution.now}: {f}" for f in _presumption(execution, told)]
    began = time.perf_counter()
    try:
        step = execution.replan()
    except (EngineFailed, InputError) as error:
        found.faults.append(f"seed {seed} at {execution.now}: {type(error).__name__}: {error}")
        return
    took = time.perf_counter() - began
    found.steps += 1
    found.slowest = max(found.slowest, took)
    if took > limit * 1.1 + SPARE:
        found.faults.append(f"limit: {took:.1f} s, where {limit} s were allowed")
    if not step.schedule.answered:
        found.unanswered += 1
        return
    found.left_out += bool(step.left_out)
    assumes = execution._history.assumes
    found.faults += [
        f"seed {seed} at {step.at}: {fault}" for fault in judged(step, told, changed, assumes)
    ]


# --- the judge ------------------------------------------------------------------------------------


def _presumption(execution: Execution, told: dict[Key, list[Told]]) -> Iterator[str]:
    """Whether what is presumed has begun, and nothing else, since the last plan.

    Asked where only observations have come in since then: what another event finds begun stays so.
    """
    history = execution._history
    only_seen = all(c.op == "observe" for event in execution.pending for c in event.changes)
    if not history.assumes or history.held is not None or not only_seen:
        return
    task, now, plan = execution.unobserved, execution.now, execution._schedule
    facts = {key: _known(task, observations) for key, observations in told.items()}
    taken = {(e.id, e.occurrence): e for e in execution.schedule.entries}
    known = {key: taken[key] for key, its in facts.items() if "begun" in its and key in taken}
    due = {(e.id, e.occurrence): e.start for e in plan.entries if e.start < now}
    waits = {k: its["waited"] for k, its in facts.items() if "waited" in its and k not in known}
    if any(due.get(key) == time for key, time in waits.items()):
        return  # Whether it was planned then, or before, the plan does not say.
    waiting = {key for key, time in waits.items() if due.get(key, time) < time}
    begun = due.keys() - not_begun(task, plan, now, known, waiting) - waiting | known.keys()
    state = {(e.id, e.occurrence) for e in execution.state().frozen}
    world = {a.id for a in task.actions if is_world_change(a, task.clock)}
    for key in sorted(begun ^ state):
        if key[0] not in world:
            yield f"presumed: {key} is taken {'' if key in state else 'not '}to have begun"


def judged(
    step: Step, told: dict[Key, list[Told]], changed: set[str], assumes: bool
) -> Iterator[str]:
    """What is wrong with a step, by all that was observed."""
    task, now = step.task, step.at
    entries = {(e.id, e.occurrence): e for e in step.schedule.entries}
    known = {key: _known(task, observations) for key, observations in told.items()}
    for key, facts in known.items():
        yield from _contradictions(key, entries.get(key), facts, now)
    world = {a.id for a in task.actions if is_world_change(a, task.clock)}
    going = set(step.completed) | set(step.running)
    for key, entry in entries.items():
        begun = entry.id in going and entry.start <= now
        if entry.start < now and not begun and entry.id not in world:
            yield f"past: {key} is planned for {entry.start}"
        facts = known.get(key, {})
        if not assumes and begun and entry.start < now and entry.id not in world:
            if "begun" not in facts:
                yield f"confirm: {key} has begun, and nobody has observed it"
            elif entry.end <= now and entry.end > entry.start and "ended" not in facts:
                yield f"confirm: {key} has ended at {entry.end}, and nobody has observed it"
    verdict = irc.validate(task, step.schedule, at=now)
    if not verdict.valid:
        yield f"validator: {[v.message for v in verdict.violations]}"
    observed = {key[0] for key, facts in known.items() if facts}
    for violation in verdict.carried:
        if violation.rule in ("precedence", "capacity", "release") and not (
            observed & set(violation.actions)
            or any(repr(name) in violation.message for name in changed)
        ):
            yield f"presumed, and impossible: {violation.message}"
    yield from _presumed_starts(task, entries, observed, going, now)


def _presumed_starts(
    task: Task, entries: dict[Key, Entry], observed: set[str], going: set[str], now: Number
) -> Iterator[str]:
    """Nothing that is only presumed begins before its predecessors are through."""
    for edge in task.precedence:
        before, after = entries.get((edge.before, 1)), entries.get((edge.after, 1))
        if after is None or edge.after in observed or after.id not in going or after.start >= now:
            continue
        if before is None or edge.type not in ("finish-start", "start-start"):
            continue
        if before.status == "cancelled" or after.status == "cancelled":
            continue
        point = before.end if edge.type == "finish-start" else before.start
        if after.start < point + task.number(edge.min_lag):
            yield f"presumed: {after.id} at {after.start}, but {before.id} is {before}"


def _known(task: Task, observations: list[Told]) -> dict[str, Any]:
    """What counts of the observations of one occurrence: latest first, what contradicts is not so.

    A window in which it may have started (`earliest`, `latest`), and one for its end.
    """
    known: dict[str, Any] = {}

    def number(value: Any) -> Number:
        from irc.model.times import parse_instant

        return task.number(parse_instant(value))

    for one in sorted(observations, key=lambda o: (o.at, o.number), reverse=True):
        change, status = one.change, one.change.get("status")
        if "finished" in change or status in ("finished", "failed"):
            end = number(change["finished"]) if "finished" in change else one.at
            _take_end(known, end, status == "failed")
        elif status == "running" or "expected_end" in change:
            expected = number(change["expected_end"]) if "expected_end" in change else None
            _take_running(known, one.at, expected)
        if status == "not_begun":
            _take_waiting(known, one.at)
        if "started" in change:
            _take_start(known, number(change["started"]))
        if change.get("mode") or change.get("resources"):
            known.setdefault("mode", change.get("mode"))
            known.setdefault("resources", change.get("resources"))
            known.setdefault("begun", True)
    if known.get("mode") is None:
        known.pop("mode", None)
    if not known.get("resources"):
        known.pop("resources", None)
    return known


def _take_end(known: dict[str, Any], end: Number, failed: bool) -> None:
    late = ("seen" in known and end <= known["seen"]) or end < known.get("started", end)
    if not late and "ended" not in known and not _waits_after(known, end):
        known.update(ended=end, failed=failed, begun=True)


def _take_running(known: dict[str, Any], at: Number, expected: Number | None) -> None:
    if "ended" in known and known["ended"] < at:
        return
    if at < known.get("started", at) or _waits_after(known, at) or "seen" in known:
        return
    known.update(seen=at, begun=True)
    if expected is not None:
        known["expected"] = expected


def _take_start(known: dict[str, Any], start: Number) -> None:
    after = known.get("ended", known.get("seen", start))
    if "started" not in known and start <= after and not _waits_after(known, start):
        known.update(started=start, begun=True)


def _take_waiting(known: dict[str, Any], at: Number) -> None:
    begun = [known[name] for name in ("started", "ended", "seen") if name in known]
    if any(moment < at for moment in begun):
        return
    known["waited"] = max(at, known.get("waited", at))


def _waits_after(known: dict[str, Any], moment: Number) -> bool:
    """Whether it was observed later that it had not begun by then."""
    return "waited" in known and moment <= known["waited"]


def _contradictions(
    key: Key, entry: Entry | None, facts: dict[str, Any], now: Number
) -> Iterator[str]:
    if "begun" not in facts:
        if entry is not None and "waited" in facts and entry.start < facts["waited"]:
            yield f"not begun at {facts['waited']}: {entry}"
        return
    if entry is None:
        yield f"gone: {key}, which has begun: {facts}"
        return
    if "started" in facts and entry.start != facts["started"]:
        yield f"started at {facts['started']}: {entry}"
    if "ended" in facts:
        if entry.end != facts["ended"] or (entry.status == "cancelled") != facts["failed"]:
            yield f"ended at {facts['ended']} (failed: {facts['failed']}): {entry}"
    elif "seen" in facts:
        if entry.end < facts["seen"] or (facts["seen"] == now and entry.end <= now):
            yield f"still running at {facts['seen']}: {entry}"
        if facts.get("expected", now) > now and entry.end != facts["expected"]:
            yield f"expected to end at {facts['expected']}: {entry}"
    if "mode" in facts and entry.mode != facts["mode"]:
        yield f"done as {facts['mode']}: {entry}"
    for name in facts.get("resources", ()):
        if name not in entry.resources and entry.start < entry.end:
            yield f"done by {name}: {entry}"
