"""The canonical form: one for all ways to write a task, another for every other task."""

from __future__ import annotations

import copy
import json
import random
from collections.abc import Callable, Iterator
from decimal import Decimal
from typing import Any

import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from irc.model import Task
from irc.model.canonical import canonical_sha256, canonical_task, task_sha256, written_task
from irc.schedule import dump_json
from oracles.generators import documents, tasks

Document = dict[str, Any]

slow_to_draw = settings(
    max_examples=30,
    phases=[Phase.generate],  # Whole documents take minutes to shrink.
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)

EVERYTHING: Document = {
    "irc": "1",
    "name": "n",
    "description": "d",
    "time_unit": "min",
    "days_per_month": 31,
    "deadline": 100,
    "origin": "2026-03-01T08:00:00",
    "metadata": {"k": [1, {"x": "y"}]},
    "resources": [
        {
            "id": "r",
            "label": "l",
            "description": "d",
            "capacity": 3,
            "availability": [
                {"from": 1, "to": 2, "capacity": 0},
                {"from": 5, "to": 6, "capacity": 9},
            ],
        },
        {"id": "q"},
        {"id": "s", "kind": "reservoir", "initial": 2, "min": -1, "max": 9},
    ],
    "state": [{"id": "v", "values": ["raw", "done"], "initial": "raw"}, {"id": "f"}],
    "actions": [
        {
            "id": "a",
            "label": "l",
            "description": "d",
            "duration": 5,
            "occurs": "optional",
            "uses": [{"resource": "r", "amount": 2}, {"one_of": ["r", "q"]}],
            "consumes": [{"resource": "s", "amount": 2, "at": "end"}],
            "produces": [{"resource": "s", "at": "start"}],
            "release": 1,
            "deadline": 90,
            "due": 40,
            "weight": 3,
            "conditions": [{"at": "all", "var": "v", "value": "raw"}, {"at": "end", "var": "f"}],
            "effects": [{"at": "end", "var": "v", "value": "done"}, {"at": "start", "var": "f"}],
            "reward": 5,
            "cost": 2,
        },
        {
            "id": "b",
            "start": 2,
            "modes": [
                {"id": "m", "duration": {"min": 1, "max": 2}, "uses": [{"resource": "q"}]},
                {"id": "o", "label": "l", "duration": 7},
            ],
        },
        {"id": "c", "duration": 1, "occurs": {"min": 1, "max": 3}},
    ],
    "precedence": [
        {"before": "a", "after": "b", "type": "start-start", "min_lag": 1, "max_lag": 9},
        {"before": "b", "after": "a"},
    ],
    "groups": [
        {
            "id": "g",
            "label": "l",
            "actions": ["a", "b"],
            "required": False,
            "reward": 4,
            "deadline": 80,
            "due": 30,
            "weight": 2,
        }
    ],
    "goals": ["a", {"var": "v", "value": "done"}],
    "objective": ["maximize_reward", "minimize_makespan"],
    "events": [
        {
            "id": "e",
            "at": 5,
            "changes": [
                {"op": "cancel_actions", "actions": ["a"]},
                {"op": "observe", "action": "b", "occurrence": 2, "started": 3},
            ],
        },
        {"at": 8, "changes": [{"op": "set_deadline", "deadline": None}]},
    ],
}


def hash_of(document: Document) -> str:
    return task_sha256(Task.model_validate(document))


def small(**document: Any) -> str:
    return hash_of({"actions": [{"id": "a", "duration": 60}], **document})


# --- one for all ways to write ------------------------------------------------------------------


@pytest.mark.slow
@slow_to_draw
@given(documents(), st.integers())
def test_order_of_arrays_and_keys_does_not_matter(
    shuffled: Callable[[Document, random.Random], Document], document: Document, seed: int
) -> None:
    assert hash_of(shuffled(document, random.Random(seed))) == hash_of(document)


def test_order_does_not_matter_in_a_task_with_everything(
    shuffled: Callable[[Document, random.Random], Document],
) -> None:
    for seed in range(50):
        other = shuffled(EVERYTHING, random.Random(seed))
        assert canonical_task(Task.model_validate(other)) == canonical_task(
            Task.model_validate(EVERYTHING)
        )


@pytest.mark.slow
@slow_to_draw
@given(tasks())
def test_the_canonical_form_is_a_document_of_the_same_task(task: Task) -> None:
    """Decoding reads the task back from the manifest and compares hashes."""
    canonical = canonical_task(task)
    text = json.dumps(canonical, ensure_ascii=False, allow_nan=False)
    again = Task.model_validate(json.loads(text, parse_float=Decimal))
    assert canonical_task(again) == canonical
    assert task_sha256(again) == canonical_sha256(canonical) == task_sha256(task)


@pytest.mark.slow
@slow_to_draw
@given(tasks())
def test_writing_a_task_down_keeps_its_hash(task: Task) -> None:
    text = dump_json(written_task(task))
    again = Task.model_validate(json.loads(text, parse_float=Decimal))
    assert task_sha256(again) == task_sha256(task)


@pytest.mark.parametrize(
    "duration",
    [60, 60.0, Decimal("6E+1"), "60", "60.0", "120/2", "60 s", "1 min", "PT1M"],
)
def test_equal_times_are_equal_however_they_are_written(duration: Any) -> None:
    assert hash_of({"actions": [{"id": "a", "duration": duration}]}) == small()


DEFAULTS: Document = {
    "irc": "1",
    "time_unit": "s",
    "days_per_month": 30,
    "objective": "minimize_makespan",
    "deadline": None,
    "resources": [],
    "metadata": {},
    "name": None,
}


@pytest.mark.parametrize("field", DEFAULTS)
def test_a_default_that_is_written_out_says_nothing(field: str) -> None:
    assert small(**{field: DEFAULTS[field]}) == small()


def test_defaults_of_parts_say_nothing_either() -> None:
    parts = {
        "actions": [{"id": "a", "duration": 60, "occurs": "once", "release": "0 s", "uses": []}],
        "resources": [{"id": "r", "kind": "renewable", "capacity": 1, "availability": []}],
        "state": [{"id": "f", "values": [True, False]}],
        "precedence": [{"before": "a", "after": "a", "type": "finish-start", "min_lag": "0 min"}],
        "groups": [{"id": "g", "actions": ["a"], "required": True}],
        "goals": [{"var": "f", "value": True}],
    }
    plain = {
        "resources": [{"id": "r"}],
        "state": [{"id": "f"}],
        "precedence": [["a", "a"]],
        "groups": [{"id": "g", "actions": ["a"]}],
        "goals": [{"var": "f"}],
    }
    assert small(**parts) == small(**plain)


def test_an_exact_repetition_counts_once() -> None:
    parts = {
        "resources": [{"id": "r"}],
        "precedence": [["a", "b"]],
        "goals": ["a"],
        "groups": [{"id": "g", "actions": ["a", "b"]}],
    }
    assert small(**{key: value * 2 for key, value in parts.items()}) == small(**parts)


@pytest.mark.parametrize("document", [{"actions": []}, {"groups": [{"id": "g", "actions": []}]}])
def test_an_array_that_must_be_there_stays_though_it_is_empty(document: Document) -> None:
    task = Task.model_validate({"actions": [], **document})
    assert Task.model_validate(canonical_task(task)) == task


def test_aliases_do_not_matter() -> None:
    edge = {"predecessor": "a", "successor": "b", "lag": "1 min"}
    plain = {"before": "a", "after": "b", "min_lag": 60}
    assert small(dependencies=[edge, ["b", "a"]]) == small(
        precedence=[plain, {"before": "b", "after": "a"}]
    )


def test_events_of_different_instants_may_stand_in_any_order() -> None:
    first = {"at": "1 min", "changes": [{"op": "set_release", "action": "a", "release": 70}]}
    second = {"at": 90, "changes": [{"op": "cancel_actions", "actions": ["a"]}]}
    assert small(events=[first, second]) == small(events=[second, first])
    together = {**second, "at": 60}
    assert small(events=[first, together]) != small(events=[together, first])


def test_decimals_in_metadata_are_hashed_by_value() -> None:
    assert small(metadata={"x": Decimal("0.50")}) == small(metadata={"x": 0.5})
    assert small(metadata={"x": Decimal("0.1")}) != small(
        metadata={"x": Decimal("0.10000000000000000001")}
    )


def test_the_hash_is_the_same_on_every_machine() -> None:
    """Of the text that is hashed: sorted keys, no blanks, UTF-8."""
    import hashlib

    text = '{"actions":[{"duration":90,"id":"é"}],"irc":"1"}'
    expected = hashlib.sha256(text.encode()).hexdigest()
    assert hash_of({"actions": [{"id": "é", "duration": "1.5 min"}]}) == expected


# --- another for every other task ---------------------------------------------------------------


def leaves(value: Any, at: tuple[str | int, ...] = ()) -> Iterator[tuple[str | int, ...]]:
    """The paths of all values that are no object or list."""
    if isinstance(value, (dict, list)):
        for key, inner in value.items() if isinstance(value, dict) else enumerate(value):
            yield from leaves(inner, (*at, key))
    else:
        yield at


def others(value: Any) -> list[Any]:
    """Values of the same kind, of which at least one is usually legal in its place."""
    if isinstance(value, bool):
        return [not value]
    if isinstance(value, int):
        return [value + 1, value - 1]
    if value is None:
        return [7]
    words = {"optional": "once", "min": "s", "start": "end", "end": "start", "all": "start"}
    words |= {"start-start": "finish-start", "reservoir": "renewable"}
    words |= {"maximize_reward": "minimize_cost", "minimize_makespan": "minimize_cost"}
    words |= {"2026-03-01T08:00:00": "2026-03-01T08:00:01"}
    return [words.get(value, value + "x")]


ONLY_ONE_VALUE = [
    ("irc",),
    *(("events", e, "changes", c, "op") for e, c in [(0, 0), (0, 1), (1, 0)]),
]


@pytest.mark.parametrize(
    "path",
    [path for path in leaves(EVERYTHING) if path not in ONLY_ONE_VALUE],
    ids=lambda path: "/".join(map(str, path)),
)
def test_every_value_of_a_task_counts(path: tuple[str | int, ...]) -> None:
    changed = []
    for other in others(value_at(path)):
        document = copy.deepcopy(EVERYTHING)
        element: Any = document
        for part in path[:-1]:
            element = element[part]
        element[path[-1]] = other
        try:
            changed.append(hash_of(document))
        except ValidationError:
            continue
    assert changed
    assert hash_of(EVERYTHING) not in changed


def value_at(path: tuple[str | int, ...]) -> Any:
    element: Any = EVERYTHING
    for part in path:
        element = element[part]
    return element


@pytest.mark.parametrize(
    "array",
    ["uses", "consumes", "produces", "conditions", "effects"],
)
def test_a_second_use_or_change_counts_again(array: str) -> None:
    document = copy.deepcopy(EVERYTHING)
    document["actions"][0][array] = document["actions"][0][array] * 2
    assert hash_of(document) != hash_of(EVERYTHING)


def test_the_order_of_objectives_and_of_changes_counts() -> None:
    objectives, changes = copy.deepcopy(EVERYTHING), copy.deepcopy(EVERYTHING)
    objectives["objective"].reverse()
    changes["events"][0]["changes"].reverse()
    assert len({hash_of(EVERYTHING), hash_of(objectives), hash_of(changes)}) == 3


def test_true_and_the_text_true_are_two_values() -> None:
    assert small(goals=[{"var": "f", "value": False}]) != small(
        goals=[{"var": "f", "value": "False"}]
    )
    assert small(goals=[{"var": "f", "value": True}]) != small(
        goals=[{"var": "f", "value": "true"}]
    )
