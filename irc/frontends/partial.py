"""Checks the rest of a document that has faults of shape, so that one run has all findings.

What is certain is repaired, as `irc check --fix` would, and what shows then is found, too. The
other faulty elements are patched, so that the rest can be typed and checked. Findings about a
patched element, or because of it, are left out.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from irc.diagnostics import Code, Diagnostic, Findings, Severity
from irc.diagnostics.patching import apply_patches, operations_of
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
    repaired = _Repaired(copy.deepcopy(dict(raw)))
    faults = [d for d in found.items if d.severity is Severity.ERROR and d.offset is None]
    more = [repaired.placed(d) for d in repaired.repair(faults)]
    return more + [repaired.placed(d) for d in _checked(repaired.document, repaired.faults)]


@dataclass
class _Repaired:
    """A document after certain repairs, and the way back to places in the original.

    `moves` are pairs of a path in the document and its path before, the latest repair last.
    """

    document: Any
    faults: list[Diagnostic] = field(default_factory=list)
    moves: list[tuple[Pointer, Pointer]] = field(default_factory=list)

    def repair(self, faults: list[Diagnostic]) -> list[Diagnostic]:
        """Makes all certain repairs, and those of what shows then; returns what showed then."""
        shown: list[Diagnostic] = []
        for _ in range(_MOST_REPAIRS):
            fixable = [d for d in faults if d.fix]
            if not fixable:
                break
            self._note_moves(fixable)
            known = {(d.code, d.message) for d in faults if not d.fix}
            self.document = apply_patches(self.document, fixable)
            again = Findings()
            to_task(self.document, again)
            faults = again.items
            shown += [d for d in faults if (d.code, d.message) not in known]
        self.faults = faults
        return shown

    def _note_moves(self, fixable: list[Diagnostic]) -> None:
        lengths = {
            name: len(listed) for name, listed in self.document.items() if isinstance(listed, list)
        }
        for operation in operations_of(fixable):
            if operation.op == "move" and operation.origin is not None:
                self.moves.append((operation.path, operation.origin))
            elif operation.op == "add":
                array = operation.target
                place = lengths.get(str(array[-1]), 0)
                lengths[str(array[-1])] = place + 1
                self.moves.append(((*array, place), operation.because))

    def placed(self, finding: Diagnostic) -> Diagnostic:
        """A finding about the document, at its place in the original; it has no repair there."""
        pointer = finding.pointer
        for path, origin in reversed(self.moves):
            if pointer[: len(path)] == path:
                rest = () if path[-1:] and isinstance(path[-1], int) else pointer[len(path) :]
                pointer = (*origin, *rest)
        return replace(finding, pointer=pointer, fix=() if self.moves else finding.fix)


_MOST_REPAIRS = 8
"""Limit on rounds of repairs: one can reveal another fault, which the next one repairs."""


def _checked(document: Any, faults: list[Diagnostic]) -> list[Diagnostic]:
    """Findings of the checks about the sound elements of a document, given its faults of shape."""
    from irc.checks import run_checks

    patched: Any = copy.deepcopy(document)
    faulty: set[Pointer] = set()
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
    for name, value in required.get(str(pointer[0]), {}).items():
        element.setdefault(name, value)


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
