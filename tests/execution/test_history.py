"""What has happened by a time, and what events and observations make of a plan."""

from __future__ import annotations

from fractions import Fraction

import pytest

from builders import task_of
from irc.diagnostics import Code, Findings
from irc.execution import state_at
from irc.execution.follow import follow
from irc.execution.history import History
from irc.execution.presumed import as_of
from irc.model import Task
from irc.model.quantities import exact
from irc.schedule import Entry
from online_cases import action, entry, event, plan, repaired, starts

PLAN = plan(entry("a", 0, 4), entry("b", 4, 8), entry("z", 2, 2))
TASK = task_of(
    action("a", 4),
    action("b", {"min": 2, "max": 6}),
    action("z", 0),
    groups=[
        {"id": "g", "actions": ["a", "b"], "required": False},
        {"id": "h", "actions": ["b"], "required": False},
    ],
)


def taken(at: object, *changes: dict[str, object], whole: Task = TASK) -> History:
    """The history after one event, which must not contradict it."""
    history, findings = History.of(PLAN), Findings()
    follow(history, whole, event(at, *changes), findings)
    assert findings.items == []
    return as_of(history, whole, exact(Fraction(str(at))))


def faults(
    at: object, *changes: dict[str, object], history: History | None = None
) -> list[tuple[Code, str]]:
    findings = Findings()
    follow(history or History.of(PLAN), TASK, event(at, *changes), findings)
    return [(d.code, "/".join(map(str, d.pointer))) for d in findings.items]


def times(history: History, name: str, number: int = 1) -> tuple[object, object, object]:
    found = history.entries[name, number]
    return found.start, found.end, found.status


def names(entries: tuple[Entry, ...]) -> list[str]:
    return [e.id for e in entries]


# --- state_at ---


def test_what_starts_or_ends_just_now_is_open_or_completed() -> None:
    state = state_at(PLAN, 4)
    assert (names(state.completed), names(state.running), names(state.open)) == (
        ["a", "z"],
        [],
        ["b"],
    )


def test_an_observed_start_just_now_has_begun() -> None:
    state = state_at(PLAN, 4, {("b", 1)})
    assert names(state.running) == ["b"]
    assert names(state_at(PLAN, 2, {("z", 1)}).completed) == ["z"]
    assert names(state_at(PLAN, 2).open) == ["b", "z"]


# --- observations ---


def test_an_early_end_is_the_end_and_a_late_start_shifts_it() -> None:
    seen = {"op": "observe", "action": "a"}
    assert times(taken(3, {**seen, "finished": 3}), "a") == (0, 3, None)
    assert times(taken(3, {**seen, "started": 1}), "a") == (1, 5, None)
    exact = taken("7/2", {**seen, "started": "1/3", "finished": "7/2"})
    assert times(exact, "a") == (Fraction(1, 3), Fraction(7, 2), None)


def test_an_observed_range_keeps_the_length_that_was_planned() -> None:
    assert times(taken(5, {"op": "observe", "action": "b", "started": 3}), "b") == (3, 7, None)


def test_two_observations_of_one_event_must_not_contradict_each_other() -> None:
    seen = {"op": "observe", "action": "a"}
    twice = ({**seen, "started": 1}, {**seen, "started": 2})
    assert faults(3, *twice) == [(Code.OBSERVED, "changes/1/started")]
    assert faults(3, {**seen, "started": 1}, {**seen, "started": 1, "finished": 3}) == []


def test_an_action_that_the_same_event_adds_can_be_observed() -> None:
    one = task_of(action("a", 5))
    new = {"op": "add_actions", "actions": [action("x", 4)]}
    step = repaired(
        one, plan(entry("a", 0, 5)), 3, new, {"op": "observe", "action": "x", "started": 2}
    )
    assert starts(step.schedule) == {"a": 0, "x": 2}
    assert set(step.running) == {"a", "x"}


def test_what_is_observed_takes_as_long_as_the_same_event_says() -> None:
    two = task_of(action("a", 5), action("b", 1), precedence=[["a", "b"]])
    step = repaired(
        two,
        plan(entry("a", 0, 5), entry("b", 5, 6)),
        3,
        {"op": "set_duration", "action": "a", "duration": 9},
        {"op": "observe", "action": "a", "started": 1},
    )
    assert starts(step.schedule) == {"a": 1, "b": 10}


# --- cancellations ---


def test_a_cancellation_ends_what_runs_and_removes_what_is_open() -> None:
    history = taken(2, {"op": "cancel_actions", "actions": ["a", "b"]})
    assert times(history, "a") == (0, 2, "cancelled")
    assert ("b", 1) not in history.entries
    assert history.cancelled == {"a": 2, "b": 2}


def test_what_is_done_cannot_be_cancelled() -> None:
    cancel = {"op": "cancel_actions", "actions": ["b", "a"]}
    assert faults(5, cancel) == [(Code.ALREADY_DONE, "changes/0/actions/1")]
    assert faults(9, {"op": "cancel_groups", "groups": ["g"]}) == [
        (Code.ALREADY_DONE, "changes/0/groups/0")
    ]


def test_what_another_group_has_goes_on_when_a_group_is_cancelled() -> None:
    history = taken(2, {"op": "cancel_groups", "groups": ["g"]})
    assert times(history, "a") == (0, 2, "cancelled")
    assert times(history, "b") == (4, 8, None)
    both = taken(2, {"op": "cancel_groups", "groups": ["g", "h"]})
    assert ("b", 1) not in both.entries


def test_a_group_of_the_same_event_keeps_its_actions() -> None:
    new = {"op": "add_groups", "groups": [{"id": "n", "actions": ["a"]}]}
    history = taken(2, new, {"op": "cancel_groups", "groups": ["g"]})
    assert times(history, "a") == (0, 4, None)


# --- durations ---


@pytest.mark.parametrize(("duration", "end"), [(2, 2), (3, 3), (9, 9), ({"min": 1, "max": 3}, 3)])
def test_a_new_duration_moves_the_end_of_what_runs(duration: object, end: int) -> None:
    history = taken(2, {"op": "set_duration", "action": "a", "duration": duration})
    assert times(history, "a") == (0, end, None)


def test_a_duration_that_would_have_passed_is_refused() -> None:
    change = {"op": "set_duration", "action": "a", "duration": 1}
    assert faults(2, change) == [(Code.EVENT_TIME, "changes/0/duration")]
    assert faults(4, change) == [(Code.ALREADY_DONE, "changes/0/action")]


def test_changes_of_one_event_come_in_their_order() -> None:
    longer = {"op": "set_duration", "action": "a", "duration": 6}
    history = taken(3, longer, {"op": "observe", "action": "a", "finished": 3})
    assert times(history, "a") == (0, 3, None)
