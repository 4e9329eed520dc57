"""Replies of a model: the text, and why the model stopped writing."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum

from irc.diagnostics import Code, Diagnostic, Report
from irc.methods.answer import Answer, AnswerState
from irc.methods.written_answer import REASONS


class FinishReason(StrEnum):
    """Why a model stopped, as its service says: done, out of tokens, or it refuses."""

    STOP = "stop"
    LENGTH = "length"
    REFUSAL = "refusal"


@dataclass(frozen=True)
class Reply:
    """The text that a model wrote; `finish_reason` is None where its service does not say it."""

    text: str
    finish_reason: FinishReason | None = None


_STATES = {
    FinishReason.LENGTH: AnswerState.TRUNCATED,
    FinishReason.REFUSAL: AnswerState.MALFORMED,
}
_MESSAGES = {
    FinishReason.LENGTH: "the answer is cut off: the model reached its limit of tokens",
    FinishReason.REFUSAL: "the model refuses to answer",
}


def finished(answer: Answer, reason: FinishReason | None) -> Answer:
    """The answer in the state that the service's reason gives it.

    The text alone cannot say whether it is cut off; the service can. An answer that can be used
    stays as it is.
    """
    if reason is None or answer.state is AnswerState.OK:
        return answer
    if reason is FinishReason.STOP:
        return _whole(answer)
    finding = Diagnostic(Code.SYNTAX, _MESSAGES[reason], offset=len(answer.text.rstrip()))
    rest = () if reason is FinishReason.REFUSAL else _but_state(answer)
    report = Report((finding, *rest), answer.report.source)
    return replace(answer, state=_STATES[reason], document=None, report=report)


def _whole(answer: Answer) -> Answer:
    """The answer of a model that was done: a text without an object is malformed, not cut off."""
    if answer.state is not AnswerState.TRUNCATED:
        return answer
    message = REASONS[AnswerState.MALFORMED]
    first = replace(answer.report.diagnostics[0], message=message)
    report = Report((first, *_but_state(answer)), answer.report.source)
    return replace(answer, state=AnswerState.MALFORMED, report=report)


def _but_state(answer: Answer) -> tuple[Diagnostic, ...]:
    """The findings but the one that says why no object can be read."""
    reasons = set(REASONS.values())
    return tuple(d for d in answer.report.diagnostics if d.message not in reasons)
