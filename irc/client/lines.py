"""Files of JSON lines that grow: each line is whole, also after a process was killed."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from irc.driver.files import WriteError


def read_lines(path: Path) -> Iterator[tuple[int, dict[str, Any]]]:
    """(number, object) of each line. A last line without its end was cut, and is left out.

    Raises `WriteError` where the file cannot be read, or a line is no object.
    """
    try:
        text = path.read_bytes().decode("utf-8")
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "it is no text in UTF-8"
        raise WriteError(f"cannot read {str(path)!r}: {reason}") from None
    for number, line in enumerate(text.split("\n")[:-1], 1):
        if not line.strip():
            continue
        try:
            found = json.loads(line)
        except (ValueError, RecursionError):
            found = None
        if not isinstance(found, dict):
            raise WriteError(f"{str(path)!r}, line {number}: expected a JSON object")
        yield number, found


class Lines:
    """A file to which lines are appended, each in one piece.

    `begins` is the text with which each line begins: a last line without its end is taken away
    only where it is the beginning of such a line, and not of another file.
    """

    def __init__(self, path: Path, begins: str) -> None:
        """Opens or makes the file, and takes away a last line that was cut. Raises `WriteError`."""
        self._path = path
        self._begins = begins.encode()
        try:
            self._file = os.open(path, os.O_RDWR | os.O_CREAT | os.O_APPEND, 0o666)
            self._take_away_a_cut_line()
        except OSError as error:
            raise self._failed(error) from None

    def _failed(self, error: OSError) -> WriteError:
        return WriteError(f"cannot write {str(self._path)!r}: {error.strerror or error}")

    def _take_away_a_cut_line(self) -> None:
        data = self._path.read_bytes()
        start = data.rfind(b"\n") + 1
        cut, begins = data[start:], self._begins
        if not (cut.startswith(begins) or begins.startswith(cut)):
            raise WriteError(
                f"cannot write {str(self._path)!r}: its last line is of something else"
            )
        if cut:
            os.ftruncate(self._file, start)

    def write(self, line: Mapping[str, Any]) -> None:
        """Appends an object. Raises `WriteError`."""
        data = (json.dumps(line, ensure_ascii=False) + "\n").encode("utf-8", "backslashreplace")
        try:
            while data:
                data = data[os.write(self._file, data) :]
        except OSError as error:
            raise self._failed(error) from None

    def close(self) -> None:
        """Closes the file."""
        os.close(self._file)
