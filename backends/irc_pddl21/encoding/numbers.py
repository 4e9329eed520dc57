"""Number variables in PDDL: a numeric fluent for each (PDDL2.1, Fox and Long 2003, level 2).

Conditions are comparisons, effects `increase`, `decrease` and `assign`. Adding asks for room within
the bounds before it adds, so in the order in which a planner separates its happenings the level
never leaves them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from irc.problem import Activity, NumberCondition, NumberEffect, Problem, together
from irc.targets import Refusal
from irc_pddl21.encoding.builder import Builder
from irc_pddl21.encoding.pddl import NumericCondition, NumericEffect

LARGEST = 2**53
"""Planners keep fluents in doubles, which hold whole numbers up to this one exactly."""


def add_numbers(builder: Builder) -> NumberFluents:
    """Declares the fluents of all numbers, and adds the goals on them.

    Raises `Refusal` for levels that no planner holds exactly.
    """
    fluents = NumberFluents(builder)
    for goal in builder.problem.number_goals:
        builder.encoding.numeric_goal += fluents.compared(goal.number, goal.least, goal.greatest)
    return fluents


def _refuse(problem: Problem) -> None:
    for k, number in enumerate(problem.numbers):
        moved = abs(number.initial) + abs(number.least or 0) + abs(number.greatest or 0)
        for activity in problem.activities:
            details = activity.details
            moved += sum(abs(e.amount) for e in details.all_number_effects if e.number == k)
        if moved >= LARGEST:
            raise Refusal(
                f"the levels of number variable {number.id!r} are beyond what planners hold",
                number.origin,
                "count it in larger units, round its levels, or use target 'cpsat'",
            )


class NumberFluents:
    """The fluent of each number, by index."""

    def __init__(self, builder: Builder) -> None:
        self.problem = builder.problem
        _refuse(self.problem)
        self.names = [builder.names.new(f"level_of_{n.id}") for n in self.problem.numbers]
        for name, number in zip(self.names, self.problem.numbers, strict=True):
            builder.encoding.counters[name] = number.initial
            scaled = "" if number.scale == 1 else f", times {number.scale}"
            builder.grounded.tokens[name] = f"the level of {number.id!r}{scaled}"

    def compared(
        self, k: int, least: int | None, greatest: int | None, when: str = "end"
    ) -> Iterator[NumericCondition]:
        """The comparisons that keep a number within limits."""
        name = self.names[k]
        if least is not None and least == greatest:
            yield NumericCondition(when, "=", name, least)
            return
        if least is not None:
            yield NumericCondition(when, ">=", name, least)
        if greatest is not None:
            yield NumericCondition(when, "<=", name, greatest)

    def of(
        self, activity: Activity, *, instant: bool
    ) -> tuple[list[NumericCondition], list[NumericEffect]]:
        """The conditions of an activity on numbers, and its effects on them."""
        details = activity.details
        needs: list[NumericCondition] = []
        for condition in details.number_conditions:
            needs += self._asked(condition)
        changes: list[NumericEffect] = []
        for effect in at_happenings(details.number_effects, instant=instant):
            name, number = self.names[effect.number], self.problem.numbers[effect.number]
            when = "end" if effect.at_end else "start"
            if effect.sets:
                changes.append(NumericEffect(effect.at_end, name, effect.amount, sets=True))
                continue
            if effect.amount < 0 and number.least is not None:
                needs.append(NumericCondition(when, ">=", name, number.least - effect.amount))
            if effect.amount > 0 and number.greatest is not None:
                needs.append(NumericCondition(when, "<=", name, number.greatest - effect.amount))
            if effect.amount:
                changes.append(NumericEffect(effect.at_end, name, effect.amount))
        return list(dict.fromkeys(needs)), changes

    def _asked(self, condition: NumberCondition) -> Iterator[NumericCondition]:
        return self.compared(condition.number, condition.least, condition.greatest, condition.at)


def at_happenings(effects: Iterable[NumberEffect], *, instant: bool) -> tuple[NumberEffect, ...]:
    """Effects on numbers by happening: an instant has all of them at its only one."""
    return together(e._replace(at_end=False) if instant else e for e in effects)


def gives_two_levels(problem: Problem, activity: Activity, *, instant: bool) -> bool:
    """Whether one happening gives a number two levels, or one outside its bounds."""
    seen: dict[tuple[int, bool], NumberEffect] = {}
    for effect in at_happenings(activity.details.number_effects, instant=instant):
        if effect.sets and not problem.numbers[effect.number].allows(effect.amount):
            return True
        first = seen.setdefault((effect.number, effect.at_end), effect)
        if first is not effect:
            return True
    return False
