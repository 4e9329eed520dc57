"""Releases, deadlines, limits of starts and ends in PDDL: timed initial literals."""

from __future__ import annotations

from irc.problem import IMPOSSIBLE_DEADLINE
from irc_pddl21.encoding.builder import Builder
from irc_pddl21.encoding.pddl import TimedLiteral


def add_time_windows(builder: Builder) -> None:
    """Adds the window of every activity; activities with the same time share a fact."""
    opened: dict[int, str] = {}
    closed: dict[int, str] = {}
    for i, activity in enumerate(builder.problem.activities):
        release = max(activity.release, activity.start or 0)
        if release:
            builder.require(2 * i, _released(builder, release, opened))
        if activity.earliest_end:
            builder.require(2 * i + 1, _released(builder, activity.earliest_end, opened))
        for latest in dict.fromkeys((activity.start, activity.latest_start)):
            if latest is not None:
                builder.require(2 * i, _open_until(builder, latest, closed))
        deadline = builder.problem.effective_deadline(i)
        if deadline is not None:
            builder.deadline_facts[i] = _open_until(builder, deadline, closed)


def _released(builder: Builder, release: int, opened: dict[int, str]) -> str:
    if release not in opened:
        opened[release] = builder.fact(f"released_{release}")
        time = release * builder.scale.units_per_tick
        builder.encoding.timed.append(TimedLiteral(time, opened[release], True))
    return opened[release]


def _open_until(builder: Builder, time: int, closed: dict[int, str]) -> str:
    time = max(time, IMPOSSIBLE_DEADLINE)
    if time == IMPOSSIBLE_DEADLINE and time not in closed:
        closed[time] = builder.fact("open_never")  # Literals cannot come before the beginning.
    if time not in closed:
        closed[time] = builder.fact(f"open_{time}", initially=True)
        end = time * builder.scale.units_per_tick + builder.scale.slack
        builder.encoding.timed.append(TimedLiteral(end, closed[time], False))
    return closed[time]
