"""Asks an engine within a budget; where there is no time for one, the compiler answers itself."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from irc.driver.quick import quick_outcome
from irc.schedule import Schedule, Status
from irc.targets import Budget, Engine, EngineMissing, Outcome, Program, SolveOptions

AFTERWARDS_SHARE = 0.05
"""The part of a time limit that is kept for re-timing, the validator and the output, at most."""

STEP_AFTERWARDS_SHARE = 0.3
"""The same for a step of a running task, whose limit may be short."""

MANY_ACTIVITIES = 5_000
LARGE_AFTERWARDS_SHARE = 0.4
"""The same for a task of many activities, of which the rest takes longer than a share of little."""

AFTERWARDS = 2
"""For a task of many activities, re-timing, the validator and the output take this many times as
long as all that came before the engine, at most: measured up to 100,000 activities.
"""

Accept = Callable[[Schedule], bool]


def asked(
    program: Program,
    engine: Engine,
    options: SolveOptions,
    budget: Budget,
    accept: Accept | None = None,
    part: float = 1.0,
    kept: float = AFTERWARDS_SHARE,
) -> Outcome:
    """The outcome of an engine, which may take a `part` of the time that is left.

    Of the time limit the part `kept`, at most, is kept for what follows.

    If the engine finds nothing within the budget, or the budget does not last until it could begin,
    the outcome is the compiler's own schedule, if there is one that `accept` accepts. Raises
    `EngineMissing` or `EngineFailed`. A deterministic call does not ask how busy the machine is.
    """
    reason = engine.missing()
    if reason is not None:
        raise EngineMissing(reason)
    if not budget.is_cancelled:
        import irc.validation  # noqa: F401 - now, while there is time: a search may be cut short
    begins = not budget.is_over if options.deterministic else engine.can_begin(budget)
    quick = None if begins else _own(program, accept)
    if quick is not None:
        return replace(quick, is_cut=options.deterministic)
    if budget.is_cancelled:
        return Outcome(Status.UNKNOWN, engine.name, is_cut=options.deterministic)
    # All that follows takes about as long as all that came before: reading and checking.
    following = budget.elapsed
    if len(program.problem.activities) >= MANY_ACTIVITIES:
        kept, following = max(kept, LARGE_AFTERWARDS_SHARE), AFTERWARDS * following
    after = min(following, kept * budget.limit)
    outcome = engine.solve(program, options, budget.share(part).at_most(budget.left - after))
    if outcome.status is Status.UNKNOWN:
        quick = _own(program, accept)
    return outcome if quick is None else replace(quick, notes=outcome.notes, is_cut=outcome.is_cut)


def _own(program: Program, accept: Accept | None) -> Outcome | None:
    outcome = quick_outcome(program.problem)
    if outcome is None or outcome.schedule is None:
        return None
    return outcome if accept is None or accept(outcome.schedule) else None
