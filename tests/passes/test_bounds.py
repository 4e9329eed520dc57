"""The lower bounds of the passes: never above the optimum, and most often equal to it."""

from __future__ import annotations

import json
import random
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from itertools import chain, combinations, pairwise
from typing import Any, NamedTuple

import pytest
from ortools.sat.python import cp_model

from irc.lowering.lower import lower
from irc.model import Task
from irc.model.quantities import Number
from irc.passes import destructive
from irc.passes.contention import drop_uncontended, merge_pools
from irc.passes.critical_path import heads_and_tails
from irc.passes.destructive import destructive_bound
from irc.passes.energy import energy_bound, loads, thinned
from irc.passes.reduction import reduce_transitively
from irc.problem import (
    Activity,
    Arc,
    Bound,
    ContendedPool,
    Contention,
    OpenDemand,
    Problem,
    Renewable,
    Requirement,
)
from oracles.brute_force import optimal_makespan
from oracles.generators import big_capacity_task, contended_task, random_task
from paths import SHARED_DATA

ROBO_CHALLENGE = SHARED_DATA / "robo_challenge"

Document = dict[str, Any]


def prepared(problem: Problem) -> Problem:
    """The problem as the bounds find it."""
    return heads_and_tails(drop_uncontended(merge_pools(reduce_transitively(problem))))


def bounded(problem: Problem) -> Problem:
    return destructive_bound(energy_bound(prepared(problem)))


def bound_of(**document: Any) -> tuple[Number, str]:
    """The bound after both passes in the task's unit, and its reason."""
    return in_units(bounded(lower(Task.model_validate(document))))


def energy_of(**document: Any) -> tuple[Number, str]:
    """The same without destructive improvement."""
    return in_units(energy_bound(prepared(lower(Task.model_validate(document)))))


def in_units(problem: Problem) -> tuple[Number, str]:
    return problem.to_units(problem.bounds.makespan.value), problem.bounds.makespan.reason


def action(name: str, duration: Any, resource: str | None = None, **more: Any) -> Document:
    uses = [] if resource is None else [{"resource": resource, "amount": more.pop("amount", 1)}]
    return {"id": name, "duration": duration, "uses": uses, **more}


# --- never above the optimum --------------------------------------------------------------------

SMALL_TASKS: dict[str, Callable[[random.Random], Task]] = {
    "everything": lambda rng: random_task(rng, actions=(2, 8)),
    "choices": lambda rng: random_task(rng, actions=(4, 7), windows=False, tighten=0.0),
    "one unit": lambda rng: random_task(rng, actions=(4, 8), one_of=False, capacities=(1, 1)),
    "big capacities": lambda rng: big_capacity_task(rng, actions=(3, 7)),
    "robots": lambda rng: contended_task(rng, rng.randint(4, 8)),
}


def small_problems(kind: str, count: int) -> Iterator[tuple[Problem, int | None]]:
    """Prepared problems and their optimum, where the lags do not contradict each other."""
    for seed in range(count):
        task = SMALL_TASKS[kind](random.Random(f"{kind} {seed}"))
        best = optimal_makespan(task)
        try:
            yield prepared(lower(task)), best
        except ValueError:
            assert best is None


@pytest.mark.slow
@pytest.mark.parametrize("kind", SMALL_TASKS)
def test_no_bound_exceeds_the_optimum(kind: str) -> None:
    compared = 0
    for problem, best in small_problems(kind, 50):
        by_energy = energy_bound(problem)
        bounds = [by_energy, destructive_bound(problem), destructive_bound(by_energy)]
        assert by_energy.bounds.makespan.value >= problem.bounds.makespan.value
        assert bounds[2].bounds.makespan.value >= by_energy.bounds.makespan.value
        if best is not None:
            assert max(p.bounds.makespan.value for p in bounds) <= best
            compared += problem.has_contention
    assert compared > 18


@pytest.mark.slow
@pytest.mark.parametrize("steps", [0, 40, 400, 4_000])
def test_an_early_end_of_the_budget_leaves_a_true_bound(
    steps: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(destructive, "BASE_STEPS", steps)
    monkeypatch.setattr(destructive, "STEPS_PER_ACTIVITY", 0)
    for problem, best in small_problems("everything", 60):
        value = destructive_bound(problem).bounds.makespan.value
        assert value >= problem.bounds.makespan.value
        assert best is None or value <= best


@pytest.mark.slow
@pytest.mark.parametrize("factor", [7, 10**6 + 3, 10**15])
def test_long_times_leave_a_true_bound(factor: int) -> None:
    for problem, best in small_problems("robots", 15):
        assert best is not None
        value = bounded(scaled(problem, factor)).bounds.makespan.value
        assert problem.bounds.makespan.value * factor <= value <= best * factor


def scaled(problem: Problem, factor: int) -> Problem:
    """A task of robots and minimum lags with all times multiplied, in the same ticks."""
    return replace(
        problem,
        bounds=replace(problem.bounds, makespan=Bound(0, "")),
        activities=tuple(
            replace(a, duration_min=a.duration_min * factor, duration_max=a.duration_max * factor)
            for a in problem.activities
        ),
        arcs=tuple(arc._replace(min_lag=arc.min_lag * factor) for arc in problem.arcs),
    )


# --- how often they are the optimum -------------------------------------------------------------


def kitchen_task(rng: random.Random, actions: int) -> Task:
    """Items that go through stations of capacity 1 to 3, with up to four robots, and lags."""
    robots = [f"robot{i}" for i in range(rng.randint(0, 4))]
    stations = [(f"station{i}", rng.randint(2, 12)) for i in range(5)]
    steps: list[Document] = []
    precedence: list[Document] = []
    while len(steps) < actions:
        route = rng.sample(stations, rng.randint(1, 3))
        item = len(steps)
        for k, (station, duration) in enumerate(route):
            steps.append(action(f"{item} {k}", duration, station))
            if robots:
                steps[-1]["uses"].append({"one_of": robots})
            lag = {"min_lag": rng.randint(1, 4)} if rng.random() < 0.25 else {}
            if k:
                precedence.append({"before": f"{item} {k - 1}", "after": f"{item} {k}", **lag})
    resources: list[Document] = [{"id": r} for r in robots]
    resources += [{"id": s, "capacity": rng.choice((1, 1, 2, 3))} for s, _ in stations]
    return Task.model_validate({"resources": resources, "actions": steps, "precedence": precedence})


def cpsat_makespan(document: Document) -> int:
    """The least makespan of a task of fixed durations, uses and finish-start lags, by CP-SAT."""
    model = cp_model.CpModel()
    lengths = {step["id"]: step["duration"] for step in document["actions"]}
    horizon = sum(lengths.values()) + sum(edge["min_lag"] for edge in document["precedence"])
    starts = {name: model.new_int_var(0, horizon, name) for name in lengths}
    held: dict[str, list[Any]] = {r["id"]: [] for r in document["resources"]}
    for step in document["actions"]:
        start, length = starts[step["id"]], lengths[step["id"]]
        for use in step["uses"]:
            chosen = {r: model.new_bool_var("") for r in use["one_of"] or [use["resource"]]}
            model.add_exactly_one(chosen.values())
            for r, literal in chosen.items():
                held[r].append(
                    model.new_optional_fixed_size_interval_var(start, length, literal, "")
                )
    for resource in document["resources"]:
        users = held[resource["id"]]
        model.add_cumulative(users, [1] * len(users), resource["capacity"])
    for edge in document["precedence"]:
        before, after = edge["before"], edge["after"]
        model.add(starts[after] >= starts[before] + lengths[before] + edge["min_lag"])
    makespan = model.new_int_var(0, horizon, "makespan")
    model.add_max_equality(makespan, [starts[name] + lengths[name] for name in starts])
    model.minimize(makespan)
    solver = cp_model.CpSolver()
    solver.parameters.num_workers = 1
    assert solver.solve(model) == cp_model.OPTIMAL
    return round(solver.objective_value)


TIGHTNESS: dict[str, Callable[[random.Random, int], Task]] = {
    "robots": contended_task,
    "kitchen": kitchen_task,
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", TIGHTNESS)
def test_the_bound_is_the_optimum_in_19_of_20_contended_tasks(kind: str) -> None:
    reached = by_energy = total = 0
    for seed in range(75):
        rng = random.Random(f"{kind} {seed}")
        task = TIGHTNESS[kind](rng, 6 + seed % (15 if kind == "robots" else 7))
        problem = prepared(lower(task))
        if not problem.has_contention:
            continue
        best = cpsat_makespan(task.model_dump(mode="json"))
        energy, both = (
            energy_bound(problem).bounds.makespan.value,
            bounded(lower(task)).bounds.makespan.value,
        )
        assert energy <= both <= best
        by_energy += energy == best
        reached += both == best
        total += 1
    assert total >= 50
    assert reached >= 0.95 * total
    assert by_energy < reached


STATIONS = {"grill": "grill", "cut": "cutting_board", "fry": "fryer", "boil": "boiler"} | {
    "toast": "toaster",
    "marinate": "marinator",
}


def robo_task(document: Document) -> Task:
    """A Robo Challenge instance; its witness plan tells which actions each item goes through."""
    robots = document.get("robots", [])
    steps: list[Document] = []
    routes: dict[str, list[str]] = {}
    for line in sorted(
        document["witness_plan"].splitlines(), key=lambda text: float(text.split(":")[0])
    ):
        kind, *_, item = line.split("(")[1].split(")")[0].split()
        steps.append(
            action(f"{kind} {item}", str(document["action_durations"][kind]), STATIONS.get(kind))
        )
        if robots:
            steps[-1]["uses"].append({"one_of": robots})
        routes.setdefault(item, []).append(f"{kind} {item}")
    stack = [f"stack {item}" for item in document["goal"]["stack_order"]]
    # A plan may stack an item before a step that is no part of the stack is done with others.
    chains = [*(sorted(route, key=lambda name: name in stack) for route in routes.values()), stack]
    precedence = [list(pair) for names in chains for pair in pairwise(names)]
    lags = [
        {
            "before": f"{lag['before']['action']} {lag['before']['item']}",
            "after": f"{lag['after']['action']} {lag['after']['item']}",
            "min_lag": lag["min_lag"],
        }
        for lag in document["temporal_constraints"]
    ]
    resources = [{"id": s, "capacity": c} for s, c in document["stations"].items()]
    resources += [{"id": r} for r in robots]
    return Task.model_validate(
        {"resources": resources, "actions": steps, "precedence": precedence + lags}
    )


@pytest.mark.slow
@pytest.mark.shared_data
@pytest.mark.skipif(not ROBO_CHALLENGE.is_dir(), reason="needs the benchmark data")
def test_the_bound_is_the_optimum_of_every_robo_challenge_task() -> None:
    missed = []
    for path in sorted(ROBO_CHALLENGE.glob("*.json")):
        document = json.loads(path.read_text(encoding="utf-8"))
        bound = bounded(lower(robo_task(document))).bounds.makespan
        if bound.value != document["optimal_makespan"]:
            missed.append((path.stem, bound, document["optimal_makespan"]))
    assert not missed


# --- energy -------------------------------------------------------------------------------------


class Job(NamedTuple):
    """What one resource sees of an activity."""

    duration: int
    head: int
    tail: int
    amount: int = 1


def on_one_resource(capacity: int, jobs: list[Job]) -> Problem:
    """Independent jobs; a head is a release, a tail what follows elsewhere."""
    steps: list[Document] = []
    for i, (duration, head, tail, amount) in enumerate(jobs):
        steps.append(action(f"job {i}", duration, "r", release=head, amount=amount))
        steps.append(action(f"then {i}", tail))
    return prepared(
        lower(
            Task.model_validate(
                {
                    "resources": [{"id": "r", "capacity": capacity}],
                    "actions": steps,
                    "precedence": [[f"job {i}", f"then {i}"] for i in range(len(jobs))],
                }
            )
        )
    )


def random_jobs(rng: random.Random, count: int, capacity: int) -> list[Job]:
    return [
        Job(
            rng.randint(1, 9),
            head=rng.randint(0, 15),
            tail=rng.randint(0, 15),
            amount=rng.randint(1, capacity),
        )
        for _ in range(count)
    ]


def jackson_preemptive(jobs: list[Job]) -> int:
    """The makespan of Jackson's preemptive schedule on one unit, tick by tick."""
    left = {i: job.duration for i, job in enumerate(jobs)}
    now = best = 0
    while left:
        ready = [i for i in left if jobs[i].head <= now]
        now += 1
        if ready:
            urgent = max(ready, key=lambda i: jobs[i].tail)
            left[urgent] -= 1
            if not left[urgent]:
                del left[urgent]
                best = max(best, now + jobs[urgent].tail)
    return best


def test_on_one_unit_the_energy_is_jacksons_preemptive_schedule() -> None:
    for seed in range(60):
        jobs = random_jobs(random.Random(seed), 2 + seed % 12, 1)
        value, _ = in_units(energy_bound(on_one_resource(1, jobs)))
        longest_alone = max(sum(job[:3]) for job in jobs)
        assert value == max(longest_alone, jackson_preemptive(jobs))


def test_the_energy_is_the_best_over_all_sets_of_activities() -> None:
    for seed in range(40):
        capacity = 2 + seed % 3
        jobs = random_jobs(random.Random(seed), 2 + seed % 7, capacity)
        problem = on_one_resource(capacity, jobs)
        best = problem.bounds.makespan.value
        for load in loads(problem):
            users = list(zip(load.activities, load.amounts, strict=True))
            for some in chain.from_iterable(combinations(users, k + 1) for k in range(len(users))):
                work = sum(problem.activities[i].duration_min * amount for i, amount in some)
                head = min(problem.bounds.heads[i] for i, _ in some)
                tail = min(problem.bounds.tails[i] for i, _ in some)
                best = max(best, head - (-work // load.capacity) + tail)
        assert energy_bound(problem).bounds.makespan.value == best


def test_the_reason_names_the_resource_and_the_terms_in_the_tasks_unit() -> None:
    value, reason = energy_of(
        resources=[{"id": "grill"}],
        actions=[
            action("warm up", "2.5"),
            *(action(f"steak {k}", 10, "grill") for k in range(3)),
            action("serve", 3),
        ],
        precedence=[
            pair for k in range(3) for pair in (["warm up", f"steak {k}"], [f"steak {k}", "serve"])
        ],
    )
    assert value == Fraction("35.5")
    assert reason == "energy of 'grill' (head 2.5 + work 30 / capacity 1 + tail 3)"


def test_alternatives_are_one_pool_with_those_who_name_a_member() -> None:
    either = [{"one_of": ["left", "right"]}]
    bound = energy_of(
        resources=[{"id": "left"}, {"id": "right"}],
        actions=[
            *({"id": f"any {k}", "duration": 10, "uses": either} for k in range(4)),
            action("own", 15, "left"),
        ],
    )
    assert bound == (30, "energy of 'left' or 'right' (head 0 + work 55 / capacity 2 + tail 0)")


def test_overlapping_sets_of_alternatives_are_one_pool() -> None:
    value, reason = energy_of(
        resources=[{"id": "a"}, {"id": "b"}, {"id": "c"}],
        actions=[
            *({"id": f"x{k}", "duration": 3, "uses": [{"one_of": ["a", "b"]}]} for k in range(4)),
            *({"id": f"y{k}", "duration": 3, "uses": [{"one_of": ["b", "c"]}]} for k in range(4)),
            action("z", 1),
        ],
    )
    assert value == 8
    assert reason.startswith("energy of 'a' or 'b' or 'c' ")


def test_an_alternative_that_is_too_small_is_none() -> None:
    bound = energy_of(
        resources=[{"id": "car"}, {"id": "van", "capacity": 2}],
        actions=[
            {"id": f"ride {k}", "duration": 5, "uses": [{"one_of": ["car", "van"], "amount": 2}]}
            for k in range(3)
        ],
    )
    assert bound == (15, "energy of 'van' (head 0 + work 30 / capacity 2 + tail 0)")


def test_amounts_above_half_of_the_capacity_take_turns() -> None:
    value, reason = energy_of(
        resources=[{"id": "crane", "capacity": 5}],
        actions=[
            *(action(f"heavy {k}", 4, "crane", amount=3) for k in range(3)),
            action("light", 1, "crane", amount=2),
        ],
    )
    assert value == 12
    assert reason.startswith("energy of 'crane', amounts above 1/2 of it")


def test_a_capacity_that_the_amounts_cannot_fill_does_not_count_in_full() -> None:
    bound = energy_of(
        resources=[{"id": "oven", "capacity": 7}],
        actions=[*(action(f"tray {k}", 6, "oven", amount=2) for k in range(7)), action("z", 1)],
    )
    assert bound == (14, "energy of 'oven' (head 0 + work 84 / capacity 6 + tail 0)")


# --- destructive improvement --------------------------------------------------------------------


@pytest.mark.parametrize(("unit", "release"), [(1, 1), (10**9 + 7, 10**9 + 8)])
def test_two_orders_that_both_end_late_raise_the_bound(unit: int, release: int) -> None:
    """However long the times are in ticks: the second release is no multiple of the rest."""
    jobs = [Job(4 * unit, head=0, tail=5 * unit), Job(2 * unit, head=release, tail=6 * unit)]
    problem = energy_bound(on_one_resource(1, jobs))
    assert problem.bounds.makespan.value < 12 * unit
    raised = destructive_bound(problem).bounds.makespan
    assert raised.value == 12 * unit
    assert raised.reason.startswith(f"a makespan of {12 * unit - 1} ")


RULES = {
    "what comes second starts later": (2, [Job(5, 4, 14), Job(2, 14, 15, 2), Job(9, 13, 11)], 36),
    "what comes first ends earlier": (
        2,
        [Job(9, 2, 7), Job(9, 15, 0), Job(1, 3, 5, 2), Job(8, 2, 9, 2)],
        27,
    ),
    "too much work moves a start": (
        1,
        [Job(3, 6, 13), Job(6, 10, 9), Job(6, 3, 1), Job(3, 3, 11), Job(7, 3, 3)],
        30,
    ),
    "too much work moves an end": (
        2,
        [Job(8, 6, 9), Job(2, 14, 8), Job(9, 10, 9, 2), Job(8, 9, 8, 2)],
        40,
    ),
}
"""Capacity, jobs and bound, where the propagation without that rule shows less."""


@pytest.mark.parametrize("rule", RULES)
def test_propagation_alone_raises_the_bound(rule: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(destructive, "DEPTH_LIMIT", 0)
    capacity, jobs, value = RULES[rule]
    problem = energy_bound(on_one_resource(capacity, jobs))
    assert problem.bounds.makespan.value < value
    assert in_units(destructive_bound(problem))[0] == value


def test_the_reason_names_the_interval_that_holds_too_much() -> None:
    jobs = [Job(2, 12, 1), Job(9, 4, 1), Job(2, 10, 1), Job(3, 9, 10)]
    bound = in_units(destructive_bound(energy_bound(on_one_resource(1, jobs))))
    assert bound == (26, "a makespan of 25 asks too much of 'r' between 9 and 24")


def test_where_propagation_stands_cases_of_order_decide() -> None:
    jobs = [Job(7, 14, 14), Job(7, 4, 3), Job(7, 7, 3), Job(5, 5, 6)]
    bound = in_units(destructive_bound(energy_bound(on_one_resource(1, jobs))))
    assert bound == (36, "a makespan of 35 fails in each of 3 cases of order")


def test_a_deadline_of_an_action_forbids_the_better_order() -> None:
    value, _ = bound_of(
        resources=[{"id": "room"}],
        actions=[
            action("talk", 3, "room", deadline=3),
            action("meal", 4, "room"),
            action("washing up", 5),
        ],
        precedence=[["meal", "washing up"]],
    )
    assert value == 12


def test_seven_equal_jobs_on_two_units_take_four_turns() -> None:
    bound = bound_of(
        resources=[{"id": "boiler", "capacity": 2}],
        actions=[
            *(action(f"boil {k}", 11, "boiler") for k in range(7)),
            action("elsewhere", 1),
        ],
    )
    assert bound == (44, "a makespan of 43 asks too much of 'boiler' between 0 and 43")


def test_a_fixed_start_leaves_the_others_what_is_left() -> None:
    value, _ = bound_of(
        resources=[{"id": "room"}],
        actions=[action("talk", 2, "room", start=3), action("meal", 4, "room")],
    )
    assert value == 9


def test_a_refuted_deadline_shows_as_a_bound_behind_it() -> None:
    value, _ = bound_of(
        resources=[{"id": "room"}],
        actions=[action("talk", 2, "room", start=3), action("meal", 4, "room")],
        deadline=8,
    )
    assert value == 9


def test_deadlines_of_actions_that_cannot_be_kept_leave_the_bound_as_it_is() -> None:
    problem = energy_bound(
        prepared(
            lower(
                Task.model_validate(
                    {
                        "resources": [{"id": "room"}],
                        "actions": [
                            action("talk", 3, "room", deadline=5),
                            action("meal", 3, "room", deadline=5),
                        ],
                    }
                )
            )
        )
    )
    assert destructive_bound(problem) is problem
    assert problem.bounds.makespan.value == 6


def test_a_range_that_may_shrink_to_nothing_is_in_nobodys_way() -> None:
    value, _ = bound_of(
        resources=[{"id": "room"}],
        actions=[
            action("pause", {"min": 0, "max": 5}, "room"),
            action("talk", 4, "room"),
            action("discussion", {"min": 2, "max": 5}, "room"),
        ],
    )
    assert value == 6


def test_without_contention_the_problem_is_returned_as_it_is() -> None:
    problem = prepared(
        lower(
            Task.model_validate(
                {
                    "resources": [{"id": "oven", "capacity": 2}],
                    "actions": [action("a", 3, "oven"), action("b", 4, "oven"), action("c", 5)],
                }
            )
        )
    )
    assert energy_bound(problem) is problem
    assert destructive_bound(problem) is problem


# --- determinism and size -----------------------------------------------------------------------


@pytest.mark.slow
def test_the_order_of_the_input_does_not_matter() -> None:
    for seed in range(20):
        rng = random.Random(seed)
        document = kitchen_task(rng, 12).model_dump(mode="json", exclude_unset=True)
        first = bounded(lower(Task.model_validate(document))).bounds.makespan
        for part in ("actions", "resources", "precedence"):
            rng.shuffle(document[part])
        assert bounded(lower(Task.model_validate(document))).bounds.makespan == first


def layered(activities: int, resources: int) -> Problem:
    """A long contended problem, made directly: each activity waits for two before it."""
    rng = random.Random(activities)
    arcs = {
        Arc(rng.randrange(max(0, i - 30), i), i, min_lag=rng.choice((0, 0, 1, 3)))
        for i in range(1, activities)
        for _ in range(2)
    }
    stations = [Renewable(f"r{r}", rng.choice((1, 1, 2, 3))) for r in range(resources)]
    return Problem(
        name=None,
        time_unit="s",
        tick=Fraction(1),
        activities=tuple(
            _user(f"a{i}", rng.randint(1, 9), rng.randrange(resources)) for i in range(activities)
        ),
        resources=tuple(stations),
        contention=Contention(
            tuple(ContendedPool(r.id, r.capacity, (k,)) for k, r in enumerate(stations))
        ),
        arcs=tuple(sorted(arcs)),
    )


def _user(name: str, duration: int, resource: int) -> Activity:
    return Activity(
        name,
        duration,
        duration,
        uses=(Requirement((resource,), 1),),
        open_demands=(OpenDemand(0, (resource,), 1),),
    )


@pytest.mark.slow
@pytest.mark.parametrize(("activities", "seconds"), [(100, 1), (1_000, 3), (10_000, 5)])
def test_the_bounds_take_little_time_on_large_problems(activities: int, seconds: float) -> None:
    problem = prepared(layered(activities, 20))
    began = time.process_time()
    both = destructive_bound(energy_bound(problem))
    assert time.process_time() - began < seconds
    assert both.bounds.makespan.value > problem.bounds.makespan.value


def test_beyond_the_size_limit_only_the_energy_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = energy_bound(prepared(layered(300, 6)))
    assert destructive_bound(problem).bounds.makespan.value > problem.bounds.makespan.value
    monkeypatch.setattr(destructive, "SIZE_LIMIT", 299)
    assert destructive_bound(problem) is problem


def test_beyond_the_pairs_limit_the_bound_is_still_true(monkeypatch: pytest.MonkeyPatch) -> None:
    capacity, jobs, value = RULES["what comes second starts later"]
    problem = energy_bound(on_one_resource(capacity, jobs))
    monkeypatch.setattr(destructive, "DEPTH_LIMIT", 0)
    monkeypatch.setattr(destructive, "PAIRS_LIMIT", 1)
    assert problem.bounds.makespan.value <= destructive_bound(problem).bounds.makespan.value < value


def test_of_many_times_an_even_choice_is_looked_at() -> None:
    assert thinned({5, 1, 9}, 3) == [1, 5, 9]
    assert thinned(range(1000), 4) == [0, 250, 500, 750]


def test_no_more_steps_are_spent_than_allowed(monkeypatch: pytest.MonkeyPatch) -> None:
    """However hard the task: the budget is all there is, whatever the machine."""
    spent: list[int] = []
    real = destructive._Refuter._spend

    def counted(self: Any, steps: int) -> None:
        spent.append(steps)
        real(self, steps)

    monkeypatch.setattr(destructive._Refuter, "_spend", counted)
    bounded(layered(300, 6))
    most = destructive.BASE_STEPS + destructive.STEPS_PER_ACTIVITY * 300
    assert most / 2 < sum(spent) < 1.1 * most
