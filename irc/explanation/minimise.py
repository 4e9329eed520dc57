"""Deletion: from statements that cannot hold together to a minimal set of them.

Each statement is left out in turn; where the others still cannot hold together it stays out, else
it is needed. What is weaker holds more often, so a statement that was needed once is needed in
the smaller set too, and one pass is enough. (Chinneck, Dravnieks, "Locating minimal infeasible
constraint sets in linear programs", 1991.)
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum, auto

from irc.problem import Problem
from irc.problem.statements import KINDS, Side, Statement

_PARTS = 4
"""Groups that cannot all be left out are tried again in so many parts."""

_FEW = 8
"""So many groups are few to be left out together, and so many trials are enough."""


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


@dataclass
class _Deletion:
    """The statements still kept, and those of them that are known to be needed."""

    kept: frozenset[Statement]
    attempt: Try
    implied: Mapping[Statement, Statement]
    needed: set[Statement] = field(default_factory=set)

    def leave_out(self, statements: frozenset[Statement]) -> Verdict:
        """Leaves statements out for good where the others still cannot hold together."""
        rest = self.kept - statements
        trial = self.attempt(rest) if rest else Trial(Verdict.POSSIBLE)
        if trial.verdict is Verdict.IMPOSSIBLE:
            self.kept = rest if trial.core is None else rest & trial.core
        elif trial.verdict is Verdict.POSSIBLE and len(statements) == 1:
            (statement,) = statements
            self.needed |= {statement, self.implied.get(statement, statement)}
        return trial.verdict

    def leave_out_groups(self, groups: Sequence[frozenset[Statement]]) -> None:
        """Leaves out whole groups: many together, and where that is too much, fewer.

        Where few together never go either, nearly all are needed, and one by one is next.
        """
        parts = [groups]
        size = len(groups)
        while parts and size:
            too_much = [part for part in parts if not self._goes(part)]
            if size == 1 or (size <= _FEW <= len(parts) == len(too_much)):
                return
            size = -(-size // _PARTS)
            parts = [part[k : k + size] for part in too_much for k in range(0, len(part), size)]

    def _goes(self, groups: Sequence[frozenset[Statement]]) -> bool:
        statements = frozenset().union(*groups) & self.kept
        if not statements:
            return True
        if statements & self.needed:
            return False
        return self.leave_out(statements) is Verdict.IMPOSSIBLE


def minimise(
    found: Iterable[Statement],
    attempt: Try,
    order: Sequence[Statement],
    families: Iterable[Sequence[frozenset[Statement]]] = (),
    implied: Mapping[Statement, Statement] | None = None,
) -> Conflict:
    """A minimal subset of `found`, which cannot hold together.

    `order` says what is left out first, so what an author would rather not hear of comes first.
    Two things save trials: `families` are groups of statements that are left out before that, as
    many at a time as possible; and where a statement is needed, so is the one `implied` by it.
    """
    deletion = _Deletion(frozenset(found), attempt, implied or {})
    for groups in families:
        deletion.leave_out_groups(groups)
    minimal = True
    for statement in order:
        if statement in deletion.kept and statement not in deletion.needed:
            verdict = deletion.leave_out(frozenset((statement,)))
            minimal = minimal and verdict is not Verdict.UNKNOWN
    return Conflict(tuple(s for s in order if s in deletion.kept), minimal)


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
