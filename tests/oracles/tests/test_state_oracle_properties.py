"""The state oracle against other ways to the same answer, and against laws that answers keep."""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from itertools import product
from typing import Any

import pytest

from irc.model import Task
from irc.model.quantities import Number
from irc.schedule import Entry, Schedule
from irc.validation import validate
from oracles.brute_force import optimal_makespan
from oracles.generators import random_task
from oracles.state_brute_force import Optimum, optimum
from oracles.state_generators import (
    MIXES,
    crowded_task,
    match_cellar,
    reward_task,
    state_task,
)
from oracles.state_task import Job, Plain, read
from oracles.state_validity import is_valid

Document = dict[str, Any]


@cache
def best_of(seed: int) -> Optimum | None:
    return optimum(state_task(seed))


def document_of(task: Task) -> Document:
    """What the task says, as JSON."""
    document: Document = task.model_dump(mode="json", by_alias=True, exclude_defaults=True)
    return document


def vector(task: Task) -> tuple[Number, ...] | None:
    best = optimum(task)
    return None if best is None else best.vector


def worth(task: Task, values: tuple[Number, ...] | None) -> tuple[Number, ...] | None:
    """As `values`, but less is better for all of them."""
    if values is None:
        return None
    return tuple(
        -value if name == "maximize_reward" else value
        for name, value in zip(task.objective, values, strict=True)
    )


# --- other ways to the same answer --------------------------------------------------------------


@pytest.mark.parametrize("seed", range(30))
def test_it_agrees_with_the_oracle_for_tasks_without_state(seed: int) -> None:
    task = random_task(random.Random(f"both oracles {seed}"), actions=(1, 4), durations=(0, 4))
    least = optimal_makespan(task)
    assert vector(task) == (None if least is None else (least,))


def enough_ticks(plain: Plain, counts: tuple[int, ...]) -> int:
    """A tick by which an optimal schedule of a selection has ended, if it has a valid one.

    Take a valid schedule in whole ticks and keep its choices, durations and ranks, the order (or
    the coincidence) of every two of its points and of each point and each constant of the task,
    and whether a lag is kept with time to spare. All rules but deadlines look at nothing else, and
    the earliest times under these difference constraints are nowhere later. Each of them is the
    length of a simple path from a constant, which enters each point at most once: by a duration, a
    lag plus 1, a negated maximal lag, or a strict order (1).
    """
    step = [1]
    step += [arc.least + 1 for arc in plain.arcs]
    step += [-arc.most for arc in plain.arcs if arc.most is not None]
    lengths = [
        max(option.most for option in job.options) * count
        for job, count in zip(plain.jobs, counts, strict=True)
    ]
    return plain.last_constant + sum(lengths) + 2 * sum(counts) * max(step)


def ways(plain: Plain, job: Job, number: int, horizon: int) -> Iterator[Entry]:
    for option in job.options:
        for lasts in range(option.least, option.most + 1):
            last = horizon if job.deadline is None else min(horizon, job.deadline)
            for start in range(job.release, last - lasts + 1):
                yield Entry(
                    job.id,
                    plain.time(start),
                    plain.time(start + lasts),
                    resources=dict(option.held),
                    mode=option.mode,
                    occurrence=number,
                )


def worth_of(plain: Plain, counts: tuple[int, ...], tried: tuple[Entry, ...]) -> tuple[Number, ...]:
    """What entries are worth, valid or not, in the task's unit; less is better."""
    ends: dict[str, int] = {}
    late = 0
    due = {job.id: job for job in plain.jobs}
    for entry in tried:
        end = int(entry.end / plain.tick)
        ends[entry.id] = max(end, ends.get(entry.id, 0))
        job = due[entry.id]
        late += 0 if job.due is None else job.weight * max(0, end - job.due)
    for party in plain.parties:
        if party.due is not None and counts[party.members[0]]:
            last = max(ends[plain.jobs[m].id] for m in party.members)
            late += party.weight * max(0, last - party.due)
    values = {
        "minimize_makespan": plain.time(max(ends.values(), default=0)),
        "minimize_tardiness": plain.time(late),
        "maximize_reward": -plain.reward(counts),
        "minimize_cost": plain.cost(counts),
    }
    return tuple(values[name] for name in plain.objective)


def enumerated(task: Task, budget: int) -> tuple[bool, tuple[Number, ...] | None]:
    """The best worth by trying every schedule; False first where that would be too many."""
    plain = read(task)
    found: list[tuple[Number, ...]] = []
    ranges = [range((job.most or 0) + 1) for job in plain.jobs]
    for counts in product(*ranges):
        if not plain.is_selection(counts):
            continue
        horizon = enough_ticks(plain, counts)
        entries = [
            list(ways(plain, job, k + 1, horizon))
            for job, count in zip(plain.jobs, counts, strict=True)
            for k in range(count)
        ]
        budget -= _size(entries)
        if budget < 0:
            return False, None
        for tried in product(*entries):
            value = worth_of(plain, counts, tried)
            if (not found or value < found[-1]) and is_valid(task, Schedule(tried)):
                found.append(value)
    return True, found[-1] if found else None


def _size(entries: list[list[Entry]]) -> int:
    total = 1
    for own in entries:
        total *= len(own)
    return total


def test_it_agrees_with_trying_every_schedule() -> None:
    tried = solvable = 0
    for seed in range(40):
        task = state_task(seed)
        if len(task.actions) > 3:
            continue
        complete, least = enumerated(task, 1_500)
        if complete:
            best = best_of(seed)
            assert worth(task, None if best is None else best.vector) == least, seed
            tried, solvable = tried + 1, solvable + (least is not None)
    assert tried >= 6
    assert 1 <= solvable <= tried - 1, (tried, solvable)


# --- the validator ------------------------------------------------------------------------------


def unranked(entries: tuple[Entry, ...]) -> tuple[Entry, ...]:
    return tuple(replace(entry, rank=0, end_rank=None) for entry in entries)


@pytest.mark.parametrize("seed", [*range(24), 1369, 1561, 1807])
def test_an_optimal_schedule_is_valid_with_its_ranks_and_without(seed: int) -> None:
    task, best = state_task(seed), best_of(seed)
    if best is None:
        return
    for schedule in (best.schedule, Schedule(unranked(best.schedule.entries))):
        verdict = validate(task, schedule)
        assert verdict.valid, verdict
        assert verdict.objective == best.values


def disturbed(entries: tuple[Entry, ...], rng: random.Random) -> tuple[Entry, ...]:
    """Some entries moved, most often to where another one starts or ends; sometimes one less."""
    changed = list(entries)
    for _ in range(rng.choice((1, 1, 2, 3))):
        i = rng.randrange(len(changed))
        entry, other = changed[i], rng.choice(changed)
        length = entry.end - entry.start
        kind = rng.random()
        if kind < 0.35:
            start = entry.start + rng.choice((-2, -1, 1, 2))
            changed[i] = replace(entry, start=start, end=start + length)
        elif kind < 0.8:
            start = rng.choice((other.start, other.end, other.start - length, other.end - length))
            changed[i] = replace(entry, start=start, end=start + length)
        elif kind < 0.95:
            changed[i] = replace(entry, end=entry.end + rng.choice((-1, 1)))
        elif len(changed) > 1:
            del changed[i]
    return tuple(changed)


def test_the_validator_agrees_on_disturbed_schedules() -> None:
    outcomes = {True: 0, False: 0}
    for seed in range(48):
        task, best, rng = state_task(seed), best_of(seed), random.Random(f"disturbed {seed}")
        if best is None or not 1 <= len(best.schedule.entries) <= 5:
            continue
        for _ in range(6):
            schedule = Schedule(disturbed(unranked(best.schedule.entries), rng))
            verdict = validate(task, schedule)
            assert not verdict.undecided
            assert verdict.valid == is_valid(task, schedule), (seed, schedule, verdict)
            outcomes[verdict.valid] += 1
    assert min(outcomes.values()) >= 25


# --- laws ---------------------------------------------------------------------------------------

LAW_SEEDS = range(0, 48, 5)
_TIMES = {
    *("duration", "min_lag", "max_lag", "release", "deadline", "due", "from", "to"),
    *("start", "latest_start", "earliest_end"),
}


def scaled(part: Any, k: int, is_time: bool = False) -> Any:
    """A document with all its times k times as long."""
    if isinstance(part, list):
        return [scaled(element, k, is_time) for element in part]
    if isinstance(part, dict):
        return {
            key: scaled(value, k, is_time or (key in _TIMES and key != "values"))
            for key, value in part.items()
        }
    return part * k if is_time and isinstance(part, int) else part


@pytest.mark.parametrize("seed", LAW_SEEDS)
def test_scaling_all_times_scales_makespan_and_tardiness(seed: int) -> None:
    task, best = state_task(seed), best_of(seed)
    longer = Task.model_validate(scaled(document_of(task), 3))
    timed = {"minimize_makespan", "minimize_tardiness"}
    expected = best and tuple(
        value * (3 if name in timed else 1)
        for name, value in zip(task.objective, best.vector, strict=True)
    )
    assert vector(longer) == expected


@pytest.mark.parametrize("seed", LAW_SEEDS)
def test_the_order_of_arrays_means_nothing(seed: int) -> None:
    document = document_of(state_task(seed))
    for key in ("actions", "precedence", "resources", "state", "groups", "goals"):
        document.get(key, []).reverse()
    best = best_of(seed)
    assert vector(Task.model_validate(document)) == (best and best.vector)


def test_a_precedence_that_follows_anyway_changes_nothing() -> None:
    """Start to start, with the duration in the lag: the same as finish to start."""
    changed = 0
    for seed in range(80):
        document = document_of(state_task(seed))
        fixed = {a["id"]: a["duration"] for a in document["actions"] if "duration" in a}
        more = [
            {
                "before": arc["before"],
                "after": arc["after"],
                "type": "start-start",
                "min_lag": arc.get("min_lag", 0) + fixed[arc["before"]],
            }
            for arc in document.get("precedence", ())
            if "type" not in arc and isinstance(fixed.get(arc["before"]), int)
        ]
        if more:
            changed += 1
            document["precedence"] += more
            best = best_of(seed)
            assert vector(Task.model_validate(document)) == (best and best.vector), seed
    assert changed >= 6


def relaxations(document: Document) -> Iterator[Document]:
    """Less of a constraint of each kind that there is, one at a time."""
    if any("uses" in action for action in document["actions"]):
        actions = [{k: v for k, v in a.items() if k != "uses"} for a in document["actions"]]
        yield {**document, "actions": actions}
    if "deadline" in document:
        yield {k: v for k, v in document.items() if k != "deadline"}
    if document.get("precedence"):
        yield {**document, "precedence": document["precedence"][1:]}
    if document.get("goals"):
        yield {**document, "goals": document["goals"][1:]}


@pytest.mark.parametrize("seed", LAW_SEEDS)
def test_taking_a_constraint_away_makes_no_answer_worse(seed: int) -> None:
    task, best = state_task(seed), best_of(seed)
    for document in relaxations(document_of(task)):
        easier = worth(task, vector(Task.model_validate(document)))
        if best is not None:
            assert easier is not None
            least = worth(task, best.vector)
            assert least is not None
            assert easier <= least


# --- the generators -----------------------------------------------------------------------------


def test_state_tasks_are_small_and_partly_solvable() -> None:
    solvable = 0
    for seed in range(48):
        task = state_task(seed)
        assert len(task.actions) <= 6
        assert 1 <= len(task.state) <= 4
        solvable += best_of(seed) is not None
    assert 22 <= solvable <= 40


def test_state_tasks_need_ranks_repetitions_modes_and_absence() -> None:
    best = [b for seed in range(48) if (b := best_of(seed)) is not None]
    entries = [entry for b in best for entry in b.schedule.entries]
    assert sum(entry.rank > 0 for entry in entries) >= 5
    assert any(entry.end_rank != entry.rank for entry in entries)
    assert sum(entry.occurrence > 1 for entry in entries) >= 1
    assert sum(entry.mode == "hasty" for entry in entries) >= 1
    assert any(not b.schedule.entries for b in best)


def test_a_seed_gives_the_same_task_again() -> None:
    for draw in (state_task, reward_task, crowded_task, match_cellar):
        for seed in range(len(MIXES)):
            assert draw(seed) == draw(seed)
            assert draw(seed) != draw(seed + len(MIXES))


@pytest.mark.parametrize("seed", range(0, 6, 2))
def test_a_match_cellar_needs_two_happenings_at_one_instant(seed: int) -> None:
    best = optimum(match_cellar(seed))
    if seed % 3 == 2:
        assert best is None
        return
    assert best is not None
    starts = {entry.id: entry for entry in best.schedule.entries}
    at_once = [
        (match, mend)
        for match in starts.values()
        for mend in starts.values()
        if match.id.startswith("light") and mend.id.startswith("mend")
        if match.start == mend.start and match.rank < mend.rank
    ]
    assert at_once
    later = optimum(with_flares(match_cellar(seed)))
    assert later is None or later.vector > best.vector


def with_flares(task: Task) -> Task:
    """The same cellar, but a match flares for a tick before it gives light to work by."""
    document = document_of(task)
    for variable in document["state"]:
        if variable["id"] == "lit":
            variable.update(values=["dark", "flare", "light"], initial="dark")
    matches = 0
    for action in document["actions"]:
        struck = action["id"].startswith("light")
        matches += struck
        for fact in (*action.get("conditions", ()), *action.get("effects", ())):
            if fact["var"] == "lit":
                given = "flare" if struck else "light"
                fact["value"] = given if fact.get("value", True) else "dark"
    document["actions"] += [
        {
            "id": f"flare{k}",
            "duration": 1,
            "occurs": "optional",
            "conditions": [{"at": at, "var": "lit", "value": "flare"} for at in ("start", "end")],
            "effects": [{"at": "end", "var": "lit", "value": "light"}],
        }
        for k in range(matches)
    ]
    return Task.model_validate(document)


def test_reward_tasks_offer_many_optional_groups() -> None:
    for seed in range(50):
        task = reward_task(seed)
        assert 15 <= len(task.groups) <= 40
        assert not any(group.required for group in task.groups)
        assert task.deadline is not None
        assert any(resource.kind == "reservoir" for resource in task.resources)


def test_in_some_reward_tasks_nothing_fits() -> None:
    for seed in range(6, 50, 7):
        task = reward_task(seed)
        longest = {action.id: action.duration for action in task.actions}
        for group in task.groups:
            assert sum(longest[name] for name in group.actions) > task.deadline


def test_crowded_tasks_have_the_size_that_is_asked() -> None:
    sizes = [len(crowded_task(seed).actions) for seed in range(200)]
    assert min(sizes) == 6
    assert max(sizes) == 20
    capacities = {r.capacity for seed in range(200) for r in crowded_task(seed).resources}
    assert capacities == {1, 2, 3}
