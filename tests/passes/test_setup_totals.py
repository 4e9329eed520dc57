"""Lower bounds on the set-ups of a schedule together, by hand and against brute force."""

from __future__ import annotations

import random
from typing import Any

import irc
from irc.lowering.lower import lower
from irc.model import Task
from irc.passes import run_passes, setup_totals
from irc.passes.setup_totals import SETUP_OBJECTIVES, least_setups
from oracles.setups import best, random_task

Document = dict[str, Any]


def least(document: Document, name: str = "setup_time") -> int:
    return least_setups(run_passes(lower(Task.model_validate(document))), name)


def row(before: str, after: str, time: int, cost: int = 0) -> Document:
    return {"from": before, "to": after, "time": time, "cost": cost}


def use(family: str, *machines: str) -> Document:
    chosen = {"one_of": [*machines]} if len(machines) > 1 else {"resource": machines[0]}
    return {**chosen, "family": family}


def shop(*families: str, rows: list[Document], **more: Any) -> Document:
    actions = [
        {"id": f"a{k}", "duration": 2, "uses": [use(f, "m")]} for k, f in enumerate(families)
    ]
    return {"resources": [{"id": "m", "setups": {"times": rows}}], "actions": actions, **more}


def test_uses_of_one_family_count_one_by_one() -> None:
    rows = [row("x", "x", 2), row("y", "y", 3), row("*", "*", 9, 1)]
    assert least(shop("x", "x", "y", "y", "x", rows=rows)) == 2 + 2 + 3 + 9


def test_time_and_cost_have_bounds_of_their_own() -> None:
    rows = [row("x", "y", 1, 8), row("y", "x", 6, 3)]
    document = shop("x", "y", rows=rows)
    assert [least(document, name) for name in SETUP_OBJECTIVES] == [1, 3]


def test_precedence_rules_orders_out() -> None:
    rows = [row("x", "y", 1), row("y", "x", 6)]
    document = shop("x", "y", "x", rows=rows)
    assert least(document) == 1
    arcs = [["a1", "a0"], ["a0", "a2"]]
    assert least({**document, "precedence": arcs}) == 6


def test_a_use_that_may_be_absent_may_lie_between_two_others() -> None:
    rows = [row("x", "y", 7), row("y", "x", 7), row("*", "z", 1), row("z", "*", 2)]
    document = shop("x", "y", rows=rows)
    assert least(document) == 7
    document["actions"].append(
        {"id": "z", "duration": 1, "occurs": "optional", "uses": [use("z", "m")]}
    )
    assert least(document) == 3


def test_uses_that_choose_their_machine_are_entered_on_one_of_them() -> None:
    rows = [row("*", "*", 4), row("x", "x", 3)]
    machines = [{"id": name, "setups": {"times": rows}} for name in "mn"]
    actions = [{"id": str(k), "duration": 2, "uses": [use("x", "m", "n")]} for k in range(5)]
    assert least({"resources": machines, "actions": actions}) == 3 * (5 - 2)


def test_with_too_many_states_each_use_has_its_least_entry(monkeypatch: Any) -> None:
    monkeypatch.setattr(setup_totals, "MOST_STATES", 1)
    rows = [row("*", "x", 2), row("*", "y", 5), row("y", "y", 1)]
    assert least(shop("x", "y", "y", rows=rows)) == 2 + (5 + 1) - 5


def test_no_schedule_of_random_tasks_has_less() -> None:
    exact = judged = 0
    for seed in range(24):
        document = random_task(random.Random(seed))
        name = SETUP_OBJECTIVES[seed % 2]
        document["objective"] = [f"minimize_{name}"]
        wanted = best(document) if irc.check(document).ok else None
        if wanted is not None:
            found = least(document, name)
            assert found <= wanted[0], seed
            judged += 1
            exact += found == wanted[0]
    assert judged > 15
    assert exact > 0.8 * judged
