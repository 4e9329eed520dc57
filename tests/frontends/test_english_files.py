"""Texts in English through files, standard input and the commands; bad and hostile input."""

from __future__ import annotations

import json
import random
import time
from pathlib import Path

import pytest

import irc
from english_texts import first_error, order
from runs import run_irc

QUESTION = """\
To make tea, here are the steps needed.
Step 1. Boil the water (5 minutes)
Step 2. Warm the pot (1 minute)
Step 3. Brew (4 minutes)

These ordering constraints need to be obeyed when executing above steps:
Step 1 must precede Step 2 and 3.
Step 2 must precede Step 3.

Question: Assume that you need to execute all the steps to complete the task and that infinite \
resources are available. What is the shortest possible time to make tea?
"""

SECONDS = 20
"""What a hostile text may take: a second or two, and patience with a busy machine."""


@pytest.mark.parametrize("name", ["question.txt", "question.md", "question"])
def test_a_question_is_solved_from_a_file(name: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(QUESTION, encoding="utf-8")
    assert irc.solve(tmp_path / name).makespan == 600


@pytest.mark.slow
def test_a_question_is_solved_from_standard_input() -> None:
    result = run_irc("solve", "-", "--format", "json", stdin=QUESTION)
    assert json.loads(result.stdout)["makespan"] == 600


def test_a_question_becomes_json_that_means_the_same(tmp_path: Path) -> None:
    (tmp_path / "tea.txt").write_text(QUESTION, encoding="utf-8")
    out = tmp_path / "tea.json"
    result = run_irc("convert", tmp_path / "tea.txt", "-o", out)
    assert result.exit_code == 0
    assert irc.load(out).ir == irc.loads(QUESTION).ir
    assert irc.load(out).ir.name == "make tea"


def test_a_question_is_compiled_for_a_planner(tmp_path: Path) -> None:
    (tmp_path / "tea.txt").write_text(QUESTION, encoding="utf-8")
    assert "step3" in irc.compile(tmp_path / "tea.txt", "pddl21").files["domain.pddl"]


def test_a_json_answer_in_a_text_counts_as_ever() -> None:
    text = QUESTION + '\n```json\n{"actions": [{"id": "a", "duration": 7}]}\n```\n'
    assert irc.solve(irc.loads(text)).makespan == 7


def test_findings_of_the_checks_stand_in_the_text() -> None:
    text = QUESTION.replace("Step 2 must precede Step 3.", "Step 3 must precede Step 1.")
    found = [d for d in irc.check(irc.loads(text)).located() if d.code.id == "IRC301"]
    assert [(d.line, d.column) for d in found][:1] in ([(7, 1)], [(8, 1)])


def test_a_step_before_itself_is_told_at_its_sentence() -> None:
    text = QUESTION.replace("Step 2 must precede Step 3.", "Step 3 must precede Step 3.")
    found = [d for d in irc.check(irc.loads(text)).located() if d.code.id == "IRC204"]
    assert [d.line for d in found] == [8]


def test_a_month_has_the_days_of_the_ir() -> None:
    task = irc.loads("Step 1. Wait for the letter (1 month)").ir
    assert (task.days_per_month, irc.solve(task).makespan) == (30, 30 * 86_400)


@pytest.mark.slow
def test_the_answer_may_be_asked_for_in_a_unit() -> None:
    text = QUESTION + "Give your answer in minutes.\n"
    assert irc.solve(irc.loads(text)).makespan == 10


def test_line_ends_of_windows_and_a_byte_order_mark_change_nothing() -> None:
    assert irc.loads("\ufeff" + QUESTION.replace("\n", "\r\n")).ir == irc.loads(QUESTION).ir


def large(count: int, orders: int) -> str:
    rng = random.Random(7)
    steps = [f"Step {i}. Do the thing ({rng.randint(1, 50)} minutes)" for i in range(1, count + 1)]
    pairs = (sorted(rng.sample(range(1, count + 1), 2)) for _ in range(orders))
    told = [f"Step {a} must precede Step {b}." for a, b in pairs]
    return "\n".join([*steps, "", "These ordering constraints need to be obeyed:", *told])


@pytest.mark.slow
def test_time_grows_with_the_length_of_the_text() -> None:
    irc.loads(QUESTION)
    began = time.process_time()
    irc.loads(large(500, 1500))
    small = time.process_time() - began
    began = time.process_time()
    task = irc.loads(large(2000, 6000)).ir
    assert len(task.precedence) == 6000
    assert time.process_time() - began < 10 * small + 1


ONE = "Step 1. Boil (5 min)\n\n"

HOSTILE = {
    "one line of a megabyte": (ONE + "Step 1 must precede step " + "1, " * 330_000, "IRC020"),
    "parentheses": (ONE + "(" * 1_000_000, "IRC020"),
    "quotes": (ONE + '"' * 1_000_000, "IRC020"),
    "words without end": (ONE + "to bake for to " * 60_000, "IRC020"),
    "a list of conjunctions": (ONE + "step 1 and " * 70 + "step 1 must precede step 1", "IRC020"),
    "unknown lines": (ONE + "foo bar\n" * 20_000, "IRC020"),
    "a huge number": (f"Step 1. Boil ({'9' * 5000} minutes)", "IRC025"),
    "a fraction by zero": ("Step 1. Boil (1/0 minutes)", "IRC020"),
    "other digits": (ONE + "Step １ must precede step ٣.", "IRC020"),
    "control characters": (ONE + "\x00\x01\u202e\u200b", "IRC020"),
    "too long a text": ("Step 1. Boil (5 min)\n" + "x y. " * 5_000_000, "IRC006"),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_text_is_refused_without_a_wait(name: str) -> None:
    text, code = HOSTILE[name]
    began = time.process_time()
    assert first_error(text)[0] == code
    assert time.process_time() - began < SECONDS


def test_more_precedences_than_a_task_may_have_are_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from irc.frontends.english import assembly, references

    for module in (assembly, references):
        monkeypatch.setattr(module, "MOST_EDGES", 10_000)
    steps = "\n".join(f"Step {i}. X (1 s)" for i in range(1, 121))
    sentence = "Steps 1 to 60 must precede steps 61 to 120.\n"
    assert irc.loads(f"{steps}\n\n{sentence * 2}").ir.actions
    assert first_error(f"{steps}\n\n{sentence * 3}")[0] == "IRC006"


def test_binary_files_are_refused_at_the_first_bad_byte(tmp_path: Path) -> None:
    (tmp_path / "x.txt").write_bytes(b"Step 1.\n\x80\xff\x00")
    (found,) = irc.check(tmp_path / "x.txt").located()
    assert (found.code.id, found.line, found.column) == ("IRC001", 2, 1)


def test_a_text_file_without_steps_is_told_so(tmp_path: Path) -> None:
    (tmp_path / "x.txt").write_text("Sorry, I cannot do that.", encoding="utf-8")
    (found,) = irc.check(tmp_path / "x.txt").located()
    assert found.code.id == "IRC029"


def test_two_steps_of_one_number_are_told_at_the_second() -> None:
    assert first_error("Step 1. Boil (5 min)\nStep 1. Fry (5 min)\n") == ("IRC202", 2, 1)


def test_order_of_steps_is_kept() -> None:
    assert order(irc.loads(QUESTION).ir) == "1>2 1>3 2>3"
