"""What history alone breaks is carried, and binds the rest just as much as it must."""

from __future__ import annotations

import pytest

from builders import task_of
from irc.schedule import Status
from online_cases import action, carried, entry, plan, repaired, starts

ROBOTS = [{"id": "r1"}, {"id": "r2"}]
FLOUR = [{"id": "flour", "kind": "reservoir"}]
MAKES = {"produces": [{"resource": "flour", "amount": 1}]}
TAKES = {"consumes": [{"resource": "flour", "amount": 1}]}


def seen(name: str, time: int) -> dict[str, object]:
    return {"op": "observe", "action": name, "started": time}


# --- pools ---


def test_a_free_member_of_a_pool_can_be_taken_though_another_is_overloaded() -> None:
    pool = task_of(
        *(action(n, d, "r1|r2") for n, d in (("a", 4), ("b", 8), ("c", 8))), resources=ROBOTS
    )
    old = plan(entry("a", 0, 4, "r1"), entry("b", 4, 12, "r1"), entry("c", 4, 12, "r2"))
    step = repaired(pool, old, 2, seen("a", 0), seen("b", 2))
    assert starts(step.schedule) == {"a": 0, "b": 2, "c": 2}
    assert carried(step) == [
        "2 of 'r1' are in use at 2 s, its capacity then is 1 (used by 'a', 'b')"
    ]


def test_more_can_run_in_a_pool_than_it_has_if_history_says_so() -> None:
    pool = task_of(*(action(n, 4, "r1|r2") for n in "abcd"), resources=ROBOTS)
    old = plan(
        entry("a", 0, 4, "r1"),
        entry("c", 0, 4, "r2"),
        entry("b", 4, 8, "r1"),
        entry("d", 4, 8, "r2"),
    )
    step = repaired(pool, old, 2, seen("a", 0), seen("b", 2))
    assert step.schedule.status is Status.OPTIMAL
    assert starts(step.schedule) == {"a": 0, "c": 0, "b": 2, "d": 4}


# --- capacity ---


def test_what_runs_keeps_its_place_when_capacity_is_cut_and_nothing_open_joins_it() -> None:
    oven = task_of(
        *(action(n, 4, "oven") for n in "abc"), resources=[{"id": "oven", "capacity": 2}]
    )
    old = plan(*(entry(n, t, t + 4, "oven") for n, t in (("a", 0), ("b", 1), ("c", 4))))
    cut = {"op": "set_capacity", "resource": "oven", "capacity": 1}
    step = repaired(oven, old, 2, cut)
    assert starts(step.schedule) == {"a": 0, "b": 1, "c": 5}
    assert carried(step) == [
        "2 of 'oven' are in use at 2 s, its capacity then is 1 (used by 'a', 'b')"
    ]


def test_a_capacity_that_is_cut_to_what_runs_is_no_conflict() -> None:
    oven = task_of(*(action(n, 4, "oven") for n in "ab"), resources=[{"id": "oven", "capacity": 2}])
    old = plan(entry("a", 0, 4, "oven"), entry("b", 2, 6, "oven"))
    step = repaired(oven, old, 2, {"op": "set_capacity", "resource": "oven", "capacity": 1})
    assert starts(step.schedule) == {"a": 0, "b": 4}
    assert carried(step) == []


# --- time ---


def test_a_deadline_that_one_running_action_breaks_still_binds_the_other() -> None:
    """`watch` ends 6 after `cook`: were it not bound, `serve` would go first, not to be late."""
    late = task_of(
        action("late", 8),
        action("watch", {"min": 5, "max": 20}),
        action("cook", 3, "oven"),
        action("serve", 3, "oven", due=4),
        resources=[{"id": "oven"}],
        precedence=[{"before": "cook", "after": "watch", "type": "finish-finish", "min_lag": 6}],
        deadline=10,
        objective="minimize_tardiness",
    )
    old = plan(
        entry("late", 0, 8),
        entry("watch", 0, 10),
        entry("cook", 1, 4, "oven"),
        entry("serve", 4, 7, "oven"),
    )
    step = repaired(late, old, 1, {"op": "set_duration", "action": "late", "duration": 12})
    assert starts(step.schedule) == {"late": 0, "watch": 0, "cook": 1, "serve": 4}
    assert carried(step) == ["'late' ends at 12 s, after the task's deadline (10 s)"]


@pytest.mark.parametrize("lags", [{"min_lag": 3}, {"max_lag": 1, "type": "start-start"}])
def test_an_order_that_history_breaks_is_carried(lags: dict[str, object]) -> None:
    both = task_of(action("a", 4), action("b", 4), action("c", 1), precedence=[["b", "c"]])
    old = plan(entry("a", 0, 4), entry("b", 4, 8), entry("c", 8, 9))
    order = {"op": "add_precedence", "precedence": [{"before": "a", "after": "b", **lags}]}
    step = repaired(both, old, 5, order)
    assert step.schedule.entries == old.entries
    assert len(carried(step)) == 1


# --- stock ---


def test_what_was_used_too_soon_is_made_up_for_by_what_still_runs_and_by_nothing_else() -> None:
    """`bake` took what `mill` brings at 5, so at 5 there is nothing yet for `bake2`."""
    baking = task_of(
        action("mill", 5, **MAKES),
        action("mill2", 8, **MAKES),
        action("bake", 3, **TAKES),
        action("bake2", 9, **TAKES),
        resources=FLOUR,
    )
    old = plan(
        entry("mill", 0, 5), entry("mill2", 0, 8), entry("bake", 5, 8), entry("bake2", 8, 17)
    )
    step = repaired(baking, old, 3, seen("bake", 3))
    assert starts(step.schedule) == {"mill": 0, "mill2": 0, "bake": 3, "bake2": 8}
    assert carried(step) == [
        "the level of 'flour' is -1 at 3 s, below its minimum 0 (after 'bake')"
    ]


def test_what_the_only_supplier_brings_makes_up_for_the_past_first() -> None:
    baking = task_of(
        action("mill", 5, produces=[{"resource": "flour", "amount": 2}]),
        action("bake", 3, **TAKES),
        action("bake2", 2, **TAKES),
        action("bake3", 2, occurs="optional", reward=5, **TAKES),
        resources=FLOUR,
        objective=["maximize_reward", "minimize_makespan"],
    )
    old = plan(entry("mill", 3, 8), entry("bake", 8, 11), entry("bake2", 8, 10))
    step = repaired(baking, old, 3, seen("bake", 3))
    assert starts(step.schedule) == {"bake": 3, "mill": 3, "bake2": 8}


def test_a_store_that_history_has_overfilled_is_full_until_it_is_emptied() -> None:
    full = task_of(
        action("bring", 2, **MAKES),
        action("fetch", 6, consumes=[{"resource": "flour", "amount": 1, "at": "end"}]),
        action("bring2", 1, **MAKES),
        action("fetch2", 4, consumes=[{"resource": "flour", "amount": 1, "at": "end"}]),
        resources=[{"id": "flour", "kind": "reservoir", "initial": 1, "max": 1}],
    )
    old = plan(
        entry("fetch", 0, 6), entry("bring", 4, 6), entry("fetch2", 6, 10), entry("bring2", 9, 10)
    )
    step = repaired(full, old, 2, {"op": "observe", "action": "bring", "started": 0, "finished": 2})
    assert step.schedule.status is Status.OPTIMAL
    assert {n: t for n, t in starts(step.schedule).items() if n != "bring"} == {
        "fetch": 0,
        "fetch2": 2,
        "bring2": 5,
    }
    assert carried(step) == [
        "the level of 'flour' is 2 at 2 s, above its maximum 1 (after 'bring')"
    ]


def test_stock_that_runs_out_later_because_of_history_alone_is_carried() -> None:
    """`bake` takes its flour when it ends, and nobody will have milled any."""
    baking = task_of(
        action("mill", 2, **MAKES),
        action("bake", 6, consumes=[{"resource": "flour", "amount": 1, "at": "end"}]),
        resources=FLOUR,
    )
    old = plan(entry("bake", 0, 6), entry("mill", 4, 6))
    step = repaired(baking, old, 3, {"op": "cancel_actions", "actions": ["mill"]})
    assert starts(step.schedule) == {"bake": 0}
    assert len(carried(step)) == 1


def test_the_pause_of_what_ends_after_a_new_deadline_is_stated_as_it_is() -> None:
    """The calendar is known until that end, and not only until the deadline."""
    task = task_of(
        action("paint", 2, calendar="shift", breaks="pause"),
        calendars=[{"id": "shift", "every": 4, "open": [{"from": 1, "to": 2}]}],
    )
    deadline = {"op": "set_deadline", "deadline": 8}
    step = repaired(task, plan(entry("paint", 5, 10, paused=3)), 6, deadline)
    assert [e.paused for e in step.schedule.entries] == [3]
    assert any("deadline" in message for message in carried(step))


def test_what_starts_now_cannot_have_made_room_for_what_has_just_ended() -> None:
    """The past comes first: `mill` filled the bin before `bake`, which was seen to start now."""
    flour = [{"resource": "flour", "amount": 2}]
    task = task_of(
        action("mill", 1, produces=flour),
        action("bake", 2, consumes=flour),
        action("clean", 1),
        resources=[{"id": "flour", "kind": "reservoir", "initial": 2, "max": 3}],
    )
    planned = plan(entry("mill", 2, 3), entry("bake", 3, 5), entry("clean", 5, 6))
    step = repaired(task, planned, 3, seen("bake", 3))
    assert starts(step.schedule) == {"mill": 2, "bake": 3, "clean": 3}
    assert [message.split(" at ")[0] for message in carried(step)] == ["the level of 'flour' is 4"]
