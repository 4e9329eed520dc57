"""Reports of engines to the caller: only better answers and bounds, with valid schedules."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

from irc.model.quantities import Number
from irc.schedule import Schedule, Status
from irc.targets import Budget, ObjectiveLevel, OnProgress, Outcome, Progress, SolveOptions

Approve = Callable[[Outcome], Schedule]
"""The schedule of an engine's outcome as the caller gets it. Raises `EngineFailed`."""


def telling(options: SolveOptions, budget: Budget, approve: Approve) -> SolveOptions:
    """The options for an engine: its progress reaches the caller as that of the whole call."""
    if options.on_progress is None:
        return options
    return replace(options, on_progress=_Teller(options.on_progress, budget, approve))


class _Teller:
    """Passes on each progress that is better than all before it, of any engine or run."""

    def __init__(self, tell: OnProgress, budget: Budget, approve: Approve) -> None:
        self.tell, self.budget, self.approve = tell, budget, approve
        self.values: tuple[Number, ...] = ()
        self.bounds: tuple[Number | None, ...] = ()

    def __call__(self, progress: Progress) -> None:
        values = tuple(map(_cost, progress.levels))
        bounds = tuple(level.bound for level in progress.levels)
        # An objective that was not being improved before has no value to compare with.
        known = min(len(values), len(self.values))
        if values[:known] > self.values[:known]:
            return
        if (values, bounds) == (self.values, self.bounds):
            return
        self.values, self.bounds = values, bounds
        made = None if progress.found is None else partial(self._made, progress)
        self.tell(replace(progress, seconds=self.budget.elapsed, found=made))

    def _made(self, progress: Progress) -> Schedule:
        assert progress.found is not None
        levels = progress.levels
        outcome = Outcome(Status.FEASIBLE, progress.engine, progress.found(), levels=levels)
        return self.approve(outcome)


def _cost(level: ObjectiveLevel) -> Number:
    """The value of an objective, where less is better."""
    return -level.value if level.name == "reward" else level.value
