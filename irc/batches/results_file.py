"""The file of a batch's results: JSON lines, whole lines or none, and one writer at a time.

A batch that was killed is resumed by its file: what has a result is not solved again. A last line
that the kill has torn is cut off.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Self

from irc.batches.result import BatchResult, read_result
from irc.batches.trial import TrialKey
from irc.driver.files import WriteError

_BEGINNING = b'{"irc_result": '


class ResultsFile:
    """A file to which results are appended, and the trials that have one."""

    def __init__(self, path: Path) -> None:
        """Opens the file, or makes it. Raises `WriteError` where it holds anything else."""
        self.path = path
        try:
            descriptor = os.open(path, os.O_RDWR | os.O_CREAT | getattr(os, "O_BINARY", 0), 0o666)
            self._file: IO[bytes] = os.fdopen(descriptor, "r+b", buffering=0)
        except OSError as error:
            raise self._refused(error.strerror or str(error)) from None
        try:
            self._lock()
            self.keys, self._size = self._known()
            self._file.truncate(self._size)
        except BaseException:
            self._file.close()
            raise

    def _refused(self, reason: str) -> WriteError:
        return WriteError(f"cannot write {str(self.path)!r}: {reason}")

    def _lock(self) -> None:
        try:
            import fcntl
        except ImportError:  # Windows, whose own locks would prevent reading.
            return
        try:
            fcntl.flock(self._file.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise self._refused("another batch is writing it") from None

    def _known(self) -> tuple[set[TrialKey], int]:
        """(the trials that have a result, the bytes of the whole lines)."""
        keys, size = set(), 0
        with open(self.path, "rb") as file:
            for number, line in enumerate(file, 1):
                if not line.endswith(b"\n") and _begun(line):
                    break
                try:
                    keys.add(read_result(line).key)
                except ValueError:
                    reason = f"line {number} is no result of a batch; name another file"
                    raise self._refused(reason) from None
                size += len(line)
        return keys, size

    def add(self, result: BatchResult) -> None:
        """Appends a line: all of it or nothing. Raises `WriteError`."""
        data = result.line().encode("utf-8", "backslashreplace")
        try:
            self._file.seek(self._size)
            rest = memoryview(data)
            while rest:
                rest = rest[self._file.write(rest) or 0 :]
        except OSError as error:
            self._file.truncate(self._size)
            raise self._refused(error.strerror or str(error)) from None
        except BaseException:
            self._file.truncate(self._size)
            raise
        self._size += len(data)
        self.keys.add(result.key)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._file.close()


def _begun(line: bytes) -> bool:
    """Whether a line without an end is the beginning of a result, or zeros of a crash."""
    return line.startswith(_BEGINNING[: len(line)]) or not line.strip(b"\0")


def read_results(path: Path) -> Iterator[BatchResult]:
    """The results of a file, in their order; a torn last line is left out.

    Raises `OSError`, and `ValueError` with the number of a line that is no result.
    """
    with open(path, "rb") as file:
        for number, line in enumerate(file, 1):
            if not line.endswith(b"\n") and _begun(line):
                return
            try:
                yield read_result(line)
            except ValueError as error:
                raise ValueError(f"line {number}: {error}") from None
