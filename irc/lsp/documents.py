"""The present texts of the documents that are open in the editor."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from irc.lsp.positions import Encoding, Lines, whole_characters

_SUFFIXES = {"irc": ".irc", "json": ".json", "jsonc": ".json", "plaintext": ".txt", "text": ".txt"}
"""The suffix for the name of a text without a file, by its language in the editor."""


@dataclass(frozen=True, eq=False)
class Document:
    """One state of an open text. Every change makes another object, so identity shows a change."""

    uri: str
    version: int
    lines: Lines
    name: str
    path: Path | None
    """Its file, if it has one; included files are relative to it."""

    @property
    def text(self) -> str:
        """The whole text."""
        return self.lines.text


@dataclass(frozen=True, slots=True)
class Change:
    """A change: `text` replaces the text between two positions, or the whole text without them."""

    text: str
    start: tuple[int, int] | None = None
    end: tuple[int, int] | None = None


class Documents:
    """The open documents by URI."""

    def __init__(self) -> None:
        self.encoding = Encoding.UTF_16
        self._open: dict[str, Document] = {}

    def __iter__(self) -> Iterator[Document]:
        return iter(list(self._open.values()))

    def get(self, uri: str) -> Document | None:
        """The present state of a document, if it is open."""
        return self._open.get(uri)

    def is_current(self, document: Document) -> bool:
        """Whether a document has not been changed or closed since."""
        return self._open.get(document.uri) is document

    def open(
        self, uri: str, version: int, text: str, path: Path | None, language: str = ""
    ) -> Document:
        """Adds a text that was opened."""
        name = f"untitled{_SUFFIXES.get(language, '')}" if path is None else str(path)
        found = Document(uri, version, self._lines(text), name, path)
        self._open[uri] = found
        return found

    def change(self, uri: str, version: int, changes: Iterable[Change]) -> Document | None:
        """The document after changes, applied one after the other; None if it is not open."""
        known = self._open.get(uri)
        if known is None:
            return None
        lines = known.lines
        for change in changes:
            lines = self._lines(_changed(lines, change))
        found = Document(uri, version, lines, known.name, known.path)
        self._open[uri] = found
        return found

    def close(self, uri: str) -> None:
        """Removes a text that was closed."""
        self._open.pop(uri, None)

    def _lines(self, text: str) -> Lines:
        return Lines(whole_characters(text), self.encoding)


def _changed(lines: Lines, change: Change) -> str:
    if change.start is None or change.end is None:
        return change.text
    start, end = lines.offset(*change.start), lines.offset(*change.end)
    return lines.text[:start] + change.text + lines.text[max(start, end) :]
