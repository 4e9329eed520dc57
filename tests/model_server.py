"""A model's service on loopback: an HTTP server that answers as its script says.

`ModelServer(script)` serves until it is closed. `script` is a function from the request's body and
its number to a `Said`. All requests are kept, with their headers.
"""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any, Self


@dataclass(frozen=True)
class Said:
    """A response. `cut` closes the connection after that many bytes of the announced body."""

    body: str = ""
    status: int = 200
    headers: Mapping[str, str] = field(default_factory=dict)
    cut: int | None = None
    delay: float = 0.0
    """Seconds before the response; they end when the server is closed."""
    drip: float = 0.0
    """Seconds between one byte of the body and the next."""


def completion(text: str | None, *, finish: str | None = "stop", **message: Any) -> Said:
    """The response of a service that works."""
    choice = {
        "index": 0,
        "finish_reason": finish,
        "message": {"role": "assistant", "content": text, **message},
    }
    usage = {
        "prompt_tokens": 100,
        "completion_tokens": 20,
        "prompt_tokens_details": {"cached_tokens": 40},
        "completion_tokens_details": {"reasoning_tokens": 5},
    }
    return Said(json.dumps({"model": "m-2026", "choices": [choice], "usage": usage}))


def stream(*parts: str, finish: str | None = "stop") -> Said:
    """A response in parts; without a reason at its end it is broken."""
    events: list[dict[str, Any]] = [{"choices": [{"delta": {"content": part}}]} for part in parts]
    if finish is not None:
        events.append({"choices": [{"delta": {}, "finish_reason": finish}]})
        events.append({"choices": [], "usage": {"prompt_tokens": 7, "completion_tokens": 3}})
    lines = [f"data: {json.dumps(event)}\n\n" for event in events]
    end = "data: [DONE]\n\n" if finish is not None else ""
    return Said("".join(lines) + end, headers={"content-type": "text/event-stream"})


def error(status: int, message: str = "no", **headers: str) -> Said:
    """A response with an error status."""
    body = json.dumps({"error": {"message": message}})
    return Said(body, status, {k.replace("_", "-"): v for k, v in headers.items()})


Script = Callable[[dict[str, Any], int], Said]


def in_turn(*said: Said) -> Script:
    """A script: these responses one after the other, then the last one for ever."""
    return lambda _request, number: said[min(number, len(said) - 1)]


class ModelServer:
    """Serves a script on a free port of 127.0.0.1."""

    def __init__(self, script: Script | Sequence[Said]) -> None:
        self.script = script if callable(script) else in_turn(*script)
        self.requests: list[dict[str, Any]] = []
        self.headers: list[Mapping[str, str]] = []
        self.most_at_once = 0
        self._at_once = 0
        self._lock = threading.Lock()
        self.closing = threading.Event()
        server = self

        class Handler(BaseHTTPRequestHandler):
            protocol_version = "HTTP/1.1"

            def do_POST(self) -> None:
                server.serve(self)

            def log_message(self, *_: object) -> None:
                pass

        self._http = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self._http.daemon_threads = True
        self._http.block_on_close = False
        self.url = f"http://127.0.0.1:{self._http.server_address[1]}/v1"
        self._thread = threading.Thread(target=self._http.serve_forever, args=(0.02,), daemon=True)
        self._thread.start()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.closing.set()
        self._http.shutdown()
        self._http.server_close()

    def serve(self, handler: BaseHTTPRequestHandler) -> None:
        """Answers one request."""
        body = handler.rfile.read(int(handler.headers.get("content-length", 0)))
        with self._lock:
            number = len(self.requests)
            self.requests.append(json.loads(body))
            self.headers.append({k.lower(): v for k, v in handler.headers.items()})
            self._at_once += 1
            self.most_at_once = max(self.most_at_once, self._at_once)
        try:
            self._say(handler, self.script(self.requests[number], number))
        except OSError:
            handler.close_connection = True  # The client has gone away.
        finally:
            with self._lock:
                self._at_once -= 1

    def _say(self, handler: BaseHTTPRequestHandler, said: Said) -> None:
        if said.delay and self.closing.wait(said.delay):
            handler.close_connection = True
            return
        body = said.body.encode()
        handler.send_response(said.status)
        headers = {"content-type": "application/json", **said.headers}
        for name, value in headers.items():
            handler.send_header(name, value)
        handler.send_header("content-length", str(len(body)))
        handler.end_headers()
        for byte in body if said.drip else ():
            handler.wfile.write(bytes([byte]))
            handler.wfile.flush()
            if self.closing.wait(said.drip):
                break
        if not said.drip:
            handler.wfile.write(body[: said.cut])
        if said.cut is not None:
            handler.close_connection = True
