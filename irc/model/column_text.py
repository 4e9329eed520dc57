"""The text of the canonical form of a task that is kept as columns, for its hash.

It is the text that `irc.model.canonical` makes of the same task with objects, at less cost.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from irc.model.columns import Columns


def canonical_text(canonical: dict[str, Any], columns: Columns) -> Iterator[str]:
    """The text of the canonical form in parts, given that of the head: all keys in order."""
    written = {**canonical, "actions": _actions_text}
    if columns.before:
        written["precedence"] = _precedence_text
    order = sorted(range(len(columns.ids)), key=columns.ids.__getitem__)
    for k, key in enumerate(sorted(written)):
        yield f'{"," if k else "{"}"{key}":'
        value = written[key]
        if callable(value):
            yield from value(columns, order)
        else:
            yield json.dumps(value, sort_keys=True, ensure_ascii=False, separators=(",", ":"))
    yield "}"


_PART = 10_000
"""Actions whose text is made at once."""


def _actions_text(columns: Columns, order: list[int]) -> Iterator[str]:
    ids, durations = columns.ids, columns.durations
    for start in range(0, len(order), _PART):
        part = order[start : start + _PART]
        yield "," if start else "["
        yield ",".join([f'{{"duration":{durations[i]},"id":"{ids[i]}"}}' for i in part])
    yield "]"


def _precedence_text(columns: Columns, order: list[int]) -> Iterator[str]:
    """The precedences by the names of their actions: those of one `before` together."""
    place = [0] * len(order)
    for k, i in enumerate(order):
        place[i] = k
    afters = [f'{{"after":"{columns.ids[i]}","before":"' for i in order]
    opening, parts = "[", list[str]()
    for i in order:
        if columns.following[i]:
            end = columns.ids[i] + '"}'
            direct = sorted(map(place.__getitem__, columns.following[i]))
            parts.append(opening + (end + ",").join(map(afters.__getitem__, direct)) + end)
            opening = ","
            if len(parts) == _PART:
                yield "".join(parts)
                parts.clear()
    yield "".join(parts) + "]"
