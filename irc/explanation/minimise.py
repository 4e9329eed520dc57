"""Deletion: from statements that cannot hold together to a minimal set of them.

Each statement is left out in turn; where the others still cannot hold together it stays out, else
it is needed. What is weaker holds more often, so a statement that was needed once is needed in
the smaller set too, and one pass is enough. (Chinneck, Dravnieks, "Locating minimal infeasible
constraint sets in linear programs", 1991.)
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from enum import Enum, auto

from irc.explanation.statements import KINDS, Side, Statement
from irc.problem import Problem

_PARTS = 4
"""Groups that cannot all be left out are tried again in so many parts."""


class Verdict(Enum):
    """Whether some statements can hold together."""

    POSSIBLE = auto()
    IMPOSSIBLE = auto()
    UNKNOWN = auto()


@dataclass(frozen=True, slots=True)
class Trial:
    """The verdict on a set of statements; `core` are those that already cannot hold together."""

    verdict: Verdict
    core: frozenset[Statement] | None = None


Try = Callable[[frozenset[Statement]], Trial]


@dataclass(frozen=True, slots=True)
class Conflict:
    """Statements that cannot hold together, and whether each was proven to be needed.

    `excess` (ticks) is by how much, where they go round in time: they are then in that order.
    """

    statements: tuple[Statement, ...]
    minimal: bool
    excess: int | None = None


def minimise(
    found: Iterable[Statement],
    attempt: Try,
    order: Sequence[Statement],
    families: Iterable[Sequence[frozenset[Statement]]] = (),
) -> Conflict:
    """A minimal subset of `found`, which cannot hold together.

    `order` says what is left out first, so what an author would rather not hear of comes first.
    `families` are groups of statements that are left out before that, as many at a time as
    possible: it saves trials.
    """
    kept, needed = frozenset(found), frozenset[Statement]()
    for groups in families:
        kept, needed = _without_groups(kept, needed, attempt, groups)
    minimal = True
    for statement in order:
        if statement in kept and statement not in needed:
            kept, verdict = _without(kept, frozenset((statement,)), attempt)
            minimal = minimal and verdict is not Verdict.UNKNOWN
    return Conflict(tuple(s for s in order if s in kept), minimal)


def _without_groups(
    kept: frozenset[Statement],
    needed: frozenset[Statement],
    attempt: Try,
    groups: Sequence[frozenset[Statement]],
) -> tuple[frozenset[Statement], frozenset[Statement]]:
    """Leaves out whole groups: many together, and where that is too much, fewer."""
    waiting = [groups] if groups else []
    while waiting:
        together = waiting.pop()
        left_out = frozenset().union(*together) & kept
        if not left_out or left_out & needed:
            verdict = Verdict.POSSIBLE
        else:
            kept, verdict = _without(kept, left_out, attempt)
            if verdict is Verdict.POSSIBLE and len(left_out) == 1:
                needed |= left_out
        if left_out and verdict is not Verdict.IMPOSSIBLE and len(together) > 1:
            size = -(-len(together) // _PARTS)
            parts = [together[k : k + size] for k in range(0, len(together), size)]
            waiting += parts[::-1]
    return kept, needed


def _without(
    kept: frozenset[Statement], left_out: frozenset[Statement], attempt: Try
) -> tuple[frozenset[Statement], Verdict]:
    rest = kept - left_out
    if not rest:
        return kept, Verdict.POSSIBLE
    trial = attempt(rest)
    if trial.verdict is Verdict.IMPOSSIBLE:
        return (rest if trial.core is None else rest & trial.core), trial.verdict
    return kept, trial.verdict


def narrow(problem: Problem, conflict: Conflict, attempt: Try) -> Conflict:
    """The same conflict, saying which limit of a statement binds where only one of the two does."""
    statements = list(conflict.statements)
    two_sided = [k for k, s in enumerate(statements) if KINDS[s.kind].has_two_sides(problem, s)]
    for side in (Side.LEAST, Side.MOST):
        all_at_once = list(statements)
        for k in two_sided:
            all_at_once[k] = statements[k]._replace(side=side)
        if attempt(frozenset(all_at_once)).verdict is Verdict.IMPOSSIBLE:
            return replace(conflict, statements=tuple(all_at_once))
    for k in two_sided:
        for side in (Side.LEAST, Side.MOST):
            narrowed = [*statements[:k], statements[k]._replace(side=side), *statements[k + 1 :]]
            if attempt(frozenset(narrowed)).verdict is Verdict.IMPOSSIBLE:
                statements = narrowed
                break
    return replace(conflict, statements=tuple(statements))
