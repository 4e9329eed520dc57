"""Certain repairs as JSON patches (RFC 6902)."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal
from typing import Any, Literal, NamedTuple

from irc.diagnostics.source import Pointer, pointer_text


class TextEdit(NamedTuple):
    """An edit: `text` replaces [start, end) of a text."""

    start: int
    end: int
    text: str


@dataclass(frozen=True, slots=True)
class Operation:
    """One operation of a JSON patch. `origin` is the member `from` of RFC 6902.

    An operation "add" appends to an array of the document, which is made if it is not there. What
    it adds stood in another form at `because`.
    """

    op: Literal["replace", "remove", "move", "add"]
    path: Pointer
    value: Any = None
    origin: Pointer | None = None
    because: Pointer = ()

    @property
    def target(self) -> Pointer:
        """The path of the element, in the document before the patch, that the operation changes."""
        if self.op == "add":
            return self.path[:-1]
        return self.path if self.origin is None else self.origin

    def to_dict(self) -> dict[str, Any]:
        """The operation as RFC 6902 writes it."""
        shown: dict[str, Any] = {"op": self.op}
        if self.origin is not None:
            shown["from"] = pointer_text(self.origin)
        shown["path"] = pointer_text(self.path)
        if self.op in ("replace", "add"):
            shown["value"] = plain(self.value)
        return shown


def plain(value: Any) -> Any:
    """A value as JSON writes it, with floats for exact decimals."""
    if isinstance(value, Decimal):
        return int(value) if value == value.to_integral_value() else float(value)
    if isinstance(value, Mapping):
        return {key: plain(inner) for key, inner in value.items()}
    return [plain(inner) for inner in value] if isinstance(value, (list, tuple)) else value


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


def moved(origin: Pointer, path: Pointer) -> Fix:
    """A fix that puts an element in another place; the empty path: in that of the document."""
    return (Operation("move", path, origin=origin),)


def added(array: Pointer, value: Any, because: Pointer) -> Operation:
    """The operation that appends a value to an array, which stood at `because` in another form."""
    return Operation("add", (*array, "-"), value, because=because)


def _order(pointer: Pointer) -> tuple[tuple[int, int, str], ...]:
    """A sort key: elements of an array by index, and parts of an element after it."""
    return tuple((0, p, "") if isinstance(p, int) else (1, 0, p) for p in pointer)


_LONGEST_SHOWN = 80


def change_text(fix: Fix, edits: tuple[TextEdit, ...]) -> str:
    """The change that the repair of one finding makes, in words."""
    if edits:
        written = [edit.text for edit in edits if edit.text]
        if not written:
            return "removed"
        if len(written) < len(edits) or len(written) > 1:
            return f"rewritten in {len(edits)} places"
        return f"written as {_cut(written[0])}"
    first = fix[0]
    if any(o.op == "add" for o in fix):
        array = next(o.target[-1] for o in fix if o.op == "add")
        return f"moved to `{array}`"
    move = next((o for o in fix if o.op == "move"), None)
    if move is not None and not move.path:
        return "its contents are the document"
    value = next((o.value for o in fix if o.op == "replace"), None)
    shown = _cut(json.dumps(plain(value), ensure_ascii=False))
    if move is not None:
        now = f"renamed to `{move.path[-1]}`"
        return now if value is None else f"{now}: {shown}"
    return "removed" if first.op == "remove" else f"now {shown}"


def _cut(text: str) -> str:
    text = " ".join(text.split())
    return text if len(text) <= _LONGEST_SHOWN else f"{text[: _LONGEST_SHOWN - 2]} …"
