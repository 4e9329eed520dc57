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


def require_file(path: Path | None, suffixes: tuple[str, ...] = (".json",)) -> None:
    """Raises `WriteError` if a file of this name could not be written: before the work, not after.

    A name without a suffix, or with one of `suffixes`, will do.
    """
    if path is None:
        return
    if path.suffix and path.suffix.lower() not in suffixes:
        known = " or ".join(suffixes)
        raise WriteError(f"cannot write {str(path)!r}: its name must end in {known}")
    if path.exists() and not path.is_file():
        what = "it is a folder" if path.is_dir() else "it is no ordinary file"
        raise WriteError(f"cannot write {str(path)!r}: {what}")
    if not path.parent.is_dir():
        raise WriteError(f"cannot write {str(path)!r}: there is no folder {str(path.parent)!r}")
    if not os.access(path.parent, os.W_OK | os.X_OK):
        raise WriteError(f"cannot write {str(path)!r}: nothing may be written in its folder")


def require_folder(folder: Path | None) -> None:
    """Raises `WriteError` if no files could be written into a folder of this name."""
    if folder is None:
        return
    there = next((part for part in (folder, *folder.parents) if part.exists()), None)
    if there is None or not there.is_dir():
        raise WriteError(f"cannot make folder {str(folder)!r}: {str(there)!r} is no folder")
    if not os.access(there, os.W_OK | os.X_OK):
        raise WriteError(f"cannot make folder {str(folder)!r}: nothing may be written there")
