"""Calendars in PDDL: a fact for each unit that is away at times, and timed initial literals."""

from __future__ import annotations

from irc.problem import ContendedPool
from irc_pddl21.encoding.builder import Builder


def add_calendar(
    builder: Builder, pool: ContendedPool, tokens: list[str], prefix: str = "here_"
) -> dict[str, str]:
    """The fact that says the unit is there, for each token whose unit is not always there.

    The k-th unit is there while the capacity is at least k; units gone together share a fact. It
    goes a slack late: an action may end when its unit goes.
    """
    steps = list(pool.levels())
    here: dict[str, str] = {}
    facts: dict[tuple[bool, ...], str] = {}
    for k, token in enumerate(tokens, start=1):
        there = tuple(capacity >= k for _, capacity in steps)
        if all(there):
            continue
        if there not in facts:
            facts[there] = builder.fact(
                builder.names.new(prefix + token.removeprefix("free_")), initially=there[0]
            )
            times = [time for time, _ in steps]
            _add_literals(builder, facts[there], times, there)
        here[token] = facts[there]
    return here


def _add_literals(builder: Builder, fact: str, times: list[int], there: tuple[bool, ...]) -> None:
    scale = builder.scale
    for n in range(1, len(times)):
        if there[n] != there[n - 1]:
            time = times[n] * scale.units_per_tick + (0 if there[n] else scale.slack)
            builder.switch(fact, time, there[n])
