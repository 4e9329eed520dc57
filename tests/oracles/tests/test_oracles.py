"""The oracles judge the compiler; here they judge each other."""

from __future__ import annotations

import json
import random
from collections.abc import Iterable, Mapping, Sequence
from itertools import product
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from ortools.sat.python import cp_model

from irc.model import Action, DurationRange, Precedence, Task
from irc.model.base import Node
from oracles.brute_force import enough_time, longest_path, optimal_makespan, optimal_schedule
from oracles.generators import (
    HOSTILE_NAMES,
    big_capacity_task,
    contended_task,
    documents,
    hostile_names,
    random_task,
    tasks,
)

RESOURCE_FREE = {
    "resources": (0, 0),
    **dict.fromkeys(("types", "max_lags", "windows", "ranges"), False),
    **dict.fromkeys(("fixed_starts", "task_deadline", "tighten"), False),
}
ONLY_JOBS = {**RESOURCE_FREE, "resources": (1, 2), "one_of": False, "precedence": False}

whole_ir = settings(
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)


def seeded(seed: int) -> random.Random:
    return random.Random(f"oracles {seed}")


# --- two other ways to the same number ----------------------------------------------------------


def lengths(action: Action) -> range:
    if isinstance(action.duration, DurationRange):
        return range(action.duration.min, action.duration.max + 1)
    return range(action.duration, action.duration + 1)


Times = Mapping[str, tuple[int, int]]


def is_valid(task: Task, times: Times, held: Mapping[str, Mapping[str, int]]) -> bool:
    """The definition of a valid schedule, read off the task as it was written."""
    return (
        all(in_windows(task, action, *times[action.id]) for action in task.actions)
        and all(arc_holds(arc, times) for arc in task.precedence)
        and all(
            in_use(times, held, resource.id, instant) <= resource.capacity
            for resource in task.resources
            for instant, _ in times.values()
        )
    )


def in_windows(task: Task, action: Action, start: int, end: int) -> bool:
    return (
        end - start in lengths(action)
        and start >= max(0, action.release)
        and action.start in (None, start)
        and (action.latest_start is None or start <= action.latest_start)
        and all(end <= limit for limit in (action.deadline, task.deadline) if limit is not None)
    )


def arc_holds(arc: Precedence, times: Times) -> bool:
    (start_a, end_a), (start_b, end_b) = times[arc.before], times[arc.after]
    lag = {
        "finish-start": start_b - end_a,
        "start-start": start_b - start_a,
        "finish-finish": end_b - end_a,
        "start-finish": end_b - start_a,
    }[arc.type]
    return arc.min_lag <= lag and (arc.max_lag is None or lag <= arc.max_lag)


def in_use(times: Times, held: Mapping[str, Mapping[str, int]], resource: str, instant: int) -> int:
    return sum(
        held[name].get(resource, 0)
        for name, (start, end) in times.items()
        if start <= instant < end
    )


def holdings(task: Task) -> Iterable[dict[str, dict[str, int]]]:
    """What each action holds, for every way to choose."""
    uses = [(action.id, use) for action in task.actions for use in action.uses]
    for chosen in product(*(use.alternatives for _, use in uses)):
        held: dict[str, dict[str, int]] = {action.id: {} for action in task.actions}
        for (name, use), resource in zip(uses, chosen, strict=True):
            held[name][resource] = held[name].get(resource, 0) + use.amount
        yield held


def enumerated_makespan(task: Task) -> int | None:
    """The optimum by trying every start, length and choice up to `enough_time`."""
    horizon = enough_time(task)
    names = [action.id for action in task.actions]
    spans = [
        [(s, s + d) for d in lengths(action) for s in range(horizon - d + 1)]
        for action in task.actions
    ]
    ways = list(holdings(task))
    best = None
    for tried in product(*spans):
        makespan = max((end for _, end in tried), default=0)
        times = dict(zip(names, tried, strict=True))
        if (best is None or makespan < best) and any(is_valid(task, times, w) for w in ways):
            best = makespan
    return best


def cp_sat_makespan(task: Task) -> int | None:
    """The optimum by a model of intervals, with nothing in common with the compiler's."""
    model = cp_model.CpModel()
    horizon = 10 + 2 * sum(abs(number) for number in numbers(task))
    starts, ends, used = {}, {}, {resource.id: [] for resource in task.resources}
    for action in task.actions:
        allowed = lengths(action)
        start = starts[action.id] = model.new_int_var(max(0, action.release), horizon, "")
        end = ends[action.id] = model.new_int_var(0, horizon, "")
        length = model.new_int_var(allowed[0], allowed[-1], "")
        model.add(start + length == end)
        if action.start is not None:
            model.add(start == action.start)
        if action.latest_start is not None:
            model.add(start <= action.latest_start)
        lasts = model.new_bool_var("")
        model.add(length >= 1).only_enforce_if(lasts)
        model.add(length == 0).only_enforce_if(~lasts)
        for use in action.uses:
            picks = {resource: model.new_bool_var("") for resource in use.alternatives}
            model.add_exactly_one(picks.values())
            for resource, pick in picks.items():
                busy = model.new_bool_var("")
                model.add_multiplication_equality(busy, [pick, lasts])
                interval = model.new_optional_interval_var(start, length, end, busy, "")
                used[resource].append((interval, use.amount))
        for limit in (action.deadline, task.deadline):
            if limit is not None:
                model.add(end <= limit)
    for arc in task.precedence:
        u = (starts if arc.type.startswith("start-") else ends)[arc.before]
        v = (starts if arc.type.endswith("-start") else ends)[arc.after]
        model.add(v - u >= arc.min_lag)
        if arc.max_lag is not None:
            model.add(v - u <= arc.max_lag)
    for resource in task.resources:
        intervals = [interval for interval, _ in used[resource.id]]
        amounts = [amount for _, amount in used[resource.id]]
        model.add_cumulative(intervals, amounts, resource.capacity)
    makespan = model.new_int_var(0, horizon, "")
    model.add_max_equality(makespan, [0, *ends.values()])
    model.minimize(makespan)
    solver = cp_model.CpSolver()
    solver.parameters.num_workers = 1
    status = solver.solve(model)
    assert status in (cp_model.OPTIMAL, cp_model.INFEASIBLE)
    return int(solver.objective_value) if status == cp_model.OPTIMAL else None


def numbers(task: Task) -> Iterable[int]:
    for action in task.actions:
        yield lengths(action)[-1]
        yield action.release
        yield action.start or 0
    for arc in task.precedence:
        yield arc.min_lag
        yield arc.max_lag or 0


# --- agreement ----------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(60))
def test_search_agrees_with_a_cp_sat_model(seed: int) -> None:
    task = random_task(seeded(seed))
    assert optimal_makespan(task) == cp_sat_makespan(task)


@pytest.mark.parametrize("seed", range(15))
def test_search_agrees_with_a_cp_sat_model_on_big_capacities(seed: int) -> None:
    task = big_capacity_task(seeded(seed))
    assert optimal_makespan(task) == cp_sat_makespan(task)


@pytest.mark.parametrize("seed", range(10))
def test_search_agrees_with_a_cp_sat_model_where_nothing_but_capacity_orders_jobs(
    seed: int,
) -> None:
    task = random_task(seeded(seed), **ONLY_JOBS, actions=(5, 7))
    assert optimal_makespan(task) == cp_sat_makespan(task)


@pytest.mark.parametrize("seed", range(10))
def test_search_agrees_with_a_cp_sat_model_on_interchangeable_jobs_and_robots(seed: int) -> None:
    rng = seeded(seed)
    robots = ["r1", "r2", "r3"][: rng.randint(2, 3)]
    uses = [{"one_of": robots}]
    actions = [{"id": f"a{i}", "duration": rng.randint(2, 3), "uses": uses} for i in range(6)]
    actions[0]["deadline"] = rng.randint(3, 8)
    task = Task(
        resources=[{"id": r, "capacity": rng.choice((1, 1, 2))} for r in robots],
        actions=actions,
        precedence=[{"before": "a5", "after": "a4", "max_lag": rng.randint(0, 2)}],
    )
    assert optimal_makespan(task) == cp_sat_makespan(task)


@pytest.mark.parametrize("seed", range(40))
def test_search_agrees_with_plain_enumeration_up_to_enough_time(seed: int) -> None:
    task = random_task(seeded(seed), actions=(2, 3), durations=(0, 3), tighten=0.4)
    assert optimal_makespan(task) == enumerated_makespan(task)


@pytest.mark.parametrize("seed", range(30))
def test_the_optimal_schedule_is_itself_valid(seed: int) -> None:
    task = random_task(seeded(seed), tighten=0)
    best = optimal_schedule(task)
    times = {name: (best.starts[name], best.ends[name]) for name in best.starts}
    assert is_valid(task, times, best.resources)
    assert best.resources in list(holdings(task))
    assert best.makespan == max(best.ends.values())


@pytest.mark.parametrize("seed", range(30))
def test_search_agrees_with_the_longest_path_where_nothing_is_shared(seed: int) -> None:
    task = random_task(seeded(seed), **RESOURCE_FREE)
    assert optimal_makespan(task) == longest_path(task)


# --- cases worked out by hand -------------------------------------------------------------------


def jobs(*durations: Any, **fields: Any) -> list[dict[str, Any]]:
    """Actions a, b, c … with the same `fields`."""
    return [
        {"id": name, "duration": d, **fields} for name, d in zip("abcdef", durations, strict=False)
    ]


def one_machine(actions: Sequence[Mapping[str, Any]], capacity: int = 1, **more: Any) -> Task:
    return Task.model_validate(
        {"resources": [{"id": "m", "capacity": capacity}], "actions": actions, **more}
    )


ON_M = {"uses": [{"resource": "m"}]}


def test_an_empty_task_takes_no_time() -> None:
    assert optimal_makespan(Task(actions=[])) == 0


@pytest.mark.parametrize(("capacity", "makespan"), [(1, 9), (2, 5), (3, 4)])
def test_jobs_wait_for_capacity(capacity: int, makespan: int) -> None:
    assert optimal_makespan(one_machine(jobs(4, 3, 2, **ON_M), capacity)) == makespan


@pytest.mark.parametrize(("robots", "makespan"), [(["x"], 6), (["x", "y"], 4)])
def test_a_job_takes_one_robot_of_several(robots: list[str], makespan: int) -> None:
    task = Task(
        resources=[{"id": r} for r in robots], actions=jobs(2, 2, 2, uses=[{"one_of": robots}])
    )
    assert optimal_makespan(task) == makespan


def test_two_uses_of_one_action_may_need_two_different_robots() -> None:
    pair = [{"one_of": ["x", "y"]}, {"one_of": ["x", "y"]}]
    task = Task(resources=[{"id": "x"}, {"id": "y"}], actions=jobs(3, 3, uses=pair))
    assert optimal_makespan(task) == 6


def test_no_capacity_is_enough_for_an_amount_above_it() -> None:
    assert optimal_makespan(one_machine(jobs(1, uses=[{"resource": "m", "amount": 2}]))) is None


def test_a_zero_duration_uses_nothing() -> None:
    busy = {"id": "busy", "duration": 4, **ON_M}
    blink = {"id": "blink", "duration": 0, "start": 2, "uses": [{"resource": "m", "amount": 9}]}
    assert optimal_makespan(one_machine([busy, blink])) == 4


@pytest.mark.parametrize(("least", "makespan"), [(0, 4), (1, None)])
def test_a_range_that_begins_at_zero_may_use_nothing(least: int, makespan: int | None) -> None:
    busy = {"id": "busy", "duration": 4, "start": 0, **ON_M}
    flexible = {"id": "f", "duration": {"min": least, "max": 3}, "deadline": 4, **ON_M}
    assert optimal_makespan(one_machine([busy, flexible])) == makespan


def test_a_range_shrinks_to_nothing_where_its_resource_is_taken() -> None:
    busy = {"id": "busy", "duration": 4, "start": 0, **ON_M}
    other = {"id": "other", "duration": 2}
    flexible = {"id": "f", "duration": {"min": 0, "max": 3}, "deadline": 3, **ON_M}
    arcs = [{"before": "other", "after": "f", "type": "finish-finish"}]
    best = optimal_schedule(one_machine([busy, other, flexible], precedence=arcs))
    assert best is not None
    assert best.starts["f"] == best.ends["f"] == 2


@pytest.mark.parametrize(("release", "makespan"), [(3, 4), (4, None)])
def test_a_range_stretches_to_its_maximum_and_no_further(
    release: int, makespan: int | None
) -> None:
    task = Task(
        actions=[
            {"id": "a", "duration": {"min": 1, "max": 3}, "start": 0},
            {"id": "b", "duration": 1, "release": release},
        ],
        precedence=[{"before": "a", "after": "b", "max_lag": 0}],
    )
    assert optimal_makespan(task) == makespan


@pytest.mark.parametrize(
    ("kind", "lag", "makespan"),
    [
        ("finish-start", 2, 11),
        ("finish-start", -2, 7),
        ("finish-start", -9, 5),
        ("start-start", 2, 6),
        ("finish-finish", 2, 7),
        ("finish-finish", -2, 5),
        ("start-finish", 9, 9),
    ],
)
def test_each_precedence_type_binds_its_two_points(kind: str, lag: int, makespan: int) -> None:
    arc = {"before": "a", "after": "b", "type": kind, "min_lag": lag}
    assert optimal_makespan(Task(actions=jobs(5, 4), precedence=[arc])) == makespan


def test_a_maximum_lag_delays_the_first_action_until_the_second_can_run() -> None:
    actions = [
        {"id": "a", "duration": 2},
        {"id": "b", "duration": 3, **ON_M},
        {"id": "c", "duration": 4, "start": 0, **ON_M},
    ]
    arcs = [{"before": "a", "after": "b", "max_lag": 0}]
    best = optimal_schedule(one_machine(actions, precedence=arcs))
    assert (best.makespan, best.starts) == (7, {"a": 2, "b": 4, "c": 0})


def test_maximum_lags_can_make_a_shared_machine_infeasible() -> None:
    arcs = [
        {"before": "a", "after": "b", "type": "start-start", "min_lag": 1, "max_lag": 2},
    ]
    assert optimal_makespan(one_machine(jobs(3, 3, **ON_M), precedence=arcs)) is None
    assert optimal_makespan(one_machine(jobs(2, 3, **ON_M), precedence=arcs)) == 5


def test_a_negative_maximum_lag_is_a_minimum_the_other_way() -> None:
    arcs = [{"before": "a", "after": "b", "min_lag": -9, "max_lag": -6}]
    assert optimal_makespan(Task(actions=jobs(2, 3), precedence=arcs)) == 6


@pytest.mark.parametrize(("limit", "makespan"), [(6, 9), (5, None)])
def test_deadline_of_the_second_of_two_jobs(limit: int, makespan: int | None) -> None:
    a, b, c = jobs(3, 3, 3, **ON_M)
    task = one_machine([{**a, "deadline": 4}, {**b, "deadline": limit}, c])
    assert optimal_makespan(task) == makespan


@pytest.mark.parametrize(("limit", "makespan"), [(9, 9), (8, None)])
def test_deadline_of_the_task(limit: int, makespan: int | None) -> None:
    assert optimal_makespan(one_machine(jobs(4, 5, **ON_M), deadline=limit)) == makespan


@pytest.mark.parametrize(("limit", "makespan"), [(9, 9), (8, None)])
def test_a_horizon_cuts_later_schedules_off(limit: int, makespan: int | None) -> None:
    assert optimal_makespan(one_machine(jobs(4, 5, **ON_M)), horizon=limit) == makespan


def test_a_positive_cycle_is_infeasible_without_any_horizon() -> None:
    arcs = [["a", "b"], ["b", "a"]]
    assert optimal_makespan(Task(actions=jobs(58_000_000, 1), precedence=arcs)) is None
    assert optimal_makespan(Task(actions=jobs(0, 0), precedence=arcs)) == 0


@pytest.mark.parametrize(("limit", "makespan"), [(2, None), (3, None), (4, 7), (9, 7)])
def test_latest_start_of_the_second_of_two_jobs(limit: int, makespan: int | None) -> None:
    a, b = jobs(4, 3, **ON_M)
    task = one_machine([{**a, "latest_start": 0}, {**b, "latest_start": limit}])
    assert optimal_makespan(task) == makespan


def test_a_fixed_start_before_the_release_is_infeasible() -> None:
    assert optimal_makespan(Task(actions=jobs(1, start=3, release=3))) == 4
    assert optimal_makespan(Task(actions=jobs(1, start=3, release=4))) is None
    assert optimal_makespan(Task(actions=jobs(1, start=-1))) is None


def test_enough_time_counts_releases_and_lags() -> None:
    arcs = [{"before": "a", "after": "b", "min_lag": 7}]
    task = Task(actions=jobs(2, 3, release=100), precedence=arcs)
    assert enough_time(task) == optimal_makespan(task) == 112


def test_times_with_units_are_read_in_the_unit_of_the_task() -> None:
    task = Task(time_unit="min", actions=jobs("1 h", "90 s"), precedence=[["a", "b"]])
    with pytest.raises(ValueError, match="3/2 is not a whole number"):
        optimal_makespan(task)
    assert str(longest_path(task)) == "123/2"


def test_longest_path_takes_releases_and_the_tightest_of_several_lags() -> None:
    task = Task(
        actions=[{"id": "a", "duration": 4, "release": 3}, {"id": "b", "duration": 1}],
        precedence=[
            {"before": "a", "after": "b", "min_lag": 5},
            {"before": "a", "after": "b", "min_lag": -20},
        ],
    )
    assert longest_path(task) == optimal_makespan(task) == 13


@pytest.mark.parametrize(
    "foreign",
    [
        {"state": [{"id": "v"}]},
        {"goals": ["a"]},
        {"groups": [{"id": "g", "actions": ["a"]}]},
        {"events": [{"at": 1}]},
        {"resources": [{"id": "m", "kind": "reservoir"}]},
        {"resources": [{"id": "m", "availability": [{"from": 0, "to": 1, "capacity": 0}]}]},
        {"actions": jobs(1, occurs="optional")},
        {"actions": jobs(1, conditions=[{"at": "start", "var": "v"}])},
        {"actions": [{"id": "a", "modes": [{"id": "m", "duration": 1}]}]},
        {"actions": [{"id": "a", "duration": 1}, {"id": "a", "duration": 2}]},
        {"actions": jobs(1, **ON_M)},
        {"actions": jobs(-1)},
        {"precedence": [["a", "nobody"]]},
    ],
)
def test_what_the_oracles_do_not_know_is_refused(foreign: dict[str, Any]) -> None:
    task = Task.model_validate({"actions": jobs(1), **foreign})
    for oracle in (optimal_makespan, longest_path):
        with pytest.raises(ValueError):
            oracle(task)


@pytest.mark.parametrize(
    "foreign",
    [
        {"deadline": 9},
        {"precedence": [["a", "b"], ["b", "a"]]},
        {"precedence": [{"before": "a", "after": "b", "max_lag": 9}]},
        {"precedence": [{"before": "a", "after": "b", "type": "start-start"}]},
        {"actions": jobs({"min": 1, "max": 2})},
        {"actions": jobs(1, start=1)},
    ],
)
def test_longest_path_refuses_what_is_no_path(foreign: dict[str, Any]) -> None:
    with pytest.raises(ValueError):
        longest_path(Task.model_validate({"actions": jobs(1, 1), **foreign}))


# --- generators ---------------------------------------------------------------------------------


@pytest.mark.parametrize("generate", [random_task, big_capacity_task])
def test_equal_seeds_give_equal_tasks(generate: Any) -> None:
    assert generate(seeded(7)) == generate(seeded(7))
    assert generate(seeded(7)) != generate(seeded(8))


def test_most_random_tasks_are_feasible_and_some_are_not() -> None:
    found = [optimal_makespan(random_task(seeded(seed))) for seed in range(200)]
    assert 10 <= found.count(None) <= 60
    untightened = [random_task(seeded(seed), tighten=0) for seed in range(100)]
    assert None not in [optimal_makespan(task) for task in untightened]


@pytest.mark.parametrize(
    ("generate", "least"),
    [
        (random_task, 35),
        (big_capacity_task, 35),
        (lambda rng: contended_task(rng, 7), 65),
    ],
    ids=["random", "big capacities", "contended"],
)
def test_resources_are_contended_in_many_tasks(generate: Any, least: int) -> None:
    slower = 0
    for seed in range(100):
        task = generate(seeded(seed))
        makespan = optimal_makespan(task)
        if makespan is not None:
            plenty = [r.model_copy(update={"capacity": 10**6}) for r in task.resources]
            slower += optimal_makespan(task.model_copy(update={"resources": plenty})) < makespan
    assert slower >= least


FEATURES = {
    "one_of": lambda task: any(use.one_of for use in uses_of(task)),
    "amounts": lambda task: any(use.amount > 1 for use in uses_of(task)),
    "precedence": lambda task: task.precedence,
    "types": lambda task: any(arc.type != "finish-start" for arc in task.precedence),
    "min_lags": lambda task: any(arc.min_lag for arc in task.precedence),
    "max_lags": lambda task: any(arc.max_lag is not None for arc in task.precedence),
    "windows": lambda task: any(a.release or a.deadline is not None for a in task.actions),
    "ranges": lambda task: any(isinstance(a.duration, DurationRange) for a in task.actions),
    "fixed_starts": lambda task: any(a.start is not None for a in task.actions),
    "task_deadline": lambda task: task.deadline is not None,
}


def uses_of(task: Task) -> list[Any]:
    return [use for action in task.actions for use in action.uses]


@pytest.mark.parametrize("knob", FEATURES)
def test_a_knob_switches_its_feature_off_and_leaves_it_on_elsewhere(knob: str) -> None:
    shown = FEATURES[knob]
    assert not any(shown(random_task(seeded(seed), **{knob: False})) for seed in range(80))
    assert any(shown(random_task(seeded(seed))) for seed in range(80))


def test_random_tasks_keep_to_their_ranges() -> None:
    for seed in range(50):
        task = random_task(seeded(seed), actions=(3, 5), capacities=(2, 4), durations=(1, 2))
        assert 3 <= len(task.actions) <= 5
        assert all(2 <= resource.capacity <= 4 for resource in task.resources)
        big = big_capacity_task(seeded(seed))
        assert all(20 <= resource.capacity <= 100 for resource in big.resources)
        assert all(use.amount > 1 for use in uses_of(big))


def test_contended_tasks_have_the_jobs_asked_for() -> None:
    assert [len(contended_task(seeded(n), n).actions) for n in (6, 20)] == [6, 20]


# --- hostile names ------------------------------------------------------------------------------


def test_hostile_names_are_legal_and_distinct() -> None:
    assert len(set(HOSTILE_NAMES)) == len(HOSTILE_NAMES)
    assert all(name and name.encode() for name in HOSTILE_NAMES)


@pytest.mark.parametrize("seed", range(20))
def test_hostile_names_change_no_makespan(seed: int) -> None:
    task = random_task(seeded(seed))
    renamed = hostile_names(task, seeded(seed))
    assert {action.id for action in renamed.actions} <= set(HOSTILE_NAMES)
    assert optimal_makespan(renamed) == optimal_makespan(task)


def test_more_names_than_the_list_has_stay_distinct() -> None:
    many = Task(actions=[{"id": f"a{i}", "duration": 1} for i in range(400)])
    renamed = hostile_names(many, seeded(1))
    assert len({action.id for action in renamed.actions}) == 400


@given(tasks(), st.randoms(use_true_random=False))
@settings(whole_ir, max_examples=25)
def test_hostile_names_keep_the_structure_of_any_task(task: Task, rng: random.Random) -> None:
    assert shape(hostile_names(task, rng)) == shape(task)


def shape(task: Task) -> Any:
    """The document with each name replaced by the order in which it first appears."""
    seen: dict[tuple[str, str], int] = {}

    def number(space: str, name: str) -> int:
        return seen.setdefault((space, name), len(seen))

    def walk(part: Any, of: str) -> Any:
        if isinstance(part, Node):
            return {
                key: walk(getattr(part, key), f"{type(part).__name__}.{key}")
                for key in fields(part)
            }
        if isinstance(part, tuple):
            return [walk(item, of) for item in part]
        return number(SPACES[of], part) if of in SPACES and isinstance(part, str) else part

    return walk(task, "")


def fields(node: Node) -> list[str]:
    return sorted(node.model_fields_set)


SPACES = {
    f"{owner}.{key}": space
    for space, places in {
        "action": {
            "Action": ["id"],
            "Precedence": ["before", "after"],
            "PrecedenceKey": ["before", "after"],
            "Group": ["actions"],
            "Task": ["goals"],
            "SetGoals": ["goals"],
            "CancelActions": ["actions"],
            **{op: ["action"] for op in ("SetDuration", "SetDeadline", "SetRelease", "Observe")},
            "RetryAction": ["action", "id"],
            "Lapsed": ["action", "repetition"],
        },
        "resource": {
            "Resource": ["id"],
            "Use": ["resource", "one_of"],
            "StockChange": ["resource"],
            "SetCapacity": ["resource"],
            "Observe": ["resources"],
        },
        "state": {
            "StateVariable": ["id"],
            **{part: ["var"] for part in ("Condition", "Effect", "StateGoal", "SetState")},
        },
        "group": {"Group": ["id"], "CancelGroups": ["groups"], "SetDeadline": ["group"]},
        "mode": {"Mode": ["id"], "Observe": ["mode"], "RetryAction": ["mode"]},
        "event": {"Event": ["id"]},
        "calendar": {"Calendar": ["id"], "Resource": ["calendar"], "Action": ["calendar"]},
    }.items()
    for owner, keys in places.items()
    for key in keys
}


# --- the whole IR -------------------------------------------------------------------------------


@given(documents())
@settings(whole_ir, max_examples=25)
def test_documents_are_json(document: dict[str, Any]) -> None:
    assert json.loads(json.dumps(document)) == document


@given(tasks())
@settings(whole_ir, max_examples=25)
def test_tasks_can_be_read_back_from_what_pydantic_writes(task: Task) -> None:
    written = task.model_dump_json(by_alias=True, exclude_unset=True)
    assert Task.model_validate_json(written) == task
