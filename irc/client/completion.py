"""Completions in the bodies of responses: pure functions, from text to what the model wrote.

The body is JSON, or a stream of events (`data: {…}` lines) of which the parts are put together.
Nothing of it is trusted: a field of another type than documented is no answer.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from irc.methods import FinishReason, Reply, ServiceFailure

MOST_BYTES = 16 * 2**20
"""Limit on the body of a response."""

LONGEST_SHOWN = 200


class NoAnswer(ServiceFailure):
    """A service gave no answer. `again`: it may give one later; `fatal`: it never will."""

    def __init__(self, message: str, *, again: bool = False, fatal: bool = False) -> None:
        super().__init__(message)
        self.again = again
        self.fatal = fatal


@dataclass(frozen=True)
class Usage:
    """Tokens: those of the prompt, of these the cached ones, those written, of these the hidden."""

    prompt: int = 0
    cached: int = 0
    completion: int = 0
    reasoning: int = 0

    def __add__(self, other: Usage) -> Usage:
        return Usage(
            self.prompt + other.prompt,
            self.cached + other.cached,
            self.completion + other.completion,
            self.reasoning + other.reasoning,
        )

    def as_json(self) -> dict[str, int]:
        """The counts by name."""
        return {
            "prompt": self.prompt,
            "cached": self.cached,
            "completion": self.completion,
            "reasoning": self.reasoning,
        }


@dataclass(frozen=True)
class Completion:
    """The reply of a model, the tokens that it took, and the name the service gives the model."""

    reply: Reply
    usage: Usage = field(default_factory=Usage)
    served_by: str | None = None

    def as_json(self) -> dict[str, Any]:
        """The completion as a JSON object."""
        return {
            "text": self.reply.text,
            "finish_reason": self.reply.finish_reason,
            "tokens": self.usage.as_json(),
            "served_by": self.served_by,
        }


def completion_from_json(found: Mapping[str, Any]) -> Completion:
    """The inverse of `as_json`. Raises `ValueError` for anything else."""
    text, reason = found.get("text"), found.get("finish_reason")
    tokens, served_by = found.get("tokens"), found.get("served_by")
    if not isinstance(text, str) or not isinstance(tokens, dict):
        raise ValueError("expected 'text' and 'tokens'")
    if not isinstance(served_by, (str, type(None))):
        raise ValueError("'served_by' is not a text")
    counts = {name: _count(tokens, name) for name in Usage().as_json()}
    return Completion(
        Reply(text, None if reason is None else FinishReason(reason)), Usage(**counts), served_by
    )


def read_body(body: str, url: str) -> Completion:
    """The completion in the body of a response with status 200. Raises `NoAnswer`."""
    text = body.strip()
    if not text:
        raise NoAnswer(
            "the service answered nothing: the body of its response is empty", again=True
        )
    if text.startswith(("data:", "event:", ":")):
        return _completion(_joined(text))
    if text.startswith("<"):
        message = f"the service answered with a page in HTML; is {url} the base URL of its API?"
        raise NoAnswer(message, fatal=True)
    return _completion(_object(text))


def _object(text: str) -> dict[str, Any]:
    try:
        found = json.loads(text)
    except (ValueError, RecursionError) as error:
        at = getattr(error, "pos", 0)
        if at >= len(text) - 1 or "Unterminated" in str(error):
            message = f"the service's response is cut off after {len(text)} characters"
        else:
            message = f"the service answered with something else than JSON: {shown(text)}"
        raise NoAnswer(message, again=True) from None
    if not isinstance(found, dict):
        raise NoAnswer(f"the service answered with no JSON object: {shown(text)}", again=True)
    return found


def shown(text: str) -> str:
    """A text of a service in one short line."""
    line = " ".join(text.split())
    return repr(line if len(line) <= LONGEST_SHOWN else line[:LONGEST_SHOWN] + "…")


def error_text(body: object) -> str:
    """The message in the body of an error; empty where there is none."""
    for name in ("error", "message", "detail"):
        inner: object = body.get(name) if isinstance(body, dict) else None
        if isinstance(inner, dict):
            return error_text(inner)
        if isinstance(inner, str) and inner.strip():
            return shown(inner)[1:-1]
    return ""


def _completion(found: Mapping[str, Any]) -> Completion:
    if "error" in found and not found.get("choices"):
        reported = error_text(found) or shown(json.dumps(found["error"]))
        raise NoAnswer(f"the service reports an error: {reported}", again=True)
    choices = found.get("choices")
    if not isinstance(choices, list) or not choices:
        raise NoAnswer("the service answered without a choice", again=True)
    message = choices[0].get("message") if isinstance(choices[0], dict) else None
    if not isinstance(message, dict):
        raise NoAnswer("the service answered with a choice that has no message", again=True)
    served_by = found.get("model")
    return Completion(
        _reply(message, choices[0].get("finish_reason")),
        _usage(found.get("usage")),
        served_by if isinstance(served_by, str) else None,
    )


def _reply(message: Mapping[str, Any], reason: object) -> Reply:
    if reason == "content_filter":
        raise NoAnswer("the service's content filter withholds the answer")
    content, refusal = message.get("content"), message.get("refusal")
    text = _text(content)
    if text is None:
        raise NoAnswer("the service answered with a message that is no text", again=True)
    if isinstance(refusal, str) and refusal and not text.strip():
        return Reply(refusal, FinishReason.REFUSAL)
    return Reply(text, _REASONS.get(str(reason)))


_REASONS = {"stop": FinishReason.STOP, "length": FinishReason.LENGTH}
"""The reasons that say whether a text is whole; others say nothing about it."""


def _text(content: object) -> str | None:
    """The text of a message; some services send it in parts."""
    if content is None:
        return ""
    if isinstance(content, list):
        parts = [part.get("text", "") for part in content if isinstance(part, dict)]
        return "".join(map(str, parts)) if len(parts) == len(content) else None
    return content if isinstance(content, str) else None


def _usage(found: object) -> Usage:
    """The tokens that a service counted; 0 where it does not say."""
    if not isinstance(found, dict):
        return Usage()
    prompt, written = found.get("prompt_tokens_details"), found.get("completion_tokens_details")
    return Usage(
        _count(found, "prompt_tokens"),
        _count(prompt, "cached_tokens"),
        _count(found, "completion_tokens"),
        _count(written, "reasoning_tokens"),
    )


def _count(found: object, name: str) -> int:
    value = found.get(name) if isinstance(found, dict) else None
    return value if isinstance(value, int) and not isinstance(value, bool) and value > 0 else 0


# --- streams ------------------------------------------------------------------------------------


def _joined(text: str) -> dict[str, Any]:
    """One response put together from the parts of a stream. Raises `NoAnswer` for a cut one."""
    parts: dict[str, list[str]] = {"content": [], "refusal": []}
    found: dict[str, Any] = {}
    reason: object = None
    for event in _events(text):
        if "error" in event:
            return event
        found.update({k: event[k] for k in ("model", "usage") if event.get(k) is not None})
        choices = event.get("choices")
        choice = choices[0] if isinstance(choices, list) and choices else None
        if not isinstance(choice, dict):
            continue
        reason = choice.get("finish_reason") or reason
        delta = choice.get("delta")
        for name, into in parts.items():
            if isinstance(delta, dict) and isinstance(delta.get(name), str):
                into.append(delta[name])
    if reason is None:
        raise NoAnswer("the service's stream ended before the answer did", again=True)
    message = {name: "".join(into) for name, into in parts.items()}
    return {**found, "choices": [{"message": message, "finish_reason": reason}]}


def _events(text: str) -> Iterator[dict[str, Any]]:
    for line in text.split("\n"):
        data = line.removeprefix("data:").strip() if line.startswith("data:") else ""
        if data and data != "[DONE]":
            yield _object(data)
