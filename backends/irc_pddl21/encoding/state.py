"""State variables in PDDL: a fact for each value that a condition or a goal names.

An effect deletes the facts of the other values and adds its own, so at most one of a variable's
facts holds. A value that no condition and no goal names needs no fact: taking it is losing the
others.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from irc.problem import Activity, Effect, Problem
from irc.targets import Refusal
from irc_pddl21.encoding.builder import Builder
from irc_pddl21.encoding.names import NameTable

MOST_CHANGES = 200_000
"""The most facts that all effects together may add and delete."""


def add_state(builder: Builder) -> StateFacts:
    """Declares the facts of all variables.

    Raises `Refusal` where the effects would change more than `MOST_CHANGES` facts.
    """
    state = StateFacts(builder.problem, builder.names)
    _refuse_many_changes(builder.problem, state)
    builder.encoding.facts += state.facts.values()
    builder.encoding.initial += state.initial
    builder.grounded.state.update(state.meanings)
    return state


def _refuse_many_changes(problem: Problem, state: StateFacts) -> None:
    changes: Counter[int] = Counter()
    for activity in problem.activities:
        ways = max(1, len(activity.details.modes))
        for effect in activity.details.effects:
            changes[effect.var] += ways * state.values_asked(effect.var)
    if changes.total() > MOST_CHANGES:
        largest, _ = changes.most_common(1)[0]
        variable = problem.variables[largest]
        raise Refusal(
            f"the effects on {variable.id!r}, with its {state.values_asked(largest):,} values, and "
            f"on other variables change {changes.total():,} facts, more than the "
            f"{MOST_CHANGES:,} that target 'pddl21' writes out",
            variable.origin,
            "use fewer values, or target 'cpsat'",
        )


class StateFacts:
    """The facts of a problem's variables, by (variable, value)."""

    def __init__(self, problem: Problem, names: NameTable) -> None:
        asked = set(problem.goals)
        for activity in problem.activities:
            asked.update((c.var, c.value) for c in activity.details.conditions)
        self.facts: dict[tuple[int, int], str] = {}
        self.meanings: dict[str, str] = {}
        self.initial: list[str] = []
        self._of_variable: dict[int, list[int]] = {}
        for v, value in sorted(asked):
            variable = problem.variables[v]
            shown = variable.values[value]
            text = str(shown).lower() if isinstance(shown, bool) else shown
            name = names.new(f"is_{variable.id}_{text}")
            self.facts[v, value] = name
            self.meanings[name] = f"{variable.id!r} is {shown!r}"
            self._of_variable.setdefault(v, []).append(value)
            if variable.initial == value:
                self.initial.append(name)

    def values_asked(self, variable: int) -> int:
        """The number of values of a variable that conditions and goals name."""
        return len(self._of_variable.get(variable, ()))

    def conditions(self, activity: Activity, at: str) -> list[str]:
        """The facts of an activity's conditions at "start", "all" or "end"."""
        return [self.facts[c.var, c.value] for c in activity.details.conditions if c.at == at]

    def effects(self, activity: Activity, at_end: bool) -> tuple[list[str], list[str]]:
        """The facts that one end of an activity adds and deletes."""
        return self._changed(e for e in activity.details.effects if e.at_end == at_end)

    def _changed(self, effects: Iterable[Effect]) -> tuple[list[str], list[str]]:
        adds: list[str] = []
        deletes: list[str] = []
        for effect in effects:
            for value in self._of_variable.get(effect.var, ()):
                changed = adds if value == effect.value else deletes
                changed.append(self.facts[effect.var, value])
        return adds, deletes


def contradicts_itself(activity: Activity, *, instant: bool) -> bool:
    """Whether one happening of an activity gives a variable two values, which is impossible."""
    given: dict[tuple[int, bool], int] = {}
    for effect in activity.details.effects:
        happening = effect.var, effect.at_end and not instant
        if given.setdefault(happening, effect.value) != effect.value:
            return True
    return False
