"""The tasks of the conformance suite, with their optima and the rules that they are about."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from irc.model import Task


@dataclass(frozen=True)
class Case:
    """A small task with the makespan of an optimal schedule; None if it has no schedule.

    `rule` is the number of the rule of docs/semantics.md that the case is about: a backend that
    leaves it out gets another answer.
    """

    name: str
    document: dict[str, Any]
    optimum: int | None
    rule: str | None = None

    @property
    def task(self) -> Task:
        """The typed task."""
        return Task.model_validate(self.document)


def _actions(**durations: Any) -> list[dict[str, Any]]:
    return [{"id": name, "duration": duration} for name, duration in durations.items()]


def _on(name: str, duration: int, *uses: Any, **more: Any) -> dict[str, Any]:
    listed = [
        {"one_of": list(use)} if isinstance(use, tuple) else {"resource": use} for use in uses
    ]
    return {"id": name, "duration": duration, "uses": listed, **more}


def _lag(before: str, after: str, **more: Any) -> dict[str, Any]:
    return {"before": before, "after": after, **more}


_BOARD = [{"id": "board", "capacity": 2}]
_OVEN = [{"id": "oven"}]
_ROBOTS = [{"id": "r1"}, {"id": "r2"}]

FIRST_IS_WRONG: dict[str, Any] = {
    "resources": [{"id": "lathe"}, {"id": "mill"}, {"id": "saw"}],
    "actions": [
        _on("a1", 10, "mill"),
        _on("a2", 1, "mill"),
        _on("b1", 11, "saw"),
        _on("b2", 1, "saw"),
        _on("c1", 10, "lathe"),
        _on("c2", 2, "lathe"),
        *_actions(**{"a2 before": 1, "a2 after": 20, "b1 after": 10}),
        *_actions(**{"b2 before": 10, "b2 after": 11, "c1 after": 8, "c2 after": 13}),
    ],
    "precedence": [
        *(["a2 before", "a2"], ["a2", "a2 after"], ["b1", "b1 after"]),
        *(["b2 before", "b2"], ["b2", "b2 after"], ["c1", "c1 after"], ["c2", "c2 after"]),
    ],
}
"""Three machines. The mill must wait for `a2`, which comes late and has a long tail; the saw must
not wait for `b2`; the lathe must begin with `c2`, whose tail is longer. Each rule that people use
for a first order goes wrong at one of them: what can begin begins; by name, in either direction;
the shortest, the longest, the longest tail, the longest rest first.
"""

CONFORMANCE_TASKS: tuple[Case, ...] = (
    Case(
        "one action",
        {"actions": _actions(a=5)},
        5,
        "2.2",
    ),
    Case(
        "a chain",
        {"actions": _actions(a=2, b=3), "precedence": [["a", "b"]]},
        5,
        "3.1",
    ),
    Case(
        "a milestone",
        {"actions": _actions(a=2, m=0, b=3), "precedence": [["a", "m"], ["m", "b"]]},
        5,
        "2.2",
    ),
    Case(
        "a minimum lag",
        {"actions": _actions(a=2, b=3), "precedence": [_lag("a", "b", min_lag=4)]},
        9,
        "3.1",
    ),
    Case(
        "a maximum lag between releases",
        {
            "actions": [*_actions(a=2), {"id": "b", "duration": 3, "release": 10}],
            "precedence": [_lag("a", "b", max_lag=1)],
        },
        13,
        "3.1",
    ),
    Case(
        "a negative lag",
        {"actions": _actions(a=6, b=3), "precedence": [_lag("a", "b", min_lag=-2)]},
        7,
        "3.1",
    ),
    Case(
        "start to start and finish to finish",
        {
            "actions": _actions(a=4, b=2),
            "precedence": [
                _lag("a", "b", type="start-start", min_lag=1),
                _lag("a", "b", type="finish-finish", min_lag=3),
            ],
        },
        7,
        "3.1",
    ),
    Case(
        "starts that coincide",
        {
            "actions": [*_actions(a=4), {"id": "b", "duration": 2, "release": 3}],
            "precedence": [_lag("a", "b", type="start-start", max_lag=0)],
        },
        7,
        "3.1",
    ),
    Case(
        "a release",
        {"actions": [{"id": "a", "duration": 2, "release": 3}]},
        5,
        "2.3",
    ),
    Case(
        "a fixed start",
        {"actions": [{"id": "a", "duration": 2, "start": 4}]},
        6,
        "2.4",
    ),
    Case(
        "a deadline that decides the order",
        {
            "resources": _OVEN,
            "actions": [_on("a", 4, "oven"), _on("b", 3, "oven", deadline=4)],
        },
        7,
        "2.5",
    ),
    Case(
        "a latest start that decides the order",
        {
            "resources": _OVEN,
            "actions": [_on("a", 4, "oven"), _on("b", 3, "oven", latest_start=1)],
        },
        7,
        "2.6",
    ),
    Case(
        "one oven for three",
        {
            "resources": _OVEN,
            "actions": [_on(n, d, "oven") for n, d in (("a", 3), ("b", 4), ("c", 5))],
        },
        12,
        "4.2",
    ),
    Case(
        "freed capacity is taken at the same instant",
        {
            "resources": _OVEN,
            "actions": [_on("a", 3, "oven"), _on("b", 2, "oven")],
            "deadline": 5,
        },
        5,
        "4.2",
    ),
    Case(
        "two at a time",
        {"resources": _BOARD, "actions": [_on(n, 4, "board") for n in "abc"]},
        8,
        "4.2",
    ),
    Case(
        "amounts that fill a resource",
        {
            "resources": [{"id": "power", "capacity": 3}],
            "actions": [
                {"id": "a", "duration": 3, "uses": [{"resource": "power", "amount": 2}]},
                {"id": "b", "duration": 4, "uses": [{"resource": "power", "amount": 2}]},
                {"id": "c", "duration": 7, "uses": [{"resource": "power", "amount": 1}]},
            ],
        },
        7,
        "4.2",
    ),
    Case(
        "one of two robots",
        {"resources": _ROBOTS, "actions": [_on(n, 3, ("r1", "r2")) for n in "abc"]},
        6,
        "4.1",
    ),
    Case(
        "a robot that is also wanted by name",
        {
            "resources": _ROBOTS,
            "actions": [_on("a", 3, ("r1", "r2")), _on("b", 3, "r1"), _on("c", 3, "r1")],
        },
        6,
        "4.2",
    ),
    Case(
        "a duration the solver chooses",
        {
            "actions": [{"id": "a", "duration": {"min": 2, "max": 6}}, *_actions(b=5)],
            "precedence": [_lag("a", "b", type="finish-finish", max_lag=0)],
        },
        5,
        "2.2",
    ),
    Case(
        "a deadline that resources cannot meet",
        {
            "resources": _OVEN,
            "actions": [_on(n, 3, "oven") for n in "ab"],
            "deadline": 5,
        },
        None,
        "2.5",
    ),
    Case(
        "tenths of a second",
        {
            "actions": [{"id": "a", "duration": "0.1 s"}, {"id": "b", "duration": "1900 ms"}],
            "precedence": [["a", "b"]],
        },
        2,
        "2.2",
    ),
    Case(
        "precedences that decide the order",
        {
            "resources": _BOARD,
            "actions": [
                _on(name, duration, "board")
                for name, duration in (("a", 3), ("b", 3), ("c", 2), ("d", 2), ("e", 2))
            ],
            "precedence": [["a", "c"], ["a", "d"], ["a", "e"]],
        },
        7,
        "3.1",
    ),
    Case(
        "a minimum lag that decides the order",
        {
            "resources": _OVEN,
            "actions": [_on("a", 3, "oven"), _on("b", 5, "oven"), *_actions(c=1, d=2)],
            "precedence": [_lag("a", "c", min_lag=9), ["b", "d"]],
        },
        13,
        "3.1",
    ),
    Case(
        "a maximum lag that decides the order",
        {
            "resources": _OVEN,
            "actions": [_on("a", 1, "oven"), _on("b", 1, "oven"), _on("c", 5, "oven")],
            "precedence": [_lag("a", "b", min_lag=2, max_lag=2)],
        },
        9,
        "3.1",
    ),
    Case(
        "a release that decides the order",
        {
            "resources": _OVEN,
            "actions": [
                _on("a", 5, "oven"),
                _on("b", 3, "oven", release=5),
                *_actions(c=2, d=6),
            ],
            "precedence": [["a", "c"], ["b", "d"]],
        },
        14,
        "2.3",
    ),
    Case(
        "a fixed start that decides the order",
        {
            "resources": _OVEN,
            "actions": [_on("a", 4, "oven"), _on("b", 3, "oven", start=2), *_actions(c=5)],
            "precedence": [["a", "c"]],
        },
        14,
        "2.4",
    ),
    Case(
        "an oven for one that decides the order",
        {
            "resources": _OVEN,
            "actions": [_on("a", 6, "oven"), _on("b", 2, "oven"), *_actions(c=7)],
            "precedence": [["b", "c"]],
        },
        9,
        "4.2",
    ),
    Case("the first order is never the best", FIRST_IS_WRONG, 23, "4.2"),
    Case(
        "the first order of the board is never the best",
        {
            "resources": _BOARD,
            "actions": [
                _on(name, duration, "board")
                for name, duration in (("a", 3), ("b", 3), ("c", 2), ("d", 2), ("e", 2))
            ],
        },
        6,
        "4.2",
    ),
    Case(
        "the first robot is never the best",
        {
            "resources": _ROBOTS,
            "actions": [
                _on(name, duration, ("r1", "r2"))
                for name, duration in (("a", 3), ("b", 3), ("c", 2), ("d", 2), ("e", 2))
            ],
        },
        6,
        "4.1",
    ),
)
