"""Failures of a service: which pass, how long to wait, and what to say."""

from __future__ import annotations

from collections.abc import Mapping
from email.utils import parsedate_to_datetime
from http import HTTPStatus
from typing import TYPE_CHECKING

from irc.client.completion import NoAnswer, error_text

if TYPE_CHECKING:
    import openai

PASSING = frozenset({408, 409, 425, 429})
"""Statuses below 500 that may be different the next time."""

FATAL = frozenset({401, 403, 404, 407})
"""Statuses that every further request gets too."""

SPENT = ("insufficient_quota", "billing_hard_limit_reached")
"""Codes of an account that has nothing left: waiting does not help."""


class Refused(NoAnswer):
    """A response with an error status; `wait` are the seconds that the service asks for."""

    def __init__(
        self, message: str, *, again: bool, fatal: bool, wait: float | None = None
    ) -> None:
        super().__init__(message, again=again, fatal=fatal)
        self.wait = wait


def refused(error: openai.APIStatusError, key: str) -> Refused:
    """The failure that an error status means; `key` says in words which key was sent."""
    status, code = error.status_code, str(error.code or "")
    spent = code in SPENT
    message = f"{_status_text(status)}{_detail(error.body)}"
    if status in (401, 403):
        message += f" ({key})"
    again = (status in PASSING or status >= 500) and not spent
    wait = retry_after(error.response.headers) if again else None
    return Refused(message, again=again, fatal=status in FATAL or spent, wait=wait)


def _status_text(status: int) -> str:
    try:
        return f"HTTP {status} ({HTTPStatus(status).phrase})"
    except ValueError:
        return f"HTTP {status}"


def _detail(body: object) -> str:
    detail = error_text(body if isinstance(body, dict) else None)
    return f": {detail}" if detail else ""


def retry_after(headers: Mapping[str, str]) -> float | None:
    """The seconds in `Retry-After-Ms` or `Retry-After`; None where there are none.

    A date counts from the date of the response itself, so that no clock has to be right.
    """
    if (milliseconds := _number(headers.get("retry-after-ms"))) is not None:
        return milliseconds / 1000
    written = headers.get("retry-after")
    if (seconds := _number(written)) is not None:
        return seconds
    try:
        until = parsedate_to_datetime(written or "")
        sent = parsedate_to_datetime(headers.get("date", ""))
        return max(0.0, (until - sent).total_seconds())
    except (ValueError, TypeError):
        return None


def _number(text: str | None) -> float | None:
    try:
        value = float(text or "")
    except ValueError:
        return None
    return value if 0 <= value < 1e9 else None
