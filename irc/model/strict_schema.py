"""The JSON Schema of the IR for structured output of language models.

OpenAI's strict mode, Gemini, xgrammar and llguidance each take another part of JSON Schema. This
schema keeps to what all of them take: every object is closed and requires all of its fields, a
field that may be absent may be null, alternatives are `anyOf`, and there are no references, bounds,
patterns or defaults. Every reader of irc takes null as absent. `metadata` is free, so it is left
out, and so are the events of a task; a model that revises a task writes one event.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

Part = Literal["task", "event"]

_LEFT_OUT: Mapping[Part, frozenset[str]] = {
    "task": frozenset(("irc", "metadata", "events", "days_per_month", "origin")),
    "event": frozenset(("id",)),
}
_KEPT = ("type", "enum")
_NULL = {"type": "null"}


def strict_schema(part: Part = "task") -> dict[str, Any]:
    """The closed schema of a task, or of an event that revises one."""
    from pydantic import TypeAdapter

    from irc.model import Event, Task

    whole = TypeAdapter(Task if part == "task" else Event).json_schema(by_alias=True)
    return _object(whole, whole.get("$defs", {}), _LEFT_OUT[part])


def _closed(schema: Mapping[str, Any], defs: Mapping[str, Any]) -> dict[str, Any]:
    """A part of a schema with what every reader of schemas takes."""
    if "$ref" in schema:
        return _closed(defs[schema["$ref"].rsplit("/", 1)[-1]], defs)
    for word in ("anyOf", "oneOf", "allOf"):
        if word in schema:
            return _alternatives([_closed(inner, defs) for inner in schema[word]])
    if "const" in schema:
        return {"type": schema.get("type", "string"), "enum": [schema["const"]]}
    if schema.get("type") == "object":
        return _object(schema, defs)
    if schema.get("type") == "array":
        return {"type": "array", "items": _closed(schema["items"], defs)}
    return {word: schema[word] for word in _KEPT if word in schema}


def _object(
    schema: Mapping[str, Any], defs: Mapping[str, Any], left_out: frozenset[str] = frozenset()
) -> dict[str, Any]:
    needed = schema.get("required", ())
    properties = {
        name: _closed(inner, defs) if name in needed else _nullable(_closed(inner, defs))
        for name, inner in schema.get("properties", {}).items()
        if name not in left_out
    }
    return {
        "type": "object",
        "properties": properties,
        "required": list(properties),
        "additionalProperties": False,
    }


def _nullable(schema: dict[str, Any]) -> dict[str, Any]:
    if "anyOf" in schema or "enum" in schema:
        return _alternatives([schema, _NULL])
    named = schema["type"]
    return {**schema, "type": [named, "null"]} if isinstance(named, str) else schema


def _alternatives(schemas: list[dict[str, Any]]) -> dict[str, Any]:
    """The alternatives, each once, those of alternatives among them; only one is itself."""
    flat: list[dict[str, Any]] = []
    for schema in schemas:
        flat += [s for s in schema.get("anyOf", [schema]) if s not in flat]
    if len(flat) == 1:
        return flat[0]
    if len(flat) == _WITH_NULL and _NULL in flat:
        other = next(s for s in flat if s != _NULL)
        return {"anyOf": flat} if "enum" in other else _nullable(other)
    return {"anyOf": flat}


_WITH_NULL = 2
