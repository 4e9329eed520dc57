"""Where a task was read from, and where in that text each of its elements stands."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field

Pointer = tuple[str | int, ...]
"""A path into the document: keys and array indexes, as in RFC 6901."""

Locator = Callable[[str, frozenset[Pointer]], Mapping[Pointer, "Range"]]
"""Finds elements in a text. A front end supplies the one for its language."""


@dataclass(frozen=True, slots=True)
class Range:
    """Offsets into the text: [start, end) of a value, and of its key where it has one.

    `within` is the text where that is another one than the task's own: a file it includes.
    `written` is the path as the text itself spells it, for texts that JSON patches apply to.
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
    """A named text and the way to find an element in it.

    Positions are looked up only when a diagnostic needs them, so a good task pays nothing. The
    locator must be one that can be pickled: a module's function, or an object of a class.
    """

    name: str
    text: str
    locator: Locator | None = field(default=None, compare=False, repr=False)
    _found: dict[Pointer, Range | None] = field(default_factory=dict, repr=False, compare=False)
    _counted: list[int] = field(default_factory=lambda: [0, 0, 0], repr=False, compare=False)
    """An offset that was asked for, how many lines end before it, and where its line begins."""

    def line_and_column(self, offset: int) -> tuple[int, int]:
        """1-based line and column (in characters) of an offset."""
        counted, lines, begin = self._counted
        if offset < begin:
            counted, lines, begin = 0, 0, 0
        # What was counted is not counted again: a line may be long, and asked for often.
        if more := self.text.count("\n", counted, offset):
            lines, begin = lines + more, self.text.rfind("\n", counted, offset) + 1
        self._counted[:] = [max(offset, counted), lines, begin]
        return lines + 1, offset - begin + 1

    def line_at(self, offset: int) -> str:
        """The text of the line an offset is in, without its line end."""
        start = self.text.rfind("\n", 0, offset) + 1
        end = self.text.find("\n", offset)
        return self.text[start : end if end >= 0 else len(self.text)].rstrip("\r")

    def locate(self, pointers: Iterable[Pointer]) -> Mapping[Pointer, Range | None]:
        """The place of each element; of its nearest known ancestor where it has none itself."""
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
