"""Writing files so that they appear whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

from irc.errors import IrcError


class WriteError(IrcError):
    """A file or folder that cannot be written; the text says which and why."""


def write_whole(path: Path, content: str | bytes, *, mode: int | None = None) -> None:
    """Writes beside the target and renames, so no reader ever sees half a file.

    `mode` are the permissions of the file; without it, those that a new one would have.
    """
    temporary: str | None = None
    try:
        handle, temporary = tempfile.mkstemp(prefix=f".{path.name[:50]}.", dir=path.parent)
        with os.fdopen(handle, "wb") as file:
            file.write(content.encode() if isinstance(content, str) else content)
        # mkstemp makes private files; a result has the permissions a new file would have.
        mask = os.umask(0)
        os.umask(mask)
        os.chmod(temporary, 0o666 & ~mask if mode is None else mode)
        os.replace(temporary, path)
        temporary = None
    except OSError as error:
        raise WriteError(f"cannot write {str(path)!r}: {error.strerror or error}") from None
    finally:  # also where we are interrupted
        if temporary is not None:
            with suppress(OSError):
                os.unlink(temporary)


def write_folder(folder: Path, files: Mapping[str, str]) -> None:
    """Writes several files into a folder, which is made if need be."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise WriteError(f"cannot make folder {str(folder)!r}: {error.strerror or error}") from None
    for name, text in files.items():
        write_whole(folder / name, text)
