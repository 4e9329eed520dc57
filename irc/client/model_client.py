"""The model client: asks a language model behind any OpenAI-compatible endpoint.

`ModelClient.ask` is the function that `irc.methods.converse` takes. It may be called from any
number of threads: all requests run in one event loop, in a thread of its own, which keeps to the
limits on concurrency and rate, and which a cancellation ends at once.
"""

from __future__ import annotations

import asyncio
import json
import os
import threading
from collections.abc import Coroutine, Sequence
from concurrent.futures import Future
from concurrent.futures import TimeoutError as NotYet
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING, Any, Self

from irc.client.completion import MOST_BYTES, Completion, NoAnswer, Usage, read_body
from irc.client.failures import Refused, refused
from irc.client.kept import Cache, NotRecorded, Recorder, Replay, Request, fingerprint
from irc.client.options import ClientOptions, Endpoint, endpoint_of
from irc.client.rate import Rate
from irc.errors import IrcError, LibraryMissing
from irc.methods import Message, Method, Reply
from irc.methods.loop import Ask
from irc.outcome import INTERRUPTED
from irc.targets import Budget

if TYPE_CHECKING:
    import openai
    import tenacity

POLL_SECONDS = 0.05
CHARACTERS_PER_TOKEN = 4
"""For the tokens that a request is expected to take; its reply says how many it took."""


class AskingEnded(IrcError):
    """The time of a client is over, or it was cancelled; nothing more is asked."""

    ends_as = INTERRUPTED


@dataclass
class Counts:
    """The work of a client: requests sent, sent again, replies that were kept, tokens."""

    requests: int = 0
    retries: int = 0
    failures: int = 0
    from_cache: int = 0
    replayed: int = 0
    usage: Usage = field(default_factory=Usage)

    def cost(self, price_in: float | None, price_out: float | None) -> float | None:
        """The cost, at prices for a million tokens; None where no price is known."""
        if price_in is None and price_out is None:
            return None
        spent = self.usage.prompt * (price_in or 0) + self.usage.completion * (price_out or 0)
        return spent / 1e6


class ModelClient:
    """Asks one model, with limits, retries, a cache and a recording as its options say.

    It is a context manager: leaving it ends the requests under way and closes the files.
    """

    def __init__(self, options: ClientOptions, budget: Budget | None = None) -> None:
        """Opens the files. `budget` bounds all that is asked.

        Raises `OptionError` for a missing key, `StoreError`, `WriteError`, or `LibraryMissing`.
        """
        self.options = options
        self.counts = Counts()
        self._budget = budget or Budget()
        self._lock = threading.Lock()
        self._replay = None if options.replay is None else Replay(options.replay)
        self._endpoint: Endpoint | None = None
        if self._replay is None:
            self._endpoint = endpoint_of(options, os.environ.get)
            _require_libraries()
        self._cache = None if options.cache is None else Cache(options.cache)
        self._recorder = None if options.record is None else Recorder(options.record)
        self._sender = None if self._endpoint is None else _Sender(options, self._endpoint, self)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        self.close()

    def close(self) -> None:
        """Ends the requests under way, and closes the files."""
        for part in (self._sender, self._cache, self._recorder):
            if part is not None:
                part.close()

    def asking(self, method: Method) -> Ask:
        """The function that asks for answers of a method, in its schema where that is wanted."""
        return partial(self.ask, schema=method.schema if self.options.structured else None)

    def ask(self, messages: Sequence[Message], schema: str | None = None) -> Reply:
        """The model's reply to a conversation. `schema` is that of a method.

        Raises `ServiceFailure` where the service gives no answer, and `AskingEnded`.
        """
        request: Request = {
            "model": self.options.model,
            "messages": list(messages),
            **self.options.settings,
        }
        completion = self._kept(request)
        if completion is None:
            completion = self._sent(request, schema)
        if self._recorder is not None:
            self._recorder.note(request, completion)
        return completion.reply

    def _kept(self, request: Request) -> Completion | None:
        """The reply in the recording or the cache; None where it has to be asked for."""
        if self._replay is not None:
            try:
                completion = self._replay.get(request)
            except NotRecorded:
                self.count(failures=1)
                raise
            self.count(replayed=1)
            return completion
        if self._cache is None or (found := self._cache.get(self._key(request))) is None:
            return None
        self.count(from_cache=1)
        return found

    def _key(self, request: Request) -> str:
        assert self._endpoint is not None
        return fingerprint(request, self._endpoint.shown)

    def _sent(self, request: Request, schema: str | None) -> Completion:
        assert self._sender is not None
        assert self._endpoint is not None
        try:
            completion = self._waited(self._sender.begin(request, schema))
        except NoAnswer as error:
            self.count(failures=1)
            error.args = (self._endpoint.without_key(str(error)),)
            raise
        self.count(usage=completion.usage)
        text = self._endpoint.without_key(completion.reply.text)
        completion = replace(completion, reply=replace(completion.reply, text=text))
        if self._cache is not None:
            self._cache.put(self._key(request), completion)
        return completion

    def _waited(self, sending: Future[Completion]) -> Completion:
        while True:
            try:
                return sending.result(timeout=POLL_SECONDS)
            except NotYet:
                if sending.done():
                    raise
                if self._budget.is_over:
                    sending.cancel()
                    raise _ended(self._budget) from None

    def count(self, usage: Usage | None = None, **more: int) -> None:
        """Adds to the counts."""
        with self._lock:
            for name, number in more.items():
                setattr(self.counts, name, getattr(self.counts, name) + number)
            if usage is not None:
                self.counts.usage += usage


def _ended(budget: Budget) -> AskingEnded:
    if budget.is_cancelled:
        return AskingEnded("asking was cancelled")
    return AskingEnded(f"the time limit of {budget.limit:g} s is over")


def _require_libraries() -> None:
    from importlib.util import find_spec

    missing = [name for name in ("openai", "tenacity") if find_spec(name) is None]
    if missing:
        message = f"asking a model needs {' and '.join(missing)}: pip install 'irc-compiler[llm]'"
        raise LibraryMissing(message)


class _Sender:
    """The event loop in which requests are sent, in a thread of its own."""

    def __init__(self, options: ClientOptions, endpoint: Endpoint, client: ModelClient) -> None:
        self._options = options
        self._endpoint = endpoint
        self._client = client
        self._rate = Rate(options.requests_per_minute, options.tokens_per_minute)
        self._slots = asyncio.Semaphore(options.concurrency)
        self._service = _connected(options, endpoint)
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, daemon=True, name="irc asks")
        self._thread.start()

    def begin(self, request: Request, schema: str | None) -> Future[Completion]:
        """Sends a request as soon as the limits allow it."""
        return self._run(self._completion(request, schema))

    def _run(self, work: Coroutine[Any, Any, Completion]) -> Future[Completion]:
        return asyncio.run_coroutine_threadsafe(work, self._loop)

    def close(self) -> None:
        """Cancels what is under way and ends the loop."""
        if not self._loop.is_closed():
            asyncio.run_coroutine_threadsafe(self._cancel_all(), self._loop).result()
            self._loop.call_soon_threadsafe(self._loop.stop)
            self._thread.join()
            self._loop.close()

    async def _cancel_all(self) -> None:
        others = asyncio.all_tasks() - {asyncio.current_task()}
        for task in others:
            task.cancel()
        await asyncio.gather(*others, return_exceptions=True)
        await self._service.close()

    async def _completion(self, request: Request, schema: str | None) -> Completion:
        import tenacity

        async with self._slots:
            trying = tenacity.AsyncRetrying(
                stop=tenacity.stop_after_attempt(self._options.retries + 1),
                wait=self._wait,
                retry=tenacity.retry_if_exception(self._may_pass),
                before_sleep=lambda _: self._client.count(retries=1),
                reraise=True,
            )
            return await trying(self._once, request, schema)

    def _may_pass(self, error: BaseException) -> bool:
        return isinstance(error, NoAnswer) and error.again

    def _wait(self, state: tenacity.RetryCallState) -> float:
        """The seconds before a request is sent again: those asked for, or ever more."""
        import tenacity

        error = None if state.outcome is None else state.outcome.exception()
        wanted = error.wait if isinstance(error, Refused) else None
        if wanted is not None:
            # The service speaks to all requests of this client, not to this one alone.
            self._rate.hold(wanted)
            return wanted
        first, longest = self._options.first_wait, self._options.longest_wait
        doubled = tenacity.wait_exponential(multiplier=first, max=longest)
        jitter = tenacity.wait_random(0, first / 2)
        return (doubled + jitter)(state)

    async def _once(self, request: Request, schema: str | None) -> Completion:
        expected = len(json.dumps(request["messages"])) // CHARACTERS_PER_TOKEN
        await self._rate.take(expected)
        self._client.count(requests=1)
        try:
            async with asyncio.timeout(self._options.request_timeout):
                body = await self._body(request, schema)
        except TimeoutError:
            seconds = self._options.request_timeout
            raise NoAnswer(f"no answer within {seconds:g} s", again=True) from None
        completion = read_body(body, self._endpoint.shown)
        used = completion.usage
        self._rate.used(expected, used.prompt + used.completion)
        return completion

    async def _body(self, request: Request, schema: str | None) -> str:
        """The body of the response to a request. Raises `NoAnswer`."""
        import httpx2
        import openai

        try:
            sending = self._service.chat.completions.with_streaming_response
            async with sending.create(**self._fields(request, schema)) as response:
                return await _limited(response.iter_bytes())
        except openai.APIStatusError as error:
            raise self._long_wait(refused(error, self._key_in_words)) from None
        except openai.APITimeoutError:
            raise TimeoutError from None
        except (openai.APIConnectionError, httpx2.HTTPError) as error:
            reason = str(error.__cause__ or error) or type(error).__name__
            message = f"the connection to {self._endpoint.shown} failed: {reason}"
            raise NoAnswer(message, again=True) from None

    @property
    def _key_in_words(self) -> str:
        name = self._options.key_variable
        if self._endpoint.key is not None:
            return f"the key is that of the environment variable {name}"
        return "no key was sent" if name is None else f"no key was sent: {name} is not set"

    def _long_wait(self, failure: Refused) -> Refused:
        longest = self._options.longest_wait
        if failure.wait is None or failure.wait <= longest:
            return failure
        message = (
            f"{failure}; it asks to wait {failure.wait:g} s, and at most {longest:g} s are allowed"
        )
        return Refused(message, again=False, fatal=False)

    def _fields(self, request: Request, schema: str | None) -> dict[str, Any]:
        """The fields of a request as the endpoint wants them."""
        fields = {k: v for k, v in request.items() if k not in ("max_tokens", "structured")}
        if (most := request.get("max_tokens")) is not None:
            # OpenAI's newer models refuse the older name; other services know only that.
            name = "max_completion_tokens" if self._endpoint.is_openai else "max_tokens"
            fields[name] = most
        if schema is not None:
            fields["response_format"] = _response_format(schema)
        if self._options.stream:
            fields |= {"stream": True, "stream_options": {"include_usage": True}}
        return fields


def _connected(options: ClientOptions, endpoint: Endpoint) -> openai.AsyncOpenAI:
    # (Here, and not when the first request is sent: loading it takes a second of that one's time.)
    import openai

    return openai.AsyncOpenAI(
        api_key=endpoint.key or "none",
        base_url=endpoint.url,
        max_retries=0,
        timeout=options.request_timeout,
    )


async def _limited(parts: Any) -> str:
    """The text of a body. Raises `NoAnswer` where it is longer than any answer is."""
    found = bytearray()
    async for part in parts:
        found += part
        if len(found) > MOST_BYTES:
            raise NoAnswer(f"the service's response is longer than {MOST_BYTES >> 20} MiB")
    return found.decode("utf-8", "replace")


def _response_format(schema: str) -> dict[str, Any]:
    from irc.model.strict_schema import strict_schema

    part = strict_schema("event" if schema == "event" else "task")
    return {
        "type": "json_schema",
        "json_schema": {"name": schema, "strict": True, "schema": part},
    }
