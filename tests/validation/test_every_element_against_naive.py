"""Schedules of tasks with every pair of elements, and damaged ones: two validators say the same."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import pytest
from pydantic import ValidationError

from irc.diagnostics import InputError
from irc.driver.solve import solve_task
from irc.model import Task
from irc.schedule import Entry, Schedule
from irc.targets import SolveOptions
from irc.validation import validate
from oracles.combined import document_with, pairs
from oracles.naive_validation import keeps_every_rule

Entries = Sequence[Entry]


def moved(entries: Entries, rng: random.Random) -> list[Entry]:
    """One occurrence at another time."""
    k, by = rng.randrange(len(entries)), rng.choice((-1, 1, 1, 2))
    old = entries[k]
    return [*entries[:k], replace(old, start=old.start + by, end=old.end + by), *entries[k + 1 :]]


def stretched(entries: Entries, rng: random.Random) -> list[Entry]:
    """One occurrence that lasts longer, or less long."""
    k, by = rng.randrange(len(entries)), rng.choice((-1, 1))
    old = entries[k]
    if old.end + by < old.start:
        by = 1
    return [*entries[:k], replace(old, end=old.end + by, paused=0), *entries[k + 1 :]]


def swapped(entries: Entries, rng: random.Random) -> list[Entry]:
    """Two occurrences, each from the other's start on."""
    if len(entries) < 2:
        return list(entries)
    one, two = rng.sample(range(len(entries)), 2)
    found = list(entries)
    for k, other in ((one, two), (two, one)):
        old, at = entries[k], entries[other].start
        found[k] = replace(old, start=at, end=at + old.end - old.start, paused=0)
    return found


def held_elsewhere(entries: Entries, rng: random.Random) -> list[Entry]:
    """One occurrence holds what another one holds, or one unit more than it did."""
    k = rng.randrange(len(entries))
    other = rng.choice(entries).resources
    held = (
        dict(other) if rng.random() < 0.6 else {n: a + 1 for n, a in entries[k].resources.items()}
    )
    return [*entries[:k], replace(entries[k], resources=held), *entries[k + 1 :]]


def left_out(entries: Entries, rng: random.Random) -> list[Entry]:
    """One occurrence less."""
    k = rng.randrange(len(entries))
    return [*entries[:k], *entries[k + 1 :]]


def ranked(entries: Entries, rng: random.Random) -> list[Entry]:
    """Other ranks, some of which are not 0."""
    ends = (None, None, 0, 1, 2)
    return [replace(e, rank=rng.randint(0, 2), end_rank=rng.choice(ends)) for e in entries]


def wrong_task(document: Any, rng: random.Random) -> Any:
    """The task with a family, an amount or a capacity that is another one."""
    uses = [
        u for a in document["actions"] for p in (a, *a.get("modes", ())) for u in p.get("uses", ())
    ]
    named = [use for use in uses if "family" in use]
    kind = rng.choice(("family", "amount", "capacity"))
    if kind == "family" and named:
        use = rng.choice(named)
        use["family"] = rng.choice(["red", "blue", "oak", "elm"])
    elif kind == "amount" and uses:
        use = rng.choice(uses)
        use["amount"] = use.get("amount", 1) + 1
    else:
        able = [r for r in document.get("resources", ()) if r.get("capacity", 1) > 1]
        for resource in able[:1]:
            resource["capacity"] -= 1
    return document


DAMAGE = (moved, moved, stretched, swapped, held_elsewhere, left_out, ranked)


def compare(pair: Sequence[str], seed: int) -> Counter[str]:
    """How both validators judge a schedule of a task and damaged ones; fails where they differ."""
    rng = random.Random(f"damage {pair} {seed}")
    document = document_with(pair, seed)
    seen: Counter[str] = Counter()
    try:
        task = Task.model_validate(document)
        schedule = solve_task(task, SolveOptions("cpsat", time_limit=30.0, workers=1)).schedule
    except (ValidationError, InputError):
        return seen
    if not schedule.answered or not schedule.entries:
        return seen
    cases = [(task, list(schedule.entries))]
    cases += [(task, damage(schedule.entries, rng)) for damage in DAMAGE]
    cases.append((task, swapped(moved(schedule.entries, rng), rng)))
    other = Task.model_validate(wrong_task(document, rng))
    entries = [_with_amounts(other, entry) for entry in schedule.entries]
    cases.append((other, entries))
    for number, (of, listed) in enumerate(cases):
        verdict = validate(of, Schedule(tuple(listed)))
        expected = keeps_every_rule(of, listed)
        assert verdict.valid is expected, f"{pair} {seed}, case {number}: {verdict}\n{listed}"
        seen["valid" if expected else verdict.violations[0].rule] += 1
    return seen


def _with_amounts(task: Task, entry: Entry) -> Entry:
    """The entry with the amounts that its uses have in a task, where no use has a choice."""
    (action,) = (a for a in task.actions if a.id == entry.id)
    mode = next((m for m in action.modes if m.id == entry.mode), None)
    uses = [*action.uses, *(mode.uses if mode else ())]
    if any(len(use.alternatives) > 1 for use in uses):
        return entry
    held: dict[str, int] = {}
    for use in uses:
        held[use.alternatives[0]] = held.get(use.alternatives[0], 0) + use.amount
    return replace(entry, resources=held)


RULES = {
    "orders": "sequence",
    "loads": "load",
    "set-ups": "setup",
    "no idle": "idle",
    "shifts": "calendar",
    "couplings": "coupling",
    "selections": "selection",
}
"""For some elements the rule that damage to a schedule breaks."""


@pytest.mark.slow
@pytest.mark.parametrize("element", RULES)
def test_a_damaged_schedule_is_rejected_by_both_validators_or_by_neither(element: str) -> None:
    seen: Counter[str] = Counter()
    for seed in range(1, 9):
        seen += compare((element,), seed)
    for pair in [p for p in pairs() if element in p][1::11]:
        seen += compare(pair, 1)
    assert seen["valid"] >= 20, seen
    assert seen[RULES[element]] >= 1, seen
