"""Running work that a broken resource ends, and what begins at the very instant of an event."""

from __future__ import annotations

import pytest

import irc

_DOCUMENT = {
    "name": "shifts",
    "origin": "2026-01-05T00:00",
    "time_unit": "h",
    "calendars": [{"id": "day", "open": [{"from": "08:00", "to": "16:00"}]}],
    "resources": [{"id": "mill", "calendar": "day"}, {"id": "desk"}],
    "actions": [
        {"id": "part", "duration": 12, "breaks": "pause", "uses": [{"resource": "mill"}]},
        {"id": "letter", "duration": 3, "uses": [{"resource": "desk"}]},
    ],
}
_BROKEN = {"op": "set_capacity", "resource": "mill", "capacity": 0}
_MENDED = {"op": "set_capacity", "resource": "mill", "capacity": 1, "from": 30}


def _task(**more: object) -> dict[str, object]:
    first, second = _DOCUMENT["actions"]
    return {**_DOCUMENT, "actions": [{**first, **more}, second]}


def _places(step: irc.Step) -> dict[str, tuple[irc.Number, irc.Number]]:
    return {e.id: (e.start, e.end) for e in step.schedule}


# At 10 h two hours are done; at 20 h, in the night, a whole shift of eight is.
@pytest.mark.parametrize(
    ("at", "more", "end"),
    [
        (10, {}, 58),  # 10 h are left: 32 to 40, and 56 to 58.
        (20, {}, 36),  # 4 h are left.
        (20, {"on_failure": "resume"}, 36),
        (20, {"on_failure": "restart"}, 60),  # 12 h: 32 to 40, and 56 to 60.
    ],
)
def test_what_is_left_counts_work_without_pauses(at, more, end):
    task = _task(**more)
    plan = irc.solve(task)
    broken = irc.replan(task, plan, at, [{"changes": [_BROKEN]}])
    assert broken.schedule.answered
    assert _places(broken)["part"] == (8, at)
    assert any("'part (2)' needs 1 of 'mill'" in note.message for note in broken.notes)
    mended = irc.replan(task, plan, at, [{"changes": [_BROKEN, _MENDED]}])
    assert _places(mended)["part (2)"] == (32, end)


def test_an_event_may_be_a_document_and_its_fault_has_a_place():
    task = _task()
    plan = irc.solve(task)
    step = irc.replan(task, plan, "10 h", [{"changes": [{**_BROKEN, "resource": "desk"}]}])
    assert step.schedule.answered
    with pytest.raises(irc.InputError) as caught:
        irc.replan(task, plan, 10, [{"changes": [{"op": "set_capacity", "resource": "mil"}]}])
    assert "/0/changes/0" in str(caught.value)


def test_what_repeats_and_was_seen_to_begin_now_is_history_at_once():
    """It began before its release; the task cannot fix the start of one of several occurrences."""
    task = {
        "actions": [{"id": "stir", "duration": 2, "release": 1, "occurs": {"min": 1, "max": 2}}]
    }
    execution = irc.Execution(irc.Task.from_dict(task), irc.solve(task))
    execution.observe("stir", started=0)
    step = execution.replan()
    assert [(e.id, e.start, e.status) for e in step.schedule] == [("stir", 0, "begun")]
    verdict = irc.validate(step.task, step.schedule, at=0)
    assert verdict.valid
    assert [v.rule for v in verdict.carried] == ["release"]
    assert not irc.validate(step.task, step.schedule).valid
    execution.advance(1)
    assert [e.status for e in execution.replan().schedule] == [None]
