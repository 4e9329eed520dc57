"""Positions of the protocol are converted exactly, in every encoding."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from irc.lsp.documents import Change, Documents
from irc.lsp.positions import Encoding, Lines

TEXT = "a𝄞é\r\nüb\rc\u2028d\x0be\n"
"""A character beyond the basic plane, all three line ends, and two that end no line."""

TEXTS = st.text(alphabet=st.sampled_from("ab é𝄞\r\n\u2028\x0b\x85\ufeff"), max_size=40)
ENCODINGS = st.sampled_from(list(Encoding))


@pytest.mark.parametrize(
    ("encoding", "column"), [(Encoding.UTF_8, 5), (Encoding.UTF_16, 3), (Encoding.UTF_32, 2)]
)
def test_columns_count_the_units_of_the_encoding(encoding: Encoding, column: int) -> None:
    lines = Lines(TEXT, encoding)
    assert lines.place(TEXT.index("é")) == (0, column)
    assert lines.offset(0, column) == TEXT.index("é")


def test_only_line_ends_of_the_protocol_end_a_line() -> None:
    lines = Lines(TEXT, Encoding.UTF_16)
    assert lines.place(TEXT.index("c")) == (2, 0)
    assert lines.place(TEXT.index("e")) == (2, 4)
    assert len(lines.starts) == 4


def test_a_column_inside_of_a_character_means_its_beginning() -> None:
    assert Lines("𝄞x", Encoding.UTF_16).offset(0, 1) == 0
    assert Lines("éx", Encoding.UTF_8).offset(0, 1) == 0


def test_a_column_behind_its_line_means_the_end_of_that() -> None:
    lines = Lines("ab\r\ncd", Encoding.UTF_16)
    assert lines.offset(0, 99) == 2
    assert lines.offset(99, 0) == 6
    assert lines.offset(-1, -5) == 0


@pytest.mark.slow
@given(TEXTS, ENCODINGS, st.data())
def test_every_place_leads_back(text: str, encoding: Encoding, data: st.DataObject) -> None:
    lines = Lines(text, encoding)
    offset = data.draw(st.integers(0, len(text)))
    back = lines.offset(*lines.place(offset))
    assert back == offset or text[back:offset] == "\r"  # Between the halves of a line end.


def _units(text: str, encoding: Encoding) -> int:
    width = {"utf-8": 1, "utf-16": 2, "utf-32": 4}[encoding]
    return len(text.encode(f"{encoding}-le" if encoding != "utf-8" else "utf-8")) // width


@pytest.mark.slow
@given(TEXTS, TEXTS, ENCODINGS, st.data())
def test_an_edit_changes_what_it_names_and_nothing_else(
    text: str, new: str, encoding: Encoding, data: st.DataObject
) -> None:
    """Against positions that the test works out by itself, from the protocol's words."""
    start = data.draw(st.integers(0, len(text)))
    end = data.draw(st.integers(start, len(text)))

    def place(offset: int) -> tuple[int, int]:
        before = text[:offset]
        ends = before.replace("\r\n", "\n\n").replace("\r", "\n")
        line = before.replace("\r\n", "\n").replace("\r", "\n").count("\n")
        return line, _units(before[ends.rfind("\n") + 1 :], encoding)

    if text[start - 1 : start + 1] == "\r\n" or text[end - 1 : end + 1] == "\r\n":
        return  # There is no position between the two.
    documents = Documents()
    documents.encoding = encoding
    documents.open("u", 1, text, None)
    changed = documents.change("u", 2, [Change(new, place(start), place(end))])
    assert changed is not None
    assert changed.text == text[:start] + new + text[end:]


def test_halves_of_a_character_that_come_together_are_one() -> None:
    documents = Documents()
    documents.open("u", 1, "a\ud834b", None)
    changed = documents.change("u", 2, [Change("\udd1e", (0, 2), (0, 2))])
    assert changed is not None
    assert changed.text == "a𝄞b"


def test_a_change_of_a_text_that_is_not_open_does_nothing() -> None:
    assert Documents().change("u", 2, [Change("x")]) is None
