"""Reads a large and simple JSON document as columns, in a few passes that run in C.

It accepts only a text that is a task without doubt and without a note, whose actions have an `id`
and a whole `duration` each, and whose precedences have `before` and `after`. Of any other text it
says nothing: the general reader reads it, and reports its faults.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from operator import itemgetter
from typing import TYPE_CHECKING, Any

from irc.frontends.json.document import json_source
from irc.model.garbage import without_garbage

if TYPE_CHECKING:
    from irc.model import Task
    from irc.model.columns import Columns, ColumnTask

LONGEST_DURATION = 10**15
"""A longer duration is left to the general reader."""

_HEAD = {"irc", "name", "description", "time_unit"}
_ACTION = ("id", "duration")
_EDGE = ("before", "after")
_BLANK = " \t\r\n"
_RICH = tuple(
    f'"{key}"' for key in ("resources", "uses", "modes", "release", "deadline", "min_lag")
)
"""Keys of which a simple document has none: a text with one of them is not even decoded."""


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
    content = json.loads(text, parse_float=_refuse, parse_constant=_refuse)
    _require(type(content) is dict)
    head = {key: value for key, value in content.items() if key not in ("actions", "precedence")}
    _require(head.keys() <= _HEAD and set(map(type, head.values())) <= {str})
    ids, durations = _members(content["actions"], _ACTION)
    before, after = _members(content.get("precedence", []), _EDGE)
    members = len(content) + 2 * len(ids) + 2 * len(before)
    del content
    _require(set(map(type, durations)) == {int} and min(durations) > 0)
    _require(max(durations) <= LONGEST_DURATION)
    _require(all(set(map(type, names)) <= {str} for names in (ids, before, after)) and all(ids))
    # An object keeps the last of two members with one key, and each member has its colon: so no key
    # is there twice where the colons outside of texts are as many as the members.
    if (colons := text.count(":")) != members:
        texts = (*head.values(), *ids, *before, *after)
        _require(colons - sum(value.count(":") for value in texts) == members)
    index = dict(zip(ids, range(len(ids)), strict=True))
    _require(len(index) == len(ids))
    befores, afters = ([*map(index.__getitem__, names)] for names in (before, after))
    _require_distinct(befores, afters, len(ids))
    return Columns(_typed_head(head, bool(before)), ids, durations, befores, afters)


def _members(objects: Any, keys: tuple[str, str]) -> tuple[list[Any], list[Any]]:
    """The values of two keys in a list of objects that have no others."""
    _require(type(objects) is list and set(map(type, objects)) <= {dict})
    _require(set(map(len, objects)) <= {2})
    return [*map(itemgetter(keys[0]), objects)], [*map(itemgetter(keys[1]), objects)]


def _require_distinct(before: Sequence[int], after: Sequence[int], count: int) -> None:
    """Raises where a precedence is there twice, or an action precedes itself."""
    pairs = {b * count + a for b, a in zip(before, after, strict=True)}
    _require(len(pairs) == len(before) and all(map(int.__ne__, before, after)))


def _typed_head(head: dict[str, str], has_precedence: bool) -> Task:
    """The task without its actions. Raises `ValueError` where it has faults."""
    from irc.model import Task

    rest: dict[str, Any] = {"actions": [], **({"precedence": []} if has_precedence else {})}
    return Task.model_validate({**head, **rest})
