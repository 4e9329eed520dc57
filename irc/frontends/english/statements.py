"""What sentences say: references to steps, points in time, and statements about them."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Literal


@dataclass(frozen=True, slots=True)
class Ref:
    """Steps as a sentence names them, at [start, end) of the text.

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
    """The smallest unit it was written in."""

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
class Order:
    """`after` comes no earlier than `before`, with a lag within bounds where they are given."""

    before: Point
    after: Point
    least: Length | None = None
    most: Length | None = None


@dataclass(frozen=True, slots=True)
class Chain:
    """Groups of steps one after the other."""

    groups: tuple[Refs, ...]


@dataclass(frozen=True, slots=True)
class Told:
    """A part of a story: "first", "then" (after what was told before) or "finally"."""

    when: Literal["first", "then", "finally"]
    refs: Refs


@dataclass(frozen=True, slots=True)
class Place:
    """Steps that come before ("first") or after ("last") all others; or in the order named."""

    where: Literal["first", "last", "in order"]
    refs: Refs


@dataclass(frozen=True, slots=True)
class OthersAfter:
    """No other step starts before this point."""

    point: Point


@dataclass(frozen=True, slots=True)
class EachAfterPrevious:
    """The steps follow each other as they are listed."""


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
    """Said of two steps; of more it would be ambiguous."""


@dataclass(frozen=True, slots=True)
class AtATime:
    """At most so many steps run at any time."""

    most: int


@dataclass(frozen=True, slots=True)
class Deadline:
    """All steps end by this time."""

    time: Length


@dataclass(frozen=True, slots=True)
class Takes:
    """How long steps take; several need the word "each"."""

    refs: Refs
    time: Time
    each: bool


@dataclass(frozen=True, slots=True)
class Frame:
    """A sentence that frames the question: what it is said for, and its free text if any."""

    kind: Literal["plain", "titled", "orders", "all needed", "unbounded", "all told", "unit"]
    text: str = ""
    start: int = 0


@dataclass(frozen=True, slots=True)
class Refused:
    """Understood, but not exact enough to compile: `reason` is a key of `REASONS`."""

    reason: str


Statement = (
    Order
    | Chain
    | Told
    | Place
    | OthersAfter
    | EachAfterPrevious
    | Free
    | Apart
    | AtATime
    | Deadline
    | Takes
    | Frame
    | Refused
)
