"""Checks the rest of a document that has faults of shape, so that one run has all findings.

The faulty elements are patched, so that the rest can be typed and checked. Findings about a patched
element, or because of it, are left out.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import Any

from irc.diagnostics import Code, Diagnostic, Findings
from irc.diagnostics.source import Pointer
from irc.model.from_document import to_task

_ROUNDS = 3
"""Limit on rounds: removing a fault can reveal another one in the same element."""

_STAND_IN = "\x00"
"""The beginning of the ids of elements without a name; no real id begins so."""

_NAMED = {
    "actions": "action",
    "resources": "resource",
    "state": "state variable",
    "groups": "group",
}

_ELEMENT = 2
"""Pointers into the arrays of a task begin with the array's name and an index."""


def further_findings(raw: Mapping[str, Any], found: Findings) -> list[Diagnostic]:
    """Findings of the checks about the sound elements of `raw`, given its faults of shape."""
    from irc.checks import run_checks

    patched: Any = copy.deepcopy(dict(raw))
    faulty: set[Pointer] = set()
    faults = list(found.items)
    for _ in range(_ROUNDS):
        for fault in faults:
            _patch(patched, fault, faulty)
        again = Findings()
        task = to_task(patched, again)
        if task is not None:
            report = run_checks(task, lint=False, complete=False).report
            nameless = {field for field in _NAMED if _has_stand_in(patched.get(field))}
            return [d for d in report if not _follows(d, faulty, nameless)]
        faults = again.items
    return []


def _patch(document: Any, fault: Diagnostic, faulty: set[Pointer]) -> None:
    pointer = fault.pointer
    faulty.add(pointer[:_ELEMENT])
    parent, name = _parent(document, pointer)
    if fault.code is Code.MISSING_FIELD:
        target = parent[name] if pointer else document
        if isinstance(target, dict):
            _fill(target, pointer)
    elif isinstance(parent, dict) and name in parent:
        # Remove a wrong value; the next round fills a required field.
        del parent[name]
    elif isinstance(parent, list) and isinstance(name, int) and name < len(parent):
        parent[name] = {}


def _parent(document: Any, pointer: Pointer) -> tuple[Any, Any]:
    for part in pointer[:-1]:
        try:
            document = document[part]
        except (KeyError, IndexError, TypeError):
            return None, None
    return document, pointer[-1] if pointer else None


def _fill(element: dict[str, Any], pointer: Pointer) -> None:
    """Gives a patched element its required fields."""
    if not pointer:
        element.setdefault("actions", [])
        return
    stand_in = f"{_STAND_IN}{'/'.join(map(str, pointer))}"
    required: dict[str, dict[str, Any]] = {
        "actions": {"id": stand_in, "duration": 0},
        "resources": {"id": stand_in},
        "state": {"id": stand_in},
        "groups": {"id": stand_in, "actions": []},
        "precedence": {"before": f"{stand_in}<", "after": f"{stand_in}>"},
    }
    for field, value in required.get(str(pointer[0]), {}).items():
        element.setdefault(field, value)


def _has_stand_in(elements: Any) -> bool:
    listed = elements if isinstance(elements, list) else []
    ids = [e.get("id") for e in listed if isinstance(e, dict)]
    return any(isinstance(i, str) and i.startswith(_STAND_IN) for i in ids)


def _follows(finding: Diagnostic, faulty: set[Pointer], nameless: set[str]) -> bool:
    """Whether the only reason for a finding may be a patch."""
    if finding.pointer[:_ELEMENT] in faulty or finding.pointer[:1] in faulty:
        return True
    if _STAND_IN in finding.message:
        return True
    unknown = (f"there is no {_NAMED[field]} " for field in nameless)
    return finding.code is Code.UNKNOWN_NAME and finding.message.startswith(tuple(unknown))
