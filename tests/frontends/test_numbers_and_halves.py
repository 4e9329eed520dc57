"""NaN, numbers out of range and half characters: a located error in every reader, no traceback."""

from __future__ import annotations

import gzip
import json
import random
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import irc
from irc.diagnostics import Diagnostic, InputError
from irc.frontends.events import read_events
from irc.frontends.files import parse_task
from irc.frontends.importers.asyncplan import import_asyncplan
from irc.frontends.importers.instances import read_instances
from irc.frontends.importers.planner import import_planner
from irc.frontends.importers.robo import import_robo
from irc.frontends.importers.robo_online import import_robo_online
from irc.frontends.importers.schedule_spec import import_schedule_spec
from irc.frontends.json.document import read_document
from irc.frontends.json.value import read_line
from irc.methods import read_nl_ir, read_planner, read_schedule_spec
from irc.schedule.reading import schedule_from_json
from paths import EXAMPLES
from runs import run_irc

GRAPHS = [
    {
        "id": 1,
        "question": "Step 1. Cut (2 s)\nStep 2. Fry (3 s)",
        "graph": {"durations": [2, 3], "edges": [[0, 1]], "step_to_node": {"1": 0, "2": 1}},
        "answer": 5,
    }
]
KITCHEN = {
    "id": "k",
    "items": {"bun": {"state": "raw", "predicates": ["istoastable"]}},
    "goal": {"required_states": {"bun": "toasted"}, "stack_order": ["bun"]},
    "action_durations": {"toast": 5, "stack": 1},
    "stations": {"toaster": 1},
    "temporal_constraints": [],
}
SPEC = {
    "actions": [{"id": "a", "duration": 3, "station": "oven"}, {"id": "b", "duration": 4}],
    "dependencies": [{"before": "a", "after": "b", "min_lag": 1}],
}
TASK = {
    "name": "supper",
    "metadata": {"note": "x", "count": 1},
    "resources": [{"id": "r", "capacity": 2}],
    "actions": [{"id": "a", "duration": 3, "uses": [{"resource": "r", "amount": 1}]}],
}
SCHEDULE = {"actions": [{"id": "a", "start": 0, "end": 3, "resources": {"r": 1}}], "seconds": 1}

Read = Callable[[str], Any]


def _events(text: str, tmp: Path) -> Any:
    file = tmp / "events.json"
    file.write_text(text)
    return read_events(str(file), 0)


def _schedule(text: str) -> Any:
    document = read_document(text, "s.json")
    return schedule_from_json(document.content, document.source)


READERS: dict[str, tuple[Any, Read]] = {
    "asyncplan": (GRAPHS, lambda text: list(import_asyncplan(text, "f"))),
    "robo": (KITCHEN, lambda text: list(import_robo(text, "f"))),
    "robo-online": ([KITCHEN], lambda text: list(import_robo_online(text, "f"))),
    "instances": (GRAPHS, lambda text: read_instances(text, "f")),
    "planner": (SPEC, lambda text: import_planner(text, "f")),
    "schedule-spec": (SPEC, lambda text: import_schedule_spec(text, "f")),
    "task": (TASK, lambda text: parse_task(text, "f.json")),
    "answer": (TASK, lambda text: parse_task(f"```json\n{text}\n```", "f.txt")),
    "schedule": (SCHEDULE, _schedule),
}
BAD = ("NaN", "Infinity", "-Infinity", "1e999999999", '"\\ud800"', '"x\\udfffy"', "9" * 5000)
_LEAF = re.compile(r'(?<=: )(?:\d+|"[^"]*")|(?<=[\[ ])\d+(?=[,\]])')


@pytest.mark.parametrize("reader", READERS)
def test_every_reader_refuses_them_with_a_place(reader: str) -> None:
    document, read = READERS[reader]
    text = json.dumps(document)
    leaves = [match.span() for match in _LEAF.finditer(text)]
    rng = random.Random(1)
    refused = 0
    for bad in BAD:
        start, end = rng.choice(leaves)
        errors = errors_of(read, text[:start] + bad + text[end:])
        assert all(d.line is not None for d in errors)
        refused += bool(errors)
    assert refused >= len(BAD) - 3


def errors_of(read: Read, text: str) -> tuple[Diagnostic, ...]:
    """The errors of a reader, located; none where it takes the text."""
    try:
        read(text)
    except InputError as error:
        return error.report.located().errors
    return ()


def test_half_a_character_in_an_instances_name_has_a_place(tmp_path: Path) -> None:
    file = tmp_path / "kitchen.json"
    file.write_text(json.dumps({**KITCHEN, "id": "\ud800"}))
    said = run_irc("convert", file, "--from", "robo", "-o", tmp_path / "out")
    assert said.exit_code == 1
    assert "kitchen.json:1:8" in said.stderr
    assert "half a character" in said.stderr


def test_a_nan_that_only_the_metadata_hold_is_refused_too() -> None:
    text = '[{"id": 1, "answer": NaN, "graph": {"durations": [1], "edges": []}}]'
    with pytest.raises(InputError) as refused:
        list(import_asyncplan(text, "f"))
    (finding,) = refused.value.report.located()
    assert (finding.line, finding.column) == (1, 22)
    assert "NaN is not a number in JSON" in finding.message


@pytest.mark.parametrize("read", [read_nl_ir, read_planner, read_schedule_spec])
@pytest.mark.parametrize("bad", ["NaN", "Infinity", "1e999", '"\\ud800"'])
def test_a_model_that_writes_them_gets_an_answer_with_a_diagnostic(read: Read, bad: str) -> None:
    second = f'{{"id": "second", "duration": {bad}}}'
    text = f'{{"actions": [{{"id": "first", "duration": 3}}, {second}]}}'
    answer = read(text)
    assert not answer.report.ok
    assert answer.task is None
    assert "second" in answer.report.render()


@pytest.mark.parametrize("bad", [float("nan"), float("inf"), "\ud800", object()])
@pytest.mark.parametrize(
    "where", [("metadata", "x"), ("name",), ("actions", 0, "duration"), ("actions", 0, "id")]
)
def test_documents_of_a_program_are_held_to_the_same(bad: Any, where: tuple[Any, ...]) -> None:
    document: Any = json.loads(json.dumps(TASK))
    *parents, last = where
    parent = document
    for part in parents:
        parent = parent[part]
    parent[last] = bad
    with pytest.raises(InputError) as refused:
        irc.solve(document)
    assert refused.value.report.errors[0].pointer[:1] == where[:1]


def test_a_line_of_recorded_answers_is_named(tmp_path: Path) -> None:
    instances, answers = tmp_path / "i.json", tmp_path / "a.jsonl.gz"
    instances.write_text(json.dumps(GRAPHS))
    answers.write_bytes(gzip.compress(b'{"id": 1, "answer": "x"}\n{"id": 1, "n": NaN}\n'))
    command = ("eval", "score", "--method", "planner", "--instances", instances, "--answers")
    said = run_irc(*command, answers)
    assert said.exit_code == 1
    assert "line 2: NaN is not a number in JSON: line 1 column 16" in said.stderr
    answers.write_bytes(gzip.compress(b'{"id": 1, "answer": true}\n'))
    assert "line 1: 'answer' is not a text" in run_irc(*command, answers).stderr


def test_lines_are_read_as_they_are() -> None:
    assert read_line('{"a": "\\ud800", "b": 0.1}') == {"a": "\ud800", "b": 0.1}
    for bad in ("[NaN]", "[1e999]", "[" * 100_000):
        with pytest.raises(ValueError, match="line 1 column"):
            read_line(bad)


def test_events_of_a_file_are_held_to_the_same(tmp_path: Path) -> None:
    for bad in ("NaN", '"\\ud800"'):
        change = f'{{"op": "set_duration", "action": "a", "duration": {bad}}}'
        text = f'[{{"changes": [{change}]}}]'
        with pytest.raises(InputError) as refused:
            _events(text, tmp_path)
        assert all(d.line == 1 for d in refused.value.report.located())


def test_the_examples_are_still_read() -> None:
    assert irc.check(EXAMPLES / "late_dinner.json") is not None
