"""A plan that is being read."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from decimal import Decimal
from enum import Enum
from fractions import Fraction

from irc_pddl21.decoding.plan_log import Damage, PlanBlock, PlanStep

MAX_DAMAGE_PER_PLAN = 1_000
"""After this number of damaged lines the rest of a plan is skipped."""

_ROUNDING = Fraction(1, 100)
"""Steps may end this much before a stated makespan: planners print two to four decimals."""


class Heading(Enum):
    """The line that announced a plan."""

    NONE = "a step"
    FIGURE = "a comment with a cost or makespan"
    FOUND = "; Plan found with metric"
    SOLUTION = ";;;; Solution Found"


@dataclass(slots=True)
class OpenPlan:
    """The steps, damage and figures of a plan so far."""

    heading: Heading
    line: int
    metric: Decimal | None = None
    stated_makespan: Decimal | None = None
    steps: list[PlanStep] = field(default_factory=list)
    damage: list[Damage] = field(default_factory=list)
    is_over: bool = False
    """A figure stands below the steps: the next lines belong to another plan."""

    @property
    def is_given_up(self) -> bool:
        """Whether the plan has too many damaged lines, so that its rest is skipped."""
        return len(self.damage) >= MAX_DAMAGE_PER_PLAN

    @property
    def expects_durations(self) -> bool:
        """Whether the next step should have a duration, judged by the steps so far."""
        return not self.steps or any(step.duration is not None for step in self.steps)

    def has_figure(self, name: str) -> bool:
        """Whether the "makespan" or "metric" is known."""
        return (self.stated_makespan if name == "makespan" else self.metric) is not None

    def may_have(self, figure: str) -> bool:
        """Whether a figure may belong to this plan; if not, it announces the next one."""
        if self.heading is Heading.NONE and not self.steps:
            return False
        return not ((self.steps or self.damage) and self.has_figure(figure))

    def is_a_plan(self, *, is_first: bool) -> bool:
        """Whether this is more than a comment: without steps, a first plan whose metric is 0."""
        return bool(self.steps or self.damage) or (self.metric == 0 and is_first)

    def as_block(self) -> PlanBlock:
        """The plan as it stands."""
        return PlanBlock(tuple(self.steps), self.metric, self.line, tuple(self.damage))

    def lacking(self, earlier: Iterable[PlanBlock], *, ends_text: bool) -> str:
        """The sign that steps are missing from an undamaged plan; empty where there is none.

        `earlier` are the plans above it. `ends_text`: the text ends with its last line.
        """
        if self.damage:
            return ""
        if not self.steps and self.metric != 0:
            return "no step follows the heading"
        end = max((step.end for step in self.steps), default=Fraction(0)) + _ROUNDING
        stated, metric = self.stated_makespan, self.metric
        if stated is not None and end < Fraction(stated):
            return f"the steps end before the stated makespan {stated}"
        if not ends_text:
            return ""
        if self.heading is Heading.FOUND and metric is not None and end < Fraction(metric):
            return f"the text ends before the steps reach the metric {metric}"
        return self._cut_repetition(earlier)

    def _cut_repetition(self, earlier: Iterable[PlanBlock]) -> str:
        steps = tuple(self.steps)
        for plan in earlier:
            is_longer = len(plan.steps) > len(steps) and plan.metric == self.metric
            if is_longer and plan.steps[: len(steps)] == steps:
                return f"the text ends inside this repetition of the plan at line {plan.line}"
        return ""
