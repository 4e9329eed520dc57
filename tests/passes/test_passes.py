"""The passes leave out only what follows, and settle only what costs nothing."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

import networkx as nx
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from builders import problem_of
from irc.lowering.lower import lower
from irc.model import DurationRange, Task
from irc.passes import PASSES, reduction, run_passes
from irc.passes.contention import drop_uncontended, merge_pools
from irc.passes.critical_path import heads_and_tails
from irc.passes.reduction import reduce_transitively, redundant_arcs
from irc.problem import Activity, Arc, OpenDemand, Problem
from irc.schedule import Status
from irc.targets import Budget, Program, SolveOptions, get_backend
from irc.validation import validate
from oracles.brute_force import optimal_makespan
from oracles.generators import contended_task, random_task

RESOURCE_FREE: dict[str, Any] = {"resources": (0, 0), "tighten": 0.0}


# --- transitive reduction -----------------------------------------------------------------------


@st.composite
def orders(draw: st.DrawFn) -> Problem:
    """Activities and an acyclic set of arcs of all kinds, each pair of either kind at most once."""
    size = draw(st.integers(1, 9))
    rank = draw(st.permutations(range(size)))
    pairs = [(a, b) for i, a in enumerate(rank) for b in rank[i + 1 :]]
    chosen = draw(st.lists(st.sampled_from(pairs), unique=True)) if pairs else []
    kinds = [(True, False, 0, None)] * 4 + [
        (True, False, 2, None),
        (True, False, 0, 3),
        (True, False, -1, None),
        (False, False, 0, None),
        (True, True, 0, None),
    ]
    arcs = [Arc(a, b, *draw(st.sampled_from(kinds)), k) for k, (a, b) in enumerate(chosen)]
    lengths = draw(st.lists(st.integers(0, 5), min_size=size, max_size=size))
    activities = tuple(Activity(f"a{i}", n, n) for i, n in enumerate(lengths))
    return Problem(None, "s", Fraction(1), activities, arcs=tuple(arcs))


def plain(arc: Arc) -> bool:
    return arc[2:6] == (True, False, 0, None)


def before(problem: Problem) -> nx.DiGraph:
    """Who is wholly before whom, by finish-start arcs with lags of 0 or more."""
    graph = nx.DiGraph()
    graph.add_nodes_from(range(len(problem.activities)))
    graph.add_edges_from(
        arc[:2] for arc in problem.arcs if arc.from_end and not arc.to_end and arc.min_lag >= 0
    )
    return graph


@pytest.mark.slow
@given(orders())
def test_reduction_keeps_who_is_before_whom(problem: Problem) -> None:
    reduced = reduce_transitively(problem)
    closures = [nx.transitive_closure_dag(before(p)).edges for p in (problem, reduced)]
    assert set(closures[0]) == set(closures[1])


@pytest.mark.slow
@given(orders())
def test_reduction_takes_away_every_plain_arc_that_follows_and_nothing_else(
    problem: Problem,
) -> None:
    needed = set(nx.transitive_reduction(before(problem)).edges)
    expected = [arc for arc in problem.arcs if not plain(arc) or arc[:2] in needed]
    assert list(reduce_transitively(problem).arcs) == expected


@pytest.mark.slow
@given(orders())
def test_reduction_moves_nothing(problem: Problem) -> None:
    try:
        heads, bound = (p := heads_and_tails(problem)).bounds.heads, p.bounds.makespan
    except ValueError:
        return
    reduced = heads_and_tails(reduce_transitively(problem))
    assert (reduced.bounds.heads, reduced.bounds.makespan) == (heads, bound)
    assert reduced.bounds.tails == p.bounds.tails


@pytest.mark.slow
@settings(max_examples=30)
@given(orders())
def test_beyond_the_limit_fewer_arcs_go_but_none_that_is_needed(problem: Problem) -> None:
    everything = set(redundant_arcs(problem))
    limit, reduction.FULL_REDUCTION_LIMIT = reduction.FULL_REDUCTION_LIMIT, 0
    try:
        found = set(redundant_arcs(problem))
    finally:
        reduction.FULL_REDUCTION_LIMIT = limit
    assert found <= everything
    graph = before(problem)
    over_one = {
        k
        for k, arc in enumerate(problem.arcs)
        if plain(arc) and any(graph.has_edge(w, arc.after) for w in graph[arc.before])
    }
    assert found == over_one


def test_no_arc_follows_from_a_cycle() -> None:
    activities = tuple(Activity(name, 0, 0) for name in "abc")
    arcs = (Arc(0, 1), Arc(1, 0), Arc(1, 2), Arc(0, 2))
    assert redundant_arcs(Problem(None, "s", Fraction(1), activities, arcs=arcs)) == []


def test_no_arc_follows_through_an_action_that_may_be_absent() -> None:
    problem = problem_of(
        actions=[
            {"id": "a", "duration": 1},
            {"id": "b", "duration": 1, "occurs": "optional"},
            {"id": "c", "duration": 1},
        ],
        precedence=[["a", "b"], ["b", "c"], ["a", "c"]],
    )
    assert [arc.origin for arc in reduce_transitively(problem).arcs] == [0, 2, 1]


# --- pools --------------------------------------------------------------------------------------

POOL = {"one_of": ["r1", "r2"]}


def uses(*wanted: list[dict[str, Any]], capacities: Sequence[int] = (1, 1, 1)) -> Problem:
    """One action of length 2 for each list of uses, over resources r1, r2, …"""
    return problem_of(
        resources=[{"id": f"r{k + 1}", "capacity": c} for k, c in enumerate(capacities)],
        actions=[{"id": f"a{i + 1}", "duration": 2, "uses": w} for i, w in enumerate(wanted)],
    )


def test_resources_that_are_only_asked_for_together_become_one() -> None:
    problem = merge_pools(uses([POOL], [POOL, {"resource": "r3"}], [POOL], capacities=(1, 2, 1)))
    assert [(s.id, s.capacity, s.members) for s in problem.contention.pools] == [
        ("r3", 1, (2,)),
        ("r1|r2", 3, (0, 1)),
    ]
    assert problem.activities[1].open_demands == (OpenDemand(0, (1,), 1), OpenDemand(1, (0,), 1))


@pytest.mark.parametrize(
    "other",
    [
        {"resource": "r1"},
        {"resource": "r2"},
        {"one_of": ["r2", "r3"]},
        {"one_of": ["r1", "r2", "r3"]},
        {"one_of": ["r1", "r2"], "amount": 2},
    ],
)
@pytest.mark.parametrize("first", [True, False])
def test_resources_that_can_be_told_apart_stay_apart(other: dict[str, Any], first: bool) -> None:
    wanted = [[POOL], [POOL], [other]]
    problem = uses(*(reversed(wanted) if first else wanted), capacities=(2, 2, 2))
    assert merge_pools(problem) is problem


def test_a_pool_that_meets_a_spoilt_pool_is_spoilt_too() -> None:
    chain = [[{"one_of": pair}] for pair in (["r1", "r2"], ["r2", "r3"], ["r3", "r4"])]
    problem = uses(*chain, capacities=(1, 1, 1, 1))
    assert merge_pools(problem) is problem


# --- contention ---------------------------------------------------------------------------------


def test_claims_on_resources_with_room_for_all_at_once_are_settled() -> None:
    problem = drop_uncontended(
        uses(
            [{"resource": "r1"}, {"resource": "r3"}],
            [{"one_of": ["r1", "r2"], "amount": 2}, {"resource": "r3"}],
            capacities=(2, 2, 1),
        )
    )
    assert [a.open_demands for a in problem.activities] == [
        (OpenDemand(1, (2,), 1),),
        (OpenDemand(1, (2,), 1),),
    ]
    assert problem.contention.fixed_choices == {(0, 0): 0, (1, 0): 1}


def test_a_settled_choice_relieves_the_other_resources() -> None:
    both = [{"one_of": ["r1", "r2"]}]
    problem = drop_uncontended(uses(both, [{"resource": "r1"}], capacities=(1, 1)))
    assert not problem.has_contention
    assert problem.contention.fixed_choices == {(0, 0): 1, (1, 0): 0}


def test_contended_claims_stay() -> None:
    problem = uses([{"resource": "r1"}], [{"resource": "r1"}], capacities=(1,))
    assert drop_uncontended(problem).activities == problem.activities


Pass = Callable[[Problem], Problem]
ROADS: dict[str, tuple[Pass, ...]] = {
    "nothing": (heads_and_tails,),
    "pools": (merge_pools, heads_and_tails),
    "contention": (drop_uncontended, heads_and_tails),
    "both": (merge_pools, drop_uncontended, heads_and_tails),
    "all": PASSES,
}


def small_tasks(count: int) -> list[Task]:
    tasks = [
        random_task(random.Random(f"passes {seed}"), actions=(3, 6), resources=(2, 3), tighten=0.0)
        for seed in range(count)
    ]
    return tasks + [
        contended_task(random.Random(f"robots {seed}"), 4 + seed % 4) for seed in range(count // 2)
    ]


@pytest.mark.slow
@pytest.mark.parametrize("road", ROADS)
def test_the_passes_keep_the_optimum(road: str) -> None:
    backend = get_backend("cpsat")
    engine = backend.engines()["ortools"]
    changed = 0
    for task in small_tasks(40):
        problem = run_passes(lower(task), ROADS[road])
        changed += problem.contention.pools != lower(task).contention.pools or bool(
            problem.contention.fixed_choices
        )
        outcome = engine.solve(Program(backend, task, problem), SolveOptions(workers=1), Budget())
        assert outcome.status is Status.OPTIMAL
        assert outcome.schedule is not None
        assert validate(task, outcome.schedule).valid
        assert outcome.schedule.makespan == optimal_makespan(task)
    assert changed > 20 or road == "nothing"


# --- heads, tails, critical path ----------------------------------------------------------------


def distances(task: Task) -> nx.DiGraph:
    """Costs whose shortest paths are the longest paths between the points of a task."""
    graph = nx.DiGraph()

    def least(u: Any, v: Any, weight: Any) -> None:
        if not graph.has_edge(u, v) or graph.edges[u, v]["weight"] > -weight:
            graph.add_edge(u, v, weight=-weight)

    for action in task.actions:
        start, end = (action.id, "start"), (action.id, "finish")
        length = action.duration
        ranged = isinstance(length, DurationRange)
        least(start, end, length.min if ranged else length)
        least(end, start, -(length.max if ranged else length))
        least("zero", start, max(0, action.release, action.start or 0))
        least(end, "makespan", 0)
    for edge in task.precedence:
        one, other = edge.type.split("-")
        u, v = (edge.before, one), (edge.after, other)
        least(u, v, edge.min_lag)
        if edge.max_lag is not None:
            least(v, u, -edge.max_lag)
    return graph


@pytest.mark.parametrize("seed", range(60))
def test_heads_and_tails_are_longest_paths(seed: int) -> None:
    task = random_task(random.Random(f"paths {seed}"), **RESOURCE_FREE)
    problem = heads_and_tails(lower(task))
    tick, graph = problem.tick, distances(task)
    lengths = nx.single_source_bellman_ford_path_length(graph, "zero")
    for activity, head, tail in zip(
        problem.activities, problem.bounds.heads, problem.bounds.tails, strict=True
    ):
        assert head * tick == -lengths[activity.id, "start"]
        to_end = nx.bellman_ford_path_length(graph, (activity.id, "finish"), "makespan")
        assert tail * tick == -to_end
    assert problem.bounds.makespan.value * tick == -lengths["makespan"]


@pytest.mark.parametrize("seed", range(40))
def test_without_resources_the_critical_path_is_the_optimum(seed: int) -> None:
    task = random_task(random.Random(f"critical {seed}"), **RESOURCE_FREE)
    problem = heads_and_tails(lower(task))
    assert problem.to_units(problem.bounds.makespan.value) == optimal_makespan(task)


def test_a_contradiction_is_an_error_of_the_caller() -> None:
    edge = {"before": "a", "after": "a2", "min_lag": 3, "max_lag": 1}
    problem = problem_of(
        actions=[{"id": "a", "duration": 1}, {"id": "a2", "duration": 1}], precedence=[edge]
    )
    with pytest.raises(ValueError, match="contradict each other"):
        heads_and_tails(problem)
