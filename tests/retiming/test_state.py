"""Re-timing with state: the order of what happens is kept, down to the order within an instant."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest

from builders import at, state_action
from irc.lowering.lower import lower
from irc.model import Task
from irc.passes import run_passes
from irc.problem import Problem
from irc.problem.decisions import AnswerError, Decision, Placed
from irc.retiming.retime import earliest_schedule, retime
from irc.retiming.state import state_orders
from irc.retiming.to_schedule import schedule_of
from irc.validation import validate

EPSILON = Fraction(1, 1000)


def task_of(*actions: dict[str, Any], **fields: Any) -> Task:
    names = {
        part["var"] for a in actions for part in (*a.get("conditions", ()), *a.get("effects", ()))
    }
    state = [{"id": name, "initial": False} for name in sorted(names)]
    # The deadline is far and prime, so that a tick is 1 s.
    document = {"actions": list(actions), "state": state, "deadline": 997, **fields}
    return Task.model_validate(document)


def retimed(
    task: Task, tolerance: Fraction | int = 0, **decisions: Decision
) -> dict[str, tuple[int, int, int, int]]:
    """(start, end, rank, end rank) of each action, once the validator has agreed."""
    problem = lower(task)
    placed = retime(problem, [decisions[a.id] for a in problem.activities], tolerance)
    verdict = validate(task, schedule_of(problem, placed))
    assert verdict.valid, verdict.violations
    return {
        a.id: (p.start, p.end, p.rank, p.end_rank)
        for a, p in zip(problem.activities, placed, strict=True)
    }


def at_rank(start: int, end: int, rank: int, end_rank: int | None = None) -> Decision:
    return Decision(start, end, rank=rank, end_rank=rank if end_rank is None else end_rank)


MATCH = state_action("match", 8, (), (at("start", "light"), at("end", "light", False)))
REPAIR = state_action(
    "repair", 5, (at("start", "light"), at("all", "light")), (at("end", "fixed"),)
)


def test_a_repair_follows_the_match_at_the_same_time_one_rank_later() -> None:
    task = task_of(MATCH, REPAIR)
    found = retimed(task, match=Decision(5, 13), repair=Decision(7, 12))
    assert found == {"match": (0, 8, 0, 0), "repair": (0, 5, 1, 1)}


def test_a_match_lit_at_5_lights_a_shorter_repair_at_5() -> None:
    task = task_of({**MATCH, "release": 5}, REPAIR)
    found = retimed(task, match=Decision(5, 13), repair=at_rank(5, 10, 1))
    assert found == {"match": (5, 13, 0, 0), "repair": (5, 10, 1, 1)}


def test_a_repair_as_long_as_the_match_cannot_be_lit_by_it() -> None:
    task = task_of(MATCH, {**REPAIR, "duration": 8})
    with pytest.raises(AnswerError):
        retimed(task, match=Decision(0, 8), repair=Decision(EPSILON, 8 + EPSILON))


def test_what_holds_throughout_may_end_with_the_hold_that_gives_it() -> None:
    """`all` demands nothing at the two ends themselves."""
    repair = state_action("repair", 8, (at("all", "light"),))
    task = task_of({**MATCH, "release": 1}, repair)
    found = retimed(task, match=Decision(3, 11), repair=Decision(3, 11))
    assert found == {"match": (1, 9, 0, 0), "repair": (1, 9, 0, 0)}


def test_the_result_of_an_end_is_taken_at_that_instant() -> None:
    task = task_of(
        state_action("boil", 3, (), (at("end", "boiled"),)),
        state_action("mash", 2, (at("start", "boiled"),), (at("end", "mashed"),)),
        state_action("serve", 1, (at("start", "mashed"),)),
    )
    found = retimed(task, boil=Decision(1, 4), mash=Decision(9, 11), serve=Decision(12, 13))
    assert found == {"boil": (0, 3, 0, 0), "mash": (3, 5, 1, 1), "serve": (5, 6, 2, 2)}


def test_a_planners_epsilons_become_ranks() -> None:
    task = task_of(
        state_action("boil", 3, (), (at("end", "boiled"),)),
        state_action("mash", 2, (at("start", "boiled"),), (at("end", "mashed"),)),
    )
    found = retimed(
        task,
        Fraction(3, 2000),
        boil=Decision(Fraction(0), Fraction(3)),
        mash=Decision(3 + EPSILON, 5 + EPSILON),
    )
    assert found == {"boil": (0, 3, 0, 0), "mash": (3, 5, 1, 1)}


def test_a_value_that_rounding_has_made_late_counts_as_given_in_time() -> None:
    task = task_of(
        state_action("boil", 3, (), (at("end", "boiled"),)),
        state_action("mash", 2, (at("start", "boiled"),)),
    )
    late = {"boil": Decision(Fraction(0), 3 + EPSILON), "mash": Decision(Fraction(3), Fraction(5))}
    assert retimed(task, Fraction(3, 2000), **late)["mash"] == (3, 5, 1, 1)
    with pytest.raises(AnswerError, match="'mash' needs a value of 'boiled'"):
        retimed(task, 0, **late)


def test_two_readers_swap_freely() -> None:
    """Reading is no conflict: which of two readers came first does not matter."""
    light = state_action("light", 1, (), (at("end", "on"),))
    task = task_of(
        light,
        state_action("see", 2, (at("start", "on"),), release=4),
        state_action("look", 2, (at("start", "on"),)),
    )
    found = retimed(task, light=Decision(0, 1), see=Decision(4, 6), look=Decision(7, 9))
    assert (found["look"], found["see"]) == ((1, 3, 1, 1), (4, 6, 0, 0))


def test_a_change_stays_behind_those_who_read_what_it_changes() -> None:
    task = task_of(
        state_action("on", 0, (), (at("start", "light"),)),
        state_action("see", 2, (at("start", "light"),), release=3),
        state_action("off", 0, (), (at("start", "light", False),)),
    )
    found = retimed(task, on=Decision(0, 0), see=Decision(5, 7), off=Decision(9, 9))
    assert found == {"on": (0, 0, 0, 0), "see": (3, 5, 0, 0), "off": (3, 3, 1, 1)}


def test_the_same_value_may_be_given_again_inside_a_hold() -> None:
    task = task_of(
        state_action("on", 0, (), (at("start", "light"),)),
        state_action("again", 0, (), (at("start", "light"),), release=1),
        state_action("read", 6, (at("all", "light"),)),
        state_action("off", 0, (), (at("start", "light", False),)),
    )
    found = retimed(
        task,
        on=Decision(0, 0),
        again=Decision(4, 4),
        read=Decision(3, 9),
        off=Decision(9, 9),
    )
    assert found == {
        "on": (0, 0, 0, 0),
        "again": (1, 1, 0, 0),
        "read": (0, 6, 0, 0),
        "off": (6, 6, 0, 0),
    }


def test_the_last_value_stays_the_last() -> None:
    task = task_of(
        state_action("dirty", 1, (), (at("end", "clean", False),), release=4),
        state_action("wash", 1, (), (at("end", "clean"),)),
        goals=[{"var": "clean", "value": True}],
    )
    found = retimed(task, dirty=Decision(5, 6), wash=Decision(7, 8))
    assert found == {"dirty": (4, 5, 0, 0), "wash": (4, 5, 1, 1)}


def cover(length: int) -> Task:
    """`lamp` strictly contains `first` and then `second`, which take 2 each."""
    return task_of(
        state_action("lamp", length, (), (at("start", "light"), at("end", "light", False))),
        state_action("first", 2, (at("start", "light"),), (at("end", "ready"),)),
        state_action("second", 2, (at("start", "ready"), at("end", "light"))),
    )


def test_what_is_strictly_inside_needs_a_tick_more_than_its_parts() -> None:
    found = retimed(cover(5), lamp=Decision(3, 8), first=at_rank(3, 5, 1), second=at_rank(5, 7, 2))
    assert found == {"lamp": (0, 5, 0, 0), "first": (0, 2, 1, 1), "second": (2, 4, 2, 2)}


def test_no_ranks_fit_strictly_into_exactly_as_much_time() -> None:
    late = 2 * EPSILON
    with pytest.raises(AnswerError, match="in a circle at one instant"):
        retimed(
            cover(4),
            Fraction(1, 100),
            lamp=Decision(Fraction(0), 4 + 3 * EPSILON),
            first=Decision(EPSILON, 2 + EPSILON),
            second=Decision(2 + late, 4 + late),
        )


def test_a_duration_that_shrinks_to_nothing_stays_two_happenings() -> None:
    blink = state_action(
        "blink",
        {"min": 0, "max": 9},
        (at("all", "light"),),
        (at("start", "light"), at("end", "light", False)),
    )
    found = retimed(task_of(blink), blink=Decision(2, 6))
    assert found == {"blink": (0, 0, 0, 1)}


def test_an_action_of_one_happening_stays_one() -> None:
    """Were its end a rank later than its start, its own effect would spoil its condition."""
    turn = state_action(
        "turn",
        {"min": 0, "max": 9},
        (at("end", "light", False),),
        (at("start", "light"),),
    )
    task = task_of(
        state_action("boil", 3, (), (at("end", "boiled"),)),
        state_action("wait", 2, (at("start", "boiled"),)),
        turn,
        precedence=[{"before": "wait", "after": "turn", "type": "start-finish"}],
    )
    found = retimed(task, boil=Decision(0, 3), wait=Decision(4, 6), turn=Decision(5, 5))
    assert found["turn"] == (3, 3, 1, 1)


def test_a_range_lasts_until_what_it_needs_at_its_end_is_there() -> None:
    task = task_of(
        state_action("bake", 4, (), (at("end", "baked"),)),
        state_action("wait", {"min": 1, "max": 9}, (at("end", "baked"),)),
    )
    found = retimed(task, bake=Decision(3, 7), wait=Decision(2, 9))
    assert found == {"bake": (0, 4, 0, 0), "wait": (0, 4, 0, 1)}


def test_ranks_grow_along_precedence_without_a_moment_to_spare() -> None:
    task = task_of(
        state_action("boil", 3, (), (at("end", "boiled"),)),
        state_action("mash", 2, (at("start", "boiled"),)),
        state_action("serve", 1),
        precedence=[{"before": "mash", "after": "serve"}],
    )
    found = retimed(task, boil=Decision(0, 3), mash=at_rank(3, 5, 1), serve=at_rank(5, 6, 1))
    assert found["serve"] == (5, 6, 1, 1)


def test_the_kept_orders_are_about_as_many_as_what_touches_state() -> None:
    count = 200
    actions = [state_action("on", 0, (), (at("start", "light"),))]
    actions += [
        state_action(f"a{k}", 1, (at("start", "light"), at("all", "light")), (at("end", "light"),))
        for k in range(count)
    ]
    problem = lower(task_of(*actions))
    decisions = [
        Decision(0, 0) if a.id == "on" else Decision(2 * int(a.id[1:]) + 1, 2 * int(a.id[1:]) + 2)
        for a in problem.activities
    ]
    orders = state_orders(problem, decisions, 0)
    assert count <= len(orders) <= 6 * count


def kitchen() -> tuple[Task, Problem]:
    """State that the passes turn into precedence."""
    task = task_of(
        state_action("cut", 2, (at("start", "cut", False),), (at("end", "cut"),)),
        state_action("fry", 3, (at("start", "cut"),)),
    )
    problem = run_passes(lower(task))
    assert problem.state_precedences
    return task, problem


def test_what_state_made_precedence_of_still_gets_ranks() -> None:
    task, problem = kitchen()
    for placed in (
        earliest_schedule(problem),
        retime(problem, [Decision(4, 6), Decision(9, 12)]),
    ):
        assert [(p.start, p.rank) for p in placed] == [(0, 0), (2, 1)]
        assert validate(task, schedule_of(problem, placed)).valid


def test_ranks_are_written_only_where_they_are_not_0() -> None:
    _, problem = kitchen()
    entries = schedule_of(problem, earliest_schedule(problem)).to_dict()["actions"]
    assert entries == [
        {"id": "cut", "start": 0, "end": 2},
        {"id": "fry", "start": 2, "end": 5, "rank": 1},
    ]


def test_an_end_of_its_own_rank_is_written() -> None:
    problem = lower(task_of(state_action("blink", {"min": 0, "max": 9}, (), (at("end", "light"),))))
    placed = Placed(0, 3, (), rank=1, end_rank=0)
    (entry,) = schedule_of(problem, [placed]).entries
    assert (entry.rank, entry.end_rank) == (1, 0)
    (entry,) = schedule_of(problem, [replace(placed, end_rank=1)]).entries
    assert (entry.rank, entry.end_rank) == (1, None)
