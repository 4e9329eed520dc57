"""`include`: other files of the task's own folder, and nothing beyond it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath, PureWindowsPath

from irc.diagnostics import Code, InputError
from irc.diagnostics.source import Source
from irc.frontends.dsl.faults import Fault

Refuse = Callable[[str], Fault]
"""Makes the fault that is raised, at the place of the include."""

MAX_INCLUDES = 100
"""How many files one task may take in, each time counted."""

MAX_INCLUDED_BYTES = 16 * 1024 * 1024
"""How large all of them may be together."""


@dataclass(slots=True)
class Included:
    """An included text and where it was found."""

    source: Source
    path: Path


@dataclass(slots=True)
class Library:
    """Reads included files, each once, and remembers them: places are looked up later."""

    folder: Path | None
    """The folder of allowed includes; None if the text has none."""
    known: dict[tuple[Path | None, str], Included] = field(default_factory=dict)
    """The file that was found for a folder and a name."""
    kept: bool = False
    """Whether only known files are returned, because places belong to the text read before."""
    count: int = 0
    bytes: int = 0

    def open(self, name: str, beside: Path | None, start: int, end: int) -> Included:
        """The file `name`, relative to the file `beside` that includes it. Raises `Fault`."""

        def refuse(message: str, hint: str | None = None) -> Fault:
            return Fault(Code.DSL_INCLUDE, message, start, end, hint)

        if self.folder is None:
            raise refuse("a text that is not a file cannot include one", "save it beside the file")
        if not name or "\x00" in name:
            raise refuse("this is not the name of a file")
        if PurePosixPath(name).is_absolute() or PureWindowsPath(name).anchor:
            raise refuse(
                "an include must not be an absolute path", "name a file in the task's own folder"
            )
        self.count += 1
        if self.count > MAX_INCLUDES:
            raise refuse(f"more than {MAX_INCLUDES} includes")
        known = self.known.get((beside, name))
        if known is not None:
            return known
        if self.kept:
            raise refuse(f"{name!r} did not exist when the task was read")
        try:
            root = self.folder.resolve(strict=True)
            # Check this before looking for the file, so that no message reveals files outside.
            path = ((beside or root).joinpath(*PurePosixPath(name).parts)).resolve()
            if not path.is_relative_to(root):
                raise refuse(
                    f"{name!r} leads out of the task's folder",
                    "an included file must be in the folder of the task, or below it",
                )
            path = path.resolve(strict=True)
            if not path.is_file():
                raise refuse(f"{name!r} is not a file")
            found = Included(self._read(path, root, name, refuse), path)
        except (OSError, RuntimeError, ValueError) as error:
            reason = getattr(error, "strerror", None) or str(error)
            raise refuse(f"cannot read {name!r}: {reason}", self._near(name)) from None
        self.known[beside, name] = found
        return found

    def _read(self, path: Path, root: Path, name: str, refuse: Refuse) -> Source:
        from irc.frontends.json.document import decode_bytes

        with open(path, "rb") as file:
            data = file.read(MAX_INCLUDED_BYTES - self.bytes + 1)
        self.bytes += len(data)
        if self.bytes > MAX_INCLUDED_BYTES:
            raise refuse(f"the included files have more than {MAX_INCLUDED_BYTES:,} bytes together")
        shown = (self.folder or root) / path.relative_to(root)
        try:
            text = decode_bytes(data, shown.as_posix())
        except InputError as error:
            reason = error.report.diagnostics[0].message
            raise refuse(f"cannot read {name!r}: {reason}") from None
        return Source(shown.as_posix(), text.removeprefix("\ufeff"))

    def _near(self, name: str) -> str | None:
        from irc.diagnostics import did_you_mean

        if self.folder is None:
            return None
        try:
            known = sorted(p.name for p in self.folder.iterdir() if p.suffix == ".irc")[:1000]
        except OSError:
            return None
        return did_you_mean(name, known)
