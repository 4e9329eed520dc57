"""Facts of one occurrence: which count is decided in one pass, as by comparing them in pairs."""

from __future__ import annotations

import random
import time

from irc.execution.observations import (
    ENDED,
    FAILED,
    NOT_BEGUN,
    RUNNING,
    STARTED,
    Fact,
    Observed,
    contradicts,
    with_fact,
)


def in_pairs(facts: tuple[Fact, ...]) -> list[Fact]:
    """The facts that no later one which counts contradicts, the latest first."""
    found: list[Fact] = []
    for fact in reversed(facts):
        if not any(contradicts(fact, later) for later in found):
            found.append(fact)
    return found


def a_fact(r: random.Random, number: int) -> Fact:
    """A random fact, observed after those with smaller numbers."""
    what = r.choice(["", NOT_BEGUN, STARTED, RUNNING, ENDED, FAILED])
    if what:
        return Fact(number // 2, number, what, r.randrange(4))
    resources = r.choice([(), ("x",), ("y", "x"), ("x", "y")])
    return Fact(number // 2, number, mode=r.choice([None, "a", "b"]), resources=resources)


def test_those_that_count_are_those_that_pairs_leave():
    r = random.Random(1)
    for _ in range(4000):
        facts = tuple(a_fact(r, number) for number in range(r.randrange(1, 9)))
        assert Observed(facts).counting == in_pairs(facts), facts


def test_the_same_report_at_every_tick_takes_little_time_each():
    known = Observed()
    begin = time.process_time()
    for tick in range(400):
        known, corrected, by = with_fact(known, Fact(tick, tick, STARTED, 0))
        assert not corrected
        assert by is None
    assert time.process_time() - begin < 10
    assert known.started == 0
