"""Writes files so that they appear whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

from irc.errors import IrcError
from irc.outcome import MISUSED


class WriteError(IrcError):
    """A file or folder that cannot be written; the message says which and why."""

    ends_as = MISUSED


def write_whole(path: Path, content: str | bytes, *, mode: int | None = None) -> None:
    """Writes a file beside `path` and renames it, so that no reader sees half a file.

    `mode` is the permissions of the file; the default is those of a new file.
    """
    temporary: str | None = None
    try:
        handle, temporary = tempfile.mkstemp(prefix=f".{path.name[:50]}.", dir=path.parent)
        with os.fdopen(handle, "wb") as file:
            file.write(content.encode() if isinstance(content, str) else content)
        # mkstemp makes private files; a result has the permissions of a new file.
        mask = os.umask(0)
        os.umask(mask)
        os.chmod(temporary, 0o666 & ~mask if mode is None else mode)
        os.replace(temporary, path)
        temporary = None
    except OSError as error:
        raise WriteError(f"cannot write {str(path)!r}: {error.strerror or error}") from None
    finally:  # also after an interrupt
        if temporary is not None:
            with suppress(OSError):
                os.unlink(temporary)


def write_folder(folder: Path, files: Mapping[str, str]) -> None:
    """Writes several files into a folder; makes the folder if necessary."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise WriteError(f"cannot make folder {str(folder)!r}: {error.strerror or error}") from None
    for name, text in files.items():
        write_whole(folder / name, text)
