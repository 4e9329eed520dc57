"""Serial generation on a profile of nodes or ticks gives what a plain one gives."""

from __future__ import annotations

import random
from collections.abc import Sequence

import pytest

from builders import Document, act, after_passes
from irc.local_search import project as projects
from irc.local_search.compiled import ints
from irc.local_search.genetic import (
    COUNTS,
    JUSTIFIES,
    MOST_VISITS,
    START,
    WAY_AT,
    take,
)
from irc.local_search.ways import Ways, ways_of
from local_search_tasks import use

LEVELS = {"r": [(0, 4), (5, 2), (9, 4)], "s": [(0, 3)]}
"""The capacities of two resources, each from a time on."""


def rich_project(seed: int) -> Document:
    """Twenty activities with lags, releases, modes, pools to choose from, and some of no length."""
    rng = random.Random(seed)
    actions: list[Document] = []
    for i in range(20):
        own: Document = {"release": rng.choice((0, 0, 0, 7, 40))}
        uses = [use(r, rng.randint(1, 2)) for r in ("r", "s") if rng.random() < 0.7]
        if i % 4 == 0:
            modes = [
                {"id": "one", "duration": rng.randint(1, 3), "uses": uses},
                {"id": "other", "duration": rng.randint(3, 6), "uses": [use("s")]},
            ]
            actions.append({"id": f"a{i:02}", "modes": modes, **own})
            continue
        if i % 4 == 1:
            uses = [{"one_of": ["r", "s"]}]
        actions.append(act(f"a{i:02}", rng.choice((0, 1, 2, 3, 9)), uses=uses, **own))
    arcs = [
        {"before": f"a{i:02}", "after": f"a{j:02}", "min_lag": rng.choice((0, 0, 1, 30))}
        for j in range(20)
        for i in range(j)
        if rng.random() < 0.08
    ]
    resources = [
        {"id": "r", "capacity": 4, "availability": [{"from": 5, "to": 9, "capacity": 2}]},
        {"id": "s", "capacity": 3},
    ]
    return {"resources": resources, "actions": actions, "precedence": arcs}


def plainly(ways: Ways, order: Sequence[int], chosen: Sequence[int]) -> list[int]:
    """The starts of a list, tick by tick."""
    problem = ways.problem
    capacities = [LEVELS[problem.resources[p.members[0]].id] for p in problem.contention.pools]
    used: dict[tuple[int, int], int] = {}
    starts = [0] * len(order)
    for i in order:
        way = ways.of[i][chosen[i]]
        time = problem.activities[i].release
        for arc in problem.arcs:
            if arc.after == i:
                lasts = ways.of[arc.before][chosen[arc.before]].duration
                time = max(time, starts[arc.before] + lasts + arc.min_lag)

        def fits(time: int) -> bool:
            return all(
                used.get((r, t), 0) + amount <= [n for at, n in capacities[r] if at <= t][-1]
                for r, amount in way.held  # noqa: B023
                for t in range(time, time + way.duration)  # noqa: B023
            )

        while not fits(time):
            time += 1
        starts[i] = time
        for r, amount in way.held:
            for t in range(time, time + way.duration):
                used[r, t] = used.get((r, t), 0) + amount
    return starts


def generated(ways: Ways, order: Sequence[int], chosen: Sequence[int]) -> list[int]:
    """The starts of a list as local search finds them, without justification."""
    search = projects.ProjectSearch(ways, 0, 0)
    search._work[COUNTS, JUSTIFIES] = 0
    first = search.project[WAY_AT]
    numbers = ints(first[i] + k for i, k in enumerate(chosen))
    take(search.project, search._work, search._use, ints(order), numbers)
    return [int(start) for start in search._work[START, : len(order)]]


@pytest.mark.parametrize("ticks", [0, projects.MOST_TICKS], ids=["nodes", "ticks"])
@pytest.mark.parametrize("seed", range(12))
def test_generation_is_that_of_a_plain_one(
    seed: int, ticks: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(projects, "MOST_TICKS", ticks)
    problem = after_passes(rich_project(seed))
    ways, rng = ways_of(problem), random.Random(seed)
    order = projects.order_by(problem, [rng.random() for _ in ways.of])
    chosen = [rng.randrange(len(own)) for own in ways.of]
    assert generated(ways, order, chosen) == plainly(ways, order, chosen)


def test_a_node_is_closed_after_many_visits_in_vain(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(projects, "MOST_TICKS", 0)
    actions = [
        act("a long", 10, uses=[use("r")]),  # It leaves half of the resource,
        *(act(f"b{i:04}", 1, uses=[use("r", 2)]) for i in range(MOST_VISITS + 1)),  # of which these
        act("c small", 1, uses=[use("r")]),  # need all.
        act("d small", 1, uses=[use("r")]),
    ]
    document = {"resources": [{"id": "r", "capacity": 2}], "actions": actions}
    ways = ways_of(after_passes(document))
    large = [*range(MOST_VISITS + 2)]
    order = [*large[:-1], len(large), large[-1], len(large) + 1]
    starts = generated(ways, order, [0] * len(order))
    assert starts[: len(large)] == [0, *range(10, 10 + MOST_VISITS + 1)]
    assert starts[len(large) :] == [0, 10 + MOST_VISITS + 1]
