"""The edit that formats a text as `irc fmt` does."""

from __future__ import annotations

from irc.diagnostics import InputError
from irc.diagnostics.fix import TextEdit
from irc.frontends.layout import lay_out


def layout_edit(text: str, name: str) -> TextEdit | None:
    """The edit of the fewest lines that formats a text; None if nothing changes, or if the text
    cannot be read (its findings report that)."""
    try:
        found = lay_out(text, name)
    except InputError:
        return None
    if not found.changed:
        return None
    old, new = text.splitlines(keepends=True), found.laid_out.splitlines(keepends=True)
    same_before = _common(old, new)
    same_after = _common(old[same_before:][::-1], new[same_before:][::-1])
    start = sum(map(len, old[:same_before]))
    end = len(text) - sum(map(len, old[len(old) - same_after :]))
    return TextEdit(start, end, "".join(new[same_before : len(new) - same_after]))


def _common(one: list[str], other: list[str]) -> int:
    """The number of equal lines at the beginning."""
    count = 0
    for a, b in zip(one, other, strict=False):
        if a != b:
            break
        count += 1
    return count
