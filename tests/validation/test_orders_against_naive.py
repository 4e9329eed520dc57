"""Rules 4.5 and 4.6 on random schedules: the validator finds what the brute force finds."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Iterator, Mapping
from itertools import islice

import pytest

from irc.model import Task
from irc.schedule import Entry, Schedule
from irc.validation import validate
from oracles.small_generators import batch_task, sequence_task
from oracles.small_tasks import Choice, Document, Placement, choices


def _schedules(
    document: Document, rng: random.Random, *, apart: bool
) -> Iterator[tuple[Mapping[str, Choice], dict[str, int]]]:
    """Random choices with random starts; `apart`: one action after another."""
    known = list(islice(choices(document), 40))
    for chosen in rng.sample(known, min(4, len(known))):
        names = list(chosen)
        rng.shuffle(names)
        starts: dict[str, int] = {}
        at = 0
        for name in names:
            starts[name] = at if apart else rng.choice((0, 0, 1, 2))
            at += chosen[name].duration + rng.choice((0, 0, 1))
        yield chosen, starts


def _entry(name: str, choice: Choice, start: int) -> Entry:
    held: Counter[str] = Counter()
    for _, resource, amount in choice.held:
        held[resource] += amount
    return Entry(name, start, start + choice.duration, mode=choice.mode, resources=dict(held))


@pytest.mark.parametrize("kind", ["sequence", "load"])
def test_the_validator_finds_what_the_brute_force_finds(kind: str) -> None:
    seen: Counter[bool] = Counter()
    for seed in range(60):
        rng = random.Random(seed)
        document = sequence_task(seed) if kind == "sequence" else batch_task(seed)
        task = Task.model_validate(document)
        for chosen, starts in _schedules(document, rng, apart=kind == "sequence"):
            placement = Placement(document, chosen, None)
            placement.prepare()
            orders, loads = placement.holds(starts)
            entries = tuple(_entry(n, chosen[n], start) for n, start in starts.items())
            verdict = validate(task, Schedule(entries))
            found = any(v.rule == kind for v in verdict.violations)
            assert found != (orders if kind == "sequence" else loads), (seed, starts, str(verdict))
            seen[found] += 1
    assert min(seen[True], seen[False]) >= 20, seen
