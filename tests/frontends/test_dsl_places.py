"""Every part of a document is found at the words of the text that state it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from hypothesis import given, settings

from irc.diagnostics.source import Pointer
from irc.frontends.dsl import written
from irc.frontends.dsl.printer import print_task
from irc.frontends.dsl.reader import DslReading, read_dsl
from irc.model import Task
from oracles.everything import EVERYTHING
from oracles.generators import tasks

UNSAID = {("op",), ("kind",), ("type",)}
"""What is stated by the kind of the statement."""


def leaves(node: Any, at: Pointer = ()) -> Iterator[tuple[Pointer, Any]]:
    """The texts and numbers of a document, free-form data left out."""
    if isinstance(node, dict):
        for key, value in node.items():
            if at or key != "metadata":
                yield from leaves(value, (*at, key))
    elif isinstance(node, list):
        for i, value in enumerate(node):
            yield from leaves(value, (*at, i))
    else:
        yield at, node


def text_at(reading: DslReading, pointer: Pointer) -> str:
    place = reading.source.locate([pointer])[pointer]
    assert place is not None, pointer
    return reading.source.text[place.start : place.end]


def said(value: Any) -> set[str]:
    """How a value may stand in a text."""
    if isinstance(value, bool):
        return {str(value).lower(), "optional"}
    if isinstance(value, int):
        return {str(value), written.quoted(str(value))}
    return {str(value), written.quoted(str(value)), written.name(str(value))}


def misplaced(reading: DslReading) -> list[tuple[Pointer, Any, str]]:
    """The names and numbers whose places hold something else."""
    found = []
    for pointer, value in leaves(reading.document):
        field = next(part for part in reversed(pointer) if isinstance(part, str))
        if (
            (field,) in UNSAID
            or field
            in ("at", "objective", "one_of", "status", "value", "days", "breaks", "no_idle")
            or "occurs" in pointer
            or not {"lapsed", "couplings", "select", "objective", "add"}.isdisjoint(pointer)
        ):
            continue  # Said in other words, by a default, by the name of a pool, or as JSON.
        text = text_at(reading, pointer).replace("- ", "-")
        if value is not None and text not in said(value):
            found.append((pointer, value, text))
    return found


@pytest.mark.slow
def test_all_parts_of_a_task_with_every_field_are_found() -> None:
    assert misplaced(read_dsl(print_task(Task.model_validate(EVERYTHING)))) == []


@pytest.mark.slow
@settings(max_examples=4)
@given(tasks())
def test_all_parts_of_any_task_are_found(task: Task) -> None:
    assert misplaced(read_dsl(print_task(task))) == []


TEXT = """\
resource oven, grill
resource robots = r1, r2
bake bread 10 min on oven * 2 by robots, grill weight 3  # why
for i in 1 .. 3: step {i} 5 after bake bread + 3 .. 5
a, b -> c
"""


def place(pointer: Pointer, *, key: bool = False) -> str:
    reading = read_dsl(TEXT)
    found = reading.source.locate([pointer])[pointer]
    assert found is not None
    start = found.key_start if key else found.start
    assert start is not None
    return reading.source.text[start : found.end]


def test_parts_of_plain_statements_are_found_too() -> None:
    assert place(("resources", 3, "id")) == "r2"
    assert place(("actions", 0, "id")) == "bake bread"
    assert place(("actions", 0, "duration")) == "10 min"
    assert place(("actions", 0, "uses", 0, "amount")) == "2"
    assert place(("actions", 0, "uses", 1, "one_of", 1)) == "robots"
    assert place(("actions", 0, "uses", 2, "resource")) == "grill"
    assert place(("actions", 0, "weight"), key=True) == "weight 3"
    assert place(("actions", 2, "id")) == "step {i}"
    assert place(("precedence", 1, "min_lag")) == "3"
    assert place(("precedence", 1, "max_lag")) == "5"
    assert place(("precedence", 3)) == "a, b -> c"
    assert place(("precedence", 4)) == "b -> c"
    assert place(("precedence", 4, "before")) == "b"


def test_a_part_without_words_of_its_own_is_found_at_its_element() -> None:
    assert place(("actions", 0, "deadline")).startswith("bake bread")
    assert place(("precedence", 4, "min_lag")) == "b -> c"
