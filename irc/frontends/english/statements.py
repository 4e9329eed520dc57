"""The statements of sentences: references to steps, points in time, and orders."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Literal


@dataclass(frozen=True, slots=True)
class Ref:
    """A reference of a sentence to steps, at [start, end) of the text.

    Kinds: "label", "range", "name", "nth", and the words "this", "first", "last", "previous",
    "all_previous", "all_other", "all".
    """

    kind: str
    value: tuple[Any, ...]
    start: int
    end: int


Refs = tuple[Ref, ...]
Edge = Literal["start", "end"]


@dataclass(frozen=True, slots=True)
class Point:
    """The start or the end of each of some steps."""

    refs: Refs
    edge: Edge


@dataclass(frozen=True, slots=True)
class Length:
    """An exact length of time; `text` is how the IR writes it."""

    text: str
    seconds: Fraction
    months: Fraction
    unit: str
    """The smallest unit in its text."""

    @property
    def document(self) -> Any:
        """Its value in the IR."""
        return self.text


@dataclass(frozen=True, slots=True)
class Between:
    """A length of time within bounds, both included."""

    least: Length
    most: Length

    @property
    def unit(self) -> str:
        """The unit of its lower bound."""
        return self.least.unit

    @property
    def document(self) -> Any:
        """Its value in the IR."""
        return {"min": self.least.text, "max": self.most.text}


Time = Length | Between


@dataclass(frozen=True, slots=True)
class Ordering:
    """`after` is not earlier than `before`, with a lag within bounds if they are given."""

    before: Point
    after: Point
    least: Length | None = None
    most: Length | None = None


@dataclass(frozen=True, slots=True)
class Chain:
    """Groups of steps one after the other."""

    groups: tuple[Refs, ...]


@dataclass(frozen=True, slots=True)
class StoryPart:
    """A part of a story: "first", "then" (after the previous part) or "finally"."""

    when: Literal["first", "then", "finally"]
    refs: Refs


@dataclass(frozen=True, slots=True)
class Place:
    """Steps before ("first") or after ("last") all others, or in the given order."""

    where: Literal["first", "last", "in order"]
    refs: Refs


@dataclass(frozen=True, slots=True)
class OthersAfter:
    """No other step starts before this point."""

    point: Point


@dataclass(frozen=True, slots=True)
class EachAfterPrevious:
    """The steps follow each other in the order of the list."""


@dataclass(frozen=True, slots=True)
class Free:
    """No order among these steps, or none before them ("unconstrained")."""

    refs: Refs
    against: Literal["each other", "all"]


@dataclass(frozen=True, slots=True)
class Apart:
    """No two of these steps (or none of these and none of the others) overlap."""

    refs: Refs
    others: Refs = ()
    pair: bool = False
    """Whether the sentence is about two steps; for more it would be ambiguous."""


@dataclass(frozen=True, slots=True)
class AtATime:
    """At most `most` steps run at any time."""

    most: int


@dataclass(frozen=True, slots=True)
class Deadline:
    """All steps end by this time."""

    time: Length


@dataclass(frozen=True, slots=True)
class Takes:
    """The duration of steps; several steps need the word "each"."""

    refs: Refs
    time: Time
    each: bool


@dataclass(frozen=True, slots=True)
class Selects:
    """At least `least` and at most `most` (None: all) of the steps are done; or all, or none."""

    refs: Refs
    least: int = 0
    most: int | None = None
    all_or_none: bool = False


@dataclass(frozen=True, slots=True)
class Due:
    """Steps should end by this time; to end later costs lateness."""

    refs: Refs
    time: Length


@dataclass(frozen=True, slots=True)
class UsesThing:
    """Steps use one of some things, or an `amount` of a thing of which there are several.

    Set-ups depend on the `family`.
    """

    refs: Refs
    things: tuple[str, ...]
    family: str | None = None
    amount: int | None = None
    capacity: int | None = None


@dataclass(frozen=True, slots=True)
class UsesTheSame:
    """Steps use the same one of some things of a kind: `others` (or the first) say which."""

    refs: Refs
    kind: str
    others: Refs = ()


@dataclass(frozen=True, slots=True)
class OpenTimes:
    """A thing is open, or closed, from one hour to another, on some days of the week.

    No thing: all work. No days: every day. It may be closed on whole `dates` instead.
    """

    thing: str | None
    begin: str
    end: str
    days: tuple[str, ...] = ()
    dates: tuple[str, ...] = ()
    closed: bool = False


@dataclass(frozen=True, slots=True)
class Changes:
    """To change a thing from one family to another takes time."""

    thing: str
    before: str
    after: str
    time: Length


@dataclass(frozen=True, slots=True)
class MayPause:
    """Steps pause at closed times."""

    refs: Refs


@dataclass(frozen=True, slots=True)
class Begins:
    """The date and hour of t = 0, as the IR writes them."""

    origin: str


@dataclass(frozen=True, slots=True)
class Frame:
    """A sentence around the task, such as the question, with its free text if it has any."""

    kind: Literal["plain", "titled", "orders", "all needed", "unbounded", "no orders", "unit"]
    text: str = ""
    start: int = 0


@dataclass(frozen=True, slots=True)
class Refused:
    """A sentence that is understood but not exact enough; `reason` is a key of `REASONS`."""

    reason: str


Statement = (
    Ordering
    | Chain
    | StoryPart
    | Place
    | OthersAfter
    | EachAfterPrevious
    | Free
    | Apart
    | AtATime
    | Deadline
    | Takes
    | Selects
    | Due
    | UsesThing
    | UsesTheSame
    | OpenTimes
    | Changes
    | MayPause
    | Begins
    | Frame
    | Refused
)
