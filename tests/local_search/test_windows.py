"""Windows of large shops and projects: valid schedules, no worse than the lists they begin with."""

from __future__ import annotations

import random

import pytest

from builders import Document, act, after_passes
from irc.local_search import compiled, project_windows, search, shop_windows
from irc.local_search.project_windows import ProjectWindows
from irc.local_search.search import LocalSearch, search_with
from irc.local_search.shop_windows import ShopWindows
from irc.local_search.ways import NotApplicable, ways_of
from irc.model import Task
from irc.retiming.listed import listed_schedule
from irc.validation import validate
from local_search_tasks import job_shop, larger_shop, project, use, with_stock
from oracles.brute_force import optimal_makespan

Kind = type[ShopWindows] | type[ProjectWindows]


def larger_project(*, away: bool = False, rich: bool = False) -> Document:
    """Sixty activities that hold some of two resources; `away`: of one there is less for a time.

    `rich`: with lags, releases, and two modes of each tenth activity.
    """
    rng = random.Random(3)
    actions = [
        act(f"a{i}", rng.randint(1, 6), uses=[use("r", rng.randint(1, 5)), use("s")])
        for i in range(60)
    ]
    arcs: list[Document] = [
        {"before": f"a{max(0, i - rng.randint(1, 9))}", "after": f"a{i}"} for i in range(1, 60)
    ]
    if rich:
        for i in range(0, 60, 10):
            duration, uses = actions[i].pop("duration"), actions[i].pop("uses")
            slow = {"id": "slow", "duration": duration + 2, "uses": [use("s")]}
            actions[i]["modes"] = [{"id": "quick", "duration": duration, "uses": uses}, slow]
            actions[i + 5]["release"] = i
            arcs[i]["min_lag"] = 2
    windows = [{"from": 10, "to": 20, "capacity": 5}] if away else []
    resources = [{"id": "r", "capacity": 8, "availability": windows}, {"id": "s", "capacity": 3}]
    return {"resources": resources, "actions": actions, "precedence": arcs}


def first_and_last(document: Document, kind: Kind, steps: int) -> tuple[int, int]:
    """The makespans of the list schedule and after some steps; all schedules are valid."""
    problem = after_passes(document)
    search: LocalSearch = kind(ways_of(problem), 0, problem.bounds.makespan.value)
    values = []
    for _ in range(steps):
        search.step()
        found = search.found()
        assert found is not None
        schedule = listed_schedule(problem, found)
        assert not validate(Task.model_validate(document), schedule).violations
        assert search.value == max(int(d.end) for d in found[0])
        assert schedule.makespan <= search.value
        values.append(search.value)
    assert values == sorted(values, reverse=True)
    return values[0], values[-1]


@pytest.mark.parametrize("seed", range(4))
def test_small_tasks_get_their_best_schedules(seed: int) -> None:
    for document, kind in ((job_shop(seed), ShopWindows), (project(seed), ProjectWindows)):
        _, reached = first_and_last(document, kind, 12)
        assert reached == optimal_makespan(Task.model_validate(document))


@pytest.mark.parametrize("flexible", [False, True])
def test_windows_of_a_shop_make_it_shorter(flexible: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shop_windows, "SIZES", (25,))
    monkeypatch.setattr(shop_windows, "PATIENCE", 40)
    first, last = first_and_last(larger_shop(flexible=flexible), ShopWindows, 60)
    # (With machines to choose from the list schedule meets the bound.)
    assert last == first if flexible else last < first


@pytest.mark.parametrize("own", [{}, {"away": True}, {"rich": True}], ids=str)
def test_windows_of_a_project_make_it_shorter(
    own: dict[str, bool], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(project_windows, "SIZES", (20, 30))
    first, last = first_and_last(larger_project(**own), ProjectWindows, 24)
    assert last < first


def test_windows_do_not_know_about_stock() -> None:
    with pytest.raises(NotApplicable, match="stock"):
        ProjectWindows(ways_of(after_passes(with_stock(1))), 0, 0)


@pytest.mark.parametrize("kind", [ShopWindows, ProjectWindows])
def test_a_better_schedule_is_taken(kind: Kind) -> None:
    problem = after_passes(larger_shop())
    ways = ways_of(problem)
    other = search_with(ways)
    for _ in range(3 if compiled.IS_COMPILED else 20):
        other.step()
    own: LocalSearch = kind(ways, 0, 10**6)
    own.step()
    found = other.found()
    assert found is not None
    assert other.value is not None
    assert own.value is not None
    own.give(found)
    own.step()
    assert own.value <= max(other.value, problem.bounds.makespan.value)


def test_large_problems_are_searched_by_windows(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(search, "LARGE", 50)
    assert isinstance(search_with(ways_of(after_passes(larger_shop()))), ShopWindows)
    assert isinstance(search_with(ways_of(after_passes(larger_project()))), ProjectWindows)
    assert search.is_large(after_passes(larger_shop())) is compiled.IS_COMPILED


def test_a_project_that_is_searched_as_a_whole_may_be_too_large(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(search, "MOST_OF_A_PROJECT", 2)
    with pytest.raises(NotApplicable, match="too many"):
        search_with(ways_of(after_passes(with_stock(1))))
