"""Repeated actions become an activity for each occurrence."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from builders import problem_of
from irc.passes import run_passes
from irc.passes.unroll import slots, unroll
from irc.problem import Bounds


def chop(least: int, most: int | None, **fields: Any) -> dict[str, Any]:
    occurs = {"min": least} if most is None else {"min": least, "max": most}
    return {"id": "chop", "duration": 2, "occurs": occurs, **fields}


EAT = {"id": "eat", "duration": 3}


@pytest.mark.parametrize(
    ("least", "most", "depth", "expected"),
    [(0, None, 4, 4), (0, 3, 4, 3), (5, None, 2, 5), (0, 9, 0, 1), (2, 3, 2, 2)],
)
def test_an_action_has_as_many_occurrences_as_depth_and_bounds_say(
    least: int, most: int | None, depth: int, expected: int
) -> None:
    problem = problem_of(chop(least, most))
    assert slots(problem.activities[0], depth) == expected
    assert len(unroll(problem, depth).activities) == expected


def test_first_occurrences_keep_their_place_and_each_knows_the_one_before() -> None:
    problem = unroll(problem_of(chop(2, None), EAT), 4)
    assert [a.id for a in problem.activities] == ["chop", "eat", "chop", "chop", "chop"]
    details = [problem.activities[i].details for i in (0, 2, 3, 4)]
    assert [d.occurrence for d in details] == [1, 2, 3, 4]
    assert [d.previous_occurrence for d in details] == [None, 0, 2, 3]
    assert [d.optional for d in details] == [False, False, True, True]
    assert all(d.repeats is None for d in details)


def test_a_problem_without_repeats_stays_itself() -> None:
    problem = problem_of(EAT)
    assert unroll(problem, 4) is problem


def test_later_occurrences_start_after_those_before_and_leave_room_for_those_after() -> None:
    problem = unroll(run_passes(problem_of(chop(3, 4, release=5))), 4)
    assert problem.bounds.heads == (5, 7, 9, 11)
    assert problem.bounds.tails == (4, 2, 0, 0)


def test_what_was_settled_for_an_action_holds_for_each_occurrence() -> None:
    uses = [{"resource": "knife"}]
    problem = run_passes(problem_of(chop(0, 3, uses=uses), EAT, resources=[{"id": "knife"}]))
    assert problem.contention.fixed_choices == {(0, 0): 0}
    assert unroll(problem, 3).contention.fixed_choices == {(0, 0): 0, (2, 0): 0, (3, 0): 0}


def test_without_heads_there_are_none_after_either() -> None:
    problem = replace(problem_of(chop(0, 3)), bounds=Bounds())
    assert (unroll(problem, 3).bounds.heads, unroll(problem, 3).bounds.tails) == ((), ())
