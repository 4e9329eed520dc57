"""Reads event documents: one event or a list of events, for a task that they revise."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from irc.diagnostics import Code, Diagnostic, Findings, InputError, Report
from irc.diagnostics.source import Pointer, Source
from irc.frontends.json.value import find_value
from irc.frontends.texts import read_text
from irc.model import Event
from irc.model.from_document import to_task

_DSL = re.compile(r"\ufeff?(?:[ \t]*(?:#[^\n]*)?\r?\n)*event\b")
"""The beginning of a text with events in the DSL, whatever the name of its file."""

_HINT = "write `event rush order at 12:`, and its changes indented below"

_OWN = {"events"}
"""The parts of a DSL document that may be in a file of events."""

_EXPECTED = 'an event such as {"changes": [{"op": "cancel_actions", "actions": ["a"]}]}, or a list'


@dataclass(frozen=True)
class PlacedEvent:
    """An event and its place in its text."""

    event: Event
    pointer: Pointer = ()
    source: Source | None = None

    def anchored(self, report: Report) -> Report:
        """A report on the event alone, with places in the text of the event."""
        if report.source is not None:
            return report
        moved = (
            replace(d, pointer=(*self.pointer, *d.pointer), fix=()) if d.offset is None else d
            for d in report
        )
        return Report(tuple(moved), self.source)

    def notes(self, report: Report) -> list[Diagnostic]:
        """The findings of a report on the event alone, each with its place and its text."""
        found = self.anchored(report)
        return [d if d.within else replace(d, within=found.source) for d in found.located()]


def read_events(
    path: str, at: int | float | str
) -> tuple[list[PlacedEvent], tuple[Diagnostic, ...], Source]:
    """The events in a file ("-": standard input), notes on its text, and the text.

    The text is JSON, or `event` statements of the DSL. Events without a time are at `at`. Raises
    `InputError` with every fault of syntax and shape.
    """
    return parse_events(*read_text(path), at)


def parse_events(
    text: str, name: str, at: int | float | str
) -> tuple[list[PlacedEvent], tuple[Diagnostic, ...], Source]:
    """The events in a text, as `read_events` reads those of a file. Raises `InputError`."""
    if name.endswith(".irc") or _DSL.match(text):
        return _from_dsl(text, name, at)
    raw, source, notes = find_value(text, name, _EXPECTED)
    elements = raw if isinstance(raw, list) else [raw]

    def place(i: int) -> Pointer:
        return (i,) if isinstance(raw, list) else ()

    events = to_events(elements, place, at, source)
    return [PlacedEvent(event, place(i), source) for i, event in enumerate(events)], notes, source


def _from_dsl(
    text: str, name: str, at: int | float | str
) -> tuple[list[PlacedEvent], tuple[Diagnostic, ...], Source]:
    from irc.frontends.dsl.reader import read_dsl

    if not text.strip():
        empty = Diagnostic(Code.DSL_SYNTAX, "there is no event in this text", offset=0, hint=_HINT)
        raise InputError(Report((empty,), Source(name, text)))
    reading = read_dsl(text, name)
    findings = Findings([*reading.notes, *reading.faults])
    document = reading.document
    events = document.get("events", [])
    if not reading.faults and (not events or any(document[key] for key in document.keys() - _OWN)):
        findings.add(
            Code.DSL_SYNTAX,
            "only `event` statements may stand here",
            _first_other(document),
            hint=_HINT,
        )
    try:
        typed = to_events(events, lambda i: ("events", i), at, reading.source)
    except InputError as error:
        findings.items += error.report.diagnostics
    report = Report(tuple(findings.items), reading.source)
    if not report.ok:
        raise InputError(report)
    placed = [PlacedEvent(e, ("events", i), reading.source) for i, e in enumerate(typed)]
    return placed, reading.notes, reading.source


def _first_other(document: Mapping[str, Any]) -> Pointer:
    """The first part of a document that is not an event."""
    other = next((key for key in document if key not in _OWN and document[key]), None)
    if other is None:
        return ()
    return (other, 0) if isinstance(document[other], list) else (other,)


def to_events(
    elements: Sequence[Any],
    place: Callable[[int], Pointer],
    at: int | float | str,
    source: Source | None,
) -> tuple[Event, ...]:
    """Typed events; those without a time are at `at`. `place` gives the pointer of the i-th one.

    Raises `InputError` with every fault of shape.
    """
    timed = [
        {"at": at, **{k: v for k, v in element.items() if v is not None}}
        if isinstance(element, dict)
        else element
        for element in elements
    ]
    findings = Findings()
    # Read them as part of a task, so that faults of shape have the usual messages.
    task = to_task({"actions": (), "events": timed}, findings)
    if task is not None:
        return task.events
    moved = tuple(_moved(d, place) for d in findings.items)
    raise InputError(Report(moved, source))


def _moved(finding: Diagnostic, place: Callable[[int], Pointer]) -> Diagnostic:
    """A finding about the events of a task, as a finding about the document of the events."""

    def there(pointer: Pointer) -> Pointer:
        if len(pointer) < 2 or not isinstance(pointer[1], int):
            return ()
        return (*place(pointer[1]), *pointer[2:])

    fix = tuple(
        replace(o, path=there(o.path), origin=None if o.origin is None else there(o.origin))
        for o in finding.fix
    )
    return replace(finding, pointer=there(finding.pointer), fix=fix)


def wrong_time(placed: PlacedEvent, message: str, hint: str) -> InputError:
    """The error for an event whose time does not fit."""
    finding = Diagnostic(Code.EVENT_TIME, message, (*placed.pointer, "at"), hint)
    return InputError(Report((finding,), placed.source))
