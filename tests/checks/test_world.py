"""What state, stock and occurrences rule out, and that nothing possible is called impossible."""

from __future__ import annotations

import time
from typing import Any

import pytest

import irc
from builders import Document, act, at, task_of
from irc.frontends.dsl.task import dsl_task
from irc.model import Task


def stock(initial: int, **fields: Any) -> Document:
    return {"id": "egg", "kind": "reservoir", "initial": initial, **fields}


def eggs(amount: int, **fields: Any) -> list[Document]:
    return [{"resource": "egg", "amount": amount, **fields}]


def told(*actions: Document, **fields: Any) -> list[str]:
    """The messages of all errors."""
    task = task_of(*actions, **fields)
    return [d.message for d in irc.check(task).located().errors]


LIT, WARM = {"id": "lit"}, {"id": "warm"}
LIGHT = act("light", effects=[at("end", "lit")])

# --- values out of reach ------------------------------------------------------------------------


def test_what_nobody_gives_is_told_once_for_all_that_need_it() -> None:
    needs = [at("start", "lit")]
    (message,) = told(*(act(f"a{k}", conditions=needs) for k in range(5)), state=[LIT])
    assert message.startswith(
        "action 'a0' needs 'lit' to be true at its start (4 more actions need it too"
    )


def test_what_only_follows_from_a_fault_told_is_not_told_again() -> None:
    messages = told(
        act("light", conditions=[at("start", "gas")], effects=[at("end", "lit")]),
        act("see", conditions=[at("start", "lit")], effects=[at("end", "warm")]),
        state=[{"id": "gas"}, LIT, WARM],
        goals=[{"var": "warm"}, {"var": "lit"}],
    )
    assert len(messages) == 1
    assert messages[0].startswith("action 'light' needs 'gas'")


def test_a_circle_is_told_once_and_as_one() -> None:
    (message,) = told(
        act("a", conditions=[at("start", "lit")], effects=[at("end", "warm")]),
        act("b", conditions=[at("start", "warm")], effects=[at("end", "lit")]),
        state=[LIT, WARM],
    )
    assert message.endswith("and so on in a cycle")


def test_two_circles_are_told_both() -> None:
    pairs = [("a", "b"), ("c", "d")]
    messages = told(
        *(
            act(f"{one}{two}", conditions=[at("start", one)], effects=[at("end", two)])
            for pair in pairs
            for one, two in (pair, pair[::-1])
        ),
        state=[{"id": name} for pair in pairs for name in pair],
    )
    assert len(messages) == 2


def test_an_optional_action_that_can_never_occur_is_named_as_the_reason() -> None:
    (message,) = told(
        act(
            "light",
            occurs="optional",
            conditions=[at("all", "gas")],
            effects=[at("end", "lit")],
        ),
        state=[{"id": "gas"}, LIT],
        goals=[{"var": "lit"}],
    )
    assert "only 'light' gives it that value, and 'light' needs 'gas' to be true" in message
    assert message.endswith(", which no effect gives it")


def test_an_optional_action_out_of_reach_is_no_fault() -> None:
    assert told(act("a", occurs="optional", conditions=[at("start", "lit")]), state=[LIT]) == []


@pytest.mark.parametrize(
    "fields",
    [
        {"goals": ["a"]},
        {"groups": [{"id": "g", "actions": ["a"]}]},
        {"groups": [{"id": "g", "actions": ["a", "b"], "required": False}], "goals": ["b"]},
    ],
)
def test_what_goals_and_groups_require_must_be_possible(fields: Document) -> None:
    needs = [at("start", "lit")]
    optional = "groups" in fields and not fields["groups"][0].get("required", True)
    own = {} if optional else {"occurs": "optional"}
    (message,) = told(act("a", conditions=needs, **own), act("b", **own), state=[LIT], **fields)
    assert message.startswith("action 'a' needs 'lit'")


def test_an_effect_at_the_start_serves_the_action_itself_unless_it_takes_no_time() -> None:
    burn = {"effects": [at("start", "lit")], "conditions": [at("all", "lit")]}
    assert told(act("match", 3, **burn), state=[LIT]) == []
    assert len(told(act("match", 0, **burn), state=[LIT])) == 1


def test_a_goal_that_an_action_ends_and_another_restores_is_no_fault() -> None:
    dark = act("snuff", occurs="optional", effects=[at("end", "lit", False)])
    goals = [{"var": "lit", "value": False}]
    assert told(LIGHT, dark, state=[LIT], goals=goals) == []
    (message,) = told(LIGHT, state=[LIT], goals=goals)
    assert "action 'light' changes it, and no effect restores it" in message


def test_nothing_is_called_out_of_reach_because_its_giver_is_misspelt() -> None:
    wrong = act("light", effects=[at("end", "litt")])
    messages = told(wrong, state=[LIT], goals=[{"var": "lit"}])
    assert messages == ["there is no state variable 'litt'"]


@pytest.mark.slow
def test_nothing_is_called_out_of_reach_because_its_giver_could_not_be_read() -> None:
    text = "state lit\nlight 3 onn stove sets lit\ngoal lit\n"
    assert [d.code.id for d in dsl_task(text).report.errors] == ["IRC010"]
    broken = (
        '{"state": [{"id": "lit"}], "goals": [{"var": "lit"}], "actions": '
        '[{"id": "light", "duration": "soon", "effects": [{"at": "end", "var": "lit"}]}]}'
    )
    with pytest.raises(irc.InputError) as found:
        irc.loads(broken)
    assert [d.code.id for d in found.value.report.errors] == ["IRC104"]


# --- contradictions -----------------------------------------------------------------------------


def test_two_values_at_the_two_ends_are_a_contradiction_only_without_time_between() -> None:
    ends = [at("start", "lit"), at("end", "lit", False)]
    assert told(act("blink", 1, effects=ends), state=[LIT]) == []
    assert len(told(act("blink", 0, effects=ends), state=[LIT])) == 1
    assert told(act("blink", {"min": 0, "max": 1}, effects=ends), state=[LIT]) == []


def test_a_change_at_its_own_start_lets_two_conditions_differ() -> None:
    needs = [at("start", "lit", False), at("all", "lit")]
    assert told(act("burn", conditions=needs, effects=[at("start", "lit")]), state=[LIT]) == []
    (message,) = told(act("burn", conditions=needs), LIGHT, state=[LIT])
    assert message == "action 'burn' needs 'lit' to be false at its start and true throughout"


def test_the_same_condition_twice_is_no_contradiction() -> None:
    needs = [at("all", "lit"), at("end", "lit"), at("start", "lit")]
    assert told(act("see", conditions=needs), LIGHT, state=[LIT]) == []


def test_true_and_the_text_true_are_two_values() -> None:
    switch = {"id": "s", "values": [True, "true"], "initial": True}
    (message,) = told(
        act("a", effects=[at("end", "s", True), at("end", "s", "true")]), state=[switch]
    )
    assert message.endswith("two values at its end: true and 'true'")


# --- stock --------------------------------------------------------------------------------------


def test_what_others_may_produce_counts_as_often_as_they_may_occur() -> None:
    lay = act("lay", occurs={"min": 0, "max": 2}, produces=eggs(1))
    assert told(act("bake", consumes=eggs(2)), lay, resources=[stock(0)]) == []
    (message,) = told(act("bake", consumes=eggs(3)), lay, resources=[stock(0)])
    assert "there are at most 2" in message
    endless = act("lay", occurs={"min": 0}, produces=eggs(1))
    assert told(act("bake", consumes=eggs(30)), endless, resources=[stock(0)]) == []


def test_what_it_gives_back_at_its_end_does_not_help_its_start() -> None:
    borrow = {"consumes": eggs(2), "produces": eggs(2)}
    assert told(act("a", 3, **borrow), resources=[stock(2)]) == []
    assert len(told(act("a", 3, **borrow), resources=[stock(1)])) == 1
    assert told(act("a", 0, **borrow), resources=[stock(1)]) == []


def test_what_all_consume_together_is_told_with_the_level_that_would_do() -> None:
    bakes = [act(f"bake{k}", consumes=eggs(2)) for k in range(3)]
    report = irc.check(Task.model_validate({"actions": bakes, "resources": [stock(4, min=1)]}))
    (error,) = report.errors
    assert (
        "'bake0', 'bake1' and 'bake2' take 6 of 'egg' in all, but it starts with 4" in error.message
    )
    assert error.hint == '"initial" must be at least 7, or more must be produced'
    assert told(*bakes, resources=[stock(7, min=1)]) == []


def test_each_occurrence_that_must_be_counts() -> None:
    bake = act("bake", occurs={"min": 3, "max": 5}, consumes=eggs(1))
    assert told(bake, resources=[stock(3)]) == []
    assert len(told(bake, resources=[stock(2)])) == 1


def test_what_must_be_produced_has_to_fit() -> None:
    lay = [act(f"lay{k}", produces=eggs(2)) for k in range(2)]
    (message,) = told(*lay, resources=[stock(1, max=4)])
    assert "put 4 into 'egg' in all, which starts with 1 and holds at most 4" in message
    eat = act("eat", occurs="optional", consumes=eggs(1))
    assert told(*lay, eat, resources=[stock(1, max=4)]) == []


def test_optional_consumption_is_no_fault() -> None:
    assert told(act("bake", occurs="optional", consumes=eggs(9)), resources=[stock(1)]) == []


# --- occurrences and rewards --------------------------------------------------------------------


def test_an_action_that_may_not_occur_is_a_fault_only_where_it_must() -> None:
    never = act("never", occurs={"max": 0})
    assert told(never) == []
    (message,) = told(never, act("b"), groups=[{"id": "g", "actions": ["never", "b"]}])
    assert message == "action 'never' may occur at most 0 times, but group 'g' requires it"


SELL = act("sell", occurs={"min": 0}, reward=3)


@pytest.mark.parametrize(
    ("action", "fields"),
    [
        (SELL, {"objective": "maximize_reward", "deadline": 60}),
        ({**SELL, "latest_start": 60}, {"objective": "maximize_reward"}),
        (SELL, {"objective": ["minimize_makespan", "maximize_reward"]}),
        (SELL, {"objective": "minimize_makespan"}),
        ({**SELL, "consumes": eggs(1)}, {"objective": "maximize_reward", "resources": [stock(5)]}),
        ({**SELL, "occurs": {"min": 0, "max": 9}}, {"objective": "maximize_reward"}),
        ({**SELL, "reward": -1}, {"objective": "maximize_reward"}),
    ],
)
def test_a_reward_that_something_ends_is_legal(action: Document, fields: Document) -> None:
    assert told(action, **fields) == []


@pytest.mark.parametrize(
    ("action", "fields"),
    [
        (SELL, {"objective": "maximize_reward"}),
        ({**SELL, "duration": 0}, {"objective": "maximize_reward", "deadline": 60}),
        ({**SELL, "reward": 0, "cost": -1}, {"objective": "minimize_cost"}),
        (
            {**SELL, "consumes": eggs(1), "produces": eggs(2)},
            {"objective": "maximize_reward", "resources": [stock(5)]},
        ),
    ],
)
def test_a_reward_without_end_is_refused(action: Document, fields: Document) -> None:
    (message,) = told(action, **fields)
    assert message.endswith("of action 'sell' can be collected without limit")


# --- size ---------------------------------------------------------------------------------------


@pytest.mark.slow
def test_long_chains_are_checked_in_linear_time() -> None:
    n = 20_000
    chain = [
        act(f"a{k}", conditions=[at("start", f"v{k}")], effects=[at("end", f"v{k + 1}")])
        for k in range(n)
    ]
    state = [{"id": f"v{k}"} for k in range(n + 1)]
    task = Task.model_validate({"actions": chain, "state": state, "goals": [{"var": f"v{n}"}]})
    began = time.process_time()
    errors = irc.check(task).errors
    assert time.process_time() - began < 10
    assert [d.pointer for d in errors] == [("actions", 0, "conditions", 0)]
