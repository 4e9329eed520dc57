"""The bound and the list schedules of tasks with set-ups, against brute force."""

from __future__ import annotations

import random
from typing import Any

import pytest

import irc
from irc.lowering.lower import lower
from irc.model import Task
from irc.passes import run_passes
from irc.passes.setup_schedule import search_of, setup_schedule
from irc.problem import Problem
from irc.retiming.listed import listed_schedule
from irc.targets import Budget
from irc_cpsat.encoding.encode import build_model
from irc_cpsat.solving.hinting import complete_hint
from oracles.setups import best, random_task


def compiled(document: dict[str, Any]) -> Problem:
    return run_passes(lower(Task.model_validate(document)))


def shop(*families: str, times: list[dict[str, Any]], **setups: Any) -> dict[str, Any]:
    """One machine and an action of 2 for each family."""
    return {
        "resources": [{"id": "m", "setups": {"times": times, **setups}}],
        "actions": [
            {"id": f"a{k}", "duration": 2, "uses": [{"resource": "m", "family": family}]}
            for k, family in enumerate(families)
        ],
    }


def row(before: str, after: str, time: int) -> dict[str, Any]:
    return {"from": before, "to": after, "time": time}


def test_the_bound_counts_the_shortest_way_through_the_families() -> None:
    times = [row("*", "*", 9), row("x", "y", 1), row("y", "z", 2)]
    problem = compiled(shop("x", "y", "z", "x", times=times))
    assert problem.bounds.makespan.value == 8 + 3
    assert problem.bounds.makespan.reason == "work of 8 s on 'm', and set-ups of 3 s at least"


def test_the_bound_begins_with_the_initial_family() -> None:
    times = [row("*", "*", 9), row("x", "y", 1), row("c", "y", 4), row("y", "x", 5)]
    assert compiled(shop("x", "y", times=times, initial="c")).bounds.makespan.value == 4 + 4 + 5


def test_more_families_than_can_be_ordered_are_bounded_by_their_entries() -> None:
    names = [f"f{k}" for k in range(14)]
    times = [row("*", name, k) for k, name in enumerate(names)]
    problem = compiled(shop(*names, times=times))
    assert problem.bounds.makespan.value == 28 + sum(range(14)) - 13


@pytest.mark.slow
def test_bounds_are_no_higher_and_list_schedules_no_better_than_the_optimum() -> None:
    listed = 0
    for seed in range(60):
        document = random_task(random.Random(seed))
        document["objective"] = ["minimize_makespan"]
        task, least = Task.model_validate(document), best(document)
        if least is None:
            continue
        problem = run_passes(lower(task))
        assert problem.bounds.makespan.value * problem.tick <= least[0]
        found = setup_schedule(problem)
        if found is not None:
            schedule = listed_schedule(problem, found)
            assert irc.validate(task, schedule).valid
            assert least[0] <= schedule.makespan <= max(d.end for d in found[0]) * problem.tick
            listed += 1
    assert listed > 12


def test_a_list_schedule_is_improved_until_nothing_can_be_better() -> None:
    times = [row("*", "*", 9), row("x", "y", 1), row("y", "z", 2)]
    search = search_of(compiled(shop("z", "x", "y", "x", "z", times=times)))
    assert search is not None
    search.improve(10_000)
    assert search.best is not None
    assert search.best[0] == (0, 13)


def test_what_may_be_absent_has_no_list_schedule() -> None:
    document = shop("x", "y", times=[row("x", "y", 1)])
    document["actions"][0]["occurs"] = "optional"
    assert search_of(compiled(document)) is None


def test_choices_that_depend_on_each_other_have_no_list_schedule() -> None:
    """Such a schedule that ends too early would limit the horizon."""
    document = shop("x", "y", times=[row("x", "y", 2)])
    document["actions"][1]["modes"] = [{"id": "off", "duration": 0}, {"id": "on", "duration": 1}]
    del document["actions"][1]["duration"]
    document["actions"].append({"id": "b", "modes": [{"id": "off", "duration": 2}]})
    document["couplings"] = [{"different": "mode", "actions": ["a1", "b"]}]
    assert search_of(compiled(document)) is None
    answer = irc.solve(document, workers=1)
    assert (answer.status, answer.makespan) == ("optimal", 3)


def test_fast_keys_are_those_of_the_schedules() -> None:
    for seed in range(40):
        document = random_task(random.Random(seed))
        for action in document["actions"]:
            action.pop("occurs", None)
            action.pop("modes", None)
            action.setdefault("duration", 3)
        document["objective"] = ["minimize_setup_time", "minimize_makespan"]
        document.pop("precedence", None)
        search = search_of(compiled(document))
        if search is not None and search.fast is not None:
            order = list(search.order)
            assert search.fast.key(order) == search._placed(order)


@pytest.mark.slow
def test_list_schedules_with_calendars_and_pauses_are_valid_and_complete_a_hint() -> None:
    listed = 0
    for seed in range(100):
        document = _with_shifts(random_task(random.Random(seed)), random.Random(seed))
        if not irc.check(document).ok:
            continue
        task = Task.model_validate(document)
        problem = run_passes(lower(task))
        found = setup_schedule(problem)
        if found is None:
            continue
        schedule = listed_schedule(problem, found)
        assert schedule is not None, seed
        verdict = irc.validate(task, schedule)
        assert verdict.valid, (seed, verdict.violations)
        model = build_model(problem, hints=True)
        if model.hint is None:
            continue
        complete_hint(model, Budget(20.0))
        proto: Any = model.model.proto
        assert len(proto.solution_hint.vars) == len(proto.variables), seed
        listed += 1
    assert listed > 12


def _with_shifts(document: dict[str, Any], r: random.Random) -> dict[str, Any]:
    """The task with resources that are open for a part of each cycle, and some work that pauses."""
    opened = {"from": r.choice([0, 2]), "to": r.choice([7, 9])}
    document["calendars"] = [{"id": "shift", "every": 12, "open": [opened]}]
    for resource in document["resources"]:
        if "kind" not in resource and r.random() < 0.7:
            resource["calendar"] = "shift"
    for action in document["actions"]:
        if r.random() < 0.6:
            action["breaks"] = "pause"
    return document
