"""An append-only journal: accepted requests are on disk before they are acknowledged.

A text file of JSON lines (`irc.service.journal_lines`). The first line names the task and the first
schedule, each further line is a request that was accepted, or a snapshot: the whole state after the
requests before it. A restart begins at the last snapshot. Damage is reported and never replayed.
Only the last line can be torn, by a crash while it was written: it was not acknowledged, so it is
dropped. Damage before a snapshot that can be read is reported, and loses nothing.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import IO, Any

from irc._version import __version__
from irc.diagnostics import Code, Diagnostic, InputError, Report
from irc.diagnostics.source import Source
from irc.errors import IrcError
from irc.frontends.json.value import read_value
from irc.outcome import MISUSED
from irc.service.journal_lines import SNAPSHOT, Contents, is_begun, read_lines, to_line

JOURNAL_VERSION = "2"
READ_VERSIONS = ("1", "2")

MAX_JOURNAL = 4 * 1024 * 1024 * 1024
"""Bytes; a larger file is refused before it is read."""

COMPACT_ABOVE = 16 * 1024 * 1024
"""Bytes from which on a journal is shortened to its last two snapshots and what follows."""


class JournalError(IrcError):
    """The journal cannot be opened or written; the message says which and why."""

    ends_as = MISUSED


@dataclass(frozen=True)
class Start:
    """A place from which a journal can be replayed: a snapshot, or None for the beginning.

    `requests` are the entries that follow, as JSON texts with their line numbers.
    """

    snapshot: str | None
    requests: tuple[tuple[int, str], ...]


@dataclass(frozen=True)
class Recovered:
    """The contents of a journal: its header, its sound lines, and notes."""

    header: dict[str, Any]
    contents: Contents
    notes: tuple[Diagnostic, ...] = ()

    @property
    def entries(self) -> tuple[str, ...]:
        """The requests that the file still has, as JSON texts."""
        return tuple(line.text for line in self.contents.lines[1:] if not line.is_snapshot)

    def starts(self) -> Iterator[Start]:
        """The places from which all that follows is there, the last one first."""
        lines = self.contents.lines
        for k in self.contents.starts():
            later = ((line.number, line.text) for line in lines[k + 1 :] if not line.is_snapshot)
            yield Start(lines[k].text if k else None, tuple(later))


class Journal:
    """A journal that only this process writes. Close it, or use it in a `with` statement."""

    def __init__(self, path: Path, file: IO[bytes]) -> None:
        self._path, self._file = path, file
        self._lines = 0
        self._header = b""
        self._snapshot: int | None = None
        """Where the last snapshot begins."""

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
        try:
            self._write(to_line(self._lines, entry.encode()))
        except OSError as error:
            self._file.close()
            raise _failed("write", self._path, error, _GO_ON) from None
        self._lines += 1

    def begin(self, header: dict[str, Any]) -> None:
        """Writes the first line of a new journal."""
        document = {"irc_journal": JOURNAL_VERSION, "irc": __version__, **header}
        entry = json.dumps(document, ensure_ascii=False, allow_nan=False)
        self.append(entry)
        self._header = to_line(0, entry.encode())
        _sync_folder(self._path)

    def save(self, snapshot: str) -> None:
        """Writes a snapshot, a JSON text on one line, from which a restart can begin.

        A long journal then loses the part in front of its previous snapshot. Raises `OSError` where
        there is no room: the journal is as before, and can be written.
        """
        begin, before = self._file.seek(0, os.SEEK_END), self._snapshot
        self._write(to_line(self._lines, SNAPSHOT + snapshot.encode() + b"}"))
        self._lines += 1
        self._snapshot = begin
        if before is not None and begin > COMPACT_ABOVE and before > begin // 2:
            self._drop_before(before)

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
        """Takes the file for this process. Raises `JournalError` where another one has it."""
        try:
            _lock(self._file)
            own, there = os.fstat(self._file.fileno()), os.stat(self._path)
        except (BlockingIOError, FileNotFoundError):
            pass
        else:
            # Another process may have shortened the journal, which makes a new file of it.
            if (own.st_dev, own.st_ino) == (there.st_dev, there.st_ino):
                return
        raise JournalError(
            f"the journal {str(self._path)!r} is in use by another process: "
            "end that process first, or name another journal"
        )

    def _write(self, line: bytes) -> None:
        """Appends a line. Raises `OSError`; what was written of it is then taken back."""
        end = self._file.seek(0, os.SEEK_END)
        try:
            written = 0
            while written < len(line):
                written += self._file.write(line[written:])
            os.fsync(self._file.fileno())
        except OSError:
            with suppress(OSError):  # If this fails, the rest of the line is dropped as torn.
                self._file.truncate(end)
            raise

    def _drop_before(self, offset: int) -> None:
        """Replaces the file by its first line and what it has from `offset` on. Raises `OSError`.

        A crash leaves the file as it was or as it is then.
        """
        self._file.seek(offset)
        rest = _read_all(self._file)
        whole = Path(os.path.realpath(self._path))
        short = whole.with_name(whole.name + ".new")
        handle = os.open(short, os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0), 0o600)
        with os.fdopen(handle, "r+b", buffering=0) as file:
            try:
                file.truncate(0)
                for part in (self._header, rest):
                    while part:
                        part = part[file.write(part) :]
                _lock(file)
                os.chmod(short, os.fstat(self._file.fileno()).st_mode & 0o7777)
                os.fsync(file.fileno())
                os.replace(short, whole)
            except OSError:
                with suppress(OSError):
                    short.unlink()
                raise
            kept = os.fdopen(os.dup(file.fileno()), "r+b", buffering=0)
        self._file.close()
        self._file = kept
        self._snapshot = (self._snapshot or 0) - offset + len(self._header)
        _sync_folder(whole)

    def _recover(self) -> Recovered | None:
        size = os.fstat(self._file.fileno()).st_size
        if size > MAX_JOURNAL:
            raise JournalError(
                f"the journal {str(self._path)!r} has {size:,} bytes; "
                f"at most {MAX_JOURNAL:,} are read"
            )
        data, name = _read_all(self._file), str(self._path)
        found = read_lines(data)
        if not found.lines and not is_begun(data):
            raise _not_a_journal(data, name)
        header = _header(found, data, name)
        notes = () if header is None else _require_whole(found, header, data, name)
        if found.kept < len(data):
            notes = (*notes, _torn(data, found, name))
            self._file.truncate(found.kept)
            os.fsync(self._file.fileno())
        if header is None:
            return None
        self._lines = found.lines[-1].seq + 1
        self._header = data[: data.index(b"\n") + 1]
        snapshots = [line.offset for line in found.lines if line.is_snapshot]
        self._snapshot = snapshots[-1] if snapshots else None
        return Recovered(header, found, notes)


_GO_ON = "make room or mend the access, and start again: all that was acknowledged is in it"


def _lock(file: IO[bytes]) -> None:
    """Locks a file for this process. Raises `BlockingIOError` where another one has it."""
    try:
        import fcntl
    except ImportError:  # Windows, whose own locks would prevent reading.
        return
    fcntl.flock(file.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)


def _read_all(file: IO[bytes]) -> bytes:
    """The rest of an unbuffered file."""
    parts = []
    while more := file.read(16 * 1024 * 1024):
        parts.append(more)
    return b"".join(parts)


def _header(found: Contents, data: bytes, name: str) -> dict[str, Any] | None:
    """The first entry, None for a new journal. Raises `InputError` where it cannot be read."""
    if not found.lines and not found.damage:
        return None
    if not found.lines or found.lines[0].seq != 0:
        raise _damaged(found, data, name)
    header, _ = read_value(found.lines[0].text, name)
    _require_version(header, data, name)
    return dict(header)


def _require_whole(
    found: Contents, header: dict[str, Any], data: bytes, name: str
) -> tuple[Diagnostic, ...]:
    """Notes on damage that a later snapshot makes up for. Raises `InputError` for any other."""
    if not found.damage:
        return ()
    if not found.starts():
        raise _damaged(found, data, name)
    first, others = found.damage[0], len(found.damage) - 1
    more = f"; {others} more {'place is' if others == 1 else 'places are'} damaged" * bool(others)
    note = Diagnostic(
        Code.MENDED_JOURNAL,
        f"line {first.number} of the journal is damaged: {first.reason}{more}",
        hint="nothing is lost: the execution continues from a later snapshot",
        offset=len(data[: first.offset].decode("utf-8", "replace")),
        line=first.number,
        column=1,
        within=_source(name, data),
    )
    return (note,)


def _source(name: str, data: bytes) -> Source:
    return Source(name, data.decode("utf-8", "replace"))


def _not_a_journal(data: bytes, name: str) -> InputError:
    finding = Diagnostic(
        Code.BAD_JOURNAL,
        "this file is not a journal of `irc run`",
        hint="name a new file, or the journal of an earlier run",
        offset=0,
    )
    return InputError(Report((finding,), _source(name, data)))


def _damaged(found: Contents, data: bytes, name: str) -> InputError:
    """The error for damage behind which nothing can be replayed."""
    damage = found.in_the_way()
    finding = Diagnostic(
        Code.BAD_JOURNAL,
        f"line {damage.number} of the journal is damaged: {damage.reason}",
        hint="the lines from there on are not usable; keep the file, and restore it from a "
        "copy, or start again with another journal",
        offset=len(data[: damage.offset].decode("utf-8", "replace")),
    )
    return InputError(Report((finding,), _source(name, data)))


def _torn(data: bytes, found: Contents, name: str) -> Diagnostic:
    number = data.count(b"\n", 0, found.kept) + 1
    return Diagnostic(
        Code.TORN_JOURNAL,
        f"line {number}, the last of the journal, was cut off and has been dropped",
        hint="no action is needed: it was never acknowledged; send that request again",
        offset=len(data[: found.kept].decode("utf-8", "replace")),
        line=number,
        column=1,
        within=_source(name, data),
    )


def _require_version(header: Any, data: bytes, name: str) -> None:
    version = header.get("irc_journal") if isinstance(header, dict) else None
    if version in READ_VERSIONS:
        return
    finding = Diagnostic(
        Code.JOURNAL_VERSION,
        f"unknown version of a journal, {version!r}; expected {JOURNAL_VERSION!r}",
        hint="continue it with the version of irc that wrote it",
        offset=0,
    )
    raise InputError(Report((finding,), _source(name, data)))


def _failed(what: str, path: Path, error: OSError | ValueError, remedy: str = "") -> JournalError:
    reason = getattr(error, "strerror", None) or error
    hint = f"; {remedy}" if remedy else ""
    return JournalError(f"cannot {what} the journal {str(path)!r}: {reason}{hint}")


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
