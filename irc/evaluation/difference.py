"""Where two tasks differ: actions, durations, goals, and what must come before what."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from irc.evaluation.closure import closure
from irc.model import Task

Pair = tuple[str, str]


@dataclass(frozen=True)
class Difference:
    """The elements that one task has and the other has not.

    Order is compared by what must come before what, all edges taken together, so that an edge
    that follows from others is no difference. `reversed_order` are the edges of the first task
    that the second one turns round.
    """

    only_first: tuple[str, ...]
    only_second: tuple[str, ...]
    durations: tuple[tuple[str, Any, Any], ...]
    goals_only_first: tuple[str, ...]
    goals_only_second: tuple[str, ...]
    order_only_first: tuple[Pair, ...]
    order_only_second: tuple[Pair, ...]
    reversed_order: tuple[Pair, ...]
    all_reversed: bool

    @property
    def same(self) -> bool:
        """Whether nothing differs."""
        found = self.as_json()
        return not any(found.values())

    def as_json(self) -> dict[str, Any]:
        """The difference as a JSON object."""
        return {
            "actions": {"only_first": self.only_first, "only_second": self.only_second}
            if self.only_first or self.only_second
            else {},
            "durations": [
                {"action": name, "first": a, "second": b} for name, a, b in self.durations
            ],
            "goals": {"only_first": self.goals_only_first, "only_second": self.goals_only_second}
            if self.goals_only_first or self.goals_only_second
            else {},
            "order_only_first": self.order_only_first,
            "order_only_second": self.order_only_second,
            "reversed": self.reversed_order,
            "all_reversed": self.all_reversed,
        }

    def lines(self) -> Iterable[str]:
        """The difference in words, one line each."""
        yield from (f"only in the first: action {name!r}" for name in self.only_first)
        yield from (f"only in the second: action {name!r}" for name in self.only_second)
        yield from (f"duration of {name!r}: {a} and {b}" for name, a, b in self.durations)
        yield from (f"only in the first: goal {goal}" for goal in self.goals_only_first)
        yield from (f"only in the second: goal {goal}" for goal in self.goals_only_second)
        if self.all_reversed:
            yield "every edge is reversed"
        yield from (f"reversed: {a!r} before {b!r}" for a, b in self.reversed_order)
        yield from (f"only in the first: {a!r} before {b!r}" for a, b in self.order_only_first)
        yield from (f"only in the second: {a!r} before {b!r}" for a, b in self.order_only_second)


def difference(first: Task, second: Task) -> Difference:
    """Where two tasks differ. Edges count where they bind a start to an end, whatever the lag."""
    one, other = _durations(first), _durations(second)
    number = {name: k for k, name in enumerate(dict.fromkeys([*one, *other]))}
    here, there = _edges(first, number), _edges(second, number)
    before, after = closure(here), closure(there)
    turned = {(a, b) for a, b in here if (b, a) in after and (a, b) not in after}
    turning = {(b, a) for a, b in turned}
    names = list(number)

    def pairs(edges: Iterable[tuple[int, int]]) -> tuple[Pair, ...]:
        return tuple((names[a], names[b]) for a, b in sorted(edges))

    goals, other_goals = _goals(first), _goals(second)
    return Difference(
        tuple(name for name in one if name not in other),
        tuple(name for name in other if name not in one),
        tuple((n, one[n], other[n]) for n in one if n in other and one[n] != other[n]),
        tuple(goal for goal in goals if goal not in other_goals),
        tuple(goal for goal in other_goals if goal not in goals),
        pairs(edge for edge in here if edge not in after and edge not in turned),
        pairs(edge for edge in there if edge not in before and edge not in turning),
        pairs(turned),
        bool(here) and there == {(b, a) for a, b in here},
    )


def _durations(task: Task) -> dict[str, str]:
    return {action.id: str(action.duration) for action in task.actions}


def _edges(task: Task, number: dict[str, int]) -> set[tuple[int, int]]:
    return {
        (number[edge.before], number[edge.after])
        for edge in task.precedence
        if edge.type == "finish-start" and edge.before in number and edge.after in number
    }


def _goals(task: Task) -> list[str]:
    return [goal if isinstance(goal, str) else str(goal) for goal in task.goals]
