"""The state of an execution as JSON, and back: nothing but data, which is safe to read.

Whole numbers, texts, truth values, null and floats are themselves, and a list is a tuple. All else
is an object whose `$` names its kind: a class of `_CLASSES` with its fields, a part of the IR as it
was written, or a container.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import MISSING, fields
from decimal import Decimal
from fractions import Fraction
from types import MappingProxyType
from typing import Any

from irc.diagnostics import InputError
from irc.errors import IrcError
from irc.execution.execution import Execution
from irc.execution.history import History
from irc.execution.observations import Fact, Observed
from irc.execution.plannable import Plannable
from irc.execution.rounding import Rounding
from irc.frontends.json.value import read_value
from irc.model import Event, Task
from irc.model.canonical import task_sha256, written_part
from irc.schedule import Entry, ObjectiveValue, Schedule, Status
from irc.targets import SolveOptions

_KINDS = (Entry, Fact, History, ObjectiveValue, Observed, Plannable, Rounding, Schedule)
_CLASSES: Mapping[str, type] = MappingProxyType({kind.__name__: kind for kind in _KINDS})
_NODES: Mapping[str, type[Any]] = MappingProxyType({"Event": Event, "Task": Task})
_OPTIONS = "options"
_EMPTY: Mapping[str, Any] = MappingProxyType({"_notes": (), "_known": None})
_LEFT_OUT = {_OPTIONS, *_EMPTY}
"""The attributes of an execution that the caller gives anew, and those that begin empty."""


class SnapshotError(IrcError):
    """A snapshot that this version of irc cannot read."""


def to_snapshot(execution: Execution) -> dict[str, Any]:
    """The state of an execution, without its options, as a JSON document."""
    state = {key: value for key, value in vars(execution).items() if key not in _LEFT_OUT}
    return {
        "task_sha256": task_sha256(execution.task),
        "state": {key: _written(value) for key, value in state.items()},
    }


def from_snapshot(document: Any, options: SolveOptions) -> Execution:
    """The execution in a snapshot, with these options. Raises `SnapshotError`."""
    execution = object.__new__(Execution)
    try:
        state = {key: _read(value) for key, value in document["state"].items()}
        if not isinstance(state.get("_told"), Task) or state.keys() & _LEFT_OUT:
            raise SnapshotError("the snapshot has no task")
        vars(execution).update(state, **{_OPTIONS: options, **_EMPTY})
        same = task_sha256(execution.task) == document["task_sha256"]
    except (ArithmeticError, AttributeError, InputError, KeyError, TypeError, ValueError) as error:
        raise SnapshotError(f"the snapshot cannot be read: {error}") from error
    if not same:
        raise SnapshotError("the snapshot has another task than the one that was written")
    return execution


def _written(value: Any) -> Any:
    """A value as JSON. Raises `TypeError` for one whose kind is not known."""
    if value is None or type(value) in (bool, int, str):
        return value
    if type(value) in (tuple, list):
        items = [_written(item) for item in value]
        return items if type(value) is tuple else {"$": "list", "of": items}
    if type(value) is Status:
        return {"$": "Status", "of": str(value)}
    if type(value) in (float, Fraction, Decimal):
        return {"$": type(value).__name__, "of": str(value)}
    if type(value) in (set, frozenset):
        items = [_written(item) for item in sorted(value)]
        return {"$": type(value).__name__, "of": items}
    if isinstance(value, Mapping):
        return {"$": "dict", "of": [[_written(k), _written(v)] for k, v in value.items()]}
    name = type(value).__name__
    if _CLASSES.get(name) is type(value):
        return {"$": name, **_fields(value)}
    if _NODES.get(name) is type(value):
        # A text, so that the nesting of what users wrote does not add to that of the snapshot.
        return {"$": name, "of": json.dumps(written_part(value), ensure_ascii=False)}
    raise TypeError(f"a snapshot cannot hold {type(value).__name__}")


def _fields(value: Any) -> dict[str, Any]:
    """The fields of a dataclass that do not have their default.

    What is derived from the others is made again where it is needed.
    """
    own = (f for f in fields(value) if f.init and not f.metadata.get("derived"))
    given = ((f, getattr(value, f.name)) for f in own)
    return {f.name: _written(has) for f, has in given if f.default is MISSING or has != f.default}


def _read(raw: Any) -> Any:
    """The value that a JSON value stands for."""
    if isinstance(raw, list):
        return tuple(_read(item) for item in raw)
    if not isinstance(raw, dict):
        return raw
    name = raw["$"]
    if name in _CLASSES:
        return _CLASSES[name](**{key: _read(value) for key, value in raw.items() if key != "$"})
    if name in _NODES:
        return _NODES[name].model_validate(read_value(raw["of"], "<journal>")[0])
    return _MADE[name](raw["of"])


def _items(raw: Any) -> list[Any]:
    return [_read(item) for item in raw]


_MADE: Mapping[str, Callable[[Any], Any]] = MappingProxyType(
    {
        "Decimal": Decimal,
        "Fraction": Fraction,
        "Status": Status,
        "dict": lambda raw: {_read(key): _read(value) for key, value in raw},
        "float": float,
        "frozenset": lambda raw: frozenset(_items(raw)),
        "list": _items,
        "set": lambda raw: set(_items(raw)),
    }
)
