"""Exact optima of small state tasks, from the meaning of a valid schedule (docs/semantics.md).

Known here: all of the IR but events, `minimize_changes`, and occurrences without a maximum, of
which at most `most_occurrences` are tried. Optimal means: over all starts, ends, ranks, modes,
durations, resources and selections, in whole ticks (docs/semantics.md: the largest unit that
divides every time of the task).

**Method.** The selections (how often each action occurs) are tried one after another, those that
promise most first. A selection fixes reward and cost. For each, all schedules are walked through
in the order of time, tick by tick and all at once: a *situation* says of each occurrence whether
it waits, runs until when, or is over, and of the world its values and stocks. Within a tick,
`state_instant` lists the orders of what happens. Situations that agree in all that can matter from
then on are one (the one with the least tardiness so far).

**Ranks.** A situation carries what is demanded of the ranks that can still matter: of running
occurrences (a fixed duration gives the end the rank of the start) and of ends of precedences whose
other end is to come. Demands that contradict each other end a walk; others can be kept, because
ranks are only compared.

**It ends, without a horizon.** After the last release, fixed start and calendar boundary nothing
depends on the hour but deadlines and due dates, for which earlier is never worse. So from then on
a situation that was there before, at an earlier tick and with no more tardiness, is dropped. Seen
relative to the hour, situations are finitely many.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from types import MappingProxyType

from irc.model import Task
from irc.model.quantities import Number
from irc.schedule import Schedule
from oracles.mode_elements import has_mode_elements, tasks_by_choice
from oracles.state_relaxation import Windows, promises, relaxed_windows
from oracles.state_task import Plain, read
from oracles.state_walk import Past, TooLargeError, Walk, Worth

__all__ = ["Optimum", "Past", "TooLargeError", "optimum"]

_NAMES = MappingProxyType(
    {
        "minimize_makespan": "makespan",
        "minimize_tardiness": "tardiness",
        "maximize_reward": "reward",
        "minimize_cost": "cost",
    }
)


@dataclass(frozen=True)
class Optimum:
    """The best values of the objectives, in the task's order and unit, and a schedule with them.

    `values` maps makespan, tardiness, reward, cost to what this schedule has; only those that the
    task names are optimal. The schedule's entries give their ranks.
    """

    vector: tuple[Number, ...]
    values: Mapping[str, Number]
    schedule: Schedule


def optimum(
    task: Task,
    most_occurrences: int = 3,
    max_situations: int = 1_000_000,
    past: Past | None = None,
) -> Optimum | None:
    """The lexicographic optimum over all valid schedules of `task`; None if there is none.

    With a `past`, of those that an execution can have come to.
    Raises `ValueError` for what this oracle does not know, `TooLargeError` where it would have to
    look at more than `max_situations`.
    """
    if has_mode_elements(task):
        answers = [
            optimum(one, most_occurrences, max_situations, past) for one in tasks_by_choice(task)
        ]
        found = [answer for answer in answers if answer is not None]
        return min(found, key=lambda answer: _rank(task, answer), default=None)
    plain = read(task)
    best: Walk | None = None
    incumbent: tuple[int, ...] | None = None
    room = max_situations
    for bound, counts, windows in sorted(_selections(plain, most_occurrences), key=lambda s: s[:2]):
        if incumbent is not None and bound >= incumbent:
            break
        walk = Walk(plain, counts, windows, incumbent, room, past)
        walk.run()
        room -= walk.visited
        if walk.best is not None:
            best, incumbent = walk, walk.best.vector
    return None if best is None or best.best is None else _optimum(plain, best)


def _rank(task: Task, answer: Optimum) -> tuple[Number, ...]:
    """The worth of an answer, less is better."""
    return tuple(
        -value if name == "maximize_reward" else value
        for name, value in zip(task.objective, answer.vector, strict=True)
    )


def _selections(
    plain: Plain, most_occurrences: int
) -> Iterator[tuple[tuple[int, ...], tuple[int, ...], Windows]]:
    """Each legal selection with its windows and a bound on its worth, but for hopeless ones."""
    ranges = [
        range((max(job.least, most_occurrences) if job.most is None else job.most) + 1)
        for job in plain.jobs
    ]
    for counts in product(*ranges):
        if plain.is_selection(counts) and promises(plain, counts):
            windows = relaxed_windows(plain, counts)
            if windows is not None:
                worth = Worth(plain, counts)
                yield worth.vector(windows.makespan, windows.tardiness), counts, windows


def _optimum(plain: Plain, walk: Walk) -> Optimum:
    final = walk.best
    assert final is not None
    values: dict[str, Number] = {
        "makespan": plain.time(final.makespan),
        "tardiness": plain.time(walk.tardiness),
        "reward": plain.reward(walk.counts),
        "cost": plain.cost(walk.counts),
    }
    vector = tuple(values[_NAMES[name]] for name in plain.objective)
    return Optimum(vector, MappingProxyType(values), walk.schedule())
