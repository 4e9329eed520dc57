"""Reads unfinished JSON as far as possible, whatever is missing or too much.

Only completion uses it. It is iterative and reads each character once.
"""

from __future__ import annotations

import json
import re
from dataclasses import dataclass, field
from typing import Any

from irc.diagnostics.source import Pointer

_TOKEN = re.compile(
    r'(?P<text>"(?:[^"\\\r\n]|\\.)*+(?P<closed>")?)|(?P<mark>[{}\[\],:])|(?P<other>[^\s{}\[\],:"]+)'
)
_MOST_DEPTH = 64


@dataclass(frozen=True)
class JsonCursor:
    """The place of a cursor: the path of the value or the object that contains it.

    If a key is typed, `path` is that of its object and `key` is set. [start, end) is the text in
    quotes (or the bare word) around the cursor; without one, both are the cursor. `siblings` is
    the object around it, as far as it is written.
    """

    path: Pointer
    key: bool
    start: int
    end: int
    siblings: dict[str, Any]


@dataclass
class _Level:
    value: Any
    step: Any = None
    """The key or index of the next element."""
    behind_colon: bool = False


@dataclass
class _Reader:
    text: str
    cursor: int
    document: dict[str, Any] = field(default_factory=dict)
    levels: list[_Level] = field(default_factory=list)
    found: JsonCursor | None = None

    def run(self) -> None:
        end = 0
        for token in _TOKEN.finditer(self.text):
            if self.found is None and token.start() >= self.cursor:
                self._here(self.cursor, self.cursor)
            end = token.end()
            if token["mark"]:
                self._mark(token["mark"])
                continue
            closed = token["closed"] is not None
            inside = token.start() < self.cursor < end or (
                self.cursor == end and not (token["text"] and closed)
            )
            if self.found is None and inside:
                self._here(token.start(), end)
            self._scalar(_value(token))
            if len(self.levels) > _MOST_DEPTH:
                return
        if self.found is None:
            self._here(self.cursor, self.cursor)

    def _here(self, start: int, end: int) -> None:
        path = tuple(level.step for level in self.levels[:-1])
        if not self.levels:
            self.found = JsonCursor((), False, start, end, {})
            return
        level = self.levels[-1]
        if isinstance(level.value, list):
            outer = next((x.value for x in reversed(self.levels) if isinstance(x.value, dict)), {})
            self.found = JsonCursor((*path, len(level.value)), False, start, end, outer)
        elif level.behind_colon:
            self.found = JsonCursor((*path, level.step), False, start, end, level.value)
        else:
            self.found = JsonCursor(path, True, start, end, level.value)

    def _mark(self, mark: str) -> None:
        if mark in "{[":
            opened: Any = {} if mark == "{" else []
            if not self.levels and mark == "{" and not self.document:
                self.document = opened
            elif self.levels:
                self._put(opened, opening=True)
            self.levels.append(_Level(opened))
        elif mark in "}]":
            kind = dict if mark == "}" else list
            # Skip a bracket that closes nothing; one may close several levels.
            if any(isinstance(level.value, kind) for level in self.levels):
                while not isinstance(self.levels.pop().value, kind):
                    pass
            if self.levels:
                self.levels[-1].behind_colon = False
        elif self.levels:
            self.levels[-1].behind_colon = mark == ":"

    def _scalar(self, value: Any) -> None:
        if not self.levels:
            return
        level = self.levels[-1]
        if isinstance(level.value, dict) and not level.behind_colon:
            level.step = value if isinstance(value, str) else None
        else:
            self._put(value)

    def _put(self, value: Any, *, opening: bool = False) -> None:
        level = self.levels[-1]
        if isinstance(level.value, list):
            level.step = len(level.value)
            level.value.append(value)
        elif isinstance(level.step, str):
            level.value.setdefault(level.step, value)
            level.behind_colon = level.behind_colon and opening


def _value(token: re.Match[str]) -> Any:
    raw = token["text"]
    if raw is None:
        return {"true": True, "false": False, "null": None}.get(token["other"], 0)
    body = raw[1:-1] if token["closed"] else raw[1:]
    try:
        return json.loads(f'"{body}"')
    except ValueError:
        return body


def read_leniently(text: str, cursor: int) -> tuple[dict[str, Any], JsonCursor]:
    """(the first object of a text, as far as it is written, the place of the cursor in it)."""
    reader = _Reader(text, cursor)
    reader.run()
    return reader.document, reader.found or JsonCursor((), False, cursor, cursor, {})
