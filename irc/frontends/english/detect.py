"""Decides whether a text is a task in English, without parsing it."""

from __future__ import annotations

import re
from pathlib import PurePath

SUFFIXES = frozenset([".txt", ".md", ".text", ".markdown"])

_LOOKED_AT = 200_000
_JSON_OBJECT = re.compile(r"\{\s*[\"'}]|\"actions\"")
_STEP = re.compile(
    r"^[ \t>*•+-]*(?:(?:step|task)[ \t]*#?[ \t]*[0-9a-z]{1,6}[ \t]*[.:)(]|[0-9]{1,6}[.)][ \t])"
    r"|\b(?:step|task) [0-9]{1,6}\b"
    r"|^[ \t>]*(?:[*•+–-]|\(?[A-Z]?[0-9]{0,4}[.):])[ \t].{0,300}?"
    r"(?:[0-9]|\ban?|\bhalf an) ?(?:s|secs?|seconds?|mins?|minutes?|h|hrs?|hours?|days?|weeks?|"
    r"months?|years?)\b",
    re.IGNORECASE | re.MULTILINE,
)


def is_english(text: str, name: str) -> bool:
    """Whether a text is read as English rather than as JSON.

    A text with a JSON object is JSON; a text file is English, and so is a text with steps.
    """
    if text.lstrip("\ufeff \t\r\n")[:1] in ("{", "[") or _JSON_OBJECT.search(text):
        return False
    if PurePath(name).suffix.lower() in SUFFIXES and text.strip():
        return True
    return _STEP.search(text, 0, _LOOKED_AT) is not None
