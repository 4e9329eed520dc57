"""Rules 6 and 7: state in the order of (time, rank), given or looked for, and goals."""

from __future__ import annotations

from typing import Any

import pytest

from builders import rules, state_action, violations
from irc.model import Task
from irc.schedule import Entry, Schedule
from irc.validation import validate
from irc.validation.rank_graph import RankGraph, StepBudget


def needs(at: str, value: Any = True, var: str = "light") -> dict[str, Any]:
    return {"at": at, "var": var, "value": value}


makes = needs
"""An effect is written like a condition."""


def light_task(*actions: dict[str, Any], initial: bool = False, **fields: Any) -> Task:
    return Task(actions=list(actions), state=[{"id": "light", "initial": initial}], **fields)


MATCH = state_action("match", 8, (), (makes("start"), makes("end", False)))
REPAIR = state_action("repair", 5, (needs("start"), needs("all")))


# Conditions and effects at different times


def test_a_start_condition_holds_just_before_the_start() -> None:
    task = light_task(
        state_action("on", 5, (), (makes("end"),)), state_action("see", 1, (needs("start"),))
    )
    assert rules(task, Entry("on", 0, 5), Entry("see", 6, 7)) == []
    (violation,) = violations(task, Entry("on", 0, 5), Entry("see", 4, 5))
    assert (violation.rule, violation.number) == ("state", 6)
    assert violation.message == (
        "'see' needs 'light' = true just before its start at 4 s, but it is false"
    )
    assert violation.actions == ("see",)
    assert violation.times == (4,)


def test_start_effects_apply_at_the_start() -> None:
    task = light_task(
        state_action("on", 5, (), (makes("start"),)), state_action("see", 1, (needs("start"),))
    )
    assert rules(task, Entry("on", 0, 5), Entry("see", 1, 2)) == []


def test_an_end_condition_holds_just_before_the_end() -> None:
    task = light_task(
        state_action("on", 5, (), (makes("end"),)), state_action("see", 4, (needs("end"),))
    )
    assert rules(task, Entry("on", 0, 5), Entry("see", 2, 6)) == []
    assert rules(task, Entry("on", 0, 5), Entry("see", 0, 4)) == ["state"]


def test_a_condition_on_the_whole_duration_is_broken_by_a_change_in_the_middle() -> None:
    task = light_task(MATCH, REPAIR)
    assert rules(task, Entry("match", 0, 8), Entry("repair", 1, 6)) == []
    (violation,) = violations(task, Entry("match", 0, 8), Entry("repair", 4, 9))
    assert violation.message == (
        "'match' makes 'light' false at 8 s, while 'repair' needs it to stay true"
    )
    assert set(violation.actions) == {"match", "repair"}


def test_a_change_to_the_same_value_breaks_nothing() -> None:
    task = light_task(state_action("again", 1, (), (makes("end"),)), REPAIR, initial=True)
    assert rules(task, Entry("repair", 0, 5), Entry("again", 1, 2)) == []


def test_a_condition_on_the_whole_duration_may_be_made_true_by_the_actions_own_start() -> None:
    task = light_task(
        state_action("torch", 5, (needs("all"),), (makes("start"), makes("end", False)))
    )
    assert rules(task, Entry("torch", 0, 5)) == []


def test_a_condition_on_the_whole_duration_must_hold_just_after_the_start() -> None:
    task = light_task(state_action("see", 5, (needs("all"),)))
    (violation,) = violations(task, Entry("see", 0, 5))
    assert violation.message == (
        "'see' needs 'light' = true while it lasts (0 s to 5 s), "
        "but just after its start it is false"
    )


def test_a_variable_has_many_values() -> None:
    steps = [
        state_action("grill", 2, (needs("start", "raw", "meat"),), (makes("end", "done", "meat"),)),
        state_action("carve", 1, (needs("start", "done", "meat"),)),
    ]
    state = [{"id": "meat", "values": ["raw", "done"], "initial": "raw"}]
    task = Task(actions=steps, state=state)
    assert rules(task, Entry("grill", 0, 2), Entry("carve", 3, 4)) == []
    assert rules(task, Entry("grill", 0, 2), Entry("carve", 0, 1)) == ["state"]


def test_a_variable_without_a_first_value_meets_no_condition_until_it_is_set() -> None:
    steps = [state_action("go", 1, (needs("start", "a", "place"),))]
    task = Task(actions=steps, state=[{"id": "place", "values": ["a", "b"]}])
    (violation,) = violations(task, Entry("go", 0, 1))
    assert violation.message.endswith("but it is not set")


# Ranks that are given


def test_a_match_lit_at_5_lights_a_shorter_repair_that_starts_at_5_one_rank_later() -> None:
    task = light_task(MATCH, REPAIR)
    assert rules(task, Entry("match", 5, 13), Entry("repair", 5, 10, rank=1)) == []


def test_given_ranks_are_taken_as_they_are() -> None:
    task = light_task(MATCH, REPAIR)
    entries = [Entry("match", 5, 13, rank=1), Entry("repair", 5, 10)]
    assert "state" in rules(task, *entries)


def test_a_fixed_duration_carries_the_rank_of_the_start_to_the_end() -> None:
    task = light_task(MATCH, {**REPAIR, "duration": 8})
    # One rank later at the start is one rank later at the end, when the match is out.
    entries = [Entry("match", 5, 13), Entry("repair", 5, 13, rank=1)]
    assert rules(task, *entries) == ["state"]
    entries[1] = Entry("repair", 5, 13, rank=1, end_rank=0)
    assert rules(task, *entries) == ["rank", "state"]


def test_a_stated_end_rank_must_be_that_of_a_fixed_duration() -> None:
    task = light_task(state_action("see", 5))
    (violation,) = violations(task, Entry("see", 0, 5, rank=0, end_rank=2))
    assert (violation.rule, violation.number) == ("rank", 6)
    assert violation.message == (
        "'see' starts with rank 0 and ends with rank 2; "
        "its duration is fixed, so both have the same rank"
    )


@pytest.mark.parametrize(
    ("end", "end_rank", "valid"),
    [(2, 0, False), (2, 2, True), (3, 0, True), (3, 2, True), (4, 0, True), (4, 2, False)],
)
def test_a_chosen_duration_keeps_its_bounds_in_ranks_too(
    end: int, end_rank: int, valid: bool
) -> None:
    task = light_task(state_action("see", {"min": 2, "max": 4}))
    found = rules(task, Entry("see", 0, end, rank=1, end_rank=end_rank))
    assert found == ([] if valid else ["rank"])


def test_two_interfering_happenings_of_equal_time_and_rank_are_refused() -> None:
    task = light_task(MATCH, state_action("see", 1, (needs("start"),)), initial=True)
    # The value is the same before and after; still one reads what the other writes.
    (violation,) = violations(task, Entry("match", 5, 13, rank=1), Entry("see", 5, 6, rank=1))
    assert violation.rule == "interference"
    assert "'match' changes 'light' at 5 s with rank 1" in violation.message
    assert set(violation.actions) == {"match", "see"}


def test_two_changes_of_equal_time_and_rank_interfere_even_with_the_same_value() -> None:
    task = light_task(
        state_action("x", 1, (), (makes("end"),)), state_action("y", 1, (), (makes("end"),))
    )
    entries = [Entry("x", 0, 1, rank=3), Entry("y", 0, 1, rank=3)]
    assert rules(task, *entries) == ["interference"]
    assert rules(task, Entry("x", 0, 1, rank=3), Entry("y", 0, 1, rank=4)) == []


def test_two_reads_of_equal_time_and_rank_do_not_interfere() -> None:
    look = [state_action(name, 1, (needs("start", False),)) for name in ("x", "y")]
    task = light_task(*look)
    assert rules(task, Entry("x", 0, 1, rank=1), Entry("y", 0, 1, rank=1)) == []


def test_a_condition_on_the_whole_duration_does_not_read_at_the_start_itself() -> None:
    # PDDL2.1 checks invariants between happenings only.
    task = light_task(MATCH, state_action("see", 5, (needs("all"),)))
    assert rules(task, Entry("match", 5, 13, rank=1), Entry("see", 5, 10, rank=1)) == []
    assert rules(task, Entry("match", 5, 13), Entry("see", 8, 13)) == []


def test_a_zero_duration_reads_just_before_all_its_effects() -> None:
    toggle = state_action(
        "toggle",
        0,
        (needs("start", False), needs("all", False), needs("end", False)),
        (makes("end", True),),
    )
    assert rules(light_task(toggle), Entry("toggle", 2, 2, rank=1)) == []
    assert rules(light_task(toggle), Entry("toggle", 2, 2)) == []
    contrary = state_action("toggle", 0, (needs("end", True),), (makes("start", True),))
    assert rules(light_task(contrary), Entry("toggle", 2, 2, rank=1)) == ["state"]
    assert rules(light_task(contrary), Entry("toggle", 2, 2)) == ["state"]


def test_an_occurrence_drawn_out_in_ranks_only_is_two_happenings() -> None:
    flash = state_action("flash", {"min": 0, "max": 3}, (needs("end"),), (makes("start"),))
    task = light_task(flash)
    assert rules(task, Entry("flash", 2, 2, rank=0, end_rank=1)) == []
    assert rules(task, Entry("flash", 2, 2, rank=1, end_rank=1)) == ["state"]


def test_one_happening_does_not_give_two_values() -> None:
    both = state_action("both", 0, (), (makes("start", True), makes("end", False)))
    assert "state" in rules(light_task(both), Entry("both", 0, 0))
    assert "state" in rules(light_task(both), Entry("both", 0, 0, rank=1))


# Ranks that are looked for


def test_ranks_are_found_for_the_match_and_the_repair() -> None:
    task = light_task(MATCH, REPAIR)
    assert rules(task, Entry("match", 5, 13), Entry("repair", 5, 10)) == []


def test_no_rank_helps_a_repair_as_long_as_its_match() -> None:
    task = light_task(MATCH, {**REPAIR, "duration": 8})
    (violation,) = violations(task, Entry("match", 5, 13), Entry("repair", 5, 13))
    assert (violation.rule, violation.number) == ("rank", 6)
    assert violation.message == (
        "no ranks exist: 'repair', 'match' must come one after the other, in a circle"
    )


def test_a_repair_of_a_chosen_duration_may_end_just_before_its_match() -> None:
    task = light_task(MATCH, {**REPAIR, "duration": {"min": 2, "max": 9}})
    assert rules(task, Entry("match", 5, 13), Entry("repair", 5, 13)) == []
    # As long as allowed at most, its end can be no earlier in ranks than its start allows.
    task = light_task(MATCH, {**REPAIR, "duration": {"min": 8, "max": 9}})
    assert rules(task, Entry("match", 5, 13), Entry("repair", 5, 13)) == ["rank"]


@pytest.mark.parametrize(("longest", "expected"), [(5, ["rank"]), (6, [])])
def test_a_duration_as_long_as_allowed_ends_no_later_in_ranks_than_it_starts(
    longest: int, expected: list[str]
) -> None:
    # see starts before on's change of door at 0, and ends after on's change of light at 5.
    on = state_action("on", 5, (), (makes("start", True, "door"), makes("end")))
    see = state_action(
        "see", {"min": 2, "max": longest}, (needs("start", False, "door"), needs("end"))
    )
    task = Task(actions=[on, see], state=[{"id": "light"}, {"id": "door"}])
    assert rules(task, Entry("on", 0, 5), Entry("see", 0, 5)) == expected


def test_a_condition_on_the_whole_duration_opens_after_the_last_change_of_its_instant() -> None:
    flicker = [
        state_action("off", 0, (needs("start", True),), (makes("start", False),)),
        state_action("on", 0, (needs("start", False),), (makes("start", True),)),
    ]
    see = state_action("see", 3, (needs("all"),))
    task = light_task(*flicker, see, initial=True)
    assert rules(task, Entry("off", 5, 5), Entry("on", 5, 5), Entry("see", 5, 8)) == []
    assert rules(task, Entry("off", 5, 5), Entry("on", 5, 5), Entry("see", 2, 5)) == []
    # Throughout a change and its reversal, the light is out in between.
    assert rules(task, Entry("off", 5, 5), Entry("on", 5, 5), Entry("see", 3, 6)) == ["state"]


def test_what_no_ranks_can_mend_is_told_beside_what_they_do_not() -> None:
    closed, opens = needs("start", False, "door"), makes("start", True, "door")
    switch = state_action("switch", 1, (needs("start", False),), (makes("start", True),))
    actions = [
        MATCH,
        REPAIR,
        switch,
        *(state_action(n, 2, (closed,), (opens,)) for n in ("x", "y")),
    ]
    task = Task(actions=actions, state=[{"id": "light"}, {"id": "door"}])
    entries = [
        Entry("match", 0, 8),
        Entry("repair", 4, 9),
        Entry("switch", 1, 2),
        Entry("x", 1, 3),
        Entry("y", 1, 3),
    ]
    found = [(v.rule, v.actions) for v in violations(task, *entries)]
    assert found == [
        ("state", ("switch",)),
        ("state", ("match", "repair")),
        ("rank", ("x", "y")),
    ]


def test_a_read_before_and_a_read_after_the_same_change_are_both_placed() -> None:
    task = light_task(
        state_action("dark", 2, (needs("start", False),)),
        state_action("bright", 2, (needs("start", True),)),
        MATCH,
    )
    assert rules(task, Entry("dark", 5, 7), Entry("bright", 5, 7), Entry("match", 5, 13)) == []


def test_precedences_without_slack_order_ranks() -> None:
    actions = [
        state_action("dark", 2, (needs("start", False),)),
        state_action("on", 2, (), (makes("start"),)),
        state_action("wait", 3),
    ]
    entries = [Entry("dark", 5, 7), Entry("on", 5, 7), Entry("wait", 5, 8)]
    free = light_task(*actions)
    assert rules(free, *entries) == []
    chain = [
        {"before": "on", "after": "wait", "type": "start-start"},
        {"before": "wait", "after": "dark", "type": "start-start"},
    ]
    tight = light_task(*actions, precedence=chain)
    (violation,) = violations(tight, *entries)
    assert violation.rule == "rank"
    assert set(violation.actions) == {"dark", "on", "wait"}
    slack = light_task(*actions, precedence=[{**p, "min_lag": -1} for p in chain])
    assert rules(slack, *entries) == []


def test_a_precedence_without_slack_carries_ranks_to_a_later_instant() -> None:
    # late starts 3 after on's start exactly, so it comes no earlier in ranks; but off, of on's
    # rank or later, must come after late's read.
    actions = [
        state_action(
            "on", 3, (needs("start", False, "other"),), (makes("start"), makes("end", False))
        ),
        state_action("late", 1, (needs("start"),)),
        state_action("first", 0, (), (makes("start", True, "other"),)),
    ]
    state = [{"id": "light"}, {"id": "other"}]
    lag = [{"before": "first", "after": "late", "min_lag": 3, "type": "start-start"}]
    entries = [Entry("on", 0, 3), Entry("late", 3, 4), Entry("first", 0, 0)]
    assert rules(Task(actions=actions, state=state), *entries) == []
    assert rules(Task(actions=actions, state=state, precedence=lag), *entries) == ["rank"]


def moves(*pairs: str) -> list[dict[str, Any]]:
    """A move per pair of values: instantaneous, from the first to the second."""
    return [
        state_action(pair, 0, (needs("start", pair[0], "at"),), (makes("start", pair[1], "at"),))
        for pair in pairs
    ]


def walk_task(*pairs: str, goal: str | None = None) -> tuple[Task, list[Entry]]:
    goals = [{"var": "at", "value": goal}] if goal else []
    state = [{"id": "at", "values": sorted(set("".join(pairs))), "initial": "a"}]
    task = Task(actions=moves(*pairs), state=state, goals=goals)
    return task, [Entry(pair, 3, 3) for pair in pairs]


def test_many_changes_of_one_instant_are_put_in_an_order() -> None:
    # An order is a walk that takes every move once; only from b is there a choice to get wrong.
    task, entries = walk_task("bc", "ab", "cb", "bd", "da", goal="a")
    assert rules(task, *entries) == []


def test_changes_of_one_instant_without_an_order_are_refused() -> None:
    task, entries = walk_task("ab", "bc", "ad")
    (violation,) = violations(task, *entries)
    assert violation.rule == "rank"
    assert violation.message == "no order of 'ab', 'bc', 'ad' at 3 s suits 'at'"


def test_the_order_found_must_lead_to_the_goal() -> None:
    task, entries = walk_task("ab", "ba", "ac", "ca", goal="a")
    assert rules(task, *entries) == []
    task, entries = walk_task("ab", "ba", "ac", goal="a")
    assert rules(task, *entries) == ["rank"]


def test_an_order_chosen_at_one_instant_fits_the_next() -> None:
    # Whichever of x and y comes last at 1 decides the value that is needed at 2.
    actions = [
        state_action("x", 0, (), (makes("start", True),)),
        state_action("y", 0, (), (makes("start", False),)),
        state_action("look", 1, (needs("start", True),)),
    ]
    entries = [Entry("x", 1, 1), Entry("y", 1, 1), Entry("look", 2, 3)]
    assert rules(light_task(*actions), *entries) == []
    forced = light_task(*actions, precedence=[("x", "y")])
    assert rules(forced, *entries) == ["rank"]


def test_both_readings_of_what_takes_no_time_are_tried() -> None:
    flash = state_action("flash", {"min": 0, "max": 3}, (needs("end"),), (makes("start"),))
    assert rules(light_task(flash), Entry("flash", 2, 2)) == []
    blink = state_action("blink", {"min": 0, "max": 3}, (needs("end", False),), (makes("start"),))
    assert rules(light_task(blink), Entry("blink", 2, 2)) == []
    fixed = state_action("flash", 0, (needs("end"),), (makes("start"),))
    assert rules(light_task(fixed), Entry("flash", 2, 2)) == ["state"]


def test_readings_that_are_not_all_tried_leave_it_undecided(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("irc.validation.state.SEARCH_STEPS", 0)
    monkeypatch.setattr("irc.validation.state.STEPS_PER_OCCURRENCE", 0)
    flash = state_action("flash", {"min": 0, "max": 3}, (needs("end"),), (makes("start"),))
    (violation,) = violations(light_task(flash), Entry("flash", 2, 2))
    assert violation.rule == "undecided"
    assert violation.actions == ("flash",)


def test_something_short_may_last_through_a_change_of_its_instant() -> None:
    conditions = (needs("start", False), needs("end", True))
    on = state_action("on", 0, (), (makes("start", True),))
    entries = [Entry("on", 1, 1), Entry("flash", 1, 1)]
    drawn_out = light_task(on, state_action("flash", {"min": 0, "max": 3}, conditions))
    assert rules(drawn_out, *entries) == []
    at_once = light_task(on, state_action("flash", 0, conditions))
    assert rules(at_once, *entries) == ["rank"]


def test_a_search_that_gives_up_says_undecided_not_valid(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("irc.validation.state.SEARCH_STEPS", 20)
    monkeypatch.setattr("irc.validation.state.STEPS_PER_OCCURRENCE", 1)
    task, entries = walk_task("bc", "ab", "cb", "bd", "da", "ac", "ca", goal="a")
    verdict = validate(task, Schedule(tuple(entries)))
    assert not verdict.valid
    assert verdict.undecided
    assert [v.rule for v in verdict.violations] == ["undecided"]
    assert str(verdict).startswith("undecided, 1 violation:")


@pytest.mark.slow
def test_a_hard_instant_is_answered_in_bounded_time() -> None:
    # Every order ends in g too early, but there are millions to try.
    pairs = [a + b for a in "abcdef" for b in "abcdef" if a != b] + ["ag", "bg"]
    task, entries = walk_task(*pairs)
    assert rules(task, *entries) == ["undecided"]


def test_independent_instants_do_not_make_each_other_hard() -> None:
    # 300 two-way choices, each of them open; tried together they would be 2 to the 300.
    actions, entries = [], []
    for k in range(300):
        actions += [
            state_action(f"x{k}", 0, (), (makes("start", True),)),
            state_action(f"y{k}", 0, (), (makes("start", False),)),
            state_action(f"look{k}", 1, (needs("start", k % 2 == 0),)),
        ]
        start = 10 * k
        entries += [
            Entry(f"x{k}", start, start),
            Entry(f"y{k}", start, start),
            Entry(f"look{k}", start + 1, start + 2),
        ]
    assert rules(light_task(*actions), *entries) == []


def test_many_equal_changes_of_one_instant_are_no_trouble() -> None:
    actions = [
        state_action(f"a{i}", 2, (), (makes("start"), makes("end", False))) for i in range(200)
    ]
    entries = [Entry(f"a{i}", 0, 2) for i in range(200)]
    assert rules(light_task(*actions), *entries) == []


def test_ranks_that_move_later_take_along_what_must_follow() -> None:
    # y before x lifts x and, by precedence, w and r with it; r must still follow w.
    actions = [
        state_action("y", 0, (needs("start", False, "door"),), (makes("start", True, "door"),)),
        state_action("x", 0, (needs("start", True, "door"),), (makes("start", False, "door"),)),
        state_action("w", 0, (), (makes("start"),)),
        state_action("r", 0, (needs("start"),)),
    ]
    state = [{"id": "light", "initial": True}, {"id": "door"}]
    pairs = [{"before": a, "after": b, "type": "start-start"} for a, b in ("xw", "wr")]
    task = Task(actions=actions, state=state, precedence=pairs)
    assert rules(task, *(Entry(name, 0, 0) for name in "yxwr")) == []


def test_a_dead_end_of_the_search_leaves_no_trace() -> None:
    sets = makes("start", "v", "at")
    actions = [
        state_action("a0", 0, (needs("all"),), (sets, makes("start"))),
        state_action("a1", 0, (), (makes("start"),)),
        state_action("a2", 0, (needs("all", False),), (sets,)),
        state_action("a3", {"min": 0, "max": 1}, (), (makes("start"),)),
    ]
    state = [{"id": "light"}, {"id": "at", "values": ["u", "v"], "initial": "u"}]
    pairs = [{"before": "a3", "after": "a2", "type": "start-start"}]
    entries = [Entry(f"a{i}", 0, 0) for i in range(4)]
    assert rules(Task(actions=actions, state=state), *entries) == []
    assert rules(Task(actions=actions, state=state, precedence=pairs), *entries) == ["rank"]


def test_taking_back_edges_restores_the_ranks() -> None:
    graph = RankGraph([0, 0, 0], [(1, 2, 0)], StepBudget(100))
    start = graph.mark()
    assert graph.add(((0, 1, 1),))
    assert graph.ranks == [0, 1, 1]
    assert not graph.allows(((2, 0, 0),))
    graph.undo(start)
    assert graph.ranks == [0, 0, 0]
    assert graph.add(((2, 0, 1),))
    assert graph.ranks == [1, 0, 0]


def test_the_ranks_found_are_not_trusted(monkeypatch: pytest.MonkeyPatch) -> None:
    def all_alike(subject: Any, story: Any, budget: Any, violations: Any) -> list[int]:
        return [0] * story.node_count

    def falling(subject: Any, story: Any, budget: Any, violations: Any) -> list[int]:
        return list(range(story.node_count, 0, -1))

    monkeypatch.setattr("irc.validation.state.find_ranks", all_alike)
    entries = [Entry("match", 5, 13), Entry("repair", 5, 10)]
    assert set(rules(light_task(MATCH, REPAIR), *entries)) == {"interference", "state"}
    monkeypatch.setattr("irc.validation.state.find_ranks", falling)
    pair = [{"before": "match", "after": "repair", "type": "start-start"}]
    task = light_task(MATCH, state_action("repair", 5, (needs("start", False),)), precedence=pair)
    assert rules(task, *entries) == ["rank"]


# Rule 7


def test_a_goal_holds_after_the_last_end() -> None:
    task = light_task(MATCH, goals=[{"var": "light", "value": False}])
    assert rules(task, Entry("match", 0, 8)) == []
    (violation,) = violations(light_task(MATCH, goals=[{"var": "light"}]), Entry("match", 0, 8))
    assert (violation.rule, violation.number) == ("goal", 7)
    assert violation.message == "the goal 'light' = true does not hold at the end: it is false"


def test_a_goal_that_nothing_touches_keeps_its_first_value() -> None:
    goals = [{"var": "light", "value": False}]
    assert rules(light_task(goals=goals)) == []
    assert rules(light_task(goals=goals, initial=True)) == ["goal"]


def test_a_goal_can_be_that_an_action_is_there() -> None:
    task = light_task(state_action("bonus", 1, occurs="optional"), goals=["bonus"])
    assert rules(task, Entry("bonus", 0, 1)) == []
    (violation,) = violations(task)
    assert violation.rule == "goal"
    assert violation.message == "the goal 'bonus' is missing"
