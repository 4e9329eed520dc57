"""The options of a model client: the endpoint, the model, limits, and where replies are kept."""

from __future__ import annotations

import ipaddress
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from irc.errors import OptionError

DEFAULT_URL = "https://api.openai.com/v1"
DEFAULT_KEY = "OPENAI_API_KEY"
URL_VARIABLE = "OPENAI_BASE_URL"


@dataclass(frozen=True)
class ClientOptions:
    """How to ask a model.

    `base_url` is that of any OpenAI-compatible endpoint; None: `$OPENAI_BASE_URL`, else OpenAI's.
    `key_variable` names the environment variable that has the key; None: no key is sent.
    `temperature`, `max_tokens` and `seed` are sent where they are given. `structured` asks for an
    answer that follows the method's schema, `stream` for one that comes in parts.

    `concurrency` bounds the requests under way, `requests_per_minute` and `tokens_per_minute` the
    rate. A request that fails for a passing reason is sent again, `retries` times; `first_wait` is
    about the seconds before the first time, which double each time, and `longest_wait` the most
    that a service may ask for. `request_timeout` is in seconds, for one request with its reply.

    `price_in` and `price_out` are for a million tokens. `cache`, `record` and `replay` are files.
    """

    model: str
    base_url: str | None = None
    key_variable: str | None = DEFAULT_KEY
    temperature: float | None = None
    max_tokens: int | None = None
    seed: int | None = None
    structured: bool = False
    stream: bool = False
    concurrency: int = 4
    requests_per_minute: float | None = None
    tokens_per_minute: float | None = None
    retries: int = 5
    first_wait: float = 1.0
    longest_wait: float = 120.0
    request_timeout: float = 120.0
    price_in: float | None = None
    price_out: float | None = None
    cache: Path | None = None
    record: Path | None = None
    replay: Path | None = None

    def __post_init__(self) -> None:
        """Raises `OptionError` for a value that is not allowed."""
        for wrong, message in _faults(self):
            if wrong:
                raise OptionError(message)

    @property
    def settings(self) -> dict[str, Any]:
        """The given options that change answers, beside model and messages."""
        given = {
            "temperature": self.temperature,
            "max_tokens": self.max_tokens,
            "seed": self.seed,
            "structured": self.structured or None,
        }
        return {name: value for name, value in given.items() if value is not None}


def _faults(options: ClientOptions) -> list[tuple[bool, str]]:
    def at_least(name: str, least: float, above: bool = False) -> tuple[bool, str]:
        value = getattr(options, name)
        words = "more than" if above else "at least"
        wrong = value is not None and not (value > least if above else value >= least)
        return wrong, f"{name} is {value}; it must be {words} {least:g}"

    return [
        (not options.model.strip(), "model is empty; name the model to ask"),
        at_least("concurrency", 1),
        at_least("retries", 0),
        at_least("requests_per_minute", 0, above=True),
        at_least("tokens_per_minute", 0, above=True),
        at_least("first_wait", 0),
        at_least("longest_wait", 0),
        at_least("request_timeout", 0, above=True),
        at_least("temperature", 0),
        at_least("max_tokens", 1),
        at_least("price_in", 0),
        at_least("price_out", 0),
        (
            options.replay is not None and options.record is not None,
            "replay asks no model, so there is nothing to record; give one of the two",
        ),
    ]


@dataclass(frozen=True)
class Endpoint:
    """Where requests go: a checked URL, and the key, which no text of this object shows."""

    url: str
    key: str | None

    def __repr__(self) -> str:
        return f"Endpoint({self.shown!r})"

    @property
    def shown(self) -> str:
        """The URL without user, password and query."""
        parts = urlsplit(self.url)
        host = parts.netloc.rpartition("@")[2]
        return f"{parts.scheme}://{host}{parts.path}"

    @property
    def is_openai(self) -> bool:
        """Whether it is OpenAI's own, which names one parameter differently."""
        return (urlsplit(self.url).hostname or "").endswith(".openai.com")

    def without_key(self, text: str) -> str:
        """A text in which the key does not stand, whatever it had."""
        return text if self.key is None else text.replace(self.key, "[key]")


def endpoint_of(options: ClientOptions, environment: Callable[[str], str | None]) -> Endpoint:
    """The endpoint. Raises `OptionError` for a wrong URL, and for a key that is missing."""
    url = (options.base_url or environment(URL_VARIABLE) or DEFAULT_URL).strip().rstrip("/")
    try:
        parts = urlsplit(url)
        usable = parts.scheme in ("http", "https") and bool(parts.hostname)
        _ = parts.port
    except ValueError:
        usable = False
    if not usable:
        message = f"the base URL {url!r} is none; write it as https://api.example.com/v1"
        raise OptionError(message)
    return Endpoint(url, _key(options, url, environment))


def _key(options: ClientOptions, url: str, environment: Callable[[str], str | None]) -> str | None:
    name = options.key_variable
    if name is None:
        return None
    key = (environment(name) or "").strip()
    if key:
        if not (key.isascii() and key.isprintable()) or " " in key:
            raise OptionError(f"${name} holds no key: it has characters that no key has")
        return key
    if _is_loopback(urlsplit(url).hostname or ""):
        return None
    raise OptionError(
        f"there is no key for {Endpoint(url, None).shown}: set the environment variable {name}, "
        "or name the variable that has the key with --key-variable ('' where none is needed)"
    )


def _is_loopback(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"
