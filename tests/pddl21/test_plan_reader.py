"""The plan reader: every plan that a planner printed, exactly, and not one that it did not."""

import doctest
import json
import os
import re
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from irc_pddl21.decoding import plan_reader
from irc_pddl21.decoding.plan_log import PlanBlock, PlanLog, PlanStep
from irc_pddl21.decoding.plan_reader import read_plans

OPTIC_ANYTIME = """\
Initial heuristic = 10.000, admissible cost estimate 28.004
b (2.000 | 27.004)b (1.000 | 36.005)(G)
; LP calculated the cost

; Plan found with metric 11.002
; Theoretical reachable cost 11.003
; States evaluated so far: 11
; Time 0.00
0.000: (cut a)  [3.000]
3.001: (cut b)  [4.000]
7.002: (serve)  [4.000]

 * All goal deadlines now no later than 11.002

Resorting to best-first search
Running WA* with W = 5.000, not restarting with goal states
b (9.000 | 5.000)b (1.000 | 27.005)(G)
; LP calculated the cost

; Plan found with metric 8.001
; States evaluated so far: 58
; Time 0.00
0.000: (cut a)  [3.000]
0.000: (cut b)  [4.000]
4.001: (serve)  [4.000]

 * All goal deadlines now no later than 8.001

Problem Unsolvable
;;;; Solution Found
; States evaluated: 58
; Cost: 8.001
; Time 0.00
0.000: (cut a)  [3.000]
0.000: (cut b)  [4.000]
4.001: (serve)  [4.000]
"""

OPTIC_FIRST = """\
All the ground actions in this problem are compression-safe
Initial heuristic = 3.000, admissible cost estimate 0.000
b (2.000 | 3.000)b (1.000 | 5.000)(G);;;; Solution Found
; States evaluated: 4
; Cost: 9.001
; Time 0.00
0.000: (b)  [3.000]
0.000: (a)  [5.000]
5.001: (c)  [4.000]
"""

KAIROS_ANYTIME = """\
; cost = 11.001999999999999
; makespan = 11.002
0.000: (cut a) [3.000]
3.001: (cut b) [4.000]
7.002: (serve) [4.000]
; better plan 2
; cost = 8.001
; makespan = 8.001
0.000: (cut a) [3.000]
0.000: (cut b) [4.000]
4.001: (serve) [4.000]
"""

UNSOLVABLE = """\
Number of literals: 3
Pruning (a) - temporal contradiction: start min/max = 2147483.647/-1.001; end min/max = 9.0/7.9
; Goals unreachable from the initial state
;; Problem unsolvable!
; Time 0.00
"""

CHATTER = """\
Number of literals: 6
Constructing lookup tables: [10%] [20%] [30%] [40%] [50%] [60%] [70%] [80%] [90%] [100%]
Seeing if metric is defined in terms of task vars or a minimal value of makespan
- Yes it is
Recognised a monotonic-change-induced limit on -1.000*<special>
\x1b[01;31mLooking for achievers for goal index 2, fact (done-c) with fID 5\x1b[00m
 (c)
  Looking at numeric effects of (c): 0 and 0
  No troublesome numerics - looking at conditional effects on (c), of which there are 0
Action 0 - (a) is uninteresting once we have fact (done-a)
Pruning (a) - temporal contradiction: start min/max = 2147483.647/-1.001; end min/max = 9.0/7.9
b (2.000 | 3.000)b (1.000 | 5.000)
[   0.001s] [memory] memory limit 11855 MB
problem: line: 3: Warning: Re-declaration of symbol in same scope: step6
info: (nothing yet)
3 states evaluated
* (4.000)
"""


def step(text: str, *args: str, at: str = "0", lasts: str | None = None) -> PlanStep:
    return PlanStep(Fraction(at), text, args, None if lasts is None else Fraction(lasts))


def names(plan: PlanBlock | None) -> list[str]:
    assert plan is not None
    return [" ".join((step.name, *step.args)) for step in plan.steps]


def only_damage(log: PlanLog) -> tuple[int, str]:
    """The line and the reason of the one damage in a log."""
    ((line, reason),) = [(item.line, item.reason) for plan in log.plans for item in plan.damage]
    return line, reason


# Dialects


def test_a_popf_line_is_read_exactly() -> None:
    log = read_plans(";;;; Solution Found\n; Cost: 28.003\n3.001: (Move R2 kitchen)  [5.100]\n")
    assert log.plans == (
        PlanBlock(
            steps=(step("move", "r2", "kitchen", at="3.001", lasts="5.1"),),
            metric=Decimal("28.003"),
            line=1,
        ),
    )
    assert log.plans[0].steps[0].line == 3


def test_an_lpg_line_is_read_without_its_cost() -> None:
    log = read_plans(
        "; Version LPG-td\n; MetricValue 5.00\n\n0.0003:   (ACTION A B) [D:5.00; C:0.10]\n"
    )
    assert log.best == PlanBlock(
        steps=(step("action", "a", "b", at="0.0003", lasts="5"),), metric=Decimal("5.00"), line=2
    )


def test_a_bare_ipc_file_is_one_plan_though_its_steps_are_not_sorted() -> None:
    log = read_plans("5.001: (c) [4.000]\n0.000: (a) [5.000] ; the first\n\n9.001: (d)\n")
    assert log.plans == (
        PlanBlock(
            steps=(
                step("c", at="5.001", lasts="4"),
                step("a", lasts="5"),
                step("d", at="9.001"),
            ),
            metric=None,
            line=1,
        ),
    )
    assert log.plans[0].makespan == Fraction("9.001")


def test_comments_below_a_bare_plan_are_its_own_figures() -> None:
    log = read_plans("0: (a) [5]\n; cost = 7 (unit cost)\n; makespan = 5\n")
    (plan,) = log.plans
    assert (plan.metric, plan.complete) == (Decimal(7), True)


def test_figures_below_their_plans_are_not_taken_for_headings() -> None:
    log = read_plans("0: (a) [5]\n; cost = 7\n0: (b) [3]\n; cost = 4\n")
    assert [(names(plan), plan.metric) for plan in log.plans] == [
        (["a"], Decimal(7)),
        (["b"], Decimal(4)),
    ]


def test_colour_codes_and_any_line_ends_are_no_obstacle() -> None:
    text = OPTIC_FIRST.replace("0.000: (a)", "\x1b[01;34m0.000\x1b[00m: (\x1b[1ma)")
    text = text.replace(";;;; Solution", "\x1b[00m;;;; Solution")
    for ending in ("\n", "\r\n", "\r"):
        log = read_plans(text.replace("\n", ending))
        assert names(log.best) == ["b", "a", "c"]
        assert log.best is not None
        assert [step.line for step in log.best.steps] == [7, 8, 9]


def test_zero_that_is_printed_as_negative_is_zero() -> None:
    (plan,) = read_plans("-0.000: (a) [-0.000]\n").plans
    assert plan == PlanBlock(steps=(step("a", lasts="0"),), metric=None, line=1)


def test_more_digits_than_a_float_holds_are_kept() -> None:
    (plan,) = read_plans("12345678901234567.000000000000001: (a) [1e-9]\n").plans
    assert plan.makespan == Fraction("12345678901234567.000000000000001") + Fraction(1, 10**9)


# Which plans there are


def test_the_repetition_at_the_end_is_not_another_plan() -> None:
    log = read_plans(OPTIC_ANYTIME)
    assert [(plan.line, plan.metric) for plan in log.plans] == [
        (5, Decimal("11.002")),
        (20, Decimal("8.001")),
    ]
    assert log.blocks == 3
    assert log.best is log.plans[1]


def test_a_plan_that_differs_only_in_a_time_is_another_plan() -> None:
    head, _, tail = OPTIC_ANYTIME.rpartition("4.001")
    assert len(read_plans(f"{head}4.002{tail}").plans) == 3


def test_a_repetition_adds_the_metric_that_the_first_print_lacked() -> None:
    log = read_plans("0: (a) [5]\n;;;; Solution Found\n; Cost: 5\n0: (a) [5]\n")
    assert [(plan.line, plan.metric) for plan in log.plans] == [(1, Decimal(5))]


def test_a_heading_glued_to_a_progress_line_is_found() -> None:
    log = read_plans(OPTIC_FIRST)
    assert [(plan.line, plan.metric) for plan in log.plans] == [(3, Decimal("9.001"))]
    assert names(log.best) == ["b", "a", "c"]


def test_a_heading_glued_to_a_progress_line_that_begins_with_a_number_is_found() -> None:
    log = read_plans(OPTIC_FIRST.replace("b (2.000", "12 (2.000"))
    assert [(plan.line, plan.metric) for plan in log.plans] == [(3, Decimal("9.001"))]
    assert names(log.best) == ["b", "a", "c"]


@pytest.mark.slow
def test_a_heading_behind_megabytes_of_progress_is_found() -> None:
    log = read_plans("b (9.000 | 7.000)" * 200_000 + OPTIC_FIRST)
    assert names(log.best) == ["b", "a", "c"]


def test_each_cost_comment_of_an_anytime_log_heads_a_plan() -> None:
    log = read_plans(KAIROS_ANYTIME)
    assert [(plan.line, plan.makespan) for plan in log.plans] == [
        (1, Fraction("11.002")),
        (7, Fraction("8.001")),
    ]
    assert log.plans[0].metric == Decimal("11.001999999999999")
    assert all(plan.complete for plan in log.plans)


def test_a_step_back_in_time_behind_a_gap_begins_another_plan() -> None:
    log = read_plans("plan:\n0: (a) [5]\n5: (b) [5]\nbetter:\n0: (a) [5]\n1: (b) [5]\n")
    assert [plan.makespan for plan in log.plans] == [10, 6]


def test_chatter_between_steps_does_not_split_a_plan() -> None:
    log = read_plans("0: (a) [5]\nWarning: slow\n\n5: (b) [5]\n")
    assert [names(plan) for plan in log.plans] == [["a", "b"]]


def test_chatter_alone_holds_no_plan() -> None:
    assert read_plans(CHATTER) == PlanLog()


def test_chatter_within_a_plan_is_neither_step_nor_damage() -> None:
    first, *rest = OPTIC_FIRST.splitlines(keepends=True)[2:]
    log = read_plans(first + "".join(rest[:4]) + CHATTER + "".join(rest[4:]) + CHATTER)
    assert log.plans == read_plans(OPTIC_FIRST[OPTIC_FIRST.index("b (2") :]).plans


@pytest.mark.parametrize("figure", ["", "; cost = 5\n"])
@pytest.mark.parametrize("chatter", ["10 states expanded", "3 plans (2 of them worse)"])
def test_a_count_right_below_a_plan_is_no_damage(figure: str, chatter: str) -> None:
    (plan,) = read_plans(f"0: (a) [5]\n{figure}{chatter}\n").plans
    assert plan.complete


def test_what_looks_like_a_step_below_a_plan_that_is_over_is_no_damage_to_it() -> None:
    (plan,) = read_plans("0: (a) [5]\n; cost = 5\n10 [s]\n").plans
    assert plan.complete


def test_a_stray_line_before_a_plan_does_not_spoil_it() -> None:
    log = read_plans("12: (define (problem\n" + KAIROS_ANYTIME)
    assert [(plan.line, plan.complete) for plan in log.plans] == [(1, False), (2, True), (8, True)]


def test_nothing_is_read_from_nothing() -> None:
    assert read_plans("") == PlanLog()
    assert read_plans("").best is None


@pytest.mark.parametrize(
    "text",
    [
        ";;;; Solution Found\n; States evaluated: 1\n; Cost: 0.000\n; Time 0.00\n",
        "; cost = 0\n; makespan = 0.000\n",
        "; Plan found with metric 0.000\n\n * All goal deadlines now no later than -0.000\n",
    ],
)
def test_a_heading_of_cost_zero_without_steps_is_the_empty_plan(text: str) -> None:
    log = read_plans(text)
    assert log.best == PlanBlock(steps=(), metric=Decimal(0), line=1)
    assert log.best.complete
    assert log.best.makespan == 0


def test_a_figure_without_a_plan_is_only_a_note() -> None:
    log = read_plans("; cost = 12\nnothing came of it\n")
    assert log == PlanLog(notes=("line 1: a figure without a plan",))


# What the planner says


def test_unsolvable_is_reported_where_no_plan_is() -> None:
    log = read_plans(UNSOLVABLE)
    assert log.unsolvable
    assert log.notes == (
        "line 3: ; Goals unreachable from the initial state",
        "line 4: ;; Problem unsolvable!",
    )


def test_unsolvable_after_a_plan_only_means_no_better_one() -> None:
    log = read_plans(OPTIC_ANYTIME)
    assert not log.unsolvable
    assert log.notes == ("line 29: Problem Unsolvable",)


def test_errors_of_the_planner_are_noted() -> None:
    error = "domain: line: 19: Error: Syntax error in durative-action declaration."
    assert read_plans(f"\nErrors: 3, warnings: 0\n{error}\n").notes == (f"line 3: {error}",)


# Damage


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        (
            "0.000: (a)  [-2147483.00-647]",
            "the duration -2147483.00-647 has overflowed the planner's clock",
        ),
        (
            "-2147483.00-647: (a)  [5.000]",
            "the time -2147483.00-647 has overflowed the planner's clock",
        ),
        ("-1.000: (a)  [5.000]", "the time -1.000 is negative"),
        ("0.000: (a)  [-5.000]", "the duration -5.000 is negative"),
        ("0.0.0: (a)  [5.000]", "the time '0.0.0' is not a number"),
        ("nan: (a)  [5.000]", "the time 'nan' is not a number"),
        ("-inf: (a)  [5.000]", "the time '-inf' is not a number"),
        ("1e999999999: (a)  [5.000]", "the time '1e999999999' is not a number"),
        ("0.000: (a)  [five]", "the duration 'five' is not a number"),
        ("0.000: (a)  [5.000", "the step is not finished"),
        ("0.000: ()  [5.000]", "not a step from ')  [5.000]' on"),
        ("0.000: ((a))  [5.000]", "not a step from '(a))  [5.000]' on"),
        ("0.000: (a)  [5.000] 3", "not a step from '3' on"),
        ("0.000: (a \x00)  [5.000]", "not a step from '\\x00)  [5.000]' on"),
        ("0.000: a  [5.000]", "not a step from ': a  [5.000]' on"),
        ("0.000 (a)  [5.000]", "not a step from ' (a)  [5.000]' on"),
        ("0.0", "the step is not finished"),
        ("xx 0.000: (a)  [5.000]", "the line does not begin with a time"),
        ("(a)  [5.000]", "the line does not begin with a time"),
    ],
)
def test_a_damaged_line_is_told_and_not_trusted(line: str, reason: str) -> None:
    text = OPTIC_FIRST.replace("0.000: (a)  [5.000]", line)
    log = read_plans(text)
    assert log.best is not None
    assert names(log.best) == ["b", "c"]
    assert not log.best.complete
    assert only_damage(log) == (8, reason)
    assert log.best.damage[0].text == line.strip()


def test_a_complete_plan_is_better_than_a_later_damaged_one() -> None:
    text = OPTIC_ANYTIME.replace("4.001: (serve)  [4.000]", "4.001: (serve)  [-4.000]")
    log = read_plans(text)
    assert [plan.complete for plan in log.plans] == [True, False]
    assert log.best is log.plans[0]
    assert log.ranked == (log.plans[0], log.plans[1])


def test_of_damaged_plans_the_last_with_a_step_is_the_best() -> None:
    log = read_plans(OPTIC_ANYTIME.replace("[4.000]", "[-4.000]") + ";;;; Solution Found\n")
    assert [plan.complete for plan in log.plans] == [False, False, False]
    assert log.best is log.plans[1]


def test_of_equal_plans_the_last_is_the_best() -> None:
    log = read_plans("; cost = 5\n0: (a) [5]\n; cost = 5.0\n0: (b) [5]\n")
    assert names(log.best) == ["b"]


def test_the_lowest_metric_is_the_best_even_if_it_is_not_the_last() -> None:
    log = read_plans("; cost = 5\n0: (a) [9]\n; cost = 6\n0: (b) [1]\n")
    assert names(log.best) == ["a"]


def test_where_a_metric_is_missing_the_makespan_decides() -> None:
    log = read_plans("0: (a) [9]\n;;;; Solution Found\n0: (b) [10]\n; cost = 1\n0: (c) [11]\n")
    assert [names(plan) for plan in log.ranked] == [["a"], ["b"], ["c"]]


def test_a_heading_whose_steps_never_came_is_damage() -> None:
    log = read_plans("; Plan found with metric 41.006\n; Time 0.00\n")
    assert only_damage(log) == (1, "no step follows the heading")
    assert log.best is None


def test_steps_that_end_before_the_stated_makespan_are_not_the_whole_plan() -> None:
    log = read_plans(KAIROS_ANYTIME.rsplit("\n", 2)[0] + "\n")
    assert only_damage(log) == (10, "the steps end before the stated makespan 8.001")
    assert log.best is log.plans[0]


def test_a_text_cut_inside_a_line_leaves_damage() -> None:
    for cut in ("4.001: (serve)  [4.00", "4.001: (serve)", "4.001: (ser", "4.001:", "4", "-"):
        text = OPTIC_ANYTIME[: OPTIC_ANYTIME.index("4.001: (serve)")] + cut
        log = read_plans(text)
        assert only_damage(log) == (25, "the text ends inside this line"), cut
        assert log.best is log.plans[0]


@pytest.mark.slow
def test_a_text_cut_anywhere_never_hides_the_last_whole_plan() -> None:
    whole = read_plans(OPTIC_ANYTIME).plans
    ends = [OPTIC_ANYTIME.index("\n", OPTIC_ANYTIME.index(mark)) for mark in ("7.002:", "4.001:")]
    for cut in range(len(OPTIC_ANYTIME)):
        log = read_plans(OPTIC_ANYTIME[:cut])
        expected = [plan for plan, end in zip(whole, ends, strict=True) if cut >= end]
        assert [plan for plan in log.ranked if plan in whole][:1] == expected[-1:]
        assert not [plan for plan in log.plans if plan.complete and plan not in whole], cut


def test_an_instantaneous_step_without_newline_is_whole_where_none_has_a_duration() -> None:
    log = read_plans("0: (a)\n1: (b)")
    assert names(log.best) == ["a", "b"]
    assert log.plans[0].complete


# Rubbish


@pytest.mark.slow
@given(st.text())
def test_no_text_makes_the_reader_fail(text: str) -> None:
    assert read_plans(text).blocks >= len(read_plans(text).plans)


PIECES = st.sampled_from(
    [
        "0.000: (a b)  [5.000]",
        "1: (a)",
        "-2147483.00-647: (a) [1]",
        "2.5: (",
        "[D:1; C:2]",
        ";;;; Solution Found",
        "; Plan found with metric 3",
        "; cost = 0",
        "; makespan = nan",
        "Problem Unsolvable",
        "\n",
        "\r\n",
        " ",
        "\x1b[0m",
        "x 1: (a) [",
        ")",
        "9",
        "-",
        "\x00",
        "\ud800",
    ]
)


@pytest.mark.slow
@given(st.lists(PIECES | st.text(max_size=3), max_size=40))
def test_no_shuffle_of_planner_output_makes_the_reader_fail(pieces: list[str]) -> None:
    log = read_plans("".join(pieces))
    assert log.blocks >= len(log.plans)
    assert len(log.ranked) == len([plan for plan in log.plans if plan.steps or plan.complete])
    assert all(step.start >= 0 and step.end >= step.start for p in log.plans for step in p.steps)


@pytest.mark.slow
@pytest.mark.parametrize(
    "piece",
    ["a", "\n", "1\n", "1:(\n", ";\n", "\x1b[0m", " ", ") [", "x 1: (a\n", ";\n5\n", "é\x00("],
)
def test_rubbish_takes_seconds_and_gives_no_plan(piece: str) -> None:
    text = piece * (500_000 // len(piece))
    began = time.process_time()
    log = read_plans(text + "0: (a) [1]\n" + text)
    assert time.process_time() - began < 10
    assert not [
        plan for plan in log.plans if plan.complete and plan.steps != (step("a", lasts="1"),)
    ]


@pytest.mark.slow
def test_comments_before_rubbish_are_not_read_again_for_each_line_of_it() -> None:
    text = ";;;; Solution Found\n" + ";\n" * 300_000 + "x\n5\n" * 100_000
    began = time.process_time()
    read_plans(text)
    assert time.process_time() - began < 10


def test_a_line_beyond_the_limit_is_damage_and_shown_short() -> None:
    (plan,) = read_plans(f"0: (a) [1]\n1: ({'a' * 1_000_000}) [1]\n").plans
    (damage,) = plan.damage
    assert (damage.line, damage.reason) == (2, "the line has more than 65,536 characters")
    assert damage.text.startswith("1: (aaa")
    assert len(damage.text) == 200


def test_a_plan_is_given_up_after_many_damaged_lines_but_the_next_is_read() -> None:
    log = read_plans(";;;; Solution Found\n" + "1: (\n" * 5_000 + OPTIC_FIRST)
    assert len(log.plans[0].damage) == plan_reader.MAX_DAMAGE_PER_PLAN
    assert log.plans[0].damage[-1].reason == "too many damaged lines; the rest is not read"
    assert names(log.best) == ["b", "a", "c"]


def test_reading_stops_and_says_so_when_a_limit_is_reached(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(plan_reader, "MAX_STEPS", 5)
    log = read_plans(OPTIC_FIRST + OPTIC_ANYTIME)
    assert [plan.complete for plan in log.plans] == [True, False]
    assert log.notes == ("line 20: too many steps; the text is not read from here on",)


# Reading back what is printed

WORD = st.from_regex(r"[a-z][a-z0-9_-]{0,12}", fullmatch=True)
TIME = st.integers(0, 10**12).map(lambda ticks: Fraction(ticks, 1000))
STEPS = st.lists(st.builds(PlanStep, TIME, WORD, st.lists(WORD, max_size=3).map(tuple), TIME))


def printed(time: Fraction) -> str:
    ticks = int(time * 1000)
    return f"{ticks // 1000}.{ticks % 1000:03}"


def ipc(step: PlanStep) -> str:
    action = " ".join((step.name, *step.args))
    return f"{printed(step.start)}: ({action}) [{printed(step.duration or Fraction(0))}]"


def popf(step: PlanStep) -> str:
    return ipc(step).replace(") [", ")  [")


def lpg(step: PlanStep) -> str:
    time, _, rest = ipc(step).upper().partition(": ")
    action, _, duration = rest.partition(" [")
    return f" {time}:   {action} [D:{duration[:-1]}; C:0.1000]"


def instantaneous(step: PlanStep) -> str:
    return ipc(step).partition(" [")[0]


def kairos_heading(steps: Sequence[PlanStep]) -> str:
    makespan = printed(max((step.end for step in steps), default=Fraction(0)))
    return f"; cost = {makespan}\n; makespan = {makespan}"


def optic_heading(steps: Sequence[PlanStep]) -> str:
    makespan = printed(max((step.end for step in steps), default=Fraction(0)))
    return f"b (1.000 | 5.000)(G);;;; Solution Found\n; Cost: {makespan}\n; Time 0.00"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("heading", "line"),
    [(kairos_heading, ipc), (optic_heading, popf), (lambda _: "; Seed 46", lpg)],
    ids=["kairos", "optic", "lpg"],
)
@given(steps=STEPS)
@settings(suppress_health_check=[HealthCheck.too_slow], max_examples=20)
def test_a_printed_plan_is_read_back_equal(
    heading: Callable[[Sequence[PlanStep]], str],
    line: Callable[[PlanStep], str],
    steps: list[PlanStep],
) -> None:
    log = read_plans("\n".join([heading(steps), *map(line, steps)]) + "\n")
    assert [plan.steps for plan in log.plans if steps] == ([tuple(steps)] if steps else [])
    assert all(plan.complete for plan in log.plans)


@pytest.mark.slow
@given(steps=STEPS)
def test_a_printed_plan_without_durations_is_read_back_equal(steps: list[PlanStep]) -> None:
    log = read_plans("\n".join(map(instantaneous, steps)))
    read = [step for plan in log.plans for step in plan.steps]
    assert read == [PlanStep(step.start, step.name, step.args) for step in steps]
    assert all(plan.complete for plan in log.plans)


# Real logs


def logs(shared_data: Path) -> list[Path]:
    return [
        *sorted(shared_data.glob("recorded/optic_logs/*.stdout")),
        *sorted(shared_data.glob("optic_runs/*/stdout.txt")),
    ]


def raw_blocks(text: str) -> list[list[str]]:
    """The lines of each plan, found by cutting the text at headings: the oracle."""
    cut = re.split(r"; Plan found with metric .*|;;;; Solution Found", text)[1:]
    return [[line for line in part.split("\n") if re.match(r"-?\d[^ ]*: \(", line)] for part in cut]


def test_the_recorded_logs_are_all_there(shared_data: Path) -> None:
    assert len(logs(shared_data)) == 81 + 8


@pytest.mark.slow
@pytest.mark.shared_data
def test_real_logs_give_as_many_plans_as_they_print(shared_data: Path) -> None:
    for path in logs(shared_data):
        text = path.read_text()
        blocks = raw_blocks(text)
        log = read_plans(text)
        assert log.blocks == len(blocks), path
        assert len(log.plans) == len({tuple(block) for block in blocks}), path
        for plan, block in zip(log.plans, blocks, strict=False):
            assert len(plan.steps) + len(plan.damage) == len(block), path


@pytest.mark.slow
@pytest.mark.shared_data
def test_real_logs_have_their_damage_told_line_by_line(shared_data: Path) -> None:
    damaged = set()
    for path in logs(shared_data):
        lines = path.read_text().split("\n")
        log = read_plans(path.read_text())
        told = {(item.line, item.text) for plan in log.plans for item in plan.damage}
        first_prints = {line for line, _ in told}
        expected = {(n, line) for n, line in enumerate(lines, 1) if ".00-" in line}
        assert {text for _, text in told} == {text for _, text in expected}, path
        assert told <= expected, path
        assert len(first_prints) == len({text for _, text in expected}), path
        if told:
            damaged.add(path.name)
    assert damaged == {path.name for path in logs(shared_data) if "_overflow" in path.name}
    assert len(damaged) == 45


@pytest.mark.slow
@pytest.mark.shared_data
def test_the_best_plan_of_a_real_log_is_the_last_one_to_the_digit(shared_data: Path) -> None:
    kept = 0
    for path in logs(shared_data):
        text = path.read_text()
        blocks = raw_blocks(text)
        best = read_plans(text).best
        assert (best is None) == (not blocks), path
        if best is None or "_overflow" in path.name:
            assert best is None or not best.complete, path
            continue
        steps = [
            f"{printed(step.start)}: ({' '.join((step.name, *step.args))})  "
            f"[{printed(step.duration or Fraction(0))}]"
            for step in best.steps
        ]
        assert steps == blocks[-1], path
        assert best.complete
        assert Decimal(str(best.metric)) == Decimal(best.makespan.numerator) / Decimal(
            best.makespan.denominator
        )
        kept += 1
    assert kept == 33


@pytest.mark.shared_data
def test_unsolvable_is_reported_for_exactly_the_runs_without_a_plan(shared_data: Path) -> None:
    for path in sorted(shared_data.glob("optic_runs/*/stdout.txt")):
        exit_code = json.loads((path.parent / "run.json").read_text())["exit_code"]
        assert read_plans(path.read_text()).unsolvable == (exit_code == 1), path


# The module


@pytest.mark.slow
def test_importing_the_module_does_not_import_lark() -> None:
    code = "import sys, irc_pddl21.decoding.plan_reader; sys.exit('lark' in sys.modules)"
    path = os.pathsep.join(sys.path)
    subprocess.run([sys.executable, "-c", code], check=True, env=os.environ | {"PYTHONPATH": path})


def test_the_example_in_the_documentation_runs() -> None:
    result = doctest.testmod(plan_reader)
    assert (result.attempted, result.failed) == (3, 0)
