"""Selections in PDDL: a counter of the items that are present.

Without a condition the counter has its limits in the goal, and no item begins beyond the greatest
number. "All or none", and a selection that only binds where something else is present, are decided
by a planner-only instant instead: once it has found the right number, no further item begins. Where
the condition is absent, another instant decides the selection, and what it is about cannot begin.

An item begins with the start of the first of its activities, which are present together.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from irc.problem import Problem, Selection
from irc.targets import Refusal
from irc_pddl21.encoding.builder import Builder
from irc_pddl21.encoding.pddl import Additions, NumericCondition, NumericEffect, Operator


@dataclass
class SelectionFacts:
    """The additions of selections to the start of the first activity (by index) of an item."""

    additions: dict[int, list[Additions]] = field(default_factory=dict)

    def of(self, i: int) -> list[Additions]:
        """The additions to the start of an activity."""
        return self.additions.get(i, [])

    def add(self, i: int, additions: Additions) -> None:
        """Adds conditions and effects to the start of an activity."""
        self.additions.setdefault(i, []).append(additions)


def add_selections(builder: Builder) -> SelectionFacts:
    """Adds the counters, instants and goals of all selections that are not decided yet.

    Raises `Refusal` where an item may occur more than once.
    """
    found = SelectionFacts()
    for k, selection in enumerate(builder.problem.selections, start=1):
        _SelectionEncoder(builder, found, selection, k).add()
    return found


def is_certain(problem: Problem, item: tuple[int, ...]) -> bool:
    """Whether activities that are present together are present in any case."""
    return not any(problem.activities[i].details.optional for i in item)


class _SelectionEncoder:
    """Adds one selection, the k-th."""

    def __init__(
        self, builder: Builder, found: SelectionFacts, selection: Selection, k: int
    ) -> None:
        self.builder, self.found, self.selection, self.k = builder, found, selection, k
        items = selection.items
        self.free = [item for item in items if not is_certain(builder.problem, item)]
        self.there = len(items) - len(self.free)
        self.counter = builder.names.new(f"count_of_selection_{k}")

    def add(self) -> None:
        """Adds the counter, and what keeps it within its limits."""
        condition = self.selection.condition
        always = condition is None or is_certain(self.builder.problem, condition)
        if always and not self.selection.all_or_none and not self._limits():
            return
        self._require_single_occurrences()
        self.builder.encoding.counters[self.counter] = self.there
        self.builder.grounded.tokens[self.counter] = f"items of selection {self.k} so far"
        if always and not self.selection.all_or_none:
            self._add_range()
        else:
            self._add_decisions(None if always else condition)

    def _limits(self) -> list[NumericCondition]:
        """The limits on the number of items that are not kept in any case."""
        least, most = self.selection.least, self.selection.most
        limits = []
        if least > self.there:
            limits.append(NumericCondition("start", ">=", self.counter, least))
        if most is not None and most < self.there + len(self.free):
            limits.append(NumericCondition("start", "<=", self.counter, most))
        return limits

    def _add_range(self) -> None:
        most = self.selection.most
        self.builder.encoding.numeric_goal += self._limits()
        needs: tuple[NumericCondition, ...] = ()
        if most is not None and most < self.there + len(self.free):
            needs = (NumericCondition("start", "<=", self.counter, most - 1),)
        self._count(Additions(needs=needs))

    def _add_decisions(self, condition: tuple[int, ...] | None) -> None:
        """Adds the instants that decide the selection."""
        open_ = self._fact(f"open_selection_{self.k}", "no instant has decided it", initially=True)
        decided = self._fact(f"decided_selection_{self.k}", "it is kept")
        self.builder.encoding.goal.append(decided)
        self._count(Additions(at_start=(open_,)))
        everything = self.there + len(self.free)
        ways = [("keep", self._limits())]
        if self.selection.all_or_none:
            ways = [
                ("none_of", [NumericCondition("start", "<=", self.counter, 0)]),
                ("all_of", [NumericCondition("start", ">=", self.counter, everything)]),
            ]
        for verb, needs in ways:
            self._add_instant(f"{verb}_selection_{self.k}", open_, decided, needs)
        if condition is not None:
            met = self._fact(f"met_selection_{self.k}", "its condition may begin", initially=True)
            self.found.add(condition[0], Additions(at_start=(met,)))
            self._add_instant(f"without_selection_{self.k}", met, decided, [])
            begun = self._fact(f"unmet_selection_{self.k}", "it may not apply", initially=True)
            self.found.add(condition[0], Additions(start_deletes=(begun,)))
            self.builder.encoding.operators[-1].at_start.append(begun)

    def _add_instant(
        self, text: str, fact: str, decided: str, needs: list[NumericCondition]
    ) -> None:
        """An instant that decides the selection and takes a fact away."""
        operator = Operator(
            self.builder.names.new(text),
            None,
            at_start=[fact],
            start_deletes=[fact],
            start_adds=[decided],
            needs=needs,
        )
        self.builder.add_helper(operator, f"selection {self.selection.origin + 1} is decided")

    def _fact(self, text: str, meaning: str, *, initially: bool = False) -> str:
        name = self.builder.names.new(text)
        self.builder.grounded.tokens[name] = f"selection {self.selection.origin + 1}: {meaning}"
        return self.builder.fact(name, initially=initially)

    def _count(self, more: Additions) -> None:
        """Counts each item that begins, which needs more besides."""
        counted = NumericEffect(False, self.counter, 1)
        for item in self.free:
            self.found.add(item[0], more._replace(changes=(counted,)))

    def _require_single_occurrences(self) -> None:
        condition = self.selection.condition or ()
        for i in (*(item[0] for item in self.free), *condition[:1]):
            activity = self.builder.problem.activities[i]
            if activity.details.repeats is not None:
                raise Refusal(
                    f"action {activity.id!r} may occur more than once, and a selection counts it; "
                    "target 'pddl21' counts only what occurs at most once",
                    ("select", self.selection.origin),
                    "use target 'cpsat'",
                )
