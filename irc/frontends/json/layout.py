"""The standard layout of a JSON text: what fits is on one line, the rest is indented."""

from __future__ import annotations

import re
from collections.abc import Iterator

WIDEST = 100
_INDENT = "  "
_TOKEN = re.compile(r'[ \t\r\n]*("(?:[^"\\]|\\.)*"|[{}\[\],:]|[^\s{}\[\],:"]+)')

Node = str | tuple[str, list["Member"]]
Member = tuple[str, Node]
"""The key with its colon, or "", and the value; numbers and texts as they were written."""


def laid_out(text: str) -> str:
    """A valid JSON text, nested at most as deep as a task may be, in the standard layout."""
    return "".join(_lines(_node(_tokens(text)), "", 0, 0)) + "\n"


def _tokens(text: str) -> Iterator[str]:
    return (match[1] for match in _TOKEN.finditer(text))


def _node(tokens: Iterator[str]) -> Node:
    return _value(next(tokens), tokens)


def _value(first: str, tokens: Iterator[str]) -> Node:
    if first not in ("{", "["):
        return first
    closing = "}" if first == "{" else "]"
    members: list[Member] = []
    for token in tokens:
        if token == closing:
            break
        if token == ",":
            continue
        if first == "{":
            next(tokens)  # the colon
            members.append((f"{token}: ", _value(next(tokens), tokens)))
        else:
            members.append(("", _value(token, tokens)))
    return first, members


def _lines(node: Node, key: str, level: int, after: int) -> Iterator[str]:
    """The text of a member; `after` is the width of what follows on its last line."""
    if isinstance(node, str):
        yield key + node
        return
    opening, members = node
    closing = "}" if opening == "{" else "]"
    room = WIDEST - len(_INDENT) * level - len(key) - after
    short = _short(node, room) if level or not members else None
    if short is not None:
        yield key + short
        return
    yield f"{key}{opening}\n"
    for i, (inner, value) in enumerate(members):
        comma = "," if i + 1 < len(members) else ""
        yield _INDENT * (level + 1)
        yield from _lines(value, inner, level + 1, len(comma))
        yield f"{comma}\n"
    yield f"{_INDENT * level}{closing}"


def _short(node: Node, room: int) -> str | None:
    """The node on one line; None as soon as there is no room for it."""
    if isinstance(node, str):
        return node if len(node) <= room else None
    opening, members = node
    parts: list[str] = []
    room -= 2
    for key, value in members:
        text = _short(value, room - len(key))
        if text is None:
            return None
        parts.append(key + text)
        room -= len(parts[-1]) + 2
        if room < -2:
            return None
    return f"{opening}{', '.join(parts)}{'}' if opening == '{' else ']'}"
