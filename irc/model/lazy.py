"""The `events` of a task, whose twenty models are built only for tasks that have events."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, TypeAdapter, ValidationError
from pydantic_core import core_schema

if TYPE_CHECKING:
    from irc.model.events import Event


@cache
def events_adapter() -> TypeAdapter[tuple[Event, ...]]:
    """Validates the `events` array of a task; its locations start at the array."""
    from irc.model.events import Event

    return TypeAdapter(tuple[Event, ...])


def _validate(raw: Any) -> Any:
    if raw == ():
        return ()
    try:
        return events_adapter().validate_python(raw)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        path = ".".join(str(part) for part in first["loc"])
        raise ValueError(f"events.{path}: {first['msg']}") from None


class _EventsSchema:
    def __get_pydantic_core_schema__(
        self, _source: Any, _handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(_validate)

    def __get_pydantic_json_schema__(
        self, _schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return handler(events_adapter().core_schema)


if TYPE_CHECKING:
    Events = tuple[Event, ...]
else:
    Events = Annotated[Any, _EventsSchema()]
