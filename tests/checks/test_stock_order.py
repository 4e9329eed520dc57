"""What stock alone rules out, and that nothing possible is ruled out."""

from __future__ import annotations

import random
from typing import Any

import pytest

import irc
from irc.checks.stock_order import impossible_stock
from irc.lowering.lower import lower
from irc.model import Task
from oracles.state_brute_force import optimum

Document = dict[str, Any]


def swap(name: str, takes: str, gives: str, **fields: Any) -> Document:
    consumes, produces = [{"resource": takes}], [{"resource": gives}]
    return {"id": name, "duration": 0, "consumes": consumes, "produces": produces, **fields}


def stores(*names: str, **fields: Any) -> list[Document]:
    return [{"id": name, "kind": "reservoir", **fields} for name in names]


def task_of(resources: list[Document], *actions: Document) -> Task:
    return Task.model_validate({"resources": resources, "actions": list(actions)})


BUY, SELL = swap("buy", "coins", "tokens"), swap("sell", "tokens", "coins")


@pytest.mark.parametrize("target", ["cpsat", "pddl21"])
def test_two_swaps_that_could_only_pay_each_other_are_infeasible(target: str) -> None:
    task = task_of(stores("coins", "tokens"), BUY, SELL)
    assert irc.check(task).ok
    schedule = irc.solve(task, target=target, time_limit=10)
    assert (schedule.status, schedule.engine) == ("infeasible", "stock-order")


def test_the_reason_names_who_waits_and_for_what() -> None:
    found = impossible_stock(lower(task_of(stores("coins", "tokens"), BUY, SELL)))
    assert found is not None
    assert found.message == (
        "stock lets no order of 'buy', 'sell' happen: 'buy' takes 1 of 'coins', which can never "
        "have enough before"
    )
    assert found.pointer == ("actions", 0)


def test_room_can_be_missing_as_well() -> None:
    full = stores("left", "right", initial=1, max=1)
    over = [swap("to right", "left", "right"), swap("to left", "right", "left")]
    found = impossible_stock(lower(task_of(full, *over)))
    assert found is not None
    assert found.message.endswith("'to left' puts 1 into 'left', which can never have room before")
    roomy = stores("left", "right", initial=1, max=2)
    assert impossible_stock(lower(task_of(roomy, *over))) is None


def test_one_coin_to_begin_with_is_enough_for_a_circle() -> None:
    ring = [swap("a", "x", "y"), swap("b", "y", "z"), swap("c", "z", "x")]
    resources = stores("x", "y", "z")
    assert impossible_stock(lower(task_of(resources, *ring))) is not None
    resources[1]["initial"] = 1
    assert impossible_stock(lower(task_of(resources, *ring))) is None


def test_what_need_not_happen_is_no_contradiction() -> None:
    optional = [{**BUY, "occurs": "optional"}, {**SELL, "occurs": "optional"}]
    assert impossible_stock(lower(task_of(stores("coins", "tokens"), *optional))) is None
    wanted = task_of(stores("coins", "tokens"), *optional).model_copy(update={"goals": ("buy",)})
    assert impossible_stock(lower(wanted)) is not None


def random_stock(seed: int) -> Task:
    rng = random.Random(f"stock {seed}")
    resources = [
        {"id": name, "kind": "reservoir", "initial": rng.randint(0, 1), "max": rng.randint(1, 3)}
        for name in "xy"
    ]
    actions = []
    for name in "abcd"[: rng.randint(2, 4)]:
        low = rng.choice([0, 0, 1])
        duration: Any = {"min": low, "max": low + 1} if rng.random() < 0.2 else low
        action: Document = {"id": name, "duration": duration}
        for kind in ("consumes", "produces"):
            if rng.random() < 0.7:
                change = {"resource": rng.choice("xy"), "amount": rng.choice([1, 1, 2])}
                if rng.random() < 0.4:
                    change["at"] = rng.choice(["start", "end"])
                action[kind] = [change]
        if rng.random() < 0.2:
            action["occurs"] = rng.choice(["optional", {"min": 0, "max": 2}])
        actions.append(action)
    return Task.model_validate({"resources": resources, "actions": actions})


@pytest.mark.slow
def test_nothing_that_brute_force_finds_possible_is_ruled_out() -> None:
    found = beyond_check = 0
    for seed in range(400):
        task = random_stock(seed)
        if impossible_stock(lower(task)) is not None:
            found += 1
            beyond_check += irc.check(task).ok
            assert optimum(task) is None, seed
    assert found > 100
    assert beyond_check > 5
