"""The number of occurrences that stock allows."""

from __future__ import annotations

from typing import Any

import pytest

from builders import problem_of, task_of
from irc import solve
from irc.passes.stock_occurrences import bounded_by_stock, most_by_stock
from irc.schedule import Status
from irc.targets import SolveOptions

FLOUR = {"id": "flour", "kind": "reservoir", "initial": 5}
BREAD = {"id": "bread", "kind": "reservoir"}


def repeated(name: str, least: int = 0, most: int | None = None, **fields: Any) -> dict[str, Any]:
    occurs = {"min": least} if most is None else {"min": least, "max": most}
    return {"id": name, "duration": 1, "occurs": occurs, **fields}


def takes(amount: int, what: str = "flour") -> dict[str, Any]:
    return {"consumes": [{"resource": what, "amount": amount}]}


def brings(amount: int, what: str = "flour") -> dict[str, Any]:
    return {"produces": [{"resource": what, "amount": amount}]}


BAKES = {**takes(2), **brings(3, "bread")}
BORROWS = {**takes(1), **brings(1)}


@pytest.mark.parametrize(
    ("resources", "actions", "limits"),
    [
        ([FLOUR], [repeated("sell", **takes(2))], {"sell": 2}),
        ([{**FLOUR, "min": 2}], [repeated("sell", **takes(1))], {"sell": 3}),
        ([{**FLOUR, "max": 9}], [repeated("mill", **brings(2))], {"mill": 2}),
        ([FLOUR], [repeated("mill", **brings(2))], {}),
        ([FLOUR], [repeated("sell", **BORROWS)], {}),
        ([FLOUR], [repeated("sell", most=1_000, **takes(1))], {"sell": 5}),
        ([FLOUR], [repeated("sell", most=3, **takes(1))], {"sell": 3}),
        ([FLOUR, BREAD], [repeated("bake", **BAKES), repeated("sell", **takes(1, "bread"))],
         {"bake": 2, "sell": 6}),
        ([FLOUR], [repeated("sell", **takes(2)), repeated("mill", **brings(1))], {}),
        ([FLOUR], [repeated("sell", **takes(2)), {"id": "mill", "duration": 1, **brings(4)}],
         {"sell": 4}),
        ([FLOUR], [{"id": "sell", "occurs": {"min": 0}, "modes": [
            {"id": "by hand", "duration": 2, **takes(2)}, {"id": "fast", "duration": 1, **takes(1)}
        ]}], {"sell": 5}),
    ],
)  # fmt: skip
def test_as_often_as_the_scarcest_stock_allows(
    resources: list[dict[str, Any]], actions: list[dict[str, Any]], limits: dict[str, int]
) -> None:
    problem = problem_of(*actions, resources=resources)
    found = most_by_stock(problem)
    assert {problem.activities[i].id: most for i, most in found.items()} == limits


def test_what_must_occur_more_often_than_stock_allows_stays_required() -> None:
    problem = bounded_by_stock(problem_of(repeated("sell", 3, **takes(2)), resources=[FLOUR]))
    assert problem.activities[0].details.repeats == (3, 3)


@pytest.mark.parametrize(
    ("task", "value"),
    [
        (task_of(repeated("sell", reward=3, **takes(1)), resources=[FLOUR],
                 objective=["maximize_reward"]), 15),
        (task_of(repeated("mill", reward=3, **brings(2)), resources=[{**FLOUR, "max": 9}],
                 objective=["maximize_reward"]), 6),
        (task_of(repeated("bake", **BAKES), repeated("sell", reward=2, **takes(1, "bread")),
                 resources=[FLOUR, BREAD], objective=["maximize_reward"]), 12),
    ],
)  # fmt: skip
def test_what_only_stock_limits_is_planned_to_the_last_occurrence(task: Any, value: int) -> None:
    schedule = solve(task, options=SolveOptions(time_limit=20, workers=1))
    assert (schedule.status, schedule.objective[0].value) == (Status.OPTIMAL, value)


def test_the_search_goes_deeper_while_an_answer_uses_all_that_its_model_holds() -> None:
    """More than a model can hold: the answer is not proven, and has more than one."""
    much = {**FLOUR, "initial": 1_000_000}
    task = task_of(
        repeated("sell", reward=1, **takes(1)), resources=[much], objective=["maximize_reward"]
    )
    schedule = solve(task, options=SolveOptions(time_limit=20, workers=1))
    assert (schedule.status, schedule.objective[0].value) == (Status.FEASIBLE, 64)
