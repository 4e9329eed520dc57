"""The layout of texts: comments, blank lines, includes and repetitions stay; so does the task."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import irc
from irc.frontends.dsl.formatter import formatted
from irc.frontends.dsl.reader import read_dsl
from irc.frontends.files import parse_task
from irc.frontends.json.layout import WIDEST, laid_out
from irc.frontends.language import language_of
from oracles.generators import documents
from paths import ROOT
from runs import run_irc

MESSY = """\
\t
task   "rested combo"   # the name
include "kitchen.irc"
# stations
resource   grill ,fryer
resource robots=r1,r2


# steps
grill patty 10s   on grill*2   by robots
cut   onion 3 s   # quick
\tdeadline  40

fry onion 8   ..  12   on fryer after cut onion+3s..2 min ,start of grill patty -5
a→b   ->c
for  item in lettuce ,cucumber :
  # each of them
  cut {item}   3s on board   # by hand
  wash {item}s 10

  for i in 1..3: x {i}{item} 5
event   at 10 :
        set capacity of grill=0 during ..60
        # more
        add:
            y 3
            z 45 min  on fryer
metadata   {"a":1,
      "b": [1.50]
}
"""

TIDY = """\
task "rested combo"  # the name
include "kitchen.irc"
# stations
resource grill, fryer
resource robots = r1, r2


# steps
grill patty 10s on grill * 2 by robots
cut onion 3 s  # quick
    deadline 40

fry onion 8 .. 12 on fryer after cut onion + 3s .. 2 min, start of grill patty - 5
a -> b -> c
for item in lettuce, cucumber:
    # each of them
    cut {item}    3s  on board  # by hand
    wash {item}s  10

    for i in 1 .. 3: x {i}{item} 5
event at 10:
    set capacity of grill = 0 during .. 60
    # more
    add:
        y  3
        z  45 min  on fryer
metadata {"a":1,
      "b": [1.50]
}
"""


def test_a_messy_text_is_laid_out() -> None:
    assert formatted(MESSY) == TIDY


def test_what_is_laid_out_stays_as_it_is() -> None:
    assert formatted(TIDY) == TIDY


def test_neighbouring_actions_stand_in_columns() -> None:
    text = "a 1 on r\nlonger name 10 .. 20 min\nb 2 by x # c\n\nc 3 on r\n"
    assert formatted(text.replace("10 ..", "10 min ..")) == (
        "a            1                 on r\n"
        "longer name  10 min .. 20 min\n"
        "b            2                 by x  # c\n"
        "\n"
        "c 3 on r\n"
    )


def test_changes_of_an_event_are_not_set_in_columns() -> None:
    text = (
        "event at 5:\n"
        "    cancel group order 1\n"
        "    add group g 2 = a\n"
        "    add:\n"
        "        a    3\n"
        "        bcd  4\n"
    )
    assert formatted(text) == text


def test_times_and_texts_stay_as_they_were_written() -> None:
    text = 'a "1 h,  30 min"  label "x\\u00e9  # \\n"\nb 1  h  30   min\n'
    assert '"1 h,  30 min"' in formatted(text)
    assert '"x\\u00e9  # \\n"' in formatted(text)
    assert "1  h  30   min" in formatted(text)


def test_a_text_with_faults_is_refused_with_all_of_them() -> None:
    with pytest.raises(irc.InputError) as caught:
        formatted("boil 3 onn x\ntask 'a'\n")
    assert [d.line for d in caught.value.report.located().errors] == [1, 2]


LINES = st.sampled_from(
    [
        *("boil eggs 10 on stove", "boil  3 min  deadline 5", "a -> b + 3..5", "# note", "", "x 2"),
        *("  # inner", "    y 3 after x - 5", "for i in 1..2: z {i} 3", "resource a ,b capacity 2"),
        *("event e at 5:", "    cancel a", "    set deadline=none", "for j in a, b:", "\t# tab"),
        *("    q {j} 5", "  on stove", "    deadline  4 # end"),
        *("state s=x , y initial x", 'metadata {"a":  [1, 2]}', "x 1 occurs 0..", "goal s=x"),
        *("set = 3", "pool p=a,b", "    add: ", "        w 3", 'task "a  b"', "reward 3 cost -5"),
    ]
)


@pytest.mark.slow
@settings(max_examples=50)
@given(st.lists(LINES, max_size=14))
def test_layout_is_final_and_changes_no_task(lines: list[str]) -> None:
    text = "\n".join(lines)
    try:
        once = formatted(text)
    except irc.InputError:
        return
    assert formatted(once) == once
    assert read_dsl(once).document == read_dsl(text).document
    assert [part for part in once.split() if part.startswith("#")] == [
        part for part in text.split() if part.startswith("#")
    ]


def test_the_examples_are_laid_out() -> None:
    for path in (ROOT / "examples").glob("*.irc"):
        text = path.read_text("utf-8")
        assert formatted(text) == text, path.name


# --- JSON ---------------------------------------------------------------------------------------


@pytest.mark.slow
@settings(max_examples=40)
@given(documents())
def test_the_layout_of_json_is_final_and_keeps_every_word(document: object) -> None:
    text = json.dumps(document)
    once = laid_out(text)
    assert json.loads(once) == document
    assert list(json.loads(once)) == list(json.loads(text))
    assert laid_out(once) == once


def test_numbers_and_escapes_in_json_stay_as_they_were_written() -> None:
    text = '{"actions":[{"id":"caf\\u00e9","duration":1.50},{"id":"b","duration":2E3}]}'
    once = laid_out(text)
    for word in ("1.50", "2E3", '"caf\\u00e9"'):
        assert word in once


def test_what_fits_a_line_of_json_stands_on_one() -> None:
    fits = {"id": "a" * 25, "duration": 3, "uses": [{"resource": "b" * 17}]}
    text = laid_out(json.dumps({"actions": [fits, {**fits, "label": "c"}]}))
    lines = text.split("\n")
    assert f"    {json.dumps(fits)}," in lines
    assert '      "label": "c"' in lines
    assert max(map(len, lines)) <= WIDEST


# --- the command --------------------------------------------------------------------------------


def test_fmt_writes_in_place_and_keeps_the_permissions(tmp_path: Path) -> None:
    path = tmp_path / "task.irc"
    path.write_text("boil   3\n")
    path.chmod(0o600)
    assert run_irc("fmt", path).exit_code == 0
    assert path.read_text() == "boil 3\n"
    assert path.stat().st_mode & 0o777 == 0o600
    assert [p.name for p in tmp_path.iterdir()] == ["task.irc"]


def test_fmt_does_not_touch_what_is_in_order(tmp_path: Path) -> None:
    path = tmp_path / "task.irc"
    path.write_text("boil 3\n")
    before = path.stat().st_mtime_ns
    assert run_irc("fmt", path).exit_code == 0
    assert path.stat().st_mtime_ns == before


def test_fmt_check_only_looks(tmp_path: Path) -> None:
    path = tmp_path / "task.irc"
    path.write_text("boil   3\n")
    assert run_irc("fmt", path, "--check").exit_code == 1
    assert path.read_text() == "boil   3\n"
    path.write_text("boil 3\n")
    assert run_irc("fmt", "--check", path).exit_code == 0


def test_fmt_of_standard_input_goes_to_standard_output() -> None:
    assert run_irc("fmt", "-", stdin="boil   3").stdout == "boil 3\n"
    assert run_irc("fmt", "-", stdin='{"actions":[]}').stdout == '{\n  "actions": []\n}\n'


def test_fmt_refuses_what_it_would_lose(tmp_path: Path) -> None:
    path = tmp_path / "answer.json"
    path.write_text('Here you are: {"actions": []}')
    assert run_irc("fmt", path).exit_code == 1
    assert path.read_text() == 'Here you are: {"actions": []}'
    path.write_text("not JSON")
    assert run_irc("fmt", path).exit_code == 1
    (tmp_path / "bad.irc").write_text("boil 3 onn")
    assert run_irc("fmt", tmp_path / "bad.irc").exit_code == 1
    assert (tmp_path / "bad.irc").read_text() == "boil 3 onn"


def test_convert_writes_what_the_suffix_says(tmp_path: Path) -> None:
    task = ROOT / "examples" / "robot_team.json"
    assert run_irc("convert", task, "-o", tmp_path / "a.irc").exit_code == 0
    assert run_irc("convert", tmp_path / "a.irc", "-o", tmp_path / "b.json").exit_code == 0
    assert (tmp_path / "a.irc").read_text("utf-8").startswith("task ")
    assert irc.load(tmp_path / "b.json").ir == irc.load(tmp_path / "a.irc").ir == irc.load(task).ir


# --- which language -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "name", "language"),
    [
        ("boil 3", "a.irc", "dsl"),
        ('{"actions": []}', "a.irc", "dsl"),
        ("boil 3", "a.json", "json"),
        ("boil 3", "-", "dsl"),
        ('\ufeff {"actions": []}', "<stdin>", "json"),
        ('Sure! ```json\n{"actions": [] }\n```', "a.txt", "json"),
        ('# kitchen\ntask "a"\nboil 3\n', "a.txt", "dsl"),
        ("oops\nboil 3 on stove\n", "<text>", "dsl"),
        ("Sorry, I cannot do that.", "<text>", "json"),
        ('boil 3\nmetadata {"ticket": 3}', "<text>", "dsl"),
        ("", "<text>", "json"),
    ],
)
def test_the_language_of_a_text(text: str, name: str, language: str) -> None:
    assert language_of(text, name) == language


@pytest.mark.slow
def test_every_command_and_call_takes_the_dsl(tmp_path: Path) -> None:
    path = tmp_path / "task.irc"
    path.write_text("resource pot\nboil 3 min on pot\neat 5 after boil\n")
    assert irc.load(path).ir == irc.loads(path.read_text()).ir
    assert parse_task(path.read_text(), "x.irc").task == irc.load(path).ir
    assert irc.solve(path).makespan == 185
    assert run_irc("check", path).exit_code == 0
    assert run_irc("targets", path).exit_code == 0
    assert run_irc("compile", path, "-t", "pddl21").exit_code == 0
    assert run_irc("solve", path, "-o", tmp_path / "s.json").exit_code == 0
    assert run_irc("validate", path, tmp_path / "s.json").exit_code == 0
    assert run_irc("solve", "-", stdin=path.read_text()).exit_code == 0
