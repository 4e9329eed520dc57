"""Checks for legal but suspicious elements: unused resources, redundant precedences."""

from __future__ import annotations

from irc.diagnostics import Code, Findings
from irc.model import Action, Task
from irc.passes.reduction import redundant_arcs
from irc.problem import Problem

_MOST_MISSPELT = 50
"""With more unknown resources than this, every unused resource is reported."""


def _is_meant(resource: str, unknown: set[str]) -> bool:
    """Whether one of the unknown names may be a misspelling of this resource.

    (The unknown names are reported already.)
    """
    if not unknown or len(unknown) > _MOST_MISSPELT:
        return False
    from irc.diagnostics.suggest import closest

    return any(closest(name, [resource]) for name in unknown)


def check_lint(task: Task, problem: Problem, findings: Findings) -> None:
    """Adds warnings about unused resources and notes about redundant precedences."""
    changes = (change for event in task.events for change in event.changes)
    added = (a for c in changes for a in getattr(c, "actions", ()) if isinstance(a, Action))
    used: set[str] = set()
    for action in (*task.actions, *added):
        used.update(r for u in action.uses for r in u.alternatives)
        used.update(c.resource for c in (*action.consumes, *action.produces))
        for mode in action.modes:
            used.update(c.resource for c in (*mode.consumes, *mode.produces))
        used.update(r for m in action.modes for u in m.uses for r in u.alternatives)
    unknown = used.difference(r.id for r in task.resources)
    for i, resource in enumerate(task.resources):
        if resource.id not in used and not _is_meant(resource.id, unknown):
            findings.add(
                Code.UNUSED,
                f"no action uses resource {resource.id!r}",
                ("resources", i),
                hint='name it in the "uses" of an action, or remove it',
            )
    redundant = redundant_arcs(problem)
    if not redundant:
        return
    from irc.diagnostics.fix import removed

    for k in redundant:
        arc = problem.arcs[k]
        before, after = problem.activities[arc.before].id, problem.activities[arc.after].id
        findings.add(
            Code.REDUNDANT,
            f"{before!r} before {after!r} follows from other precedences",
            ("precedence", arc.origin),
            hint="it may be removed; targets leave it out",
            # Events may remove the other precedences, and then this one is needed.
            fix=() if task.events else removed(("precedence", arc.origin)),
        )
