"""Decides which half-done groups are given up: as few as possible, and only on a proof.

A half-done group is finished if any continuation allows it. Where a proof says that none does, a
search finds the groups that can be finished together.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations

from irc.execution.continuation import PROVER, Repair
from irc.model.quantities import Number
from irc.problem import Problem
from irc.problem.objective_values import costs
from irc.schedule import Status
from irc.targets import Budget, Outcome, get_backend

Found = tuple[Outcome, Problem, tuple[int, ...]]
"""An outcome, the problem it answers, and the groups given up."""

PROVER_SHARE = 0.1
"""The part of the time left that this may take before an engine is asked."""

GIVEN_UP_TRIED = 200
"""At most this many choices of groups to give up are tried, smaller ones first."""


def best_continuation(repair: Repair) -> Found:
    """The best continuation that gives up as few half-done groups as possible."""
    half_done = repair.frozen.half_done()
    has_prover = not repair.backend.proves and _can_prove(repair.budget.share(PROVER_SHARE))
    if repair.frozen.all_carried is not None and has_prover:
        repair = _with_what_is_met(repair)
    if half_done and has_prover:
        return _as_proven(repair)
    outcome, problem = repair.attempt(())
    if outcome.status is Status.UNKNOWN and has_prover and not repair.budget.is_over:
        proven, whole = _prover(repair, repair.budget).attempt(())
        if proven.status is Status.INFEASIBLE:
            return proven, whole, ()
    if outcome.schedule is not None or not half_done:
        return outcome, problem, ()
    found, certain = _smallest(repair, half_done, outcome.status is not Status.UNKNOWN)
    if found:
        return min(found, key=lambda f: _value(f[1], f[0]))
    # Without a proof that the others cannot be finished, none is given up.
    return outcome if certain else replace(outcome, status=Status.UNKNOWN), problem, ()


def _can_prove(budget: Budget) -> bool:
    """Whether the prover is there, and can be loaded in the time."""
    prover = get_backend(PROVER).engine()
    return prover.missing() is None and prover.can_begin(budget)


def _prover(repair: Repair, budget: Budget) -> Repair:
    """The repair with the prover instead of its engine, and with another budget."""
    prover = get_backend(PROVER)
    options = replace(repair.options, on_progress=None)
    return replace(repair, backend=prover, engine=prover.engine(), options=options, budget=budget)


def _with_what_is_met(repair: Repair) -> Repair:
    """The repair in which all is carried at once that, as the prover says, nothing can meet."""
    frozen = repair.frozen
    proven, _ = _prover(repair, repair.budget.share(PROVER_SHARE)).all_met(())
    if proven.status is not Status.INFEASIBLE or frozen.all_carried is None:
        return repair
    return replace(repair, frozen=replace(frozen, problem=frozen.all_carried, all_carried=None))


def _as_proven(repair: Repair) -> Found:
    """The continuation that gives up the groups which the prover gave up, to save time."""
    proven = best_continuation(_prover(repair, repair.budget.share(PROVER_SHARE)))
    if proven[0].status is Status.INFEASIBLE:
        return proven
    return (*repair.attempt(proven[2]), proven[2])


def _smallest(repair: Repair, half_done: Sequence[int], certain: bool) -> tuple[list[Found], bool]:
    """The result of giving up as few as possible, and whether fewer are proven not to suffice."""
    found: list[Found] = []
    sizes = range(1, 1 + len(half_done))
    choices = (chosen for size in sizes for chosen in combinations(half_done, size))
    for tried, given_up in enumerate(choices):
        if found and len(given_up) > len(found[0][2]):
            break
        certain = certain and not repair.budget.is_over and tried < GIVEN_UP_TRIED
        if not certain:
            break
        outcome, problem = repair.attempt(given_up)
        if outcome.schedule is not None:
            found.append((outcome, problem, given_up))
        certain = outcome.status is not Status.UNKNOWN
    return found, certain


def _value(problem: Problem, outcome: Outcome) -> tuple[Number, ...]:
    """The objectives in their order; less is better."""
    assert outcome.schedule is not None
    return tuple(costs(problem, outcome.schedule).values())
