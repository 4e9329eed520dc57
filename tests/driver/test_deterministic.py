"""Deterministic calls: the same task, seed and limits give the same answer, on any machine."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
from typing import Any

import pytest

import irc
from api.test_running import shop
from irc.driver.solve import solve_task
from irc.errors import OptionError
from irc.targets import Budget, Cancellation, SolveOptions, Work
from local_search_tasks import job_shop, project

SCRIPT = """
import json, sys
from api.test_running import shop
from irc.driver.solve import solve_task
from irc.local_search import compiled, shop as machines
from irc.targets import Progress, SolveOptions
from irc_cpsat.solving import rounds

rounds.FIRST_ROUND, rounds.UNIT_STEPS, machines.STEADY_STEPS = 0.01, 100, 2_000
workers, seed = int(sys.argv[1]), int(sys.argv[2])
told = []
schedule = solve_task(
    shop(8, 10),
    SolveOptions(
        time_limit=500, workers=workers, seed=seed, deterministic=True, work_limit=0.03,
        on_progress=lambda progress: told.append(progress.value),
    ),
).schedule
document = schedule.to_dict()
del document["seconds"]
print(json.dumps([compiled.IS_COMPILED, told, document]))
"""


def answer(workers: int, *, is_compiled: bool = False, hashes: int = 0) -> Any:
    """[whether loops are compiled, the values told, the schedule] of a process of its own."""
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join(sys.path),
        "PYTHONHASHSEED": str(hashes),
        "IRC_COMPILED": "1" if is_compiled else "0",
    }
    command = [sys.executable, "-c", SCRIPT, str(workers), "0"]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=300)
    assert not done.returncode, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


@pytest.mark.slow
def test_two_processes_give_the_same_answer() -> None:
    first = answer(workers=2)
    assert answer(workers=1, hashes=3) == first
    _, told, document = first
    assert document["repeatable"] is True
    assert document["status"] == "feasible"
    assert len(told) > 1


@pytest.mark.parametrize(
    "document",
    [
        job_shop(1),
        project(2),
        {**project(3), "objective": ["minimize_flow_time", "minimize_makespan"]},
    ],
)
def test_two_calls_in_a_process_give_the_same_answer(document: dict[str, Any]) -> None:
    answers = [irc.solve(document, deterministic=True, work_limit=0.05, seed=4) for _ in range(2)]
    documents = [{**a.to_dict(), "seconds": None} for a in answers]
    assert documents[0] == documents[1]
    assert answers[0].repeatable is True


def test_a_call_that_the_clock_cuts_says_so() -> None:
    options = SolveOptions(time_limit=1, deterministic=True, work_limit=1e6)
    found = solve_task(shop(), options)
    assert found.schedule.repeatable is False
    assert found.schedule.to_dict()["repeatable"] is False
    assert any("not repeatable" in note.message for note in found.notes)


def test_a_cancelled_call_is_not_repeatable() -> None:
    cancel = Cancellation()
    threading.Timer(0.3, cancel.cancel).start()
    options = SolveOptions(time_limit=50, deterministic=True, work_limit=1e6, cancel=cancel)
    schedule = solve_task(shop(), options).schedule
    assert (schedule.repeatable, schedule.interrupted) == (False, True)


def test_other_calls_say_nothing_of_it() -> None:
    schedule = irc.solve(project(1), time_limit=20)
    assert schedule.repeatable is None
    assert "repeatable" not in schedule.to_dict()


def test_it_is_kept_in_documents() -> None:
    schedule = irc.solve(job_shop(2), deterministic=True)
    assert irc.Schedule.from_dict(schedule.to_dict()).repeatable is True


def test_what_depends_on_the_clock_is_refused() -> None:
    task = job_shop(1)
    with pytest.raises(OptionError, match="target 'pddl21' cannot be deterministic"):
        irc.solve(task, "pddl21", deterministic=True)
    with pytest.raises(OptionError, match="a simulation cannot be deterministic"):
        irc.simulate(task, deterministic=True)
    with pytest.raises(OptionError, match="an execution cannot be deterministic"):
        irc.replan(task, irc.solve(task), 1, deterministic=True)
    with pytest.raises(OptionError, match="set deterministic"):
        irc.solve(task, work_limit=3)
    with pytest.raises(OptionError, match="more than 0 units"):
        irc.solve(task, deterministic=True, work_limit=0)


def test_work_is_a_clock_that_only_work_moves() -> None:
    now = 0.0
    work = Work(Budget(10, clock=lambda: now))
    budget = work.of(4)
    part = budget.share(0.5)
    assert (budget.left, part.left, budget.work) == (4, 2, work)
    work.add(2)
    assert (budget.left, part.is_over, budget.is_over) == (2, True, False)
    now = 10.0
    assert (budget.is_over, budget.left, work.is_cut) == (True, 0, True)
    assert Budget(3).work is None
