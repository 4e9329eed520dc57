"""Rule 6.4: levels of number variables, with ranks that a schedule gives and without."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from builders import Document, act, task_of
from irc.schedule import Entry, Schedule
from irc.validation import validate

TANK: Document = {"id": "tank", "kind": "number", "initial": 1, "min": 0, "max": 3}


def change(at: str, amount: Any) -> Document:
    return {"at": at, "var": "tank", "add": amount}


def asked(at: str, **limits: Any) -> Document:
    return {"at": at, "var": "tank", **limits}


def rules(actions: list[Document], *entries: Entry, goals: Any = ()) -> list[str]:
    task = task_of(*actions, state=[TANK], goals=list(goals))
    return [v.rule for v in validate(task, Schedule(entries)).violations]


FILL = act("fill", 2, effects=[change("end", 2)])
USE = act("use", 3, effects=[change("start", -3)])


def test_a_level_is_kept_after_each_happening() -> None:
    assert rules([FILL, USE], Entry("fill", 0, 2), Entry("use", 2, 5)) == []
    assert rules([FILL, USE], Entry("fill", 0, 2), Entry("use", 2, 5, rank=1)) == []
    assert rules([FILL, USE], Entry("fill", 0, 2), Entry("use", 1, 4)) == ["bounds"]
    assert rules([FILL, USE], Entry("fill", 0, 2, rank=1), Entry("use", 2, 5)) == ["bounds"]


def test_two_changes_of_one_number_never_share_a_rank() -> None:
    entries = Entry("fill", 0, 2, rank=1), Entry("use", 2, 5, rank=1)
    assert "interference" in rules([FILL, USE], *entries)


def test_an_order_of_many_changes_at_one_instant_is_found() -> None:
    actions = [act(f"up {i}", 1, effects=[change("end", 2)]) for i in range(3)]
    actions += [act(f"down {i}", 1, effects=[change("start", -2)]) for i in range(3)]
    entries = [Entry(f"up {i}", 0, 1) for i in range(3)]
    entries += [Entry(f"down {i}", 1, 2) for i in range(3)]
    assert rules(actions, *entries) == []
    assert rules(actions[1:], *entries[1:]) == ["rank"]


@pytest.mark.parametrize(
    ("limits", "fine"),
    [
        ({"at_least": 1}, True),
        ({"at_least": "4/3"}, False),
        ({"at_most": 1}, True),
        ({"at_most": 0.5}, False),
        ({"equals": 1}, True),
        ({"equals": 2}, False),
        ({"at_least": 0, "at_most": 2}, True),
    ],
)
@pytest.mark.parametrize("at", ["start", "all", "end"])
def test_a_condition_gives_limits(at: str, limits: Document, fine: bool) -> None:
    look = act("look", 4, conditions=[asked(at, **limits)])
    assert (rules([look], Entry("look", 0, 4)) == []) is fine


def test_what_holds_throughout_is_broken_in_the_middle_and_not_at_the_ends() -> None:
    look = act("look", 4, conditions=[asked("all", at_most=1)])
    fill = act("fill", 2, effects=[change("end", 2)])
    assert rules([look, fill], Entry("look", 0, 4), Entry("fill", 0, 2)) == ["state"]
    assert rules([look, fill], Entry("look", 0, 4), Entry("fill", 2, 4)) == []


def test_what_one_happening_adds_counts_together() -> None:
    swap = act("swap", 0, effects=[change("start", -3), change("end", 3)])
    assert rules([swap], Entry("swap", 1, 1)) == []
    apart = act("swap", {"min": 0, "max": 2}, effects=[change("start", -3), change("end", 3)])
    assert rules([apart], Entry("swap", 1, 1)) == []
    assert rules([apart], Entry("swap", 1, 2)) == ["bounds"]


def test_goals_look_at_the_last_level() -> None:
    goals = [{"var": "tank", "at_least": 3}]
    assert rules([FILL], Entry("fill", 0, 2), goals=goals) == []
    assert rules([act("fill", 2)], Entry("fill", 0, 2), goals=goals) == ["goal"]


def test_levels_are_exact() -> None:
    tenth = act("drip", 1, occurs={"max": 20}, effects=[change("end", Fraction(1, 10))])
    entries = [Entry("drip", i, i + 1, occurrence=i + 1) for i in range(20)]
    assert rules([tenth], *entries, goals=[{"var": "tank", "equals": 3}]) == []


def test_a_history_that_left_the_bounds_is_carried_and_not_made_worse() -> None:
    sip = act("sip", 1, occurs="optional", effects=[change("start", -1)])
    task = task_of(USE, sip, FILL, state=[TANK])
    past = Entry("use", 0, 3)
    kept = validate(task, Schedule((past, Entry("fill", 4, 6))), at=4)
    assert [v.rule for v in kept.violations] == []
    assert [v.rule for v in kept.carried] == ["bounds"]
    worse = validate(task, Schedule((past, Entry("sip", 5, 6), Entry("fill", 4, 6))), at=4)
    assert [v.rule for v in worse.violations] == ["bounds"]
