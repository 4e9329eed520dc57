"""The search over lists: valid schedules, which are worth what it says, and no better than best."""

from __future__ import annotations

from typing import Any

import pytest

from builders import Document, act, after_passes
from irc.driver.solve import solve_task
from irc.local_search.list_search import ListSearch
from irc.local_search.listing import least_value, listing_of
from irc.local_search.ways import NotApplicable
from irc.model import Task
from irc.problem import Problem
from irc.problem.objective_values import in_units
from irc.retiming.listed import listed_schedule
from irc.schedule import Entry, Schedule, Status
from irc.targets import SolveOptions
from irc.validation import validate
from list_search_tasks import list_task

NOT_FOUND: frozenset[int] = frozenset()


def searched(document: Document, steps: int = 2) -> tuple[Problem, ListSearch]:
    """The problem of a task, and its search after some steps."""
    problem = after_passes(document)
    search = ListSearch(listing_of(problem), 0, least_value(problem))
    for _ in range(steps):
        search.step()
    return problem, search


def as_it_is(problem: Problem, search: ListSearch) -> tuple[Any, Schedule]:
    """What the search says of its schedule, and the schedule at the very times that it found."""
    found = search.found()
    assert found is not None
    assert search.value is not None
    exact = listed_schedule(problem, found)
    decisions = {a.id: d for a, d in zip(problem.activities, found[0], strict=True)}
    entries = [_at(problem, entry, decisions[entry.id]) for entry in exact.entries]
    return in_units(problem, problem.objectives[0], search.value), Schedule(tuple(entries))


def _at(problem: Problem, entry: Entry, decision: Any) -> Entry:
    start, end = (problem.to_units(int(time)) for time in (decision.start, decision.end))
    return Entry(entry.id, start, end, mode=entry.mode, resources=entry.resources)


@pytest.mark.parametrize("seed", range(40))
def test_its_schedules_are_valid_and_worth_what_it_says(seed: int) -> None:
    document = list_task(seed)
    task = Task.model_validate(document)
    problem, search = searched(document)
    claimed, schedule = as_it_is(problem, search)
    verdict = validate(task, schedule)
    assert not verdict.violations
    assert verdict.objective[problem.objectives[0]] == claimed
    retimed = validate(task, listed_schedule(problem, search.found()))  # type: ignore[arg-type]
    assert not retimed.violations
    assert retimed.objective[problem.objectives[0]] <= claimed


@pytest.mark.parametrize("seed", range(100, 109))
def test_it_finds_nothing_better_than_the_best_and_often_that(seed: int) -> None:
    document = list_task(seed, size=5)
    best = solve_task(Task.model_validate(document), SolveOptions(time_limit=60)).schedule
    assert best.status is Status.OPTIMAL
    problem, search = searched(document)
    claimed, _ = as_it_is(problem, search)
    assert claimed >= best.objective[0].value
    if seed not in NOT_FOUND:
        assert claimed == best.objective[0].value


def test_from_one_seed_it_takes_the_same_steps() -> None:
    one, other = (searched(list_task(3))[1].found() for _ in range(2))
    assert one == other


def test_it_is_never_worse_than_a_schedule_that_it_is_given() -> None:
    document = list_task(1)
    _, search = searched(document, steps=4)
    problem = after_passes(document)
    other = ListSearch(listing_of(problem), 9, least_value(problem))
    found = search.found()
    assert found is not None
    other.give(found)
    other.step()
    assert other.value is not None
    assert search.value is not None
    assert other.value <= search.value


def test_a_deadline_that_cannot_be_kept_leaves_it_without_a_schedule() -> None:
    actions = [act(f"a{k}", 3, uses=[{"resource": "m"}]) for k in range(3)]
    _, search = searched({"resources": [{"id": "m"}], "actions": actions, "deadline": 8})
    assert search.value is None
    assert search.found() is None


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"objective": ["minimize_earliness"]}, "first objective has earliness"),
        ({"actions": [act("a"), act("b", occurs="optional")]}, "'b' has optional"),
        ({"actions": [act("a"), act("b", start=4)]}, "'b' has start"),
        ({"precedence": [{"before": "a", "after": "b", "max_lag": 3}]}, "maximum lags"),
        ({"precedence": [{"before": "a", "after": "b", "min_lag": -1}]}, "negative"),
        (
            {"precedence": [{"before": "a", "after": "b", "type": "finish-finish"}]},
            "lags count to an end",
        ),
        (
            {
                "state": [{"id": "s", "values": ["x", "y"], "initial": "x"}],
                "actions": [act("a", effects=[{"at": "end", "var": "s", "value": "y"}])],
                "goals": [{"var": "s", "value": "y"}],
                "precedence": [],
            },
            "variables",
        ),
        ({"resources": [{"id": "n", "kind": "reservoir", "initial": 1}]}, "reservoirs"),
        ({"resources": [{"id": "o", "kind": "batch", "capacity": 2}]}, "'o' has batch"),
        ({"resources": [{"id": "o", "no_idle": True}]}, "no idle"),
    ],
)
def test_what_it_does_not_know_is_named(changes: dict[str, Any], reason: str) -> None:
    document: Document = {"actions": [act("a"), act("b")], **changes}
    with pytest.raises(NotApplicable, match=reason):
        listing_of(after_passes(document))
