"""The schedule by rule, and the horizon: valid, and never better than the optimum."""

from __future__ import annotations

import random
from typing import Any

import pytest

from builders import lettered, task_of, with_heads_and_tails
from irc.lowering.lower import lower
from irc.model import Task
from irc.passes import run_passes
from irc.passes.serial_sgs import list_schedule
from irc.problem import Problem
from irc.problem.decisions import Decision, Placed
from irc.problem.horizon import safe_horizon
from irc.retiming.retime import retime
from irc.retiming.to_schedule import schedule_of
from irc.validation import validate
from oracles.brute_force import optimal_makespan
from oracles.generators import big_capacity_task, contended_task, random_task


def problem_of(*actions: dict[str, Any], **more: Any) -> Problem:
    return with_heads_and_tails(task_of(*lettered(*actions), **more))


def random_tasks(count: int) -> list[Task]:
    tasks = []
    for seed in range(count):
        rng = random.Random(f"list {seed}")
        kinds = (random_task, big_capacity_task, lambda rng: contended_task(rng, 8))
        tasks.append(kinds[seed % 3](rng))
    return tasks


@pytest.mark.slow
def test_what_the_rule_finds_is_valid_and_never_better_than_the_optimum() -> None:
    found_ones = 0
    for task in random_tasks(150):
        best = optimal_makespan(task)
        try:
            problem = with_heads_and_tails(task)
        except ValueError:
            assert best is None
            continue
        found = list_schedule(problem)
        if found is None:
            continue
        placed = [
            Placed(int(d.start), int(d.end), taken(problem, i, choice))
            for i, (d, choice) in enumerate(zip(*found, strict=True))
        ]
        schedule = schedule_of(problem, placed)
        assert validate(task, schedule).valid
        assert best is not None
        assert schedule.makespan >= best
        found_ones += 1
    assert found_ones > 100


def taken(problem: Problem, i: int, choice: tuple[int, ...]) -> tuple[int, ...]:
    """What has no length claims nothing, but names its resources all the same."""
    if not choice:
        return tuple(use.alternatives[0] for use in problem.activities[i].uses)
    return tuple(problem.contention.pools[shared].members[0] for shared in choice)


@pytest.mark.slow
def test_with_pools_the_rule_keeps_the_summed_capacity() -> None:
    pooled = 0
    for seed in range(60):
        task = contended_task(random.Random(f"pools {seed}"), 6 + seed % 9)
        problem = run_passes(lower(task))
        pooled += any(len(shared.members) > 1 for shared in problem.contention.pools)
        found = list_schedule(problem)
        assert found is not None
        decisions = [Decision(d.start, d.end) for d in found[0]]
        placed = retime(problem, decisions)
        assert validate(task, schedule_of(problem, placed)).valid
        assert max(p.end for p in placed) <= max(d.end for d in decisions)
    assert pooled > 30


def test_without_contention_the_rule_is_the_critical_path() -> None:
    off = dict.fromkeys(("max_lags", "windows", "fixed_starts", "task_deadline", "ranges"), False)
    for seed in range(60):
        task = random_task(random.Random(seed), resources=(0, 0), tighten=0.0, **off)
        problem = with_heads_and_tails(task)
        found = list_schedule(problem)
        assert found is not None
        assert tuple(d.start for d in found[0]) == problem.bounds.heads
        assert max(d.end for d in found[0]) == problem.bounds.makespan.value


def test_the_longest_way_to_the_end_goes_first() -> None:
    use = {"uses": [{"resource": "r"}]}
    problem = problem_of(
        use,
        {**use, "duration": 4},
        {"duration": 9},
        precedence=[["a", "c"]],
        resources=[{"id": "r"}],
    )
    found = list_schedule(problem)
    assert found is not None
    assert [d.start for d in found[0]] == [0, 2, 2]


def test_a_gap_before_later_work_is_used() -> None:
    use = {"uses": [{"resource": "r"}]}
    problem = problem_of(
        {**use, "release": 5, "duration": 20}, {**use, "duration": 5}, resources=[{"id": "r"}]
    )
    found = list_schedule(problem)
    assert found is not None
    assert [problem.to_units(int(d.start)) for d in found[0]] == [5, 0]


ONE = {"uses": [{"resource": "r"}]}
TWO = {"uses": [{"resource": "r", "amount": 2}]}
AB = {"before": "a", "after": "b"}
BA = {"before": "b", "after": "a"}


@pytest.mark.parametrize(
    ("actions", "precedence", "deadline"),
    [
        pytest.param([TWO], [], 99, id="demand"),
        pytest.param([{"uses": [*ONE["uses"], *ONE["uses"]]}], [], 99, id="joint demand"),
        pytest.param([{**ONE, "start": 1}, ONE], [], 4, id="deadline of the task"),
        pytest.param([{"release": 1}, {"deadline": 1}], [], 99, id="deadline of an action"),
        pytest.param([ONE, {**ONE, "latest_start": 0}], [], 99, id="latest start"),
        pytest.param(
            [{}, ONE, {**ONE, "duration": 9}],
            [{**AB, "type": "start-start", "max_lag": 0}],
            99,
            id="maximum lag",
        ),
        pytest.param(
            [{}, {}], [{**AB, "min_lag": -9}, {**BA, "min_lag": -9}], 99, id="cycle of arcs"
        ),
    ],
)
def test_where_the_rule_is_defeated_there_is_no_schedule(
    actions: Any, precedence: Any, deadline: int
) -> None:
    problem = problem_of(
        *actions, resources=[{"id": "r"}], precedence=precedence, deadline=deadline
    )
    assert list_schedule(problem) is None


@pytest.mark.slow
def test_two_thousand_jobs_take_little_time() -> None:
    task = contended_task(random.Random("many"), 2000)
    found = list_schedule(run_passes(lower(task)))
    assert found is not None
    assert len(found[0]) == 2000


# --- the horizon --------------------------------------------------------------------------------


@pytest.mark.slow
def test_some_optimal_schedule_has_ended_by_the_horizon() -> None:
    compared = 0
    for seed in range(300):
        task = random_task(random.Random(f"horizon {seed}"))
        best = optimal_makespan(task)
        if best is not None:
            problem = lower(task)
            assert best <= problem.to_units(safe_horizon(problem))
            compared += 1
    assert compared > 200


@pytest.mark.parametrize(
    ("actions", "precedence", "horizon"),
    [
        ([{}], [], 2),
        ([{"release": 100}], [], 102),
        ([{"start": 100}, {"release": 30}], [], 104),
        ([{"duration": {"min": 1, "max": 7}}], [], 7),
        ([{}, {}], [{**AB, "min_lag": 50}], 54),
        ([{}, {}], [{**AB, "min_lag": 50}, {**AB, "min_lag": 20}], 54),
        ([{}, {}], [{**AB, "type": "start-start", "min_lag": 50}], 54),
        ([{}, {}], [{**BA, "max_lag": -50, "min_lag": -90}], 54),
    ],
)
def test_the_horizon_counts_releases_fixed_starts_ranges_and_lags(
    actions: Any, precedence: Any, horizon: int
) -> None:
    listed = [{"id": "ab"[k], "duration": 2, **action} for k, action in enumerate(actions)]
    document = {"actions": listed, "precedence": precedence}
    problem = lower(Task.model_validate(document))
    assert problem.to_units(safe_horizon(problem)) == horizon
    problem = lower(Task.model_validate({**document, "deadline": horizon - 1}))
    assert problem.to_units(safe_horizon(problem)) == horizon - 1
