"""Reads one JSON object or list: requests of programs, and event files.

`irc.frontends.json.document` reads tasks: it looks for the one object that is a task.
"""

from __future__ import annotations

import json
import re
from itertools import islice
from math import isfinite
from typing import Any, NoReturn

from irc.diagnostics import Code, Diagnostic, Findings, InputError, Report
from irc.diagnostics.source import Source
from irc.frontends.json.document import MAX_DEPTH, decode_object, json_source, note_surroundings

_BLANK = " \t\r\n"
_OPENING = "{["
_OPENINGS = re.compile(r"[\[{]")
_OF_JSON = tuple("{}[],:")
"""Characters after a JSON text that belong to a faulty text, not to a comment around it."""

_MOST_ATTEMPTS = 100


def read_value(
    text: str, name: str, expected: str = "a JSON object", start: int = 0
) -> tuple[Any, Source]:
    """(the value that a text has from `start` on, the text as a source that knows its elements).

    `expected` describes the value, for the message on empty texts. Raises `InputError` for faults
    of syntax, duplicate keys, nesting, and text after the value.
    """
    text = text.removeprefix("\ufeff")
    start = _skip_blank(text, start)
    source = json_source(name, text, start)
    if start == len(text):
        raise _fault(source, 0, "the input is empty", f"expected {expected}")
    if text[start] not in _OPENING:
        shown = text[start : start + 12].split("\n")[0]
        hint = "this is not a JSON object or list; check that you gave the right text"
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
        message = f"there is more text after the JSON: {text[behind : behind + 12]!r}"
        raise _fault(source, behind, message, "keep exactly one; write several as a list: [ …, … ]")
    return content, source


def find_value(text: str, name: str, expected: str) -> tuple[Any, Source, tuple[Diagnostic, ...]]:
    """(the one object, or list of objects, in a text, its source, notes on text around it).

    The text may be the answer of a language model: code fences and other text are ignored. Raises
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
            break  # The text begins with the faulty value, not with other text.
    return *read_value(text, name, expected, starts[0] if starts else 0), ()


def read_line(text: str) -> Any:
    """The value of a line of recorded data; texts in it are kept as they are.

    Raises `ValueError` for faults of syntax, for NaN, and for a number out of range.
    """
    try:
        return json.loads(text, parse_constant=_no_number, parse_float=_finite)
    except json.JSONDecodeError:
        raise  # It has a place.
    except (ValueError, RecursionError) as error:
        from irc.frontends.json.scan import scan

        faults = scan(text, max_depth=MAX_DEPTH).faults
        message, offset = str(error), text.find(getattr(error, "number", ""))
        if faults:
            message, offset = faults[0].message, faults[0].offset
        line, column = Source("", text).line_and_column(max(offset, 0))
        raise ValueError(f"{message}: line {line} column {column}") from None


def _no_number(constant: str) -> NoReturn:
    raise ValueError(f"{constant} is not a number in JSON")


def _finite(number: str) -> float:
    if not isfinite(value := float(number)):
        raise _OutOfRange(number)
    return value


class _OutOfRange(ValueError):
    """A number that does not fit into a float."""

    def __init__(self, number: str) -> None:
        super().__init__(f"the number {number[:40]} is out of range")
        self.number = number


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
