"""Sources: the text of a document, and the place of each element in it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

Pointer = tuple[str | int, ...]
"""A path into the document: keys and array indexes, as in RFC 6901."""

Locator = Callable[[str, frozenset[Pointer]], Mapping[Pointer, "Range"]]
"""Finds elements in a text. A front end supplies the one for its language."""


class Range(NamedTuple):
    """Offsets into the text: [start, end) of a value, and the start of its key if it has one.

    `within` is the text, if that is not the task's own: a file that it includes. `written` is the
    path as the text itself spells it, for texts that JSON patches apply to.
    """

    start: int
    end: int
    key_start: int | None = None
    within: Source | None = None
    written: Pointer | None = None


def pointer_text(pointer: Pointer) -> str:
    """The RFC 6901 text of a path: "/actions/3/duration"."""
    return "".join(f"/{str(part).replace('~', '~0').replace('/', '~1')}" for part in pointer)


@dataclass(frozen=True)
class Source:
    """A named text and a locator for its elements.

    Positions are computed only when a diagnostic needs them, so a task without faults pays nothing.
    The locator must be picklable: a function of a module, or an object of a class.
    """

    name: str
    text: str
    locator: Locator | None = field(default=None, compare=False, repr=False)
    _found: dict[Pointer, Range | None] = field(default_factory=dict, repr=False, compare=False)
    _counted: list[int] = field(default_factory=lambda: [0, 0, 0], repr=False, compare=False)
    """The last offset, the number of lines that end before it, and the start of its line."""

    def line_and_column(self, offset: int) -> tuple[int, int]:
        """1-based line and column (in characters) of an offset."""
        counted, lines, begin = self._counted
        if offset < begin:
            counted, lines, begin = 0, 0, 0
        # Count on from the last offset: a line may be long and have many findings.
        if more := self.text.count("\n", counted, offset):
            lines, begin = lines + more, self.text.rfind("\n", counted, offset) + 1
        self._counted[:] = [max(offset, counted), lines, begin]
        return lines + 1, offset - begin + 1

    def line_at(self, offset: int) -> str:
        """The text of the line that contains an offset, without its line end."""
        start = self.text.rfind("\n", 0, offset) + 1
        end = self.text.find("\n", offset)
        return self.text[start : end if end >= 0 else len(self.text)].rstrip("\r")

    def locate(self, pointers: Iterable[Pointer]) -> Mapping[Pointer, Range | None]:
        """The place of each element, or of its nearest known ancestor if it has none itself."""
        missing = {p for p in pointers if p not in self._found}
        if missing and self.locator is not None:
            wanted = frozenset(p[:n] for p in missing for n in range(len(p) + 1))
            places = self.locator(self.text, wanted)
            for pointer in missing:
                self._found[pointer] = next(
                    (
                        places[pointer[:n]]
                        for n in range(len(pointer), -1, -1)
                        if pointer[:n] in places
                    ),
                    None,
                )
        return self._found
