"""How many occurrences of a repeated action a CP-SAT model holds."""

from __future__ import annotations

import irc
from irc.driver.compile import compile_task
from irc.problem import Problem
from irc.schedule import Status
from irc_cpsat.solving.depth import depths, enough, within

LAPS = {
    "state": [{"id": "done", "values": ["0", "1", "2", "3"], "initial": "0"}],
    "actions": [
        {
            "id": f"lap {k}",
            "duration": k,
            "occurs": {"min": 0},
            "conditions": [{"at": "start", "var": "done", "value": str(k - 1)}],
            "effects": [{"at": "end", "var": "done", "value": str(k)}],
        }
        for k in (1, 2, 3)
    ],
    "goals": [{"var": "done", "value": "3"}],
}


def problem(**fields: object) -> Problem:
    return compile_task(irc.Task.from_dict({**LAPS, **fields}).ir, "cpsat").problem


def greatest(of: Problem) -> list[int | None]:
    return [a.details.repeats[1] for a in of.activities if a.details.repeats]


def test_one_occurrence_is_tried_first() -> None:
    assert next(depths(problem())) == 1


def test_a_known_schedule_caps_each_action_by_its_own_duration() -> None:
    capped = within(problem(), 6)
    assert (capped.deadline, sorted(g for g in greatest(capped) if g)) == (6, [2, 3, 6])
    assert enough(capped, capped.deadline) == 6


def test_an_earlier_deadline_of_the_task_is_kept() -> None:
    assert within(problem(deadline=4), 6).deadline == 4


def test_without_a_limit_no_number_of_occurrences_is_enough() -> None:
    assert enough(problem(), None) is None


def test_a_schedule_of_one_occurrence_each_is_proven_among_all_numbers() -> None:
    schedule = irc.solve(irc.Task.from_dict(LAPS), "cpsat", shortcut=False, time_limit=60)
    assert (schedule.status, schedule.makespan) == (Status.OPTIMAL, 6)


def test_what_needs_two_occurrences_gets_them() -> None:
    press = {
        "id": "press",
        "duration": 2,
        "occurs": {"min": 0},
        "produces": [{"resource": "juice"}],
    }
    drink = {"id": "drink", "duration": 1, "consumes": [{"resource": "juice", "amount": 2}]}
    task = irc.Task.from_dict(
        {"resources": [{"id": "juice", "kind": "reservoir"}], "actions": [press, drink]}
    ).ir
    schedule = irc.solve(task, "cpsat", shortcut=False, time_limit=60)
    assert (schedule.status, schedule.makespan) == (Status.OPTIMAL, 5)
