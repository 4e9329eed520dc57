"""The whole document (docs/ir.md)."""

from __future__ import annotations

from datetime import datetime
from fractions import Fraction
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field, PrivateAttr, field_validator, model_validator

from irc.diagnostics.source import Source
from irc.model.base import Instant, Node, Span, Text
from irc.model.lazy import (
    Calendars,
    Couplings,
    Events,
    Goals,
    Groups,
    Lapses,
    Selections,
    Sequences,
    State,
)
from irc.model.original import Original
from irc.model.parts import (
    Action,
    Objective,
    Precedence,
    Resource,
    objective_names,
    without_aliases,
)
from irc.model.quantities import Number, TimeError
from irc.model.quantities import Span as SpanValue
from irc.model.resolution import derived_resolution
from irc.model.times import Clock, parse_instant, unit_seconds
from irc.model.times import Instant as InstantValue
from irc.model.unwritable import unwritable

if TYPE_CHECKING:
    from irc.model.columns import Columns


class Task(Node):
    """The whole document.

    >>> task = Task(actions=[{"id": "boil", "duration": "4 min"}])
    >>> task.actions[0].duration.seconds
    Fraction(240, 1)
    """

    irc: Literal["1"] = "1"
    name: Text | None = None
    description: Text | None = None
    time_unit: str = "s"
    days_per_month: Annotated[int, Field(ge=1, le=31, strict=True)] = 30
    deadline: Instant | None = None
    origin: datetime | None = None
    resolution: Span | None = None
    metadata: dict[str, Any] = Field(default_factory=dict)
    calendars: Calendars = ()
    resources: tuple[Resource, ...] = ()
    state: State = ()
    actions: tuple[Action, ...]
    precedence: tuple[Precedence, ...] = ()
    groups: Groups = ()
    couplings: Couplings = ()
    select: Selections = ()
    sequences: Sequences = ()
    goals: Goals = ()
    objective: Annotated[tuple[Objective, ...], Field(min_length=1)] = ("minimize_makespan",)
    events: Events = ()
    lapsed: Lapses = ()

    _source: Source | None = PrivateAttr(default=None)
    _clock: tuple[tuple[Any, ...], Clock] | None = PrivateAttr(default=None)
    _original: tuple[tuple[Any, ...], Original] | None = PrivateAttr(default=None)

    @model_validator(mode="before")
    @classmethod
    def _read_aliases(cls, raw: Any) -> Any:
        if not isinstance(raw, dict) or "dependencies" not in raw:
            return raw
        return without_aliases(raw, {"dependencies": "precedence"})

    @field_validator("time_unit")
    @classmethod
    def _known_unit(cls, unit: str) -> str:
        unit_seconds(unit)
        return unit

    @field_validator("resolution")
    @classmethod
    def _more_than_nothing(cls, resolution: SpanValue | None) -> SpanValue | None:
        if resolution is not None and Clock(Fraction(1)).exact(resolution) <= 0:
            raise TimeError("a resolution is more than 0, such as '1 ms'")
        return resolution

    @field_validator("origin", mode="before")
    @classmethod
    def _date_time(cls, raw: Any) -> datetime | None:
        origin = None if raw is None else parse_instant(raw)
        if origin is not None and not isinstance(origin, datetime):
            raise TimeError("expected a date-time such as 2026-03-01T08:00:00Z")
        return origin

    @field_validator("metadata", mode="before")
    @classmethod
    def _writable(cls, metadata: Any) -> Any:
        """Metadata as JSON can hold them: a NaN or half a character is refused here."""
        if metadata and (fault := unwritable(metadata)) is not None:
            raise ValueError(fault)
        return metadata

    _one_objective = field_validator("objective", mode="before")(objective_names)

    def __eq__(self, other: object) -> bool:
        """Whether the contents are equal, whatever file they were read from."""
        return self.__dict__ == other.__dict__ if isinstance(other, Task) else NotImplemented

    __hash__ = None  # type: ignore[assignment]

    @property
    def source(self) -> Source | None:
        """The text this task was read from, if it was."""
        return self._source

    def with_source(self, source: Source | None) -> Task:
        """This task, with the text that it was read from."""
        self._source = source
        return self

    @property
    def columns(self) -> Columns | None:
        """Its actions and precedences as columns, if it is kept so (`irc.model.columns`)."""
        return None

    @property
    def original(self) -> Original | None:
        """The PDDL that this very task was made of; None for any other, and for a changed copy."""
        if self._original is None:
            return None
        made, original = self._original
        now = self.__dict__.values()
        return original if all(a is b for a, b in zip(made, now, strict=True)) else None

    def with_original(self, original: Original) -> Task:
        """This task, with the PDDL that it was made of."""
        self._original = tuple(self.__dict__.values()), original
        return self

    @property
    def clock(self) -> Clock:
        """The clock that converts this task's times to numbers of its time unit."""
        # (Everything that it depends on; a copy of the task may differ in some of it.)
        read = self.__dict__
        now = tuple(map(read.__getitem__, _CLOCK_FIELDS))
        known = self._clock
        if known is None or any(a is not b for a, b in zip(known[0], now, strict=True)):
            exact = () if known is None or known[1].resolution is not None else known[0]
            known = self._clock = now, self._new_clock(exact)
        return known[1]

    def _new_clock(self, exact: tuple[Any, ...]) -> Clock:
        """The clock; the parts in `exact` are known to have no raw times."""
        unit = unit_seconds(self.time_unit, self.days_per_month)
        clock = Clock(unit, self.days_per_month, self.origin)
        if self.calendars:
            from irc.model.zones import zone_of_naive_times

            clock = clock._replace(zone=zone_of_naive_times(self))
        if self.resolution is not None:
            resolution: Number | None = clock.exact(self.resolution)
        else:
            resolution = derived_resolution(self, clock, exact)
        return clock if resolution is None else clock._replace(resolution=resolution)

    def number(self, value: InstantValue) -> Number:
        """A time of this task in its time unit, as a multiple of its resolution."""
        return self.clock.number(value)


_CLOCK_FIELDS = (
    "time_unit",
    "days_per_month",
    "origin",
    "resolution",
    "deadline",
    "actions",
    "precedence",
    "resources",
    "groups",
    "calendars",
)
