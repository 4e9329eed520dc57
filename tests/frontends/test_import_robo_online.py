"""The importer of Online Robo Challenge: an episode is a task at t = 0 and events, exactly as told.

What is revealed at a moment is modelled at that moment; the task before does not show it.
"""

from __future__ import annotations

import json
from copy import deepcopy
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

import irc
from irc.diagnostics import Code, InputError
from irc.events.apply import apply
from irc.frontends.importers.robo_online import import_robo_online
from irc.model import Event, Task

Raw = dict[str, Any]

OKRA = {"state": "raw", "predicates": ["iscuttable", "isfryableifcut"], "fry_requires_cut": True}
KITCHEN: Raw = {
    "items": {
        "okra": OKRA,
        "leek": {"state": "raw", "predicates": ["iscuttable"]},
        "plate": {"state": "ready", "predicates": []},
    },
    "action_durations": {"cut": 3.0, "fry": 8.0, "stack": 1.0, "boil": 12},
    "stations": {"cutting_board": 1, "fryer": 1, "toaster": 1},
}
ORDER = {"id": "first", "required_states": {"okra": "cut"}, "stack_order": ["plate", "okra"]}


def delta(at: Any = 2.5, name: str = "e", **fields: Any) -> Raw:
    return {"id": name, "trigger_time": at, "type": "add_delivery", "delta": fields}


def delivery(name: str, item: str, state: str, **fields: Any) -> Raw:
    return {"id": name, "required_states": {item: state}, **fields}


def episode(*events: Raw, **initial: Any) -> Raw:
    start = {**KITCHEN, "deliveries": [ORDER], **initial}
    return deepcopy({"id": "lunch", "initial_task": start, "events": list(events)})


def imported(raw: Raw) -> Task:
    ((_, task),) = import_robo_online(json.dumps(raw), "lunch.json")
    assert irc.check(task).ok, irc.check(task).render()
    return task


def faults(raw: Raw) -> dict[str, str]:
    """Pointer → message, each a located finding of the importer."""
    text = json.dumps(raw, indent=1)
    with pytest.raises(InputError) as error:
        list(import_robo_online(text, "lunch.json"))
    found = error.value.report.located()
    assert len(list(found)) == len({d.pointer for d in found}), "a fault is told twice"
    assert {(d.code, d.line is not None) for d in found} == {(Code.NOT_AN_IMPORT, True)}
    return {d.to_dict()["pointer"]: d.message for d in found}


def changes(event: Event) -> dict[str, Any]:
    return {change.op: change for change in event.changes}


def revised(task: Task) -> Task:
    """The task after all of its events, each of which must leave a sound one."""
    for event in sorted(task.events, key=lambda event: task.number(event.at)):
        task = apply(task, event)
        assert irc.check(task).ok, irc.check(task).render()
    return task


# --- the benchmark ------------------------------------------------------------------------------


def episodes(shared_data: Path) -> list[tuple[Raw, Task]]:
    return [
        (json.loads(path.read_text("utf-8")), task)
        for path in sorted((shared_data / "robo_online").glob("*.json"))
        for _, task in import_robo_online(path.read_text("utf-8"), path.name)
    ]


@pytest.mark.slow
@pytest.mark.shared_data
def test_every_episode_is_a_sound_task_before_and_after_each_event(shared_data: Path) -> None:
    read = episodes(shared_data)
    assert len(read) == 70
    for raw, task in read:
        assert list(irc.check(task)) == [], irc.check(task).render()
        assert [(e.id, e.at) for e in task.events] == [
            (e["id"], Fraction(str(e["trigger_time"]))) for e in raw["events"]
        ]
        last = revised(task)
        items = {**raw["initial_task"]["items"], **_all(raw, "add_items")}
        idle = set(task.metadata.get("items_without_a_goal", ()))
        assert {action.id.partition("_")[2] for action in last.actions} == items.keys() - idle
        assert len(last.groups) == sum(
            len(d.get(key) or ())
            for d in (raw["initial_task"], *(e["delta"] for e in raw["events"]))
            for key in ("candidate_goals", "add_candidate_goals")
        )


def _all(raw: Raw, field: str) -> Raw:
    return {k: v for e in raw["events"] for k, v in (e["delta"].get(field) or {}).items()}


@pytest.mark.slow
@pytest.mark.shared_data
def test_the_known_optima_are_those_of_the_tasks_before_any_event(shared_data: Path) -> None:
    """The benchmark's candidate menus had a deadline, which their episodes leave out."""
    for _, task in episodes(shared_data):
        known = task.metadata["oracle"]
        if reward := known.get("source_optimal_reward"):
            task = task.model_copy(update={"deadline": int(known["source_optimal_makespan"])})
        schedule = irc.solve(task, workers=1)
        values = {value.name: value.value for value in schedule.objective}
        assert schedule.status == "optimal"
        assert values["makespan"] == known["source_optimal_makespan"]
        assert values.get("reward") == reward


# --- nothing is foreseen ------------------------------------------------------------------------


def test_the_task_at_first_is_that_of_an_episode_without_its_events() -> None:
    later = delta(
        add_deliveries=[delivery("second", "okra", "fried"), delivery("3", "leek", "cut")]
    )
    with_events, without = imported(episode(later)), imported(episode())
    for field in ("state", "actions", "precedence", "groups", "goals", "objective", "deadline"):
        assert getattr(with_events, field) == getattr(without, field), field
    assert [r.id for r in with_events.resources] == ["cutting_board", "fryer"]
    assert with_events.metadata["unused_stations"] == ["toaster"]


def test_an_item_is_processed_further_than_its_first_order_asked_for() -> None:
    task = imported(episode(delta(add_deliveries=[delivery("second", "okra", "fried")])))
    assert task.state[0].values == ("raw", "cut", "toasted", "fried")
    assert task.goals[0].value == "cut"  # type: ignore[union-attr]
    last = revised(task)
    assert [a.id for a in last.actions] == ["cut_okra", "stack_plate", "stack_okra", "fry_okra"]
    assert [goal.value for goal in last.goals] == ["fried"]  # type: ignore[union-attr]
    assert irc.solve(last).makespan == 11  # The okra is upon the plate before it is fried.


def test_an_item_that_nobody_wanted_gets_its_variable_when_somebody_does() -> None:
    task = imported(episode(delta(add_deliveries=[delivery("second", "leek", "cut")])))
    (event,) = task.events
    assert list(changes(event)) == ["add_state", "add_actions", "set_goals"]
    assert [v.id for v in changes(event)["add_state"].state] == ["leek"]
    assert [goal.var for goal in changes(event)["set_goals"].goals] == ["okra", "leek"]


def test_what_is_already_wanted_adds_nothing() -> None:
    task = imported(episode(delta(add_deliveries=[delivery("second", "okra", "cut")])))
    assert task.events == (Event(id="e", at=Fraction("2.5"), changes=()),)


# --- times --------------------------------------------------------------------------------------


def test_events_come_in_the_order_of_their_exact_times_and_else_of_the_file() -> None:
    onion = {"add_items": {"onion": OKRA}, "add_deliveries": [delivery("a", "onion", "cut")]}
    raw = episode(
        delta(2.29, "b", add_deliveries=[delivery("b", "onion", "fried")]),
        delta(2.29, "c", add_deliveries=[delivery("c", "leek", "cut")]),
        delta(0.1, "a", **onion),
    )
    task = imported(raw)
    assert [(e.id, e.at) for e in task.events] == [
        ("a", Fraction(1, 10)),
        ("b", Fraction(229, 100)),
        ("c", Fraction(229, 100)),
    ]
    assert [a.id for a in revised(task).actions][3:] == ["cut_onion", "fry_onion", "cut_leek"]


def test_deadlines_of_the_task_and_of_an_order_are_taken() -> None:
    late = delivery("second", "okra", "fried", deadline=40.5, stack_order=None)
    task = imported(episode(delta(set_deadline=60, add_deliveries=[late]), deadline=50))
    (event,) = task.events
    assert (task.deadline, changes(event)["set_deadline"].deadline) == (50, 60)
    (group,) = changes(event)["add_groups"].groups
    assert (group.required, group.deadline) == (True, Fraction(81, 2))
    assert group.actions == ("cut_okra", "fry_okra")


def test_lags_may_reach_back_to_earlier_work() -> None:
    lag = {
        "before": {"action": "stack", "item": "okra"},
        "after": {"action": "cut", "item": "leek"},
        "min_lag": 2,
        "max_lag": 4.5,
    }
    leek = [delivery("second", "leek", "cut")]
    task = imported(episode(delta(add_deliveries=leek, add_temporal_constraints=[lag, lag])))
    (edge,) = changes(task.events[0])["add_precedence"].precedence
    assert (edge.before, edge.after) == ("stack_okra", "cut_leek")
    assert (edge.min_lag, edge.max_lag) == (2, Fraction(9, 2))


def test_null_is_nothing() -> None:
    fields = ("add_items", "add_deliveries", "add_candidate_goals", "add_temporal_constraints")
    raw = episode(
        delta(**dict.fromkeys(fields), set_deadline=None),
        **dict.fromkeys(("robots", "temporal_constraints", "candidate_goals", "inventory_limits")),
        deadline=None,
    )
    assert imported(raw).events[0].changes == ()
    assert imported({**raw, "events": None}).events == ()


# --- what may be left alone ---------------------------------------------------------------------


def candidate(name: str, item: str, state: str, reward: int = 5, **cost: int) -> Raw:
    return {"id": name, "item": item, "state": state, "reward": reward, "cost": cost}


def test_a_delivery_with_a_reward_is_an_optional_order() -> None:
    dish = delivery("treat", "leek", "cut", stack_order=["leek"], reward=7, deadline=20)
    task = imported(episode(delta(add_deliveries=[dish]), robots=["r1", "r2"]))
    assert task.objective == ("minimize_makespan",)
    by_op = changes(task.events[0])
    (group,) = by_op["add_groups"].groups
    assert (group.id, group.required, group.reward, group.deadline) == ("treat", False, 7, 20)
    assert group.actions == ("cut_leek", "stack_leek")
    assert "set_goals" not in by_op
    assert by_op["set_objective"].objective == ("maximize_reward", "minimize_makespan")
    assert irc.solve(revised(task)).objective[0].value == 7


def test_a_candidate_of_an_event_takes_its_cost_out_of_the_stock_that_was_there() -> None:
    raw = episode(
        delta(1, "e1", add_candidate_goals=[candidate("b", "leek", "cut", 9, root=1)]),
        candidate_goals=[candidate("a", "okra", "fried", 4, root=1)],
        inventory_limits={"root": 1, "oil": 3},
        deliveries=[],
        robots=["r1"],
    )
    task = imported(raw)
    stock = task.resources[-1]
    assert (stock.id, stock.initial) == ("root", 1)
    assert task.metadata["unused_stocks"] == ["oil"]
    schedule = irc.solve(revised(task))
    assert [entry.id for entry in schedule.entries] == ["cut_leek"]
    assert irc.solve(task).objective[0].value == 4


def test_an_obligation_makes_a_choice_of_before_certain() -> None:
    raw = episode(
        delta(add_deliveries=[delivery("must", "okra", "fried", deadline=30)]),
        deliveries=[],
        candidate_goals=[candidate("may", "okra", "cut", 0)],
    )
    task = imported(raw)
    assert [entry.id for entry in irc.solve(task).entries] == []
    assert [entry.id for entry in irc.solve(revised(task)).entries] == ["cut_okra", "fry_okra"]


def test_a_choice_may_take_an_obligation_further() -> None:
    more = [candidate("more", "okra", "fried", 5)]
    task = imported(episode(delta(add_candidate_goals=more)))
    assert changes(task.events[0])["set_goals"].goals == ()
    last = revised(task)
    assert irc.solve(last).objective[0].value == 5
    short = last.model_copy(update={"deadline": 5})
    assert {e.id for e in irc.solve(short).entries} == {"cut_okra", "stack_plate", "stack_okra"}


# --- bad input ----------------------------------------------------------------------------------

ADDED = "/events/0/delta"
LAG = {
    "before": {"action": "cut", "item": "okra"},
    "after": {"action": "cut", "item": "leek"},
}


@pytest.mark.parametrize(
    ("raw", "pointer", "message"),
    [
        (episode(delta(-1)), "/events/0/trigger_time", "expected a time of 0 or more, found -1"),
        (episode(delta("soon")), "/events/0/trigger_time", "soon"),
        (episode(delta(None)), "/events/0", "the field 'trigger_time' is missing"),
        (episode(delta(1), delta(2)), "/events/1/id", "the event 'e' is given twice"),
        (episode({"id": "e", "trigger_time": 1}), "/events/0", "the field 'delta' is missing"),
        (episode(delta(add_item={})), f"{ADDED}/add_item", "does not know the field"),
        (
            episode(delta(add_items={"okra": OKRA})),
            f"{ADDED}/add_items/okra",
            "item 'okra' is already there",
        ),
        (
            episode(delta(add_deliveries=[delivery("x", "lek", "cut")])),
            f"{ADDED}/add_deliveries/0/required_states/lek",
            "there is no item 'lek'",
        ),
        (
            episode(
                delta(5, "late", add_items={"onion": OKRA}),
                delta(4, "early", add_deliveries=[delivery("x", "onion", "cut")]),
            ),
            "/events/1/delta/add_deliveries/0/required_states/onion",
            "there is no item 'onion'",
        ),
        (
            episode(delta(add_deliveries=[delivery("first", "leek", "cut")])),
            f"{ADDED}/add_deliveries/0",
            "the order 'first' already exists",
        ),
        (
            episode(delta(add_candidate_goals=[candidate("first", "leek", "cut")])),
            f"{ADDED}/add_candidate_goals/0",
            "the order 'first' already exists",
        ),
        (
            episode(delta(add_deliveries=[delivery("x", "leek", "fried")])),
            f"{ADDED}/add_deliveries/0/required_states/leek",
            "item 'leek' cannot become 'fried' from its state 'raw'; it cannot be fried",
        ),
        (
            episode(delta(add_deliveries=[delivery("x", "okra", "raw")])),
            f"{ADDED}/add_deliveries/0/required_states/okra",
            "an earlier goal takes it to 'cut', and no processing leads from there to 'raw'",
        ),
        (
            episode(
                delta(add_deliveries=[delivery("x", "leek", "raw"), delivery("y", "leek", "cut")])
            ),
            f"{ADDED}/add_deliveries/1/required_states/leek",
            "item 'leek' is wanted 'raw' at the same moment",
        ),
        (
            episode(delta(add_deliveries=[{"id": "x", "stack_order": ["leek", "okra"]}])),
            f"{ADDED}/add_deliveries/0/stack_order/1",
            "item 'okra' is already stacked by another order",
        ),
        (
            episode(delta(add_deliveries=[delivery("x", "okra", "toasted")], set_deadline=-2)),
            f"{ADDED}/set_deadline",
            "expected a time of 0 or more",
        ),
        (
            episode(delta(add_deliveries=[delivery("x", "leek", "toasted")])),
            f"{ADDED}/add_deliveries/0/required_states/leek",
            "'action_durations' has no 'toast', which 'leek' needs",
        ),
        (
            episode(
                delta(add_deliveries=[delivery("x", "okra", "fried")]),
                stations={"cutting_board": 1},
            ),
            f"{ADDED}/add_deliveries/0/required_states/okra",
            "there is no station 'fryer' to fry 'okra'",
        ),
        (
            episode(delta(add_temporal_constraints=[LAG])),
            f"{ADDED}/add_temporal_constraints/0",
            "no goal needs the action",
        ),
        (
            episode(
                delta(add_temporal_constraints=[{"before": LAG["before"], "after": LAG["before"]}])
            ),
            f"{ADDED}/add_temporal_constraints/0",
            "the action 'cut_okra' cannot be timed after itself",
        ),
        (
            episode(delta(add_candidate_goals=[candidate("c", "leek", "fried")])),
            f"{ADDED}/add_candidate_goals/0",
            "it cannot be fried",
        ),
        (episode(delta(add_items={"": OKRA})), f"{ADDED}/add_items/", "must not be empty"),
        (
            episode(delta(add_candidate_goals=[candidate("c", "leek", "cut", root=1)])),
            f"{ADDED}/add_candidate_goals/0",
            "'inventory_limits' has no 'root', which this order costs",
        ),
        (
            episode(delta(add_candidate_goals=[candidate("c", "okra", "cut")])),
            f"{ADDED}/add_candidate_goals/0",
            "it is fulfilled already, so there is nothing to choose",
        ),
        (
            episode(
                delta(add_deliveries=[{"id": "x", "stack_order": ["leek"]}]),
                candidate_goals=[candidate("c", "leek", "cut")],
            ),
            f"{ADDED}/add_deliveries/0/stack_order/0",
            "whether 'leek' is 'cut' is left to another order",
        ),
        (
            episode(
                delta(
                    add_deliveries=[
                        {
                            "id": "x",
                            "required_states": {"leek": "cut", "okra": "fried"},
                            "reward": 3,
                        }
                    ]
                ),
                candidate_goals=[candidate("c", "leek", "cut")],
            ),
            f"{ADDED}/add_deliveries/0/required_states/leek",
            "another goal makes 'leek' 'cut' already",
        ),
    ],
)
def test_a_fault_is_told_where_it_stands(raw: Raw, pointer: str, message: str) -> None:
    found = faults(raw)
    assert pointer in found, found
    assert message in found[pointer]


def test_faults_of_several_events_come_at_once() -> None:
    bad = [delta(i, f"e{i}", add_deliveries=[delivery(f"d{i}", "leek", "fried")]) for i in (3, 1)]
    assert len(faults(episode(*bad))) == 2
