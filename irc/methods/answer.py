"""The answer of a method: its state, and the step graph or the plan in it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cached_property
from typing import TYPE_CHECKING, Any

from irc.diagnostics import Report

if TYPE_CHECKING:
    from irc.frontends.importers.plan_lines import PlanLine
    from irc.frontends.importers.step_graph import Duration, StepGraph
    from irc.model import Event, Task
    from irc.schedule import Schedule


class AnswerState(StrEnum):
    """The states in which a model's answer can be."""

    OK = "ok"
    EMPTY = "empty"
    TRUNCATED = "truncated"
    MALFORMED = "malformed"
    INVALID = "invalid"


@dataclass(frozen=True)
class Answer:
    """A model's answer, read.

    `document` is the task as an IR document; None where there is none. `stated_makespan` is the
    makespan that the model states. `actions_from_gold` marks an answer that names goals only, so
    that the instance's own kitchen must supply the actions. `event` are the changes of a repair.
    """

    state: AnswerState
    text: str
    graph: StepGraph | None = None
    document: Mapping[str, Any] | None = None
    stated_makespan: Duration | None = None
    plan: tuple[PlanLine, ...] | None = None
    report: Report = field(default_factory=Report)
    actions_from_gold: bool = False
    event: Event | None = None

    @cached_property
    def task(self) -> Task | None:
        """The answer as a task of the IR; None where it holds none. Raises `ValueError`."""
        if self.document is None:
            return None
        from irc.model import Task

        return Task.model_validate(self.document)

    @cached_property
    def schedule(self) -> Schedule | None:
        """The plan as a schedule; None where the answer holds no plan."""
        if self.plan is None:
            return None
        from irc.frontends.importers.plan_lines import plan_schedule

        return plan_schedule(self.plan)

    @property
    def delivered(self) -> bool:
        """Whether there is something to judge; an empty or cut answer is a limit of the run."""
        return self.state in (AnswerState.OK, AnswerState.INVALID)
