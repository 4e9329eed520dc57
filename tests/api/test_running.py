"""What runs in the background: it ends when it is told to, with the best schedule so far."""

from __future__ import annotations

import asyncio
import os
import random
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import aclosing
from typing import Any

import pytest

import irc
from irc.model import Task
from irc.targets import Budget, Progress

ENOUGH = 5.0
"""Seconds within which a call that is ended ends, also where the machine is busy."""

LIMIT = 60.0
"""Seconds that no test may wait for: whoever takes them was not ended."""


def shop(machines: int = 15, jobs: int = 20) -> Task:
    """A job shop that no solver proves while a test waits.

    Every job visits all machines, in an order and with durations drawn at random, as in Taillard
    (1993), "Benchmarks for basic scheduling problems": 20 jobs on 15 machines are the hard ones.
    """
    rng = random.Random(7)
    actions: list[dict[str, Any]] = []
    precedence = []
    for j in range(jobs):
        route = rng.sample(range(machines), machines)
        for k, machine in enumerate(route):
            uses = [{"resource": f"m{machine}"}]
            actions.append({"id": f"{j}-{k}", "duration": rng.randint(1, 99), "uses": uses})
            if k:
                precedence.append([f"{j}-{k - 1}", f"{j}-{k}"])
    return Task.model_validate(
        {
            "name": "shop",
            "resources": [{"id": f"m{k}"} for k in range(machines)],
            "actions": actions,
            "precedence": precedence,
        }
    )


SHOP = shop()


class Knock:
    """Says when an engine has an answer, and how long it is since then."""

    def __init__(self) -> None:
        self.heard = threading.Event()
        self.since: Budget | None = None

    def __call__(self, progress: Progress) -> None:
        self.since = self.since or Budget()
        self.heard.set()


def nothing_runs() -> bool:
    """Whether no thread of ours and no planner is left (a thread that is done takes a moment)."""
    patience = Budget(1)
    while any(t.name.startswith("irc") for t in threading.enumerate()):
        if patience.is_over:
            return False
    if sys.platform == "win32":
        return True
    parent = ["pgrep", "-P", str(os.getpid()), "-f", "_worker.py"]
    return subprocess.run(parent, capture_output=True, check=False).stdout == b""


# --- cancellation -------------------------------------------------------------------------------


def test_a_call_that_is_cancelled_before_it_begins_asks_no_engine() -> None:
    cancel = irc.Cancellation()
    cancel.cancel()
    schedule = irc.solve(SHOP, cancel=cancel)
    assert (schedule.status, schedule.interrupted) == ("feasible", True)
    assert schedule.engine == "list-schedule"
    assert irc.validate(SHOP, schedule).valid
    assert irc.Schedule.from_dict(schedule.to_dict()) == schedule
    assert schedule.to_dict()["interrupted"] is True
    assert "interrupted" in str(schedule)


@pytest.mark.slow
def test_a_call_that_is_cancelled_has_the_best_schedule_so_far() -> None:
    cancel = irc.Cancellation()
    seen: list[Progress] = []

    def on_progress(progress: Progress) -> None:
        seen.append(progress)
        if len(seen) == 3:
            cancel.cancel()

    schedule = irc.solve(SHOP, time_limit=LIMIT, on_progress=on_progress, cancel=cancel)
    assert (schedule.status, schedule.interrupted) == ("feasible", True)
    assert schedule.makespan <= seen[-1].value
    assert schedule.seconds is not None
    assert schedule.seconds < seen[2].seconds + ENOUGH


def test_an_answer_that_is_certain_is_not_called_interrupted() -> None:
    cancel = irc.Cancellation()
    cancel.cancel()
    task = irc.Task(actions=[{"id": "a", "duration": 3}])
    schedule = irc.solve(task, cancel=cancel)
    assert (schedule.status, schedule.interrupted) == ("optimal", False)
    assert "interrupted" not in schedule.to_dict()


def test_an_explanation_that_is_cancelled_says_so() -> None:
    cancel = irc.Cancellation()
    cancel.cancel()
    explanation = irc.explain(SHOP, cancel=cancel)
    assert (explanation.status, explanation.interrupted) == ("feasible", True)
    assert explanation.to_dict()["interrupted"] is True


def test_a_simulation_that_is_cancelled_keeps_the_steps_before() -> None:
    change = {"op": "set_duration", "action": "0-0", "duration": 150}
    events = [{"at": at, "changes": [change]} for at in (1, 2, 3)]
    task = Task.model_validate(
        {**SHOP.model_dump(exclude_unset=True, by_alias=True), "events": events}
    )
    cancel = irc.Cancellation()

    def on_step(step: irc.Step) -> None:
        if step.at == 1:
            cancel.cancel()

    first = irc.solve(SHOP, time_limit=0.3)
    simulation = irc.simulate(
        task, schedule=first, on_step=on_step, cancel=cancel, time_limit=0.4, workers=1
    )
    assert [step.at for step in simulation.steps] == [0, 1]
    assert simulation.interrupted
    assert simulation.to_dict()["interrupted"] is True
    assert irc.validate(simulation.steps[-1].task, simulation.final, 1).valid


def test_a_replanning_that_is_cancelled_continues_the_history() -> None:
    cancel = irc.Cancellation()
    cancel.cancel()
    first = irc.solve(SHOP, cancel=cancel)  # The compiler's own schedule, the same every time.
    for target in ("cpsat", "pddl21"):
        event = irc.Event(5).set_duration("0-0", 120)
        step = irc.replan(SHOP, first, 5, [event], target=target, cancel=cancel)
        if step.schedule.answered:
            assert irc.validate(step.task, step.schedule, 5).valid
        assert step.schedule.interrupted or step.schedule.status == "optimal"


def test_an_exception_of_who_is_told_ends_the_search() -> None:
    def on_progress(progress: Progress) -> None:
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        irc.solve(SHOP, time_limit=LIMIT, on_progress=on_progress)


# --- ^C -----------------------------------------------------------------------------------------


@pytest.fixture
def interrupting() -> Iterator[Any]:
    """Sends ^C to this process as soon as there is an answer."""
    if sys.platform == "win32" or threading.current_thread() is not threading.main_thread():
        pytest.skip("there is no ^C for this thread")
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield lambda _: os.kill(os.getpid(), signal.SIGINT)
    signal.signal(signal.SIGINT, before)


def test_ctrl_c_ends_a_call_with_the_best_schedule_so_far(interrupting: Any) -> None:
    schedule = irc.solve(SHOP, time_limit=LIMIT, on_progress=interrupting)
    assert (schedule.status, schedule.interrupted) == ("feasible", True)
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_ctrl_c_before_there_is_an_answer_is_not_swallowed(
    interrupting: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    def lower_checked(checked: Any, backend: Any, budget: Budget) -> Any:
        interrupting(None)
        return lowered(checked, backend, budget)

    from irc.driver import solve
    from irc.driver.compile import lower_checked as lowered

    monkeypatch.setattr(solve, "lower_checked", lower_checked)
    task = irc.Task(objective=["maximize_reward"])
    task.action("a", 2).uses(task.resource("r")).optional().reward(3)
    task.action("b", 2).uses("r").optional().reward(3)
    with pytest.raises(KeyboardInterrupt):
        irc.solve(task)


def test_a_handler_of_the_program_stays_its_own(interrupting: Any) -> None:
    got: list[int] = []
    signal.signal(signal.SIGINT, lambda number, _frame: got.append(number))
    schedule = irc.solve(shop(2, 3), time_limit=LIMIT, on_progress=interrupting)
    assert schedule.status == "optimal"
    assert set(got) == {signal.SIGINT}


# --- in the background --------------------------------------------------------------------------


@pytest.mark.slow
def test_a_handle_ends_with_the_best_schedule_so_far() -> None:
    knock = Knock()
    solving = irc.start(SHOP, time_limit=LIMIT, on_progress=knock)
    assert knock.heard.wait(LIMIT)
    assert not solving.done
    with pytest.raises(TimeoutError):
        solving.result(timeout=0)
    solving.cancel()
    ended = Budget()
    schedule = solving.result(timeout=LIMIT)
    assert ended.elapsed < ENOUGH
    assert (schedule.status, schedule.interrupted, solving.done) == ("feasible", True, True)
    assert solving.progress is not None
    assert schedule.makespan <= solving.progress.value
    assert irc.validate(SHOP, solving.progress.schedule()).valid


def test_a_handle_raises_what_solving_raises() -> None:
    with pytest.raises(irc.UnknownTarget):
        irc.start(SHOP, "nowhere").result()
    with pytest.raises(irc.InputError):
        irc.start({"actions": [{"id": "a"}]}).result()


def test_better_and_better_schedules_and_the_answer_last() -> None:
    task = shop(3, 5)
    schedules = list(irc.solve_iter(task, time_limit=LIMIT))
    makespans = [schedule.makespan for schedule in schedules]
    assert makespans == sorted(makespans, reverse=True)
    assert len(set(makespans[:-1])) == len(makespans) - 1
    assert schedules[-1].status == "optimal"
    assert all(irc.validate(task, schedule).valid for schedule in schedules)


def test_what_has_no_schedule_is_said_last() -> None:
    task = irc.Task(deadline=3)
    van = task.resource("van")
    task.action("a", 2).uses(van)
    task.action("b", 2).uses(van)
    assert [s.status for s in task.solve_iter()] == ["infeasible"]


@pytest.mark.slow
def test_the_search_ends_with_the_loop() -> None:
    for schedule in irc.solve_iter(SHOP, time_limit=LIMIT):
        assert schedule.answered
        break
    assert nothing_runs()


# --- async --------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("target", ["cpsat", "pddl21"])
def test_a_cancelled_task_stops_the_engine(target: str) -> None:
    async def main() -> float:
        solving = asyncio.create_task(irc.asolve(shop(12, 30), target, time_limit=LIMIT))
        await asyncio.sleep(0.7)
        solving.cancel()
        ended = Budget()
        with pytest.raises(asyncio.CancelledError):
            await solving
        return ended.elapsed

    assert asyncio.run(main()) < ENOUGH
    assert nothing_runs()


def test_awaited_calls_run_beside_each_other() -> None:
    tasks = [shop(2, jobs) for jobs in (2, 3, 4)]

    async def main() -> list[irc.Schedule]:
        return await asyncio.gather(*(irc.asolve(t, time_limit=LIMIT, workers=1) for t in tasks))

    assert [s.status for s in asyncio.run(main())] == ["optimal"] * 3


def test_an_async_loop_may_be_left() -> None:
    async def main() -> irc.Schedule:
        async with aclosing(irc.asolve_iter(SHOP, time_limit=LIMIT)) as schedules:
            async for schedule in schedules:
                return schedule
        raise AssertionError

    assert asyncio.run(main()).answered
    assert nothing_runs()


def test_every_call_has_an_async_one() -> None:
    task = irc.Task()
    van = task.resource("van")
    a, b = task.action("a", 4).uses(van), task.action("b", 4).uses(van)
    task.event(1).set_duration(a, 6)

    async def main() -> None:
        schedule = await task.asolve()
        assert schedule.makespan == 8
        event = irc.Event(1).set_duration(b, 5)
        assert (await irc.areplan(task, schedule, 1, [event])).schedule.makespan == 9
        assert (await irc.asimulate(task)).final.makespan == 10
        assert (await irc.aexplain(task)).status == "optimal"
        running = irc.Execution(task, schedule)
        running.apply(event)
        step = await running.areplan()
        assert running.schedule == step.schedule
        assert not running.pending

    asyncio.run(main())


# --- progress -----------------------------------------------------------------------------------


@pytest.mark.parametrize("target", ["cpsat", "pddl21"])
def test_progress_tells_of_every_objective(target: str) -> None:
    task = irc.Task(objective=["maximize_reward", "minimize_makespan"], deadline=20)
    van = task.resource("van")
    for k in range(4):
        task.action(f"a{k}", 3 + k).uses(van).optional().reward(k + 1)
    seen: list[Progress] = []
    schedule = irc.solve(task, target, time_limit=10, workers=1, on_progress=seen.append)
    assert schedule.answered
    assert seen
    assert [p.seconds for p in seen] == sorted(p.seconds for p in seen)
    for progress in seen:
        assert progress.levels[0].name == "reward"
        assert progress.value == progress.level.value
        if progress.bound is not None:
            assert progress.gap is not None
            assert 0 <= progress.gap <= 1
        assert irc.validate(task, progress.schedule()).valid
    if target == "cpsat":
        assert {p.objective for p in seen} == {"reward", "makespan"}
        last = seen[-1]
        assert [(o.name, o.value) for o in schedule.objective] == [
            (level.name, level.value) for level in last.levels
        ]


def test_progress_of_a_replanning_is_that_of_the_whole() -> None:
    task = irc.Task()
    van, cart = task.resources("van", "cart")
    for k in range(3):
        task.action(f"a{k}", 4).one_of(van, cart).before(task.action(f"b{k}", 3).uses(van))
    schedule = task.solve()
    for target in ("cpsat", "pddl21"):
        seen: list[Progress] = []
        event = irc.Event(2).set_duration("a0", 6)
        step = irc.replan(task, schedule, 2, [event], target=target, on_progress=seen.append)
        for progress in seen:
            assert progress.schedule().makespan >= step.schedule.makespan
            assert irc.validate(step.task, progress.schedule(), 2).valid


def test_a_gap_is_between_a_value_and_its_bound() -> None:
    gaps = [irc.ObjectiveLevel("makespan", 8, bound).gap for bound in (None, 8, 6)]
    assert gaps == [None, 0.0, 0.25]
    assert irc.ObjectiveLevel("reward", 0, 5).gap == 1.0
