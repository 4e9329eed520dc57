"""Reads the instances that a model is to answer: a JSON file, JSON lines, or a folder of files."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from irc.diagnostics import Code, Diagnostic, InputError, Report
from irc.frontends.json.value import read_line
from irc.methods import (
    Instance,
    NotAnInstance,
    kitchen_instance,
    running_instance,
    step_instance,
)

_READERS = {"question": step_instance, "items": kitchen_instance, "news": running_instance}
"""The field by which each kind of instance is known, and its reader."""

HINT = (
    "an instance is an object with `id` and `question`, a kitchen with `id` and `items`, or a "
    "running task with `id`, `news`, `task` and `now`; a file has one, a list, or one a line"
)


def read_instances(path: Path) -> list[Instance]:
    """The instances of a file or a folder, in order. Raises `InputError`."""
    if path.is_dir():
        files = sorted((*path.glob("*.json"), *path.glob("*.jsonl")))
        if not files:
            raise _unusable(path, "there is no file NAME.json or NAME.jsonl in this folder")
    else:
        files = [path]
    found: dict[str, Instance] = {}
    for file in files:
        for position, raw in enumerate(_values(file), 1):
            instance = _instance(file, position, raw)
            if instance.id in found:
                raise _unusable(file, f"there are two instances with id {instance.id!r}")
            found[instance.id] = instance
    if not found:
        raise _unusable(path, "there is no instance in it")
    return list(found.values())


def _values(file: Path) -> Iterator[Any]:
    try:
        text = file.read_text("utf-8")
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "it is no text in UTF-8"
        raise _unusable(file, reason) from None
    if file.suffix == ".jsonl":
        lines = [(n, line) for n, line in enumerate(text.splitlines(), 1) if line.strip()]
        yield from (_value(file, f"line {n}", line) for n, line in lines)
        return
    found = _value(file, "it", text)
    yield from found if isinstance(found, list) else [found]


def _value(file: Path, where: str, text: str) -> Any:
    try:
        return read_line(text)
    except ValueError as error:
        raise _unusable(file, f"{where} is no JSON: {error}") from None


def _instance(file: Path, position: int, raw: Any) -> Instance:
    name = f"instance {position}"
    if not isinstance(raw, dict):
        raise _unusable(file, f"{name} is no JSON object")
    if not isinstance(raw.get("id"), (str, int)) or isinstance(raw["id"], bool):
        raise _unusable(file, f"{name} has no 'id', a text or a number")
    kinds = [read for field, read in _READERS.items() if field in raw]
    if not kinds:
        fields = ", ".join(f"'{f}'" for f in _READERS)
        raise _unusable(file, f"{name} (id {raw['id']!r}) has none of the fields {fields}")
    try:
        return kinds[0](raw)
    except NotAnInstance as error:
        raise _unusable(file, f"{name} (id {raw['id']!r}): {error}") from None


def _unusable(path: Path, reason: str) -> InputError:
    return InputError(Report((Diagnostic(Code.UNREADABLE, f"{path}: {reason}", hint=HINT),)))
