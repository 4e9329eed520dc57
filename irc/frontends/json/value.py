"""One JSON object or list and nothing else: what programs send, and event files.

Tasks are read by `json_document`, which looks for the one object that is a task.
"""

from __future__ import annotations

import re
from itertools import islice
from typing import Any

from irc.diagnostics import Code, Diagnostic, Findings, InputError, Report
from irc.diagnostics.source import Source
from irc.frontends.json.document import decode_object, json_source, note_surroundings

_BLANK = " \t\r\n"
_OPENING = "{["
_OPENINGS = re.compile(r"[\[{]")
_OF_JSON = tuple("{}[],:")
"""What behind a JSON text belongs to a faulty one, and is no chatter."""

_MOST_ATTEMPTS = 100


def read_value(
    text: str, name: str, expected: str = "a JSON object", start: int = 0
) -> tuple[Any, Source]:
    """The value that a text is from `start` on, and the text as a source that knows its elements.

    `expected` says what it should hold, for texts that hold nothing. Raises `InputError` for
    faults of syntax, duplicate keys, nesting, and for what stands behind the value.
    """
    text = text.removeprefix("\ufeff")
    start = _skip_blank(text, start)
    source = json_source(name, text, start)
    if start == len(text):
        raise _fault(source, 0, "the input is empty", f"expected {expected}")
    if text[start] not in _OPENING:
        shown = text[start : start + 12].split("\n")[0]
        hint = "this is no JSON object or list; check that the right text was given"
        raise _fault(source, start, f"expected {expected}, found {shown!r}", hint)
    decoded = decode_object(text, start)
    if not isinstance(decoded, tuple):
        finding = Diagnostic(
            decoded.code, decoded.message, hint=decoded.hint, offset=decoded.offset
        )
        raise InputError(Report((finding,), source))
    content, end = decoded
    behind = _skip_blank(text, end)
    if behind < len(text):
        message = f"there is something behind the JSON text: {text[behind : behind + 12]!r}"
        raise _fault(source, behind, message, "keep exactly one; several stand in a list: [ …, … ]")
    return content, source


def find_value(text: str, name: str, expected: str) -> tuple[Any, Source, tuple[Diagnostic, ...]]:
    """The one object, or list of objects, in a text, and notes on what stands around it.

    A language model's answer is read as it stands: code fences and chatter are set aside. Raises
    `InputError` as `read_value` does.
    """
    text = text.removeprefix("\ufeff")
    starts = [match.start() for match in islice(_OPENINGS.finditer(text), _MOST_ATTEMPTS)]
    for start in starts:
        decoded = decode_object(text, start)
        if isinstance(decoded, tuple) and _is_objects(decoded[0]):
            content, end = decoded
            if text[(behind := _skip_blank(text, end)) : behind + 1] in _OF_JSON:
                break
            _require_no_second(text, end, name)
            notes = Findings()
            note_surroundings(text, start, end, notes)
            return content, json_source(name, text, start), tuple(notes.items)
        if start == _skip_blank(text, 0):
            break  # It is no chatter that begins like this.
    return *read_value(text, name, expected, starts[0] if starts else 0), ()


def _skip_blank(text: str, at: int) -> int:
    return len(text) - len(text[at:].lstrip(_BLANK))


def _fault(source: Source, offset: int, message: str, hint: str) -> InputError:
    return InputError(Report((Diagnostic(Code.SYNTAX, message, hint=hint, offset=offset),), source))


def _is_objects(content: Any) -> bool:
    if isinstance(content, list):
        return bool(content) and all(isinstance(element, dict) for element in content)
    return isinstance(content, dict)


def _require_no_second(text: str, end: int, name: str) -> None:
    """Raises where another object begins behind the one that was read."""
    second = text.find("{", end)
    if second >= 0 and isinstance(decode_object(text, second), tuple):
        message, hint = "a second JSON object begins here", "keep exactly one, or a list of them"
        raise _fault(json_source(name, text), second, message, hint)
