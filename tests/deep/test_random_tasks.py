"""Random tasks for hours: `python -m pytest tests/deep --seconds 3600`, one hour for each test.

Each test prints the seeds that it has tried; the last one is where a test failed, and
`--first-seed` begins with it again.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from pathlib import Path

import pytest

from crash_runs import MODES, Kitchen
from irc.driver.solve import solve_task
from irc.frontends.dsl.printer import print_task
from irc.frontends.files import parse_task
from irc.model import Task
from irc.targets import SolveOptions
from laws import agree, answer_of, answered, faults_of_repairs, has_schedule, told_of
from oracles.clock_sessions import faults_of_session
from oracles.generators import big_capacity_task, contended_task, hostile_names, random_task
from oracles.online_orders_play import play as play_orders
from oracles.online_random import EACH
from oracles.reality import play as play_session
from oracles.setups import best as best_with_setups
from oracles.setups import random_task as setup_task
from oracles.state_brute_force import TooLargeError, optimum
from oracles.state_generators import match_cellar, state_task

Seeds = Iterator[int]


def test_cpsat_finds_the_optimum_of_tasks_with_setups(seeds: Seeds) -> None:
    for seed in seeds:
        document = setup_task(random.Random(seed))
        task = Task.model_validate(document)
        schedule = solve_task(task, SolveOptions("cpsat", time_limit=60, workers=1)).schedule
        wanted = best_with_setups(document)
        assert schedule.status == ("infeasible" if wanted is None else "optimal")
        if wanted is not None:
            values = tuple(-o.value if o.name == "reward" else o.value for o in schedule.objective)
            assert values == wanted


KINDS = (random_task, big_capacity_task, lambda rng: contended_task(rng, 7))
ALLOWED = {
    "ortools": {"optimal", "infeasible", "refused"},
    "kairos": {"optimal", "feasible", "unknown", "refused", "beyond the target"},
}


@pytest.mark.parametrize(("target", "engine"), [("cpsat", "ortools"), ("pddl21", "kairos")])
def test_engines_say_nothing_untrue_of_plain_tasks(seeds: Seeds, target: str, engine: str) -> None:
    if engine == "kairos":
        pytest.importorskip("kairos")
    for seed in seeds:
        task = KINDS[seed % len(KINDS)](random.Random(f"deep {seed}"))
        assert answered(task, target, engine, 30.0) in ALLOWED[engine]


@pytest.mark.parametrize("make", [state_task, match_cellar])
def test_cpsat_finds_the_optimum_of_tasks_with_state(seeds: Seeds, make) -> None:
    for seed in seeds:
        task = make(seed)
        try:
            best = optimum(task, max_situations=200_000)
        except TooLargeError:
            continue
        agree(task, answer_of(task), best)


def test_no_task_with_a_schedule_is_called_impossible(seeds: Seeds) -> None:
    for seed in seeds:
        assert not (told_of(seed) and has_schedule(seed))


@pytest.mark.parametrize("operation", [*EACH, None])
def test_after_events_the_rest_is_repaired_as_well_as_can_be(
    seeds: Seeds, operation: str | None
) -> None:
    for seed in seeds:
        assert faults_of_repairs(seed, operation) == []


@pytest.mark.parametrize("target", ["cpsat", "pddl21"])
def test_whatever_time_is_accepted_can_be_planned_with(seeds: Seeds, target: str) -> None:
    if target == "pddl21":
        pytest.importorskip("kairos")
    for seed in seeds:
        assert list(faults_of_session(seed, target)) == []


def test_half_done_orders_are_finished_while_they_can_be(seeds: Seeds) -> None:
    for seed in seeds:
        for one in play_orders(seed):
            assert one.judged.faults == []
            assert one.judged.worse is None


@pytest.mark.parametrize("target", ["cpsat", "pddl21"])
def test_no_session_has_an_impossible_history(seeds: Seeds, target: str) -> None:
    if target == "pddl21":
        pytest.importorskip("kairos")
    for seed in seeds:
        assert play_session(seed, SolveOptions(target, time_limit=5, workers=1)).faults == []


def test_what_is_printed_in_the_dsl_is_read_back(seeds: Seeds) -> None:
    for seed in seeds:
        rng = random.Random(f"deep {seed}")
        task = state_task(seed) if seed % 2 else hostile_names(random_task(rng), rng)
        assert parse_task(print_task(task), "task.irc").task == task


def test_a_killed_session_forgets_nothing_that_it_acknowledged(
    seeds: Seeds, tmp_path_factory: pytest.TempPathFactory
) -> None:
    for seed in seeds:
        folder: Path = tmp_path_factory.mktemp("killed")
        kitchen = Kitchen(folder, random.Random(f"deep {seed}"))
        for k in range(5):
            kitchen.crash(MODES[(seed + k) % len(MODES)])
