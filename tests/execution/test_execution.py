"""A live execution, whole simulations, and how little of a plan has to move."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

import irc
from builders import task_of
from irc.diagnostics import Code, InputError
from irc.execution import Execution, simulate
from irc.execution.stabilise import stabilised
from irc.lowering.lower import lower
from irc.model import Task
from irc.passes import run_passes
from irc.problem import PreviousPlace, PreviousPlan
from irc.schedule import Status
from irc.targets import Budget, SolveOptions
from online_cases import OPTIONS, action, entry, event, plan, repaired, starts

VAN = [{"id": "van"}]
CHAIN = task_of(
    *(action(n, d, "van") for n, d in (("a", 4), ("b", 4), ("c", 4))), action("d", 2), resources=VAN
)
PLAN = plan(
    entry("a", 0, 4, "van"),
    entry("d", 1, 3),
    entry("b", 4, 8, "van"),
    entry("c", 8, 12, "van"),
)
LATE = {"op": "set_duration", "action": "a", "duration": 6}


def running(whole: Task = CHAIN, at: int = 0, **means: object) -> Execution:
    return Execution(whole, PLAN, at, **{"options": OPTIONS, **means})  # type: ignore[arg-type]


# --- time ---


def test_time_does_not_go_back() -> None:
    run = running(at=3)
    with pytest.raises(InputError, match="3 s already"):
        run.advance(2)
    with pytest.raises(InputError, match="3 s already"):
        run.apply(event(2, LATE))
    run.advance("7/2")
    assert run.now == Fraction(7, 2)
    assert run.task is CHAIN


def test_an_event_that_does_not_fit_changes_nothing() -> None:
    run = running(at=2)
    done = {"op": "cancel_actions", "actions": ["a", "nobody"]}
    with pytest.raises(InputError):
        run.apply(event(3, LATE, done))
    assert (run.now, run.task, run.pending, run.schedule) == (2, CHAIN, (), PLAN)


def test_a_copy_goes_its_own_way() -> None:
    run = running()
    other = run.copy()
    other.apply(event(2, LATE))
    assert (run.now, run.pending, run.schedule) == (0, (), PLAN)
    assert starts(other.replan().schedule)["b"] == 6
    assert starts(run.schedule)["b"] == 4


# --- repairs ---


@pytest.mark.parametrize("at", [0, 2, 4, "9/2"])
def test_where_nothing_has_changed_nothing_moves(at: object) -> None:
    run = running()
    run.advance(at)  # type: ignore[arg-type]
    step = run.replan()
    assert (step.moved, step.schedule.entries) == (0, PLAN.entries)


def test_when_everything_is_done_nothing_is_left() -> None:
    run = running(at=20)
    step = run.replan()
    assert step.schedule.entries == PLAN.entries
    assert step.schedule.status is Status.OPTIMAL
    assert set(step.completed) == {"a", "b", "c", "d"}


def test_two_events_of_one_instant_are_one_step_in_their_order() -> None:
    run = running()
    run.apply(event(2, LATE))
    run.apply(event(2, {"op": "add_actions", "actions": [action("e", 1, "van")]}))
    run.apply(event(2, {"op": "cancel_actions", "actions": ["e"]}))
    step = run.replan()
    assert [len(e.changes) for e in step.events] == [1, 1, 1]
    assert starts(step.schedule) == {"a": 0, "d": 1, "b": 6, "c": 10}
    assert step.moved == 2
    assert run.pending == ()


def test_times_are_exact_however_odd_an_event_is() -> None:
    step = repaired(CHAIN, PLAN, Fraction(7, 3), {**LATE, "duration": "13/3"})
    assert starts(step.schedule)["c"] == Fraction(25, 3)
    assert step.schedule.makespan == Fraction(37, 3)


def test_where_nothing_continues_the_old_plan_stays() -> None:
    run = running()
    run.apply(event(2, {"op": "set_deadline", "deadline": 11}))
    step = run.replan()
    assert (step.schedule.status, step.schedule.entries) == (Status.INFEASIBLE, ())
    assert run.schedule.entries
    assert len(run.pending) == 1
    run.apply(event(2, {"op": "set_deadline", "deadline": 12}))
    assert run.replan().schedule.entries == PLAN.entries


def test_a_schedule_of_something_else_is_refused() -> None:
    with pytest.raises(InputError, match="does not have"):
        Execution(CHAIN, plan(entry("x", 0, 1)))
    with pytest.raises(InputError, match="two entries of"):
        Execution(CHAIN, plan(entry("a", 0, 4, "van"), entry("a", 4, 8, "van")))


def test_what_holds_what_it_cannot_is_refused() -> None:
    with pytest.raises(InputError, match=r"holds cart.*does not allow"):
        Execution(CHAIN, plan(entry("a", 0, 4, "cart")), 1).replan()


# --- moving little ---

TABLES = task_of(
    *(action(n, d, "t1|t2") for n, d in (("a", 10), ("b", 10), ("c", 9), ("d", 9))),
    resources=[{"id": "t1"}, {"id": "t2"}],
)
SEATED = plan(
    entry("a", 0, 10, "t1"),
    entry("b", 0, 10, "t2"),
    entry("c", 10, 19, "t1"),
    entry("d", 10, 19, "t2"),
)


def test_among_equals_as_little_moves_as_can_be() -> None:
    longer = {"op": "set_duration", "action": "a", "duration": 11}
    step = repaired(TABLES, SEATED, 5, longer)
    assert (step.schedule.makespan, step.moved) == (20, 1)
    assert step.schedule.status is Status.OPTIMAL
    assert [o.name for o in step.schedule.objective] == ["makespan", "changes"]


@pytest.mark.parametrize(
    ("stability", "makespan", "moved"), [(0, 14, 3), (0.06, 14, 3), ("10%", 15, 1)]
)
def test_stability_lets_the_makespan_grow_by_so_much_to_move_less(
    stability: float | str, makespan: int, moved: int
) -> None:
    """`a` takes 1 longer: all others follow it, or `b` alone goes last."""
    shop = task_of(
        action("a", 5, "m"),
        action("b", 2, "m"),
        action("c", 4, "m"),
        action("d", 2, "m"),
        resources=[{"id": "m"}],
    )
    old = plan(
        entry("a", 0, 5, "m"),
        entry("b", 5, 7, "m"),
        entry("c", 7, 11, "m"),
        entry("d", 11, 13, "m"),
    )
    longer = {"op": "set_duration", "action": "a", "duration": 6}
    step = repaired(shop, old, 2, longer, stability=stability)
    assert (step.schedule.makespan, step.moved) == (makespan, moved)


def test_reward_comes_before_changes_and_changes_before_what_follows_them() -> None:
    first = task_of(
        action("a", 4, "van"),
        action("b", 4, "van", occurs="optional", reward=3),
        action("c", 2, "van"),
        resources=VAN,
        objective=["maximize_reward", "minimize_changes", "minimize_makespan"],
    )
    old = plan(entry("a", 0, 4, "van"), entry("c", 6, 8, "van"))
    step = repaired(first, old, 1)
    assert starts(step.schedule) == {"a": 0, "c": 6, "b": 8}
    assert step.moved == 0
    soon = first.model_copy(update={"objective": ("maximize_reward", "minimize_makespan")})
    assert repaired(soon, old, 1).schedule.makespan == 10


def test_minimize_changes_before_all_else_leaves_the_gap_where_it_is() -> None:
    still = CHAIN.model_copy(update={"objective": ("minimize_changes", "minimize_makespan")})
    shorter = {"op": "set_duration", "action": "a", "duration": 3}
    assert repaired(still, PLAN, 2, shorter).moved == 0
    assert repaired(CHAIN, PLAN, 2, shorter).schedule.makespan == 11


def test_what_moved_for_no_reason_is_put_back() -> None:
    """The old plan as a whole is rejected here, so each activity is put back by itself."""
    document = task_of(
        action("a", 4, "van"),
        {"id": "b", "modes": [{"id": "m", "duration": 2}, {"id": "n", "duration": 1}]},
        action("c", 1),
        resources=VAN,
    )
    earlier = (PreviousPlace(0, None, (0,)), PreviousPlace(2, 0, ()), PreviousPlace(2, None, ()))
    problem = replace(run_passes(lower(document)), previous=PreviousPlan(earlier))
    old = [entry("a", 0, 4, "van"), entry("b", 2, 4, mode="m"), entry("c", 2, 3)]
    found = plan(entry("a", 0, 4, "van"), entry("b", 0, 2, mode="m"), entry("c", 0, 1))
    verdicts = iter([False, True])
    new = stabilised(problem, found, old, Fraction(0), lambda _: next(verdicts), Budget())
    assert starts(new) == {"a": 0, "b": 2, "c": 2}


def test_what_happened_to_one_of_several_occurrences_is_kept_by_the_history() -> None:
    thrice = task_of(action("a", 4, "van", occurs={"min": 3, "max": 3}), resources=VAN)
    run = Execution(thrice, irc.solve(thrice))
    run.advance(5)
    run.observe("a", finished=5)
    run.observe("a", occurrence=2, started=5)
    step = run.replan()
    assert [(e.start, e.end) for e in step.schedule.entries] == [(0, 5), (5, 9), (9, 13)]
    assert step.running == ("a",)
    assert [note.code for note in step.notes] == [Code.CARRIED]
    with pytest.raises(InputError, match="no occurrence 4"):
        run.observe("a", occurrence=4, started=5)
    (note,) = run.observe("a", occurrence=2, started=4)
    assert "corrects what was observed at 5 s: it started at 5 s" in note.message


# --- simulations ---


def test_a_simulation_goes_on_where_nothing_continues() -> None:
    late = event(2, {"op": "set_deadline", "deadline": 11})
    after = event(3, {"op": "set_deadline", "deadline": 30})
    episode = CHAIN.model_copy(update={"events": (after, late)})
    seen: list[object] = []
    done = simulate(episode, options=OPTIONS, on_step=lambda step: seen.append(step.at))
    assert seen == [0, 2, 3]
    assert done.steps[1].schedule.status is Status.INFEASIBLE
    assert (done.final.status, done.final.makespan) == (Status.OPTIMAL, 12)


def test_a_simulation_without_a_first_plan_has_one_step() -> None:
    impossible = CHAIN.model_copy(update={"deadline": 11, "events": (event(1, LATE),)})
    done = simulate(impossible, options=OPTIONS)
    assert [step.schedule.status for step in done.steps] == [Status.INFEASIBLE]


def test_a_simulation_begins_with_the_plan_that_is_given() -> None:
    episode = CHAIN.model_copy(update={"events": (event(2, LATE),)})
    done = simulate(episode, schedule=PLAN, options=OPTIONS)
    assert done.steps[0].schedule is PLAN
    assert done.moved == done.steps[1].moved == 2
    assert starts(done.final)["d"] == 1


def test_the_time_limit_of_a_replanning_counts_from_when_its_request_arrived() -> None:
    """What has gone by since then is not there any more for an engine."""
    shop = task_of(*(action(n, 3, "oven") for n in "abc"), resources=[{"id": "oven"}])
    old = plan(*(entry(n, t, t + 3, "oven") for n, t in (("a", 0), ("b", 3), ("c", 6))))
    engines = []
    for spent in (0.0, 10.0):
        running = Execution(shop, old, 1, options=SolveOptions(time_limit=9.0, workers=1))
        running.apply(event(1, {"op": "set_duration", "action": "b", "duration": 2}))
        engines.append(running.replan(since=Budget(spent=spent)).schedule.engine)
    assert engines == ["ortools", "list-schedule"]
