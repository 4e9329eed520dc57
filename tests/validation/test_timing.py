"""Rules 1 to 3: presence, time windows, precedence."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from builders import rules, violations
from irc.model import Task
from irc.schedule import Entry


def one_action(**fields: Any) -> Task:
    return Task(actions=[{"id": "cut", "duration": 3, **fields}])


def two_actions(**precedence: Any) -> Task:
    return Task(
        actions=[{"id": "cut", "duration": 3}, {"id": "stack", "duration": 1}],
        precedence=[{"before": "cut", "after": "stack", **precedence}],
    )


# Rule 1


def test_every_once_action_must_be_there() -> None:
    (violation,) = violations(two_actions(), Entry("stack", 3, 4))
    assert (violation.rule, violation.number) == ("presence", 1)
    assert violation.message == "'cut' is missing"
    assert violation.actions == ("cut",)


def test_an_optional_action_may_be_absent_or_there_but_not_twice() -> None:
    task = one_action(occurs="optional")
    assert rules(task) == []
    assert rules(task, Entry("cut", 0, 3)) == []
    assert rules(task, Entry("cut", 0, 3), Entry("cut", 3, 6, occurrence=2)) == ["presence"]


@pytest.mark.parametrize(("count", "expected"), [(0, 1), (1, 1), (2, 0), (3, 0), (4, 1)])
def test_the_number_of_occurrences_keeps_its_bounds(count: int, expected: int) -> None:
    task = one_action(occurs={"min": 2, "max": 3})
    entries = [Entry("cut", 3 * k, 3 * k + 3, occurrence=k + 1) for k in range(count)]
    assert rules(task, *entries) == ["presence"] * expected


def test_without_a_maximum_an_action_may_occur_any_number_of_times() -> None:
    task = one_action(occurs={"min": 0})
    entries = [Entry("cut", 3 * k, 3 * k + 3, occurrence=k + 1) for k in range(20)]
    assert rules(task, *entries) == []


def test_an_entry_of_an_unknown_action_is_refused() -> None:
    (violation,) = violations(one_action(), Entry("cut", 0, 3), Entry("cutt", 0, 3))
    assert violation.rule == "unknown"
    assert "'cutt'" in violation.message


def test_the_same_occurrence_twice_is_refused() -> None:
    task = one_action(occurs={"min": 0})
    (violation,) = violations(task, Entry("cut", 0, 3), Entry("cut", 3, 6))
    assert violation.message == "occurrence 1 of 'cut' stands 2 times in the schedule"


def test_occurrences_are_numbered_from_one_without_a_gap() -> None:
    task = one_action(occurs={"min": 0})
    assert rules(task, Entry("cut", 0, 3, occurrence=2)) == ["occurrence"]
    gap = [Entry("cut", 0, 3), Entry("cut", 3, 6, occurrence=3)]
    assert rules(task, *gap) == ["occurrence"]


def test_occurrences_are_numbered_by_start() -> None:
    task = one_action(occurs={"min": 0})
    in_order = [Entry("cut", 3, 6, occurrence=2), Entry("cut", 0, 3, occurrence=1)]
    assert rules(task, *in_order) == []
    (violation,) = violations(
        task, Entry("cut", 3, 6, occurrence=1), Entry("cut", 0, 3, occurrence=2)
    )
    assert violation.message == (
        "the occurrences of 'cut' are not numbered by start: "
        "number 2 starts at 0 s, number 1 at 3 s"
    )


def test_occurrences_of_one_action_do_not_overlap_but_may_touch() -> None:
    task = one_action(occurs={"min": 0})
    assert rules(task, Entry("cut", 0, 3), Entry("cut", 3, 6, occurrence=2)) == []
    (violation,) = violations(task, Entry("cut", 0, 3), Entry("cut", 2, 5, occurrence=2))
    assert violation.message == (
        "two occurrences of 'cut' overlap: one lasts until 3 s, another starts at 2 s"
    )


def test_an_overlap_is_found_behind_an_occurrence_that_ends_early() -> None:
    task = one_action(duration={"min": 1, "max": 10}, occurs={"min": 0})
    entries = [
        Entry("cut", 0, 10, occurrence=1),
        Entry("cut", 1, 2, occurrence=2),
        Entry("cut", 5, 6, occurrence=3),
    ]
    assert rules(task, *entries) == ["occurrence", "occurrence"]


def test_an_exact_repetition_of_an_action_counts_once() -> None:
    twice = Task(actions=[{"id": "cut", "duration": 3}, {"id": "cut", "duration": 3}])
    assert rules(twice, Entry("cut", 0, 3)) == []


def group_task(required: bool) -> Task:
    occurs = {"occurs": "optional"} if required else {}
    return Task(
        actions=[{"id": name, "duration": 1, **occurs} for name in ("bake", "wrap")],
        groups=[{"id": "order", "actions": ["bake", "wrap"], "required": required}],
    )


def test_a_required_group_must_be_there_completely() -> None:
    task = group_task(required=True)
    assert rules(task, Entry("bake", 0, 1), Entry("wrap", 0, 1)) == []
    assert rules(task) == ["group"]
    (violation,) = violations(task, Entry("bake", 0, 1))
    assert violation.message == "the group 'order' is required; missing: 'wrap'"
    assert violation.actions == ("wrap",)


def test_an_optional_group_decides_for_members_that_say_nothing() -> None:
    task = group_task(required=False)
    assert rules(task) == []
    assert rules(task, Entry("bake", 0, 1), Entry("wrap", 0, 1)) == []
    assert rules(task, Entry("wrap", 0, 1)) == ["group"]


@pytest.mark.parametrize("status", ["cancelled", "abandoned"])
def test_an_entry_with_a_status_belongs_to_execution(status: str) -> None:
    (violation,) = violations(one_action(), Entry("cut", 0, 3, status=status))
    assert violation.rule == "status"
    assert repr(status) in violation.message


# Rule 2


def test_a_fixed_duration_is_kept() -> None:
    assert rules(one_action(), Entry("cut", 5, 8)) == []
    (violation,) = violations(one_action(), Entry("cut", 5, 9))
    assert (violation.rule, violation.number) == ("duration", 2)
    assert violation.message == "'cut' lasts 4 s (5 to 9) instead of 3 s"
    assert violation.times == (5, 9)


@pytest.mark.parametrize(
    ("end", "valid"), [(1, False), (2, True), (3, True), (4, True), (5, False)]
)
def test_a_chosen_duration_lies_in_its_range_ends_included(end: int, valid: bool) -> None:
    task = one_action(duration={"min": 2, "max": 4})
    assert (rules(task, Entry("cut", 0, end)) == []) is valid


def test_thirds_are_exact() -> None:
    third = Fraction(1, 3)
    task = Task(
        actions=[{"id": "a", "duration": "1/3"}, {"id": "b", "duration": 1}],
        precedence=[("a", "b")],
    )
    assert rules(task, Entry("a", 0, third), Entry("b", third, Fraction(4, 3))) == []
    almost = Fraction(333333333333333, 10**15)
    assert rules(task, Entry("a", 0, third), Entry("b", almost, 1 + almost)) == ["precedence"]


def test_times_with_units_are_read_in_the_unit_of_the_task() -> None:
    task = Task(time_unit="min", actions=[{"id": "boil", "duration": "90 s"}])
    assert rules(task, Entry("boil", 0, Fraction(3, 2))) == []
    (violation,) = violations(task, Entry("boil", 0, 90))
    assert violation.message == "'boil' lasts 90 min (0 to 90) instead of 1.5 min"


def modes_task() -> Task:
    modes = [{"id": "fast", "duration": 1}, {"id": "slow", "duration": 4}]
    return Task(actions=[{"id": "cut", "duration": 9, "modes": modes}])


def test_the_duration_is_that_of_the_chosen_mode() -> None:
    assert rules(modes_task(), Entry("cut", 0, 4, mode="slow")) == []
    assert rules(modes_task(), Entry("cut", 0, 4, mode="fast")) == ["duration"]
    assert rules(modes_task(), Entry("cut", 0, 9, mode="fast")) == ["duration"]


def test_exactly_one_of_the_modes_is_chosen() -> None:
    assert [v.message for v in violations(modes_task(), Entry("cut", 0, 4))] == [
        "'cut' has no mode in the schedule; its modes are 'fast', 'slow'"
    ]
    assert [v.message for v in violations(modes_task(), Entry("cut", 0, 4, mode="quick"))] == [
        "'cut' has no mode 'quick'; its modes are 'fast', 'slow'"
    ]
    assert rules(one_action(), Entry("cut", 0, 3, mode="fast")) == ["mode"]


def test_nothing_ends_before_it_starts_whatever_its_mode() -> None:
    assert rules(modes_task(), Entry("cut", 4, 0, mode="quick")) == ["mode", "duration"]


def test_nothing_starts_before_zero_or_its_release() -> None:
    assert rules(one_action(), Entry("cut", -1, 2)) == ["release"]
    assert rules(one_action(release=-5), Entry("cut", -1, 2)) == ["release"]
    task = one_action(release=2)
    assert rules(task, Entry("cut", 2, 5)) == []
    (violation,) = violations(task, Entry("cut", 1, 4))
    assert violation.message == "'cut' starts at 1 s, before its release (2 s)"


def test_a_fixed_start_is_kept() -> None:
    task = one_action(start=4)
    assert rules(task, Entry("cut", 4, 7)) == []
    assert rules(task, Entry("cut", 5, 8)) == ["start"]


def test_nothing_starts_after_its_latest_start() -> None:
    task = one_action(latest_start=4)
    assert rules(task, Entry("cut", 1, 4)) == []
    assert rules(task, Entry("cut", 4, 7, rank=1)) == []
    (violation,) = violations(task, Entry("cut", Fraction(9, 2), Fraction(15, 2)))
    assert (violation.rule, violation.number) == ("latest_start", 2)
    assert violation.message == "'cut' starts at 4.5 s, after its latest start (4 s)"
    assert violation.times == (Fraction(9, 2), 4)


def test_every_occurrence_starts_by_the_latest_start() -> None:
    task = one_action(latest_start=4, occurs={"min": 0})
    assert rules(task, Entry("cut", 0, 3), Entry("cut", 3, 6, occurrence=2)) == []
    late = [Entry("cut", 0, 3), Entry("cut", 5, 8, occurrence=2)]
    assert rules(task, *late) == ["latest_start"]


def test_an_action_ends_by_its_own_its_groups_and_the_tasks_deadline() -> None:
    task = Task(
        actions=[{"id": "cut", "duration": 3, "deadline": 10}],
        groups=[{"id": "order", "actions": ["cut"], "deadline": 11}],
        deadline=12,
    )
    assert rules(task, Entry("cut", 7, 10)) == []
    late = [v.message for v in violations(task, Entry("cut", 10, 13))]
    assert late == [
        "'cut' ends at 13 s, after its deadline (10 s)",
        "'cut' ends at 13 s, after the deadline of group 'order' (11 s)",
        "'cut' ends at 13 s, after the task's deadline (12 s)",
    ]


def test_absolute_dates_are_read_against_the_origin() -> None:
    task = Task(
        time_unit="h",
        origin="2030-01-01T00:00:00",
        actions=[{"id": "ship", "duration": 1, "release": "2030-01-02T00:00:00"}],
    )
    assert rules(task, Entry("ship", 24, 25)) == []
    assert rules(task, Entry("ship", 23, 24)) == ["release"]


# Rule 3


@pytest.mark.parametrize(
    ("kind", "earliest"),
    [("finish-start", 5), ("start-start", 2), ("finish-finish", 4), ("start-finish", 1)],
)
def test_each_type_of_precedence_binds_its_two_end_points(kind: str, earliest: int) -> None:
    task = two_actions(type=kind)
    cut = Entry("cut", 2, 5)
    assert rules(task, cut, Entry("stack", earliest, earliest + 1)) == []
    assert rules(task, cut, Entry("stack", earliest - 1, earliest)) == ["precedence"]


def test_a_minimal_lag_is_waited_for() -> None:
    task = two_actions(min_lag=2)
    assert rules(task, Entry("cut", 0, 3), Entry("stack", 5, 6)) == []
    (violation,) = violations(task, Entry("cut", 0, 3), Entry("stack", 3, 4))
    assert violation.message == (
        "'stack' starts at 3 s, but must not start before 5 s: the end of 'cut' (3 s) + lag 2 s"
    )
    assert violation.actions == ("cut", "stack")
    assert violation.times == (3, 5)


def test_a_negative_lag_lets_work_overlap_that_far_and_no_further() -> None:
    task = two_actions(min_lag=-2)
    assert rules(task, Entry("cut", 0, 3), Entry("stack", 1, 2)) == []
    assert rules(task, Entry("cut", 0, 3), Entry("stack", 0, 1)) == ["precedence"]


def test_a_maximal_lag_bounds_the_wait() -> None:
    task = two_actions(max_lag=2)
    assert rules(task, Entry("cut", 0, 3), Entry("stack", 5, 6)) == []
    (violation,) = violations(task, Entry("cut", 0, 3), Entry("stack", 6, 7))
    assert violation.message == (
        "'stack' starts at 6 s, but must not start after 5 s: "
        "the end of 'cut' (3 s) + maximum lag 2 s"
    )


def test_precedence_binds_only_where_both_are_there() -> None:
    task = Task(
        actions=[
            {"id": "cut", "duration": 3, "occurs": "optional"},
            {"id": "stack", "duration": 1},
        ],
        precedence=[("cut", "stack")],
    )
    assert rules(task, Entry("stack", 0, 1)) == []
    assert rules(task, Entry("stack", 0, 1), Entry("cut", 0, 3)) == ["precedence"]


def test_a_minimal_lag_is_compared_with_ranks() -> None:
    task = two_actions()
    assert rules(task, Entry("cut", 0, 3, rank=1), Entry("stack", 3, 4, rank=1)) == []
    (violation,) = violations(task, Entry("cut", 0, 3, rank=1), Entry("stack", 3, 4))
    assert violation.rule == "precedence"
    assert "rank 0" in violation.message
    assert rules(task, Entry("cut", 0, 3, rank=1), Entry("stack", 4, 5)) == []


def test_a_maximal_lag_is_compared_by_time_alone() -> None:
    task = two_actions(max_lag=0)
    assert rules(task, Entry("cut", 0, 3), Entry("stack", 3, 4, rank=7)) == []


def test_a_maximal_lag_below_zero_is_read_as_it_stands() -> None:
    task = two_actions(type="start-start", min_lag=-5, max_lag=-1)
    assert rules(task, Entry("cut", 5, 8), Entry("stack", 4, 5)) == []
    assert rules(task, Entry("cut", 5, 8), Entry("stack", 5, 6)) == ["precedence"]
