"""Certain repairs as JSON patches (RFC 6902)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from irc.diagnostics.source import Pointer, pointer_text


@dataclass(frozen=True, slots=True)
class Operation:
    """One operation of a JSON patch. `origin` is the member `from` of RFC 6902."""

    op: Literal["replace", "remove", "move"]
    path: Pointer
    value: Any = None
    origin: Pointer | None = None

    @property
    def target(self) -> Pointer:
        """The path of the element, in the document before the patch, that the operation changes."""
        return self.path if self.origin is None else self.origin

    def to_dict(self) -> dict[str, Any]:
        """The operation as RFC 6902 writes it."""
        shown: dict[str, Any] = {"op": self.op}
        if self.origin is not None:
            shown["from"] = pointer_text(self.origin)
        shown["path"] = pointer_text(self.path)
        if self.op == "replace":
            shown["value"] = self.value
        return shown


Fix = tuple[Operation, ...]
"""The operations that repair one finding, in an order in which they can be applied."""


def replaced(pointer: Pointer, value: Any) -> Fix:
    """A fix that puts another value in the same place."""
    return (Operation("replace", pointer, value),)


def removed(*pointers: Pointer) -> Fix:
    """A fix that removes elements, the last one first."""
    return tuple(Operation("remove", p) for p in sorted(pointers, key=_order, reverse=True))


def renamed(pointer: Pointer, key: str) -> Fix:
    """A fix that gives a member of an object another key."""
    return (Operation("move", (*pointer[:-1], key), origin=pointer),)


def _order(pointer: Pointer) -> tuple[tuple[int, int, str], ...]:
    """A sort key: elements of an array by index, and parts of an element after it."""
    return tuple((0, p, "") if isinstance(p, int) else (1, 0, p) for p in pointer)
