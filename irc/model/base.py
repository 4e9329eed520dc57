"""The base of all parts of the IR: strict parsing, names, times."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, PlainSerializer, PlainValidator, WithJsonSchema

from irc.model.quantities import Number, Quantity, level_of
from irc.model.quantities import Span as _Span
from irc.model.times import Instant as _Instant
from irc.model.times import json_number, parse_day_time, parse_instant, parse_span


class Node(BaseModel):
    """A frozen part of the IR; an unknown field is an error, never ignored."""

    model_config = ConfigDict(
        extra="forbid",
        frozen=True,
        populate_by_name=True,
        defer_build=True,
        hide_input_in_errors=True,
    )


def write_time(value: Any) -> Any:
    """A time as JSON: whole numbers as integers, units as they were written, the rest as text."""
    if isinstance(value, int):
        return value
    if isinstance(value, Quantity):
        return value.text
    if hasattr(value, "isoformat"):
        return value.isoformat()
    return json_number(value)


_TIME_SCHEMA: dict[str, Any] = {
    "anyOf": [
        {"type": "number"},
        {"type": "string", "examples": ["1 h 30 min", "PT1H30M", "90 days", "1/3"]},
    ]
}

Span = Annotated[
    _Span,
    PlainValidator(parse_span),
    PlainSerializer(write_time),
    WithJsonSchema(
        {**_TIME_SCHEMA, "description": "A length of time, in time_unit or with units."}
    ),
]
Instant = Annotated[
    _Instant,
    PlainValidator(parse_instant),
    PlainSerializer(write_time),
    WithJsonSchema({**_TIME_SCHEMA, "description": "A time after t = 0, or a date-time."}),
]
DayTime = Annotated[
    str | _Span,
    PlainValidator(parse_day_time),
    PlainSerializer(lambda value: value if isinstance(value, str) else write_time(value)),
    WithJsonSchema(
        {
            "anyOf": [
                {"type": "number"},
                {"type": "string", "examples": ["06:00", "22:30", "24:00", "8 h"]},
            ],
            "description": "A time of day, or the time since the beginning of a cycle.",
        }
    ),
]
Name = Annotated[str, Field(min_length=1, strict=True)]
Count = Annotated[int, Field(ge=0, strict=True)]
Amount = Annotated[int, Field(ge=1, strict=True)]
Text = Annotated[str, Field(min_length=0), WithJsonSchema({"type": "string"})]
"""A text. (Without a constraint pydantic would take half a character, which cannot be written.)"""

Level = Annotated[
    Number,
    PlainValidator(level_of),
    PlainSerializer(write_time),
    WithJsonSchema(
        {
            "anyOf": [{"type": "number"}, {"type": "string", "examples": ["1/3"]}],
            "description": "An exact number, without a unit.",
        }
    ),
]
"""The level of a number variable, or a bound on it or change of it."""

StateValue = (
    Annotated[bool, Field(strict=True)]
    | Annotated[str, Field(min_length=0, strict=True), WithJsonSchema({"type": "string"})]
)

AnyValue = StateValue | Level
"""The value of a state variable: one of its values, or the level of a number variable."""
