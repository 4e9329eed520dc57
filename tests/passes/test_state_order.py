"""State that only says what comes after what becomes precedence; other state stays."""

from __future__ import annotations

import time
from typing import Any

import pytest

from irc.lowering.lower import lower
from irc.model import Task
from irc.passes.state_order import order_from_state
from irc.problem import Problem

Document = dict[str, Any]

FOOD = {"id": "food", "values": ["raw", "cut", "fried"], "initial": "raw"}


def step(name: str, needs: str, gives: str | None, **fields: Any) -> Document:
    var = fields.pop("var", "food")
    effects = [{"at": "end", "var": var, "value": gives}] if gives else []
    condition = {"at": fields.pop("when", "start"), "var": var, "value": needs}
    return {"id": name, "duration": 2, "conditions": [condition], "effects": effects, **fields}


def ordered(*actions: Document, **fields: Any) -> Problem:
    raw = {"state": [FOOD], "actions": list(actions), **fields}
    return order_from_state(lower(Task.model_validate(raw)))


def pairs(problem: Problem) -> set[tuple[str, str]]:
    names = [a.id for a in problem.activities]
    return {(names[a], names[b]) for a, b in problem.state_precedences}


CUT, FRY = step("cut", "raw", "cut"), step("fry", "cut", "fried")
SERVE = step("serve", "fried", None)


def test_changes_that_follow_each_other_become_precedence() -> None:
    problem = ordered(FRY, SERVE, CUT)
    assert problem.variables == ()
    assert pairs(problem) == {("cut", "fry"), ("fry", "serve")}
    assert {(a.before, a.after) for a in problem.arcs} == set(problem.state_precedences)
    assert all(not (a.details.conditions or a.details.effects) for a in problem.activities)


def test_a_goal_that_the_last_change_reaches_is_met() -> None:
    problem = ordered(CUT, FRY, goals=[{"var": "food", "value": "fried"}])
    assert (problem.variables, problem.goals) == ((), ())


MORE_THAN_ORDER: dict[str, tuple[tuple[Document, ...], Document]] = {
    "a goal that a later change undoes": (
        (CUT, FRY),
        {"goals": [{"var": "food", "value": "cut"}]},
    ),
    "a goal that says who must be there": (
        ({**CUT, "occurs": "optional"},),
        {"goals": [{"var": "food", "value": "raw"}]},
    ),
    "a value that two give": ((CUT, step("tear", "raw", "cut")), {}),
    "a value that nothing gives": ((CUT, SERVE), {}),
    "a change that may be absent": (({**CUT, "occurs": "optional"}, FRY), {}),
    "changes by two groups": (
        (CUT, FRY),
        {
            "groups": [
                {"id": "g1", "actions": ["cut"], "required": False},
                {"id": "g2", "actions": ["fry"], "required": False},
            ]
        },
    ),
    "a change that may be repeated": (({**CUT, "occurs": {"min": 1, "max": 2}}, FRY), {}),
    "a change when something starts": (
        ({**CUT, "effects": [{"at": "start", "var": "food", "value": "cut"}]}, FRY),
        {},
    ),
    "a value that is needed only at the end": ((CUT, step("fry", "cut", "fried", when="end")), {}),
    "a reader beside the next change": ((CUT, step("weigh", "raw", None)), {}),
    "an order against the precedence": (
        (CUT, FRY),
        {"precedence": [{"before": "fry", "after": "cut"}]},
    ),
    "precedence with a negative lag": (
        (CUT, FRY),
        {"precedence": [{"before": "cut", "after": "fry", "min_lag": -1}]},
    ),
}


@pytest.mark.parametrize("what", MORE_THAN_ORDER)
def test_state_that_says_more_than_an_order_stays(what: str) -> None:
    actions, fields = MORE_THAN_ORDER[what]
    problem = ordered(*actions, **fields)
    assert [v.id for v in problem.variables] == ["food"]
    assert problem.state_precedences == ()
    assert any(a.details.effects for a in problem.activities)


def test_one_group_chooses_all_of_a_chain_together() -> None:
    group = {"id": "order", "actions": ["cut", "fry"], "required": False}
    assert ordered(CUT, FRY, groups=[group]).variables == ()


def test_of_orders_that_contradict_each_other_the_later_variable_stays() -> None:
    """a before b by x, b before a by y, and z of their own: x and z go, y stays."""
    boolean = [{"id": name} for name in ("x", "y", "z")]
    effects = {
        "a": [{"at": "end", "var": "x", "value": True}],
        "b": [{"at": "end", "var": "y", "value": True}],
    }
    needs = {"a": ["x", False, "y", True], "b": ["x", True, "y", False]}
    actions: list[Document] = [
        {
            "id": name,
            "duration": 1,
            "effects": effects[name],
            "conditions": [
                {"at": "start", "var": var, "value": value}
                for var, value in zip(needs[name][::2], needs[name][1::2], strict=True)
            ],
        }
        for name in ("a", "b")
    ]
    actions += [
        step("c", False, True, var="z"),  # type: ignore[arg-type]
        step("d", True, None, var="z"),  # type: ignore[arg-type]
    ]
    problem = order_from_state(lower(Task.model_validate({"state": boolean, "actions": actions})))
    assert [v.id for v in problem.variables] == ["y"]
    assert pairs(problem) == {("a", "b"), ("c", "d")}
    assert {c.var for a in problem.activities for c in a.details.conditions} == {0}


def chains(size: int, length: int = 4) -> Problem:
    values = [f"s{i}" for i in range(length + 1)]
    return lower(
        Task.model_validate(
            {
                "state": [{"id": f"v{k}", "values": values, "initial": "s0"} for k in range(size)],
                "actions": [
                    step(f"a{k}_{i}", f"s{i}", f"s{i + 1}", var=f"v{k}")
                    for k in range(size)
                    for i in range(length)
                ],
            }
        )
    )


@pytest.mark.slow
def test_a_thousand_variables_take_no_longer_than_their_number_says() -> None:
    problem = chains(1_000)
    began = time.process_time()
    assert order_from_state(problem).variables == ()
    assert time.process_time() - began < 3  # Four times what 250 take would be about 0.3 s.
