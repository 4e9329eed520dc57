"""An append-only journal: accepted requests are on disk before they are acknowledged.

A text file of JSON lines. The first line names the task and the first schedule, each further line
is an entry. Every line carries its number and a checksum, so that damage is reported and never
replayed. Only the last line can be torn, by a crash while it was written: it was not acknowledged,
so it is dropped.
"""

from __future__ import annotations

import json
import os
import re
import zlib
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import IO, Any

from irc.diagnostics import Code, Diagnostic, InputError, Report
from irc.diagnostics.source import Source
from irc.errors import IrcError
from irc.frontends.json.value import read_value

JOURNAL_VERSION = "1"

MAX_JOURNAL = 4 * 1024 * 1024 * 1024
"""Bytes; a larger file is refused before it is read."""

_LINE = re.compile(rb'\{"seq": (\d{1,18}), "crc": "([0-9a-f]{8})", "entry": (.*)\}', re.DOTALL)
_BEGINNING = b'{"seq": 0, "crc": "'


class JournalError(IrcError):
    """The journal cannot be opened or written; the message says which and why."""


@dataclass(frozen=True)
class Recovered:
    """The contents of a journal: its header, its entries as JSON texts, and notes."""

    header: dict[str, Any]
    entries: tuple[str, ...]
    notes: tuple[Diagnostic, ...] = ()


class Journal:
    """A journal that only this process writes. Close it, or use it in a `with` statement."""

    def __init__(self, path: Path, file: IO[bytes]) -> None:
        self._path, self._file = path, file
        self._lines = 0

    @classmethod
    def open(cls, path: Path) -> tuple[Journal, Recovered | None]:
        """(the journal at `path`, its contents or None for a new one).

        A torn last line is cut off. Raises `JournalError` if the file cannot be opened or another
        process has it, and `InputError` if it is not a journal or is damaged.
        """
        try:
            # Never truncate on opening: another process may use the file.
            handle = os.open(path, os.O_RDWR | os.O_CREAT | getattr(os, "O_BINARY", 0), 0o666)
            file = os.fdopen(handle, "r+b", buffering=0)
        except (OSError, ValueError) as error:
            raise _failed("open", path, error) from None
        journal = cls(path, file)
        try:
            journal._lock()
            return journal, journal._recover()
        except OSError as error:
            file.close()
            raise _failed("read", path, error) from None
        except BaseException:
            file.close()
            raise

    def append(self, entry: str) -> None:
        """Writes one entry, a JSON text on one line; it is on disk when this returns.

        After a `JournalError` no more entries can be appended: only opening the journal again
        shows how much of the failed write is on disk.
        """
        if self._file.closed:
            raise JournalError(f"the journal {str(self._path)!r} cannot be written any more")
        line = _line(self._lines, entry.encode())
        end = self._file.tell()
        try:
            written = 0
            while written < len(line):
                written += self._file.write(line[written:])
            os.fsync(self._file.fileno())
        except OSError as error:
            with suppress(OSError):  # If this fails, the rest of the line is dropped as torn.
                self._file.truncate(end)
            self._file.close()
            raise _failed("write", self._path, error) from None
        self._lines += 1

    def begin(self, header: dict[str, Any]) -> None:
        """Writes the first line of a new journal."""
        document = {"irc_journal": JOURNAL_VERSION, **header}
        self.append(json.dumps(document, ensure_ascii=False, allow_nan=False))
        _sync_folder(self._path)

    def close(self) -> None:
        """Closes the file, so that other processes can use the journal."""
        self._file.close()

    def __enter__(self) -> Journal:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        at: TracebackType | None,
    ) -> None:
        self.close()

    def _lock(self) -> None:
        try:
            import fcntl
        except ImportError:  # Windows, whose own locks would prevent reading.
            return
        try:
            fcntl.flock(self._file.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise JournalError(
                f"the journal {str(self._path)!r} is in use by another process: "
                "end that process first, or name another journal"
            ) from None

    def _recover(self) -> Recovered | None:
        size = os.fstat(self._file.fileno()).st_size
        if size > MAX_JOURNAL:
            raise JournalError(
                f"the journal {str(self._path)!r} has {size:,} bytes; "
                f"at most {MAX_JOURNAL:,} are read"
            )
        data = self._file.read(size) or b""
        while len(data) < size and (more := self._file.read(size - len(data))):
            data += more
        texts, kept = _sound_lines(data, str(self._path))
        notes: tuple[Diagnostic, ...] = ()
        if kept < len(data):
            notes = (_torn(data, kept, len(texts), str(self._path)),)
            self._file.truncate(kept)
            os.fsync(self._file.fileno())
        self._file.seek(kept)
        self._lines = len(texts)
        if not texts:
            return None
        header, _ = read_value(texts[0], str(self._path))
        _require_version(header, Source(str(self._path), data[:kept].decode()))
        return Recovered(header, tuple(texts[1:]), notes)


def _line(number: int, entry: bytes) -> bytes:
    checksum = zlib.crc32(entry, number)
    return b'{"seq": %d, "crc": "%08x", "entry": %s}\n' % (number, checksum, entry)


def _sound_lines(data: bytes, name: str) -> tuple[list[str], int]:
    """(the entries of a journal's sound lines, the number of bytes of these lines).

    The rest is a torn last line. Raises `InputError` for damage before it.
    """
    texts: list[str] = []
    kept = 0
    while kept < len(data):
        end = data.find(b"\n", kept)
        text = None if end < 0 else _entry(data[kept:end], len(texts))
        if text is None:
            if not _is_torn(data[kept:]) or (not texts and not _is_begun(data[kept:])):
                raise _damaged(data, kept, len(texts), name)
            break
        texts.append(text)
        kept = end + 1
    return texts, kept


def _entry(line: bytes, number: int) -> str | None:
    """The entry of a line that is complete and has this number, else None."""
    match = _LINE.fullmatch(line)
    if match is None or int(match[1]) != number:
        return None
    if int(match[2], 16) != zlib.crc32(match[3], number):
        return None
    try:
        return match[3].decode()
    except UnicodeDecodeError:
        return None


def _is_torn(rest: bytes) -> bool:
    """Whether the rest of a journal is a last line that was not written to its end.

    It has no line end, or a part before its line end is missing. A complete but wrong line was
    acknowledged, so it is damage.
    """
    if b"\n" not in rest:
        return True
    line, _, more = rest.partition(b"\n")
    try:
        json.loads(line)
    except (ValueError, RecursionError):
        return not more
    return False


def _is_begun(line: bytes) -> bool:
    """Whether a torn first line belongs to a journal, so that no other file is ever cut."""
    return line.startswith(_BEGINNING) or _BEGINNING.startswith(line)


def _damaged(data: bytes, at: int, number: int, name: str) -> InputError:
    text = data.decode("utf-8", "replace")
    offset = len(data[:at].decode("utf-8", "replace"))
    if number or _is_begun(data):
        message = f"line {number + 1} of the journal is damaged: {_reason(data[at:], number)}"
        hint = (
            "the lines from there on are not usable; keep the file, and restore it from a "
            "copy, or start again with another journal"
        )
    else:
        message = "this file is not a journal of `irc run`"
        hint = "name a new file, or the journal of an earlier run"
    finding = Diagnostic(Code.BAD_JOURNAL, message, hint=hint, offset=offset)
    return InputError(Report((finding,), Source(name, text)))


def _reason(rest: bytes, number: int) -> str:
    match = _LINE.fullmatch(rest[: rest.find(b"\n")])
    if match is None:
        return "it is not an entry"
    if int(match[1]) != number:
        return f"it is entry {int(match[1])} where entry {number} is expected"
    return "its contents do not match its checksum"


def _torn(data: bytes, at: int, number: int, name: str) -> Diagnostic:
    text = data.decode("utf-8", "replace")
    return Diagnostic(
        Code.TORN_JOURNAL,
        f"line {number + 1}, the last of the journal, was cut off and has been dropped",
        hint="no action is needed: it was never acknowledged; send that request again",
        offset=len(data[:at].decode("utf-8", "replace")),
        line=number + 1,
        column=1,
        within=Source(name, text),
    )


def _require_version(header: Any, source: Source) -> None:
    version = header.get("irc_journal") if isinstance(header, dict) else None
    if version == JOURNAL_VERSION:
        return
    finding = Diagnostic(
        Code.BAD_JOURNAL,
        f"unknown version of a journal, {version!r}; expected {JOURNAL_VERSION!r}",
        hint="continue it with the version of irc that wrote it",
        offset=0,
    )
    raise InputError(Report((finding,), source))


def _failed(what: str, path: Path, error: OSError | ValueError) -> JournalError:
    reason = getattr(error, "strerror", None) or error
    return JournalError(f"cannot {what} the journal {str(path)!r}: {reason}")


def _sync_folder(path: Path) -> None:
    """Writes the name of a new file to disk, if folders can be synced."""
    if os.name != "posix":
        return
    handle = os.open(path.parent, os.O_RDONLY)
    try:
        os.fsync(handle)
    except OSError:  # Some file systems cannot sync folders; the file itself is on disk.
        pass
    finally:
        os.close(handle)
