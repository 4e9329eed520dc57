"""Set-ups in PDDL2.1 text, and what a planner makes of them."""

from __future__ import annotations

from typing import Any

import pytest

import irc
from builders import Document, lettered, task_of
from irc.diagnostics import InputError
from irc.driver.compile import compile_task
from irc.schedule import Schedule
from irc.validation import validate
from irc_pddl21.encoding import setups
from irc_pddl21.encoding.encode import encode
from irc_pddl21.encoding.grounded import Grounded

ROWS = [{"from": "red", "to": "blue", "time": 4}, {"from": "blue", "to": "red", "time": 1}]


def press(**more: Any) -> list[Document]:
    return [{"id": "press", "setups": {"times": ROWS, **more}}]


def prints(family: str, duration: object = 2, **more: Any) -> Document:
    return {
        "duration": duration,
        "uses": [{"resource": "press", "family": family}],
        **more,
    }


def grounded(*actions: Document, resources: list[Document], **more: Any) -> Grounded:
    task = task_of(*lettered(*actions), resources=resources, **more)
    return encode(compile_task(task, "pddl21").problem)


def planned(*actions: Document, resources: list[Document], **more: Any) -> Schedule:
    pytest.importorskip("kairos")
    task = task_of(*lettered(*actions), resources=resources, **more)
    schedule = irc.solve(task, "pddl21", engine="kairos", time_limit=5, shortcut=False)
    assert validate(task, schedule).valid
    return schedule


def test_a_set_up_leads_from_one_family_to_another_and_takes_the_unit() -> None:
    found = grounded(prints("red"), prints("blue"), resources=press())
    by_name = {o.name: o for o in found.encoding.operators}
    wash = by_name["setup_press_red_press_blue"]
    assert wash.name in found.planner_only
    assert wash.duration == (4 * found.scale, 4 * found.scale)
    assert {"used_press_red", "free_press_1"} <= set(wash.at_start)
    assert wash.end_adds == ["ready_press_blue", "free_press_1"]
    assert {"ready_press_red", "ready_press_blue"} <= set(by_name["a"].start_deletes)
    assert "ready_press_red" in by_name["a"].end_adds
    assert "ready_press_blue" not in by_name["a"].end_adds


@pytest.mark.parametrize(("initial", "end"), [("red", 9), ("blue", 10), ("green", 9)])
def test_the_first_use_needs_its_set_up_from_the_initial_family(initial: str, end: int) -> None:
    rows = [*ROWS, {"from": "green", "to": "blue", "time": 9}, {"from": "green", "to": "red"}]
    resources: list[Document] = [{"id": "press", "setups": {"times": rows, "initial": initial}}]
    actions = [prints("red"), prints("blue", 3, release=2)]
    schedule = planned(*actions, resources=resources, precedence=[["a", "b"]])
    assert schedule.makespan == end


def test_a_set_up_goes_on_while_the_resource_is_away() -> None:
    (resource,) = press()
    resource |= {"availability": [{"from": 2, "to": 6, "capacity": 0}]}
    schedule = planned(prints("red"), prints("blue"), resources=[resource], precedence=[["a", "b"]])
    assert schedule["b"].start == 6


def test_a_detour_over_a_third_family_is_no_set_up() -> None:
    rows = [
        {"from": "red", "to": "green", "time": 1},
        {"from": "green", "to": "blue", "time": 1},
        {"from": "red", "to": "blue", "time": 9},
    ]
    resources: list[Document] = [{"id": "press", "setups": {"times": rows}}]
    actions = [prints("red"), prints("blue"), prints("green", release=30)]
    schedule = planned(*actions, resources=resources, precedence=[["a", "b"]])
    assert schedule["b"].start == 11


def test_what_may_last_no_time_has_a_way_without_set_ups() -> None:
    found = grounded(
        prints("red"), prints("blue", {"min": 0, "max": 3}), prints("red"), resources=press()
    )
    once, longer = sorted(
        (o for o in found.encoding.operators if o.name.startswith("b__")),
        key=lambda o: o.duration is not None,
    )
    assert not any(fact.startswith("ready_") for fact in once.at_start)
    assert longer.duration is not None
    assert longer.duration[0] == found.scale


def test_too_many_set_ups_are_refused_at_their_place(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(setups, "MOST_SETUPS", 1)
    with pytest.raises(InputError) as refused:
        grounded(prints("red"), prints("blue"), resources=press())
    (error,) = refused.value.report.errors
    assert error.pointer == ("resources", 0, "setups")
