"""Reservoirs in PDDL: a counter for each level.

Taking asks for enough before it takes, putting asks for room before it puts. So in the order in
which a planner separates its happenings the level never leaves its limits, and then neither do
the levels of whole instants, which are sums of such happenings.
"""

from __future__ import annotations

from irc.problem import Activity, Problem
from irc_pddl21.encoding.builder import Builder
from irc_pddl21.encoding.names import NameTable
from irc_pddl21.encoding.pddl import Encoding, NumericCondition, NumericEffect


def add_reservoirs(builder: Builder) -> ReservoirLevels:
    """Declares the counters of all reservoirs whose level changes."""
    levels = ReservoirLevels(builder.problem, builder.names, builder.encoding)
    builder.grounded.tokens.update(levels.meanings)
    return levels


class ReservoirLevels:
    """The counter of each reservoir, by index."""

    def __init__(self, problem: Problem, names: NameTable, encoding: Encoding) -> None:
        self.problem = problem
        self.counters: dict[int, str] = {}
        self.meanings: dict[str, str] = {}
        touched = {c.reservoir for a in problem.activities for c in a.details.all_stock}
        for k in sorted(touched):
            reservoir = problem.reservoirs[k]
            name = names.new(f"level_of_{reservoir.id}")
            self.counters[k] = name
            self.meanings[name] = f"what is in {reservoir.id!r}"
            encoding.counters[name] = reservoir.initial

    def of(
        self, activity: Activity, *, instant: bool
    ) -> tuple[list[NumericCondition], list[NumericEffect]]:
        """The conditions of an activity on the levels, and its effects on them.

        Changes of one reservoir at one happening add up (an instant is a single happening).
        """
        nets: dict[tuple[bool, int], int] = {}
        for change in activity.details.stock:
            key = change.at_end and not instant, change.reservoir
            nets[key] = nets.get(key, 0) + change.amount
        needs: list[NumericCondition] = []
        changes: list[NumericEffect] = []
        for (at_end, k), net in sorted(nets.items()):
            reservoir, counter = self.problem.reservoirs[k], self.counters[k]
            when = "end" if at_end else "start"
            if net < 0:
                needs.append(NumericCondition(when, ">=", counter, reservoir.least - net))
            if net > 0 and reservoir.greatest is not None:
                needs.append(NumericCondition(when, "<=", counter, reservoir.greatest - net))
            if net:
                changes.append(NumericEffect(at_end, counter, net))
        return needs, changes
