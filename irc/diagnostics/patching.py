"""Certain repairs: as JSON patches (RFC 6902), and as edits of the text that keep its layout.

The paths of all fixes of a report are those of the document before any of them. Applied from the
end of the document to its start, no fix moves the target of another one. `apply_patches` does so on
a decoded document, `apply_fixes` on the text itself.
"""

from __future__ import annotations

import copy
import json
import re
from collections.abc import Iterable
from dataclasses import replace
from typing import Any, NamedTuple

from irc.diagnostics.finding import Diagnostic
from irc.diagnostics.fix import Fix, Operation, _order
from irc.diagnostics.source import Pointer, Range, Source

_BLANK = " \t\r\n"
_KEY = re.compile(r'"(?:[^"\\]++|\\.)*+"')


def as_written(fix: Fix, source: Source) -> Fix:
    """A fix with the paths of the text; empty if JSON patches do not apply to the text."""
    operations = []
    for operation in fix:
        written = _written(operation.target, source)
        if written is None:
            return ()
        if operation.origin is None:
            operations.append(replace(operation, path=written))
        else:
            path = (*written[:-1], operation.path[-1])
            operations.append(replace(operation, path=path, origin=written))
    return tuple(operations)


def _written(pointer: Pointer, source: Source) -> Pointer | None:
    place = source.locate([pointer]).get(pointer)
    if place is None or place.written is None or len(place.written) != len(pointer):
        return None
    return place.written


def operations_of(diagnostics: Iterable[Diagnostic]) -> list[Operation]:
    """All operations of some diagnostics, each once, last place first.

    Operations inside an element that another operation removes are left out.
    """
    by_target = {o.target: o for d in diagnostics for o in d.fix if o.op != "remove"}
    by_target |= {o.target: o for d in diagnostics for o in d.fix if o.op == "remove"}
    gone = {target for target, o in by_target.items() if o.op == "remove"}
    kept = [
        o
        for target, o in by_target.items()
        if not any(target[:n] in gone for n in range(len(target)))
    ]
    return sorted(kept, key=lambda o: _order(o.target), reverse=True)


def apply_patches(document: Any, diagnostics: Iterable[Diagnostic]) -> Any:
    """A copy of a decoded document with every fix applied."""
    patched = copy.deepcopy(document)
    for operation in operations_of(diagnostics):
        *parents, last = operation.target
        parent = patched
        for part in parents:
            parent = parent[part]
        if operation.op == "replace":
            parent[last] = operation.value
        else:
            value = parent.pop(last)
            if operation.op == "move":
                parent[operation.path[-1]] = value
    return patched


class TextEdit(NamedTuple):
    """An edit: `text` replaces [start, end) of a text."""

    start: int
    end: int
    text: str


def text_edits(diagnostics: Iterable[Diagnostic], source: Source) -> list[TextEdit]:
    """The fixes as edits that do not touch each other, in the order of the text.

    The diagnostics are those of `source`, located: their paths are as the text writes them.
    """
    operations = operations_of(diagnostics)
    places = source.locate([o.target for o in operations])
    edits, going = [], []
    for operation in operations:
        place = places.get(operation.target)
        if place is None or place.written != operation.target:
            continue
        if operation.op == "remove":
            start = place.start if place.key_start is None else place.key_start
            going.append(Range(start, place.end))
        elif operation.op == "replace":
            edits.append(TextEdit(place.start, place.end, _json(operation.value)))
        elif place.key_start is not None and (key := _KEY.match(source.text, place.key_start)):
            edits.append(TextEdit(key.start(), key.end(), _json(operation.path[-1])))
    return sorted([*edits, *_removals(source.text, going)])


def _json(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False)


def _removals(text: str, elements: list[Range]) -> list[TextEdit]:
    """Edits that remove elements of arrays and objects, each with one of the commas beside it."""
    edits = []
    tails: dict[int, int] = {}  # Removed elements at the end of a list: start → end of the last.
    for element in sorted(elements, key=lambda r: r.start, reverse=True):
        after = _skip(text, element.end)
        if not text.startswith(",", after):
            tails[element.start] = element.end
            continue
        following = _skip(text, after + 1)
        if following in tails:
            tails[element.start] = tails.pop(following)
        else:
            edits.append(TextEdit(element.start, following, ""))
    for start, end in tails.items():
        before = _skip_back(text, start)
        comma = before > 0 and text[before - 1] == ","
        edits.append(TextEdit(before - 1 if comma else start, end, ""))
    return edits


def _skip(text: str, at: int) -> int:
    while at < len(text) and text[at] in _BLANK:
        at += 1
    return at


def _skip_back(text: str, at: int) -> int:
    while at > 0 and text[at - 1] in _BLANK:
        at -= 1
    return at


def apply_fixes(diagnostics: Iterable[Diagnostic], source: Source) -> str:
    """The text with all fixes of its located diagnostics applied, and not changed elsewhere."""
    pieces, done = [], 0
    for edit in text_edits(diagnostics, source):
        pieces += [source.text[done : edit.start], edit.text]
        done = edit.end
    return "".join([*pieces, source.text[done:]])
