"""What a person sees of an answer, read back from the text."""

from __future__ import annotations

import io
import random
import re
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from typing import Any

import pytest
from rich.cells import cell_len
from rich.console import Console

from irc.cli.chart import CHART_ROWS
from irc.cli.page import PIPED_WIDTH, answer_console
from irc.cli.render import print_answer
from irc.cli.table import TABLE_ROWS
from irc.driver.judge import Answer, finish
from irc.lowering.lower import lower
from irc.model import Task
from irc.model.times import format_number
from irc.passes import run_passes
from irc.passes.serial_sgs import list_schedule
from irc.retiming.retime import earliest_schedule, retime
from irc.retiming.slack import slacks
from irc.retiming.to_schedule import schedule_of
from irc.schedule import Entry, Schedule, Status
from irc.targets import Outcome
from oracles.generators import HOSTILE_NAMES, contended_task

SANDWICH: dict[str, Any] = {
    "name": "grilled chicken sandwich",
    "resources": [{"id": "grill"}, {"id": "board"}, {"id": "fryer"}],
    "actions": [
        {"id": "grill_chicken", "duration": 10, "uses": [{"resource": "grill"}]},
        {"id": "cut_lettuce", "duration": 4, "uses": [{"resource": "board"}]},
        {"id": "rest", "duration": 5},
        {"id": "stack", "duration": 5, "uses": [{"resource": "board"}]},
        {"id": "serve", "duration": 0},
    ],
    "precedence": [
        ["grill_chicken", "rest"],
        ["rest", "stack"],
        ["cut_lettuce", "stack"],
        ["stack", "serve"],
    ],
}
EDGES = "▐▕"


def answer_of(document: Mapping[str, Any] | Task, status: Status = Status.FEASIBLE) -> Answer:
    """The task solved by the list rule where resources are contended for, else exactly."""
    task = Task.model_validate(document)
    problem = run_passes(lower(task))
    found = list_schedule(problem) if problem.has_contention else None
    placed = retime(problem, found[0]) if found else earliest_schedule(problem)
    outcome = Outcome(status, "some-engine", schedule_of(problem, placed))
    return Answer(finish(task, problem, outcome, "cpsat", 0.25), problem)


def without_schedule(document: Mapping[str, Any], status: Status) -> Answer:
    task = Task.model_validate(document)
    problem = run_passes(lower(task))
    return Answer(finish(task, problem, Outcome(status, "some-engine"), "cpsat", 0.25), problem)


def shown(
    answer: Answer | Mapping[str, Any] | Task, width: int = 100, encoding: str = "utf-8"
) -> str:
    """The text as it arrives in a pipe that takes `encoding` and nothing else."""
    raw = io.BytesIO()
    file = io.TextIOWrapper(raw, encoding=encoding, errors="strict", newline="\n")
    given = answer if isinstance(answer, Answer) else answer_of(answer)
    print_answer(given, Console(file=file, width=width))
    file.flush()
    return raw.getvalue().decode(encoding)


def parts(text: str) -> list[list[str]]:
    """The lines of headline, table and chart."""
    return [block.split("\n") for block in text.rstrip("\n").split("\n\n")]


def by_cells(line: str) -> list[str]:
    """The character in each cell; "" behind a wide one."""
    cells: list[str] = []
    for character in line:
        cells += [character, *[""] * (cell_len(character) - 1)]
    return cells


def table_of(text: str) -> dict[str, dict[str, str]]:
    """The table read by its columns: action → title → cell."""
    titles, rule, *rows = parts(text)[1]
    starts = [0, *(k + 1 for k, c in enumerate(rule) if c == " " and rule[k + 1 : k + 2] != " ")]
    spans = list(zip(starts, [*starts[1:], len(rule) + 1], strict=True))
    names = ["".join(by_cells(titles)[a:b]).strip() for a, b in spans]
    read = {}
    for row in rows:
        if "more rows" not in row:
            cells = ["".join(by_cells(row)[a:b]).strip() for a, b in spans]
            read[cells[0]] = dict(zip(names, cells, strict=True))
    return read


_LEGEND = re.compile("critical|has slack|several actions")


def chart_of(text: str) -> list[str]:
    """The rows of the chart, without axis, legend and what follows."""
    chart = parts(text)[2]
    last = next(k for k, line in enumerate(chart) if _LEGEND.search(line))
    return [row for row in chart[2:last] if "more rows" not in row]


def chain(n: int, **fields: Any) -> dict[str, Any]:
    ids = [f"step {k}" for k in range(n)]
    return {
        "actions": [{"id": i, "duration": 2} for i in ids],
        "precedence": [list(pair) for pair in pairwise(ids)],
        **fields,
    }


# --- headline -----------------------------------------------------------------------------------


def test_a_proved_makespan_stands_beside_its_bound_and_the_reason() -> None:
    headline = parts(shown(SANDWICH))[0]
    assert headline == [
        "grilled chicken sandwich  ✔ optimal",
        "makespan 20 s, bound 20 s: critical path",
        "target cpsat, engine some-engine, 0.250 s",
    ]


def test_an_answer_without_proof_tells_its_gap() -> None:
    answer = answer_of(SANDWICH)
    problem = answer.problem.with_bound(15, "energy of 'board'")
    schedule = finish(
        Task.model_validate(SANDWICH),
        problem,
        Outcome(Status.FEASIBLE, "e", answer.schedule),
        "t",
        12.34,
    )
    headline = parts(shown(Answer(schedule, problem)))[0]
    assert headline[0].endswith("feasible (gap 25.0 %)")
    assert headline[1] == "makespan 20 s, bound 15 s: energy of 'board'"
    assert headline[2] == "target t, engine e, 12.3 s"


def test_a_bound_that_the_engine_proved_is_not_given_our_reason() -> None:
    answer = answer_of(SANDWICH)
    weaker = answer.problem.with_bound(3, "critical path")
    text = shown(Answer(answer.schedule, weaker))
    assert "makespan 20 s, bound 20 s: proved by some-engine" in text
    assert "critical path" not in text


def test_a_deadline_that_cannot_be_met_is_told_with_the_least_time_needed() -> None:
    text = shown(without_schedule({**SANDWICH, "deadline": 12}, Status.INFEASIBLE))
    assert "✘ infeasible" in text
    assert "deadline of 12 s; at least 20 s are needed: critical path" in text
    assert len(parts(text)) == 1


def test_other_infeasible_tasks_say_what_cannot_be_kept() -> None:
    text = shown(without_schedule(SANDWICH, Status.INFEASIBLE))
    assert "no schedule keeps all precedences, lags, windows and capacities at once" in text


def test_no_answer_within_the_limits_still_tells_the_bound() -> None:
    text = shown(without_schedule(SANDWICH, Status.UNKNOWN))
    assert "no schedule was found within the limits; at least 20 s are needed" in text


def test_an_empty_task_has_nothing_to_show_but_that() -> None:
    assert parts(shown({"actions": []}))[0][:2] == [
        "unnamed task  ✔ optimal",
        "there is nothing to do",
    ]


@pytest.mark.parametrize(
    ("duration", "unit", "told"),
    [
        (58_000_000, "s", "58,000,000 s (≈671 d 7 h)"),
        (5400, "s", "5,400 s (1 h 30 min)"),
        ("29.5", "h", "29.5 h (1 d 5 h 30 min)"),
        (30, "s", "30 s"),
        (40, "d", "40 d"),
        (40, "month", "40 month"),
        ("1/3", "min", "1/3 min"),
    ],
)
def test_a_long_time_is_also_told_in_greater_units(duration: Any, unit: str, told: str) -> None:
    text = shown({"time_unit": unit, "actions": [{"id": "a", "duration": duration}]})
    assert f"makespan {told}, bound" in text


# --- table --------------------------------------------------------------------------------------


def test_every_action_is_a_row_with_its_times_resources_and_slack() -> None:
    table = table_of(shown(SANDWICH))
    assert list(table) == ["cut_lettuce", "grill_chicken", "rest", "stack", "serve"]
    assert table["cut_lettuce"] == {
        "action": "cut_lettuce",
        "start (s)": "0",
        "end": "4",
        "duration": "4",
        "resources": "board",
        "slack": "11",
    }
    assert table["serve"]["start (s)"] == table["serve"]["end"] == "20"


def test_exactly_the_actions_without_slack_are_marked_critical() -> None:
    answer = answer_of(contended_task(random.Random(4), 40))
    slack = slacks(answer.problem, answer.schedule)
    table = table_of(shown(answer))
    assert {name for name, row in table.items() if row["slack"] == "critical"} == {
        name for name, ticks in slack.items() if ticks == 0
    }
    assert {row["slack"] for row in table.values()} > {"critical"}


def test_columns_stay_aligned_beside_wide_characters() -> None:
    document = {
        "resources": [{"id": "日本語のオーブン"}, {"id": "grill"}],
        "actions": [
            {"id": "🤖🤖", "duration": 12, "uses": [{"resource": "日本語のオーブン"}]},
            {"id": "焼く", "duration": 3, "uses": [{"resource": "grill"}]},
        ],
    }
    table = table_of(shown(document))
    assert table["🤖🤖"]["resources"] == "日本語のオーブン"
    assert table["🤖🤖"]["slack"] == "critical"
    assert table["焼く"]["slack"] == "9"


def test_decimal_points_stand_under_each_other() -> None:
    document = {
        "actions": [
            {"id": "a", "duration": "10.25"},
            {"id": "b", "duration": 3},
            {"id": "c", "duration": "0.5"},
        ]
    }
    rows = {row[0]: row for row in parts(shown(document))[1][2:]}
    point = rows["a"].index("10.25") + 2
    assert rows["c"].index("0.5") + 1 == point
    assert rows["b"][point - 1 : point + 3] == "3   "


def test_thirds_stay_exact() -> None:
    table = table_of(
        shown({"actions": [{"id": "a", "duration": "1/3"}, {"id": "b", "duration": 2}]})
    )
    assert table["a"]["duration"] == "1/3"
    assert table["a"]["slack"] == "5/3"


def test_amounts_and_several_resources_are_listed_in_natural_order() -> None:
    document = {
        "resources": [{"id": "robot10"}, {"id": "robot2"}, {"id": "crew", "capacity": 5}],
        "actions": [
            {
                "id": "lift",
                "duration": 5,
                "uses": [
                    {"resource": "robot10"},
                    {"resource": "robot2"},
                    {"resource": "crew", "amount": 3},
                ],
            }
        ],
    }
    assert table_of(shown(document))["lift"]["resources"] == "crew ×3, robot2, robot10"


def test_modes_and_occurrences_are_shown_where_there_are_any() -> None:
    answer = answer_of({"actions": [{"id": "cut", "duration": 4}]})
    assert "mode" not in table_of(shown(answer))["cut"]
    entries = (Entry("cut", 0, 4, mode="by hand"), Entry("cut", 4, 8, occurrence=2))
    text = shown(Answer(replace(answer.schedule, entries=entries), answer.problem))
    table = table_of(text)
    assert table["cut"]["mode"] == "by hand"
    assert table["cut #2"]["start (s)"] == "4"
    assert "slack is not known" in text
    assert "slack" not in table["cut"]


def test_ranks_are_shown_where_an_instant_has_an_order() -> None:
    answer = answer_of({"actions": [{"id": "cut", "duration": 4}]})
    entries = (
        Entry("cut", 0, 4),
        Entry("fry", 4, 8, rank=1),
        Entry("eat", 8, 9, rank=2, end_rank=3),
    )
    problem = replace(
        answer.problem,
        activities=tuple(replace(answer.problem.activities[0], id=e.id) for e in entries),
    )
    table = table_of(shown(Answer(replace(answer.schedule, entries=entries), problem)))
    assert [table[name]["rank"] for name in ("cut", "fry", "eat")] == ["", "1", "2, 3"]
    assert "rank" not in table_of(shown(answer))["cut"]


def optional_orders(count: int) -> dict[str, Any]:
    orders = [f"order{k + 1}" for k in range(count)]
    return {
        "actions": [
            {"id": "open", "duration": 1},
            {"id": "nap", "duration": 1, "occurs": "optional"},
            *({"id": f"bake {name}", "duration": 9} for name in orders),
        ],
        "groups": [
            {"id": name, "actions": [f"bake {name}"], "required": False, "reward": 1}
            for name in orders
        ],
    }


def test_what_is_left_out_is_told_by_groups_and_then_by_actions() -> None:
    answer = answer_of({"actions": [{"id": "open", "duration": 1}]})
    problem = lower(Task.model_validate(optional_orders(2)))
    assert "left out: order1, order2, nap\n" in shown(Answer(answer.schedule, problem))
    assert "left out" not in shown(answer)


def test_of_much_that_is_left_out_the_first_are_named() -> None:
    answer = answer_of({"actions": [{"id": "open", "duration": 1}]})
    problem = lower(Task.model_validate(optional_orders(20)))
    text = " ".join(shown(Answer(answer.schedule, problem)).split())
    assert "order11, order12 and 9 more" in text


def test_a_task_without_answer_leaves_nothing_out() -> None:
    answer = without_schedule(optional_orders(1), Status.INFEASIBLE)
    assert "left out" not in shown(answer)


def test_a_long_table_is_cut_in_the_middle_and_says_how_to_see_all() -> None:
    rows = parts(shown(chain(1000)))[1][2:]
    assert len(rows) == TABLE_ROWS + 1
    assert rows[TABLE_ROWS // 2] == "… 940 more rows (use -o or --format json for all)"
    assert rows[0].startswith("step 0 ")
    assert rows[-1].startswith("step 999 ")


def test_a_table_of_the_greatest_length_is_not_cut() -> None:
    assert "more rows" not in shown(chain(TABLE_ROWS))


# --- chart --------------------------------------------------------------------------------------


def test_bars_stand_where_their_times_are() -> None:
    chart = parts(shown(SANDWICH, width=100))[2]
    gutter = len("no resource ")
    assert chart[0].split() == ["0", "s", "2", "4", "6", "8", "10", "12", "14", "16", "18", "20"]
    per_second = (chart[0].index("10") - gutter) // 10
    rows = {row[:gutter].strip(): row[gutter:] for row in chart_of(shown(SANDWICH, width=100))}
    assert rows["grill"].index("▐") == 0
    assert rows["grill"].rindex("█") == 10 * per_second - 1
    assert rows["board"].index("▕") == 0
    assert rows["board"].rindex("░") == 4 * per_second - 1
    assert rows["board"].index("▐") == 15 * per_second
    assert rows["no resource"].index("▐") == 10 * per_second
    assert "idle: fryer" in chart[-1]


def test_every_bar_is_on_its_resource_and_none_covers_another() -> None:
    answer = answer_of(contended_task(random.Random(8), 30))
    text = shown(answer, width=600)
    rows, gutter = chart_of(text), parts(text)[2][1].index("├")
    found: dict[str, int] = {}
    name = ""
    for row in rows:
        name = row[:gutter].strip() or name
        found[name] = found.get(name, 0) + sum(c in EDGES for c in row)
    expected: dict[str, int] = {}
    capacity = {r.id: r.capacity for r in answer.problem.resources}
    for entry in answer.schedule.entries:
        for held in entry.resources:
            title = held if capacity[held] == 1 else f"{held} ×{capacity[held]}"
            expected[title] = expected.get(title, 0) + 1
    assert found == expected


def test_bars_and_table_agree_on_what_is_critical() -> None:
    answer = answer_of(contended_task(random.Random(8), 30))
    rows = chart_of(shown(answer, width=600))
    slack = slacks(answer.problem, answer.schedule)
    critical = sum(len(e.resources) for e in answer.schedule.entries if not slack[e.id])
    assert sum(row.count("▐") for row in rows) == critical
    assert 0 < critical < sum(len(e.resources) for e in answer.schedule.entries)


def test_overlaps_on_a_resource_take_as_many_lanes_as_run_at_once() -> None:
    use = [{"resource": "crew"}]
    document = {
        "resources": [{"id": "crew", "capacity": 3}],
        "actions": [{"id": f"a{k}", "duration": 5, "uses": use} for k in range(6)],
    }
    rows = chart_of(shown(document))
    assert [row.split()[0] for row in rows[:1]] == ["crew"]
    assert len(rows) == 3
    assert all(sum(c in EDGES for c in row) == 2 for row in rows)


def test_a_resource_used_one_at_a_time_takes_one_lane_however_short_the_actions_are() -> None:
    use = [{"resource": "desk"}]
    document = {
        "resources": [{"id": "desk"}],
        "actions": [{"id": f"a{k}", "duration": 1, "uses": use} for k in range(400)],
    }
    text = shown(document, width=60)
    (row,) = chart_of(text)
    assert set(row.removeprefix("desk ")) == {"▓"}
    assert "▓ several actions" in text


def test_labels_stand_in_their_bars_or_beside_them() -> None:
    document = {
        "actions": [
            {"id": "a long bar", "duration": 90},
            {"id": "a short bar", "duration": 1},
            {"id": "the end", "duration": 1, "release": 89},
        ]
    }
    upper, lower = chart_of(shown(document))
    assert upper.startswith("▒ a short bar ")
    assert upper.endswith(" the end ▐")
    assert "█ a long bar █" in lower


def test_every_action_that_holds_nothing_is_labelled_where_there_is_room() -> None:
    rng = random.Random(2)
    document = {
        "actions": [{"id": f"step{k}.", "duration": rng.randint(1, 40)} for k in range(35)],
        "precedence": [[f"step{k // 3}.", f"step{k}."] for k in range(1, 35)],
    }
    rows = chart_of(shown(document))
    for k in range(35):
        assert sum(f"step{k}." in row for row in rows) == 1


def test_a_milestone_alone_is_a_mark_at_zero() -> None:
    text = shown({"actions": [{"id": "done", "duration": 0}]})
    assert chart_of(text) == ["◆ done"]
    assert "◆ critical milestone" in text


def test_a_milestone_of_zero_length_does_not_cover_a_resource() -> None:
    use = [{"resource": "desk"}]
    document = {
        "resources": [{"id": "desk"}],
        "actions": [
            {"id": "write", "duration": 9, "uses": use},
            {"id": "sign", "duration": 0, "uses": use, "release": 4},
        ],
    }
    rows = chart_of(shown(document))
    assert rows[0].startswith("desk ")
    assert "◇" not in rows[0]
    assert rows[1].startswith("no resource ")
    assert "◇ sign" in rows[1]


def test_a_great_span_has_its_axis_in_days() -> None:
    text = shown(chain(2, deadline=90_000_000) | {"actions": [
        {"id": "step 0", "duration": 12_000_000}, {"id": "step 1", "duration": 46_000_000}
    ]})  # fmt: skip
    axis = parts(text)[2][0].split()
    assert axis[:2] == ["0", "d"]
    assert axis[2:] == ["100", "200", "300", "400", "500", "600"]


def test_axis_labels_are_round_and_do_not_touch() -> None:
    for span in (1, 7, 13, 60, 99, 100, 101, 999, 9_999, 10_000, 86_400, 10**9, Fraction(1, 3)):
        document = {"actions": [{"id": "a", "duration": format_number(span)}]}
        axis = parts(shown(document, width=70))[2][0]
        numbers = [Fraction(n.replace(",", "")) for n in axis.split() if n[0].isdigit()]
        steps = {b - a for a, b in pairwise(numbers)}
        assert len(steps) == 1, (span, axis)
        assert len(numbers) > 3, (span, axis)
        digits = format_number(steps.pop()).replace(".", "").strip("0")
        assert digits in ("1", "2", "5", "15", "3", "6", "12"), (span, axis)


def test_a_chart_with_too_many_rows_is_cut_and_says_so() -> None:
    document = {"actions": [{"id": f"a{k}", "duration": 5} for k in range(100)]}
    text = shown(document)
    assert len(chart_of(text)) == CHART_ROWS
    assert f"… {100 - CHART_ROWS} more rows" in parts(text)[2]


def test_a_crowded_resource_does_not_push_the_others_out_of_the_chart() -> None:
    document = {
        "resources": [{"id": "crowd", "capacity": 90}, {"id": "zoo"}],
        "actions": [
            *({"id": f"a{k}", "duration": 5, "uses": [{"resource": "crowd"}]} for k in range(90)),
            {"id": "feed", "duration": 3, "uses": [{"resource": "zoo"}]},
            {"id": "wash", "duration": 3},
        ],
    }
    rows = chart_of(shown(document))
    assert len(rows) == CHART_ROWS
    assert any(row.startswith("zoo ") and "feed" in row for row in rows)
    assert any(row.startswith("no resource ") and "wash" in row for row in rows)


# --- where it is shown --------------------------------------------------------------------------


def hostile() -> dict[str, Any]:
    names = [*HOSTILE_NAMES, "[red]", "[/]", "[bold]x[/bold]", ":smile:", "a\n[link=x]b", "\x1b[2J"]
    resources = [*names[:6], "日本語", "🤖", "[blue]"]
    return {
        "name": "[red]name[/red]\r\n\x1b[31m",
        "resources": [{"id": name} for name in resources],
        "actions": [
            {"id": name, "duration": 1 + k % 5, "uses": [{"resource": resources[k % 9]}]}
            for k, name in enumerate(dict.fromkeys(names))
        ],
    }


@pytest.mark.slow
@pytest.mark.parametrize("encoding", ["utf-8", "ascii", "cp1252"])
@pytest.mark.parametrize("width", [24, 40, 60, 80, 100, 173])
def test_no_line_is_wider_than_the_console(width: int, encoding: str) -> None:
    for document in (SANDWICH, hostile(), chain(70), contended_task(random.Random(1), 100)):
        for line in shown(document, width, encoding).split("\n"):
            assert cell_len(line) <= width, line
            assert line == line.rstrip()


def test_names_are_never_read_as_markup_or_control() -> None:
    text = shown(hostile())
    assert all(c.isprintable() for c in text.replace("\n", ""))
    assert text.startswith(r"[red]name[/red]\r\n\x1b[31m  ")
    table = table_of(text)
    for name in ("[/]", "[bold]x[/bold]", ":smile:", r"a\n[link=x]b", r"\x1b[2J"):
        document = {"actions": [{"id": name, "duration": 1}]}
        assert name in table or name in table_of(shown(document))


def test_control_characters_and_spaces_at_the_ends_of_a_name_can_be_seen() -> None:
    names = {"line\nbreak": r"line\nbreak", "\u202eright": r"\u202eright", " x ": '" x "'}
    document = {"actions": [{"id": name, "duration": 1} for name in names]}
    assert set(table_of(shown(document))) == set(names.values())


def test_joined_emoji_are_taken_apart_because_terminals_disagree_on_their_width() -> None:
    table = table_of(shown({"actions": [{"id": "👩\u200d🍳 \u2764\ufe0f", "duration": 1}]}))
    assert list(table) == ["👩🍳 \u2764"]


def test_two_long_names_that_differ_at_the_end_can_be_told_apart() -> None:
    document = {"actions": [{"id": "x" * 300 + end, "duration": 1} for end in "ab"]}
    first, second = table_of(shown(document))
    assert first.endswith("a")
    assert second.endswith("b")
    assert "…" in first


@pytest.mark.parametrize("encoding", ["ascii", "cp1252", "latin-1"])
def test_without_box_characters_ascii_takes_their_place(encoding: str) -> None:
    text = shown(SANDWICH, encoding=encoding)
    assert text.isascii()
    rows = chart_of(text)
    assert any(row.startswith("grill ") and "[#" in row for row in rows)
    assert any(row.startswith("board ") and "(=" in row for row in rows)
    assert "[# critical   (= has slack   * critical milestone" in text
    assert "..." in shown(chain(100), encoding=encoding)


def test_names_that_the_encoding_lacks_are_written_as_escapes() -> None:
    document = {"actions": [{"id": "焼く 🤖", "duration": 3}]}
    assert r"\u713c\u304f \U0001f916" in table_of(shown(document, encoding="ascii"))
    assert "straße" in table_of(
        shown({"actions": [{"id": "straße", "duration": 3}]}, encoding="cp1252")
    )


def test_colour_is_for_terminals_only() -> None:
    answer = answer_of(SANDWICH)
    assert "\x1b" not in shown(answer)
    file = io.StringIO()
    print_answer(
        answer, Console(file=file, width=100, force_terminal=True, color_system="standard")
    )
    coloured = file.getvalue()
    assert "\x1b[31mgrill_chicken" in coloured


def test_a_pipe_is_as_wide_as_columns_says_or_one_hundred(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delenv("COLUMNS", raising=False)
    assert answer_console().width == PIPED_WIDTH == 100
    monkeypatch.setenv("COLUMNS", "72")
    assert answer_console().width == 72


def test_the_same_answer_is_shown_in_the_same_bytes() -> None:
    shuffled = {**SANDWICH, "actions": SANDWICH["actions"][::-1]}
    assert parts(shown(SANDWICH))[1:] == parts(shown(shuffled))[1:]


def test_a_schedule_read_from_a_file_can_be_shown_without_what_it_does_not_say() -> None:
    answer = answer_of(SANDWICH)
    bare = Schedule(answer.schedule.entries)
    headline = parts(shown(Answer(bare, answer.problem)))[0]
    assert headline == ["unnamed task  feasible", "makespan 20 s"]


@pytest.mark.slow
def test_showing_an_answer_loads_no_solver() -> None:
    heavy = {"ortools", "networkx", "unified_planning", "pydantic", "matplotlib"}
    code = f"import sys, irc.cli.render; print(sorted({heavy!r} & set(sys.modules)))"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "[]"


@pytest.mark.parametrize("encoding", ["utf-8", "ascii"])
def test_every_sign_of_the_chart_is_in_its_legend(encoding: str) -> None:
    signs = set("▐█▕░▒◆◇▓" if encoding == "utf-8" else "#[=(*%")
    seen = set()
    drawn = (contended_task(random.Random(seed), 8) for seed in range(12))
    for document in (SANDWICH, chain(3), crowded(), crowded(3), *drawn):
        text = shown(document, encoding=encoding)
        # (Names of actions may hold the letter that is the ASCII sign of a milestone.)
        used = signs & set("".join(chart_of(text)))
        legend = next(line for line in parts(text)[2] if _LEGEND.search(line))
        assert used <= set(legend)
        assert not (signs & set(legend)) - used
        seen |= used
    assert len(seen) >= 5


def crowded(steps: int = 40) -> dict[str, Any]:
    """Many short actions on one resource, and a long one after one of them."""
    return {
        "resources": [{"id": "m"}],
        "actions": [
            *({"id": f"s{i}", "duration": 1, "uses": [{"resource": "m"}]} for i in range(steps)),
            {"id": "long", "duration": 100},
        ],
        "precedence": [["s0", "long"]],
    }
