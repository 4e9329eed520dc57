"""Whatever is wrong with a text of the DSL: the code, the line and the column, and no more."""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import irc
from irc.diagnostics import Report, Severity
from irc.frontends.dsl import document_parts, reader
from irc.frontends.dsl.task import dsl_task
from irc.frontends.files import parse_task

TOKEN_NAMES = re.compile(r"\b[A-Z]{2,}(_[A-Z]+)+\b|\$END|\bDOTS\b|\bEQUALS\b|\bWORD\b")


@dataclass(frozen=True)
class Wrong:
    """A text and every error it must be told: (code, line, column), and words that are said."""

    text: str
    errors: tuple[tuple[str, int, int], ...]
    said: str = ""


def wrong(text: str, *errors: tuple[str, int, int], said: str = "") -> Wrong:
    return Wrong(text, errors, said)


def errors(report: Report) -> list[tuple[str, int | None, int | None]]:
    return [(d.code.id, d.line, d.column) for d in report.located().errors]


def told(text: str) -> Report:
    """The report on a text: of its faults, else of the checks."""
    found = dsl_task(text)
    if found.task is None or not found.report.ok:
        return found.report
    return irc.check(found.task)


STATEMENTS = [
    wrong("boil", ("IRC010", 1, 1), said="has no duration"),
    wrong("minimise makespan\nboil 3", ("IRC010", 1, 1), said="`minimize`"),
    wrong("resorce grill\nboil 3", ("IRC010", 1, 1), said="`resource`"),
    wrong("boil eggs 10s onn stove", ("IRC010", 1, 15), said="did you mean `on`?"),
    wrong("boil 3 deadlin 20", ("IRC010", 1, 8), said="`deadline`"),
    wrong("boil 3 starts 20", ("IRC010", 1, 8), said="`starts at`"),
    wrong("resource board capcity 2\nboil 3", ("IRC010", 1, 16), said="`capacity`"),
    wrong("boil 3 min 4", ("IRC013", 1, 6), said="quotes"),
    wrong("3 min", ("IRC013", 1, 1), said="where a name is expected"),
    wrong("a 5 min -> b", ("IRC013", 1, 3)),
    wrong('"boil" eggs 3', ("IRC010", 1, 8), said="after the name in quotes"),
    wrong("boil eggs 10s after", ("IRC010", 1, 19), said="ends too early; expected a name"),
    wrong("boil 3 after on", ("IRC010", 1, 14), said="has a meaning of its own"),
    wrong("put egg on pan 4 s", ("IRC010", 1, 16), said="stands before `on`"),
    wrong("boil 5 .. 10 min", ("IRC010", 1, 6), said='write "5"'),
    wrong("boil 5 after a + 3 .. 5 min\na 1", ("IRC010", 1, 18), said="has none"),
    wrong("boil .. 10", ("IRC010", 1, 6), said="before it"),
    wrong("boil 3 on [a, b", ("IRC010", 1, 15), said="`]`"),
    wrong("boil 3 occurs x", ("IRC010", 1, 15), said="expected a number"),
    wrong("boil 3 label eggs", ("IRC010", 1, 14), said='text in "quotes"'),
    wrong("boil 3 reward 1 reward 2", ("IRC014", 1, 17), said="`reward` appears twice"),
    wrong("boil 3 optional occurs 2", ("IRC014", 1, 17)),
    wrong("boil 3 deadline -5", ("IRC010", 1, 17), said="cannot be negative"),
    wrong('boil 3 after a - "5 min"\na 1', ("IRC010", 1, 18), said="inside"),
    wrong("boil eggs: 3", ("IRC010", 1, 10), said='put the name in "quotes"'),
    wrong("boil (eggs) 3", ("IRC010", 1, 6), said="`(` has no meaning here"),
    wrong("boil 3; bake 4", ("IRC010", 1, 7), said="a line of its own"),
    wrong("boil 1,000 s", ("IRC010", 1, 8), said="no comma"),
    wrong("a 1\nb 1\na -> b 5 min", ("IRC010", 3, 8), said="`+ 5 min`"),
    wrong("-> b", ("IRC010", 1, 1), said="expected a statement"),
    wrong("boil 3 mode fast", ("IRC010", 1, 13), said="mode 'fast' has no duration"),
    wrong("boil " + "9" * 50, ("IRC104", 1, 6), said="40 digits"),
    wrong("boil 3 cost " + "9" * 2000, ("IRC005", 1, 13), said="out of range"),
    wrong("task a\ntask b\nx 1", ("IRC014", 2, 1), said="`task` appears twice"),
    wrong("minimize cost\nminimize makespan\nx 1", ("IRC014", 2, 1)),
    wrong("minimize makespann\nx 1", ("IRC010", 1, 10), said="`minimize makespan`"),
    wrong("unit min s\nx 1", ("IRC010", 1, 10), said="end of the statement"),
    wrong("unit fortnight\nx 1", ("IRC104", 1, 6), said="unknown time unit"),
    wrong("irc 2\nx 1", ("IRC103", 1, 5)),
    wrong("origin tomorrow\nx 1", ("IRC010", 1, 8)),
    wrong('origin "tomorrow"\nx 1', ("IRC104", 1, 8)),
    wrong("days per month 40\nx 1", ("IRC103", 1, 16)),
    wrong("resource a\npool p q, a\nx 1 on p", ("IRC010", 2, 9), said="expected `=`"),
    wrong("resource a, p\npool p = a\nx 1 on p, a", ("IRC018", 2, 6), said="of a resource"),
    wrong("resource a, b\npool p = a\npool p = b\nx 1 on p", ("IRC018", 3, 6)),
    wrong("resource a\npool p = a, b\nx 1 on a", ("IRC201", 2, 13), said="'b'"),
    wrong("resource r, s = a, b\nx 1", ("IRC018", 1, 10), said="one name"),
    wrong("resource a capacity 1 during 5 ..\nx 1", ("IRC010", 1, 23), said="only one end"),
    wrong("stock a within ..\nx 1", ("IRC010", 1, 9)),
    wrong("metadata", ("IRC010", 1, 8), said="braces"),
    wrong('metadata {"a": 1,}\nx 1', ("IRC002", 1, 17), said="comma"),
    wrong('metadata {\n  "a": 1,\n  "a": 2\n}\nx 1', ("IRC004", 3, 3)),
    wrong('metadata {"a": 1} b\nx 1', ("IRC010", 1, 19)),
    wrong('metadata {"a": [1, 2\nx 1', ("IRC002", 1, 20), said="cut off"),
    wrong("metadata " + '{"a":' * 100 + "1" + "}" * 100 + "\nx 1", ("IRC006", 1, 330)),
]

TEXTS = [
    wrong('task "a\nx 1', ("IRC011", 1, 6), said="not closed"),
    wrong('x 1 label "a\\x"', ("IRC011", 1, 13), said="escape"),
    wrong('x 1 label "a\tb"', ("IRC011", 1, 13), said="\\t"),
    wrong('x 1 label "\\ud800"', ("IRC011", 1, 11), said="half a character"),
    wrong("task 'a'\nx 1", ("IRC010", 1, 6), said='"double quotes"'),
    wrong("boil \x00 3", ("IRC010", 1, 6), said="U+0000"),
    wrong("boil eggs} 3", ("IRC016", 1, 10), said="brace"),
    wrong("", ("IRC010", 1, 1), said="empty"),
    wrong("# nothing\n", ("IRC010", 1, 1), said="no statement"),
]

BLOCKS = [
    wrong("x 1\n  y 2\nz 3", ("IRC012", 2, 3), said="does not continue"),
    wrong("x 1\n  onn r\nz 3", ("IRC012", 2, 3), said="does not continue"),
    wrong("for a in b:\n    x {a} 1\n  y 2", ("IRC012", 3, 3), said="no statement above this line"),
    wrong("for a in b:\n\tx {a} 1\n    y {a} 2", ("IRC012", 3, 5), said="tabs and spaces"),
    wrong("  x 1", ("IRC012", 1, 3), said="remove the spaces"),
    wrong("for a in b\nx 1", ("IRC010", 1, 10), said="`:`"),
    wrong("for a b: x 1", ("IRC010", 1, 7), said="`in`"),
    wrong("for a in b:\nx 1", ("IRC010", 1, 11), said="is empty"),
    wrong("for a in b: x {c} 1", ("IRC016", 1, 15), said="no `for c`"),
    wrong("for item in b: x {itm} 1", ("IRC016", 1, 18), said="`item`"),
    wrong("for a in b: x {a + 1} 1", ("IRC016", 1, 15), said="reckon"),
    wrong("for a in b: x {a *} 1", ("IRC016", 1, 15), said="not filled in"),
    wrong("for a in b: for a in c: x {a} 1", ("IRC016", 1, 17), said="around this one"),
    wrong("for a in 3 .. 1: x {a} 1", ("IRC106", 1, 10), said="empty"),
    wrong("for a in []: x {a} 1\ny {a} 1", ("IRC016", 2, 3), said="no `for a`"),
    wrong('for a in "", b: {a} 1', ("IRC016", 1, 17), said="stands for nothing"),
    wrong("for a in b, x: y {a} min", ("IRC016", 1, 18), said="not a time"),
    wrong("for a in b: task {a}", ("IRC010", 1, 13), said="cannot stand in a `for`"),
    wrong("for a in b: metadata {}", ("IRC010", 1, 13)),
    wrong("x {a} 1", ("IRC016", 1, 3), said="only in a `for`"),
    wrong("for a in 1 .. 2: x {a} 1 onn b", ("IRC010", 1, 26), said="`on`"),
    wrong("event 3: cancel a\na 1", ("IRC010", 1, 8), said="expected `at`"),
    wrong("a 1\nevent at 3: cancl a", ("IRC010", 2, 13), said="`cancel`"),
    wrong("a 1\nevent at 3: set deadline = b", ("IRC010", 2, 28), said="`none`"),
    wrong("a 1\nevent at 3: add b 1 after a", ("IRC010", 2, 21), said="a change of its own"),
    wrong("a 1\nb 1\nevent at 3: remove a -> b + 1", ("IRC010", 3, 20), said="every order"),
    wrong("a 1\nevent at 3:\n  add:\n    b 1\n    resource r", ("IRC010", 3, 3), said="one kind"),
    wrong("a 1\nevent at 3:\n  add:\n    goal a", ("IRC010", 4, 5), said="cannot be added"),
    wrong("a 1\nevent at 3:\n  remove:\n    b 1", ("IRC010", 4, 5), said="only an order"),
    wrong("a 1\nevent at 3: set state s = b at end", ("IRC010", 2, 29), said="remove it"),
]

CHECKS = [
    wrong("resource grill\nboil 3 on gril", ("IRC201", 2, 11), said="`grill`"),
    wrong("resource grill\nboil 3 on grill * 2", ("IRC304", 2, 8)),
    wrong("grill patty 3\nstack 1 after patty", ("IRC201", 2, 15), said="'patty'"),
    wrong("a 1\na -> a", ("IRC204", 2, 1)),
    wrong("a 1\nb 1\na -> b -> a", ("IRC301", 3, 6)),
    wrong("a 10 deadline 5", ("IRC302", 1, 15)),
    wrong("a 10\ndeadline 5", ("IRC303", 2, 10)),
    wrong("state s = x, y initial z\na 1", ("IRC210", 1, 24)),
    wrong("state s = x, y\na 1", ("IRC211", 1, 7)),
    wrong("state s\na 1 needs s = x", ("IRC210", 2, 15)),
    wrong("state s\na 1 sets t", ("IRC201", 2, 10)),
    wrong("stock flour\na 1 on flour", ("IRC207", 2, 8)),
    wrong("a 1\na 2", ("IRC202", 2, 1)),
    wrong("group g = a, b\na 1", ("IRC201", 1, 14)),
    wrong("a 1\ngoal b", ("IRC201", 2, 6)),
    wrong("a 1 on []", ("IRC205", 1, 8)),
    wrong("a 5 .. 3", ("IRC106", 1, 3)),
    wrong('a "-3"', ("IRC105", 1, 3)),
    wrong("a 3 lightyears", ("IRC010", 1, 1)),
    wrong('a "3 lightyears"', ("IRC104", 1, 3)),
    wrong("a 1\nevent at 3: set duration of b = 2", ("IRC201", 2, 29)),
    wrong("a 1\nevent at 3: add b -> a", ("IRC201", 2, 17)),
    wrong(
        "resource a, b capacity 1 during 0 .. 9 capacity 2 during 5 .. 12\nx 1 on a, b",
        ("IRC213", 1, 40),
        ("IRC213", 1, 40),
    ),
    wrong("for i in 1 .. 2: x {i} 1 on r", ("IRC201", 1, 29), ("IRC201", 1, 29)),
    wrong("a 1 after b .. 3", ("IRC201", 1, 11)),
]


@pytest.mark.parametrize("case", [*STATEMENTS, *TEXTS, *BLOCKS, *CHECKS], ids=lambda c: c.text[:40])
def test_each_fault_is_told_at_its_place(case: Wrong) -> None:
    report = told(case.text)
    assert errors(report) == list(case.errors), report.render()
    words = " ".join(f"{d.message} {d.hint}" for d in report)
    assert case.said in words, words
    assert not TOKEN_NAMES.search(words), words


FIVE = """\
task "five mistakes"
resource grill, board
grill patty 10s onn grill
cut onion 3s on bord
fry onion 8s after "cut onion
deadline soon
for item in a, b: cut {itm} 3s
serve 2s after cut onion
"""


def test_a_text_with_five_mistakes_is_told_five() -> None:
    expected = [
        ("IRC010", 3, 17),
        ("IRC201", 4, 17),
        ("IRC011", 5, 20),
        ("IRC010", 6, 10),
        ("IRC016", 7, 23),
    ]
    assert errors(told(FIVE)) == expected


def test_a_name_that_a_faulty_statement_declares_is_not_called_unknown() -> None:
    assert errors(told("boil eggs 3 onn stove\neat 1 after boil eggs")) == [("IRC010", 1, 13)]
    assert errors(told("resource grill capacity x\nfry 1 on grill")) == [("IRC010", 1, 25)]
    assert errors(told("for x a, b: cut {x} 1\neat 1 after cut a")) == [("IRC010", 1, 7)]


def test_faults_of_a_repeated_statement_are_told_once() -> None:
    text = "for i in 1 .. 100:\n    x {i} 1 onn r\n    y {i} 1 afer x"
    assert errors(told(text)) == [("IRC010", 2, 13), ("IRC010", 3, 13)]


def test_a_fault_in_an_event_leaves_its_other_changes_checked() -> None:
    text = "a 1\nevent at 3:\n    cancl a\n    cancel b\nevent at x:\n    cancel a"
    assert errors(told(text)) == [("IRC010", 3, 5), ("IRC201", 4, 12), ("IRC010", 5, 10)]


# --- whole files --------------------------------------------------------------------------------


def checked(folder: Path, content: bytes | str) -> Report:
    path = folder / "task.irc"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return irc.check(path)


def test_a_binary_file_is_told_at_its_first_bad_byte(tmp_path: Path) -> None:
    report = checked(tmp_path, b"boil 3\n\x89PNG\r\n" + bytes(range(256)))
    assert errors(report) == [("IRC001", 2, 1)]


def test_line_ends_of_windows_are_read(tmp_path: Path) -> None:
    report = checked(tmp_path, 'task "a"\r\nboil 3\r\n\r\nbake 4 after boil\r\n  deadline 20\r\n')
    assert list(report) == []
    assert irc.load(tmp_path / "task.irc").ir.actions[1].deadline == 20


def test_a_byte_order_mark_is_noted(tmp_path: Path) -> None:
    report = checked(tmp_path, "\ufeffboil 3")
    assert [(d.code.id, d.line, d.column) for d in report.located()] == [("IRC007", 1, 1)]


LONG = 120_000


@pytest.mark.slow
@pytest.mark.parametrize(
    "line",
    [
        "x" * LONG,
        "x " * (LONG // 2),
        '"' + "x" * LONG,
        "boil 3 after " + "a, " * (LONG // 30) + "a",
        "boil " + "9" * LONG,
        "1 h " * (LONG // 4),
        "{" * LONG,
        "[" * LONG,
        "a -> " * (LONG // 50) + "a",
        "#" * LONG,
        "\t" * LONG + "x 1",
        "boil 3 " + "on a " * (LONG // 50),
        'metadata {"a": ' + "[" * LONG,
        "x-" * (LONG // 2),
        "P1D" * (LONG // 3),
        "{x}" * (LONG // 3) + " 3",
    ],
    ids=lambda line: line[:14],
)
def test_a_very_long_line_is_read_or_refused_in_seconds(tmp_path: Path, line: str) -> None:
    began = time.process_time()
    report = checked(tmp_path, f"{line}\nlast 1 onn x\n")
    assert time.process_time() - began < 8
    assert ("IRC010", 2, 8) in errors(report)


@pytest.mark.slow
def test_rubbish_is_given_up_after_many_faults() -> None:
    began = time.process_time()
    report = told("boil 3 onn x\n" * 40_000)
    assert len(report.errors) == reader.MAX_FAULTS + 1
    assert report.errors[-1].code.id == "IRC006"
    assert time.process_time() - began < 20


def test_deep_blocks_are_refused() -> None:
    deep = "".join(f"{'  ' * i}for a{i} in x:\n" for i in range(100)) + "  " * 100 + "b 1"
    assert [code for code, *_ in errors(told(deep))] == ["IRC006"]


def test_deep_inline_blocks_are_refused_or_read() -> None:
    deep = "".join(f"for a{i} in x: " for i in range(2000)) + "b 1"
    assert [code for code, *_ in errors(told(deep))] == ["IRC006"]


@pytest.mark.parametrize(
    "text",
    [
        "for a in 1 .. 9999:\n  for b in 1 .. 9999:\n    for c in 1 .. 9999: x {a} {b} {c} 1",
        "for a in 1 .. 99999999: x {a} 1",
        f"for a in 1 .. {'9' * 30}: x {{a}} 1",
        "for a in 1 .. 2000: for b in 1 .. 2000: x {a} {b} 1",
    ],
)
def test_a_for_that_makes_millions_is_told_at_once(text: str) -> None:
    began = time.process_time()
    report = told(text)
    assert [(code, line) for code, line, _ in errors(report)] in (
        [("IRC017", 1)],
        [("IRC005", 1)],
    )
    assert time.process_time() - began < 3


def test_a_for_whose_end_depends_on_another_is_bounded_too(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(document_parts.ExpansionLimit, "__init__", limited(100, 1000))
    report = told("for a in 1 .. 20:\n  for b in 1 .. {a}: x {a} {b} 1")
    assert errors(report) == [("IRC017", 2, 3)]


def test_arrows_and_pools_are_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(document_parts.ExpansionLimit, "__init__", limited(100, 50))
    many = ", ".join(f"a{i}" for i in range(10))
    assert errors(told(f"{many} -> {many}")) == [("IRC017", 1, 1)]
    uses = "".join(f"x{i} 1 by p\n" for i in range(6))
    report = told(f"resource p = {many}\n{uses}")
    assert errors(report)[0] == ("IRC017", 1, 10)


def test_the_text_that_a_for_repeats_is_bounded() -> None:
    braces = " ".join("{i}" for _ in range(200))
    assert errors(told(f"for i in 1 .. 90000:\n  a {braces} 1")) == [("IRC017", 1, 1)]


def limited(statements: int, parts: int) -> Callable[[document_parts.ExpansionLimit], None]:
    """An `__init__` with other limits."""

    def init(limit: document_parts.ExpansionLimit) -> None:
        limit.statements, limit.parts, limit.text = statements, parts, 10_000

    return init


PIECES = st.sampled_from(
    [
        *("boil", "3", "on", "\n", "    ", "\t", "for", "x", "in", ":", "{x}", '"', "->", ",", "["),
        *("]", "event", "at", "add", "set deadline", "=", "resource", "capacity", "..", "#", "+"),
        *("metadata", "{", "}", "min", "\r\n", "after", "group", "mode", "-", "pool", "\x00", "é"),
    ]
)


@pytest.mark.slow
@settings(max_examples=250)
@given(st.lists(PIECES, max_size=40))
def test_no_text_ends_in_a_traceback(pieces: list[str]) -> None:
    text = " ".join(pieces)
    report = told(text)
    for d in report.located():
        assert d.line is not None
        assert not TOKEN_NAMES.search(f"{d.message} {d.hint}"), d
    if all(d.severity is not Severity.ERROR for d in report):
        assert parse_task(text, "task.irc").task is not None


@pytest.mark.slow
@settings(max_examples=150)
@given(st.text(max_size=80))
def test_no_characters_end_in_a_traceback(text: str) -> None:
    told(text).located()
