"""Least times of temporal networks, against Bellman–Ford and networkx on random graphs."""

from __future__ import annotations

import random
from collections.abc import Iterable

import networkx as nx
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from irc.lowering.lower import lower
from irc.problem.temporal_network import Network, components, earliest, is_acyclic
from irc.problem.time_points import DURATION, point_map, timing_network
from oracles.generators import random_task

Edge = tuple[int, int, int]


def network_of(size: int, edges: Iterable[Edge]) -> Network:
    network = Network(size)
    for src, dst, weight in edges:
        network.add(src, dst, weight)
    return network


@st.composite
def graphs(draw: st.DrawFn) -> tuple[int, list[Edge], list[int]]:
    """Points, edges of any sign (loops and repetitions too), and floors."""
    size = draw(st.integers(1, 9))
    point = st.integers(0, size - 1)
    edges = draw(st.lists(st.tuples(point, point, st.integers(-6, 4)), max_size=20))
    return size, edges, draw(st.lists(st.integers(-3, 9), min_size=size, max_size=size))


def bellman_ford(size: int, edges: list[Edge], floors: list[int]) -> list[int] | None:
    """The least times, by rounds over all edges; None where they grow without end."""
    times = list(floors)
    for _ in range(size):
        for src, dst, weight in edges:
            times[dst] = max(times[dst], times[src] + weight)
    done = all(times[dst] >= times[src] + weight for src, dst, weight in edges)
    return times if done else None


def positive_components(size: int, edges: list[Edge]) -> set[frozenset[int]]:
    """The strongly connected components with a positive cycle, by networkx."""
    graph = nx.MultiDiGraph()
    graph.add_nodes_from(range(size))
    graph.add_weighted_edges_from((src, dst, -weight) for src, dst, weight in edges)
    found = set()
    for members in nx.strongly_connected_components(graph):
        inner = nx.DiGraph()
        inner.add_nodes_from(members)
        for src, dst, cost in graph.subgraph(members).edges(data="weight"):
            if not inner.has_edge(src, dst) or inner.edges[src, dst]["weight"] > cost:
                inner.add_edge(src, dst, weight=cost)
        if nx.negative_edge_cycle(inner):
            found.add(frozenset(members))
    return found


@pytest.mark.slow
@settings(max_examples=200)
@given(graphs())
def test_times_are_those_of_bellman_ford(case: tuple[int, list[Edge], list[int]]) -> None:
    size, edges, floors = case
    times = earliest(network_of(size, edges), floors)
    expected = bellman_ford(size, edges, floors)
    assert bool(times.cycles) == (expected is None)
    if expected is not None:
        assert times.t == expected


@pytest.mark.slow
@settings(max_examples=200)
@given(graphs())
def test_every_component_with_a_positive_cycle_shows_one(
    case: tuple[int, list[Edge], list[int]],
) -> None:
    size, edges, floors = case
    network = network_of(size, edges)
    shown = []
    for cycle in earliest(network, floors).cycles:
        assert sum(network.weight[e] for e in cycle) > 0
        for edge, following in zip(cycle, [*cycle[1:], cycle[0]], strict=True):
            assert network.dst[edge] == network.src[following]
        assert len({network.src[e] for e in cycle}) == len(cycle)
        shown.append(frozenset(network.src[e] for e in cycle))
    contradictory = positive_components(size, edges)
    assert len(shown) == len(contradictory)
    assert all(any(points <= members for members in contradictory) for points in shown)


@pytest.mark.slow
@given(graphs())
def test_the_chain_behind_a_time_adds_up_to_it(case: tuple[int, list[Edge], list[int]]) -> None:
    size, edges, floors = case
    network = network_of(size, edges)
    times = earliest(network, floors)
    if times.cycles:
        return
    for point in range(size):
        chain = times.chain(point, network)
        first = network.src[chain[0]] if chain else point
        assert floors[first] + sum(network.weight[e] for e in chain) == times.t[point]
        assert times.cause[first] == -1


@pytest.mark.slow
@given(graphs())
def test_least_times_leave_every_time_pressed_from_behind(
    case: tuple[int, list[Edge], list[int]],
) -> None:
    size, edges, floors = case
    times = earliest(network_of(size, edges), floors)
    if times.cycles:
        return
    t = times.t
    for point in range(size):
        pressed = [t[src] + weight for src, dst, weight in edges if dst == point]
        assert t[point] == max([floors[point], *pressed])


@pytest.mark.slow
@given(graphs())
def test_distances_to_the_end_are_those_from_it_turned_round(
    case: tuple[int, list[Edge], list[int]],
) -> None:
    size, edges, floors = case
    turned = network_of(size, [(dst, src, weight) for src, dst, weight in edges])
    backward = earliest(network_of(size, edges).reversed(), floors)
    assert backward.t == earliest(turned, floors).t


@pytest.mark.slow
@given(graphs())
def test_components_are_those_of_networkx_in_topological_order(
    case: tuple[int, list[Edge], list[int]],
) -> None:
    size, edges, _ = case
    network = network_of(size, edges)
    leaving: list[list[int]] = [[] for _ in range(size)]
    for k, (src, _, _) in enumerate(edges):
        leaving[src].append(k)
    found = components(network, leaving, range(size))
    graph = nx.DiGraph([(src, dst) for src, dst, _ in edges])
    graph.add_nodes_from(range(size))
    assert set(map(frozenset, found)) == set(
        map(frozenset, nx.strongly_connected_components(graph))
    )
    place = {point: k for k, members in enumerate(found) for point in members}
    assert all(place[src] <= place[dst] for src, dst, _ in edges)


@pytest.mark.slow
@given(graphs())
def test_acyclic_means_what_networkx_says(case: tuple[int, list[Edge], list[int]]) -> None:
    size, edges, _ = case
    graph = nx.DiGraph([(src, dst) for src, dst, _ in edges])
    graph.add_nodes_from(range(size))
    assert is_acyclic(size, edges) == nx.is_directed_acyclic_graph(graph)


def test_the_points_of_a_contradiction_keep_what_came_from_outside() -> None:
    edges = [(0, 1, 5), (1, 2, 1), (2, 1, 0), (2, 3, 2)]
    times = earliest(network_of(4, edges), [1, 0, 0, 0])
    assert sorted(times.cycles[0]) == [1, 2]
    assert times.t == [1, 6, 0, 2]


@pytest.mark.slow
@pytest.mark.parametrize("where", [0, 10_000, 19_998])
def test_a_contradiction_in_a_long_chain_is_found_in_little_time(where: int) -> None:
    size = 20_000
    edges = [(i, i + 1, 2) for i in range(size - 1)]
    edges += [(i + 1, i, -1 if i == where else -2) for i in range(size - 1)]
    (cycle,) = earliest(network_of(size, edges), [0] * size).cycles
    assert sorted(cycle) == [where, size - 1 + where]


@pytest.mark.slow
def test_many_small_components_in_a_row_are_settled_in_little_time() -> None:
    size = 20_000
    edges = [(2 * i, 2 * i + 1, 2) for i in range(size)]
    edges += [(2 * i + 1, 2 * i, -5) for i in range(size)]
    edges += [(2 * i + 1, 2 * i + 2, 1) for i in range(size - 1)]
    times = earliest(network_of(2 * size, edges), [0] * 2 * size)
    assert times.t[-1] == 3 * size - 1


@pytest.mark.slow
@pytest.mark.parametrize("size", [2_000, 20_000])
def test_a_long_cycle_of_lags_is_settled_in_little_time(size: int) -> None:
    forward = [(i, i + 1, 2) for i in range(size - 1)]
    backward = [(i + 1, i, -2) for i in range(size - 1)]
    times = earliest(network_of(size, forward + backward), [0] * size)
    assert times.t == [2 * i for i in range(size)]


@pytest.mark.slow
def test_a_ladder_that_is_hard_for_label_correction_is_still_exact() -> None:
    rng = random.Random(7)
    size = 300
    edges = [
        (i, j, rng.randint(-9, 9)) for i in range(size) for j in rng.sample(range(i), min(i, 3))
    ]
    edges = [(src, dst, weight + (dst - src) * 20) for src, dst, weight in edges]
    edges += [(dst, src, -weight - 1) for src, dst, weight in edges]
    floors = [rng.randint(0, 50) for _ in range(size)]
    times = earliest(network_of(size, edges), floors)
    expected = bellman_ford(size, edges, floors)
    assert times.cycles == [] if expected is not None else times.cycles
    if expected is not None:
        assert times.t == expected


# --- the network of a task ----------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(40))
def test_the_network_of_a_task_holds_its_durations_and_lags(seed: int) -> None:
    """A schedule keeps the network exactly if it keeps durations and precedences, read plainly."""
    rng = random.Random(f"network {seed}")
    problem = lower(random_task(rng, resources=(0, 0), tighten=0.5))
    timing = timing_network(problem)
    points, network = timing.points, timing.network
    for _ in range(60):
        starts = [rng.randint(0, 12) for _ in problem.activities]
        lengths = [rng.randint(a.duration_min, a.duration_max) for a in problem.activities]
        if rng.random() < 0.2 and lengths:
            k = rng.randrange(len(lengths))
            lengths[k] += rng.choice((-1, 1)) * (points.start[k] != points.end[k])
        ends = [s + n for s, n in zip(starts, lengths, strict=True)]
        t = [0] * points.size
        for i, (start, end) in enumerate(zip(starts, ends, strict=True)):
            t[points.start[i]] = start
            if points.start[i] != points.end[i]:
                t[points.end[i]] = end
        kept = all(
            t[v] >= t[u] + w
            for u, v, w in zip(network.src, network.dst, network.weight, strict=True)
        )
        lags = [
            (
                (ends if a.to_end else starts)[a.after]
                - (ends if a.from_end else starts)[a.before],
                a,
            )
            for a in problem.arcs
        ]
        wanted = all(
            a.min_lag <= lag and (a.max_lag is None or lag <= a.max_lag) for lag, a in lags
        ) and all(
            a.duration_min <= n <= a.duration_max
            for a, n in zip(problem.activities, lengths, strict=True)
        )
        assert kept == wanted


def test_without_maxima_only_what_pushes_later_is_left() -> None:
    from irc.model import Task

    task = Task.model_validate(
        {
            "actions": [{"id": "a", "duration": {"min": 1, "max": 4}}, {"id": "b", "duration": 2}],
            "precedence": [{"before": "a", "after": "b", "min_lag": 1, "max_lag": 3}],
        }
    )
    problem = lower(task)
    full, least = timing_network(problem), timing_network(problem, maxima=False)
    assert [is_max for _, is_max in full.labels] == [False, True, False, True]
    assert least.labels == [(DURATION, False), (0, False)]
    assert least.network.weight == [1, 1]
    assert point_map(problem).size == 3
