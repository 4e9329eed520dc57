"""Local search: its schedules are valid, no better than the best, and the same from one seed."""

from __future__ import annotations

import random
from itertools import pairwise
from typing import Any

import pytest

from builders import Document, act, after_passes
from irc.local_search.search import LocalSearch, is_shop, search_of
from irc.local_search.ways import NotApplicable, ways_of
from irc.model import Task
from irc.problem import Problem
from irc.retiming.listed import listed_schedule
from irc.validation import validate
from oracles.brute_force import optimal_makespan
from oracles.small_tasks import best_of
from oracles.state_brute_force import optimum

STEPS = 2


def use(resource: str, amount: int = 1) -> Document:
    """A use of one resource."""
    return {"resource": resource, "amount": amount}


def chain(*names: str) -> list[Document]:
    """Each of these before the next one."""
    return [{"before": a, "after": b} for a, b in pairwise(names)]


def job_shop(seed: int, *, flexible: bool = False) -> Document:
    """Three jobs of two operations on two machines, with a release and a lag; or with choices."""
    rng = random.Random(seed)
    machines = ["m0", "m1", "m2"] if flexible else ["m0", "m1"]
    actions, arcs = [], list[Document]()
    for job in range(3):
        names = [f"{job}.{k}" for k in range(2)]
        for k, name in enumerate(names):
            own = {"release": rng.randint(1, 4)} if job == 2 and not k and not flexible else {}
            if flexible:
                asked = sorted(rng.sample(machines, 2))
                modes = [{"id": m, "duration": rng.randint(1, 4), "uses": [use(m)]} for m in asked]
                actions.append({"id": name, "modes": modes})
            else:
                uses = [use(rng.choice(machines))]
                actions.append(act(name, rng.randint(1, 4), uses=uses, **own))
        arcs += chain(*names)
    arcs[0]["min_lag"] = rng.randint(0, 2)
    return {"resources": [{"id": m} for m in machines], "actions": actions, "precedence": arcs}


def project(seed: int) -> Document:
    """Six activities that hold some of two resources, in a random order of precedence."""
    rng = random.Random(seed)
    actions = [
        act(
            f"a{i}",
            rng.randint(1, 4),
            uses=[use(r, rng.randint(1, 3)) for r in ("r", "s") if rng.random() < 0.8],
        )
        for i in range(6)
    ]
    arcs = [
        {"before": f"a{i}", "after": f"a{j}", "min_lag": rng.choice((0, 0, 1))}
        for j in range(6)
        for i in range(j)
        if rng.random() < 0.25
    ]
    resources = [{"id": "r", "capacity": 4}, {"id": "s", "capacity": 3}]
    return {"resources": resources, "actions": actions, "precedence": arcs}


def with_stock(seed: int) -> Document:
    """Three activities with a quick and a slow mode; the quick ones use up a stock."""
    rng = random.Random(seed)
    actions: list[Document] = [
        {
            "id": f"a{i}",
            "modes": [
                {
                    "id": "quick",
                    "duration": rng.randint(1, 2),
                    "uses": [use("r", rng.randint(1, 2))],
                    "consumes": [use("n", rng.randint(1, 3))],
                },
                {"id": "slow", "duration": rng.randint(3, 5), "uses": [use("r")]},
            ],
        }
        for i in range(3)
    ]
    stock = {"id": "n", "kind": "reservoir", "initial": 4}
    return {
        "resources": [{"id": "r", "capacity": 2}, stock],
        "actions": actions,
        "precedence": chain("a0", "a2"),
    }


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
        ({"objective": ["minimize_cost"]}, "first objective"),
        ({"deadline": 9, "actions": [act("a", deadline=5)]}, "'a' has deadline"),
        ({"actions": [act("a"), act("b", occurs="optional")]}, "'b' has optional"),
        ({"precedence": [{"before": "a", "after": "b", "max_lag": 3}]}, "maximum lags"),
    ],
)
def test_what_it_does_not_know_is_named(changes: dict[str, Any], reason: str) -> None:
    document: Document = {"actions": [act("a"), act("b")], **changes}
    with pytest.raises(NotApplicable, match=reason):
        search_of(after_passes(document))
