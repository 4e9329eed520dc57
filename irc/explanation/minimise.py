"""Deletion: finds a minimal set among statements that cannot hold together.

Each statement is left out in turn. If the others still cannot hold together, it stays out, else it
is needed. A smaller set holds more easily, so a statement that is needed once is needed in every
smaller set too, and one pass is enough. (Chinneck, Dravnieks, "Locating minimal infeasible
constraint sets in linear programs", 1991.)
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum, auto
from typing import Generic, TypeVar

from irc.problem import Problem
from irc.problem.statements import KINDS, Side, Statement
from irc.targets import Budget

_PARTS = 4
"""The number of parts in which groups that cannot all be left out are tried again."""

_FEW = 8
"""If this many trials, each with at most as many groups, leave nothing out, the trials end."""


class Possibility(Enum):
    """Whether some statements can hold together."""

    POSSIBLE = auto()
    IMPOSSIBLE = auto()
    UNKNOWN = auto()


S = TypeVar("S", bound=Hashable)
"""A statement, or an element of a task."""


@dataclass(frozen=True, slots=True)
class Trial(Generic[S]):
    """The result for a set of statements; `core` is a subset that cannot hold together."""

    result: Possibility
    core: frozenset[S] | None = None


Try = Callable[[frozenset[S]], Trial[S]]


@dataclass(frozen=True, slots=True)
class Conflict(Generic[S]):
    """Statements that cannot hold together, and whether each was proven to be needed.

    `excess` (ticks) is the missing time, if the statements form a cycle in time, in their order.
    """

    statements: tuple[S, ...]
    minimal: bool
    excess: int | None = None


@dataclass
class _Deletion(Generic[S]):
    """The remaining statements, and those of them that are known to be needed."""

    kept: frozenset[S]
    attempt: Try[S]
    implied: Mapping[S, S]
    needed: set[S] = field(default_factory=set)

    def leave_out(self, statements: frozenset[S]) -> Possibility:
        """Leaves statements out for good if the others still cannot hold together."""
        rest = self.kept - statements
        trial = self.attempt(rest)
        if trial.result is Possibility.IMPOSSIBLE:
            self.kept = rest if trial.core is None else rest & trial.core
        elif trial.result is Possibility.POSSIBLE and len(statements) == 1:
            (statement,) = statements
            self.needed |= {statement, self.implied.get(statement, statement)}
        return trial.result

    def leave_out_groups(self, groups: Sequence[frozenset[S]]) -> None:
        """Leaves out whole groups: many together, and if that fails, fewer.

        If even few together always fail, nearly all are needed, and single statements come next.
        """
        parts = [groups]
        size = len(groups)
        while parts and size:
            too_much = [part for part in parts if not self._goes(part)]
            if size == 1 or (size <= _FEW <= len(parts) == len(too_much)):
                return
            size = -(-size // _PARTS)
            parts = [part[k : k + size] for part in too_much for k in range(0, len(part), size)]

    def _goes(self, groups: Sequence[frozenset[S]]) -> bool:
        statements = frozenset().union(*groups) & self.kept
        if not statements:
            return True
        if statements & self.needed:
            return False
        return self.leave_out(statements) is Possibility.IMPOSSIBLE


def minimise(
    found: Iterable[S],
    attempt: Try[S],
    order: Sequence[S],
    families: Iterable[Sequence[frozenset[S]]] = (),
    implied: Mapping[S, S] | None = None,
    budget: Budget | None = None,
) -> Conflict[S]:
    """A minimal subset of `found`, which cannot hold together.

    `order` is the order of leaving out: statements that help an author least come first. Two things
    save trials: groups in `families` are left out before that, as many at a time as possible; and
    if a statement is needed, so is the one `implied` by it. After the end of the budget no more is
    tried.
    """
    deletion = _Deletion(frozenset(found), attempt, implied or {})
    for groups in families:
        deletion.leave_out_groups(groups)
    minimal = True
    for statement in order:
        if budget is not None and budget.is_over:
            minimal = minimal and deletion.kept <= deletion.needed
            break
        if statement in deletion.kept and statement not in deletion.needed:
            result = deletion.leave_out(frozenset((statement,)))
            minimal = minimal and result is not Possibility.UNKNOWN
    return Conflict(tuple(s for s in order if s in deletion.kept), minimal)


def narrow(
    problem: Problem,
    conflict: Conflict[Statement],
    attempt: Try[Statement],
    budget: Budget | None = None,
) -> Conflict[Statement]:
    """The same conflict, with the side of each statement of which only one limit binds.

    After the end of the budget no more is tried.
    """
    statements = list(conflict.statements)
    two_sided = [k for k, s in enumerate(statements) if KINDS[s.kind].has_two_sides(problem, s)]
    for side in (Side.LEAST, Side.MOST):
        all_at_once = list(statements)
        for k in two_sided:
            all_at_once[k] = statements[k]._replace(side=side)
        if attempt(frozenset(all_at_once)).result is Possibility.IMPOSSIBLE:
            return replace(conflict, statements=tuple(all_at_once))
    for k in two_sided:
        if budget is not None and budget.is_over:
            break
        for side in (Side.LEAST, Side.MOST):
            narrowed = [*statements[:k], statements[k]._replace(side=side), *statements[k + 1 :]]
            if attempt(frozenset(narrowed)).result is Possibility.IMPOSSIBLE:
                statements = narrowed
                break
    return replace(conflict, statements=tuple(statements))
