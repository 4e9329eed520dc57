"""The texts that the editor has open, as they are now."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from irc.lsp.positions import Encoding, Lines, whole_characters

_SUFFIXES = {"irc": ".irc", "json": ".json", "jsonc": ".json", "plaintext": ".txt", "text": ".txt"}
"""What a text that has no file yet would be called, by the language the editor takes it for."""


@dataclass(frozen=True, eq=False)
class Document:
    """One state of an open text. Every change makes another one, so identity tells what is new."""

    uri: str
    version: int
    lines: Lines
    name: str
    path: Path | None
    """Its file, where it has one: what it includes is looked for beside it."""

    @property
    def text(self) -> str:
        """The whole text."""
        return self.lines.text


@dataclass(frozen=True, slots=True)
class Change:
    """What stands between two positions becomes `text`; without positions, all of it does."""

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
        """The document as it is now, if it is open."""
        return self._open.get(uri)

    def is_current(self, document: Document) -> bool:
        """Whether it has not been changed or closed since."""
        return self._open.get(document.uri) is document

    def open(
        self, uri: str, version: int, text: str, path: Path | None, language: str = ""
    ) -> Document:
        """Takes a text in."""
        name = f"untitled{_SUFFIXES.get(language, '')}" if path is None else str(path)
        found = Document(uri, version, self._lines(text), name, path)
        self._open[uri] = found
        return found

    def change(self, uri: str, version: int, changes: Iterable[Change]) -> Document | None:
        """Applies changes, one after the other; None where no such text is open."""
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
        """Forgets a text."""
        self._open.pop(uri, None)

    def _lines(self, text: str) -> Lines:
        return Lines(whole_characters(text), self.encoding)


def _changed(lines: Lines, change: Change) -> str:
    if change.start is None or change.end is None:
        return change.text
    start, end = lines.offset(*change.start), lines.offset(*change.end)
    return lines.text[:start] + change.text + lines.text[max(start, end) :]
