"""The kinds of values that compiled functions know, and the annotations that stand for them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from types import NoneType
from typing import Annotated, Any, get_args, get_origin

from irc.errors import IrcError

Row = Annotated[Any, 1]
"""An array of whole numbers of 64 bits."""

Table = Annotated[Any, 2]
"""A table of them."""

Tables = Annotated[Any, 3]
"""Some tables of them that have the same size."""


class NotCompiled(IrcError):
    """A function has something that cannot be compiled; the text says what and where."""


@dataclass(frozen=True, slots=True)
class Number:
    """A whole number, or a truth value: 1 or 0."""

    is_truth: bool = False


@dataclass(frozen=True, slots=True)
class Array:
    """An array with a number of dimensions: where it begins, and its size in each of them."""

    dimensions: int


@dataclass(frozen=True, slots=True)
class Several:
    """A tuple; without any, nothing."""

    kinds: tuple[Kind, ...] = ()


Kind = Number | Array | Several

NUMBER, TRUTH, NOTHING = Number(), Number(is_truth=True), Several()


@dataclass(frozen=True, slots=True)
class Value:
    """A value: the names of its parts in LLVM, and for each of its arrays the arguments of the
    function whose memory it can have.
    """

    kind: Kind
    parts: tuple[str, ...]
    roots: tuple[frozenset[str], ...] = ()


def types_of(kind: Kind) -> tuple[str, ...]:
    """The LLVM types of the parts of a value."""
    if isinstance(kind, Number):
        return ("i64",)
    if isinstance(kind, Array):
        return ("ptr", *["i64"] * kind.dimensions)
    return tuple(one for own in kind.kinds for one in types_of(own))


def parts_of(value: Value) -> Iterator[Value]:
    """The members of a tuple."""
    assert isinstance(value.kind, Several)
    parts, roots = iter(value.parts), iter(value.roots)
    for kind in value.kind.kinds:
        types = types_of(kind)
        own = tuple(islice(parts, len(types)))
        yield Value(kind, own, tuple(islice(roots, types.count("ptr"))))


def kind_of(annotation: Any) -> Kind | None:
    """The kind that an annotation stands for; None: an array with any number of dimensions.

    `Annotated[tuple[Row, ...], 22]` is a tuple of 22.
    """
    if annotation in (None, NoneType):
        return NOTHING
    if annotation in (int, bool):
        return Number(annotation is bool)
    if annotation is Any:
        return None
    if get_origin(annotation) is Annotated:
        inner, count = get_args(annotation)
        if inner is Any:
            return Array(count)
        return Several((_member(get_args(inner)[0]),) * count)
    if get_origin(annotation) is tuple and ... not in get_args(annotation):
        return Several(tuple(_member(own) for own in get_args(annotation)))
    raise NotCompiled(f"no kind of value is annotated as {annotation!r}")


def _member(annotation: Any) -> Kind:
    kind = kind_of(annotation)
    # (An array of a tuple has one dimension, where nothing else stands.)
    return Array(1) if kind is None else kind
