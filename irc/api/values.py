"""Reads times and elements that are written in code."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from decimal import Decimal
from fractions import Fraction
from functools import cache
from typing import Any

from pydantic import ValidationError

from irc import model
from irc.diagnostics import Diagnostic, Findings, InputError, Report
from irc.errors import OptionError
from irc.model import Task as IrTask
from irc.model.base import Node
from irc.model.from_document import to_task
from irc.model.quantities import Quantity

Length = int | float | str | Fraction | Decimal | timedelta | Quantity
"""A length of time: a number of the task's unit, a text such as "1 h 30 min", a `timedelta`."""

Moment = Length | datetime
"""A point in time: a length after t = 0, a date-time, or a time of day such as "12:00"."""

_TIME_OF_DAY = re.compile(r"([01]?\d|2[0-3]):([0-5]\d)(?::([0-5]\d))?")
_NUMBERED = re.compile(r"^('\w+') of [a-z ]+ 1:")
_DAY = timedelta(days=1)
_UNITS = (("h", 3_600_000_000), ("min", 60_000_000), ("s", 1_000_000), ("us", 1))


@dataclass(frozen=True, slots=True)
class Between:
    """A range of durations from which the solver chooses, both ends included."""

    min: Length
    max: Length


def between(min: Length, max: Length) -> Between:
    """A duration from `min` to `max`, both included, which the solver chooses."""
    return Between(min, max)


Duration = Length | Between


def length(value: Length) -> Any:
    """Converts a length of time to the form of the IR."""
    if isinstance(value, timedelta):
        micros = value // timedelta(microseconds=1)
        return Quantity(_in_words(micros), Fraction(micros, 1_000_000))
    return value


def _in_words(micros: int) -> str:
    """Microseconds as a text with units: "1 h 30 min"."""
    rest, parts = abs(micros), []
    for unit, size in _UNITS:
        count, rest = divmod(rest, size)
        if count:
            parts.append(f"{count} {unit}")
    return ("-" if micros < 0 else "") + (" ".join(parts) or "0 s")


def duration(value: Duration) -> Any:
    """Converts a duration to the form of the IR."""
    if isinstance(value, Between):
        return {"min": length(value.min), "max": length(value.max)}
    return length(value)


def is_time_of_day(value: Moment) -> bool:
    """Whether a point in time is a text such as "12:00"."""
    return isinstance(value, str) and _TIME_OF_DAY.fullmatch(value.strip()) is not None


def moment(value: Moment, task: IrTask | None) -> Any:
    """Converts a point in time to the form of the IR.

    A time of day is the first such time at or after the task's origin; without an origin it counts
    from t = 0. Raises `OptionError` for a time of day where no task is known.
    """
    if isinstance(value, datetime):
        return value
    parts = _TIME_OF_DAY.fullmatch(value.strip()) if isinstance(value, str) else None
    if parts is None:
        return length(value)
    if task is None:
        raise OptionError(
            f"{value!r} is a time of day, which needs the task: build the element with a method of"
            " the task, such as `task.action(…)`"
        )
    hour, minute, second = (int(part or 0) for part in parts.groups())
    since_midnight = timedelta(hours=hour, minutes=minute, seconds=second)
    if task.origin is None:
        return length(since_midnight)
    midnight = task.origin.replace(hour=0, minute=0, second=0, microsecond=0)
    time = midnight + since_midnight
    return time if time >= task.origin else time + _DAY


def read(document: Mapping[str, Any], *, null_is_absent: bool = True) -> IrTask:
    """The typed task of a document. Raises `InputError` with every fault of shape."""
    findings = Findings()
    task = to_task(document, findings, null_is_absent=null_is_absent)
    if task is None:
        raise InputError(Report(tuple(findings.items)))
    return task


_NODES = {
    "actions": "Action",
    "calendars": "Calendar",
    "groups": "Group",
    "precedence": "Precedence",
    "resources": "Resource",
    "state": "StateVariable",
}


@cache
def _node_class(section: str) -> type[Node]:
    """The class of the elements of a section."""
    node: type[Node] = getattr(model, _NODES[section])
    return node


def read_part(section: str, raw: Mapping[str, Any]) -> Any:
    """One typed element of a section of a task. Raises `InputError` with every fault of shape."""
    try:
        return _node_class(section).model_validate(raw)
    except ValidationError:
        pass  # It is read again as a part of a task, to get the messages of its faults.
    try:
        whole = read({"actions": (), section: (raw,)}, null_is_absent=False)
        (part,) = getattr(whole, section)
    except InputError as error:
        raise InputError(Report(tuple(_of_part(d) for d in error.report))) from None
    return part


def _of_part(fault: Diagnostic) -> Diagnostic:
    """A fault of the only entry of a section as a fault of that entry, which has no number."""
    message = fault.message
    if len(fault.pointer) == 3:
        message = _NUMBERED.sub(r"\1:", message)
    return replace(fault, message=message, pointer=fault.pointer[2:], fix=())
