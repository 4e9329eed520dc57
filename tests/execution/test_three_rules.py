"""Three rules of an instant: resources respect ranks, the past comes first, and stock changes one
happening after another."""

from __future__ import annotations

from typing import Any

import pytest

import irc
from irc.execution import Execution, replan, simulate
from irc.model import Event, StateVariable, Task
from irc.schedule import Entry, Schedule
from irc.targets import SolveOptions
from irc.validation import validate
from oracles.state_brute_force import optimum

OPTIONS = SolveOptions(time_limit=3)
PATIENT = SolveOptions(time_limit=20)
"""For a proof by a planner, which takes seconds on a busy machine."""
BRIEF = SolveOptions(time_limit=2)
"""For an answer that no planner can prove to be the best: it takes the whole limit."""
TARGETS = ("cpsat", "pddl21")


def fact(at: str, var: str, value: Any = True) -> dict[str, Any]:
    return {"at": at, "var": var, "value": value}


def press(name: str, duration: int, **fields: Any) -> dict[str, Any]:
    return {"id": name, "duration": duration, "uses": [{"resource": "press"}], **fields}


CHANGEOVER = Task.model_validate(
    {
        "resources": [{"id": "press"}],
        "state": [{"id": "ink", "values": ["black", "red"], "initial": "black"}],
        "actions": [
            press("black", 3, release=5, conditions=[fact("start", "ink", "black")]),
            press("red", 4, conditions=[fact("start", "ink", "red")]),
            press(
                "wash",
                1,
                conditions=[fact("start", "ink", "black")],
                effects=[fact("end", "ink", "red")],
            ),
        ],
    }
)


@pytest.mark.slow
@pytest.mark.parametrize("target", TARGETS)
def test_what_is_freed_at_a_rank_is_taken_at_no_earlier_one(target: str) -> None:
    schedule = irc.solve(CHANGEOVER, target=target, time_limit=3)
    assert schedule.makespan == 13
    assert validate(CHANGEOVER, schedule).valid


def test_the_validator_sees_who_takes_a_resource_before_it_is_free() -> None:
    entries = (
        Entry("wash", 4, 5, {"press": 1}, rank=1),
        Entry("black", 5, 8, {"press": 1}),
        Entry("red", 8, 12, {"press": 1}),
    )
    (violation,) = validate(CHANGEOVER, Schedule(entries)).violations
    assert violation.message == (
        "2 of 'press' are in use at 5 s, in the order of ranks, its capacity then is 1 "
        "(used by 'wash', 'black')"
    )
    unranked = tuple(Entry(e.id, e.start, e.end, e.resources) for e in entries)
    assert "no ranks exist" in validate(CHANGEOVER, Schedule(unranked)).violations[0].message


def test_of_several_units_only_as_many_are_handed_over_as_must_be() -> None:
    """Of two units one is free: who starts before another ends takes that one."""
    task = Task.model_validate(
        {
            "resources": [{"id": "press", "capacity": 2}],
            "state": [{"id": "lit"}],
            "actions": [
                press("weld", 4, conditions=[fact("end", "lit")]),
                press(
                    "match", 2, release=4, effects=[fact("start", "lit"), fact("end", "lit", False)]
                ),
            ],
        }
    )
    schedule = irc.solve(task, time_limit=20)
    assert [(e.id, e.start, e.rank) for e in schedule.entries] == [("weld", 0, 1), ("match", 4, 0)]
    assert validate(task, schedule).valid
    one = task.model_copy(
        update={"resources": (task.resources[0].model_copy(update={"capacity": 1}),)}
    )
    assert irc.solve(one, time_limit=20).status == "infeasible"


def test_a_capacity_that_falls_does_so_behind_all_ranks_of_its_instant() -> None:
    task = Task.model_validate(
        {
            "resources": [{"id": "press", "availability": [{"from": 4, "to": 6, "capacity": 0}]}],
            "state": [{"id": "lit"}],
            "actions": [
                press("weld", 4, conditions=[fact("end", "lit")]),
                {"id": "match", "duration": 1, "effects": [fact("end", "lit")]},
            ],
        }
    )
    entries = (Entry("weld", 0, 4, {"press": 1}, rank=1), Entry("match", 3, 4))
    assert validate(task, Schedule(entries)).valid


def moves(name: str, source: str, target: str) -> dict[str, Any]:
    return {
        "id": name,
        "duration": 4,
        "occurs": {"min": 0, "max": 3},
        "conditions": [fact("start", "cart", source)],
        "effects": [fact("start", "cart", "moving"), fact("end", "cart", target)],
    }


@pytest.mark.slow
@pytest.mark.parametrize("target", TARGETS)
def test_a_change_of_the_world_comes_behind_what_ended_and_binds_what_starts(target: str) -> None:
    task = Task.model_validate(
        {
            "state": [{"id": "cart", "values": ["A", "B", "C", "moving"], "initial": "A"}],
            "actions": [moves("A to B", "A", "B"), moves("B to C", "B", "C")],
            "goals": [{"var": "cart", "value": "C"}],
            "events": [{"at": 4, "changes": [{"op": "set_state", "var": "cart", "value": "A"}]}],
        }
    )
    final = simulate(task, target=target, options=BRIEF).final
    assert final.makespan == 12
    assert [(e.id, e.start) for e in final.entries] == [
        ("A to B", 0),
        ("cart at 4", 4),
        ("A to B", 4),
        ("B to C", 8),
    ]


@pytest.mark.slow
@pytest.mark.parametrize("target", TARGETS)
def test_nobody_walks_through_a_door_that_shut_at_that_instant(target: str) -> None:
    opens = fact("start", "open")
    task = Task.model_validate(
        {
            "state": [{"id": "open", "initial": True}],
            "actions": [
                {"id": "pack", "duration": 2},
                {"id": "walk", "duration": 5, "conditions": [fact("all", "open")]},
                {"id": "fetch key", "duration": 3},
                {
                    "id": "open door",
                    "duration": 1,
                    "occurs": "optional",
                    "conditions": [fact("start", "open", False)],
                    "effects": [{**opens, "at": "end"}],
                },
            ],
            "precedence": [["pack", "walk"], ["fetch key", "open door"]],
            "events": [{"at": 2, "changes": [{"op": "set_state", "var": "open", "value": False}]}],
        }
    )
    assert simulate(task, target=target, options=BRIEF).final.makespan == 9


def test_the_validator_orders_the_instant_of_a_change_of_the_world_by_itself() -> None:
    task = Task.model_validate(
        {
            "state": [{"id": "open", "initial": True}],
            "actions": [
                {"id": "walk", "duration": 5, "conditions": [fact("start", "open")]},
                {
                    "id": "open at 2",
                    "duration": 0,
                    "start": 2,
                    "effects": [fact("start", "open", False)],
                },
            ],
        }
    )
    walks = (Entry("walk", 2, 7), Entry("open at 2", 2, 2, rank=1))
    (violation,) = validate(task, Schedule(walks)).violations
    assert violation.message == (
        "'walk' starts at 2 s with rank 0, before 'open at 2' with rank 1; ends come first, "
        "then changes by events, then starts"
    )
    assert not validate(task, Schedule((walks[0], Entry("open at 2", 2, 2)))).valid
    assert validate(task, Schedule((Entry("walk", 1, 6), Entry("open at 2", 2, 2)))).valid


def test_a_change_of_the_world_is_planned_on_whenever_the_next_plan_comes() -> None:
    task = Task.model_validate({"state": [{"id": "x"}], "actions": [{"id": "a", "duration": 50}]})
    run = Execution(task, irc.solve(task))
    change = {"op": "set_state", "var": "x", "value": True}
    run.apply(Event.model_validate({"at": 1, "changes": [change]}))
    run.advance(2)
    entries = run.replan().schedule.entries
    assert [(e.id, e.start) for e in entries] == [("a", 0), ("x at 1", 1)]


def test_ranks_of_the_past_are_facts() -> None:
    """What ended at 2 with rank 1 keeps it, and what starts then comes no earlier."""
    task = Task.model_validate(
        {
            "state": [{"id": "x"}, {"id": "y"}],
            "actions": [
                {"id": "a", "duration": 2, "effects": [fact("end", "x")]},
                {
                    "id": "b",
                    "duration": 2,
                    "conditions": [fact("end", "x")],
                    "effects": [fact("end", "y")],
                },
                {"id": "c", "duration": 2, "conditions": [fact("start", "y")]},
            ],
        }
    )
    plan = Schedule((Entry("a", 0, 2), Entry("b", 0, 2, rank=1), Entry("c", 2, 4, rank=2)))
    for target in TARGETS:
        step = replan(task, plan, 2, target=target, options=OPTIONS)
        assert [(e.id, e.rank) for e in step.schedule.entries] == [("a", 0), ("b", 1), ("c", 2)]
        later = replan(task, plan, 3, target=target, options=OPTIONS)
        assert [(e.id, e.rank) for e in later.schedule.entries][:2] == [("a", 0), ("b", 1)]


def test_the_rank_of_an_end_that_was_chosen_stays_too() -> None:
    task = Task.model_validate(
        {
            "state": [{"id": "x", "initial": True}],
            "actions": [
                {
                    "id": "b",
                    "duration": {"min": 0, "max": 3},
                    "conditions": [fact("end", "x")],
                },
                {"id": "a", "duration": 2, "effects": [fact("start", "x")]},
                {"id": "c", "duration": 0, "effects": [fact("end", "x")]},
            ],
            "precedence": [["a", "c"]],
        }
    )
    plan = Schedule((Entry("b", 0, 0, end_rank=1), Entry("a", 0, 2), Entry("c", 2, 2)))
    for target in TARGETS:
        found = replan(task, plan, 2, target=target, options=OPTIONS).schedule
        assert validate(task, found).valid
        assert [(e.id, e.rank, e.last_rank) for e in found.entries][:2] == [
            ("b", 0, 1),
            ("a", 0, 0),
        ]


def late_light(**weld: Any) -> dict[str, Any]:
    """A weld that needs light just before its end, which only a lamp that starts then gives."""
    effects = [fact("start", "lit"), fact("end", "lit", False)]
    return {
        "resources": [{"id": "r"}],
        "state": [{"id": "lit"}],
        "actions": [
            {"id": "weld", "duration": 4, "conditions": [fact("end", "lit")], **weld},
            {"id": "lamp", "duration": 2, "effects": effects, "uses": [{"resource": "r"}]},
        ],
    }


@pytest.mark.slow
def test_who_ends_with_a_resource_cannot_wait_for_who_takes_it() -> None:
    """The lamp starts before the weld ends, and takes what the weld frees: there is no plan."""
    task = Task.model_validate(late_light(uses=[{"resource": "r"}]))
    assert optimum(task) is None
    assert irc.solve(task, time_limit=20).status == "infeasible"
    assert irc.solve(task, target="pddl21", time_limit=3).status == "unknown"
    fixed = Task.model_validate(late_light(uses=[{"resource": "r"}], start=0))
    assert optimum(fixed) is None
    assert simulate(fixed, options=OPTIONS).final.status == "infeasible"


@pytest.mark.parametrize("target", TARGETS)
def test_a_plan_made_before_that_was_a_rule_keeps_its_ranks(target: str) -> None:
    """The plan is not valid, but its past is a fact: what ended at rank 1 keeps it."""
    task = Task.model_validate(late_light(uses=[{"resource": "r"}]))
    plan = Schedule((Entry("weld", 0, 4, {"r": 1}, rank=1), Entry("lamp", 4, 6, {"r": 1})))
    assert [v.rule for v in validate(task, plan).violations] == ["capacity"]
    step = replan(task, plan, 4, target=target, options=OPTIONS)
    assert [(e.id, e.start, e.rank) for e in step.schedule.entries] == [
        ("weld", 0, 1),
        ("lamp", 4, 2),
    ]
    verdict = validate(step.task, step.schedule, at=4)
    assert verdict.valid
    assert [v.rule for v in verdict.carried] == ["state"]


@pytest.mark.slow
@pytest.mark.parametrize("target", TARGETS)
def test_what_ended_at_a_rank_keeps_it_without_an_event_and_with_one(target: str) -> None:
    """Without the resource there is a plan, in which the weld ends at rank 1 of instant 4.

    What starts then comes behind it, once 4 is past.
    """
    document = late_light(start=0)
    document["actions"][1]["release"] = 4
    task = Task.model_validate(document)
    plan = irc.solve(task, target=target, time_limit=3)
    assert [(e.id, e.start, e.rank) for e in plan.entries] == [("weld", 0, 1), ("lamp", 4, 0)]
    step = replan(task, plan, 4, target=target, options=OPTIONS)
    assert [(e.id, e.start, e.rank) for e in step.schedule.entries] == [
        ("weld", 0, 1),
        ("lamp", 4, 2),
    ]
    later = replan(task, plan, 5, target=target, options=OPTIONS)
    assert [(e.id, e.rank) for e in later.schedule.entries] == [("weld", 1), ("lamp", 0)]
    tidy = {"op": "add_actions", "actions": [{"id": "tidy", "duration": 1}]}
    noted = Task.model_validate({**document, "events": [{"at": 4, "changes": [tidy]}]})
    final = simulate(noted, target=target, options=OPTIONS).final
    assert [(e.id, e.rank) for e in final.entries] == [("weld", 1), ("tidy", 0), ("lamp", 2)]


def swap(name: str, takes: str, gives: str, **fields: Any) -> dict[str, Any]:
    return {
        "id": name,
        "duration": 0,
        "consumes": [{"resource": takes}],
        "produces": [{"resource": gives}],
        **fields,
    }


def stocks(*actions: dict[str, Any], coins: int = 0, tokens: int = 0) -> Task:
    return Task.model_validate(
        {
            "resources": [
                {"id": "coins", "kind": "reservoir", "initial": coins},
                {"id": "tokens", "kind": "reservoir", "initial": tokens},
            ],
            "actions": list(actions),
        }
    )


BUY, SELL = swap("buy", "coins", "tokens"), swap("sell", "tokens", "coins")


@pytest.mark.parametrize("target", TARGETS)
def test_two_milestones_do_not_pay_each_other_with_what_neither_has(target: str) -> None:
    assert irc.solve(stocks(BUY, SELL), target=target, time_limit=20).status == "infeasible"
    assert irc.solve(stocks(BUY, SELL, coins=1), target=target, time_limit=20).makespan == 0
    assert irc.solve(stocks(BUY, SELL, tokens=1), target=target, time_limit=20).makespan == 0


def test_the_validator_sees_who_pays_with_what_nobody_has() -> None:
    both = Schedule((Entry("buy", 0, 0), Entry("sell", 0, 0)))
    (violation,) = validate(stocks(BUY, SELL), both).violations
    assert violation.message == (
        "no order of 'buy', 'sell' at 0 s keeps 'coins', 'tokens' within bounds"
    )
    assert validate(stocks(BUY, SELL, coins=1), both).valid


def test_a_circle_of_three_needs_one_to_begin_with() -> None:
    third = [
        swap("a", "coins", "tokens"),
        swap("b", "tokens", "notes"),
        swap("c", "notes", "coins", release=3),
    ]
    task = stocks(*third)
    notes = {"id": "notes", "kind": "reservoir"}
    document = task.model_dump(mode="json", by_alias=True, exclude_defaults=True)
    document["resources"] = [*document["resources"], notes]
    assert irc.solve(Task.model_validate(document), time_limit=20).status == "infeasible"
    document["resources"][0]["initial"] = 1
    assert irc.solve(Task.model_validate(document), time_limit=20).makespan == 3


def test_what_one_happening_takes_and_gives_counts_together() -> None:
    again = stocks(swap("again", "coins", "coins"))
    assert irc.solve(again, time_limit=20).makespan == 0


@pytest.mark.parametrize(("room", "makespan"), [(1, None), (3, 0), (4, 0)])
def test_amounts_that_pass_each_other_need_room(room: int, makespan: int | None) -> None:
    """With 1 of at most `room`, 2 are taken and 2 given at once."""
    store = {"id": "store", "kind": "reservoir", "initial": 1, "max": room}
    change = [{"resource": "store", "amount": 2}]
    task = Task.model_validate(
        {
            "resources": [store],
            "actions": [
                {"id": "take", "duration": 0, "consumes": change},
                {"id": "give", "duration": 0, "produces": change},
            ],
        }
    )
    schedule = irc.solve(task, time_limit=20)
    assert (schedule.makespan if schedule.answered else None) == makespan


@pytest.mark.slow
@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("state", [False, True])
@pytest.mark.parametrize(("helped", "status"), [(True, "optimal"), (False, "infeasible")])
def test_what_starts_at_an_event_has_only_the_stock_that_the_past_left(
    helped: bool, status: str, state: bool, target: str
) -> None:
    """The swaps would pay each other with the coin that was spent at this very instant."""
    spent = {"id": "shop", "duration": 4, "consumes": [{"resource": "coins", "at": "end"}]}
    if state:
        spent["effects"] = [fact("start", "open")]
    swaps = [{**BUY, "release": 4}, {**SELL, "release": 4}]
    salary = {"id": "work", "duration": 6, "produces": [{"resource": "coins"}]}
    task = stocks(spent, *swaps, *([salary] if helped else []), coins=1)
    if state:
        task = task.model_copy(update={"state": (StateVariable(id="open"),)})
    paid = (Entry("work", 0, 6),) if helped else ()
    plan = Schedule((Entry("shop", 0, 4), Entry("buy", 4, 4), Entry("sell", 4, 4), *paid))
    assert validate(task, plan).valid
    assert not validate(task, plan, at=4).valid
    step = replan(task, plan, 4, target=target, options=PATIENT)
    assert step.schedule.status == status
    starts = {e.id: e.start for e in step.schedule.entries}
    assert not helped or (starts["buy"], starts["sell"]) == (6, 6)


@pytest.mark.parametrize("target", TARGETS)
def test_an_end_that_is_chosen_at_an_event_may_come_behind_what_starts(target: str) -> None:
    """The store has room only once something is taken: the filling is ended behind that."""
    store = {"id": "store", "kind": "reservoir", "initial": 1, "max": 1}
    fill = {"id": "fill", "duration": {"min": 1, "max": 5}, "produces": [{"resource": "store"}]}
    take = {"id": "take", "duration": 1, "release": 3, "consumes": [{"resource": "store"}]}
    task = Task.model_validate({"resources": [store], "actions": [fill, take]})
    plan = Schedule((Entry("fill", 0, 5), Entry("take", 4, 5)))
    due = {"op": "set_deadline", "action": "fill", "deadline": 3}
    event = Event.model_validate({"at": 3, "changes": [due]})
    step = replan(task, plan, 3, [event], target=target, options=OPTIONS)
    assert [(e.id, e.start, e.end) for e in step.schedule.entries] == [
        ("fill", 0, 3),
        ("take", 3, 4),
    ]
    verdict = validate(step.task, step.schedule, at=3)
    assert verdict.valid
    assert verdict.carried == ()
