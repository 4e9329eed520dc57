"""Set-up time and set-up cost as objectives of `pddl21`, and the search over orders for them."""

from __future__ import annotations

from typing import Any

import pytest

import irc
from builders import Document, lettered, task_of
from irc.diagnostics import InputError
from irc.driver.compile import compile_task
from irc.problem import Problem
from irc.schedule import Schedule
from irc.validation import validate
from irc_pddl21.encoding.encode import encode
from irc_pddl21.encoding.pddl import NumericCondition, NumericEffect
from irc_pddl21.search.orders import OrderSpace

ROWS = [
    {"from": "red", "to": "blue", "time": 4, "cost": 1},
    {"from": "blue", "to": "red", "time": 1, "cost": 7},
    {"from": "red", "to": "red", "cost": 2},
]


def press(name: str = "press", **more: Any) -> Document:
    return {"id": name, "setups": {"times": ROWS, **more}}


def prints(family: str, duration: object = 2, on: str = "press", **more: Any) -> Document:
    return {"duration": duration, "uses": [{"resource": on, "family": family}], **more}


def problem_of(*actions: Document, objective: Any, **more: Any) -> Problem:
    more = {"resources": [press()], **more}
    task = task_of(*lettered(*actions), objective=objective, **more)
    return compile_task(task, "pddl21").problem


def answered(*actions: Document, objective: Any, **more: Any) -> Schedule:
    pytest.importorskip("kairos")
    more = {"resources": [press()], **more}
    task = task_of(*lettered(*actions), objective=objective, **more)
    schedule = irc.solve(task, "pddl21", engine="kairos", time_limit=5, shortcut=False)
    verdict = validate(task, schedule)
    assert verdict.valid
    assert all(verdict.objective[level.name] == level.value for level in schedule.objective)
    return schedule


def values(schedule: Schedule) -> list[object]:
    return [level.value for level in schedule.objective]


# --- the text -----------------------------------------------------------------------------------


def test_the_metric_counts_set_ups() -> None:
    problem = problem_of(prints("red"), prints("blue"), objective="minimize_setup_time")
    found = encode(problem)
    by_name = {o.name: o for o in found.encoding.operators}
    assert found.encoding.metric == "minimize (sum_of_setup_time)"
    change = NumericEffect(False, "sum_of_setup_time", 4)
    assert by_name["setup_press_red_press_blue"].changes == [change]


def test_a_set_up_that_costs_but_takes_no_time_is_an_instant() -> None:
    actions = prints("red"), prints("red"), prints("blue")
    found = encode(problem_of(*actions, objective="minimize_setup_cost"))
    by_name = {o.name: o for o in found.encoding.operators}
    again = by_name["setup_press_red_press_red"]
    assert again.duration is None
    assert again.changes == [NumericEffect(False, "sum_of_setup_cost", 2)]
    assert "ready_press_red" not in again.start_deletes
    assert "ready_press_red" not in by_name["a"].end_adds
    timed = encode(problem_of(*actions, objective="minimize_setup_time")).encoding
    assert "setup_press_red_press_red" not in {o.name for o in timed.operators}


def test_the_metric_of_a_sum_adds_the_total_time() -> None:
    levels = [{"sum": [[3, "minimize_makespan"], [5, "minimize_setup_cost"]]}]
    found = encode(problem_of(prints("red"), prints("blue"), objective=levels))
    counter = "(sum_of_objective)"
    assert found.encoding.metric == f"minimize (+ (* 3 (total-time)) (* {found.scale} {counter}))"
    changes = [c.amount for o in found.encoding.operators for c in o.changes]
    assert sorted(changes) == [5 * 1, 5 * 2, 5 * 7]


def test_a_sum_with_a_part_that_no_metric_says_is_beyond_it() -> None:
    levels = [{"sum": [[1, "minimize_tardiness"], [1, "minimize_setup_cost"]]}]
    found = encode(problem_of(prints("red", due=1), prints("blue"), objective=levels))
    assert found.encoding.metric == "minimize (total-time)"
    assert found.beyond == ("tardiness + setup_cost",)


def test_no_set_up_goes_beyond_a_limit() -> None:
    problem = problem_of(prints("red"), prints("blue"), objective="minimize_makespan")
    found = encode(problem, limits={"setup_time": 3})
    names = {o.name for o in found.encoding.operators}
    assert "setup_press_blue_press_red" in names
    assert "setup_press_red_press_blue" not in names
    (back,) = (o for o in found.encoding.operators if o.name == "setup_press_blue_press_red")
    counter = "sum_of_setup_time_within_a_limit"
    assert back.needs == [NumericCondition("start", "<=", counter, 3 - 1)]


def test_parts_of_a_sum_that_are_not_known_are_refused_at_their_place() -> None:
    levels = [{"sum": [[1, "minimize_earliness"], [1, "minimize_setup_cost"]]}]
    with pytest.raises(InputError) as refused:
        problem_of(prints("red", due=1), objective=levels)
    (error,) = refused.value.report.errors
    assert error.pointer == ("objective",)
    assert "minimize_earliness" in error.message


# --- the orders ---------------------------------------------------------------------------------


def test_the_bounds_of_orders_rise_to_the_values_of_a_whole_order() -> None:
    levels = ["minimize_setup_time", "minimize_makespan"]
    space = OrderSpace(problem_of(prints("red"), prints("blue", 3), objective=levels))
    root = space.decided(space.root)
    assert root is not None
    assert root.bounds == (1, 6)
    found = [space.decided(orders) for orders in space.children(root)]
    assert sorted(d.bounds for d in found if d is not None) == [(1, 6), (4, 9)]


def test_an_order_against_precedence_has_no_times() -> None:
    arcs = [["a", "b"]]
    actions = prints("red"), prints("blue")
    space = OrderSpace(problem_of(*actions, objective="minimize_setup_time", precedence=arcs))
    root = space.decided(space.root)
    assert root is not None
    assert [space.decided(o) is None for o in space.children(root)] == [False, True]


def test_a_use_that_may_take_no_time_may_need_no_set_up() -> None:
    actions = prints("red"), prints("blue", {"min": 0, "max": 3})
    schedule = answered(*actions, objective=["minimize_setup_cost", "minimize_makespan"])
    assert (schedule.status, values(schedule)) == ("optimal", [0, 2])


# --- answers ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("objective", "least"), [("minimize_setup_time", 1), ("minimize_setup_cost", 1)]
)
def test_set_ups_alone_are_minimised_with_a_proof(objective: str, least: int) -> None:
    schedule = answered(prints("red"), prints("blue"), objective=objective)
    assert schedule.status == "optimal"
    assert values(schedule) == [least]
    assert schedule.objective[0].bound == least


def test_set_ups_are_one_level_among_others() -> None:
    actions = prints("red"), prints("blue", due=2), prints("red", release=9)
    levels = ["minimize_tardiness", "minimize_setup_cost", "minimize_makespan"]
    schedule = answered(*actions, objective=levels)
    # (Blue is first, so that the way back costs 7, and red after red 2.)
    assert (schedule.status, values(schedule)) == ("optimal", [0, 9, 11])


@pytest.mark.parametrize(("weight", "first", "value"), [(1, "a", 8 + 1), (3, "b", 3 * 5 + 7)])
def test_a_sum_weighs_set_ups_against_time(weight: int, first: str, value: int) -> None:
    levels = [{"sum": [[weight, "minimize_makespan"], [1, "minimize_setup_cost"]]}]
    schedule = answered(prints("red"), prints("blue"), objective=levels)
    assert (schedule.status, values(schedule)) == ("optimal", [value])
    assert schedule[first].start == 0


def test_uses_choose_the_machine_that_saves_a_set_up() -> None:
    either = {"uses": [{"one_of": ["press", "other"], "family": "red"}]}
    machines = [press(initial="blue"), press("other", initial="red")]
    actions = [prints("blue"), either]
    schedule = answered(*actions, objective="minimize_setup_cost", resources=machines)
    assert (schedule.status, values(schedule)) == ("optimal", [2])
    assert schedule["b"].resources == {"other": 1}


def test_trains_that_wait_in_their_blocks_follow_each_other() -> None:
    """Chains without gaps between them: one way first, and then the trains of the other."""
    headways = [
        {"from": "east", "to": "east", "time": 2},
        {"from": "*", "to": "*", "time": 4},
    ]
    blocks: list[Document] = [{"id": b, "setups": {"times": headways}} for b in ("track", "gate")]
    ways = [("a", "b", "east"), ("c", "d", "east"), ("f", "e", "west")]
    actions = [
        {"id": name, "duration": {"min": 3, "max": 20}, "uses": [{"resource": b, "family": way}]}
        for first, second, way in ways
        for name, b in ((first, "track"), (second, "gate"))
    ]
    arcs = [{"before": x, "after": y, "min_lag": 0, "max_lag": 0} for x, y in ("ab", "cd", "ef")]
    task = task_of(*actions, resources=blocks, precedence=arcs)
    pytest.importorskip("kairos")
    schedule = irc.solve(task, "pddl21", engine="kairos", time_limit=8)
    assert (schedule.status, schedule.makespan) == ("optimal", 6 + 4 + 3 + 2 + 3 + 3)
