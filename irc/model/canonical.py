"""The canonical form of a task, and its hash.

Array order matters only in `objective` and among events of one instant, equal times can be written
in many ways, and exact repetitions count once: two tasks with the same meaning have the same
canonical form.
"""

from __future__ import annotations

import hashlib
import json
from decimal import Decimal
from fractions import Fraction
from math import isfinite
from typing import Any

from irc.model import Task
from irc.model.base import Node, write_time
from irc.model.quantities import Number, TimeError
from irc.model.times import Clock, json_number

_SETS = frozenset(
    [
        *("actions", "calendars", "resources", "state", "groups", "precedence", "goals", "lapsed"),
        *("couplings", "select", "sequences"),
    ]
)
"""Arrays whose order does not matter and where a repetition counts once."""

_BAGS = frozenset(
    [
        *("uses", "one_of", "modes", "consumes", "produces", "conditions", "effects", "values"),
        *("availability", "timed_changes", "times", "open", "closed", "days", "jobs"),
    ]
)
"""Arrays whose order does not matter but where a repetition counts again."""


def canonical_task(task: Task) -> dict[str, Any]:
    """The task as a JSON document that no longer depends on how it was written.

    >>> a = Task(actions=[{"id": "a", "duration": "1 min"}])
    >>> b = Task(actions=[{"id": "a", "duration": 60.0}])
    >>> canonical_task(a) == canonical_task(b)
    True
    """
    return {"irc": "1", **_object(task, task.clock)}


def task_sha256(task: Task) -> str:
    """The SHA-256 of the canonical form, in hexadecimal."""
    if task.columns is not None:
        from irc.model.column_text import canonical_text

        found = hashlib.sha256()
        for part in canonical_text(canonical_task(task.columns.head), task.columns):
            found.update(part.encode())
        return found.hexdigest()
    return canonical_sha256(canonical_task(task))


def canonical_sha256(canonical: dict[str, Any]) -> str:
    """The SHA-256 of a given canonical form."""
    text = json.dumps(canonical, sort_keys=True, ensure_ascii=False, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()


def written_task(task: Task) -> dict[str, Any]:
    """The task as a JSON document, as it was written: order and units kept, defaults left out."""
    return {"irc": "1", **written_part(task)}


def written_part(node: Node) -> dict[str, Any]:
    """A part of the IR as a JSON document, as it was written."""
    written: dict[str, Any] = _as_written(node)
    return written


def _as_written(node: Any) -> Any:
    if hasattr(node, "model_fields_set"):
        fields = type(node).model_fields
        return {
            (fields[name].alias or name): _as_written(getattr(node, name))
            for name in fields
            if name in node.model_fields_set
        }
    if isinstance(node, (list, tuple)):
        return [_as_written(item) for item in node]
    if isinstance(node, dict):
        return _free_form(node)
    if node is None or isinstance(node, (str, bool)):
        return node
    return write_time(node)


def _free_form(data: Any, *, ordered: bool = False) -> Any:
    """Metadata as JSON: a decimal is a number where a binary float's shortest text is equal."""
    if isinstance(data, dict):
        keys = sorted(data) if ordered else data
        return {key: _free_form(data[key], ordered=ordered) for key in keys}
    if isinstance(data, (list, tuple)):
        return [_free_form(value, ordered=ordered) for value in data]
    if isinstance(data, Decimal):
        short = float(data)
        return short if isfinite(short) and Decimal(repr(short)) == data else str(data)
    return data


_PLAIN = {"before", "after"}


def _object(node: Any, clock: Clock) -> dict[str, Any]:
    if node.model_fields_set == _PLAIN:  # The most frequent object by far.
        return {"after": node.after, "before": node.before}
    fields = type(node).model_fields
    shown: dict[str, Any] = {}
    for name in sorted(node.model_fields_set):
        value, default = getattr(node, name), fields[name].default
        if value == default or value == {}:
            continue
        # The changes of an event come in an order, those of a state variable have times.
        is_timed = name == "changes" and "initial" in fields
        is_level = name in _LEVELS or (name in ("min", "max") and "initial" in fields)
        if is_level and isinstance(value, Fraction):
            written: Any = json_number(value)
        else:
            written = _value("timed_changes" if is_timed else name, value, clock)
        default = list(default) if isinstance(default, tuple) else default
        if written != default or isinstance(written, bool) != isinstance(default, bool):
            shown[fields[name].alias or name] = written
    return shown


_LEVELS = frozenset(["at_least", "at_most", "equals", "add", "set", "initial", "value"])
"""Fields of numbers that are no times, which no resolution rounds."""


def _value(name: str, value: Any, clock: Clock) -> Any:
    if type(value) is str or type(value) is int or value is None:
        return value
    if isinstance(value, tuple):
        if name == "events":
            value = sorted(value, key=lambda event: _moment(event.at, clock))
        items = [_value("", item, clock) for item in value]
        if name in _SETS:
            unique = {_sort_key(item): item for item in items}
            return [unique[key] for key in sorted(unique)]
        return sorted(items, key=_sort_key) if name in _BAGS else items
    if isinstance(value, Node):
        return _object(value, clock)
    if name == "origin":
        return value.isoformat()
    if isinstance(value, dict):
        return _free_form(value, ordered=True)
    return value if isinstance(value, bool) else _number(value, clock)


def _moment(value: Any, clock: Clock) -> Number:
    """A sort key for moments: a date-time that the task cannot place comes first."""
    try:
        return clock.number(value)
    except TimeError:
        return 0


def _number(value: Any, clock: Clock) -> Any:
    if type(value) is int:
        return value
    try:
        number: Number = clock.number(value)
    except TimeError:
        return write_time(value)
    return json_number(number)


_ENCODER = json.JSONEncoder(sort_keys=True, ensure_ascii=False)


def _sort_key(item: Any) -> tuple[str, ...]:
    if isinstance(item, dict):
        if "id" in item:
            return (item["id"],)
        if len(item) == 2 and "before" in item:
            return (item["before"], item["after"])
        if "before" in item:
            return (item["before"], item["after"], _ENCODER.encode(item))
    return ("", "", _ENCODER.encode(item))
