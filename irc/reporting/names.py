"""Names as they may stand in a picture, a table or a page: data, and never instructions."""

from __future__ import annotations

from unicodedata import category

_KEPT = frozenset("\u200c\u200d")
"""Characters without a form of their own that scripts and emoji are written with."""


def plain(name: str) -> str:
    """A name on one line, without characters that are invisible or turn the direction of text.

    Letters of right-to-left scripts and emoji stay.
    """
    if name.isascii() and name.isprintable():
        return name
    return "".join(c if c in _KEPT or not _is_control(c) else _shown(c) for c in name)


def _is_control(character: str) -> bool:
    return category(character) in ("Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp")


def _shown(character: str) -> str:
    return " " if character in "\t\n\r\u2028\u2029" else "\ufffd"
