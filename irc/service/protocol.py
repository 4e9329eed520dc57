"""The requests of `irc run`: reads a line of JSON as a typed request, with every fault located."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from irc.diagnostics import Code, Findings, InputError, Report, did_you_mean
from irc.diagnostics.source import Source
from irc.frontends.events import to_events
from irc.frontends.json.document import decode_bytes
from irc.frontends.json.value import read_value
from irc.model import Event, Task
from irc.model.nulls import without_nulls
from irc.model.quantities import Number, TimeError
from irc.model.times import json_number, parse_instant

MAX_LINE = 16 * 1024 * 1024
"""Bytes of one request; longer lines are refused."""

NAME = "<request>"
"""The name of a request's text in diagnostics."""

_EXPECTED = 'a request such as {"do": "advance", "to": 5}'


@dataclass(frozen=True)
class Request:
    """A request as sent; its times and events are read later, for a task."""

    do: str
    id: Any
    raw: Mapping[str, Any]
    source: Source

    @property
    def replan(self) -> bool:
        """Whether the open part is planned again after the request."""
        return self.do == "replan" or self.raw.get("replan") is True


OBSERVED = (
    "occurrence",
    "status",
    "started",
    "finished",
    "expected_end",
    "mode",
    "resources",
)
"""The fields of a request `observe` that are those of the change `observe` of an event."""

_FIELDS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "advance": ("to",),
        "observe": ("action", *OBSERVED, "at", "replan"),
        "apply": ("event", "replan"),
        "replan": (),
        "state": (),
        "stop": (),
    }
)
_REQUIRED: Mapping[str, str] = MappingProxyType(
    {"advance": "to", "observe": "action", "apply": "event"}
)


def is_id(value: Any) -> bool:
    """Whether a request can have this as its "id", which its answer repeats."""
    return isinstance(value, str) or type(value) is int


def decode_request(line: bytes) -> tuple[Mapping[str, Any], Source]:
    """The JSON object of a line. Raises `InputError`."""
    text = decode_bytes(line, NAME)
    raw, source = read_value(text, NAME, _EXPECTED)
    if not isinstance(raw, Mapping):
        findings = Findings()
        findings.add(Code.WRONG_TYPE, f"expected {_EXPECTED}, found a list", offset=0)
        raise InputError(Report(tuple(findings.items), source))
    return without_nulls(raw), source


def to_request(raw: Mapping[str, Any], source: Source) -> Request:
    """The request in an object. Raises `InputError` with every fault of its fields."""
    findings = Findings()
    do = raw.get("do")
    if do not in list(_FIELDS):
        _report_unknown(raw, findings)
    else:
        _check_fields(str(do), raw, findings)
    if findings.items:
        raise InputError(Report(tuple(findings.items), source))
    return Request(str(do), raw.get("id"), raw, source)


def _report_unknown(raw: Mapping[str, Any], findings: Findings) -> None:
    known = ", ".join(_FIELDS)
    if "do" not in raw:
        hint = f'add "do": …, one of {known}'
        findings.add(Code.MISSING_FIELD, "the request has no 'do'", hint=hint)
        return
    do = raw["do"]
    hint = (did_you_mean(do, _FIELDS) if isinstance(do, str) else None) or "use one of these"
    findings.add(Code.WRONG_TYPE, f"'do': expected one of {known}", ("do",), hint=hint)


def _check_fields(do: str, raw: Mapping[str, Any], findings: Findings) -> None:
    """Adds every fault of the fields of a request with this `do`."""
    if raw.get("id") is not None and not is_id(raw["id"]):
        findings.add(Code.WRONG_TYPE, "'id': expected a text or a whole number", ("id",))
    known = ("do", *_FIELDS[do], "id")
    for key in raw.keys() - set(known):
        findings.add(
            Code.UNKNOWN_FIELD,
            f"a request to {do} has no field {key!r}",
            (key,),
            hint=did_you_mean(key, known) or f"its fields are {', '.join(known)}",
            at_key=True,
        )
    required = _REQUIRED.get(do)
    if required is not None and required not in raw:
        hint = f'add "{required}": …'
        findings.add(Code.MISSING_FIELD, f"a request to {do} has no '{required}'", hint=hint)
    if not isinstance(raw.get("replan", False), bool):
        findings.add(Code.WRONG_TYPE, "'replan': expected true or false", ("replan",))
    action = raw.get("action", "-")
    if not isinstance(action, str) or not action:
        message = "'action': expected the id of an action in double quotes"
        findings.add(Code.WRONG_TYPE, message, ("action",))
    number = raw.get("occurrence", 1)
    if type(number) is not int or number < 1:
        message = "'occurrence': expected a whole number, 1 or more"
        findings.add(Code.WRONG_TYPE, message, ("occurrence",))
    if do == "observe" and all(raw.get(field) in (None, []) for field in OBSERVED[1:]):
        findings.add(
            Code.MISSING_FIELD,
            "this observation of the action says nothing",
            hint='add "started" or "finished", or a "status" such as "running"',
        )


def observation_of(request: Request, task: Task, now: Number) -> Event:
    """The event of a request `observe`; the default of its time is now. Raises `InputError`."""
    said = {k: request.raw[k] for k in ("action", *OBSERVED) if request.raw.get(k) is not None}
    for field in ("at", "started", "finished", "expected_end"):
        if request.raw.get(field) is not None:
            time_of(request, field, task)
    at = request.raw.get("at")
    raw = {"at": json_number(now) if at is None else at, "changes": [{"op": "observe", **said}]}
    (event,) = to_events([raw], lambda i: (), 0, request.source)
    return event


def time_of(request: Request, field: str, task: Task) -> Number:
    """A time of a request in the task's unit. Raises `InputError`."""
    try:
        moment = task.clock.exact(parse_instant(request.raw.get(field)))
    except TimeError as error:
        fault = f"'{field}': {error}"
    else:
        if moment >= 0:
            return moment
        fault = f"'{field}': a time before 0 is before the task begins"
    findings = Findings()
    hint = "write a number of the task's time unit, or a text with units such as '1 h 30 min'"
    findings.add(Code.BAD_TIME, fault, (field,), hint=hint)
    raise InputError(Report(tuple(findings.items), request.source))


def event_of(request: Request, task: Task, now: Number) -> Event:
    """The event of a request `apply`: "#id" is one of the task's; the default of its time is now.

    Raises `InputError` with every fault of its shape.
    """
    raw = request.raw["event"]
    findings = Findings()
    if isinstance(raw, str):
        event = own_event(task, raw.removeprefix("#")) if raw.startswith("#") else None
        if event is not None:
            return event
        report_no_event(task, raw, ("event",), findings)
        raise InputError(Report(tuple(findings.items), request.source))
    (event,) = to_events([raw], lambda i: ("event",), json_number(now), request.source)
    return event


def own_event(task: Task, name: str) -> Event | None:
    """The task's event with this id, if there is one that is not applied yet."""
    return next((event for event in task.events if event.id == name), None)


def report_no_event(
    task: Task, text: str, pointer: tuple[str | int, ...], findings: Findings
) -> None:
    """Adds the fault that "#id" names no event of the task."""
    ids = [f"#{event.id}" for event in task.events if event.id is not None]
    listed = f"its events are {', '.join(ids)}" if ids else "it has no events with an id"
    findings.add(
        Code.UNKNOWN_NAME,
        f"the task has no event {text!r} that is still to come",
        pointer,
        hint=did_you_mean(text, ids) or listed,
    )
