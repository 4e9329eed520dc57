"""The JSON object in a model's answer, or the reason why there is none."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Any

from irc.diagnostics import Code, Findings, Report
from irc.diagnostics.source import Source
from irc.methods.answer import Answer, AnswerState

_FENCE = re.compile(r"```[\w+-]*[ \t]*\n?(.*?)```", re.DOTALL)


def find_object(text: str) -> dict[str, Any] | None:
    """The JSON object in a fence of the text, else from its first `{` to its last `}`."""
    for candidate in _candidates(text):
        try:
            value = json.loads(candidate)
        except (ValueError, RecursionError):
            continue
        if isinstance(value, dict):
            return value
    return None


def _candidates(text: str) -> Iterator[str]:
    fenced = _FENCE.search(text)
    if fenced is not None:
        yield fenced.group(1)
    first, last = text.find("{"), text.rfind("}")
    if 0 <= first < last:
        yield text[first : last + 1]


def unreadable_state(text: str) -> AnswerState:
    """Why no object can be read: the text is empty, cut off, or malformed."""
    trimmed = text.rstrip()
    if not trimmed:
        return AnswerState.EMPTY
    whole = trimmed.endswith(("}", "```"))
    return AnswerState.MALFORMED if whole else AnswerState.TRUNCATED


_REASONS = {
    AnswerState.EMPTY: "the answer is empty",
    AnswerState.TRUNCATED: "the answer is cut off: it ends before its JSON object does",
    AnswerState.MALFORMED: "the answer holds no JSON object that can be read",
}


def unreadable(text: str, expected: str) -> Answer:
    """The answer in which no object can be read, with a diagnostic where it ends."""
    state = unreadable_state(text)
    findings = Findings()
    code = Code.UNREADABLE if state is AnswerState.EMPTY else Code.SYNTAX
    findings.add(code, _REASONS[state], offset=len(text.rstrip()), hint=f"expected {expected}")
    return Answer(state, text, report=Report(tuple(findings.items), Source("answer", text)))
