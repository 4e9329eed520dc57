"""A text with edits that make it JSON, and the way back from its places to the original's."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from irc.diagnostics import Diagnostic
from irc.diagnostics.fix import TextEdit
from irc.diagnostics.source import Locator, Pointer, Range


@dataclass(frozen=True)
class Mended:
    """`text` is `original` with edits. What begins at `starts[k]` of it was at `origins[k]`.

    A place inside a text that an edit wrote is that of the edit.
    """

    original: str
    text: str
    starts: tuple[int, ...]
    origins: tuple[int, ...]
    copied: tuple[bool, ...]

    @classmethod
    def of(cls, original: str, edits: Iterable[TextEdit]) -> Mended:
        """The text with edits, which do not overlap."""
        pieces: list[str] = []
        starts, origins, copied = [0], [0], [True]
        done = length = 0

        def begin(origin: int, is_copy: bool) -> None:
            starts.append(length)
            origins.append(origin)
            copied.append(is_copy)

        for edit in sorted(edits):
            pieces.append(original[done : edit.start])
            length += edit.start - done
            begin(edit.start, False)
            pieces.append(edit.text)
            length += len(edit.text)
            done = edit.end
            begin(done, True)
        pieces.append(original[done:])
        return cls(original, "".join(pieces), tuple(starts), tuple(origins), tuple(copied))

    def back(self, offset: int) -> int:
        """The place in the original of a place in the text."""
        k = bisect_right(self.starts, offset) - 1
        return self.origins[k] + (offset - self.starts[k] if self.copied[k] else 0)

    def placed(self, finding: Diagnostic) -> Diagnostic:
        """A finding about the text, at its place in the original."""
        assert finding.offset is not None
        return replace(finding, offset=self.back(finding.offset))

    def locator(self, locate: Locator) -> Locator:
        """A locator of elements in the original; `locate` finds them in the text."""
        return _Back(self, locate)


@dataclass(frozen=True)
class _Back:
    mended: Mended
    locate: Locator

    def __call__(self, text: str, wanted: frozenset[Pointer]) -> Mapping[Pointer, Range]:
        back = self.mended.back
        return {
            pointer: place._replace(
                start=back(place.start),
                end=max(back(place.end), back(place.start)),
                key_start=None if place.key_start is None else back(place.key_start),
            )
            for pointer, place in self.locate(self.mended.text, wanted).items()
        }
