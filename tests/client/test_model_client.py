"""The model client against a real HTTP server on loopback, in all the ways in which one fails."""

from __future__ import annotations

import json
import logging
import sqlite3
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from irc.client import (
    AskingEnded,
    ClientOptions,
    Counts,
    ModelClient,
    NoAnswer,
    NotRecorded,
    StoreError,
    Usage,
)
from irc.client.completion import read_body
from irc.client.failures import retry_after
from irc.client.options import endpoint_of
from irc.client.rate import Bucket
from irc.driver.files import WriteError
from irc.errors import OptionError
from irc.methods import METHODS, AnswerState, FinishReason, Message, converse, step_instance
from irc.targets import Budget, Cancellation
from model_server import ModelServer, Said, completion, error, in_turn, stream

HELLO: list[Message] = [{"role": "user", "content": "hello"}]
QUESTION = step_instance({"id": 1, "question": "Step 1. Boil (4 min)\nStep 2. Peel (2 min)"})
RIGHT = '{"time_unit": "min", "actions": [{"id": "step1", "duration": 4}]}'
WRONG = RIGHT.replace("duration", "durration")
SECRET = "sk-very-secret-0123456789"


@pytest.fixture(autouse=True)
def _no_key(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("OPENAI_API_KEY", "OPENAI_BASE_URL"):
        monkeypatch.delenv(name, raising=False)


def client(server: ModelServer, budget: Budget | None = None, **options: Any) -> ModelClient:
    given = {"first_wait": 0.02, "retries": 2, **options}
    return ModelClient(ClientOptions("m", server.url, **given), budget)


def asked(*said: Said, **options: Any) -> tuple[Any, ModelClient, ModelServer]:
    """What a model behind these responses answers, or the failure."""
    with ModelServer(said) as server, client(server, **options) as found:
        try:
            return found.ask(HELLO), found, server
        except NoAnswer as failure:
            return failure, found, server


# --- replies ------------------------------------------------------------------------------------


def test_a_reply_is_the_text_with_why_it_ends_and_what_it_took() -> None:
    reply, found, server = asked(completion("hi there"), temperature=0.5, max_tokens=9, seed=3)
    assert (reply.text, reply.finish_reason) == ("hi there", FinishReason.STOP)
    assert found.counts == Counts(requests=1, usage=Usage(100, 40, 20, 5))
    assert found.counts.cost(1.0, 10.0) == pytest.approx((100 * 1 + 20 * 10) / 1e6)
    assert found.counts.cost(None, None) is None
    sent = {"model": "m", "messages": HELLO, "temperature": 0.5, "max_tokens": 9, "seed": 3}
    assert server.requests == [sent]


@pytest.mark.parametrize(
    ("said", "text", "reason"),
    [
        (completion("cut he", finish="length"), "cut he", "length"),
        (completion("", finish="length"), "", "length"),
        (completion(None), "", "stop"),
        (completion(None, refusal="I cannot."), "I cannot.", "refusal"),
        (completion("x", finish=None), "x", None),
        (completion([{"type": "text", "text": "in "}, {"text": "parts"}]), "in parts", "stop"),  # type: ignore[arg-type]
        (stream("in ", "parts\u2028"), "in parts\u2028", "stop"),
        (stream("cut", finish="length"), "cut", "length"),
    ],
)
def test_replies_of_every_kind(said: Said, text: str, reason: str | None) -> None:
    reply, found, server = asked(said, stream=said.body.startswith("data"))
    assert (reply.text, reply.finish_reason) == (text, reason)
    assert len(server.requests) == 1
    assert found.counts.failures == 0


def test_the_schema_of_a_method_is_sent_where_structured_output_is_wanted() -> None:
    with ModelServer([completion(RIGHT)]) as server:
        for structured in (True, False):
            with client(server, structured=structured) as found:
                assert converse(METHODS["nl-ir"], QUESTION, found.asking(METHODS["nl-ir"])).task
    first, second = server.requests
    assert first["response_format"]["json_schema"]["strict"] is True
    assert "actions" in first["response_format"]["json_schema"]["schema"]["properties"]
    assert "response_format" not in second


# --- failures -----------------------------------------------------------------------------------

NOTHING = Said(completion("").body, cut=40)


@pytest.mark.parametrize(
    "passing",
    [
        error(429),
        error(500),
        error(503),
        error(408),
        Said("busy", status=502, headers={"content-type": "text/html"}),
        NOTHING,
        Said('{"choices": [{"mess'),
        Said(""),
        Said("[]"),
        Said('{"choices": []}'),
        Said('{"choices": [{"message": 3}]}'),
        Said('{"choices": [{"message": {"content": 3}}]}'),
        Said('{"error": {"message": "overloaded"}}'),
        stream("half of an ans", finish=None),
        Said('data: {"choices": [{"del', headers={"content-type": "text/event-stream"}),
        Said("[" * 100_000),
    ],
)
def test_a_failure_that_passes_is_no_failure(passing: Said) -> None:
    reply, found, server = asked(passing, passing, completion("at last"))
    assert reply.text == "at last"
    assert len(server.requests) == 3
    assert (found.counts.requests, found.counts.retries, found.counts.failures) == (3, 2, 0)


@pytest.mark.parametrize(
    ("said", "message", "requests"),
    [
        (error(500, "all is lost"), "HTTP 500 (Internal Server Error): all is lost", 3),
        (error(400, "too long"), "HTTP 400 (Bad Request): too long", 1),
        (error(401, "bad key"), "HTTP 401 (Unauthorized): bad key (no key was sent", 1),
        (error(404), "HTTP 404 (Not Found): no", 1),
        (error(429, retry_after="3600"), "it asks to wait 3600 s, and at most 120 s", 1),
        (Said("<!doctype html><p>Hello"), "a page in HTML; is http://127.0.0.1:", 1),
        (completion(None, finish="content_filter"), "content filter withholds", 1),
        (Said('{"choices": []}'), "answered without a choice", 3),
        (Said('{"choices": [{"mess'), "cut off after 19 characters", 3),
        (Said("no JSON at all"), "something else than JSON: 'no JSON at all'", 3),
        (NOTHING, "the connection to http://127.0.0.1:", 3),
        (stream("half", finish=None), "stream ended before the answer did", 3),
    ],
)
def test_a_failure_says_what_happened(said: Said, message: str, requests: int) -> None:
    failure, found, server = asked(said)
    assert message in str(failure)
    assert len(server.requests) == requests
    assert found.counts.failures == 1


def test_an_account_that_is_spent_is_not_asked_again() -> None:
    body = json.dumps({"error": {"message": "pay", "code": "insufficient_quota"}})
    failure, _, server = asked(Said(body, 429))
    assert isinstance(failure, NoAnswer)
    assert failure.fatal
    assert len(server.requests) == 1


def test_a_response_without_end_is_given_up() -> None:
    failure, _, _ = asked(Said(" " * (17 * 2**20)))
    assert "longer than 16 MiB" in str(failure)


def test_no_service_at_all_is_named() -> None:
    with ModelServer([]) as server:
        gone = server.url
    with ModelClient(ClientOptions("m", gone, retries=0)) as found:
        with pytest.raises(NoAnswer, match=r"the connection to http://127\.0\.0\.1") as failed:
            found.ask(HELLO)
        assert failed.value.again


@pytest.mark.slow
@pytest.mark.parametrize("said", [Said(delay=60), Said(completion("slow").body, drip=0.05)])
def test_a_reply_that_does_not_come_in_time_is_given_up(said: Said) -> None:
    failure, _, server = asked(said, request_timeout=0.3, retries=1)
    assert str(failure) == "no answer within 0.3 s"
    assert len(server.requests) == 2


@pytest.mark.slow
def test_what_a_service_asks_to_wait_is_waited_by_all() -> None:
    begun: list[float] = []

    def script(_request: dict[str, Any], number: int) -> Said:
        begun.append(time.monotonic())
        return error(429, retry_after="0.4") if number == 0 else completion("x")

    with ModelServer(script) as server, client(server, concurrency=1) as found:
        found.ask(HELLO)
        assert begun[1] - begun[0] >= 0.4


@pytest.mark.parametrize(
    ("headers", "seconds"),
    [
        ({"retry-after": "7"}, 7),
        ({"retry-after": "1.5"}, 1.5),
        ({"retry-after-ms": "250", "retry-after": "9"}, 0.25),
        (
            {
                "retry-after": "Wed, 21 Oct 2026 07:28:30 GMT",
                "date": "Wed, 21 Oct 2026 07:28:00 GMT",
            },
            30,
        ),
        ({"retry-after": "Wed, 21 Oct 2026 07:28:30 GMT"}, None),
        ({"retry-after": "soon"}, None),
        ({"retry-after": "-3"}, None),
        ({"retry-after": "nan"}, None),
        ({}, None),
    ],
)
def test_retry_after_in_all_its_forms(headers: dict[str, str], seconds: float | None) -> None:
    assert retry_after(headers) == seconds


# --- limits -------------------------------------------------------------------------------------


def test_a_bucket_gives_what_has_flowed_in() -> None:
    bucket = Bucket(60)
    assert bucket.missing(60, 0.0) == 0
    bucket.take(60, 0.0)
    assert bucket.missing(10, 0.0) == pytest.approx(10)
    assert bucket.missing(10, 4.0) == pytest.approx(6)
    bucket.take(-30, 4.0)
    assert bucket.missing(10, 4.0) == 0
    assert bucket.missing(1000, 1000.0) == 0  # More than there ever is: a full one is enough.


@pytest.mark.slow
def test_no_more_requests_run_at_once_than_allowed() -> None:
    slow = Said(completion("x").body, delay=0.1)
    with ModelServer([slow]) as server, client(server, concurrency=3) as found:
        threads = [threading.Thread(target=found.ask, args=(HELLO,)) for _ in range(9)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(20)
        assert len(server.requests) == 9
        assert 2 <= server.most_at_once <= 3


@pytest.mark.slow
@pytest.mark.parametrize("limit", [{"requests_per_minute": 120}, {"tokens_per_minute": 2400}])
def test_the_rate_stays_below_its_limit(limit: dict[str, float]) -> None:
    """A stock of a minute is there at the beginning; here it is taken away first."""
    begun = time.monotonic()
    with ModelServer([completion("x")]) as server, client(server, **limit) as found:
        assert found._sender is not None
        rate = found._sender._rate
        for bucket in (rate._requests, rate._tokens):
            if bucket is not None:
                bucket._level = 0
        found.ask(HELLO)
        assert time.monotonic() - begun > 0.4 * bool(limit.get("requests_per_minute"))
        if "tokens_per_minute" in limit:  # 120 tokens were used, of which some were expected.
            assert rate._tokens is not None
            assert rate._tokens._level < -100


# --- ends ---------------------------------------------------------------------------------------


def end_of(budget: Budget, later: Callable[[], None] = lambda: None) -> str:
    with ModelServer([Said(delay=60)]) as server, client(server, budget) as found:
        timer = threading.Timer(0.2, later)
        timer.start()
        begun = time.monotonic()
        with pytest.raises(AskingEnded) as ended:
            found.ask(HELLO)
        assert time.monotonic() - begun < 5
    return str(ended.value)


@pytest.mark.slow
def test_a_cancellation_ends_a_request_under_way() -> None:
    cancel = Cancellation()
    assert end_of(Budget(cancel=cancel), cancel.cancel) == "asking was cancelled"


@pytest.mark.slow
def test_so_does_a_time_limit() -> None:
    assert end_of(Budget(0.3)) == "the time limit of 0.3 s is over"


def test_a_client_that_is_closed_leaves_no_thread() -> None:
    before = threading.active_count()
    with ModelServer([completion("x")]) as server:
        found = client(server)
        found.ask(HELLO)
        found.close()
        found.close()
    time.sleep(0.05)
    assert not [t for t in threading.enumerate() if t.name == "irc asks"]
    assert threading.active_count() <= before + 2


# --- keys ---------------------------------------------------------------------------------------


def endpoint(url: str | None = None, **environment: str) -> Any:
    return endpoint_of(ClientOptions("m", url), environment.get)


def test_a_missing_key_names_its_variable() -> None:
    with pytest.raises(OptionError, match="set the environment variable OPENAI_API_KEY"):
        endpoint()
    with pytest.raises(OptionError, match=r"there is no key for https://example\.org/v1: set .* X"):
        endpoint_of(ClientOptions("m", "https://u:p@example.org/v1", "X"), {"X": " "}.get)
    with pytest.raises(OptionError, match=r"\$OPENAI_API_KEY holds no key"):
        endpoint(OPENAI_API_KEY="two words")


def test_a_server_of_ones_own_needs_no_key() -> None:
    for host in ("127.0.0.1:8000", "localhost:8000", "[::1]:8000"):
        assert endpoint(f"http://{host}/v1").key is None
    options = ClientOptions("m", "http://gpu.example.org/v1", None)
    assert endpoint_of(options, {}.get).key is None


@pytest.mark.parametrize("url", ["example.org/v1", "ftp://example.org", "http://", "http://a:b:c"])
def test_a_wrong_url_is_named(url: str) -> None:
    with pytest.raises(OptionError, match="base URL"):
        endpoint(url)


def test_the_key_is_sent_and_written_nowhere(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """Neither by a log, nor by a cache or recording, nor by a service that repeats it."""
    monkeypatch.setenv("OPENAI_API_KEY", f" {SECRET}\n")
    caplog.set_level(logging.DEBUG)
    kept = {"cache": tmp_path / "c.sqlite", "record": tmp_path / "r.jsonl"}
    script = in_turn(completion(f"your key is {SECRET}"), error(400, f"bad {SECRET}"))
    with ModelServer(script) as server, client(server, **kept) as found:
        said = [found.ask(HELLO).text]
        with pytest.raises(NoAnswer) as failure:
            found.ask([{"role": "user", "content": "again"}])
        said += [str(failure.value), repr(failure.value), repr(found._endpoint)]
        assert server.headers[0]["authorization"] == f"Bearer {SECRET}"
    said += [path.read_bytes().decode("latin-1") for path in tmp_path.iterdir()]
    assert "your key is [key]" in said[0]
    assert not [text for text in (*said, caplog.text) if SECRET in text]


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"concurrency": 0}, "concurrency is 0; it must be at least 1"),
        ({"requests_per_minute": 0}, "must be more than 0"),
        ({"request_timeout": float("nan")}, "request_timeout is nan"),
        ({"replay": Path("a"), "record": Path("b")}, "nothing to record"),
    ],
)
def test_a_wrong_option_says_what_to_write(wrong: dict[str, Any], message: str) -> None:
    with pytest.raises(OptionError, match=message):
        ClientOptions("m", **wrong)
    with pytest.raises(OptionError, match="name the model"):
        ClientOptions(" ")


# --- cache --------------------------------------------------------------------------------------


def test_a_reply_in_the_cache_is_not_asked_for_again(tmp_path: Path) -> None:
    kept = tmp_path / "cache.sqlite"
    with ModelServer(in_turn(*(completion(str(n)) for n in range(9)))) as server:
        for options, text in (({}, "0"), ({}, "0"), ({"seed": 1}, "1"), ({"seed": 1}, "1")):
            with client(server, cache=kept, **options) as found:
                assert found.ask(HELLO).text == text
        assert found.counts == Counts(from_cache=1)
        with client(server, cache=kept) as found:
            assert found.ask([{"role": "user", "content": "other"}]).text == "2"
    with ModelServer([completion("of another address")]) as other, client(other, cache=kept) as f:
        assert f.ask(HELLO).text == "of another address"


def test_failures_are_not_kept(tmp_path: Path) -> None:
    kept = {"cache": tmp_path / "c", "record": tmp_path / "r", "retries": 0}
    with ModelServer([error(500), completion("x")]) as server, client(server, **kept) as found:
        with pytest.raises(NoAnswer):
            found.ask(HELLO)
        assert found.ask(HELLO).text == "x"
    assert len((tmp_path / "r").read_text().splitlines()) == 1


def test_a_file_that_is_no_cache_is_named_and_left_as_it_is(tmp_path: Path) -> None:
    text = tmp_path / "notes.txt"
    text.write_text("my notes " * 200)
    with ModelServer([]) as server:
        with pytest.raises(StoreError, match=r"cannot use the cache .*notes\.txt"):
            client(server, cache=text)
        with pytest.raises(WriteError, match=r"line 1: expected|something else"):
            client(server, record=text)
    assert text.read_text() == "my notes " * 200
    other = tmp_path / "other.sqlite"
    with sqlite3.connect(other) as file:
        file.execute("PRAGMA user_version = 7")
    with ModelServer([]) as server, pytest.raises(StoreError, match="of another version of irc: 7"):
        client(server, cache=other)


WRITER = """
import sys
from pathlib import Path
from irc.client.completion import Completion
from irc.client.kept import Cache
from irc.methods import Reply
cache = Cache(Path(sys.argv[1]))
for n in range(60):
    cache.put(f"{n}", Completion(Reply(f"reply {n}")))
    assert cache.get(f"{n}").reply.text == f"reply {n}"
"""


@pytest.mark.slow
def test_processes_share_a_cache(tmp_path: Path) -> None:
    kept = tmp_path / "shared.sqlite"
    running = [subprocess.Popen([sys.executable, "-c", WRITER, str(kept)]) for _ in range(2)]
    assert [process.wait(60) for process in running] == [0, 0]
    with sqlite3.connect(kept) as file:
        assert file.execute("SELECT count(*) FROM replies").fetchone() == (60,)


# --- recordings ---------------------------------------------------------------------------------


def test_a_run_is_replayed_without_a_network(tmp_path: Path) -> None:
    file = tmp_path / "run.jsonl"
    method = METHODS["nl-ir"]
    said = in_turn(completion(WRONG), completion(RIGHT))
    with ModelServer(said) as server, client(server, record=file, seed=4) as found:
        first = converse(method, QUESTION, found.asking(method))
    with ModelClient(ClientOptions("m", "https://nowhere.invalid", seed=4, replay=file)) as found:
        again = converse(method, QUESTION, found.asking(method))
    assert [a.state for a in again.answers] == [AnswerState.INVALID, AnswerState.OK]
    assert again.messages == first.messages
    assert found.counts == Counts(replayed=2)


def test_a_request_that_is_missing_in_a_recording_is_named(tmp_path: Path) -> None:
    file = tmp_path / "run.jsonl"
    with ModelServer([completion("x")]) as server, client(server, record=file, seed=4) as found:
        found.ask(HELLO)
        found.ask(HELLO)
    assert len(file.read_text().splitlines()) == 1

    def missing(text: str, **options: Any) -> str:
        with ModelClient(ClientOptions("m", replay=file, **options)) as found:
            with pytest.raises(NotRecorded) as failure:
                found.ask([{"role": "user", "content": text}])
            return str(failure.value)

    assert "has no reply to the request that ends in 'bye' (message 1" in missing("bye", seed=4)
    assert "recorded with seed 4, and this one has seed 5" in missing("hello", seed=5)


def test_a_recording_that_was_cut_goes_on(tmp_path: Path) -> None:
    file = tmp_path / "run.jsonl"
    with ModelServer([completion("x")]) as server:
        for text in ("a", "b", "c"):
            with client(server, record=file) as found:
                found.ask([{"role": "user", "content": text}])
            if text == "b":
                file.write_text(file.read_text()[:-30])
        lines = [json.loads(line) for line in file.read_text().splitlines()]
    assert [line["request"]["messages"][0]["content"] for line in lines] == ["a", "c"]


@pytest.mark.parametrize(
    ("text", "message"),
    [("{}\n", "line 1: it has no 'irc_recording'"), ("[]\n", "line 1"), ("\udcff\n", "UTF-8")],
)
def test_a_file_that_is_no_recording_is_named(tmp_path: Path, text: str, message: str) -> None:
    file = tmp_path / "run.jsonl"
    file.write_bytes(text.encode("utf-8", "surrogateescape"))
    with pytest.raises((StoreError, WriteError), match=message):
        ModelClient(ClientOptions("m", replay=file))
    with pytest.raises(StoreError, match="there is no recording"):
        ModelClient(ClientOptions("m", replay=tmp_path / "none"))


# --- the states of answers ----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("said", "state", "shown"),
    [
        (completion(RIGHT), "ok", ""),
        (completion(""), "empty", "the answer is empty"),
        (completion(RIGHT[:30], finish="length"), "truncated", "reached its limit of tokens"),
        (completion("", finish="length"), "truncated", "reached its limit of tokens"),
        (completion(None, refusal="I will not."), "malformed", "the model refuses to answer"),
        (completion("I will not."), "malformed", "no JSON object that can be read"),
        (completion("I will not.", finish=None), "truncated", "the answer is cut off"),
        (completion(WRONG), "invalid", "no field 'durration'"),
        (error(500), None, "HTTP 500"),
        (Said('{"choices": []}'), None, "without a choice"),
    ],
)
def test_states_of_answers_and_failures_of_the_service_are_kept_apart(
    said: Said, state: str | None, shown: str
) -> None:
    with ModelServer([said]) as server, client(server, retries=0) as found:
        talk = converse(METHODS["nl-ir"], QUESTION, found.ask, rewrites=0)
    if state is None:
        assert talk.answer is None
        assert talk.service_failure is not None
        assert shown in talk.service_failure
    else:
        assert talk.answer is not None
        assert talk.answer.state == state
        assert shown in "\n".join(d.message for d in talk.answer.report.errors)


@pytest.mark.parametrize("body", ['{"choices": [null]}', "null", '{"error": null}', "data: 3"])
def test_nothing_that_a_service_sends_ends_in_another_error(body: str) -> None:
    with pytest.raises(NoAnswer):
        read_body(body, "http://x")
