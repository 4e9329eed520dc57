"""Replanning moves little: against brute force, and on a shop where a station fails."""

from __future__ import annotations

import random
from itertools import product

import pytest

import irc
from irc.execution import Execution
from irc.execution.step import Step
from irc.model import Event, Task
from irc.passes import run_passes
from irc.passes.fewer_moves import fewer_moves, knows_moves
from irc.passes.serial_sgs import Found, moved_in, quick_schedule
from irc.problem import Problem
from irc.retiming.listed import listed_schedule
from irc.schedule import Schedule
from irc.validation import validate
from online_cases import frozen_at

AT = 2
DOWN = 5
"""The station that fails is down from AT until then."""


def shop(seed: int) -> Task:
    """Five actions on two stations, with some precedence."""
    rng = random.Random(f"least movement {seed}")
    actions = [
        {
            "id": f"a{k}",
            "duration": rng.randint(1, 3),
            "uses": [{"resource": f"station{rng.randrange(2)}"}],
        }
        for k in range(5)
    ]
    edges = [
        {"before": f"a{i}", "after": f"a{j}"}
        for j in range(5)
        for i in range(j)
        if rng.random() < 0.2
    ]
    resources = [{"id": f"station{k}"} for k in range(2)]
    return Task.model_validate({"actions": actions, "resources": resources, "precedence": edges})


def failure(seed: int) -> Event:
    change = {"op": "set_capacity", "resource": f"station{seed % 2}", "capacity": 0, "to": DOWN}
    return Event.model_validate({"at": AT, "changes": [change]})


def repaired(task: Task, plan: Schedule, event: Event, seconds: float) -> Step:
    execution = Execution(task, plan, time_limit=seconds, workers=1)
    execution.apply(event)
    return execution.replan()


def fewest(task: Task, plan: Schedule, station: str, makespan: int) -> int:
    """The least number of open actions that start at another time, by trying all of them."""
    length = {a.id: int(str(a.duration)) for a in task.actions}
    on = {a.id: a.uses[0].alternatives[0] for a in task.actions}
    old = {entry.id: int(entry.start) for entry in plan.entries}
    free = [name for name, start in old.items() if start >= AT]
    times = [range(AT, makespan - length[name] + 1) for name in free]
    least = len(free) + 1
    for chosen in product(*times):
        starts = {**old, **dict(zip(free, chosen, strict=True))}
        moved = sum(starts[name] != old[name] for name in free)
        if moved < least and _is_valid(task, starts, length, on, station, free):
            least = moved
    return least


def _is_valid(
    task: Task,
    starts: dict[str, int],
    length: dict[str, int],
    on: dict[str, str],
    station: str,
    free: list[str],
) -> bool:
    for edge in task.precedence:
        if starts[edge.before] + length[edge.before] > starts[edge.after]:
            return False
    if any(on[name] == station and starts[name] < DOWN for name in free):
        return False
    return not any(
        on[a] == on[b] and starts[a] < starts[b] + length[b] and starts[b] < starts[a] + length[a]
        for a in starts
        for b in starts
        if a < b
    )


@pytest.mark.parametrize("seed", range(8))
def test_no_fewer_actions_can_move_where_that_is_proven(seed: int) -> None:
    task, event = shop(seed), failure(seed)
    plan = irc.solve(task, workers=1)
    step = repaired(task, plan, event, 20)
    assert step.schedule.status == "optimal"
    found = {value.name: value for value in step.schedule.objective}
    least = fewest(task, plan, f"station{seed % 2}", int(step.schedule.makespan))
    changes = found["changes"]
    assert changes.value == step.moved >= least
    assert changes.bound is None or changes.bound <= least
    assert changes.bound == changes.value == least


def broken_shop(seed: int, count: int = 60) -> tuple[Task, Problem, int]:
    """A task of `count` actions on four stations of which one has failed, its problem, and when."""
    rng = random.Random(f"broken {seed}")
    actions = [
        {"id": f"a{k:02}", "duration": rng.randint(1, 9), "uses": [{"resource": f"s{k % 4}"}]}
        for k in range(count)
    ]
    edges = [
        {"before": f"a{rng.randrange(max(0, k - 9), k):02}", "after": f"a{k:02}"}
        for k in range(1, count)
        if rng.random() < 0.7
    ]
    document = {
        "actions": actions,
        "resources": [{"id": f"s{k}"} for k in range(4)],
        "precedence": edges,
    }
    task = Task.model_validate(document)
    plan = irc.solve(task, workers=1, time_limit=0.01)
    at = int(plan.makespan) // 3
    down = [{"from": at, "to": at + 9, "capacity": 0}]
    document["resources"] = [
        {"id": f"s{k}", **({"availability": down} if k == seed % 4 else {})} for k in range(4)
    ]
    task = Task.model_validate(document)
    return task, run_passes(frozen_at(task, plan.entries, at).problem), at


def end_of(found: Found) -> int:
    return max(int(decision.end) for decision in found[0])


@pytest.mark.parametrize("seed", range(3))
def test_the_search_moves_fewer_and_ends_no_later(seed: int) -> None:
    task, problem, at = broken_shop(seed)
    assert knows_moves(problem)
    known = quick_schedule(problem)
    assert known is not None
    found = fewer_moves(problem, known)
    assert found is not None
    assert moved_in(problem, found) < moved_in(problem, known)
    assert end_of(found) <= end_of(known)
    assert validate(task, listed_schedule(problem, found), at).valid


def test_the_shifted_plan_is_reported_before_an_engine_begins() -> None:
    task, event = shop(0), failure(0)
    plan, seen = irc.solve(task, workers=1), list[irc.Progress]()
    options = irc.SolveOptions(on_progress=seen.append, workers=1, time_limit=20)
    execution = Execution(task, plan, options=options)
    execution.apply(event)
    step = execution.replan()
    first = seen[0]
    assert first.engine == "list-schedule"
    assert first.value >= step.schedule.makespan
    assert validate(step.task, first.schedule(), AT).valid


def test_without_time_for_an_engine_the_shifted_plan_is_the_answer() -> None:
    task = shop(0)
    step = repaired(task, irc.solve(task, workers=1), failure(0), 1e-6)
    assert (step.schedule.engine, step.schedule.answered) == ("list-schedule", True)
