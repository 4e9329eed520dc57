"""One JSON object or list and nothing else: what programs send, and event files.

Tasks are read by `json_document`, which looks for the one object that is a task.
"""

from __future__ import annotations

from typing import Any

from irc.diagnostics import Code, Findings, InputError, Report
from irc.frontends.json_document import decode_object, json_source
from irc.source import Source

_BLANK = " \t\r\n"


def read_value(text: str, name: str, expected: str = "a JSON object") -> tuple[Any, Source]:
    """The value that a text is, and the text as a source that knows where its elements stand.

    `expected` says what it should hold, for texts that hold nothing. Raises `InputError` for
    faults of syntax, duplicate keys, nesting, and for what stands behind the value.
    """
    text = text.removeprefix("\ufeff")
    source = json_source(name, text)
    findings = Findings()
    start = len(text) - len(text.lstrip(_BLANK))
    if start == len(text):
        findings.add(Code.SYNTAX, "the input is empty", hint=f"expected {expected}", offset=0)
        raise InputError(Report(tuple(findings.items), source))
    if text[start] not in "{[":
        shown = text[start : start + 12].split("\n")[0]
        hint = "this is no JSON object or list; check that the right text was given"
        findings.add(Code.SYNTAX, f"expected {expected}, found {shown!r}", hint=hint, offset=start)
        raise InputError(Report(tuple(findings.items), source))
    decoded = decode_object(text, start)
    if not isinstance(decoded, tuple):
        findings.add(decoded.code, decoded.message, hint=decoded.hint, offset=decoded.offset)
        raise InputError(Report(tuple(findings.items), source))
    content, end = decoded
    rest = text[end:].lstrip(_BLANK)
    if rest:
        findings.add(
            Code.SYNTAX,
            f"there is something behind the JSON text: {rest[:12]!r}",
            hint="keep exactly one; several stand in a list: [ …, … ]",
            offset=len(text) - len(rest),
        )
        raise InputError(Report(tuple(findings.items), source))
    return content, source
