"""The strategy of whole tasks draws every field of the IR."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import seed as starting_at

from irc.model import Task, details, events, parts
from irc.model.base import Node
from irc.model.details import ChoiceMade, CoupledAction, Coupling, Selection, UseOrder
from irc.model.parts import ObjectiveTerm
from oracles.generators import tasks

whole_ir = settings(
    deadline=None,
    database=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)


def test_tasks_reach_every_field_of_the_ir() -> None:
    reached: set[str] = set()

    def note(part: Any) -> None:
        if isinstance(part, Node):
            reached.update(f"{type(part).__name__}.{key}" for key in part.model_fields_set)
            for key in part.model_fields_set:
                note(getattr(part, key))
        elif isinstance(part, tuple):
            for item in part:
                note(item)

    every = {f"{kind.__name__}.{key}" for kind in nodes() for key in kind.model_fields}
    assert every > NOT_DRAWN
    every -= NOT_DRAWN
    short = settings(whole_ir, derandomize=False, max_examples=40)
    # Several short runs see more kinds of tasks than a long one, which varies what it has seen.
    for start in range(30):
        starting_at(start)(short(given(tasks())(note)))()
        if reached == every:
            return
    pytest.fail(f"never reached: {sorted(every - reached)}")


NOT_DRAWN = {
    *("Task.couplings", "Task.select", "Task.sequences"),
    *(f"ObjectiveTerm.{f}" for f in ObjectiveTerm.model_fields),
    "ObjectiveSum.sum",
    *(
        f"{k.__name__}.{f}"
        for k in (ChoiceMade, CoupledAction, Coupling, Selection, UseOrder)
        for f in k.model_fields
    ),
}
"""Fields that the strategy of whole tasks does not draw yet: EVERYTHING has them. One entry of
`WHOLE_FEATURES` in `oracles.generators` draws those of an element."""


def nodes() -> Iterable[type[Node]]:
    declared = [*vars(parts).values(), *vars(details).values(), *vars(events).values(), Task]
    return (kind for kind in declared if isinstance(kind, type) and issubclass(kind, Node))
