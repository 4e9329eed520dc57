"""The text of an answer at every width: no ambiguous name, no unexplained sign, no lost row."""

from __future__ import annotations

import io
import random
import re
from itertools import pairwise

import pytest
from rich.cells import cell_len
from rich.console import Console

from irc.cli.page import Page
from irc.cli.render import print_answer
from irc.cli.short_names import ShortNames
from irc.driver.judge import Answer, finish
from irc.lowering.lower import lower
from irc.model import Task
from irc.schedule import Entry, Schedule, Status
from irc.targets import Outcome

WIDTHS = (50, 80, 120, 200)
SIZES = (10, 60, 61, 500)
_AXIS = "├┼─┊│"
_NO_SIGNS = set("()[] ")
"""Brackets of numbers that stand for names, and spaces."""


def answer_of(count: int, seed: int, *, dated: bool) -> Answer:
    """A plan of actions with long names that differ in the middle, at the end, or by a digit."""
    rng = random.Random(f"{count} {seed}")
    parts = ["assembly line three", "weld the left door", "weld the left door frame", "paint"]
    names = [
        f"{rng.choice(parts)} of order {k % 7} step {k} in hall {rng.choice('AB')} of the factory"
        for k in range(count)
    ]
    machines = [f"machine {k} in the big hall number {k % 3} of the north wing" for k in range(5)]
    closed = {"calendar": "day"} if dated else {}
    task = Task.model_validate(
        {
            "name": "plan",
            "time_unit": "h",
            **({"origin": "2026-12-28T06:00:00+01:00"} if dated else {}),
            "calendars": [{"id": "day", "every": 24, "open": [{"from": 0, "to": 16}]}],
            "resources": [{"id": name, "capacity": 2, **closed} for name in machines],
            "actions": [
                {"id": n, "duration": 3, "uses": [{"resource": machines[k % 5]}], "breaks": "pause"}
                for k, n in enumerate(names)
            ]
            + [{"id": "milestone", "duration": 0}],
            "groups": [{"id": "o", "actions": names[:3], "due": 5}],
        }
    )
    entries, at = [], dict.fromkeys(machines, 0)
    for k, name in enumerate(names):
        machine = machines[k % 5]
        start = at[machine]
        start += max(0, 24 - start % 24) if start % 24 >= 16 and dated else 0
        length = 11 if dated and start % 24 + 3 > 16 else 3
        at[machine] = start + length
        paused = length - 3
        entries.append(Entry(name, start, start + length, {machine: 1}, paused=paused))
    entries.append(Entry("milestone", 2, 2))
    problem = lower(task)
    outcome = Outcome(Status.FEASIBLE, "test", Schedule(tuple(entries)))
    return Answer(finish(task, problem, outcome, "cpsat", 0.0), problem)


def text_of(answer: Answer, width: int) -> str:
    file = io.StringIO()
    print_answer(answer, Console(file=file, width=width), all_rows=True)
    return file.getvalue()


def column(table: list[str], title: str) -> list[str]:
    """The cells of a column, by the line under the titles."""
    rule = table[1]
    starts = [0, *(m.end() for m in re.finditer(r"  (?=─)", rule))]
    spans = dict(
        zip(
            (table[0][a:b].strip() for a, b in pairwise([*starts, len(rule) + 1])),
            pairwise([*starts, len(rule) + 1]),
            strict=True,
        )
    )
    first, end = spans[title]
    return [row[first:end].strip() for row in table[2:] if not row.startswith("no room for")]


@pytest.mark.parametrize("count", SIZES)
@pytest.mark.parametrize("dated", [False, True])
def test_at_every_width_names_are_distinct_and_signs_explained(count: int, dated: bool) -> None:
    answer = answer_of(count, 1, dated=dated)
    for width in WIDTHS if count < 60 else WIDTHS[dated::2]:
        text = text_of(answer, width)
        assert max(map(cell_len, text.split("\n"))) <= width
        head, table, chart = text.rstrip("\n").split("\n\n")
        assert ("actions on 5 resources" in head) is (count + 1 > 60)
        names = column(table.split("\n"), "action")
        assert len(names) == len(set(names)) == count + 1
        _require_numbers_explained(text)
        _require_signs_explained(chart)


def _require_numbers_explained(text: str) -> None:
    """Each number that stands for a name has a line with the name."""
    used = set(re.findall(r"\S…\[(\d+)\]", text))
    explained = set(re.findall(r"(?m)^…\[(\d+)\] ", text))
    assert used <= explained


def _require_signs_explained(chart: str) -> None:
    lines = chart.split("\n")
    legend = next(k for k, line in enumerate(lines) if "critical" in line and "   " in line)
    signs = {c for line in lines[2:legend] for c in line if not c.isalnum() and c not in _NO_SIGNS}
    said = {c for line in lines[legend:] for c in line}
    assert signs - said - set(_AXIS) == set()


def test_a_number_stands_for_names_whose_ends_are_alike() -> None:
    page = Page(Console(file=io.StringIO(), width=80))
    same = [f"{'begin' * 9} {k} {'end' * 9}" for k in "abc"]
    short = ShortNames(page, same)
    cut = [short.fit(name, 12) for name in same]
    assert len(set(cut)) == 3
    assert all(cell_len(text) <= 12 for text in cut)
    assert [line.partition("] ")[2] for line in page.key()] == same


@pytest.mark.parametrize("width", [6, 9, 14, 30])
def test_no_two_names_become_the_same_text(width: int) -> None:
    rng = random.Random(width)
    page = Page(Console(file=io.StringIO(), width=80))
    alphabet = ["a", "b", "…", "1", "宽", " "]
    names = {
        "".join(rng.choices(alphabet, k=rng.randint(1, 40))).strip() or "x" for _ in range(400)
    }
    short = ShortNames(page, sorted(names))
    cut = [short.fit(name, width) for name in sorted(names)]
    assert len(set(cut)) == len(names)
    assert all(cell_len(text) <= width for text in cut)


def test_a_terminal_is_cut_and_a_file_is_not() -> None:
    answer = answer_of(200, 2, dated=False)
    file = io.StringIO()
    print_answer(answer, Console(file=file, width=100))
    assert "more rows" in file.getvalue()
    assert "more rows" not in text_of(answer, 100)


def test_a_long_plan_has_the_number_of_the_day_and_the_year() -> None:
    answer = answer_of(300, 3, dated=True)
    table = text_of(answer, 120).split("\n\n")[1].split("\n")
    assert column(table, "day")[0] == "1"
    assert column(table, "start")[0] == "2026-12-28 06:00"
    assert column(table, "start")[-1].startswith("20")


def test_what_is_late_and_busy_comes_first_in_a_long_plan() -> None:
    head = text_of(answer_of(100, 4, dated=False), 120).split("\n\n")[0]
    assert "101 actions on 5 resources" in head
    assert "busiest: machine" in head
    assert "all 1 orders are on time" in head
