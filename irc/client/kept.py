"""Requests whose replies are kept: their fingerprint, a cache on disk, recordings.

A fingerprint covers model, messages and settings. Address and key are no part of a request here,
so that neither is ever written.
"""

from __future__ import annotations

import hashlib
import json
import sqlite3
import threading
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from irc.client.completion import Completion, NoAnswer, completion_from_json
from irc.client.lines import Lines, read_lines
from irc.errors import IrcError
from irc.outcome import MISUSED

RECORDING_VERSION = "1"

Request = Mapping[str, Any]
"""`model`, `messages`, and the settings that were given."""


class StoreError(IrcError):
    """A cache or a recording that cannot be read or written; the text names the file."""

    ends_as = MISUSED


def fingerprint(request: Request, address: str = "") -> str:
    """The SHA-256 of a request; with an address, that of a request to it."""
    content = json.dumps([request, address], sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(content.encode("utf-8", "surrogatepass")).hexdigest()


# --- cache --------------------------------------------------------------------------------------


class Cache:
    """Replies on disk, by request and address, in SQLite: several processes may share the file."""

    VERSION = 1
    PATIENCE_SECONDS = 30.0

    def __init__(self, path: Path) -> None:
        """Opens or makes the file. Raises `StoreError`."""
        self._path = path
        self._lock = threading.Lock()
        try:
            self._file = sqlite3.connect(
                path, timeout=self.PATIENCE_SECONDS, check_same_thread=False, isolation_level=None
            )
            version = self._file.execute("PRAGMA user_version").fetchone()[0]
            if version not in (0, self.VERSION):
                raise StoreError(f"the cache {str(path)!r} is of another version of irc: {version}")
            self._file.execute("BEGIN IMMEDIATE")
            self._file.execute(
                "CREATE TABLE IF NOT EXISTS replies (request TEXT PRIMARY KEY, reply TEXT NOT NULL)"
            )
            self._file.execute(f"PRAGMA user_version = {self.VERSION}")
            self._file.execute("COMMIT")
        except sqlite3.Error as error:
            raise self._failed(error) from None

    def _failed(self, error: Exception) -> StoreError:
        return StoreError(f"cannot use the cache {str(self._path)!r}: {error}")

    def get(self, key: str) -> Completion | None:
        """The reply to a request; None where there is none. Raises `StoreError`."""
        try:
            with self._lock:
                asked = self._file.execute("SELECT reply FROM replies WHERE request = ?", (key,))
                found = asked.fetchone()
            return None if found is None else completion_from_json(json.loads(found[0]))
        except (sqlite3.Error, ValueError) as error:
            raise self._failed(error) from None

    def put(self, key: str, completion: Completion) -> None:
        """Keeps a reply; the first one that is kept stays. Raises `StoreError`."""
        reply = json.dumps(completion.as_json())
        try:
            with self._lock:
                self._file.execute("INSERT OR IGNORE INTO replies VALUES (?, ?)", (key, reply))
        except sqlite3.Error as error:
            raise self._failed(error) from None

    def close(self) -> None:
        """Closes the file."""
        with self._lock:
            self._file.close()


# --- recordings ---------------------------------------------------------------------------------


class Recorder:
    """Writes each request with its reply to a file of JSON lines, once; goes on with an old one."""

    def __init__(self, path: Path) -> None:
        """Raises `StoreError` where the file is no recording or cannot be written."""
        self._lock = threading.Lock()
        self._known = set(recorded(path)) if path.exists() else set()
        self._lines = Lines(path, '{"irc_recording"')

    def note(self, request: Request, completion: Completion) -> None:
        """Writes a request and its reply, unless they are there already."""
        key = fingerprint(request)
        line = {"irc_recording": RECORDING_VERSION, "sha256": key, "request": request}
        with self._lock:
            if key not in self._known:
                self._known.add(key)
                self._lines.write({**line, "reply": completion.as_json()})

    def close(self) -> None:
        """Closes the file."""
        self._lines.close()


Recorded = dict[str, tuple[Request, Completion]]


def recorded(path: Path) -> Recorded:
    """By fingerprint: the requests of a recording with their replies. Raises `StoreError`."""
    found: Recorded = {}
    for number, line in read_lines(path):
        request = line.get("request")
        try:
            if line.get("irc_recording") != RECORDING_VERSION or not isinstance(request, dict):
                raise ValueError("it has no 'irc_recording' of version 1 with a 'request'")
            found[fingerprint(request)] = request, completion_from_json(line.get("reply") or {})
        except ValueError as error:
            message = f"{str(path)!r} is no recording, line {number}: {error}"
            raise StoreError(message) from None
    return found


class NotRecorded(NoAnswer):
    """A request that the recording does not have; the text says which."""


class Replay:
    """The replies of a recording, in place of a model."""

    def __init__(self, path: Path) -> None:
        """Raises `StoreError`."""
        if not path.is_file():
            raise StoreError(f"there is no recording {str(path)!r}")
        self._path = path
        self._replies = recorded(path)

    def get(self, request: Request) -> Completion:
        """The recorded reply. Raises `NotRecorded`, which names the request."""
        found = self._replies.get(fingerprint(request))
        if found is not None:
            return found[1]
        raise NotRecorded(f"{str(self._path)!r} has no reply to {self._described(request)}")

    def _described(self, request: Request) -> str:
        """The request in words: its last message, and how it differs from those recorded."""
        others = [other for other, _ in self._replies.values()]
        named = f"the request that ends in {_tail(request)}"
        same_text = [o for o in others if o.get("messages") == request["messages"]]
        if same_text:
            fields = {*request, *same_text[0]} - {"messages"}
            other = sorted(f for f in fields if request.get(f) != same_text[0].get(f))
            is_, was = ({f: r.get(f) for f in other} for r in (request, same_text[0]))
            return f"{named}: it was recorded with {_fields(was)}, and this one has {_fields(is_)}"
        key = fingerprint(request)[:12]
        return f"{named} (message {len(request['messages'])}, sha256 {key}…)"


def _tail(request: Request) -> str:
    text = " ".join(str(request["messages"][-1]["content"]).split())
    return repr(text if len(text) <= 80 else f"…{text[-80:]}")


def _fields(values: Mapping[str, Any]) -> str:
    return ", ".join(
        f"no {name}" if value is None else f"{name} {value!r}" for name, value in values.items()
    )
