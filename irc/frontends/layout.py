"""`irc fmt`: rewrites a task file in the standard layout of its language, with the same meaning."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from irc.diagnostics import Code, Diagnostic, InputError, Report
from irc.driver.files import write_whole
from irc.frontends.language import language_of
from irc.frontends.texts import STANDARD_INPUT, read_text


@dataclass(frozen=True)
class Layout:
    """A text, and the same text in the standard layout."""

    text: str
    laid_out: str

    @property
    def changed(self) -> bool:
        """Whether the two differ."""
        return self.text != self.laid_out


def lay_out(text: str, name: str) -> Layout:
    """The layout of a text in any language.

    Raises `InputError` for a text that cannot be read, or that is JSON with other text around it.
    """
    if language_of(text, name) == "dsl":
        from irc.frontends.dsl.formatter import formatted

        return Layout(text, formatted(text, name))
    from irc.frontends.json.document import read_document
    from irc.frontends.json.layout import laid_out

    document = read_document(text, name)
    around = [d for d in document.notes.items if d.code is Code.SURROUNDED]
    if around:
        refused = Diagnostic(
            Code.SYNTAX,
            "there is other text around the JSON document, which formatting would lose",
            hint="remove it, or write the task with `irc convert`",
            offset=around[0].offset,
        )
        raise InputError(Report((refused,), document.source))
    return Layout(text, laid_out(document.source.text))


def lay_out_file(file: str, *, check: bool = False) -> Layout:
    """Formats a file in place, as a whole or not at all; with `check` only reads it.

    "-" is standard input, which is only read. Raises `InputError` or `WriteError`.
    """
    text, name = read_text(file)
    found = lay_out(text, name)
    if found.changed and not check and file != STANDARD_INPUT:
        path = Path(file).resolve()
        write_whole(path, found.laid_out, mode=path.stat().st_mode & 0o7777)
    return found
