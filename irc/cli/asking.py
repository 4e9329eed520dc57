"""The commands for language models. Their modules are imported when they run."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from irc.cli.options import FormatOption
from irc.cli.output import Format


def _option(panel: str | None, help: str, *names: str, **more: Any) -> Any:
    return typer.Option(*names, help=help, rich_help_panel=panel, **more)


_REQUEST = "Requests"
_LIMIT = "Limits"
_KEPT = "Kept replies and costs"

_Method = Annotated[
    str,
    _option(None, "planner, pddl21-formalizer, cpsat-formalizer, nl-ir, state-aware-repair."),
]
_Model = Annotated[str, _option(None, "The model's name, as its service has it.")]
_Questions = Annotated[Path, _option(None, "The questions: JSON, JSON lines, or a folder.")]
_Answers = Annotated[
    Path,
    _option(None, "The file of answers, NAME.jsonl; those in it stay.", "-o", "--output"),
]
_Rewrites = Annotated[
    int,
    _option(None, "Times that the model may put a faulty answer right.", min=0, max=10),
]
_First = Annotated[int | None, _option(None, "Only the first N instances.", min=1)]

_Url = Annotated[
    str | None,
    _option(_REQUEST, "Any OpenAI-compatible endpoint; else $OPENAI_BASE_URL, else OpenAI's."),
]
_KeyVariable = Annotated[
    str,
    _option(_REQUEST, "The environment variable that has the key; '' where none is needed."),
]
_Temperature = Annotated[
    float | None, _option(_REQUEST, "Sent only where it is given.", min=0, max=2)
]
_MaxTokens = Annotated[int | None, _option(_REQUEST, "The most tokens of one reply.", min=1)]
_Seed = Annotated[int | None, _option(_REQUEST, "For services that have one.")]
_Structured = Annotated[
    bool,
    _option(_REQUEST, "Output by the method's schema (nl-ir, state-aware-repair).", "--structured"),
]
_Stream = Annotated[bool, _option(_REQUEST, "Ask for replies in parts.", "--stream")]

_Concurrency = Annotated[int, _option(_LIMIT, "Requests at a time.", min=1, max=256)]
_Requests = Annotated[float | None, _option(_LIMIT, "The rate of requests.", min=0.1)]
_Tokens = Annotated[float | None, _option(_LIMIT, "The rate of tokens, in and out.", min=1)]
_Retries = Annotated[
    int,
    _option(_LIMIT, "Times that a request is sent again after a passing failure.", min=0, max=100),
]
_LongestWait = Annotated[
    float, _option(_LIMIT, "The most seconds that a service may ask to wait.", min=0)
]
_Timeout = Annotated[
    float, _option(_LIMIT, "Wall-clock seconds for one request with its reply.", min=0.01)
]
_TimeLimit = Annotated[
    float | None, _option(_LIMIT, "Wall-clock seconds for the whole run.", min=0.01)
]

_Cache = Annotated[
    Path | None, _option(_KEPT, "A file (SQLite) in which replies are kept and found again.")
]
_Record = Annotated[
    Path | None, _option(_KEPT, "A file to which each request is written with its reply.")
]
_Replay = Annotated[Path | None, _option(_KEPT, "A recording that answers in place of the model.")]
_PriceIn = Annotated[float | None, _option(_KEPT, "Price of a million tokens of prompts.", min=0)]
_PriceOut = Annotated[float | None, _option(_KEPT, "Price of a million tokens written.", min=0)]


def ask(
    method: _Method,
    model: _Model,
    instances: _Questions,
    output: _Answers,
    rewrites: _Rewrites = 3,
    first: _First = None,
    base_url: _Url = None,
    key_variable: _KeyVariable = "OPENAI_API_KEY",
    temperature: _Temperature = None,
    max_tokens: _MaxTokens = None,
    seed: _Seed = None,
    structured: _Structured = False,
    stream: _Stream = False,
    concurrency: _Concurrency = 4,
    requests_per_minute: _Requests = None,
    tokens_per_minute: _Tokens = None,
    retries: _Retries = 5,
    longest_wait: _LongestWait = 120.0,
    request_timeout: _Timeout = 120.0,
    time_limit: _TimeLimit = None,
    cache: _Cache = None,
    record: _Record = None,
    replay: _Replay = None,
    price_in: _PriceIn = None,
    price_out: _PriceOut = None,
    format: FormatOption = Format.text,
) -> None:
    """Let a language model answer instances with a method; `irc eval score` scores the answers."""
    from irc.cli.ask import ask_file
    from irc.client import ClientOptions

    given: dict[str, Any] = {
        "model": model,
        "base_url": base_url,
        "key_variable": key_variable or None,
        "temperature": temperature,
        "max_tokens": max_tokens,
        "seed": seed,
        "structured": structured,
        "stream": stream,
        "concurrency": concurrency,
        "requests_per_minute": requests_per_minute,
        "tokens_per_minute": tokens_per_minute,
        "retries": retries,
        "longest_wait": longest_wait,
        "request_timeout": request_timeout,
        "cache": cache,
        "record": record,
        "replay": replay,
        "price_in": price_in,
        "price_out": price_out,
    }
    ask_file(
        method,
        instances,
        output,
        lambda: ClientOptions(**given),
        rewrites,
        first,
        time_limit,
        format,
    )
