"""Reads a large and simple JSON document as columns, in passes over its parts that run in C.

It accepts only a text that is a task without doubt and without a note, whose actions have an `id`
and a whole `duration` each, and whose precedences have `before` and `after`. Of any other text it
says nothing: the general reader reads it, and reports its faults.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from operator import itemgetter, ne
from typing import TYPE_CHECKING, Any

from irc.frontends.json.document import json_source
from irc.model.garbage import without_garbage

if TYPE_CHECKING:
    from irc.model import Task
    from irc.model.columns import Columns, ColumnTask

LONGEST_DURATION = 10**15
"""A longer duration is left to the general reader."""

_PART = 10_000
"""Characters that are decoded at once: so few that their objects stay in the processor's cache."""

_HEAD = {"irc", "name", "description", "time_unit"}
_ARRAYS = ("actions", "precedence")
_RICH = tuple(
    f'"{key}"' for key in ("resources", "uses", "modes", "release", "deadline", "min_lag")
)
"""Keys of which a simple document has none: a text with one of them is not even decoded."""

_BLANK = " \t\r\n"
_OPENING = re.compile(rf"[{_BLANK}]*\{{")
_KEY = re.compile(rf'[{_BLANK}]*"([a-z_]+)"[{_BLANK}]*:[{_BLANK}]*')
_TEXT = re.compile(r'"([^"\x00-\x1f]*)"')
_NEXT = re.compile(rf"[{_BLANK}]*([,}}])")
_COMMA = re.compile(rf"[{_BLANK}]*,")


class _NotSimple(ValueError):
    """Raised where a document is not one for columns."""


def read_columns(text: str, name: str) -> ColumnTask | None:
    """The task of a text; None where only the general reader can say what it means."""
    if "\\" in text or any(key in text for key in _RICH):
        return None
    from irc.model.columns import ColumnTask

    try:
        columns = _columns(text)
    except (ValueError, KeyError, RecursionError):
        # (Each of them only means that it is not a simple document, whatever else it may be.)
        return None
    task = ColumnTask.of(columns)
    task.with_source(json_source(name, text, len(text) - len(text.lstrip(_BLANK))))
    return task


def _refuse(value: Any) -> Any:
    raise _NotSimple(value)


_DECODER = json.JSONDecoder(parse_float=_refuse, parse_constant=_refuse)


def _require(holds: bool) -> None:
    if not holds:
        raise _NotSimple


@without_garbage()
def _columns(text: str) -> Columns:
    """The columns of a text. Raises `ValueError`, `KeyError` or `RecursionError` where it is not a
    simple document.
    """
    from irc.model.columns import Columns

    if not text.isascii():
        text.encode()  # (Half a character cannot be written: a `ValueError`.)
    head, arrays = _members(text)
    ids: list[str] = []
    durations: list[int] = []
    for names, lengths in _pairs(text, *arrays["actions"], ("id", "duration"), int):
        ids += names
        durations += lengths
    _require(all(ids) and min(durations) > 0 and max(durations) <= LONGEST_DURATION)
    index = dict(zip(ids, range(len(ids)), strict=True))
    _require(len(index) == len(ids))
    before: list[int] = []
    after: list[int] = []
    following: list[list[int]] = [[] for _ in ids]
    for firsts, seconds in _pairs(
        text, *arrays.get("precedence", (0, 0)), ("before", "after"), str
    ):
        before += (own := [*map(index.__getitem__, firsts)])
        after += (others := [*map(index.__getitem__, seconds)])
        _require(all(map(ne, own, others)))
        for i, j in zip(own, others, strict=True):
            following[i].append(j)
    _require(sum(map(len, map(set, following))) == len(before))  # No precedence is there twice.
    return Columns(_typed_head(head, arrays), ids, durations, before, after, following)


def _members(text: str) -> tuple[dict[str, str], dict[str, tuple[int, int]]]:
    """(the members of the document that are texts, the places within the brackets of its arrays).

    The arrays hold no arrays, so each ends at the next bracket. (One within a text is taken for its
    end: then its objects cannot be decoded.)
    """
    head: dict[str, str] = {}
    arrays: dict[str, tuple[int, int]] = {}
    at, separator = _found(_OPENING, text, 0).end(), ","
    while separator == ",":
        key = _found(_KEY, text, at)
        _require(key[1] not in head and key[1] not in arrays)
        if key[1] in _ARRAYS:
            _require(text.startswith("[", key.end()))
            arrays[key[1]] = key.end() + 1, text.index("]", key.end())
            at = arrays[key[1]][1] + 1
        else:
            _require(key[1] in _HEAD)
            value = _found(_TEXT, text, key.end())
            head[key[1]], at = value[1], value.end()
        behind = _found(_NEXT, text, at)
        separator, at = behind[1], behind.end()
    _require(not text[at:].strip(_BLANK))
    return head, arrays


def _found(pattern: re.Pattern[str], text: str, at: int) -> re.Match[str]:
    match = pattern.match(text, at)
    if match is None:
        raise _NotSimple(at)
    return match


def _pairs(
    text: str, start: int, end: int, keys: tuple[str, str], second: type
) -> Iterator[tuple[list[Any], list[Any]]]:
    """The values of two keys, a text and one of type `second`, in the objects of an array that have
    no other keys; of some objects at a time.

    Where a part ends within a text or within an object, it is no JSON.
    """
    more = bool(text[start:end].strip(_BLANK))
    while more:
        stop = text.find("}", min(start + _PART, end), end) + 1 or end
        part = text[start:stop]
        objects = _DECODER.decode(f"[{part}]")
        _require(set(map(type, objects)) == {dict} and set(map(len, objects)) == {2})
        values = [*map(itemgetter(keys[0]), objects)], [*map(itemgetter(keys[1]), objects)]
        _require(set(map(type, values[0])) == {str} and set(map(type, values[1])) == {second})
        _require_keys_once(part, objects, values)
        yield values
        comma = _COMMA.match(text, stop, end)
        more = comma is not None
        if comma is not None:
            start = comma.end()
        else:
            _require(not text[stop:end].strip(_BLANK))


def _require_keys_once(
    part: str, objects: list[dict[str, Any]], values: tuple[list[Any], list[Any]]
) -> None:
    """Raises where an object has two members with one key, of which it keeps the last.

    Each member has its colon: there are none where the colons outside of texts are as many as the
    members that are kept.
    """
    colons = part.count(":") - 2 * len(objects)
    if colons:
        texts = (value for column in values for value in column if type(value) is str)
        _require(colons == sum(value.count(":") for value in texts))


def _typed_head(head: dict[str, str], arrays: dict[str, tuple[int, int]]) -> Task:
    """The task without its actions. Raises `ValueError` where it has faults."""
    from irc.model import Task

    return Task.model_validate({**head, **{name: [] for name in arrays}})
