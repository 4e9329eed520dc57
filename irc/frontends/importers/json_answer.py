"""The JSON object in a text that a language model wrote."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Any

_FENCE = re.compile(r"```[\w+-]*[ \t]*\n?(.*?)```", re.DOTALL)


def find_object(text: str) -> dict[str, Any] | None:
    """The JSON object in a fence of the text, else from its first `{` to its last `}`."""
    found = placed_object(text)
    return None if found is None else found[0]


def placed_object(text: str) -> tuple[dict[str, Any], int] | None:
    """(the JSON object in a fence of the text or between its first `{` and last `}`, its start)."""
    for start, end in _candidates(text):
        try:
            value = json.loads(text[start:end])
        except (ValueError, RecursionError):
            continue
        if isinstance(value, dict):
            return value, start
    return None


def _candidates(text: str) -> Iterator[tuple[int, int]]:
    fenced = _FENCE.search(text)
    if fenced is not None:
        yield fenced.span(1)
    first, last = text.find("{"), text.rfind("}")
    if 0 <= first < last:
        yield first, last + 1
