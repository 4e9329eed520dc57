"""Solving from threads, forked and spawned processes and pools, and many times in one process."""

from __future__ import annotations

import gc
import json
import multiprocessing
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest

import irc

pytestmark = pytest.mark.slow

METHODS = [
    m for m in ("fork", "forkserver", "spawn") if m in multiprocessing.get_all_start_methods()
]


def task_number(k: int) -> dict[str, Any]:
    """A small task; of each five one is faulty, one refused by `pddl21`, one infeasible."""
    uses = [{"resource": "van"}]
    actions = [{"id": f"a{i}", "duration": 1 + (k + i) % 5, "uses": uses} for i in range(4)]
    document: dict[str, Any] = {"resources": [{"id": "van"}], "actions": actions}
    if k % 5 == 1:
        actions[0]["duratio"] = actions[0].pop("duration")
    if k % 5 == 2:
        actions[0]["due"] = 2
        document["objective"] = ["minimize_earliness"]
    if k % 5 == 3:
        document["precedence"] = [["a0", "a1"], ["a1", "a0"]]
    return document


def solved(k: int) -> tuple[str, Any]:
    """How a task ends, with the whole schedule or the text of the error."""
    target = "pddl21" if k % 5 == 2 else "cpsat"
    try:
        schedule = irc.solve(task_number(k), target, time_limit=20, workers=1)
    except irc.IrcError as error:
        return error.outcome.status, str(error)
    return schedule.outcome.status, schedule.entries


def raised(k: int) -> irc.Schedule:
    """The schedule of a task; its errors are those of `irc.solve`, with all their contents."""
    return irc.solve(task_number(k), "pddl21" if k % 5 == 2 else "cpsat", workers=1)


EXPECTED = ["optimal", "faulty", "refused", "infeasible", "optimal"]


@pytest.mark.parametrize("method", METHODS)
def test_a_pool_gives_all_outcomes_and_goes_on_after_faulty_tasks(method: str) -> None:
    here = [solved(k) for k in range(10)]
    assert [status for status, _ in here] == EXPECTED * 2
    context = multiprocessing.get_context(method)
    with context.Pool(2) as pool:
        assert pool.map(solved, range(10)) == here
        with pytest.raises(irc.InputError) as caught:
            pool.map(raised, range(10))
        assert caught.value.outcome.status in ("faulty", "refused")
        assert pool.map(solved, range(10)) == here, "the pool can still be used"


def test_an_executor_gives_each_error_where_its_result_is_asked_for() -> None:
    context = multiprocessing.get_context(METHODS[0])
    with ProcessPoolExecutor(2, mp_context=context) as executor:
        futures = [executor.submit(raised, k) for k in range(10)]
        errors = [future.exception() for future in futures]
    for k, error in enumerate(errors):
        if EXPECTED[k % 5] in ("faulty", "refused"):
            assert isinstance(error, irc.InputError)
            assert error.outcome.status == EXPECTED[k % 5]
            assert error.report.errors
        else:
            assert error is None


def test_threads_get_the_answers_that_one_thread_gets() -> None:
    here = [solved(k) for k in range(20)]
    with ThreadPoolExecutor(8) as threads:
        assert list(threads.map(solved, range(20))) == here


FIRST_USE = """
import json, sys
from concurrent.futures import ThreadPoolExecutor
from threading import Barrier
import irc
ready = Barrier(8)
def first(k):
    ready.wait()
    task = json.loads(sys.argv[1])
    return irc.solve(task, ("cpsat", "pddl21")[k % 2], time_limit=20, workers=1).makespan
with ThreadPoolExecutor(8) as threads:
    print(set(threads.map(first, range(8))))
"""


def test_threads_can_be_the_first_to_load_what_a_call_needs() -> None:
    result = subprocess.run(
        [sys.executable, "-c", FIRST_USE, json.dumps(task_number(0))],
        capture_output=True,
        text=True,
        timeout=100,
    )
    assert (result.stdout, result.stderr) == ("{10}\n", "")


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="memory is read on Linux only")
def test_solving_again_and_again_takes_no_more_memory() -> None:
    def resident() -> int:
        return int(Path("/proc/self/statm").read_text().split()[1]) * 4096

    for k in range(50):
        solved(k)
    gc.collect()
    before = resident()
    for k in range(50, 200):
        solved(k)
    gc.collect()
    assert resident() - before < 6 * 2**20
