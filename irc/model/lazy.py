"""Fields whose types are loaded and built only for tasks that use them.

pydantic builds a validator for every model it can reach. Most tasks have no events, no state, no
groups, and a start of the command line should not wait for those forty models.
"""

from __future__ import annotations

from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationError
from pydantic_core import core_schema

from irc.errors import IrcError

if TYPE_CHECKING:
    from pydantic import TypeAdapter


class PartError(IrcError, ValueError):
    """The faults of a lazily typed field: pydantic's own, with locations from the field on."""

    def __init__(self, error: ValidationError) -> None:
        self.faults = error.errors(include_url=False)
        first = self.faults[0]
        place = ".".join(str(part) for part in first["loc"])
        super().__init__(f"{place}: {first['msg']}" if place else first["msg"])


@cache
def adapter(module: str, name: str) -> TypeAdapter[Any]:
    """The validator of a type alias in a module of the model."""
    from pydantic import TypeAdapter

    return TypeAdapter(getattr(import_module(module), name))


class Lazy:
    """Marks a field whose type is loaded at the first value other than `known`."""

    def __init__(self, module: str, name: str, known: tuple[Any, ...] = ((),)) -> None:
        self.module, self.name, self.known = f"irc.model.{module}", name, known

    def _validate(self, raw: Any) -> Any:
        if any(raw is k for k in self.known) or (isinstance(raw, str) and raw in self.known):
            return raw
        try:
            return adapter(self.module, self.name).validate_python(raw)
        except ValidationError as error:
            raise PartError(error) from None

    def __get_pydantic_core_schema__(
        self, _source: Any, _handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(self._validate)

    def __get_pydantic_json_schema__(
        self, _schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return handler(adapter(self.module, self.name).core_schema)


if TYPE_CHECKING:
    from irc.model.details import (
        Calendars,
        Conditions,
        Couplings,
        Effects,
        Goals,
        Groups,
        Lapses,
        Modes,
        Occurs,
        ResourceSetups,
        Selections,
        Sequences,
        State,
        StockChanges,
        Windows,
    )
    from irc.model.events import Events
else:
    Calendars = Annotated[Any, Lazy("details", "Calendars")]
    Conditions = Annotated[Any, Lazy("details", "Conditions")]
    Couplings = Annotated[Any, Lazy("details", "Couplings")]
    Effects = Annotated[Any, Lazy("details", "Effects")]
    Events = Annotated[Any, Lazy("events", "Events")]
    Goals = Annotated[Any, Lazy("details", "Goals")]
    Groups = Annotated[Any, Lazy("details", "Groups")]
    Lapses = Annotated[Any, Lazy("details", "Lapses")]
    Modes = Annotated[Any, Lazy("details", "Modes")]
    Occurs = Annotated[Any, Lazy("details", "Occurs", ("once", "optional"))]
    ResourceSetups = Annotated[Any, Lazy("details", "ResourceSetups", (None,))]
    Selections = Annotated[Any, Lazy("details", "Selections")]
    Sequences = Annotated[Any, Lazy("details", "Sequences")]
    State = Annotated[Any, Lazy("details", "State")]
    StockChanges = Annotated[Any, Lazy("details", "StockChanges")]
    Windows = Annotated[Any, Lazy("details", "Windows")]

__all__ = [
    "Calendars",
    "Conditions",
    "Couplings",
    "Effects",
    "Events",
    "Goals",
    "Groups",
    "Lapses",
    "Lazy",
    "Modes",
    "Occurs",
    "PartError",
    "ResourceSetups",
    "Selections",
    "Sequences",
    "State",
    "StockChanges",
    "Windows",
    "adapter",
]
