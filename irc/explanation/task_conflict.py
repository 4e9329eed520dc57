"""Finds conflicts of a whole task: elements are left out as long as the rest has no schedule.

Each trial is a task of its own: read, checked, and solved until there is any schedule. So a
conflict may be about anything that the solver's target takes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import groupby

from irc.checks import run_checks
from irc.diagnostics import Findings
from irc.driver.solve import solve_task
from irc.explanation.elements import ORDER, Element, document_of, elements_of, without
from irc.explanation.minimise import Conflict, Possibility, Trial, minimise
from irc.model import Task
from irc.model.from_document import to_task
from irc.problem import Problem
from irc.problem.horizon import safe_horizon
from irc.schedule import Status
from irc.targets import Budget, Cancellation, SolveOptions


def task_conflict(
    task: Task, problem: Problem, target: str, budget: Budget
) -> Conflict[Element] | None:
    """A minimal conflict among the elements of a task that has no schedule.

    None if the elements alone do not show that there is none. `problem` is the lowered task, and
    `target` has the solver. If the budget ends during the search, the conflict may not be minimal.
    """
    return _Search(task, problem, target, budget).conflict()


@dataclass
class _Search:
    task: Task
    problem: Problem
    target: str
    budget: Budget
    known: dict[frozenset[Element], Trial[Element]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        longest = 2 * self.problem.to_units(safe_horizon(self.problem))
        self.document = document_of(self.task)
        self.all = [
            element
            for element in elements_of(self.task, self.document, f"{longest}")
            if to_task(without(self.document, [element]), Findings()) is not None
        ]
        # What may also help is left out only at the end, one by one.
        self.relaxing = [element for element in self.all if element.relaxes]
        self.others = frozenset(self.all) - frozenset(self.relaxing)

    def conflict(self) -> Conflict[Element] | None:
        relaxing = self.relaxing
        if self.attempt(frozenset(relaxing)).result is not Possibility.IMPOSSIBLE:
            return None
        families = self._families(relaxing)
        conflict = minimise(relaxing, self.attempt, relaxing, families, budget=self.budget)
        return replace(conflict, statements=(*conflict.statements, *self._contributing(conflict)))

    def _contributing(self, conflict: Conflict[Element]) -> list[Element]:
        """The elements that may help elsewhere, but without which the others can hold together."""
        kept = frozenset(conflict.statements)
        return [
            other
            for other in sorted(self.others, key=lambda element: element.pointer)
            if self._possibility(kept | (self.others - {other})) is Possibility.POSSIBLE
        ]

    def _families(self, elements: Sequence[Element]) -> list[list[frozenset[Element]]]:
        """Elements to be left out together first: those of an action or resource, and of a kind."""
        by_owner = sorted(elements, key=lambda e: e.of)
        by_kind = sorted(elements, key=lambda e: ORDER.index(e.kind))
        return [
            [frozenset(group) for _, group in groupby(by_owner, key=lambda e: e.of)],
            [frozenset(group) for _, group in groupby(by_kind, key=lambda e: e.kind)],
        ]

    def attempt(self, kept: frozenset[Element]) -> Trial[Element]:
        """Whether the elements can hold together, beside all that do not only restrict."""
        trial = self.known.get(kept)
        if trial is None:
            trial = self.known[kept] = Trial(self._possibility(kept | self.others))
        return trial

    def _possibility(self, kept: frozenset[Element]) -> Possibility:
        if self.budget.is_over:
            return Possibility.UNKNOWN
        rest = [element for element in self.all if element not in kept]
        task = to_task(without(self.document, rest), Findings())
        if task is None:
            return Possibility.UNKNOWN
        checked = run_checks(task, lint=False)
        if not checked.report.ok:
            proven = checked.report.contradicts
            return Possibility.IMPOSSIBLE if proven else Possibility.UNKNOWN
        return self._solved(task)

    def _solved(self, task: Task) -> Possibility:
        """Whether a task has a schedule: the first one ends the search."""
        found = Cancellation(self.budget.cancel)
        options = SolveOptions(
            self.target,
            time_limit=None,
            workers=1,
            seed=0,
            on_progress=lambda progress: found.cancel(),
        )
        status = solve_task(task, options, self.budget.ended_by(found)).schedule.status
        if status is Status.INFEASIBLE:
            return Possibility.IMPOSSIBLE
        has_schedule = status in (Status.OPTIMAL, Status.FEASIBLE)
        return Possibility.POSSIBLE if has_schedule else Possibility.UNKNOWN
