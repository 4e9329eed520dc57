"""The plans in a planner's output, as data: steps, damage, and which plan is best."""

from __future__ import annotations

from dataclasses import dataclass, field
from decimal import Decimal
from fractions import Fraction


@dataclass(frozen=True, slots=True)
class PlanStep:
    """One action of a plan, with its times exactly as printed, in the planner's unit of time.

    Two steps are equal when they print the same action at the same times: `line` does not count.
    """

    start: Fraction
    name: str
    """The action, in lower case (PDDL does not tell cases apart), without parentheses."""
    args: tuple[str, ...] = ()
    duration: Fraction | None = None
    """`None` where none is printed: the action is instantaneous."""
    line: int = field(default=0, compare=False)
    """Where it stands in the text, counted from 1."""

    @property
    def end(self) -> Fraction:
        """The end of the step; its start where it has no duration."""
        return self.start if self.duration is None else self.start + self.duration


@dataclass(frozen=True, slots=True)
class Damage:
    """A line that should have been a step and cannot be trusted."""

    line: int
    """Where it stands in the text, counted from 1."""
    text: str
    """The line without colours, shortened where it is long; empty where something is missing."""
    reason: str
    """The fault, for a person to read."""


@dataclass(frozen=True, slots=True)
class PlanBlock:
    """One plan as printed, with whatever of it could be read."""

    steps: tuple[PlanStep, ...]
    """In the order of the text."""
    metric: Decimal | None
    """The planner's own figure for the plan, from its heading; `None` where it gives none."""
    line: int
    """The line of its heading, or of its first step where it has none."""
    damage: tuple[Damage, ...] = ()

    @property
    def complete(self) -> bool:
        """No line of it is damaged or known to be missing.

        This is not a promise: a text cut between two lines of a single plan shows no trace of it.
        """
        return not self.damage

    @property
    def makespan(self) -> Fraction:
        """The latest end of the steps that could be read; 0 where there are none."""
        return max((step.end for step in self.steps), default=Fraction(0))


@dataclass(frozen=True, slots=True)
class PlanLog:
    """All that a planner's output says about plans."""

    plans: tuple[PlanBlock, ...] = ()
    """In the order of the text, damaged ones too, repetitions left out."""
    blocks: int = 0
    """How many plans were printed, repetitions counted."""
    unsolvable: bool = False
    """Whether the planner says that there is no plan, and prints none. That is not a proof.

    The same words below a plan mean "no better one" and leave this `False`.
    """
    notes: tuple[str, ...] = ()
    """Notes for the user: errors that the planner reports, limits reached here."""

    @property
    def ranked(self) -> tuple[PlanBlock, ...]:
        """Every plan worth trying, best first.

        First the complete ones: the lowest metric (the lowest makespan, if any of them is without
        metric), and the last printed of equals. Then the damaged ones that have a step, the last
        printed first. A caller that validates plans takes the first that passes.
        """
        complete = [plan for plan in reversed(self.plans) if plan.complete]
        damaged = [plan for plan in reversed(self.plans) if plan.steps and not plan.complete]
        metrics = [plan.metric for plan in complete if plan.metric is not None]
        if len(metrics) < len(complete):
            complete.sort(key=lambda plan: plan.makespan)
        else:
            complete.sort(key=lambda plan: Fraction(plan.metric or 0))
        return (*complete, *damaged)

    @property
    def best(self) -> PlanBlock | None:
        """The first of `ranked`: a damaged plan only where no complete one is, which its `complete`
        tells. `None` where nothing was read.
        """
        return next(iter(self.ranked), None)
