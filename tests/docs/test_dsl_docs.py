"""docs/dsl.md: its tasks are good ones, its tables complete."""

from __future__ import annotations

import re

import pytest

from irc.driver.compile import check_task
from irc.frontends.dsl.formatter import formatted
from irc.frontends.dsl.lexer import (
    CHANGE_PHRASES,
    CLAUSE_WORDS,
    PHRASES,
    RULES,
    STATEMENT_WORDS,
    needs_quotes,
)
from irc.frontends.dsl.task import dsl_task
from paths import ROOT

PAGE = (ROOT / "docs" / "dsl.md").read_text("utf-8")
BLOCKS = re.findall(r"(?<!wrong\.irc -->\n)^```irc\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("text", BLOCKS, ids=range(len(BLOCKS)))
def test_each_task_on_the_page_has_no_error(text: str) -> None:
    found = dsl_task(text)
    assert found.task is not None
    assert found.report.ok, found.report.render()
    report = check_task(found.task)
    assert report.ok, report.render()


def test_the_page_has_tasks() -> None:
    assert len(BLOCKS) >= 9


def test_the_words_with_a_meaning_are_all_listed() -> None:
    table = PAGE.split("<!-- words -->")[1]
    rows = [set(re.findall(r"`([^`]+)`", line)) for line in table.splitlines() if "` `" in line]
    phrases = [{" ".join(p) for p in of} for of in (PHRASES, RULES)]
    assert rows == [set(CLAUSE_WORDS), set(STATEMENT_WORDS), *phrases]


@pytest.mark.parametrize("word", sorted(CLAUSE_WORDS | STATEMENT_WORDS))
def test_a_word_with_a_meaning_needs_quotes(word: str) -> None:
    assert needs_quotes(word)
    assert needs_quotes(f"x {word} y") == (word in CLAUSE_WORDS)
    assert not needs_quotes(word.capitalize())


def test_every_change_is_on_the_page() -> None:
    for phrase in CHANGE_PHRASES:
        assert f"`{' '.join(phrase)}" in PAGE or phrase == ("for",)


QUOTED = re.findall(r'^- if .*: `("[^`]+")`[;.]$', PAGE, re.MULTILINE)


def test_the_names_that_the_page_puts_in_quotes_need_them() -> None:
    assert len(QUOTED) == 4
    assert all(needs_quotes(name.strip('"')) for name in QUOTED)


@pytest.mark.parametrize("text", BLOCKS, ids=range(len(BLOCKS)))
def test_the_page_is_laid_out(text: str) -> None:
    assert formatted(text) == text
