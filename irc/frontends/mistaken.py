"""Recognises documents of other kinds, and PDDL, where a task is expected."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from irc.diagnostics import Code, Diagnostic

_SHOWN = "`irc show TASK SCHEDULE` shows it; here, give the task that it was made for"
_KINDS: Mapping[str, tuple[str, str]] = {
    "irc_schedule": ("a schedule", _SHOWN),
    "irc_step": ("a step of a running task", "its 'schedule' is one; give the task itself"),
    "irc_simulation": ("a simulation", "its 'final' is a schedule; give the task itself"),
    "irc_verdict": ("a verdict on a schedule", "give the task itself"),
    "irc_explanation": ("an explanation", "give the task itself"),
    "irc_lateness": ("an explanation", "give the task itself"),
    "irc_manifest": ("the manifest of a compiled task", "its field 'task' is the task"),
    "irc_tables": ("the tables of a schedule", "give the task itself"),
    "irc_error": ("the report of an error", "give the task itself"),
}


def mistaken_for_task(content: Mapping[str, Any]) -> Diagnostic | None:
    """The finding that a document is no task but of another kind; None where it may be a task."""
    for key, (what, hint) in _KINDS.items():
        if key in content:
            message = f"this is {what}, not a task"
            return Diagnostic(Code.WRONG_TYPE, message, (key,), hint, at_key=True)
    actions = content.get("actions")
    if not isinstance(actions, list) or not actions:
        return None
    if all(isinstance(a, Mapping) and {"id", "start", "end"} <= a.keys() for a in actions):
        message = "this is a schedule, not a task: its actions have a start and an end"
        return Diagnostic(Code.WRONG_TYPE, message, ("actions",), _SHOWN, at_key=True)
    return None


_DOMAIN = re.compile(r"\(\s*define\s*\(\s*domain\b", re.IGNORECASE)
_PROBLEM = re.compile(r"\(\s*define\s*\(\s*problem\b", re.IGNORECASE)


def part_of_pddl(text: str) -> str | None:
    """ "domain" or "problem", where a text is one of PDDL."""
    if _DOMAIN.search(text):
        return "domain"
    return "problem" if _PROBLEM.search(text) else None


def half_of_pddl(text: str) -> Diagnostic | None:
    """The finding that a text is only half of a task in PDDL."""
    part = part_of_pddl(text)
    if part is None:
        return None
    other = "problem" if part == "domain" else "domain"
    hint = (
        f"give its {other}, too: `irc solve domain.pddl problem.pddl`, and for other commands "
        "`irc convert domain.pddl --problem problem.pddl -o task.json` first"
    )
    return Diagnostic(Code.NOT_AN_IMPORT, f"this is only the {part} of a task in PDDL", hint=hint)
