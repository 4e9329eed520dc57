"""What is printed in the DSL is read back as the very same task, over the whole IR."""

from __future__ import annotations

import random
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from irc.frontends.dsl.formatter import formatted
from irc.frontends.dsl.printer import print_task
from irc.frontends.dsl.reader import read_dsl
from irc.frontends.dsl.task import dsl_task
from irc.frontends.files import parse_task
from irc.model import Event, Task
from irc.model.base import Node
from irc.model.canonical import written_task
from irc.model.lazy import Lazy, adapter
from oracles.everything import EVERYTHING
from oracles.generators import HOSTILE_NAMES, hostile_names, random_task, tasks


def test_a_task_with_every_field_is_read_back_from_its_text() -> None:
    task = Task.model_validate(EVERYTHING)
    assert parse_task(print_task(task), "task.irc").task == task


def models_below(model: type[Node]) -> set[type[Node]]:
    """A model of the IR and all that its fields can hold."""
    found: set[type[Node]] = set()
    waiting: list[Any] = [model, Event]
    while waiting:
        item = waiting.pop()
        if isinstance(item, type) and issubclass(item, Node):
            if item not in found:
                found.add(item)
                for field in item.model_fields.values():
                    waiting += [field.annotation, *field.metadata]
        elif isinstance(item, Lazy):
            waiting.append(adapter(item.module, item.name)._type)
        else:
            waiting += getattr(item, "__args__", ())
    return found


def said_fields(node: Any) -> set[tuple[type[Node], str]]:
    """The fields below a part of a task that have another value than the default."""
    if isinstance(node, tuple):
        return {said for item in node for said in said_fields(item)}
    if not isinstance(node, Node):
        return set()
    own = {
        (type(node), name)
        for name, field in type(node).model_fields.items()
        if field.is_required() or getattr(node, name) != field.default
    }
    return own.union(*(said_fields(getattr(node, name)) for name in type(node).model_fields))


ONE_VALUE_ONLY = {(Task, "irc")}


def test_the_task_with_every_field_leaves_none_out() -> None:
    every = {(m, name) for m in models_below(Task) for name in m.model_fields} - ONE_VALUE_ONLY
    assert len(every) > 100
    assert every - said_fields(Task.model_validate(EVERYTHING)) == set()


@pytest.mark.parametrize("field", sorted(Task.model_fields))
def test_a_field_that_is_changed_changes_the_text(field: str) -> None:
    """Else the tests above would not see that a field is left out."""
    whole = Task.model_validate(EVERYTHING)
    without = {k: v for k, v in EVERYTHING.items() if k != field or field == "actions"}
    if field == "irc":
        return
    if field == "actions":
        without["actions"] = EVERYTHING["actions"][:1]
    assert print_task(Task.model_validate(without)) != print_task(whole)


@pytest.mark.slow
@settings(max_examples=30)
@given(tasks())
def test_any_task_is_read_back_from_its_text(task: Task) -> None:
    text = print_task(task)
    found = dsl_task(text)
    assert found.task == task, text
    assert formatted(text) == text


@pytest.mark.slow
@settings(max_examples=25)
@given(tasks())
def test_the_way_over_the_text_and_json_loses_nothing(task: Task) -> None:
    again = dsl_task(print_task(task)).task
    assert again is not None
    assert Task.model_validate(written_task(again)) == Task.model_validate(written_task(task))


@pytest.mark.slow
@settings(max_examples=30)
@given(st.text(min_size=1, max_size=30) | st.sampled_from(HOSTILE_NAMES))
def test_any_name_can_be_written(name: str) -> None:
    if any("\ud800" <= c <= "\udfff" for c in name):
        return
    task = Task.model_validate(
        {
            "resources": [{"id": name}],
            "actions": [
                {"id": name, "duration": 3, "uses": [{"resource": name}]},
                {"id": "x", "modes": [{"id": name, "duration": 1}]},
            ],
            "precedence": [[name, "x"], ["x", name]],
            "state": [{"id": name, "values": [name, "b"], "initial": name}],
            "groups": [{"id": name, "actions": [name]}],
            "goals": [name, {"var": name, "value": name}],
        }
    )
    assert dsl_task(print_task(task)).task == task


@pytest.mark.slow
def test_random_tasks_with_hostile_names_are_read_back() -> None:
    rng = random.Random(3)
    for _ in range(60):
        task = hostile_names(random_task(rng), rng)
        assert dsl_task(print_task(task)).task == task


WORDS = st.sampled_from(
    [
        *("boil", "eggs", "step", "P3D", "PT5M", "s", "min", "d", "12", "3", "10 s", "5min", "on"),
        *("by", "after", "->", ",", "start", "of", "end", "no", "actions", "+", "..", "resource"),
        *("task", "days", "per", "month", "at", "1st", "x_1", "Über", "2.5", "4  min", "#", "{i}"),
    ]
)
SEPARATORS = st.sampled_from([" ", "  ", "", ", ", " -> ", "\t"])


@pytest.mark.slow
@settings(max_examples=50)
@given(st.lists(st.tuples(WORDS, SEPARATORS), min_size=1, max_size=9), st.booleans())
def test_plain_lines_mean_what_the_grammar_makes_of_them(
    words: list[tuple[str, str]], looking: bool
) -> None:
    line = "".join(word + separator for word, separator in words)
    assert outcome(line) == outcome(line, plain=False)


@pytest.mark.parametrize(
    "line",
    [
        "boil eggs 4 min on stove, table by robots after heat water, x 3  # why",
        "boil 4",
        "step 12 10 s",
        "step 12 5",
        "a, b 2 -> c, d -> e",
        "a -> b",
        "boil 4 by r1, r2 after b\r",
    ],
)
def test_these_lines_are_read_without_the_grammar(
    line: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    by_grammar = outcome(line, plain=False)
    monkeypatch.setattr("irc.frontends.dsl.grammar._parser", None)
    assert outcome(line) == by_grammar


def outcome(line: str, *, plain: bool = True) -> Any:
    """The document of a line and its faults, read with or without the way around the grammar."""
    with pytest.MonkeyPatch.context() as patch:
        if not plain:
            patch.setattr("irc.frontends.dsl.reader.plain_statement", lambda *_: False)
        found = read_dsl(line)
    return found.document, [(f.code, f.message, f.offset) for f in found.faults]
