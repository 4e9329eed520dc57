"""The schema for structured output, and null in the place of what is absent."""

from __future__ import annotations

import json
import random
from collections.abc import Iterator
from typing import Any, Literal

import pytest

from irc.diagnostics import Findings
from irc.frontends.files import parse_task
from irc.model import Event, Task
from irc.model.canonical import canonical_task
from irc.model.from_document import to_task
from irc.model.nulls import without_nulls
from irc.model.strict_schema import strict_schema
from irc.schedule.reading import schedule_from_json
from runs import run_irc

PARTS: tuple[Literal["task", "event"], ...] = ("task", "event")
TAKEN = {"type", "properties", "required", "additionalProperties", "items", "anyOf", "enum"}


def nodes(schema: Any) -> Iterator[dict[str, Any]]:
    """Every schema in a schema."""
    yield schema
    for inner in (*schema.get("properties", {}).values(), *schema.get("anyOf", ())):
        yield from nodes(inner)
    if "items" in schema:
        yield from nodes(schema["items"])


def depth(schema: Any) -> int:
    inner = [*schema.get("properties", {}).values(), *schema.get("anyOf", ())]
    inner += [schema["items"]] if "items" in schema else []
    return (schema.get("type") == "object") + max(map(depth, inner), default=0)


@pytest.mark.parametrize("part", PARTS)
def test_the_schema_has_only_what_every_reader_of_schemas_takes(
    part: Literal["task", "event"],
) -> None:
    schema = strict_schema(part)
    for node in nodes(schema):
        assert node.keys() <= TAKEN
        assert {"type", "anyOf"} & node.keys()
        if node.get("type") == "object":
            assert node["additionalProperties"] is False
            assert node["required"] == list(node["properties"])
    assert schema["type"] == "object"
    assert depth(schema) <= 6
    assert len(json.dumps(schema, separators=(",", ":"))) < 20_000


def drawn(schema: dict[str, Any], rng: random.Random) -> Any:
    """A value of a schema, as a model bound by it might write one; rather null than not."""
    if "anyOf" in schema:
        return drawn(rng.choice(schema["anyOf"]), rng)
    if "enum" in schema:
        return rng.choice(schema["enum"])
    kinds = schema["type"] if isinstance(schema["type"], list) else [schema["type"]]
    kind = "null" if "null" in kinds and rng.random() < 0.7 else kinds[0]
    if kind == "object":
        return {name: drawn(inner, rng) for name, inner in schema["properties"].items()}
    if kind == "array":
        return [drawn(schema["items"], rng) for _ in range(rng.randint(1, 2))]
    plain = {"string": "3", "number": 2, "integer": 1, "boolean": True, "null": None}
    return plain[kind]


RULES = (
    "resource' or",
    "one of",
    "'min'",
    "time unit",
    "origin",
    "number without a unit",
    "belong together",
    "only there",
    "for each resource",
)
"""Faults of shape that no schema without conditions can exclude."""


@pytest.mark.slow
@pytest.mark.parametrize("part", PARTS)
def test_whatever_the_schema_allows_has_a_shape_that_the_readers_take(
    part: Literal["task", "event"],
) -> None:
    rng, schema = random.Random(5), strict_schema(part)
    taken = 0
    for _ in range(40):
        value = drawn(schema, rng)
        raw = value if part == "task" else {"actions": [], "events": [value]}
        findings = Findings()
        taken += to_task(raw, findings) is not None
        wrong = [d.message for d in findings.items if not any(r in d.message for r in RULES)]
        assert wrong == []
    assert taken >= 2


def test_every_field_of_the_ir_that_is_not_left_out_is_in_the_schema() -> None:
    left_out = {"irc", "metadata", "events", "days_per_month", "origin"}
    assert set(strict_schema()["properties"]) == set(Task.model_fields) - left_out
    assert set(strict_schema("event")["properties"]) == set(Event.model_fields) - {"id"}


def test_null_is_absent_in_a_task() -> None:
    text = """{"name": null, "metadata": {"kept": null}, "resources": null, "state": null,
      "actions": [{"id": "a", "label": null, "duration": 3, "occurs": null, "uses": null,
        "release": null, "conditions": null, "modes": null},
        {"id": "b", "duration": 2, "uses": [{"resource": "r", "one_of": null, "amount": null}]}],
      "precedence": [{"before": "a", "after": "b", "type": null, "min_lag": null}],
      "objective": null, "time_unit": null, "goals": null, "groups": null, "events": null}"""
    plain = {
        "metadata": {"kept": None},
        "actions": [
            {"id": "a", "duration": 3},
            {"id": "b", "duration": 2, "uses": [{"resource": "r"}]},
        ],
        "precedence": [["a", "b"]],
    }
    task = parse_task(text).task
    assert canonical_task(task) == canonical_task(Task.model_validate(plain))
    assert task.metadata == {"kept": None}


def test_null_is_absent_in_a_schedule() -> None:
    entry = {"id": "a", "start": 0, "end": 3, "rank": None, "occurrence": None, "mode": None}
    raw = {"actions": [{**entry, "resources": None}], "status": None, "irc_schedule": None}
    assert schedule_from_json(raw) == schedule_from_json({"actions": [without_nulls(entry)]})


def test_null_removes_a_deadline() -> None:
    change = {"op": "set_deadline", "action": "a", "deadline": None, "group": None}
    assert without_nulls(change) == {"op": "set_deadline", "action": "a", "deadline": None}


def test_a_document_without_null_stays_the_same_object() -> None:
    document = {"a": [{"b": 1}], "metadata": {"x": None}}
    assert without_nulls(document) is document


def test_the_command_prints_it_in_one_line() -> None:
    assert json.loads(run_irc("schema", "--strict").stdout) == strict_schema()
    assert json.loads(run_irc("schema", "--strict", "--event").stdout) == strict_schema("event")
    assert run_irc("schema", "--event").exit_code == 2
