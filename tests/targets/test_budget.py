"""One clock with one owner: parts of a budget never outlive it, and nobody else reads the clock."""

from __future__ import annotations

import ast
import math
import pickle
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

import irc
from irc.checks import run_checks
from irc.driver.compile import lower_checked
from irc.driver.solve import solve_task
from irc.execution import simulate
from irc.execution.continuation import AFTERWARDS_SHARE
from irc.explanation import explain_task
from irc.model import Task
from irc.targets import Budget, Cancellation, Engine, Outcome, Program, SolveOptions
from irc_cpsat import CpSat
from irc_cpsat.engines import OrTools

ROOT = Path(__file__).resolve().parents[2]

READS = {
    "time": {
        f"{name}{suffix}"
        for name in ("time", "perf_counter", "monotonic", "process_time", "thread_time")
        for suffix in ("", "_ns")
    }
    | {"clock_gettime", "clock_gettime_ns", "gmtime", "localtime", "ctime"},
    "datetime": {"now", "today", "utcnow"},
    "timeit": {"default_timer", "timeit", "repeat"},
}
"""The functions of the standard library that say what time it is."""

READERS = {"irc/targets/budget.py"}
"""The modules that may."""


@dataclass
class Hands:
    """A clock that is moved by hand."""

    now: float = 100.0

    def __call__(self) -> float:
        return self.now


# --- a budget -----------------------------------------------------------------------------------


def test_a_budget_runs_from_when_it_is_made() -> None:
    clock = Hands()
    budget = Budget(10, clock=clock)
    assert (budget.limit, budget.left, budget.elapsed, budget.is_over) == (10, 10, 0, False)
    clock.now += 4
    assert (budget.limit, budget.left, budget.elapsed, budget.is_over) == (10, 6, 4, False)
    clock.now += 7
    assert (budget.limit, budget.left, budget.elapsed, budget.is_over) == (10, 0, 11, True)


def test_without_a_limit_it_never_ends() -> None:
    clock = Hands()
    budget = Budget(clock=clock)
    clock.now += 1e9
    assert (budget.left, budget.elapsed, budget.is_over) == (math.inf, 1e9, False)
    assert not budget.is_limited
    assert not budget.share(0.5).is_limited
    assert not budget.share(0).is_limited
    assert budget.at_most(3).left == 3


def test_a_part_is_of_what_is_left_and_runs_from_now() -> None:
    clock = Hands()
    budget = Budget(10, clock=clock)
    clock.now += 4
    half, two, all_of_it = budget.share(0.5), budget.at_most(2), budget.share(1)
    assert [part.limit for part in (half, two, all_of_it)] == [3, 2, 6]
    assert [part.elapsed for part in (half, two, all_of_it)] == [0, 0, 0]
    clock.now += 3
    assert (half.is_over, two.is_over, all_of_it.is_over, budget.left) == (True, True, False, 3)


@pytest.mark.parametrize("seconds", [0, 0.1, 5, 1e9, math.inf])
def test_a_part_never_outlives_the_whole(seconds: float) -> None:
    clock = Hands()
    budget = Budget(1, clock=clock)
    for _ in range(6):
        for part in (budget.at_most(seconds), budget.share(1), budget.share(7)):
            assert part.left <= budget.left
            assert part.at_most(seconds).left <= budget.left
        clock.now += 0.3
    assert budget.is_over
    assert budget.at_most(seconds).is_over


def test_a_pickled_budget_goes_on_where_it_was() -> None:
    clock = Hands()
    budget = Budget(10, clock=clock)
    clock.now += 4
    again = pickle.loads(pickle.dumps(budget))
    assert (again.limit, again.left, again.elapsed) == (10, 6, 4)
    unlimited = pickle.loads(pickle.dumps(Budget()))
    assert not unlimited.is_limited


# --- who gets it --------------------------------------------------------------------------------


def crowd() -> Task:
    """A task that an engine must be asked about."""
    uses = [{"resource": "van"}]
    return Task.model_validate(
        {
            "resources": [{"id": "van"}],
            "actions": [{"id": n, "duration": 3, "uses": uses} for n in "abc"],
            "events": [
                {"at": 1, "changes": [{"op": "set_duration", "action": "b", "duration": 4}]}
            ],
        }
    )


@pytest.fixture
def given(monkeypatch: pytest.MonkeyPatch) -> list[Budget]:
    """The budgets that CP-SAT is given."""
    seen: list[Budget] = []

    def solve(self: Engine, program: Program, options: SolveOptions, budget: Budget) -> Outcome:
        seen.append(budget)
        return original(self, program, options, budget)

    original = OrTools.solve
    monkeypatch.setattr(OrTools, "solve", solve)
    return seen


def test_an_engine_gets_what_is_left_of_the_limit(given: list[Budget]) -> None:
    irc.solve(crowd(), time_limit=20, workers=1, shortcut=False)
    assert 0 < given[0].limit <= 20


def test_no_limit_reaches_the_engine_as_none(given: list[Budget]) -> None:
    irc.solve(crowd(), time_limit=None, workers=1, shortcut=False)
    assert not given[0].is_limited


def test_a_longer_call_gives_a_part_of_its_budget(given: list[Budget]) -> None:
    clock = Hands()
    whole = Budget(20, clock=clock)
    clock.now += 5
    solve_task(crowd(), SolveOptions(time_limit=60, workers=1, shortcut=False), whole)
    assert 14 <= given[0].limit <= 15


def test_each_step_has_the_whole_limit(given: list[Budget]) -> None:
    simulate(crowd(), options=SolveOptions(time_limit=20, workers=1))
    assert len(given) == 2
    assert all(10 < budget.limit <= 20 for budget in given)


def test_an_engine_leaves_time_for_what_follows_it(
    given: list[Budget], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(CpSat, "begins_now", True)
    simulate(crowd(), options=SolveOptions(time_limit=20, workers=1))
    assert given[1].limit <= 20 * (1 - AFTERWARDS_SHARE)


def test_an_explanation_has_one_budget(given: list[Budget]) -> None:
    explain_task(crowd(), 20)
    assert given
    assert all(budget.limit <= 20 for budget in given)


# --- who reads the clock ------------------------------------------------------------------------


def reads(source: str) -> Iterator[tuple[int, str]]:
    """Line and name of whatever in a module's text says what time it is."""
    tree = ast.parse(source)
    modules: dict[str, str] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            modules |= {n.asname or n.name: n.name for n in node.names if n.name in READS}
        elif isinstance(node, ast.ImportFrom) and node.module in READS:
            for name in node.names:
                if name.name in READS[node.module]:
                    yield node.lineno, f"{node.module}.{name.name}"
                elif node.module == "datetime":
                    modules[name.asname or name.name] = "datetime"
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute):
            owner = node.value
            while isinstance(owner, ast.Attribute):
                owner = owner.value
            module = modules.get(owner.id) if isinstance(owner, ast.Name) else None
            if module is not None and node.attr in READS[module]:
                yield node.lineno, f"{module}.{node.attr}"
            elif node.attr == "time" and "loop" in ast.unparse(node.value):
                yield node.lineno, ast.unparse(node)


@pytest.mark.parametrize(
    "source",
    [
        "import time\ntime.perf_counter()",
        "import time as t\nt.monotonic_ns()",
        "from time import perf_counter",
        "from time import time as now",
        "import datetime\ndatetime.datetime.now()",
        "from datetime import datetime as d\nd.utcnow()",
        "import asyncio\nasyncio.get_running_loop().time()",
    ],
)
def test_a_look_at_the_clock_is_seen(source: str) -> None:
    assert list(reads(source))


@pytest.mark.parametrize(
    "source",
    [
        "import time\ntime.sleep(1)",
        "from datetime import datetime\ndatetime.fromisoformat(text)",
        "budget.elapsed",
    ],
)
def test_what_is_no_look_at_the_clock_is_not(source: str) -> None:
    assert not list(reads(source))


@pytest.mark.slow
def test_only_a_budget_reads_the_clock() -> None:
    found = {
        f"{path.relative_to(ROOT).as_posix()}:{line}: {name}"
        for folder in ("irc", "backends", "grammars")
        for path in sorted((ROOT / folder).rglob("*.py"))
        for line, name in reads(path.read_text(encoding="utf-8"))
    }
    others = {place for place in found if place.split(":")[0] not in READERS}
    assert not others, "\n".join(sorted(others))
    assert len(found) > len(others), "the search finds nothing at all"


# --- in a hurry ---------------------------------------------------------------------------------


def test_seconds_that_have_gone_by_count() -> None:
    clock = Hands()
    budget = Budget(10, spent=4, clock=clock)
    assert (budget.limit, budget.left, budget.elapsed) == (10, 6, 4)
    clock.now += 7
    assert budget.is_over


def test_a_part_may_outlive_the_whole_but_not_what_ends_it() -> None:
    cancel = Cancellation()
    part = Budget(0, cancel=cancel).at_least(5).share(1)
    assert 4 < part.left <= 5
    cancel.cancel()
    assert (part.left, part.is_over, part.is_cancelled) == (0, True, True)


def test_after_cancel_no_time_is_left_of_any_part() -> None:
    cancel = Cancellation()
    budget = Budget(cancel=Cancellation(cancel))
    parts = [budget, budget.share(0.5), budget.at_most(9), budget.at_least(9)]
    assert not any(part.is_over for part in parts)
    cancel.cancel()
    assert all(part.is_over and part.is_cancelled and part.left == 0 for part in parts)
    assert not Budget(0).is_cancelled, "a limit that is over is no cancellation"


def test_without_time_to_load_a_solver_the_compiler_answers(given: list[Budget]) -> None:
    schedule = irc.solve(crowd(), time_limit=0.001, shortcut=False)
    assert (schedule.status, schedule.engine) == ("optimal", "list-schedule")
    assert not schedule.interrupted
    assert not given


def test_much_of_the_time_spent_only_quick_bounds_are_sought(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[object] = []
    monkeypatch.setattr("irc.passes.serial_sgs.quick_makespan", asked.append)
    checked = run_checks(crowd(), lint=False)
    problems = [lower_checked(checked, CpSat(), Budget(10, spent=spent)) for spent in (5, 0)]
    assert len(asked) == 1, "the second one looks for more"
    assert [p.to_units(p.bounds.makespan.value) for p in problems] == [9, 9]


@pytest.mark.slow
def test_a_command_counts_from_the_start_of_its_process() -> None:
    code = "from irc.targets.budget import seconds_since_start as s; print(s(), s(waited=True))"
    began = Budget()
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    passed, computed = map(float, done.stdout.split())
    assert 0 < computed < passed + 0.05
    assert passed < began.elapsed + 0.05
