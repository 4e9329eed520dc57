"""Certain repairs: as JSON patches (RFC 6902), and as edits of the text that keep its layout.

The paths of all fixes of a report are those of the document before any of them. Applied from the
end of the document to its start, no fix moves the target of another one. `apply_patches` does so on
a decoded document, `apply_fixes` on the text itself.
"""

from __future__ import annotations

import copy
import json
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Any

from irc.diagnostics.finding import Diagnostic
from irc.diagnostics.fix import Fix, Operation, TextEdit, _order, plain
from irc.diagnostics.source import Pointer, Range, Source

_BLANK = " \t\r\n"
_KEY = re.compile(r'"(?:[^"\\]++|\\.)*+"')


def as_written(fix: Fix, source: Source) -> Fix:
    """A fix with the paths of the text; empty if JSON patches do not apply to the text."""
    operations = []
    for operation in fix:
        if operation.op == "add":
            array = _written(operation.target, source) or operation.target
            operations.append(replace(operation, path=(*array, operation.path[-1])))
            continue
        written = _written(operation.target, source)
        if written is None:
            return ()
        if operation.origin is None:
            operations.append(replace(operation, path=written))
        else:
            path = (*written[:-1], operation.path[-1]) if operation.path else ()
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
    given = [o for d in diagnostics for o in d.fix]
    if (out := next((o for o in given if o.op == "move" and not o.path), None)) is not None:
        return [out]
    gone = {o.target for o in given if o.op == "remove"}
    by_target = {
        (o.target, o.op): o
        for o in given
        if o.op != "add" and (o.op == "remove" or o.target not in gone)
    }
    gone |= {o.target for o in given if o.op == "replace"}
    kept = [
        o
        for (target, _), o in by_target.items()
        if not any(target[:n] in gone for n in range(len(target)))
    ]
    kept.sort(key=lambda o: _order(o.target), reverse=True)
    return [*kept, *additions_of(given)]


def additions_of(operations: Iterable[Operation]) -> list[Operation]:
    """The operations that add to an array, each value once."""
    adding = {(o.path, _json(o.value)): o for o in operations if o.op == "add"}
    return list(adding.values())


def apply_patches(document: Any, diagnostics: Iterable[Diagnostic]) -> Any:
    """A copy of a decoded document with every fix applied."""
    patched = copy.deepcopy(document)
    for operation in operations_of(diagnostics):
        if operation.op == "add":
            patched.setdefault(operation.target[-1], []).append(operation.value)
            continue
        *parents, last = operation.target
        parent = patched
        for part in parents:
            parent = parent[part]
        if operation.op == "replace":
            parent[last] = operation.value
        else:
            value = parent.pop(last)
            if operation.op == "move" and not operation.path:
                return value
            if operation.op == "move":
                parent[operation.path[-1]] = value
    return patched


def text_edits(diagnostics: Iterable[Diagnostic], source: Source) -> list[TextEdit]:
    """The fixes as edits that do not touch each other, in the order of the text.

    The diagnostics are those of `source`, located: their paths are as the text writes them.
    """
    diagnostics = list(diagnostics)
    if of_text := sorted({edit for d in diagnostics for edit in d.edits}):
        return of_text  # Patches apply to the text that these make.
    operations = operations_of(diagnostics)
    places = source.locate([(), *(o.target for o in operations)])
    edits, going = [*_added(source, operations, places)], []
    for operation in operations:
        if operation.op == "add":
            continue
        place = places.get(operation.target)
        if place is None or place.written != operation.target:
            continue
        if operation.op == "remove":
            start = place.start if place.key_start is None else place.key_start
            going.append(Range(start, place.end))
        elif operation.op == "replace":
            edits.append(TextEdit(place.start, place.end, _json(operation.value)))
        elif not operation.path:
            whole = places.get(()) or place
            edits += [TextEdit(whole.start, place.start, ""), TextEdit(place.end, whole.end, "")]
        elif place.key_start is not None and (key := _KEY.match(source.text, place.key_start)):
            edits.append(TextEdit(key.start(), key.end(), _json(operation.path[-1])))
    return sorted([*edits, *_removals(source.text, going)])


def _added(
    source: Source, operations: list[Operation], places: Mapping[Pointer, Range | None]
) -> Iterator[TextEdit]:
    """Edits that append to arrays of the document, or write an array that is not there."""
    whole = places.get(())
    values: dict[Pointer, list[str]] = {}
    for operation in operations:
        if operation.op == "add":
            values.setdefault(operation.target, []).append(_json(operation.value))
    for array, written in values.items():
        place = places.get(array)
        renaming = next((o for o in operations if o.op == "move" and o.path == array), None)
        if renaming is not None:
            place = places.get(renaming.target)
        if place is not None and place.written in (array, renaming and renaming.target):
            yield _appended(source.text, place, ", ".join(written))
        elif whole is not None and whole.written == ():
            yield _appended(source.text, whole, f"{_json(array[-1])}: [{', '.join(written)}]")


def _appended(text: str, place: Range, written: str) -> TextEdit:
    """The edit that writes one element more before the closing bracket of a list or object."""
    last = _skip_back(text, place.end - 1)
    if text[last - 1] in "[{":
        return TextEdit(last, last, written)
    line = text[text.rfind("\n", 0, last) + 1 : last]
    apart = "\n" in text[last : place.end - 1]
    indent = line[: len(line) - len(line.lstrip())]
    return TextEdit(last, last, f",\n{indent}{written}" if apart else f", {written}")


def _json(value: Any) -> str:
    return json.dumps(plain(value), ensure_ascii=False)


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
