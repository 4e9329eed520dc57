"""Null means absent: where a schema requires every field, a model writes null in those left out."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

_FREE = "metadata"
"""The field whose contents are not the IR's."""

_REMOVES = "deadline"
"""The field of a change (an object with `op`) in which null is a value: it removes a deadline."""


def without_nulls(raw: Any) -> Any:
    """A document without its fields that are null; the same object where there are none."""
    if isinstance(raw, Mapping):
        kept = {
            key: value if key == _FREE else without_nulls(value)
            for key, value in raw.items()
            if value is not None or (key == _REMOVES and "op" in raw)
        }
        same = len(kept) == len(raw) and all(kept[key] is raw[key] for key in kept)
        return raw if same else kept
    if isinstance(raw, (list, tuple)):
        elements = [without_nulls(element) for element in raw]
        same = all(new is old for new, old in zip(elements, raw, strict=True))
        return raw if same else elements
    return raw
