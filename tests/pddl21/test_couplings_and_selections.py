"""Couplings and selections in PDDL2.1 text, and what a planner makes of them."""

from __future__ import annotations

from typing import Any

import pytest

import irc
from builders import Document, lettered, task_of
from irc.driver.compile import compile_task
from irc.problem import Problem
from irc.schedule import Schedule, Status
from irc.validation import validate
from irc_pddl21.encoding.encode import encode
from irc_pddl21.encoding.pddl import Operator
from irc_pddl21.search.selection import SelectionSpace, breaks_selections, optional_items
from irc_pddl21.search.selection_tree import SelectionTree

ROBOTS: list[Document] = [{"id": "r1"}, {"id": "r2"}]
EITHER: Document = {"duration": 2, "uses": [{"one_of": ["r1", "r2"]}]}
OPTIONAL: Document = {"duration": 2, "occurs": "optional"}


def problem_of(*actions: Document, **more: Any) -> Problem:
    return compile_task(task_of(*lettered(*actions), **more), "pddl21").problem


def operators(problem: Problem) -> dict[str, Operator]:
    return {o.name: o for o in encode(problem).encoding.operators}


def planned(*actions: Document, **more: Any) -> Schedule:
    pytest.importorskip("kairos")
    task = task_of(*lettered(*actions), **more)
    schedule = irc.solve(task, "pddl21", engine="kairos", time_limit=5, shortcut=False)
    assert schedule.status is Status.UNKNOWN or validate(task, schedule).valid
    return schedule


def clash(one: Operator, other: Operator) -> bool:
    """Whether couplings let each of two operators take away what the other one needs."""
    return all(
        any(
            fact in after.at_start and not fact.startswith("free_") for fact in before.start_deletes
        )
        for before, after in ((one, other), (other, one))
    )


@pytest.mark.parametrize(("kind", "together"), [("same", "r1"), ("different", "r2")])
def test_ways_that_break_a_coupling_exclude_each_other(kind: str, together: str) -> None:
    problem = problem_of(
        EITHER, EITHER, resources=ROBOTS, couplings=[{kind: "resource", "actions": ["a", "b"]}]
    )
    found = operators(problem)
    for robot in ("r1", "r2"):
        excluded = clash(found["a__r1_1"], found[f"b__{robot}_1"])
        assert excluded == (robot != together)


def test_an_if_that_holds_and_a_then_that_fails_exclude_each_other() -> None:
    modes = [{"id": "slow", "duration": 3}, {"id": "quick", "duration": 1}]
    coupling = {"if": {"action": "a", "mode": "slow"}, "then": {"action": "b", "mode": "quick"}}
    found = operators(problem_of({"modes": modes}, {"modes": modes}, couplings=[coupling]))
    assert clash(found["a__slow"], found["b__slow"])
    assert not clash(found["a__slow"], found["b__quick"])
    assert not clash(found["a__quick"], found["b__slow"])


def test_a_way_that_breaks_a_coupling_alone_is_not_written() -> None:
    action = {"duration": 2, "uses": [{"one_of": ["r1", "r2"]}, {"one_of": ["r1", "r2"]}]}
    members = [{"action": "a", "use": 0}, {"action": "a", "use": 1}]
    coupling = {"different": "resource", "actions": members}
    wide = [{"id": "r1", "capacity": 2}, {"id": "r2", "capacity": 2}]
    found = operators(problem_of(action, resources=wide, couplings=[coupling]))
    assert found
    assert all("r1" in name and "r2" in name for name in found)


def test_what_takes_no_time_chooses_without_taking_a_unit() -> None:
    moment = {"duration": 0, "uses": [{"one_of": ["r1", "r2"]}]}
    coupling = {"same": "resource", "actions": ["a", "b"]}
    found = operators(problem_of(moment, EITHER, resources=ROBOTS, couplings=[coupling]))
    instants = [o for o in found.values() if o.duration is None]
    assert len(instants) == 2
    assert not any(fact.startswith("free_") for o in instants for fact in o.at_start)


def test_a_planner_keeps_couplings() -> None:
    schedule = planned(
        EITHER,
        EITHER,
        EITHER,
        resources=ROBOTS,
        couplings=[
            {"same": "resource", "actions": ["a", "b"]},
            {"different": "resource", "actions": ["b", "c"]},
        ],
    )
    assert schedule.makespan == 4


def test_limits_of_a_selection_are_a_counter_in_the_goal() -> None:
    problem = problem_of(
        OPTIONAL, OPTIONAL, OPTIONAL, select=[{"actions": ["a", "b", "c"], "min": 1, "max": 2}]
    )
    encoding = encode(problem).encoding
    (counter,) = encoding.counters
    assert [(n.relation, n.amount) for n in encoding.numeric_goal] == [(">=", 1), ("<=", 2)]
    assert all(
        [(n.relation, n.amount) for n in o.needs] == [("<=", 1)]
        and [(c.counter, c.amount) for c in o.changes] == [(counter, 1)]
        for o in encoding.operators
    )


def test_what_is_decided_is_not_counted() -> None:
    problem = problem_of(OPTIONAL, {"duration": 1}, select=[{"actions": ["a", "b"], "min": 1}])
    assert not encode(problem).encoding.counters


@pytest.mark.parametrize(
    ("rule", "forced", "there"),
    [
        ({"actions": ["a", "b"], "min": 1, "max": 1}, [], 1),
        ({"actions": ["a", "b"], "all_or_none": True}, ["a"], 2),
        ({"actions": ["a", "b"], "all_or_none": True}, [], 0),
        ({"actions": ["a", "b"], "min": 2, "if": "c"}, ["c"], 3),
        ({"actions": ["a", "b"], "min": 2, "if": "c"}, ["a"], 1),
        ({"actions": ["a", "b"], "max": 1, "if": "c"}, ["a", "b"], 2),
    ],
)
def test_a_planner_keeps_selections(rule: Document, forced: list[str], there: int) -> None:
    schedule = planned(OPTIONAL, OPTIONAL, OPTIONAL, select=[rule], goals=forced)
    assert len(schedule.entries) == there


def test_a_selection_that_nothing_can_keep_is_refuted_and_not_called_infeasible() -> None:
    rule = {"actions": ["a", "b"], "max": 1}
    problem = problem_of({"duration": 1}, {"duration": 1}, OPTIONAL, select=[rule])
    assert breaks_selections(problem)


def test_a_branch_is_not_cut_where_an_undecided_item_may_repair_it() -> None:
    rule = {"actions": ["a", "b"], "all_or_none": True}
    problem = problem_of(
        {**OPTIONAL, "reward": 5},
        {**OPTIONAL, "reward": 1},
        select=[rule],
        objective="maximize_reward",
    )
    items, _, _ = optional_items(problem, ("reward",))
    leaves = [leaf for _, leaf in SelectionTree(SelectionSpace(problem, items)).falling()]
    assert frozenset([0, 1]) in leaves
