"""Local search beside CP-SAT: what either finds counts, and a proven bound ends both."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest
from ortools.sat.python import cp_model

from builders import Document, act, problem_for_cpsat
from irc.driver.solve import solve_by, solve_task
from irc.local_search import compiled
from irc.local_search.ways import Found
from irc.model import Task
from irc.passes.unroll import unroll
from irc.problem import Problem
from irc.problem.objective_values import schedule_values
from irc.retiming.retime import retime
from irc.retiming.to_schedule import schedule_of
from irc.schedule import Status
from irc.targets import (
    Budget,
    Cancellation,
    Exchange,
    Part,
    Progress,
    SolveOptions,
    get_backend,
)
from irc.validation import validate
from irc_cpsat.encoding.builder import Builder, Model
from irc_cpsat.encoding.encode import write_model
from irc_cpsat.engines import OrTools
from irc_cpsat.solving import beside, improving
from irc_cpsat.solving.beside import Beside
from irc_cpsat.solving.improving import Improving
from irc_cpsat.solving.reporting import Reporter
from irc_cpsat.solving.solution import decisions_of
from list_search_tasks import list_task

MACHINES = 4


def shop(jobs: int) -> Task:
    """Jobs that go over all machines, each in another order."""
    actions: list[Document] = []
    precedence: list[Document] = []
    for job in range(jobs):
        for k in range(MACHINES):
            machine = (job * (k + 1) + k) % MACHINES
            duration = 1 + (7 * job + 3 * k) % 5
            actions.append(act(f"{job}.{k}", duration, uses=[{"resource": f"m{machine}"}]))
            if k:
                precedence.append({"before": f"{job}.{k - 1}", "after": f"{job}.{k}"})
    resources = [{"id": f"m{m}"} for m in range(MACHINES)]
    document = {"resources": resources, "actions": actions, "precedence": precedence}
    return Task.model_validate(document)


@pytest.fixture(autouse=True)
def _at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Local search begins when CP-SAT does, and they exchange at once."""
    monkeypatch.setattr(beside, "ALONE_SECONDS", 0.0)
    monkeypatch.setattr(beside, "ALONE_SHARE", 0.0)
    monkeypatch.setattr(beside, "EXCHANGE_SECONDS", 0.05)


def without_answer(
    workers: int, budget: Budget, reporter: Reporter, ended: Callable[[], bool]
) -> Any:
    """A CP-SAT that finds nothing until it is ended."""
    while not (budget.is_over or ended()):
        pass
    return cp_model.UNKNOWN


def run(
    problem: Problem,
    told: list[Progress] | None = None,
    workers: int = 2,
    exchange: Exchange | None = None,
) -> tuple[Any, Any, Model]:
    """The status and the answer of local search beside a CP-SAT that finds nothing.

    With a list for what is told, it is cancelled at the first schedule.
    """
    cancel = Cancellation()

    def tell(progress: Progress) -> None:
        if told is not None:
            told.append(progress)
            cancel.cancel()

    problem = unroll(problem, 1)
    builder = Builder(problem, True, True)
    built = write_model(builder)
    budget = Budget(60, cancel=cancel)

    def reporter() -> Reporter:
        return Reporter("ortools", built, "makespan", (), budget, tell)

    improving = Improving(problem, 0)
    both = Beside(builder, built, improving, workers, budget, reporter, without_answer, exchange)
    return *both.run(), built


@pytest.mark.parametrize("workers", [1, 2])
def test_a_schedule_that_meets_the_bound_is_optimal_and_ends_the_search(workers: int) -> None:
    task = shop(3)
    problem = problem_for_cpsat(task)
    best = solve_task(task).schedule
    assert best.status is Status.OPTIMAL
    problem = problem.with_bound(int(best.makespan), "it was proven before")
    budget = Budget()
    status, answer, built = run(problem, workers=workers)
    assert status == cp_model.OPTIMAL
    assert answer.value(built.makespan) == best.makespan
    assert budget.elapsed < 30


@pytest.mark.parametrize("workers", [1, 2])
def test_a_bound_and_a_schedule_of_others_count_as_its_own(workers: int) -> None:
    task = shop(3)
    problem = problem_for_cpsat(task).with_bound(1, "nothing is proven")
    best = int(solve_task(task).schedule.makespan)
    first = Exchange(Part(1, 2))
    first.prove(best)
    status, answer, built = run(problem, workers=workers, exchange=first)
    assert status == cp_model.OPTIMAL
    assert answer.value(built.makespan) == best
    assert first.best is not None
    assert first.best[0] == best
    # Where nothing else is found, the schedule of others is the answer.
    second = Exchange(Part(2, 3))
    second.offer(*first.best)
    second.prove(best)
    status, answer, built = run(problem, workers=workers, exchange=second)
    assert status == cp_model.OPTIMAL
    schedule = schedule_of(problem, retime(problem, decisions_of(built, answer)))
    assert schedule.makespan == best
    assert not validate(task, schedule).violations


@pytest.mark.parametrize("number", [0, 1])
def test_with_one_worker_it_searches_though_others_have_a_schedule(number: int) -> None:
    task = shop(3)
    problem = problem_for_cpsat(task).with_bound(1, "nothing is proven")
    best = int(solve_task(task).schedule.makespan)
    searching = Improving(unroll(problem, 1), 0)
    assert searching.begin()
    while searching.value != best:
        searching.step()
    assert searching.found is not None
    decisions, pools = searching.found
    later = [replace(d, start=d.start + 3, end=d.end + 3) for d in decisions]
    exchange = Exchange(Part(number, 2))
    exchange.offer(best + 3, (later, pools))
    exchange.prove(best)
    status, answer, built = run(problem, workers=1, exchange=exchange)
    assert status == cp_model.OPTIMAL
    assert answer.value(built.makespan) == best


@pytest.mark.parametrize("workers", [1, 2])
def test_without_a_bound_it_is_feasible_and_valid(workers: int) -> None:
    task = shop(5)
    problem = problem_for_cpsat(task).with_bound(1, "nothing is proven")
    told: list[Progress] = []
    status, answer, built = run(problem, told, workers)
    assert status == cp_model.FEASIBLE
    assert answer.best_objective_bound == 1
    schedule = schedule_of(problem, retime(problem, decisions_of(built, answer)))
    assert not validate(task, schedule).violations
    assert schedule_values(problem, schedule)["makespan"] <= answer.reached
    assert answer.reached <= told[-1].value
    assert not validate(task, told[-1].schedule()).violations


@pytest.mark.parametrize(("workers", "searches", "rounds"), [(2, 2, [1]), (4, 3, [3, 1])])
def test_on_a_large_shop_local_search_has_most_workers_after_a_while(
    workers: int, searches: int, rounds: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(beside, "LARGE_SHOP", 1)
    monkeypatch.setattr(improving, "SMALL_SHOP", 0)
    monkeypatch.setattr(beside, "FAIR_SHARE", 0.0)
    monkeypatch.setattr(compiled, "IS_COMPILED", True)
    problem = unroll(problem_for_cpsat(shop(5)).with_bound(1, "nothing is proven"), 1)
    cancel = Cancellation()
    counts: list[int] = []
    asked: list[int] = []

    class Counted(Improving):
        """It is ended where CP-SAT has no worker left."""

        def start(self, count: int = 1) -> None:
            counts.append(count)
            super().start(count)

        def wait(self, budget: Budget) -> None:
            cancel.cancel()

    def ask(workers: int, budget: Budget, reporter: Reporter, ended: Callable[[], bool]) -> Any:
        asked.append(workers)
        if len(asked) > 1:
            cancel.cancel()
        status = without_answer(workers, budget, reporter, ended)
        ended()  # CP-SAT does not end at once, and asks again.
        return status

    builder = Builder(problem, True, True)
    built = write_model(builder)
    budget = Budget(60, cancel=cancel)

    def reporter() -> Reporter:
        return Reporter("ortools", built, "makespan", (), budget, None)

    both = Beside(builder, built, Counted(problem, 0), workers, budget, reporter, ask)
    status, answer = both.run()
    assert (counts, asked) == ([1, searches], rounds)
    assert status == cp_model.FEASIBLE
    assert retime(problem, decisions_of(built, answer))


class Counting:
    """A search that finds nothing."""

    value = None
    steps = 0

    def step(self) -> None:
        self.steps += 1
        time.sleep(0.001)

    def give(self, found: Found) -> None:
        self.given = found


def test_the_search_of_a_small_problem_rests_until_it_is_given_something(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    search = Counting()
    monkeypatch.setattr(improving, "_REST_AFTER_SECONDS", 0.0)
    monkeypatch.setattr(improving, "search_of", lambda *_values, **_named: search)
    small = Improving(unroll(problem_for_cpsat(shop(3)), 1), 0)
    assert small.rests
    small.start()
    small.wait(Budget(0.3))
    assert (resting := search.steps) > 0
    small.wait(Budget(0.2))
    assert search.steps == resting
    small.give(((), ()), 100)
    small.wait(Budget(0.3))
    assert search.given == ((), ())
    assert search.steps > resting
    small.end()
    assert not any(thread.is_alive() for thread in small._threads)


def test_searches_that_run_at_once_go_on_from_the_best_of_all() -> None:
    problem = unroll(problem_for_cpsat(shop(5)).with_bound(1, "nothing is proven"), 1)
    improving = Improving(problem, 0)
    improving.start(2)
    budget = Budget(60)
    while improving.value is None and not budget.is_over:
        improving.wait(budget.at_most(0.01))
    improving.end()
    assert improving.found is not None
    assert improving.value == max(int(d.end) for d in improving.found[0])


def test_both_together_prove_the_same_makespan_as_cp_sat_alone() -> None:
    task = shop(6)
    options = SolveOptions(time_limit=60, workers=2)
    found = [
        solve_by(task, get_backend("cpsat"), OrTools(improves=improves), options, options.budget())
        for improves in (True, False)
    ]
    assert [a.schedule.status for a in found] == [Status.OPTIMAL] * 2
    assert found[0].schedule.makespan == found[1].schedule.makespan


def test_objectives_after_the_makespan_follow_as_before() -> None:
    task = shop(4)
    due = {**task.model_dump(mode="json", exclude_unset=True)}
    due["actions"][0] |= {"due": 2}
    due["objective"] = ["minimize_makespan", "minimize_tardiness"]
    both = Task.model_validate(due)
    options = SolveOptions(time_limit=60, workers=2)
    answers = [
        solve_by(both, get_backend("cpsat"), OrTools(improves=improves), options, options.budget())
        for improves in (True, False)
    ]
    values = [[level.value for level in a.schedule.objective] for a in answers]
    assert values[0] == values[1]
    assert {a.schedule.status for a in answers} == {Status.OPTIMAL}


def test_a_deadline_that_no_schedule_keeps_is_still_refuted() -> None:
    task = shop(6)
    best = solve_task(task).schedule.makespan
    late = Task.model_validate(
        {**task.model_dump(mode="json", exclude_unset=True), "deadline": int(best) - 1}
    )
    assert solve_task(late).schedule.status is Status.INFEASIBLE


def test_a_cancelled_call_ends_with_the_best_so_far() -> None:
    cancel = Cancellation()
    budget = Budget()
    options = SolveOptions(
        time_limit=60, workers=2, cancel=cancel, on_progress=lambda _: cancel.cancel()
    )
    answer = solve_task(shop(14), replace(options))
    assert answer.schedule.entries
    assert budget.elapsed < 30


def test_what_local_search_raises_reaches_the_caller(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*_: Any, **__: Any) -> Any:
        raise OSError("no room to compile in")

    monkeypatch.setattr("irc_cpsat.solving.improving.search_of", fails)
    with pytest.raises(OSError, match="no room"):
        run(problem_for_cpsat(shop(5)).with_bound(1, "nothing"))


@pytest.mark.parametrize("seed", [1, 7, 8])
def test_other_objectives_are_proven_the_same_beside_local_search(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("irc.local_search.search.LISTS_FROM", 1)
    task = Task.model_validate(list_task(seed, size=5))
    options = SolveOptions(time_limit=60, workers=2)
    answers = [
        solve_by(task, get_backend("cpsat"), OrTools(improves=improves), options, options.budget())
        for improves in (True, False)
    ]
    assert {a.schedule.status for a in answers} == {Status.OPTIMAL}
    one, other = (a.schedule.objective[0] for a in answers)
    assert (one.name, one.value) == (other.name, other.value)
    assert not validate(task, answers[0].schedule).violations


@pytest.mark.parametrize("workers", [1, 2])
def test_a_task_that_begins_with_lists_ends_where_they_meet_the_bound(
    workers: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("irc.local_search.search.LISTS_FROM", 1)
    monkeypatch.setattr(compiled, "IS_COMPILED", True)
    actions = [act(f"a{k}", 6, uses=[{"resource": "m"}], breaks="pause") for k in range(6)]
    day = {"id": "day", "every": 10, "open": [{"from": 0, "to": 5}]}
    machine = {"id": "m", "calendar": "day"}
    task = Task.model_validate({"calendars": [day], "resources": [machine], "actions": actions})
    options = SolveOptions(time_limit=60, workers=workers)
    schedule = solve_task(task, options).schedule
    assert schedule.status is Status.OPTIMAL
    assert schedule.makespan == 71
    assert not validate(task, schedule).violations
