"""Re-timing: choices and order in, the one earliest schedule out, whatever the times were."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import permutations, product
from typing import Any

import networkx as nx
import pytest

from irc.lowering.lower import lower
from irc.model import Task
from irc.passes import run_passes
from irc.problem import Problem, Requirement
from irc.problem.decisions import AnswerError, Decision, Placed
from irc.problem.time_points import timing_network
from irc.retiming.resources import assign, resource_orders
from irc.retiming.retime import earliest_schedule, retime
from irc.retiming.to_schedule import schedule_of
from irc.validation import validate
from oracles.brute_force import optimal_makespan, optimal_schedule
from oracles.generators import big_capacity_task, random_task

EPSILON = Fraction(1, 1000)

LOOSE: dict[str, Any] = {
    **dict.fromkeys(("max_lags", "windows", "fixed_starts", "task_deadline"), False),
    "tighten": 0.0,
    "actions": (3, 8),
}
"""Tasks without bounds from above: any order of the actions gives a schedule."""


def some_schedule(problem: Problem, rng: random.Random) -> list[Decision]:
    """A valid schedule with idle times, longer durations than needed, and random choices."""
    held: list[tuple[int, int, int, int]] = []
    decisions: dict[int, Decision] = {}
    for i in sorted(
        range(len(problem.activities)), key=lambda i: int(problem.activities[i].id[1:])
    ):
        activity = problem.activities[i]
        length = rng.randint(activity.duration_min, activity.duration_max)
        chosen = tuple(rng.choice(use.alternatives) for use in activity.uses)
        start = activity.release + rng.choice((0, 0, 1, 5))
        for arc in problem.arcs:
            if arc.after == i:
                from_ = decisions[arc.before]
                point = int(from_.end if arc.from_end else from_.start) + arc.min_lag
                start = max(start, point - length if arc.to_end else point)
        while not fits(problem, i, Decision(start, start + length, chosen), held):
            start += 1
            if start > 1000:  # Two uses fell on a resource too small for both.
                chosen = tuple(rng.choice(use.alternatives) for use in activity.uses)
                start = 0
        decisions[i] = Decision(start, start + length, chosen)
        held += [
            (r, start, start + length, use.amount)
            for r, use in zip(chosen, activity.uses, strict=True)
        ]
    return [decisions[i] for i in range(len(problem.activities))]


def fits(problem: Problem, i: int, decision: Decision, held: list[Any]) -> bool:
    uses = problem.activities[i].uses
    mine = [
        (r, decision.start, decision.end, u.amount)
        for r, u in zip(decision.chosen, uses, strict=True)
    ]
    everything = [*held, *mine]
    return all(
        sum(a for s, b, e, a in everything if s == r and b <= t < e)
        <= problem.resources[r].capacity
        for r, _, _, _ in mine
        for t in range(int(decision.start), int(decision.end))
    )


def answers(count: int, **knobs: Any) -> Iterator[tuple[Task, Problem, list[Decision]]]:
    for seed in range(count):
        rng = random.Random(f"retime {seed}")
        task = random_task(rng, **{**LOOSE, **knobs})
        problem = lower(task)
        yield task, problem, some_schedule(problem, rng)


def decided(placed: Sequence[Placed]) -> list[Decision]:
    return [Decision(p.start, p.end, p.resources) for p in placed]


def is_valid(task: Task, problem: Problem, placed: Sequence[Placed]) -> bool:
    return validate(task, schedule_of(problem, placed)).valid


def sharing(problem: Problem, placed: Sequence[Placed]) -> Iterator[tuple[int, int]]:
    """Ordered pairs of activities that hold a common resource for some time."""
    busy = [i for i, p in enumerate(placed) if p.end > p.start]
    yield from (
        (i, j)
        for i, j in permutations(busy, 2)
        if set(placed[i].resources) & set(placed[j].resources)
    )


@pytest.mark.slow
def test_the_answer_is_the_earliest_of_its_choices_and_order() -> None:
    """Against longest paths over *all* pairs in order, by networkx."""
    for task, problem, decisions in answers(80):
        placed = retime(problem, decisions)
        assert is_valid(task, problem, placed)
        timing = timing_network(problem)
        points, graph = timing.points, nx.DiGraph()
        edges = list(
            zip(timing.network.src, timing.network.dst, timing.network.weight, strict=True)
        )
        edges += [
            (points.end[i], points.start[j], points.end_offset[i])
            for i, j in sharing(problem, placed)
            if decisions[i].end <= decisions[j].start
        ]
        # What has no length must not grow into somebody else's time.
        edges += [
            (points.end[i], s, 0)
            for i, s in enumerate(points.start)
            if s != points.end[i] and placed[i].start == placed[i].end
        ]
        edges += [("zero", point, floor) for point, floor in enumerate(timing.floors)]
        for u, v, weight in edges:
            if not graph.has_edge(u, v) or graph.edges[u, v]["weight"] > -weight:
                graph.add_edge(u, v, weight=-weight)
        lengths = nx.single_source_bellman_ford_path_length(graph, "zero")
        assert [p.start for p in placed] == [-lengths[s] for s in points.start]
        assert all(p.start <= d.start for p, d in zip(placed, decisions, strict=True))


def test_order_and_choices_are_kept() -> None:
    pairs = 0
    for _, problem, decisions in answers(80, ranges=False):
        placed = retime(problem, decisions)
        assert [p.resources for p in placed] == [d.chosen for d in decisions]
        for i, j in sharing(problem, placed):
            if decisions[i].end <= decisions[j].start:
                assert placed[i].end <= placed[j].start
                pairs += 1
    assert pairs > 200


def test_re_timing_twice_changes_nothing() -> None:
    for _, problem, decisions in answers(80):
        placed = retime(problem, decisions)
        assert retime(problem, decided(placed)) == placed


def test_equal_choices_and_order_give_equal_schedules() -> None:
    for _, problem, decisions in answers(60):
        placed = retime(problem, decisions)
        stretched = [replace(d, start=7 * d.start + 3, end=7 * d.end + 3) for d in decisions]
        assert retime(problem, stretched) == placed


def test_drift_and_rounding_within_the_tolerance_change_nothing() -> None:
    """A planner separates dependent happenings, and prints three decimals."""
    for k, (_, problem, decisions) in enumerate(answers(60, ranges=False)):
        rng = random.Random(k)
        placed = retime(problem, decisions)
        drifted = []
        for d in decisions:
            late = rng.choice((0, 0, EPSILON / 2, EPSILON / 2 - EPSILON))
            drifted.append(replace(d, start=d.start + late, end=d.end + late))
        assert retime(problem, drifted, EPSILON * Fraction(3, 2)) == placed


@pytest.mark.slow
def test_an_optimal_schedule_stays_optimal() -> None:
    for seed in range(80):
        task = random_task(random.Random(f"optimum {seed}"), tighten=0.0)
        problem, best = lower(task), optimal_schedule(task)
        assert best is not None
        tick = problem.tick
        index = {r.id: k for k, r in enumerate(problem.resources)}
        decisions = []
        for activity in problem.activities:
            held = {index[r]: amount for r, amount in best.resources[activity.id].items()}
            chosen = next(
                choice
                for choice in product(*(use.alternatives for use in activity.uses))
                if amounts(choice, activity.uses) == held
            )
            start, end = best.starts[activity.id], best.ends[activity.id]
            decisions.append(Decision(start / tick, end / tick, chosen))
        placed = retime(problem, decisions)
        assert problem.to_units(max((p.end for p in placed), default=0)) == best.makespan
        assert is_valid(task, problem, placed)


def amounts(choice: Sequence[int], uses: Sequence[Requirement]) -> dict[int, int]:
    held: dict[int, int] = {}
    for r, use in zip(choice, uses, strict=True):
        held[r] = held.get(r, 0) + use.amount
    return held


# --- tolerance ----------------------------------------------------------------------------------


def problem_of(*actions: dict[str, Any], capacity: int = 1, **more: Any) -> Problem:
    """Actions a, b, … on one resource r (or two robots for those that say "one_of")."""
    listed = [
        {"id": "abcdefg"[k], "uses": [{"resource": "r"}], **action}
        for k, action in enumerate(actions)
    ]
    resources = [{"id": "r", "capacity": capacity}, {"id": "r1"}, {"id": "r2"}]
    return lower(Task.model_validate({"resources": resources, "actions": listed, **more}))


@pytest.mark.parametrize("early", [0, 3])
def test_an_end_just_after_the_next_start_still_counts_as_before_it(early: int) -> None:
    problem = problem_of({"duration": 5}, {"duration": 4})
    decisions = [Decision(0, 5), Decision(5 - Fraction(early, 2000), 9)]
    placed = retime(problem, decisions, Fraction(3, 2000))
    assert placed[1].start == 5


def test_an_overlap_beyond_the_tolerance_overbooks_the_resource() -> None:
    problem = problem_of({"duration": 5}, {"duration": 4})
    decisions = [Decision(0, 5), Decision(5 - Fraction(4, 2000), 9)]
    with pytest.raises(AnswerError, match="more of 'r' is held"):
        retime(problem, decisions, Fraction(3, 2000))


@pytest.mark.parametrize("tolerance", [0, Fraction(3, 2000)])
def test_a_member_of_a_pool_is_free_again_within_the_tolerance(tolerance: Any) -> None:
    wanted = {"duration": 3, "uses": [{"one_of": ["r1", "r2"]}]}
    problem = problem_of(wanted, wanted, {**wanted, "duration": 4})
    early = tolerance * Fraction(2, 3)
    decisions = [Decision(0, 3), Decision(0, 3), Decision(3 - early, 7)]
    placed = retime(problem, decisions, tolerance)
    assert [p.resources for p in placed] == [(1,), (2,), (1,)]
    assert placed[2].start == 3


# --- pools --------------------------------------------------------------------------------------


def test_members_of_pools_are_told_apart_wherever_the_summed_capacity_is_kept() -> None:
    """Interval graphs are perfect: by order of start nobody is left without."""
    for seed in range(60):
        rng = random.Random(f"pool {seed}")
        robots = [{"id": f"r{k}", "capacity": rng.randint(1, 2)} for k in range(3)]
        capacity = sum(r["capacity"] for r in robots)
        spans = [(s := rng.randint(0, 9), s + rng.randint(0, 5)) for _ in range(12)]
        while any(sum(s <= t < e for s, e in spans) > capacity for t in range(15)):
            spans.pop()
        uses = [{"one_of": [r["id"] for r in robots]}]
        actions = [
            {"id": f"a{k:02}", "duration": e - s, "uses": uses} for k, (s, e) in enumerate(spans)
        ]
        task = Task.model_validate(
            {"resources": robots, "actions": [*actions, {"id": "z", "duration": 1}]}
        )
        problem = lower(task)
        decisions = [Decision(s, e) for s, e in spans] + [Decision(0, 1)]
        chosen = assign(problem, decisions)
        for r, robot in enumerate(problem.resources):
            for t in range(15):
                users = sum(r in c and s <= t < e for c, (s, e) in zip(chosen, spans, strict=False))
                assert users <= robot.capacity
        assert is_valid(task, problem, retime(problem, decisions))


def test_what_passes_have_settled_is_taken() -> None:
    wanted = {"duration": 3, "uses": [{"one_of": ["r1", "r2"]}]}
    fixed = {"duration": 3, "uses": [{"resource": "r1"}]}
    problem = run_passes(problem_of(wanted, fixed))
    assert [p.resources for p in earliest_schedule(problem)] == [(2,), (1,)]


def test_an_engines_choice_is_kept_even_where_another_would_be_free() -> None:
    wanted = {"duration": 3, "uses": [{"one_of": ["r1", "r2"]}]}
    problem = problem_of(wanted, wanted)
    placed = retime(problem, [Decision(0, 3, (2,)), Decision(3, 6, (2,))])
    assert placed == (Placed(0, 1, (2,)), Placed(1, 2, (2,)))  # One tick is 3 s.


# --- capacity -----------------------------------------------------------------------------------


def test_only_few_of_the_pairs_in_order_are_stated_and_the_others_follow() -> None:
    for seed in range(40):
        rng = random.Random(f"orders {seed}")
        task = (big_capacity_task if seed % 2 else random_task)(
            rng, **{**LOOSE, "ranges": False, "one_of": False, "actions": (6, 12)}
        )
        problem = lower(task)
        decisions = some_schedule(problem, rng)
        chosen = assign(problem, decisions)
        stated = nx.DiGraph(resource_orders(problem, decisions, chosen, 0))
        placed = [
            Placed(int(d.start), int(d.end), c) for d, c in zip(decisions, chosen, strict=True)
        ]
        everything = nx.DiGraph(
            (i, j) for i, j in sharing(problem, placed) if placed[i].end <= placed[j].start
        )
        used = {r for resources in chosen for r in resources}
        most = sum(problem.resources[r].capacity for r in used)
        assert all(waits <= most for _, waits in stated.in_degree)
        assert set(nx.transitive_closure(stated).edges) == set(
            nx.transitive_closure(everything).edges
        )


def test_a_long_queue_on_one_resource_needs_one_arc_for_each_that_waits() -> None:
    n = 2000
    problem = lower(
        Task.model_validate(
            {
                "resources": [{"id": "r"}],
                "actions": [
                    {"id": f"a{i}", "duration": 1, "uses": [{"resource": "r"}]} for i in range(n)
                ],
            }
        )
    )
    decisions = [Decision(2 * i, 2 * i + 1) for i in range(n)]
    assert len(resource_orders(problem, decisions, [(0,)] * n, 0)) == n - 1
    assert max(p.end for p in retime(problem, decisions)) == n


def test_who_came_before_the_one_before_is_not_waited_for() -> None:
    lengths = [1, 1, 4, 2]
    problem = problem_of(*({"duration": n} for n in lengths), capacity=2)
    decisions = [Decision(0, 1), Decision(2, 3), Decision(0, 4), Decision(5, 7)]
    orders = resource_orders(problem, decisions, [(0,)] * 4, 0)
    assert sorted(orders) == [(0, 1), (1, 3), (2, 3)]


def test_freed_capacity_can_be_taken_at_the_same_instant() -> None:
    problem = problem_of({"duration": 5}, {"duration": 4}, {"duration": 3}, capacity=2)
    placed = retime(problem, [Decision(0, 5), Decision(0, 4), Decision(4, 7)])
    assert [p.start for p in placed] == [0, 0, 4]


# --- no length ----------------------------------------------------------------------------------


def test_what_has_no_length_waits_for_nobody_on_a_resource() -> None:
    problem = problem_of({"duration": 5}, {"duration": 0})
    assert [p.start for p in retime(problem, [Decision(0, 5), Decision(9, 9)])] == [0, 0]


def test_a_range_chosen_to_have_no_length_stays_without() -> None:
    problem = problem_of(
        {"duration": 4},
        {"duration": {"min": 0, "max": 9}},
        {"duration": 6, "uses": []},
        precedence=[{"before": "c", "after": "b", "type": "finish-finish"}],
    )
    placed = retime(problem, [Decision(0, 4), Decision(6, 6), Decision(0, 6)])
    assert (placed[1].start, placed[1].end) == (6, 6)


def test_nobody_waits_for_a_range_that_has_shrunk_to_nothing() -> None:
    problem = problem_of({"duration": {"min": 0, "max": 3}, "release": 10}, {"duration": 2})
    placed = retime(problem, [Decision(10, 13), Decision(13, 15)])
    assert [(p.start, p.end) for p in placed] == [(10, 10), (0, 2)]


# --- hostile answers ----------------------------------------------------------------------------


def test_an_answer_without_durations_is_read_by_its_starts() -> None:
    problem = problem_of({"duration": 5}, {"duration": 4})
    placed = retime(problem, [Decision(5, 5), Decision(0, 0)])
    assert [(p.start, p.end) for p in placed] == [(4, 9), (0, 4)]


def test_an_order_against_the_lags_is_refused() -> None:
    lag = {"before": "a", "after": "b", "type": "start-start", "max_lag": 2}
    problem = problem_of({"duration": 5}, {"duration": 4}, precedence=[lag])
    with pytest.raises(AnswerError, match="the order of the answer contradicts the lags"):
        retime(problem, [Decision(0, 5), Decision(5, 9)])


def test_an_order_against_precedence_is_refused() -> None:
    problem = problem_of({"duration": 5}, {"duration": 4}, precedence=[["a", "b"]])
    with pytest.raises(AnswerError, match="contradicts"):
        retime(problem, [Decision(4, 9), Decision(0, 4)])


def test_an_order_against_a_fixed_start_is_refused() -> None:
    problem = problem_of({"duration": 5}, {"duration": 4, "start": 3})
    with pytest.raises(AnswerError, match="'b' cannot start at its fixed time"):
        retime(problem, [Decision(0, 5), Decision(5, 9)])


def test_more_takers_than_a_pool_has_members_are_refused() -> None:
    wanted = {"duration": 3, "uses": [{"one_of": ["r1", "r2"]}]}
    problem = problem_of(wanted, wanted, {**wanted, "duration": 4})
    with pytest.raises(AnswerError, match="no resource is free for 'c'"):
        retime(problem, [Decision(0, 3), Decision(0, 3), Decision(2, 6)])


def test_times_before_zero_and_beyond_all_range_do_no_harm() -> None:
    problem = problem_of({"duration": 5}, {"duration": 4})
    placed = retime(problem, [Decision(-(10**30), -(10**30) + 5), Decision(10**30, 10**30 + 4)])
    assert [(p.start, p.end) for p in placed] == [(0, 5), (5, 9)]


# --- without contention -------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(40))
def test_without_resources_everything_starts_as_early_as_it_can(seed: int) -> None:
    task = random_task(random.Random(f"free {seed}"), resources=(0, 0), tighten=0.0)
    problem = lower(task)
    placed = earliest_schedule(problem)
    assert is_valid(task, problem, placed)
    assert problem.to_units(max((p.end for p in placed), default=0)) == optimal_makespan(task)


def test_a_contradictory_task_has_no_earliest_schedule() -> None:
    problem = problem_of({"duration": 5}, precedence=[["a", "a"]])
    assert earliest_schedule(problem) == (Placed(0, 1, (0,)),)
    problem = problem_of({"duration": 5}, {"duration": 4}, precedence=[["a", "b"], ["b", "a"]])
    with pytest.raises(AnswerError, match="contradicts itself"):
        earliest_schedule(problem)
