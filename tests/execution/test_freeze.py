"""What has begun as a fixed part of a problem, and what is left of it from now on."""

from __future__ import annotations

import pytest

from builders import task_of
from irc.execution.freeze import with_groups
from irc.execution.residual import PastError, ResidualProblem, residual_problem
from irc.lowering.lower import lower
from irc.problem import IMPOSSIBLE_DEADLINE, Arc
from irc.problem.choices import UnexplainedError, choices_of
from irc.schedule import Entry
from online_cases import action, entry, frozen_at, plan, repaired, starts

ROBOTS = [{"id": "r1", "capacity": 2}, {"id": "r2"}, {"id": "r3"}]


# --- what an entry says ---


def test_a_resource_is_found_for_each_use_even_if_the_first_choice_was_wrong() -> None:
    problem = lower(task_of(action("a", 1, "r1|r2", "r1|r3"), resources=ROBOTS))
    names = [r.id for r in problem.resources]

    def chosen(*held: str, **amounts: int) -> list[str] | None:
        one = Entry("a", 0, 1, {**dict.fromkeys(held, 1), **amounts})
        _, found = choices_of(problem, problem.activities[0], one)
        return None if found is None else [names[r] for r in found if r is not None]

    assert chosen("r1", "r2") == ["r2", "r1"]
    assert chosen("r1", "r3") == ["r1", "r3"]
    assert chosen(r1=2) == ["r1", "r1"]
    assert chosen() is None
    for wrong in ({"r3": 2}, {"r2": 1}, {"r9": 1, "r1": 1}):
        with pytest.raises(UnexplainedError):
            chosen(**wrong)


def test_a_mode_decides_which_uses_there_are() -> None:
    modes = [
        {"id": "slow", "duration": 4},
        {"id": "fast", "duration": 2, "uses": [{"resource": "r2"}]},
    ]
    problem = lower(
        task_of({"id": "a", "modes": modes, "uses": [{"resource": "r1"}]}, resources=ROBOTS)
    )
    activity = problem.activities[0]
    assert [m.id for m in activity.details.modes] == ["fast", "slow"]
    assert choices_of(problem, activity, entry("a", 0, 4, "r1", mode="slow")) == (1, (0, None))
    assert choices_of(problem, activity, entry("a", 0, 2, "r1", "r2", mode="fast")) == (0, (0, 1))
    assert choices_of(problem, activity, entry("a", 0, 2, "r1")) == (None, None)
    with pytest.raises(UnexplainedError):
        choices_of(problem, activity, entry("a", 0, 2, "r1", mode="none such"))


# --- the frozen problem ---


def test_occurrences_that_have_begun_are_counted_and_the_others_follow() -> None:
    beat = task_of(action("beat", 2, "r1", occurs={"min": 3, "max": 4}), resources=ROBOTS)
    entries = [entry("beat", 2 * k, 2 * k + 2, "r1", occurrence=k + 1) for k in range(3)]
    frozen = frozen_at(beat, entries, 3)
    rest, first, second = frozen.problem.activities
    assert (rest.details.repeats, rest.details.occurrence, rest.details.previous_occurrence) == (
        (1, 2),
        3,
        2,
    )
    assert [(a.start, a.details.occurrence) for a in (first, second)] == [(0, 1), (2, 2)]
    assert second.details.previous_occurrence == 1
    assert {i: past.running for i, past in frozen.executed.items()} == {1: False, 2: True}


def test_a_running_range_can_end_from_now_on_and_a_completed_one_has_ended() -> None:
    ranges = task_of(action("a", {"min": 2, "max": 9}), action("b", {"min": 1, "max": 9}))
    frozen = frozen_at(ranges, [entry("a", 0, 3), entry("b", 0, 6)], 5)
    a, b = frozen.problem.activities
    assert (a.duration_min, a.duration_max) == (3, 3)
    assert (b.duration_min, b.duration_max) == (5, 9)


def order(group: str, *names: str) -> dict[str, object]:
    return {"id": group, "actions": list(names), "required": False, "reward": 1}


def test_half_done_groups_are_finished_unless_given_up() -> None:
    shared = task_of(
        *(action(n, 2) for n in "abc"), groups=[order("g", "a", "b"), order("h", "b", "c")]
    )
    frozen = frozen_at(shared, [entry("a", 0, 2), entry("b", 2, 4), entry("c", 4, 6)], 1)
    assert frozen.half_done() == (0,)
    whole = with_groups(frozen, ())
    assert [g.required for g in whole.groups] == [True, False]
    assert [a.details.optional for a in whole.activities] == [False, False, True]
    less = with_groups(frozen, (0,))
    assert [g.id for g in less.groups] == ["h"]
    assert less.activities[1].deadline is not None
    assert less.activities[1].deadline < 0


# --- rebased ---

LAGS: list[tuple[str, dict[str, int], bool, bool]] = [
    ("finish-start", {"min_lag": 3}, True, False),
    ("start-start", {"min_lag": 6}, False, False),
    ("finish-finish", {"min_lag": 4}, True, True),
    ("start-finish", {"min_lag": 9}, False, True),
]


def left(document: object, entries: list[Entry], at: int) -> ResidualProblem:
    frozen = frozen_at(document, entries, at)  # type: ignore[arg-type]
    return residual_problem(frozen.problem, frozen.executed, frozen.now)


@pytest.mark.parametrize(("kind", "lag", "from_end", "to_end"), LAGS)
def test_a_lag_to_what_has_ended_is_a_release_or_an_instant(
    kind: str, lag: dict[str, int], from_end: bool, to_end: bool
) -> None:
    """a ends at 4; now is 5."""
    arcs = [{"before": "a", "after": "b", "type": kind, **lag}]
    fixed = task_of(action("a", 4), action("b", 2), precedence=arcs)
    problem = left(fixed, [entry("a", 0, 4)], 5).problem
    assert problem.arcs == ()
    due = (4 if from_end else 0) + lag["min_lag"] - 5
    assert problem.activities[0].release == max(0, due - 2 if to_end else due)
    ranged = task_of(action("a", 4), action("b", {"min": 1, "max": 4}), precedence=arcs)
    problem = left(ranged, [entry("a", 0, 4)], 5).problem
    if to_end:
        assert problem.activities[1].id == "now"
        assert problem.arcs == (Arc(1, 0, False, True, due, None, -1),)
    else:
        assert problem.activities[0].release == max(0, due)


@pytest.mark.parametrize(("kind", "lag", "from_end", "to_end"), LAGS)
def test_a_lag_to_what_runs_counts_from_when_it_began_or_from_its_end(
    kind: str, lag: dict[str, int], from_end: bool, to_end: bool
) -> None:
    """a runs from 0 to 4 (to 3 at least); now is 3."""
    arcs = [{"before": "a", "after": "b", "type": kind, **lag}]
    ranged = task_of(action("a", {"min": 2, "max": 8}), action("b", 2), precedence=arcs)
    problem = left(ranged, [entry("a", 0, 4)], 3).problem
    assert (problem.activities[0].duration_min, problem.activities[0].duration_max) == (0, 5)
    if from_end:
        assert problem.arcs == (Arc(0, 1, True, to_end, lag["min_lag"], None, 0),)
    else:
        due = lag["min_lag"] - 3
        assert problem.activities[1].release == max(0, due - 2 if to_end else due)


def test_a_maximum_lag_to_the_past_is_a_deadline_and_a_negative_one_is_nothing() -> None:
    soon = task_of(
        action("a", 4),
        action("b", 2),
        action("c", 2),
        precedence=[
            {"before": "a", "after": "b", "max_lag": 3},
            {"before": "a", "after": "c", "min_lag": -9},
        ],
    )
    problem = left(soon, [entry("a", 0, 4)], 5).problem
    assert [(a.release, a.deadline) for a in problem.activities] == [(0, 4), (0, None)]
    step = repaired(soon, plan(entry("a", 0, 4), entry("b", 4, 6), entry("c", 6, 8)), 8)
    assert step.schedule.status == "optimal"
    with pytest.raises(PastError, match="fixed start"):
        left(task_of(action("b", 2, start=1)), [], 5)


def test_a_latest_start_comes_nearer_and_ends_what_may_be_left_out() -> None:
    soon = task_of(
        action("a", 4, latest_start=0),
        action("b", 2, latest_start=7),
        action("c", 2, latest_start=3, occurs="optional"),
    )
    begun, later, never = left(soon, [entry("a", 0, 9)], 5).problem.activities
    assert begun.latest_start is None
    assert (later.latest_start, later.deadline) == (2, None)
    assert never.deadline == IMPOSSIBLE_DEADLINE
    with pytest.raises(PastError, match="latest start"):
        left(task_of(action("b", 2, latest_start=1)), [], 5)


def test_the_past_is_in_the_initial_stock_state_and_calendars() -> None:
    baking = task_of(
        action("mill", 2, produces=[{"resource": "flour", "amount": 3}]),
        action(
            "bake",
            6,
            "oven",
            consumes=[{"resource": "flour", "amount": 1}],
            produces=[{"resource": "flour", "amount": 1, "at": "end"}],
            effects=[
                {"at": "start", "var": "hot", "value": True},
                {"at": "end", "var": "hot", "value": False},
            ],
        ),
        resources=[
            {"id": "flour", "kind": "reservoir"},
            {"id": "oven", "availability": [{"from": 1, "to": 12, "capacity": 2}]},
        ],
        state=[{"id": "hot"}],
    )
    problem = left(baking, [entry("mill", 0, 2), entry("bake", 3, 9, "oven")], 5).problem
    assert problem.reservoirs[0].initial == 2
    assert problem.variables[0].values[problem.variables[0].initial] is True
    (bake,) = problem.activities
    assert (bake.start, bake.duration_min, len(bake.details.stock)) == (0, 4, 1)
    assert [(e.var, e.at_end) for e in bake.details.effects] == [(0, True)]
    oven = next(r for r in problem.resources if r.id == "oven")
    assert [(w.start, w.end, w.capacity) for w in oven.windows] == [(0, 7, 2)]


@pytest.mark.slow
def test_what_ended_at_an_instant_comes_before_what_an_event_changes_then() -> None:
    """`lit` ends at 2 and lights the lamp, then it is put out: nobody lights it for `read`."""
    lamp = task_of(
        action("lit", 2, effects=[{"at": "end", "var": "light", "value": True}]),
        action("read", 1, conditions=[{"at": "all", "var": "light", "value": True}]),
        action("light again", 3, effects=[{"at": "end", "var": "light", "value": True}]),
        state=[{"id": "light", "initial": False}],
    )
    old = plan(entry("lit", 0, 2), entry("read", 2, 3, rank=1), entry("light again", 2, 5))
    out = {"op": "set_state", "var": "light", "value": False}
    for target in ("cpsat", "pddl21"):
        step = repaired(lamp, old, 2, out, target=target, time_limit=3)
        assert starts(step.schedule) == {"lit": 0, "light at 2": 2, "light again": 2, "read": 5}
        assert next(e for e in step.schedule.entries if e.id == "light at 2").rank == 1


def test_a_range_that_took_no_time_still_had_a_start_and_an_end() -> None:
    flash = task_of(
        action(
            "flash",
            {"min": 0, "max": 1},
            effects=[
                {"at": "start", "var": "light", "value": True},
                {"at": "end", "var": "light", "value": False},
            ],
        ),
        action("look", 2, conditions=[{"at": "start", "var": "light", "value": False}]),
        state=[{"id": "light", "initial": False}],
    )
    old = plan(entry("flash", 0, 0, end_rank=1), entry("look", 0, 2, rank=2))
    assert repaired(flash, old, 1).schedule.status == "optimal"
