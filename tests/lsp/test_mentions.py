"""Every name in a document is found where it stands: what editors jump to and rename."""

from __future__ import annotations

from typing import Any

from irc.frontends.dsl.reader import read_dsl
from irc.lsp.mentions import mentions
from oracles.everything import EVERYTHING


def _at(document: Any, pointer: tuple[str | int, ...]) -> Any:
    for key in pointer:
        document = document[key]
    return document


def test_each_mention_stands_at_its_pointer() -> None:
    found = list(mentions(EVERYTHING))
    assert all(_at(EVERYTHING, m.pointer) == m.name for m in found if m.kind != "value")
    kinds = {
        (m.kind.value, m.pointer[0])
        for m in found
        if m.pointer[0] in ("couplings", "select", "sequences")
    }
    assert kinds == {
        ("action", "couplings"),
        ("resource", "couplings"),
        ("action", "select"),
        ("group", "select"),
        ("action", "sequences"),
        ("resource", "sequences"),
    }


def test_the_names_of_rules_have_their_places_in_a_text() -> None:
    text = "resource m, n\na 1 on m\nb 1 on n\n" + "same order on m, n jobs [a, a], [b, b]\n"
    text += "if a on m then b on n\nselect 1 of a, b if a\nconsecutive a, b\n"
    reading = read_dsl(text)
    assert not reading.faults
    found = list(mentions(reading.document))
    places = reading.source.locate([mention.pointer for mention in found])
    for mention in found:
        place = places[mention.pointer]
        assert place is not None, mention
        assert text[place.start : place.end] == mention.name
