"""Writes precedences in the DSL: in the statement of the waiting action, or as arrows."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

from irc.frontends.dsl import written
from irc.model import Precedence
from irc.model.events import PrecedenceKey

Arc = Precedence | PrecedenceKey

_WIDEST = 96


def by_action(
    precedence: Sequence[Precedence], ids: Sequence[str]
) -> dict[int, list[Precedence]] | None:
    """The precedences by the index of the waiting action; None if their order forbids that.

    Read back, they come in the order of the actions, so they must already have that order.
    """
    index: dict[str, int] = {}
    for i, id in enumerate(ids):
        index.setdefault(id, i)
    found: dict[int, list[Precedence]] = {}
    latest = -1
    for arc in precedence:
        at = index.get(arc.after, -1)
        if at < latest or at < 0:
            return None
        latest = at
        found.setdefault(at, []).append(arc)
    return found


def after_clauses(arcs: Sequence[Precedence]) -> list[str]:
    """The clauses of the action that waits: `after a + 3, start of b`, `ends after c`."""
    clauses = []
    for ends, group in groupby(arcs, key=lambda arc: arc.type.endswith("-finish")):
        listed = ", ".join(
            ("start of " if arc.type.startswith("start-") else "")
            + written.name(arc.before)
            + written.lag(arc.min_lag, arc.max_lag)
            for arc in group
        )
        clauses.append(f"{'ends after' if ends else 'after'} {listed}")
    return clauses


def arrows(arcs: Sequence[Arc]) -> list[str]:
    """Statements that give exactly these precedences, in their order."""
    statements = []
    at = 0
    while at < len(arcs):
        text, at = _statement(arcs, at)
        statements.append(text)
    return statements


def _statement(arcs: Sequence[Arc], at: int) -> tuple[str, int]:
    first = arcs[at]
    for side in ("before", "after"):
        text, end = _fan(arcs, at, side)
        if end - at > 1:
            return text, end
    text = f"{_source(first)} -> {_target(first)}"
    at += 1
    while at < len(arcs) and _continues(arcs[at - 1], arcs[at]):
        more = f"{text} -> {_target(arcs[at])}"
        if len(more) > _WIDEST or _fan(arcs, at, "before")[1] - at > 1:
            break
        text, at = more, at + 1
    return text, at


def _fan(arcs: Sequence[Arc], at: int, side: str) -> tuple[str, int]:
    """Plain arcs from here on that share an action: `a -> b, c` or `a, b -> c`."""
    shared = getattr(arcs[at], side)
    others: list[str] = []
    width = len(shared)
    end = at
    while end < len(arcs) and getattr(arcs[end], side) == shared and _plain(arcs[end]):
        other = written.name(arcs[end].after if side == "before" else arcs[end].before)
        width += len(other) + 2
        if others and width > _WIDEST:
            break
        others.append(other)
        end += 1
    listed = ", ".join(others)
    name = written.name(shared)
    return (f"{name} -> {listed}" if side == "before" else f"{listed} -> {name}"), end


def _plain(arc: Arc) -> bool:
    if isinstance(arc, PrecedenceKey):
        return True
    return arc.type == "finish-start" and not written.lag(arc.min_lag, arc.max_lag)


def _continues(arc: Arc, following: Arc) -> bool:
    if arc.after != following.before:
        return False
    return _type(arc).endswith("-start") and _type(following).startswith("finish-")


def _type(arc: Arc) -> str:
    return arc.type if isinstance(arc, Precedence) else "finish-start"


def _source(arc: Arc) -> str:
    return ("start of " if _type(arc).startswith("start-") else "") + written.name(arc.before)


def _target(arc: Arc) -> str:
    side = "end of " if _type(arc).endswith("-finish") else ""
    lag = written.lag(arc.min_lag, arc.max_lag) if isinstance(arc, Precedence) else ""
    return side + written.name(arc.after) + lag
