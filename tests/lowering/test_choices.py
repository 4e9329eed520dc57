"""Lowering choices, state, stock, groups, goals and objectives."""

from __future__ import annotations

from typing import Any

import pytest

from builders import Document, act, problem_of
from irc.problem import IMPOSSIBLE_DEADLINE, PLAIN, Condition, Details, Effect, Mode, StockChange


def details(**fields: Any) -> Details:
    return problem_of(act("a", 1, **fields)).activities[0].details


@pytest.mark.parametrize(
    ("occurs", "optional", "repeats"),
    [
        ("once", False, None),
        ("optional", True, None),
        ({"min": 0, "max": 1}, True, None),
        ({"min": 1, "max": 1}, False, None),
        ({"min": 0}, False, (0, None)),
        ({"min": 2, "max": 3}, False, (2, 3)),
    ],
)
def test_occurrences_are_optional_or_repeated(occurs: Any, optional: bool, repeats: Any) -> None:
    found = details(occurs=occurs)
    assert (found.optional, found.repeats) == (optional, repeats)


def test_what_may_never_occur_has_a_deadline_before_all_times() -> None:
    (activity,) = problem_of(act("a", 1, occurs={"min": 0, "max": 0})).activities
    assert (activity.details.optional, activity.deadline) == (True, IMPOSSIBLE_DEADLINE)


def group(name: str = "g", *actions: str, **fields: Any) -> Document:
    return {"id": name, "actions": list(actions), **fields}


def test_an_optional_group_makes_its_members_optional() -> None:
    problem = problem_of(act("a", 1), act("b", 1), groups=[group("g", "a", required=False)])
    assert [a.details.optional for a in problem.activities] == [True, False]


def test_a_required_group_wins_over_an_optional_one() -> None:
    groups = [group("g", "a", "b", required=False), group("h", "b")]
    problem = problem_of(act("a", 1), act("b", 1), groups=groups)
    assert [a.details.optional for a in problem.activities] == [True, False]


def test_the_earliest_deadline_among_an_action_and_its_groups_counts() -> None:
    groups = [group("g", "a", "b", deadline=7), group("h", "b", deadline=5), group("i", "c")]
    problem = problem_of(act("a", 1, deadline=6), act("b", 1), act("c", 1), groups=groups)
    assert [a.deadline for a in problem.activities] == [6, 5, None]


def test_a_group_is_worth_and_due_what_it_says() -> None:
    groups = [group("g", "b", "a", reward=3, due=4, weight=0), group("empty")]
    (found,) = problem_of(act("a", 1), act("b", 1), groups=groups).groups
    assert (found.members, found.reward, found.due, found.weight) == ((0, 1), 3, 4, 0)
    assert found.origin == ("groups", 0)


def test_modes_come_in_the_order_of_names_each_with_its_uses() -> None:
    modes = [
        {"id": "slow", "duration": 4, "uses": [{"resource": "oven"}]},
        {"id": "fast", "duration": {"min": 0, "max": 2}},
    ]
    action = {"id": "a", "uses": [{"resource": "cook"}], "modes": modes}
    (a,) = problem_of(action, resources=[{"id": "cook"}, {"id": "oven"}]).activities
    assert a.details.modes == (Mode("fast", 0, 1), Mode("slow", 2, 2))
    assert [use.alternatives for use in a.uses] == [(0,), (1,)]
    assert [a.details.use_mode(k) for k in (0, 1)] == [None, 1]
    assert [claim.use for claim in a.open_demands] == [0, 1]


def test_a_mode_without_length_claims_nothing() -> None:
    modes = [
        {"id": "m", "duration": 0, "uses": [{"resource": "oven"}]},
        {"id": "n", "duration": 2},
    ]
    (a,) = problem_of({"id": "a", "modes": modes}, resources=[{"id": "oven"}]).activities
    assert (len(a.uses), a.open_demands) == (1, ())


def test_stock_is_taken_at_the_start_and_given_at_the_end_unless_said_otherwise() -> None:
    flour = {"resource": "flour", "amount": 2}
    resources = [{"id": "flour", "kind": "reservoir", "initial": 3, "min": -1, "max": 9}]
    action = act(
        "a", 1, consumes=[flour, {**flour, "at": "end"}], produces=[flour, {**flour, "at": "start"}]
    )
    problem = problem_of(action, resources=resources)
    assert set(problem.activities[0].details.stock) == {
        StockChange(0, amount, at_end) for amount in (-2, 2) for at_end in (False, True)
    }
    (reservoir,) = problem.reservoirs
    assert (reservoir.initial, reservoir.least, reservoir.greatest) == (3, -1, 9)


def test_repeated_changes_of_stock_add_up_and_repeated_conditions_do_not() -> None:
    flour = {"resource": "flour", "amount": 1}
    lit = {"at": "start", "var": "lit", "value": True}
    problem = problem_of(
        act("a", 1, consumes=[flour, {**flour}], conditions=[lit, {**lit}]),
        resources=[{"id": "flour", "kind": "reservoir", "initial": 2}],
        state=[{"id": "lit"}],
    )
    found = problem.activities[0].details
    assert found.stock == (StockChange(0, -1, False), StockChange(0, -1, False))
    assert len(found.conditions) == 1


def test_values_that_look_alike_are_told_apart() -> None:
    state = [{"id": "flag"}, {"id": "word", "values": ["true", "false"], "initial": "false"}]
    problem = problem_of(
        act(
            "a",
            1,
            conditions=[{"at": "all", "var": "flag", "value": False}],
            effects=[{"at": "end", "var": "word", "value": "true"}],
        ),
        state=state,
        goals=[{"var": "flag", "value": True}],
    )
    flag, word = problem.variables
    found = problem.activities[0].details
    assert found.conditions == (Condition(0, flag.values.index(False), "all"),)
    assert found.effects == (Effect(1, word.values.index("true"), True),)
    assert problem.goals == ((0, flag.values.index(True)),)
    assert (flag.values[flag.initial], word.values[word.initial]) == (False, "false")


def test_goals_that_name_actions_are_wanted_once() -> None:
    problem = problem_of(
        act("a", 1, occurs="optional"), act("b", 1, occurs={"min": 0}), goals=["b", "a", "b"]
    )
    assert problem.required == (0, 1)


def test_objectives_keep_their_order() -> None:
    named = ["minimize_cost", "maximize_reward", "minimize_tardiness", "minimize_makespan"]
    problem = problem_of(act("a", 1), objective=named)
    assert problem.objectives == ("cost", "reward", "tardiness", "makespan")


def test_what_says_nothing_more_stays_plain() -> None:
    problem = problem_of(act("a", 1), act("b", 1, occurs="optional"))
    assert problem.activities[0].details is PLAIN
    assert not problem.is_plain
    assert problem.has_contention


def test_due_dates_and_rewards_alone_leave_nothing_to_decide() -> None:
    problem = problem_of(act("a", 1, due=0, reward=2, cost=1), objective="minimize_tardiness")
    assert problem.is_plain
    assert not problem.has_contention
