"""A tiny client of the Language Server Protocol that starts `irc lsp`: to test and to measure."""

from __future__ import annotations

import json
import os
import queue
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

WAIT_SECONDS = 60.0

Message = dict[str, Any]


class Client:
    """A running server and what it has said."""

    def __init__(self, encodings: list[str] | None = None, **capabilities: Any) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-m", "irc", "lsp"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env={**os.environ, "PYTHONUTF8": "1"},
        )
        self.said: queue.Queue[Message | None] = queue.Queue()
        self.kept: list[Message] = []
        self.errors: list[bytes] = []
        self._id = 0
        self._versions: dict[str, int] = {}
        self._opened: set[str] = set()
        for target in (self._read, self._read_errors):
            threading.Thread(target=target, daemon=True).start()
        general = {} if encodings is None else {"positionEncodings": encodings}
        self.info = self.request(
            "initialize",
            {
                "processId": os.getpid(),
                "rootUri": None,
                "capabilities": {"general": general, **capabilities},
            },
        )
        self.notify("initialized", {})

    def __enter__(self) -> Client:
        return self

    def __exit__(self, *_exc: object) -> None:
        if self.process.poll() is None:
            self.process.kill()
        self.process.wait(WAIT_SECONDS)
        for stream in (self.process.stdin, self.process.stdout, self.process.stderr):
            assert stream is not None
            stream.close()

    # --- messages ---

    def send_raw(self, body: bytes) -> None:
        """One message as it stands, right or wrong."""
        assert self.process.stdin is not None
        self.process.stdin.write(b"Content-Length: %d\r\n\r\n" % len(body) + body)
        self.process.stdin.flush()

    def notify(self, method: str, params: Any) -> None:
        """A message that has no answer."""
        self.send_raw(json.dumps({"jsonrpc": "2.0", "method": method, "params": params}).encode())

    def post(self, method: str, params: Any) -> int:
        """A request; its answer is not waited for."""
        self._id += 1
        message = {"jsonrpc": "2.0", "id": self._id, "method": method, "params": params}
        self.send_raw(json.dumps(message).encode())
        return self._id

    def answer(self, id: int) -> Message:
        """The answer to a request."""
        return self.wait(lambda m: m.get("id") == id and "method" not in m)

    def request(self, method: str, params: Any) -> Any:
        """The result of a request; fails where the answer is an error."""
        found = self.answer(self.post(method, params))
        assert "error" not in found, found
        return found["result"]

    def wait(self, wanted: Any, seconds: float = WAIT_SECONDS) -> Message:
        """The first message that is wanted; those before it are kept for later."""
        for i, message in enumerate(self.kept):
            if wanted(message):
                return self.kept.pop(i)
        while True:
            next_ = self.said.get(timeout=seconds)
            if next_ is None:
                raise AssertionError(f"the server ended: {b''.join(self.errors).decode()}")
            if wanted(next_):
                return next_
            self.kept.append(next_)

    def _read(self) -> None:
        stream = self.process.stdout
        assert stream is not None
        while True:
            length = 0
            while (line := stream.readline()) not in (b"\r\n", b""):
                name, _, value = line.partition(b":")
                assert name.lower().startswith(b"content-"), line
                if name.lower() == b"content-length":
                    length = int(value)
            if not line:
                break
            self.said.put(json.loads(stream.read(length)))
        self.said.put(None)

    def _read_errors(self) -> None:
        assert self.process.stderr is not None
        for line in self.process.stderr:
            self.errors.append(line)

    # --- texts ---

    def open(self, uri: str, text: str, language: str = "irc") -> list[Message]:
        """Opens a text; the findings about it."""
        version = self._versions[uri] = self._versions.get(uri, 0) + 1
        self._opened.add(uri)
        document = {"uri": uri, "languageId": language, "version": version, "text": text}
        self.notify("textDocument/didOpen", {"textDocument": document})
        return self.findings(uri)

    def close_all(self) -> None:
        """Closes the texts that are open and forgets what was said of them.

        A version is given once only, so that nothing said late can be taken for something new.
        """
        for uri in self._opened:
            self.notify("textDocument/didClose", {"textDocument": {"uri": uri}})
        self._opened.clear()
        self.at("hover", "untitled:none", 0, 0)  # Answered when all that is above has been taken.
        self.kept.clear()

    def change(self, uri: str, *changes: Message) -> None:
        """Changes a text; the findings are not waited for."""
        self._versions[uri] += 1
        identifier = {"uri": uri, "version": self._versions[uri]}
        self.notify(
            "textDocument/didChange", {"textDocument": identifier, "contentChanges": changes}
        )

    def findings(self, uri: str) -> list[Message]:
        """What is published about the newest version of a text."""
        version = self._versions[uri]
        found = self.wait(
            lambda m: (
                m.get("method") == "textDocument/publishDiagnostics"
                and m["params"]["uri"] == uri
                and m["params"].get("version") == version
            )
        )
        return list(found["params"]["diagnostics"])

    def at(self, method: str, uri: str, line: int, character: int) -> Any:
        """The result of a request about a place."""
        place = {"line": line, "character": character}
        return self.request(
            f"textDocument/{method}", {"textDocument": {"uri": uri}, "position": place}
        )

    def about(self, method: str, uri: str, **more: Any) -> Any:
        """The result of a request about a text."""
        return self.request(f"textDocument/{method}", {"textDocument": {"uri": uri}, **more})


def uri_of(path: Path) -> str:
    """The URI of a file."""
    return path.absolute().as_uri()
