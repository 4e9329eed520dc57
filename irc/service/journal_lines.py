"""The lines of a journal: how they are written, and what of a file is sound, torn or damaged.

A line is `{"seq": N, "crc": C, "bytes": B, "entry": E}`: its number, the checksum of number and
entry, the entry's length, and the entry, a JSON text. Journals of version "1" have no length.

A crash can leave the last line torn: its end is missing, or blocks of it are still zeros. It was
not acknowledged, because a line is acknowledged only when all of it is on disk. A last line that
has its whole length and is wrong was written whole and altered since, so it is damage, like
everything that is wrong before it.
"""

from __future__ import annotations

import json
import re
import zlib
from dataclasses import dataclass, field

SNAPSHOT = b'{"snapshot": '
"""The first bytes of an entry that is a snapshot."""

BEGINNING = b'{"seq": 0, "crc": "'
"""The first bytes of a journal."""

BLOCK = 512
"""Bytes that a disk writes at once."""

_HEAD = rb'\{"seq": (\d{1,18}), "crc": "([0-9a-f]{8})"(?:, "bytes": (\d{1,18}))?, "entry": '
_LINE = re.compile(_HEAD + rb"(.*)\}", re.DOTALL)
_FRONT = re.compile(_HEAD)
_FRONT_PARTS = (
    (b'{"seq": ', re.compile(rb"\d*")),
    (b', "crc": "', re.compile(rb"[0-9a-f]*")),
    (b'", "bytes": ', re.compile(rb"\d*")),
    (b', "entry": ', re.compile(b"")),
)
_HOLE = re.compile(rb"\0+")


@dataclass(frozen=True, slots=True)
class Line:
    """A sound line: its place in the file (`number` from 1), its `seq`, its entry."""

    number: int
    offset: int
    seq: int
    entry: bytes

    @property
    def is_snapshot(self) -> bool:
        """Whether the entry is a snapshot, not a request."""
        return self.entry.startswith(SNAPSHOT)

    @property
    def text(self) -> str:
        """The entry as a JSON text."""
        return self.entry.decode()


@dataclass(frozen=True, slots=True)
class Damage:
    """A place where a journal is wrong, and why."""

    number: int
    offset: int
    reason: str


@dataclass
class Contents:
    """The contents of a journal file.

    From the line with index `unbroken` on to the end nothing is wrong or missing. What is behind
    the first `kept` bytes is a torn last line.
    """

    lines: list[Line] = field(default_factory=list)
    damage: list[Damage] = field(default_factory=list)
    unbroken: int = 0
    kept: int = 0
    doubtful: bool = False
    """Whether there was damage since the last line: it may have been one that is missing."""

    def starts(self) -> list[int]:
        """The indexes of lines from which all that follows is there, the last one first."""
        first = [0] if self.unbroken == 0 and self.lines else []
        later = range(len(self.lines) - 1, max(self.unbroken, 1) - 1, -1)
        return [k for k in later if self.lines[k].is_snapshot] + first

    def in_the_way(self) -> Damage:
        """The first damage behind the last snapshot that can be read."""
        behind = max((line.offset for line in self.lines if line.is_snapshot), default=-1)
        return next((d for d in self.damage if d.offset > behind), self.damage[-1])


def to_line(number: int, entry: bytes) -> bytes:
    """The line with an entry, and its line end."""
    checksum = zlib.crc32(entry, number)
    front = b'{"seq": %d, "crc": "%08x", "bytes": %d, "entry": ' % (number, checksum, len(entry))
    return front + entry + b"}\n"


def read_lines(data: bytes) -> Contents:
    """The contents of a journal file."""
    found = Contents()
    number = 0
    while found.kept < len(data):
        number += 1
        begin, end = found.kept, data.find(b"\n", found.kept)
        if end < 0 or (end == len(data) - 1 and _sound(data[begin:end]) is None):
            if is_torn(data[begin:], begin):
                break
            end = len(data) if end < 0 else end
        _take(found, number, begin, data[begin:end])
        found.kept = end + 1
    if found.doubtful:
        found.unbroken = len(found.lines)
    return found


def _take(found: Contents, number: int, offset: int, text: bytes) -> None:
    """Adds a complete line to the contents, or what is wrong with it."""
    sound = _sound(text)
    if sound is None:
        found.damage.append(Damage(number, offset, _reason(text)))
        found.doubtful = True
        return
    seq, entry = sound
    line = Line(number, offset, seq, entry)
    last = found.lines[-1].seq if found.lines else -1
    compacted = last == 0 and line.is_snapshot
    if found.lines and (seq, entry) == (last, found.lines[-1].entry):
        found.damage.append(Damage(number, offset, f"entry {seq} is there twice"))
        return
    if seq != last + 1:
        if not compacted and not found.doubtful:
            reason = f"it is entry {seq} where entry {last + 1} is expected"
            found.damage.append(Damage(number, offset, reason))
        found.unbroken = len(found.lines)
    if seq > last:
        found.lines.append(line)
        found.doubtful = False


def _sound(text: bytes) -> tuple[int, bytes] | None:
    """(the number, the entry) of a complete line whose checksum is right, else None."""
    match = _LINE.fullmatch(text)
    if match is None:
        return None
    seq, entry = int(match[1]), match[4]
    if int(match[2], 16) != zlib.crc32(entry, seq) or int(match[3] or len(entry)) != len(entry):
        return None
    try:
        entry.decode()
    except UnicodeDecodeError:
        return None
    return seq, entry


def is_torn(rest: bytes, offset: int) -> bool:
    """Whether the rest of a file, from `offset` on, is a line that was not written to its end."""
    line, end, more = rest.partition(b"\n")
    if more or _sound(line[:-1] + b"}" if end else line[:-1]):
        return False  # Only its last byte was altered.
    if _has_hole(rest, offset):
        return True
    front = _FRONT.match(line)
    if front is None:
        return not end or _is_cut_front(line)
    if front[3] is None:  # (version 1)
        return not end or _is_cut(line)
    missing = front.end() + int(front[3]) + 1 - len(line)
    return (missing > 0 and not (end and line.endswith(b"}"))) or (missing == 0 and not end)


def _has_hole(rest: bytes, offset: int) -> bool:
    """Whether whole blocks of a line are zeros, as file systems leave what was not written."""
    return any(
        (hole.start() == 0 or (offset + hole.start()) % BLOCK == 0)
        and (hole.end() == len(rest) or (offset + hole.end()) % BLOCK == 0)
        for hole in _HOLE.finditer(rest)
    )


def _is_cut_front(line: bytes) -> bool:
    """Whether a line is the beginning of the front of some line."""
    for text, value in _FRONT_PARTS:
        if not line.startswith(text):
            return text.startswith(line)
        found = value.match(line, len(text))
        line = line[found.end() if found else len(text) :]
    return not line


def _is_cut(line: bytes) -> bool:
    """Whether a line without a length has no end: no JSON value, and no closing brace."""
    try:
        json.loads(line)
    except (ValueError, RecursionError):
        return not line.endswith(b"}")
    return False


def _reason(text: bytes) -> str:
    if _LINE.fullmatch(text) is None:
        return "it is not an entry"
    return "its contents do not match its checksum"


def is_begun(data: bytes) -> bool:
    """Whether the first line is that of a journal, if perhaps torn: no other file is ever cut."""
    return data.startswith(BEGINNING) or BEGINNING.startswith(data)
