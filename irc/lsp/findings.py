"""The findings of a report as an editor shows them: spans of the open text, with messages."""

from __future__ import annotations

from dataclasses import dataclass

from irc.diagnostics import Diagnostic, Severity
from irc.lsp.analysis import MOST_CHARACTERS, Analysis
from irc.lsp.names import Spot

MOST_SHOWN = 1000
"""At most this many findings are shown; then comes the number of the others."""


@dataclass(frozen=True, slots=True)
class Shown:
    """A finding at a span of the text, in offsets of the editor's text.

    `elsewhere` is its place in a file that the text includes, if it is there. `of` is None for a
    message of the server itself.
    """

    start: int
    end: int
    message: str
    of: Diagnostic | None = None
    elsewhere: Spot | None = None


def shown(analysis: Analysis, text: str) -> list[Shown]:
    """The findings to show for a text."""
    if analysis.too_long:
        message = (
            f"the text has more than {MOST_CHARACTERS:,} characters, so it is not checked while "
            "it is typed; run `irc check`"
        )
        return [Shown(0, 0, message)]
    found = list(analysis.report)
    listed = [_shown(d, analysis, text) for d in found[:MOST_SHOWN]]
    if len(found) > MOST_SHOWN:
        more = len(found) - MOST_SHOWN
        message = f"{more:,} more findings are not shown; run `irc check` to see them"
        listed.append(Shown(0, 0, message))
    return listed


def _shown(d: Diagnostic, analysis: Analysis, text: str) -> Shown:
    message = d.message if d.hint is None else f"{d.message}\nhint: {d.hint}"
    if d.within is not None and d.offset is not None:
        start, end = _including(text, d)
        end_there = d.end if d.end is not None else _word_end(d.within.text, d.offset)
        name = d.within.name.rsplit("/", 1)[-1]
        spot = Spot(d.offset, end_there, d.within)
        return Shown(start, end, f"in {name}, line {d.line}: {message}", d, spot)
    if d.offset is None:
        return Shown(0, _line_end(text, 0), message, d)
    start = min(d.offset + analysis.lead, len(text))
    end = _word_end(text, start) if d.end is None else min(d.end + analysis.lead, len(text))
    return Shown(start, max(start, end), message, d)


def _including(text: str, d: Diagnostic) -> tuple[int, int]:
    """The span of the statement that includes the file of a finding; the text's first line if the
    text does not include it directly."""
    from irc.lsp.dsl import includes

    assert d.within is not None
    for name, start, end in includes(text):
        if d.within.name.endswith(name.removeprefix("./")):
            return start, end
    return 0, _line_end(text, 0)


_LONGEST_WORD = 200


def _word_end(text: str, start: int) -> int:
    """The end of the text in quotes, the word or the character that begins at a place."""
    end = min(_line_end(text, start), start + _LONGEST_WORD)
    if start >= end:
        return start
    if text[start] == '"':
        at = start + 1
        while at < end and text[at] != '"':
            at += 2 if text[at] == "\\" else 1
        return min(at + 1, end)
    at = start + 1
    if text[start].isalnum() or text[start] == "_":
        while at < end and (text[at].isalnum() or text[at] in "_-"):
            at += 1
    return at


def _line_end(text: str, start: int) -> int:
    found = text.find("\n", start)
    end = len(text) if found < 0 else found
    return end - 1 if end > start and text[end - 1] == "\r" else end


SEVERITIES = {Severity.ERROR: 1, Severity.WARNING: 2, Severity.NOTE: 3}
"""The protocol's numbers of severities; messages of the server itself are information."""
