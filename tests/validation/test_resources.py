"""Rules 4 and 5: renewable resources, choices among them, reservoirs."""

from __future__ import annotations

from typing import Any

import pytest

from builders import rules, stock_task, violations
from irc.model import Task, Use
from irc.schedule import Entry, Schedule
from irc.validation import validate
from irc.validation.choices import is_explained


def users(count: int, duration: Any = 2, amount: int = 1, **grill: Any) -> Task:
    uses = [{"resource": "grill", "amount": amount}]
    return Task(
        actions=[{"id": f"a{i}", "duration": duration, "uses": uses} for i in range(count)],
        resources=[{"id": "grill", **grill}],
    )


def at(number: int, start: Any, duration: Any = 2, amount: int = 1) -> Entry:
    return Entry(f"a{number}", start, start + duration, {"grill": amount})


# Rule 4: capacity


def test_freed_capacity_can_be_taken_at_the_same_instant() -> None:
    assert rules(users(2), at(0, 0), at(1, 2)) == []


def test_use_above_the_capacity_is_refused() -> None:
    (violation,) = violations(users(2), at(0, 0), at(1, 1))
    assert (violation.rule, violation.number) == ("capacity", 4)
    assert violation.message == (
        "2 of 'grill' are in use at 1 s, its capacity then is 1 (used by 'a0', 'a1')"
    )
    assert violation.actions == ("a0", "a1")
    assert violation.times == (1,)


def test_a_larger_capacity_is_shared_up_to_its_last_unit() -> None:
    task = users(3, amount=2, capacity=5)
    assert rules(task, at(0, 0, amount=2), at(1, 1, amount=2), at(2, 2, amount=2)) == []
    assert rules(task, at(0, 0, amount=2), at(1, 1, amount=2), at(2, 1, amount=2)) == ["capacity"]


def test_every_instant_at_which_too_much_use_gets_worse_is_told() -> None:
    found = violations(users(3, duration=4), at(0, 0, 4), at(1, 1, 4), at(2, 2, 4))
    assert [v.times for v in found] == [(1,), (2,)]


def test_a_zero_duration_uses_nothing_but_names_its_resources() -> None:
    task = users(2, duration={"min": 0, "max": 2})
    assert rules(task, at(0, 0), at(1, 1, duration=0)) == []
    assert rules(task, at(0, 0), Entry("a1", 1, 1)) == ["resources"]


def test_a_resource_of_no_capacity_serves_nobody() -> None:
    assert rules(users(1, capacity=0), at(0, 0)) == ["capacity"]


def window(capacity: int, start: Any = 4, end: Any = 6) -> dict[str, Any]:
    return {"availability": [{"from": start, "to": end, "capacity": capacity}]}


def test_a_window_replaces_the_capacity_and_is_half_open() -> None:
    task = users(2, **window(0))
    assert rules(task, at(0, 2), at(1, 6)) == []
    assert rules(task, at(0, 3), at(1, 6)) == ["capacity"]
    assert rules(task, at(0, 2), at(1, 5)) == ["capacity"]


def test_an_action_does_not_pause_over_a_closed_window() -> None:
    found = violations(users(1, duration=10, **window(0)), at(0, 0, 10))
    assert [(v.rule, v.times) for v in found] == [("capacity", (4,))]


def test_a_window_can_add_capacity_for_its_time_only() -> None:
    task = users(2, **window(2))
    assert rules(task, at(0, 4), at(1, 4)) == []
    assert rules(task, at(0, 5), at(1, 5)) == ["capacity"]


def test_windows_that_touch_follow_each_other_without_a_gap() -> None:
    windows = [{"from": 0, "to": 3, "capacity": 2}, {"from": 3, "to": 6, "capacity": 3}]
    task = users(2, duration=6, capacity=0, availability=windows)
    assert rules(task, at(0, 0, 6), at(1, 0, 6)) == []


# Rule 4: what an entry names


def test_an_entry_names_exactly_what_it_uses() -> None:
    task = users(1)
    assert rules(task, Entry("a0", 0, 2, {"grill": 1})) == []
    (violation,) = violations(task, Entry("a0", 0, 2))
    assert violation.message == "'a0' names {}, but uses 'grill'"
    assert rules(task, Entry("a0", 0, 2, {"grill": 2})) == ["resources", "capacity"]


def test_an_unknown_resource_is_refused() -> None:
    (violation,) = violations(users(1), Entry("a0", 0, 2, {"grill": 1, "oven": 1}))
    assert violation.message == "'a0' names the resource 'oven', which the task does not have"


def test_uses_of_the_mode_are_added_to_the_actions_own() -> None:
    modes = [{"id": "by_hand", "duration": 2, "uses": [{"resource": "cook"}]}]
    task = Task(
        actions=[{"id": "cut", "uses": [{"resource": "board"}], "modes": modes}],
        resources=[{"id": "board"}, {"id": "cook"}],
    )
    assert rules(task, Entry("cut", 0, 2, {"board": 1, "cook": 1}, mode="by_hand")) == []
    assert rules(task, Entry("cut", 0, 2, {"cook": 1}, mode="by_hand")) == ["resources"]


def pool_task(*uses: dict[str, Any]) -> Task:
    return Task(
        actions=[{"id": "lift", "duration": 2, "uses": list(uses)}],
        resources=[{"id": f"r{i}", "capacity": 9} for i in range(1, 5)],
    )


def test_a_choice_names_one_of_its_resources() -> None:
    task = pool_task({"one_of": ["r1", "r2"]})
    assert rules(task, Entry("lift", 0, 2, {"r2": 1})) == []
    (violation,) = violations(task, Entry("lift", 0, 2, {"r3": 1}))
    assert violation.message == "'lift' names {'r3': 1}, but uses 'r1' or 'r2'"
    assert rules(task, Entry("lift", 0, 2, {"r1": 1, "r2": 1})) == ["resources"]
    assert rules(task, Entry("lift", 0, 2, {})) == ["resources"]


def test_two_choices_of_the_same_pool_may_fall_on_two_resources_or_on_one() -> None:
    task = pool_task({"one_of": ["r1", "r2"]}, {"one_of": ["r1", "r2"]})
    assert rules(task, Entry("lift", 0, 2, {"r1": 1, "r2": 1})) == []
    assert rules(task, Entry("lift", 0, 2, {"r1": 2})) == []
    assert rules(task, Entry("lift", 0, 2, {"r1": 1})) == ["resources"]
    assert rules(task, Entry("lift", 0, 2, {"r1": 2, "r2": 1})) == ["resources"]


def test_a_plain_use_and_a_choice_of_one_resource_add_up() -> None:
    task = pool_task({"resource": "r1"}, {"one_of": ["r1", "r2"], "amount": 2})
    assert rules(task, Entry("lift", 0, 2, {"r1": 3})) == []
    assert rules(task, Entry("lift", 0, 2, {"r1": 1, "r2": 2})) == []
    assert rules(task, Entry("lift", 0, 2, {"r1": 2, "r2": 1})) == ["resources"]


def choices(*texts: str, amount: int = 1) -> list[Use]:
    return [Use(one_of=tuple(text.split()), amount=amount) for text in texts]


def test_overlapping_choices_are_matched_even_where_the_first_guess_is_wrong() -> None:
    uses = choices("a b", "a c", "a")
    assert is_explained(uses, {"a": 1, "b": 1, "c": 1}) is True
    assert is_explained(uses, {"a": 2, "b": 1}) is True
    assert is_explained(uses, {"b": 2, "c": 1}) is False


def test_choices_of_different_amounts_are_packed() -> None:
    uses = [*choices("a b", amount=3), *choices("a b", amount=2), *choices("a b c", amount=2)]
    assert is_explained(uses, {"a": 3, "b": 4}) is True
    assert is_explained(uses, {"a": 5, "c": 2}) is True
    assert is_explained(uses, {"a": 6, "b": 1}) is False
    assert is_explained(uses, {"a": 1, "b": 6}) is False


def test_equal_choices_of_several_units_are_not_split() -> None:
    uses = choices("a b", "a b", amount=2)
    assert is_explained(uses, {"a": 2, "b": 2}) is True
    assert is_explained(uses, {"a": 1, "b": 3}) is False


def test_many_equal_choices_are_matched_at_once() -> None:
    names = [f"r{i}" for i in range(60)]
    uses = choices(*[" ".join(names[i : i + 20]) for i in range(40)])
    assert is_explained(uses, dict.fromkeys(names[10:50], 1)) is True
    assert is_explained(uses, dict.fromkeys([*names[:10], *names[29:59]], 1)) is True
    assert is_explained(uses, {**dict.fromkeys(names[:38], 1), "r0": 3}) is False


@pytest.mark.slow
def test_a_packing_too_hard_to_decide_is_called_undecided_not_valid() -> None:
    names = [f"r{i:02}" for i in range(24)]
    uses = [Use(one_of=tuple(names), amount=100 + i) for i in range(48)]
    half = sum(use.amount for use in uses) // 24
    named = dict.fromkeys(names, half)
    named["r00"] += sum(use.amount for use in uses) - 24 * half
    task = Task(
        actions=[{"id": "lift", "duration": 0, "uses": uses}],
        resources=[{"id": name} for name in names],
    )
    verdict = validate(task, Schedule((Entry("lift", 0, 0, named),)))
    assert [v.rule for v in verdict.violations] == ["undecided"]
    assert verdict.undecided
    assert not verdict.valid


# Rule 5


def bake(name: str = "bake", amount: int = 1, **at: str) -> dict[str, Any]:
    return {
        "id": name,
        "duration": 2,
        "consumes": [{"resource": "flour", "amount": amount, **at}],
    }


def mill(name: str = "mill", amount: int = 1, **at: str) -> dict[str, Any]:
    return {
        "id": name,
        "duration": 2,
        "produces": [{"resource": "flour", "amount": amount, **at}],
    }


def test_stock_is_taken_at_the_start_and_put_in_at_the_end() -> None:
    task = stock_task(bake(), mill())
    assert rules(task, Entry("mill", 0, 2), Entry("bake", 2, 4)) == []
    (violation,) = violations(task, Entry("mill", 0, 2), Entry("bake", 1, 3))
    assert (violation.rule, violation.number) == ("reservoir", 5)
    assert violation.message == (
        "the level of 'flour' is -1 at 1 s, below its minimum 0 (after 'bake')"
    )


def test_changes_of_one_instant_come_in_an_order_that_keeps_the_level() -> None:
    both = Entry("mill", 0, 2), Entry("bake", 2, 4)
    assert rules(stock_task(bake(amount=3), mill(amount=2), initial=1, max=3), *both) == []
    task = stock_task(bake(amount=3), mill(amount=2), initial=1, max=2)
    (violation,) = violations(task, *both)
    assert violation.message == "no order of 'mill', 'bake' at 2 s keeps 'flour' within bounds"


def test_a_change_happens_where_it_says() -> None:
    task = stock_task(bake(at="end"), mill(at="start"))
    assert rules(task, Entry("mill", 2, 4), Entry("bake", 0, 2)) == []
    assert rules(task, Entry("mill", 2, 4), Entry("bake", 1, 3)) == []
    assert rules(task, Entry("mill", 3, 5), Entry("bake", 0, 2)) == ["reservoir"]


def test_a_zero_duration_changes_stock_too() -> None:
    task = stock_task({**bake(), "duration": 0}, initial=0)
    assert rules(task, Entry("bake", 0, 0)) == ["reservoir"]


def test_a_reservoir_does_not_overflow() -> None:
    task = stock_task(mill("m1"), mill("m2"), max=1)
    (violation,) = violations(task, Entry("m1", 0, 2), Entry("m2", 2, 4))
    assert violation.message == (
        "the level of 'flour' is 2 at 4 s, above its maximum 1 (after 'm2')"
    )


def test_a_reservoir_without_a_maximum_never_overflows() -> None:
    assert rules(stock_task(mill(amount=10**9)), Entry("mill", 0, 2)) == []


def test_the_initial_level_counts_unless_it_changes_at_once() -> None:
    task = stock_task({**mill(), "duration": 0}, initial=0, min=1)
    assert rules(task, Entry("mill", 0, 0)) == []
    assert rules(task, Entry("mill", 1, 1)) == ["reservoir"]


def test_a_level_out_of_bounds_is_told_when_it_leaves_them_or_gets_worse() -> None:
    task = stock_task(bake("b1"), bake("b2"), mill(), initial=0)
    found = violations(task, Entry("b1", 0, 2), Entry("b2", 1, 3), Entry("mill", 2, 4))
    assert [v.times for v in found] == [(0,), (1,)]


@pytest.mark.parametrize("initial", [0, 5])
def test_a_reservoir_that_nothing_touches_keeps_its_level(initial: int) -> None:
    task = stock_task({"id": "wait", "duration": 1}, initial=initial, max=3)
    assert rules(task, Entry("wait", 0, 1)) == (["reservoir"] if initial > 3 else [])
