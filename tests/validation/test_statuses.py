"""What an entry may say of itself while a schedule is carried out: cancelled, abandoned."""

from __future__ import annotations

from typing import Any

import pytest

import irc
from builders import rules, task_of
from irc.events.apply import apply
from irc.model import Event, Task
from irc.schedule import Entry, Schedule
from irc.validation import Verdict, validate


def verdict(task: Task, *entries: Entry) -> Verdict:
    return validate(task, Schedule(entries))


def over(name: str = "cut", at: Any = 4, **fields: Any) -> dict[str, Any]:
    """An action of 10 as `apply` leaves it where it is cancelled at `at`."""
    return {"id": name, "duration": 10, "occurs": "optional", "deadline": at, **fields}


def cancelled(start: Any, end: Any, name: str = "cut", **fields: Any) -> Entry:
    return Entry(name, start, end, status="cancelled", **fields)


# Cancelled


def test_what_is_cancelled_ends_at_the_cancellation_whatever_it_should_have_lasted() -> None:
    assert rules(task_of(over()), cancelled(0, 4)) == []
    assert rules(task_of(over()), Entry("cut", 0, 4)) == ["duration"]
    assert rules(task_of(over()), cancelled(4, 4)) == []


def test_apply_makes_the_task_for_which_a_cancelled_entry_is_valid() -> None:
    task = task_of(
        {"id": "cut", "duration": 10, "deadline": 20},
        {"id": "stack", "duration": 1},
        precedence=[("cut", "stack")],
        goals=["cut"],
        groups=[{"id": "g", "actions": ["cut", "stack"], "required": False}],
    )
    revised = apply(task, Event(at=4, changes=[{"op": "cancel_actions", "actions": ["cut"]}]))
    assert rules(revised, cancelled(0, 4), Entry("stack", 4, 5)) == []
    assert rules(task, cancelled(0, 4), Entry("stack", 4, 5)) == ["status", "group", "goal"]


@pytest.mark.parametrize(
    "action",
    [
        {"id": "cut", "duration": 10, "deadline": 4},
        {"id": "cut", "duration": 10, "occurs": {"min": 1, "max": 2}, "deadline": 4},
        {"id": "cut", "duration": 10, "occurs": "optional"},
        over(at=5),
    ],
)
def test_only_what_the_task_has_as_over_can_be_cancelled(action: dict[str, Any]) -> None:
    assert rules(task_of(action), cancelled(0, 4)) == ["status"]


def test_a_cancelled_entry_keeps_its_deadline_release_and_start() -> None:
    assert rules(task_of(over(at=3)), cancelled(0, 4)) == ["deadline"]
    assert rules(task_of(over(release=1)), cancelled(0, 4)) == ["release"]
    assert rules(task_of(over(start=1)), cancelled(0, 4)) == ["start"]
    assert rules(task_of(over(), deadline=3), cancelled(0, 4)) == ["deadline"]


def test_nothing_is_cancelled_after_its_longest_duration_or_before_its_start() -> None:
    ranged = over(duration={"min": 6, "max": 8}, at=9)
    assert rules(task_of(ranged), cancelled(1, 9)) == []
    assert rules(task_of(ranged), cancelled(0, 9)) == ["duration"]
    assert rules(task_of(over()), cancelled(5, 4)) == ["duration"]


def test_the_mode_says_how_long_what_is_cancelled_could_have_lasted() -> None:
    fields = {"occurs": "optional", "deadline": 4, "modes": [{"id": "fast", "duration": 3}]}
    task = task_of({"id": "cut", **fields})
    assert rules(task, cancelled(1, 4, mode="fast")) == []
    assert rules(task, cancelled(0, 4, mode="fast")) == ["duration"]
    assert rules(task, cancelled(1, 4)) == ["mode"]


def test_what_is_cancelled_holds_its_resources_until_then() -> None:
    uses = [{"resource": "saw"}]
    task = task_of(
        over(uses=uses), {"id": "next", "duration": 1, "uses": uses}, resources=[{"id": "saw"}]
    )
    first = cancelled(0, 4, resources={"saw": 1})
    assert rules(task, first, Entry("next", 4, 5, {"saw": 1})) == []
    assert rules(task, first, Entry("next", 3, 4, {"saw": 1})) == ["capacity"]
    assert rules(task, cancelled(0, 4), Entry("next", 4, 5, {"saw": 1})) == ["resources"]


def test_stock_changes_at_the_start_of_what_is_cancelled_count_and_later_ones_do_not() -> None:
    def task(kind: str, at: str) -> Task:
        change = [{"resource": "flour", "at": at}]
        stock = {"id": "flour", "kind": "reservoir", "initial": 0, "max": 0}
        return task_of(over(**{kind: change}), resources=[stock])

    for kind in ("consumes", "produces"):
        assert rules(task(kind, "start"), cancelled(0, 4)) == ["reservoir"]
        assert rules(task(kind, "end"), cancelled(0, 4)) == []
    baked = task_of(
        over(produces=[{"resource": "flour"}]),
        {"id": "use", "duration": 1, "consumes": [{"resource": "flour"}]},
        resources=[{"id": "flour", "kind": "reservoir"}],
    )
    assert rules(baked, cancelled(0, 4), Entry("use", 4, 5)) == ["reservoir"]


def state_task(**fields: Any) -> Task:
    return task_of(
        over(**fields),
        {
            "id": "turn_off",
            "duration": 1,
            "effects": [{"at": "start", "var": "on", "value": False}],
        },
        {"id": "need", "duration": 1, "conditions": [{"at": "start", "var": "on"}]},
        state=[{"id": "on", "initial": False}],
    )


def test_effects_at_the_start_of_what_is_cancelled_stay_and_those_at_its_end_never_come() -> None:
    need, turn_off = Entry("need", 4, 5), Entry("turn_off", 6, 7)
    early = state_task(effects=[{"at": "start", "var": "on"}])
    late = state_task(effects=[{"at": "end", "var": "on"}])
    assert rules(early, cancelled(0, 4), need, turn_off) == []
    assert rules(late, cancelled(0, 4), need, turn_off) == ["state"]
    assert rules(early, cancelled(4, 4), Entry("need", 4, 5, rank=1), turn_off) == []


def test_conditions_hold_while_what_is_cancelled_lasts_and_its_end_has_none() -> None:
    held = state_task(
        effects=[{"at": "start", "var": "on"}], conditions=[{"at": "all", "var": "on"}]
    )
    need = Entry("need", 1, 2)
    for ranks in ({}, {"rank": 1}):  # Found, and given.
        assert rules(held, cancelled(0, 4), need, Entry("turn_off", 4, 5, **ranks)) == []
        assert rules(held, cancelled(0, 4), need, Entry("turn_off", 3, 4, **ranks)) == ["state"]
    at_once = state_task(
        at=0, effects=[{"at": "start", "var": "on"}], conditions=[{"at": "all", "var": "on"}]
    )
    assert rules(at_once, cancelled(0, 0), need, Entry("turn_off", 4, 5)) == []
    asks = state_task(
        effects=[{"at": "start", "var": "on"}], conditions=[{"at": "end", "var": "on"}]
    )
    assert rules(asks, cancelled(0, 4), need, Entry("turn_off", 3, 4)) == []
    never = state_task(conditions=[{"at": "start", "var": "on"}])
    assert "state" in rules(never, cancelled(0, 4), Entry("turn_off", 5, 6))


def test_precedence_does_not_bind_what_is_cancelled() -> None:
    for pair in (("cut", "stack"), ("stack", "cut")):
        task = task_of(over(), {"id": "stack", "duration": 1}, precedence=[pair])
        assert rules(task, cancelled(0, 4), Entry("stack", 2, 3)) == []
        assert rules(task, cancelled(0, 4), Entry("stack", 2, 3, rank=3)) == []


def test_what_is_cancelled_costs_but_earns_nothing_and_is_not_late() -> None:
    task = task_of(over(reward=7, cost=3, due=1))
    values = verdict(task, cancelled(0, 4)).objective
    assert dict(values) == {"makespan": 4, "tardiness": 0, "reward": 0, "cost": 3}


def test_what_is_cancelled_is_neither_a_goal_reached_nor_a_member_of_a_whole_group() -> None:
    assert rules(task_of(over(), goals=["cut"]), cancelled(0, 4)) == ["goal"]
    group = {"id": "g", "actions": ["cut", "stack"], "reward": 5}
    actions = (over(), {"id": "stack", "duration": 1})
    whole = verdict(task_of(*actions, groups=[group]), cancelled(0, 4), Entry("stack", 0, 1))
    assert [v.rule for v in whole.violations] == ["group"]
    assert whole.objective["reward"] == 0


def test_an_occurrence_of_a_repeated_action_can_be_cancelled() -> None:
    task = task_of(over(at=14, occurs={"min": 0, "max": 2}, reward=5))
    done = Entry("cut", 0, 10)
    assert rules(task, done, cancelled(10, 14, occurrence=2)) == []
    assert rules(task, done, cancelled(9, 14, occurrence=2)) == ["occurrence"]
    assert verdict(task, done, cancelled(10, 14, occurrence=2)).objective["reward"] == 5


# Abandoned


def order(**fields: Any) -> Task:
    return task_of(
        {"id": "bake", "duration": 3, "reward": 2, "cost": 1},
        {"id": "serve", "duration": 1},
        groups=[
            {"id": "order", "actions": ["bake", "serve"], "required": False, "reward": 9},
            *fields.pop("groups", []),
        ],
        **fields,
    )


BAKED = Entry("bake", 0, 3, status="abandoned")


def test_what_ran_of_a_group_that_was_given_up_is_marked() -> None:
    given_up = verdict(order(), BAKED)
    assert given_up.violations == ()
    assert (given_up.objective["reward"], given_up.objective["cost"]) == (2, 1)
    unmarked = verdict(order(), Entry("bake", 0, 3))
    assert [v.rule for v in unmarked.violations] == ["group"]


def test_every_member_that_is_there_must_be_marked() -> None:
    task = task_of(
        *({"id": name, "duration": 1} for name in "abc"),
        groups=[{"id": "g", "actions": list("abc"), "required": False}],
    )
    a, b = Entry("a", 0, 1, status="abandoned"), Entry("b", 0, 1)
    (violation,) = verdict(task, a, b).violations
    assert violation.message == (
        "the group 'g' is all or none; missing: 'c'; present and not abandoned: 'b'"
    )
    assert rules(task, a, Entry("b", 0, 1, status="abandoned")) == []


def test_nothing_of_a_whole_group_is_abandoned() -> None:
    assert rules(order(), BAKED, Entry("serve", 3, 4)) == ["status"]
    assert rules(task_of({"id": "bake", "duration": 3}), BAKED) == ["status"]


def test_a_required_group_cannot_be_given_up() -> None:
    task = task_of(
        {"id": "bake", "duration": 3, "occurs": "optional"},
        {"id": "serve", "duration": 1, "occurs": "optional"},
        groups=[{"id": "order", "actions": ["bake", "serve"]}],
    )
    assert rules(task, BAKED) == ["status", "group"]


def test_a_member_of_another_whole_group_is_not_marked() -> None:
    other = {"id": "other", "actions": ["bake"]}
    assert rules(order(groups=[other]), Entry("bake", 0, 3)) == []
    with_lost = {"id": "other", "actions": ["bake", "lost"], "required": False}
    task = task_of(
        *({"id": name, "duration": 3} for name in ("bake", "serve", "lost")),
        groups=[{"id": "order", "actions": ["bake", "serve"], "required": False}, with_lost],
    )
    assert rules(task, Entry("bake", 0, 3)) == ["group", "group"]


def test_the_deadline_of_a_group_lapses_when_it_is_given_up() -> None:
    def late(**fields: Any) -> Task:
        group = {"id": "g", "actions": ["a", "b"], "required": False, "deadline": 2}
        actions = [{"id": "a", "duration": 3, **fields}, {"id": "b", "duration": 0}]
        return task_of(*actions, groups=[group])

    marked = Entry("a", 0, 3, status="abandoned")
    assert rules(late(), marked) == []
    assert rules(late(deadline=2), marked) == ["deadline"]
    assert rules(late(), Entry("a", 0, 3)) == ["group", "deadline"]
    assert rules(late(), Entry("a", 0, 3), Entry("b", 0, 0)) == ["deadline"]


def test_what_is_abandoned_lasts_holds_consumes_and_acts_as_usual() -> None:
    task = task_of(
        {
            "id": "bake",
            "duration": 3,
            "uses": [{"resource": "oven"}],
            "consumes": [{"resource": "flour"}],
            "effects": [{"at": "end", "var": "warm"}],
        },
        {"id": "serve", "duration": 1},
        {"id": "dry", "duration": 1, "occurs": "optional", "uses": [{"resource": "oven"}]},
        {"id": "mix", "duration": 1, "occurs": "optional", "consumes": [{"resource": "flour"}]},
        resources=[{"id": "oven"}, {"id": "flour", "kind": "reservoir", "initial": 1}],
        state=[{"id": "warm", "initial": False}],
        goals=[{"var": "warm"}, "bake"],
        groups=[{"id": "order", "actions": ["bake", "serve"], "required": False}],
    )
    held = {"oven": 1}
    baked = Entry("bake", 0, 3, held, status="abandoned")
    assert rules(task, baked) == []
    assert rules(task, Entry("bake", 0, 2, held, status="abandoned")) == ["duration"]
    assert rules(task, baked, Entry("dry", 2, 3, held)) == ["capacity"]
    assert rules(task, baked, Entry("mix", 5, 6)) == ["reservoir"]


def test_any_other_status_is_refused_and_one_of_an_unknown_action_explains_nothing() -> None:
    task = task_of({"id": "cut", "duration": 3})
    assert rules(task, Entry("cut", 0, 3, status="running")) == ["status"]
    assert rules(task, Entry("cut", 0, 3), cancelled(0, 1, "ghost")) == ["unknown"]


def test_statuses_survive_json() -> None:
    task, schedule = order(), Schedule((BAKED,))
    from irc.schedule.reading import schedule_from_json

    assert irc.validate(task, schedule_from_json(schedule.to_dict())).valid
