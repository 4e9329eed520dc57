"""The glossary: in order, each term once, and every public name in it."""

from __future__ import annotations

import re

import pytest

import irc
from irc.schedule import Status
from paths import ROOT

PAGE = (ROOT / "docs" / "glossary.md").read_text("utf-8")
ENTRIES = re.findall(r"^\*\*([^*]+)\*\*: (.+?)\n(?:\n|\Z)", PAGE, re.MULTILINE | re.DOTALL)
TERMS = [term for term, _ in ENTRIES]


def in_order(term: str) -> str:
    """What a term is sorted by: letters, digits and spaces alone."""
    return re.sub(r"[^a-z0-9 ]", "", term.lower())


def words_of(name: str) -> str:
    """A class name as a term: "ObjectiveValue" → "objective value"."""
    parts = re.findall(r"[A-Z]+(?![a-z])|[A-Z][a-z0-9]+", name)
    return " ".join(parts).lower()


def test_terms_stand_in_alphabetical_order_and_once() -> None:
    assert len(TERMS) > 100
    assert sorted({*TERMS}, key=in_order) == TERMS


def test_every_paragraph_is_an_entry() -> None:
    paragraphs = [p for p in PAGE.split("\n\n") if p.strip()]
    assert len(paragraphs) == len(ENTRIES) + 2  # the heading and the introduction


def test_every_entry_is_a_sentence() -> None:
    assert [term for term, text in ENTRIES if not text.endswith(".")] == []


def test_a_term_in_bold_within_an_entry_is_one_of_its_own_or_defined_there() -> None:
    terms = {term.lower() for term in TERMS}
    defined_within = {"critical", "lexicographic", "minimal", "type"}
    bold = {b for _, text in ENTRIES for b in re.findall(r"\*\*([^*]+)\*\*", text)}
    assert bold - terms == defined_within


@pytest.mark.parametrize(
    "name",
    [
        n
        for n in sorted(irc.__all__)
        if n[0].isupper() and not issubclass(getattr(irc, n), Exception)
    ],
)
def test_a_public_class_is_in_the_glossary(name: str) -> None:
    terms = {term.lower() for term in TERMS}
    assert {words_of(name), f"{words_of(name)}s"} & terms


@pytest.mark.parametrize("status", ["abandoned", "cancelled", "infeasible", "optimal"])
def test_a_status_that_needs_a_proof_or_a_history_is_in_the_glossary(status: str) -> None:
    assert status in TERMS
    assert status in {*map(str, Status), "abandoned", "cancelled"}
