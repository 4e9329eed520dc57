"""Whether a journal belongs to a task: to this very one, to one before it changed, to another."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from irc.diagnostics import Code, Diagnostic, Findings, InputError, Report
from irc.diagnostics.listing import and_more
from irc.model import Task
from irc.model.canonical import canonical_task, task_sha256
from irc.model.from_document import to_task

MOST_LISTED = 3
"""Changes that a message lists."""


def require_task(task: Task, header: Mapping[str, Any]) -> None:
    """Raises `InputError` if the first entry of a journal names another task."""
    if header.get("task_sha256") == task_sha256(task):
        return
    before, name = _begun_with(header), header.get("task")
    if _same_subject(before, name, task):
        finding = Diagnostic(
            Code.CHANGED_TASK,
            f"the task has changed since the journal was begun{_changes(before, task)}",
            hint="undo the change and tell the running task of it by an event "
            '({"do": "apply", …}), or start another journal',
        )
    else:
        finding = Diagnostic(
            Code.OTHER_JOURNAL,
            f"the journal belongs to another task ({name or 'unnamed'}), "
            f"not to this one ({task.name or 'unnamed'})",
            hint="give the task that it was begun with, or name another journal",
        )
    raise InputError(Report((finding,)))


def _begun_with(header: Mapping[str, Any]) -> Task | None:
    """The task in a journal; None where there is none, as in those of version 1."""
    document = header.get("document")
    return to_task(document, Findings()) if isinstance(document, Mapping) else None


def _same_subject(before: Task | None, name: Any, now: Task) -> bool:
    """Whether two tasks have one name, or else most of their actions in common."""
    if name is not None or before is None:
        return name is not None and name == now.name
    first, second = ({action.id for action in task.actions} for task in (before, now))
    return 2 * len(first & second) > max(len(first), len(second))


def _changes(before: Task | None, now: Task) -> str:
    """The places where two tasks differ, in words."""
    if before is None:
        return ""
    found = list(_differences(canonical_task(before), canonical_task(now)))
    return f": {and_more(found[:MOST_LISTED], len(found))}" if found else ""


def _differences(before: Mapping[str, Any], now: Mapping[str, Any]) -> Iterator[str]:
    for key in sorted(before.keys() | now.keys()):
        if before.get(key) == now.get(key):
            continue
        first, second = _by_id(before.get(key, [])), _by_id(now.get(key, []))
        if first is None or second is None:
            yield f"'{key}'"
            continue
        for name in sorted(first.keys() | second.keys()):
            if first.get(name) != second.get(name):
                fate = " (gone)" * (name not in second) or " (new)" * (name not in first)
                yield f"{name!r} of '{key}'{fate}"


def _by_id(part: Any) -> dict[str, Any] | None:
    """The elements of a list by their id; None where they have none."""
    if not isinstance(part, list) or not all(isinstance(e, dict) and "id" in e for e in part):
        return None
    return {str(element["id"]): element for element in part}
