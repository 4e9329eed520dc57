"""Completion in JSON: keys and words that the schema allows, and names that the task declares."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any

from irc.diagnostics.source import Pointer
from irc.lsp.lenient_json import JsonCursor, read_leniently
from irc.lsp.mentions import Kind, mentions
from irc.lsp.suggestions import MOST_OFFERED, Suggestion

_NAMED = {
    **dict.fromkeys(("before", "after", "predecessor", "successor", "action"), Kind.ACTION),
    "resource": Kind.RESOURCE,
    "var": Kind.VARIABLE,
    "group": Kind.GROUP,
}
"""The kind of the name in the value of a key, wherever the key stands."""

_LISTED = {"one_of": Kind.RESOURCE, "goals": Kind.ACTION}
"""The kind of the names in the array of a key."""

_ALIASES = {"dependencies": "precedence"}


def complete_json(text: str, offset: int) -> list[Suggestion]:
    """The suggestions at a place of a text, which may be unfinished."""
    document, cursor = read_leniently(text, offset)
    offered: dict[str, Suggestion] = {}
    for label, kind in _offered(document, cursor):
        written = json.dumps(label, ensure_ascii=False)
        if cursor.key and not text[cursor.end :].lstrip(" \t").startswith(":"):
            offered.setdefault(label, _suggestion(cursor, label, f"{written}: ", kind, written))
        else:
            offered.setdefault(label, _suggestion(cursor, label, written, kind, written))
        if len(offered) >= MOST_OFFERED:
            break
    return list(offered.values())


def _suggestion(cursor: JsonCursor, label: str, text: str, kind: str, typed: str) -> Suggestion:
    return Suggestion(label, cursor.start, cursor.end, text, kind, typed)


def _offered(document: Mapping[str, Any], cursor: JsonCursor) -> Iterator[tuple[str, str]]:
    """The (text, kind) pairs that can stand at the cursor."""
    if cursor.key:
        for node in _nodes(cursor.path):
            for key in node.get("properties", {}):
                if key not in cursor.siblings:
                    yield key, "field"
        return
    if not cursor.path:
        return
    yield from _names(document, cursor)
    for node in _nodes(cursor.path):
        for word in (*node.get("enum", ()), *([node["const"]] if "const" in node else ())):
            if isinstance(word, str):
                yield word, "word"


def _names(document: Mapping[str, Any], cursor: JsonCursor) -> Iterator[tuple[str, str]]:
    kind, owner = _kind(cursor)
    if kind is None:
        return
    here = cursor.path
    for mention in mentions(document):
        if (
            mention.declares
            and mention.kind is kind
            and (kind is not Kind.VALUE or mention.owner == owner)
            and mention.pointer != here
        ):
            yield mention.name, kind.value


def _kind(cursor: JsonCursor) -> tuple[Kind | None, str | None]:
    """(the kind of name at the cursor, for a value also its state variable)."""
    path = cursor.path
    last = path[-1]
    keys = [part for part in path if isinstance(part, str)]
    if isinstance(last, str):
        if last in ("value", "initial"):
            said = cursor.siblings.get("var" if last == "value" else "id")
            return Kind.VALUE, said if isinstance(said, str) else None
        return _NAMED.get(last), None
    if not keys:
        return None, None
    inside = keys[-1]
    if inside in ("precedence", "dependencies") and isinstance(path[-2], int):
        return Kind.ACTION, None
    if inside == "actions" and cursor.siblings.get("op") != "add_actions" and len(path) > 2:
        return Kind.ACTION, None
    if inside == "groups" and cursor.siblings.get("op") == "cancel_groups":
        return Kind.GROUP, None
    return _LISTED.get(inside), None


@cache
def _schema() -> dict[str, Any]:
    from irc.model import Task

    return Task.model_json_schema(by_alias=True)


def _nodes(path: Pointer) -> list[dict[str, Any]]:
    """Every schema that applies to the value at a path."""
    nodes = list(_spread([_schema()]))
    for part in path:
        nodes = list(_spread(_inside(nodes, part)))
    return nodes


def _inside(nodes: list[dict[str, Any]], part: str | int) -> Iterator[Any]:
    for node in nodes:
        if isinstance(part, str):
            yield node.get("properties", {}).get(_ALIASES.get(part, part))
        else:
            yield node.get("items")


def _spread(nodes: Any) -> Iterator[dict[str, Any]]:
    """The schemas after following references and splitting alternatives."""
    waiting, seen = list(nodes), set()
    while waiting:
        node = waiting.pop(0)
        if not isinstance(node, dict) or id(node) in seen:
            continue
        seen.add(id(node))
        if "$ref" in node:
            waiting.append(_schema()["$defs"][node["$ref"].rsplit("/", 1)[-1]])
        for several in ("anyOf", "oneOf", "allOf"):
            waiting += node.get(several, ())
        yield node
