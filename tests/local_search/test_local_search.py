"""Local search: its schedules are valid, no better than the best, and the same from one seed."""

from __future__ import annotations

from typing import Any

import pytest

from builders import Document, act, after_passes
from irc.local_search import project as projects
from irc.local_search.search import LocalSearch, is_shop, search_of, search_with
from irc.local_search.ways import NotApplicable, ways_of
from irc.model import Task
from irc.problem import Problem
from irc.retiming.listed import listed_schedule
from irc.validation import validate
from local_search_tasks import job_shop, project, use, with_stock
from oracles.brute_force import optimal_makespan
from oracles.small_tasks import best_of
from oracles.state_brute_force import optimum

STEPS = 2


def searched(document: Document, seed: int = 0, steps: int = STEPS) -> tuple[Problem, LocalSearch]:
    """The problem of a task, and its search after some steps."""
    problem = after_passes(document)
    search = search_of(problem, seed)
    for _ in range(steps):
        search.step()
    return problem, search


def makespan_of(document: Document, seed: int = 0) -> int:
    """The makespan of the best schedule after some steps, exact and valid."""
    problem, search = searched(document, seed)
    found = search.found()
    assert found is not None
    schedule = listed_schedule(problem, found)
    assert not validate(Task.model_validate(document), schedule).violations
    assert search.value is not None
    assert schedule.makespan <= search.value
    return int(schedule.makespan)


@pytest.mark.parametrize("seed", range(6))
def test_a_job_shop_gets_its_best_schedule(seed: int) -> None:
    document = job_shop(seed)
    assert makespan_of(document) == optimal_makespan(Task.model_validate(document))


@pytest.mark.parametrize("seed", range(3))
def test_operations_choose_their_machines(seed: int) -> None:
    document = job_shop(seed, flexible=True)
    document["actions"] = document["actions"][:4]
    document["precedence"] = document["precedence"][:2]
    assert (makespan_of(document),) == best_of({**document, "objective": ["minimize_makespan"]})


@pytest.mark.parametrize("seed", range(6))
def test_a_project_gets_its_best_schedule(seed: int) -> None:
    document = project(seed)
    assert makespan_of(document) == optimal_makespan(Task.model_validate(document))


@pytest.mark.parametrize("seed", range(3))
def test_modes_use_up_no_more_stock_than_there_is(seed: int) -> None:
    document = with_stock(seed)
    best = optimum(Task.model_validate(document))
    assert best is not None
    assert makespan_of(document) == best.values["makespan"]


def test_interchangeable_machines_are_told_apart() -> None:
    uses = [{"one_of": ["m0", "m1"]}]
    document = {
        "resources": [{"id": "m0"}, {"id": "m1"}],
        "actions": [act(f"a{d}{k}", d, uses=uses) for d in (3, 2) for k in range(3)],
    }
    assert is_shop(ways_of(after_passes(document)))
    assert makespan_of(document) == 8


def test_a_lower_capacity_in_a_window_is_kept() -> None:
    window = {"from": 1, "to": 6, "capacity": 1}
    document = {
        "resources": [{"id": "r", "capacity": 2, "availability": [window]}],
        "actions": [act(f"a{k}", 2, uses=[use("r")]) for k in range(4)],
    }
    assert makespan_of(document) == 8  # One after another until 6; two at once would end at 4.


def windowed() -> Document:
    """Four activities on a resource whose capacity is lower for a while."""
    window = {"from": 1, "to": 6, "capacity": 1}
    return {
        "resources": [{"id": "r", "capacity": 2, "availability": [window]}],
        "actions": [act(f"a{k}", 1 + k, uses=[use("r", 1 + k % 2)]) for k in range(4)],
    }


@pytest.mark.parametrize("document", [project(1), project(2), with_stock(1), windowed()])
def test_a_profile_of_ticks_and_one_of_nodes_lead_to_the_same_schedules(
    document: Document, monkeypatch: pytest.MonkeyPatch
) -> None:
    by_ticks = searched(document, seed=1)[1].found()
    monkeypatch.setattr(projects, "MOST_TICKS", 0)
    assert searched(document, seed=1)[1].found() == by_ticks


@pytest.mark.parametrize("seed", range(2))
def test_capacities_that_need_several_words_are_kept(seed: int) -> None:
    document = project(seed)
    best = optimal_makespan(Task.model_validate(document))
    for element in (*document["resources"], *(u for a in document["actions"] for u in a["uses"])):
        key = "amount" if "amount" in element else "capacity"
        element[key] *= 1 << 40
    assert makespan_of(document) == best


def test_a_capacity_that_is_enough_for_a_while_only_is_not_searched() -> None:
    window = {"from": 0, "to": 9, "capacity": 2}
    document = {
        "resources": [{"id": "r", "availability": [window]}],
        "actions": [act(f"a{k}", 2, uses=[use("r", max(1, k))]) for k in range(3)],
    }
    with pytest.raises(NotApplicable, match="'r' has enough capacity for a while only"):
        search_with(ways_of(after_passes(document)))


@pytest.mark.parametrize("document", [job_shop(1), project(1)], ids=["shop", "project"])
def test_the_same_seed_finds_the_same_schedules(document: Document) -> None:
    one, other = (searched(document, seed=3)[1].found() for _ in range(2))
    assert one == other


@pytest.mark.parametrize("document", [job_shop(2), project(2)], ids=["shop", "project"])
def test_a_search_is_never_worse_than_a_schedule_that_it_is_given(document: Document) -> None:
    _, search = searched(document)
    best = search.found()
    assert best is not None
    other = search_of(after_passes(document), seed=9)
    other.give(best)
    for _ in range(STEPS):
        other.step()
    assert other.value is not None
    assert search.value is not None
    assert other.value <= search.value


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"objective": ["minimize_earliness"]}, "first objective"),
        ({"actions": [act("a", start=3), act("b")]}, "'a' has start"),
        ({"actions": [act("a"), act("b", occurs="optional")]}, "'b' has optional"),
        ({"precedence": [{"before": "a", "after": "b", "max_lag": 3}]}, "maximum lags"),
    ],
)
def test_what_it_does_not_know_is_named(changes: dict[str, Any], reason: str) -> None:
    document: Document = {"actions": [act("a"), act("b")], **changes}
    with pytest.raises(NotApplicable, match=reason):
        search_of(after_passes(document))
