"""Reads JSON text as the raw document, with every fault of the text located.

The text may be the answer of a language model: code fences and other text around the JSON are
ignored, with a note. There must be exactly one JSON object.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from decimal import Decimal, InvalidOperation
from itertools import product
from typing import TYPE_CHECKING, Any, NamedTuple

from irc.diagnostics import Code, Findings, InputError, Report
from irc.diagnostics.source import Pointer, Range, Source

if TYPE_CHECKING:
    from irc.frontends.json.scan import JsonFault

MAX_DEPTH = 64
"""Deeper nesting is refused: the IR itself needs eight levels."""

MAX_BYTES = 512 * 1024 * 1024
"""Larger inputs are refused before they need twice their memory."""

_LONGEST_SCANNED = 4_000_000
"""In longer texts a syntax error has the decoder's message, because the scanner takes seconds."""

_SCANNED_OF_LONG = 500_000
"""The part of a longer text that is scanned for other faults."""

_MAX_ATTEMPTS = 1000
# Compiled when first used, because most documents need none of them.
_BLANK = r"\s*"
_SURROGATE = r"\\u[dD][89a-fA-F]"
_FENCE = r"\s*(```+|~~~+)\s*[\w+-]*\s*\Z"


class RawDocument(NamedTuple):
    """The decoded JSON object, its text, and the notes on the text."""

    content: dict[str, Any]
    source: Source
    notes: Findings


class _Unacceptable(ValueError):
    """Raised by the fast decoder for faults that only the scanner can describe and locate."""


def _members(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    members = dict(pairs)
    if len(members) != len(pairs):
        raise _Unacceptable("duplicate key")
    return members


def _reject(constant: str) -> Any:
    raise _Unacceptable(constant)


def _decimal(text: str) -> Decimal:
    try:
        return Decimal(text)
    except InvalidOperation:
        raise _Unacceptable(text) from None


_DECODER = json.JSONDecoder(
    object_pairs_hook=_members, parse_float=_decimal, parse_constant=_reject
)


def decode_bytes(data: bytes, name: str) -> str:
    """The text of bytes in UTF-8, or in UTF-16 or UTF-32 with a byte-order mark.

    Raises `InputError` with the place of the first invalid byte.
    """
    if len(data) > MAX_BYTES:
        findings = Findings()
        findings.add(
            Code.TOO_LARGE,
            f"the input has {len(data):,} bytes; at most {MAX_BYTES:,} are read",
        )
        raise InputError(Report(tuple(findings.items)))
    encoding = "utf-8"
    if data.startswith((b"\xff\xfe\x00\x00", b"\x00\x00\xfe\xff")):
        encoding = "utf-32"
    elif data.startswith((b"\xff\xfe", b"\xfe\xff")):
        encoding = "utf-16"
    try:
        return data.decode(encoding)
    except UnicodeDecodeError as error:
        text = data.decode(encoding, "replace")
        offset = len(data[: error.start].decode(encoding, "replace"))
        findings = Findings()
        findings.add(
            Code.UNREADABLE,
            f"byte 0x{data[error.start]:02x} is not valid {encoding.upper()}",
            hint=_encoding_hint(data),
            offset=offset,
        )
        raise InputError(Report(tuple(findings.items), Source(name, text))) from None


_BINARY = (b"\x89PNG", b"\xff\xd8\xff", b"GIF8", b"PK\x03\x04", b"%PDF", b"\x1f\x8b", b"\x7fELF")


def _encoding_hint(data: bytes) -> str:
    if data.startswith(_BINARY) or b"\x00" in data[:1000]:
        return (
            "this does not look like a text file; a task is text: JSON, an .irc file or sentences"
        )
    return "save the file as UTF-8"


def read_document(text: str, name: str, *, mend: bool = False) -> RawDocument:
    """The one JSON object in `text`.

    With `mend`, a text in the notation of another language (comments, single quotes, a list of
    actions alone …) gives the object that is meant, with its faults among the notes. Raises
    `InputError` with every fault of the text: syntax, duplicate keys, NaN, nesting.
    """
    if not mend:
        return _read(text, name)
    if '"actions"' not in text:
        from irc.frontends.json.yaml_task import is_yaml, yaml_task

        if is_yaml(text, name):
            return RawDocument(*yaml_task(text, name))
    try:
        return _read(text, name)
    except InputError as error:
        mended = _mended(text, name, error.report)
        if mended is None:
            raise InputError(_without_edits(error.report)) from None
        return mended


def _read(text: str, name: str) -> RawDocument:
    findings = Findings()
    if text.startswith("\ufeff"):
        findings.add(
            Code.BYTE_ORDER_MARK,
            "a byte-order mark at the start is ignored",
            hint="no action is needed",
            offset=0,
        )
        text = text[1:]
    start = _skip_blank(text, 0)
    if text.startswith("{", start):
        try:
            content, end = _DECODER.raw_decode(text, start)
        except (ValueError, RecursionError):
            raise _faults(text, start, name, findings) from None
        found = [(start, end, content)] + _objects(text, end)[0]
    else:
        found, failed = _objects(text, start)
        if not any("actions" in f[2] for f in found):
            _require_no_list(text, start, name, findings)
        if found and not any("actions" in f[2] for f in found):
            _require_whole_task(text, failed, name, findings)
        if not found:
            raise _faults(text, failed[-1] if failed else start, name, findings)
    start, end, content = _only(found, text, name, findings)
    note_surroundings(text, start, end, findings)
    source = Source(name, text, _Locator(start))
    if _depth(content) > MAX_DEPTH or _has_surrogate(text, content):
        raise _faults(text, start, name, findings)
    return RawDocument(content, source, findings)


def _without_edits(report: Report) -> Report:
    """The report of a text that its edits alone do not make JSON, so none of them is certain."""
    from dataclasses import replace

    return Report(tuple(replace(d, edits=()) for d in report), report.source)


def _mended(text: str, name: str, report: Report) -> RawDocument | None:
    """The document that a text means whose faults all have edits; None where some have none."""
    from irc.frontends.json.mended import Mended

    edits = [edit for d in report.errors for edit in d.edits]
    if not edits or not all(d.edits for d in report.errors):
        return None
    mended = Mended.of(report.source.text if report.source else text, edits)
    try:
        document = _read(mended.text, name)
    except InputError:
        return None
    locator = document.source.locator
    if locator is None:
        return None
    source = Source(name, mended.original, mended.locator(locator))
    places = [d if d.offset is None else mended.placed(d) for d in document.notes.items]
    return RawDocument(document.content, source, Findings([*report.diagnostics, *places]))


def _require_whole_task(text: str, failed: list[int], name: str, findings: Findings) -> None:
    """Raises if the task itself is faulty, so that only its parts could be read."""
    key = text.find('"actions"')
    broken = [start for start in failed if start < key]
    if broken:
        raise _faults(text, broken[-1], name, findings)
    if key >= 0:
        findings.add(
            Code.SYNTAX,
            "this key is outside of any object",
            hint="put '{' before it",
            offset=key,
        )
        raise InputError(Report(tuple(findings.items), Source(name, text)))


_LIST = r"\[\s*\{"


def _require_no_list(text: str, start: int, name: str, findings: Findings) -> None:
    """Raises where a list of objects stands in the place of the task: its actions alone."""
    match = re.compile(_LIST).search(text, start)
    if match is None or "{" in text[start : match.start()] or '"actions"' in text[: match.start()]:
        return
    from irc.diagnostics.fix import TextEdit
    from irc.frontends.json.scan import scan

    begin = match.start()
    scanned = scan(text, begin, max_depth=MAX_DEPTH)
    if not scanned.faults:
        elements = _DECODER.raw_decode(text, begin)[0]
        if not all(isinstance(e, dict) and _OF_ACTIONS & e.keys() for e in elements):
            return
    findings.add(
        Code.WRONG_TYPE,
        "the task is a list; expected an object with 'actions'",
        offset=begin,
        hint='write {"actions": [ … ]}',
        edits=(TextEdit(begin, begin, '{"actions": '), TextEdit(scanned.end, scanned.end, "}")),
    )
    _add_faults(scanned.faults, findings)
    raise InputError(Report(tuple(findings.items), Source(name, text)))


_OF_ACTIONS = frozenset(("id", "name", "duration", "task", "action"))
"""Fields of which an action has at least one, in any format."""


def _skip_blank(text: str, at: int) -> int:
    match = re.compile(_BLANK).match(text, at)
    return match.end() if match else at


def decode_object(text: str, start: int) -> tuple[dict[str, Any], int] | JsonFault:
    """(the JSON object that begins at `start`, its end), or its first fault."""
    from irc.frontends.json.scan import scan

    try:
        content, end = _DECODER.raw_decode(text, start)
    except (ValueError, RecursionError):
        return scan(text, start, max_depth=MAX_DEPTH).faults[0]
    if _depth(content) > MAX_DEPTH or _has_surrogate(text, content):
        return scan(text, start, max_depth=MAX_DEPTH).faults[0]
    return content, end


def decode_list_or_object(text: str, start: int) -> tuple[Any, int] | list[JsonFault]:
    """(the JSON object or list that begins at `start` and ends the text, its end), or all faults.

    Text after the value is a fault, as are NaN, a number out of range, and half a character.
    """
    from irc.frontends.json.scan import JsonFault, scan

    decoded = decode_object(text, start)
    if not isinstance(decoded, tuple):
        return scan(text, start, max_depth=MAX_DEPTH).faults
    behind = _skip_blank(text, decoded[1])
    if behind < len(text):
        shown = text[behind : behind + 12].split("\n")[0]
        return [JsonFault(Code.SYNTAX, behind, f"there is more text after the JSON: {shown!r}")]
    return decoded


_SPELLINGS: Mapping[str | int, tuple[str | int, ...]] = {
    "precedence": ("dependencies",),
    "before": ("predecessor", 0),
    "after": ("successor", 1),
    "min_lag": ("lag",),
}
"""Other ways in which a document may write a step of a path (aliases, pairs)."""


@dataclass(frozen=True, slots=True)
class _Locator:
    """Finds the elements of the JSON value that begins at `start`."""

    start: int

    def __call__(self, text: str, wanted: frozenset[Pointer]) -> Mapping[Pointer, Range]:
        from irc.frontends.json.scan import scan

        meant: dict[Pointer, list[Pointer]] = {}
        for pointer in wanted:
            for spelled in product(*((part, *_SPELLINGS.get(part, ())) for part in pointer)):
                meant.setdefault(spelled, []).append(pointer)
        places = scan(text, self.start, meant.keys()).places
        return {
            pointer: place._replace(written=written)
            for written, place in places.items()
            for pointer in meant[written]
        }


def json_source(name: str, text: str, start: int = 0) -> Source:
    """The source of a text that has one JSON value from `start` on."""
    return Source(name, text, _Locator(start))


_Found = tuple[int, int, dict[str, Any]]


def _objects(text: str, at: int) -> tuple[list[_Found], list[int]]:
    """(all JSON objects from `at` on, the starts of faulty ones, each longer than the previous).

    It takes linear time: after a failure at some place, reading goes on from there.
    """
    found: list[_Found] = []
    failed: list[int] = []
    longest = 0
    for _ in range(_MAX_ATTEMPTS):
        at = text.find("{", at)
        if at < 0:
            break
        try:
            content, end = _DECODER.raw_decode(text, at)
        except json.JSONDecodeError as error:
            reached = max(error.pos, at + 1)
        except (ValueError, RecursionError):
            from irc.frontends.json.scan import scan

            reached = max(scan(text, at, max_depth=MAX_DEPTH).end, at + 1)
        else:
            if content:
                found.append((at, end, content))
            at = end
            continue
        if not failed or reached - at > longest:
            failed.append(at)
            longest = reached - at
        at = reached
    return found, failed


def _only(found: list[_Found], text: str, name: str, findings: Findings) -> _Found:
    tasks = [f for f in found if "actions" in f[2]] or found[:1]
    first = tasks[0]
    for other in tasks[1:]:
        if other[2] != first[2]:
            findings.add(
                Code.SYNTAX,
                "a second JSON document with other actions begins here",
                hint="keep exactly one task in the text",
                offset=other[0],
            )
            raise InputError(Report(tuple(findings.items), Source(name, text)))
    return first


def note_surroundings(text: str, start: int, end: int, findings: Findings) -> None:
    """Adds a note about text around the JSON, if there is any."""
    before, after = text[:start].strip(), text[end:].strip()
    if before or after:
        fenced = bool(re.search(_FENCE, text[:start]))
        what = "a code fence" if fenced else "other text"
        findings.add(
            Code.SURROUNDED,
            f"there is {what} around the JSON document; it is ignored",
            hint="no action is needed; only the JSON was read",
            offset=_skip_blank(text, 0) if before else _skip_blank(text, end),
        )


def _faults(text: str, start: int, name: str, findings: Findings) -> InputError:
    """The error with the scanner's faults of a text that the decoder did not accept."""
    from irc.frontends.json.scan import scan

    if not text[start:].strip():
        findings.add(
            Code.SYNTAX,
            "the input is empty",
            hint='expected a task such as {"actions": [{"id": "a", "duration": 3}]}',
            offset=max(0, len(text) - 1),
        )
    elif "{" not in text[start:]:
        findings.add(
            Code.SYNTAX,
            "there is no JSON object in the text",
            hint='expected a task such as {"actions": [{"id": "a", "duration": 3}]}',
            offset=start,
        )
    elif len(text) > _LONGEST_SCANNED and (error := _decoder_fault(text, start)):
        for found in scan(text[:_SCANNED_OF_LONG], start, max_depth=MAX_DEPTH).faults:
            if found.offset < _SCANNED_OF_LONG - 1000:  # Later faults come from the cut.
                findings.add(found.code, found.message, hint=found.hint, offset=found.offset)
        findings.add(Code.SYNTAX, f"not valid JSON: {error.msg}", offset=error.pos)
    else:
        faults = scan(text, start, max_depth=MAX_DEPTH).faults
        _add_faults(faults, findings)
        if not faults:
            findings.add(Code.SYNTAX, "the JSON document cannot be read", offset=start)
    return InputError(Report(tuple(findings.items), Source(name, text)))


def _add_faults(faults: Iterable[JsonFault], findings: Findings) -> None:
    """Adds faults of the text; notations of one kind that edits mend become one finding."""
    kinds: dict[object, list[JsonFault]] = {}
    for k, fault in enumerate(faults):
        kinds.setdefault(fault.hint if fault.edits else k, []).append(fault)
    for alike in kinds.values():
        first, more = alike[0], len(alike) - 1
        also = f" (likewise in {more} more place{'s' if more > 1 else ''})" if more else ""
        edits = tuple(edit for fault in alike for edit in fault.edits)
        findings.add(
            first.code, first.message + also, hint=first.hint, offset=first.offset, edits=edits
        )


def _decoder_fault(text: str, start: int) -> json.JSONDecodeError | None:
    """The first fault that the standard library finds, for texts that are too long to scan."""
    try:
        json.JSONDecoder().raw_decode(text, start)
    except json.JSONDecodeError as error:
        return error
    except (ValueError, RecursionError):
        return None
    return None


def _has_surrogate(text: str, content: Any) -> bool:
    """Whether some text contains half a character (a lone surrogate), which cannot be written."""
    if "\\u" not in text or not re.search(_SURROGATE, text):
        return False
    try:
        json.dumps(content, ensure_ascii=False, default=str).encode()
    except UnicodeEncodeError:
        return True
    return False


def _depth(content: Any) -> int:
    level, depth = [content], 0
    while level:
        depth += 1
        if depth > MAX_DEPTH:
            return depth
        level = [
            inner
            for outer in level
            for inner in (outer.values() if isinstance(outer, dict) else outer)
            if isinstance(inner, (dict, list))
        ]
    return depth
