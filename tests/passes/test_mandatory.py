"""What every schedule contains: a relaxation that bounds can count on."""

from __future__ import annotations

import pytest

from builders import act, problem_of
from irc.lowering.lower import lower
from irc.passes import run_passes
from irc.passes.mandatory import MOST_REPEATED, mandatory_part
from irc.problem import PLAIN, Arc
from oracles.state_brute_force import optimum
from oracles.state_generators import state_task


def test_a_plain_problem_is_its_own_mandatory_part() -> None:
    problem = problem_of(act("a"), act("b"), precedence=[["a", "b"]])
    assert mandatory_part(problem)[0] is problem


def test_what_may_be_absent_goes_with_the_arcs_that_touch_it() -> None:
    problem = problem_of(
        act("a"),
        act("b", occurs="optional"),
        act("c"),
        act("d"),
        groups=[{"id": "g", "actions": ["d"], "required": False}],
        precedence=[["a", "b"], ["b", "c"], ["a", "c"], ["c", "d"]],
    )
    core, way = mandatory_part(problem)
    assert [a.id for a in core.activities] == ["a", "c"]
    assert [(arc.before, arc.after) for arc in core.arcs] == [(0, 1)]
    assert way.activities.new == {0: 0, 2: 1}


def test_a_required_group_makes_its_optional_members_mandatory() -> None:
    groups = [{"id": "g", "actions": ["a"], "required": True}]
    core, _ = mandatory_part(problem_of(act("a", occurs="optional"), groups=groups))
    assert [a.id for a in core.activities] == ["a"]


def test_the_least_number_of_occurrences_comes_one_after_the_other() -> None:
    problem = problem_of(act("a", occurs={"min": 3}), act("b"))
    core, way = mandatory_part(problem)
    assert [a.id for a in core.activities] == ["a", "a", "a", "b"]
    assert core.arcs == (Arc(0, 1, origin=-1), Arc(1, 2, origin=-1))
    assert way.activities.new == {0: 0, 1: 3}
    assert run_passes(problem).bounds.makespan.value == 3  # In ticks of 2.


def test_a_great_number_of_occurrences_costs_no_more_than_the_limit() -> None:
    core, _ = mandatory_part(problem_of(act("a", occurs={"min": 10**12})))
    assert len(core.activities) == MOST_REPEATED


def test_of_modes_the_shortest_and_what_all_hold_remain() -> None:
    modes = [
        {"id": "slow", "duration": 6},
        {"id": "fast", "duration": 4, "uses": [{"resource": "oven"}]},
    ]
    problem = problem_of(
        {"id": "a", "uses": [{"resource": "cook"}], "modes": modes},
        act("b", uses=[{"resource": "oven"}, {"resource": "cook"}]),
        resources=[{"id": "cook"}, {"id": "oven"}],
    )
    (a, b) = mandatory_part(problem)[0].activities
    assert (a.duration_min, a.duration_max, a.details) == (2, 3, PLAIN)
    assert [use.alternatives for use in a.uses] == [(0,)]
    assert [claim.alternatives for claim in a.open_demands] == [(0,)]
    assert len(b.open_demands) == 2


def test_of_a_calendar_the_greatest_capacity_remains() -> None:
    windows = [{"from": 0, "to": 2, "capacity": 3}, {"from": 2, "to": 4, "capacity": 0}]
    problem = problem_of(
        act("a", uses=[{"resource": "oven"}]),
        resources=[{"id": "oven", "capacity": 2, "availability": windows}],
    )
    core, _ = mandatory_part(problem)
    assert [(r.capacity, r.windows) for r in core.resources] == [(3, ())]
    assert [(s.capacity, s.windows) for s in core.contention.pools] == [(3, ())]


@pytest.mark.slow
@pytest.mark.parametrize("batch", range(4))
def test_no_schedule_is_shorter_than_the_bound_of_the_mandatory_part(batch: int) -> None:
    """Of random tasks of which the makespan is what counts first."""
    judged = 0
    for seed in range(batch, 80, 4):
        task = state_task(seed)
        if task.objective[0] != "minimize_makespan":
            continue
        best = optimum(task)
        if best is not None:
            problem = run_passes(lower(task))
            assert problem.to_units(problem.bounds.makespan.value) <= best.vector[0], seed
            judged += problem.bounds.makespan.value > 0
    assert judged > 2
