"""Tasks that are kept as columns: nothing about them differs from the same tasks with objects."""

from __future__ import annotations

import copy
import json
import pickle
import random
from collections.abc import Sequence
from dataclasses import replace
from io import StringIO
from pathlib import Path
from typing import Any

import pytest
from rich.console import Console

from irc.checks import run_checks
from irc.cli.render import print_answer
from irc.diagnostics import Findings, InputError
from irc.driver.judge import Answer
from irc.driver.solve import solve_task
from irc.frontends import files
from irc.frontends.json import columns
from irc.frontends.json.columns import read_columns
from irc.model import Task
from irc.model.canonical import canonical_task, task_sha256
from irc.model.columns import ColumnTask
from irc.model.from_document import to_task
from irc.schedule import Entry, Schedule, dump_json
from irc.schedule.entry import plain_entries
from irc.schedule.writing import schedule_text
from irc.targets import SolveOptions
from irc.validation import validate
from paths import ROOT
from runs import run_irc

Document = dict[str, Any]
NAMES = ["a", "b", "c", "ä: b", "x y", "10", "9", "c,", "{", "Z"]
BRACED = [*NAMES, "}, {", "} "]
"""Names within which a part of the text may end: then the general reader reads it."""


def simple_document(
    rng: random.Random, cycles: bool = False, known: Sequence[str] = NAMES
) -> Document:
    """A task of which columns can be made; with `cycles`, perhaps one that is infeasible."""
    names = rng.sample(known, rng.randint(1, len(known)))
    actions = [{"id": name, "duration": rng.randint(1, 6)} for name in names]
    pairs = {
        (b, a)
        for _ in range(rng.randint(0, 14))
        for b, a in [rng.choices(range(len(names)), k=2)]
        if b < a or (cycles and b != a)
    }
    edges = [{"before": names[b], "after": names[a]} for b, a in rng.sample([*pairs], len(pairs))]
    head = {"name": "a: task", "irc": "1", "time_unit": "min", "description": "\u2029"}
    document: Document = {key: head[key] for key in head if rng.random() < 0.4}
    document["actions"] = actions
    if edges or rng.random() < 0.5:
        document["precedence"] = edges
    return dict(rng.sample([*document.items()], len(document)))


def text_of(document: Document, rng: random.Random) -> str:
    return json.dumps(document, ensure_ascii=False, indent=rng.choice([None, 1]))


def read_both(document: Document, seed: int) -> tuple[ColumnTask, Task]:
    """The task of a document as columns, and by the general reader."""
    text = text_of(document, random.Random(seed))
    kept = read_columns(text, "t.json")
    assert kept is not None, text
    return kept, files.parse_task(text, "t.json").task


def spoilt(rng: random.Random) -> str:
    """The text of a simple task with one or two changes that may be faults."""
    document = simple_document(rng, cycles=True, known=rng.choice([NAMES, BRACED]))
    for _ in range(rng.randint(0, 1)):
        part = rng.choice([document, *document["actions"], *document.get("precedence", [])])
        value = rng.choice([None, True, 0, -1, 3, 10**16, "5 min", "a", "", [], {}, 1.5])
        part[rng.choice([*part, "uses", "due", "type"])] = value
    text = text_of(document, rng)
    if rng.random() < 0.3:
        return text
    at = rng.randrange(len(text) + 1)
    middle = rng.choice(
        ['"id": "a", ', '"id": "a", ', '"before": "a", ', '"', "}", "\\", "NaN", "1", "{", ",", ""]
    )
    if rng.random() < 0.5:
        places = [k for k, c in enumerate(text) if c == '"' and text[k - 1] in "{, \n"]
        at = rng.choice(places)
    return text[:at] + middle + text[at + rng.choice([0, 0, 1]) :]


def outcome(text: str) -> object:
    """What reading a text gives: a task with notes and places, or a report."""
    try:
        reading = files.parse_task(text, "t.json")
    except InputError as error:
        return str(error.report)
    report = run_checks(reading.task, reading.notes).report
    return reading.notes, canonical_task(reading.task), report.located()


@pytest.mark.parametrize("seed", range(4))
def test_a_faulty_text_is_read_as_the_general_reader_does(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(columns, "_PART", (10_000, 1, 30, 90)[seed])  # (Ends within names, too.)
    rng = random.Random(seed)
    texts = [spoilt(rng) for _ in range(40)]
    expected = [outcome(text) for text in texts]
    monkeypatch.setattr(files, "COLUMNS_FROM", 0)
    kept = [read_columns(text, "t.json") for text in texts]
    assert 1 < sum(task is not None for task in kept) < 37
    assert [outcome(text) for text in texts] == expected
    for text, task in zip(texts, kept, strict=True):
        if task is not None:
            assert [d.code for d in run_checks(task).report if d.code.id < "IRC3"] == [], text


@pytest.mark.parametrize(
    "text",
    [
        '{"actions": [{"id": "a", "duration": 3, "duration": 4}]}',
        '{"actions": [{"id": "b:c", "id": "a", "duration": 4}]}',
        '{"actions": [{"id": "a:", "duration": 1}, {"id": "b", "id": "b:", "duration": 4}]}',
        '{"name": "a", "name": "b", "actions": [{"id": "a", "duration": 3}]}',
        '{"actions": [], "actions": [{"id": "a", "duration": 3}]}',
        '{"actions": [{"id": "a\\u003a", "duration": 3}]}',
        '{"actions": [{"id": "a\ud800", "duration": 3}]}',
        '{"actions": [{"id": "a", "duration": true}]}',
        '{"actions": [{"id": "a", "duration": 0}]}',
        '{"actions": [{"id": "", "duration": 1}]}',
        '{"actions": [{"id": "a", "duration": 1}, {"id": "a", "duration": 1}]}',
        '{"actions": [{"id": "a", "duration": 1}], "precedence": [["a", "a"]]}',
        '{"actions": [{"id": "a", "duration": 1}], "precedence": [{"before": "a", "after": "a"}]}',
        '{"actions": [{"id": "a", "duration": 1}], "precedence": [{"before": "a", "after": "x"}]}',
        '{"actions": [{"id": "a", "duration": 1}], "time_unit": "parsec"}',
        '{"actions": [{"id": "a", "duration": 1}], "objective": "minimize_cost"}',
        '{"actions": [{"id": "a", "duration": 1}], "irc": "2"}',
        '{"actions": []}',
        '{"actions": [{"id": "a", "duration": 1}]} and more',
        '```\n{"actions": [{"id": "a", "duration": 1}]}\n```',
        "[" * 2000,
        "",
    ],
)
def test_what_is_not_simple_is_left_to_the_general_reader(text: str) -> None:
    assert read_columns(text, "t.json") is None


def test_the_documents_of_the_corpus_are_read_alike(monkeypatch: pytest.MonkeyPatch) -> None:
    texts = [
        path.read_text("utf-8", "surrogateescape")
        for folder in ("shape", "text")
        for path in sorted((ROOT / "tests" / "corpus" / folder).glob("*.json"))
    ]
    assert len(texts) > 20
    expected = [outcome(text) for text in texts]
    monkeypatch.setattr(files, "COLUMNS_FROM", 0)
    assert [outcome(text) for text in texts] == expected


def shown(answer: Answer, *, all_rows: bool) -> str:
    file = StringIO()
    print_answer(replace_seconds(answer), Console(file=file, width=100), all_rows=all_rows)
    return file.getvalue()


def replace_seconds(answer: Answer) -> Answer:
    return replace(answer, schedule=replace(answer.schedule, seconds=1.0))


@pytest.mark.parametrize("seed", range(24))
def test_the_answer_is_the_same(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(columns, "_PART", (10_000, 1, 30, 90)[seed % 4])
    rng = random.Random(seed)
    kept, task = read_both(simple_document(rng, cycles=seed % 4 == 0), seed)
    assert task_sha256(kept) == task_sha256(task)
    options = SolveOptions(deterministic=seed % 2 == 0)
    expected, answer = (replace_seconds(solve_task(t, options)) for t in (task, kept))
    assert answer.schedule == expected.schedule
    if not expected.schedule.answered:
        assert answer.schedule.reasons == expected.schedule.reasons
        return
    assert not {"actions", "precedence"} & kept.__dict__.keys()  # (It was solved as columns.)
    assert answer.notes == expected.notes
    assert shown(answer, all_rows=False) == shown(expected, all_rows=False)
    assert schedule_text(answer.schedule) == dump_json(expected.schedule.to_dict())
    assert not {"actions", "precedence"} & kept.__dict__.keys()
    assert answer.problem == expected.problem


def test_a_long_answer_is_shown_alike() -> None:
    rng = random.Random(1)
    actions = [{"id": f"s{i}", "duration": rng.randint(1, 90)} for i in range(80)]
    pairs = {(i, min(79, i + rng.randint(1, 9))) for i in range(79) for _ in range(2)}
    edges = [{"before": f"s{b}", "after": f"s{a}"} for b, a in pairs]
    kept, task = read_both({"actions": actions, "precedence": edges}, 0)
    for all_rows in (True, False):
        assert shown(solve_task(kept), all_rows=all_rows) == shown(
            solve_task(task), all_rows=all_rows
        )


@pytest.mark.parametrize("seed", range(16))
def test_the_validator_judges_alike(seed: int) -> None:
    rng = random.Random(seed)
    kept, task = read_both(simple_document(rng), seed)
    schedule = solve_task(kept).schedule
    entries = list(schedule.entries)
    k = rng.randrange(len(entries))
    changes: list[Document] = [
        {"start": entries[k].start - 1, "end": entries[k].end - 1},
        {"start": entries[k].start + 1, "end": entries[k].end + 1},
        {"end": entries[k].end + 1},
        {"id": rng.choice([*NAMES, "other"])},
        {"mode": "m"},
        {"resources": {"r": 1}},
        {"occurrence": 2},
        {"status": "cancelled"},
        {"rank": 1},
        {"end_rank": 3},
    ]
    for change in changes:
        changed = [*entries[:k], replace(entries[k], **change), *entries[k + 1 :]]
        for objective in ((), schedule.objective):
            wrong = replace(schedule, entries=tuple(changed), objective=objective)
            assert validate(kept, wrong) == validate(task, wrong)
    for odd in (entries[:-1], [*entries, entries[0]], []):
        wrong = replace(schedule, entries=tuple(odd))
        assert validate(kept, wrong) == validate(task, wrong)
    false = tuple(replace(o, value=o.value + 1) for o in schedule.objective)
    wrong = replace(schedule, objective=false)
    assert validate(kept, wrong) == validate(task, wrong)
    assert validate(kept, schedule).valid
    assert not validate(kept, wrong).valid


def test_a_task_of_columns_is_a_task_in_all_respects() -> None:
    document = {
        "name": "n",
        "actions": [{"id": "a", "duration": 1}, {"id": "b", "duration": 2}],
        "precedence": [{"before": "a", "after": "b"}],
    }

    def kept() -> ColumnTask:
        return read_both(document, 0)[0]

    task = to_task(document, Findings())
    assert task is not None
    assert kept() == task
    assert task == kept()
    assert kept() == kept()
    assert kept() != 1
    for copied in (
        copy.copy(kept()),
        copy.deepcopy(kept()),
        kept().model_copy(),
        pickle.loads(pickle.dumps(kept())),
        kept().whole(),
    ):
        assert type(copied) is Task
        assert copied == task
        assert copied.columns is None
    changed = kept().model_copy(update={"actions": task.actions[:1], "precedence": ()})
    assert changed == task.model_copy(update={"actions": task.actions[:1], "precedence": ()})
    assert task_sha256(changed) != task_sha256(task)
    assert kept().model_dump() == task.model_dump()
    assert kept().model_dump_json() == task.model_dump_json()
    assert repr(kept()).partition("(")[2] == repr(task).partition("(")[2]
    assert dict(kept()) == dict(task)
    assert kept().model_fields_set == task.model_fields_set
    assert kept().clock == task.clock
    assert kept().actions == task.actions
    with pytest.raises(AttributeError):
        kept().nothing  # noqa: B018
    with pytest.raises(TypeError):
        hash(kept())
    assert task.columns is None


def test_plain_entries_are_entries() -> None:
    rows = [(0, 3, "a"), (3, 5, "b")]
    made = plain_entries(rows)
    assert made == (Entry("a", 0, 3), Entry("b", 3, 5))
    assert all(repr(e) == repr(Entry(e.id, e.start, e.end)) for e in made)
    assert made[0].resources is not made[1].resources
    assert plain_entries([]) == ()


def test_a_large_schedule_in_a_file_is_cut_in_the_text(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(files, "COLUMNS_FROM", 0)
    file, out = tmp_path / "large.json", tmp_path / "s.json"
    steps = [{"id": f"step{i}", "duration": 60} for i in range(10_002)]
    edges = [{"before": f"step{i}", "after": f"step{i + 1}"} for i in range(0, 10_002, 2)]
    file.write_text(json.dumps({"actions": steps, "precedence": edges}))
    result = run_irc("solve", file, "-o", out)
    assert result.exit_code == 0
    assert "10,002 actions, 10,002 of them critical" in result.stdout
    assert "9,942 more rows" in result.stdout
    assert len(result.stdout.splitlines()) < 80
    found = Schedule.from_dict(json.loads(out.read_text()))
    assert len(found.entries) == 10_002
    assert found.makespan == 120
