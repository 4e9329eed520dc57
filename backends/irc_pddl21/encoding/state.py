"""State variables in PDDL: a fact for each value that a condition or a goal names.

An effect deletes the facts of the other values and adds its own, so at most one of a variable's
facts holds. A value that no condition and no goal names needs no fact: taking it is losing the
others.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from irc.problem import Activity, Effect, Problem, TimedChange
from irc.targets import Refusal
from irc_pddl21.encoding.builder import Builder
from irc_pddl21.encoding.names import NameTable
from irc_pddl21.encoding.pddl import TimedLiteral

MOST_CHANGES = 200_000
"""The most facts that all effects together may add and delete."""


def add_state(builder: Builder) -> StateFacts:
    """Declares the facts of all variables, and their timed changes as timed initial literals.

    Raises `Refusal` where the effects would change more than `MOST_CHANGES` facts.
    """
    state = StateFacts(builder.problem, builder.names)
    _refuse_many_changes(builder.problem, state)
    builder.encoding.facts += [name for facts in state.facts.values() for name in facts]
    builder.encoding.initial += state.initial
    builder.grounded.state.update(state.meanings)
    for v, variable in enumerate(builder.problem.variables):
        for change in variable.changes:
            state.add_change(builder, v, change)
    return state


def _refuse_many_changes(problem: Problem, state: StateFacts) -> None:
    changes: Counter[int] = Counter()
    for activity in problem.activities:
        for way in activity.details.ways:
            for effect in way.effects:
                changes[effect.var] += state.values_asked(effect.var)
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
    """The facts of a problem's variables, by (variable, value).

    A variable that the world changes has two facts for a value: the first says what starts find,
    the second what must hold meanwhile and what ends find. At the time of a change starts find the
    new value at once, and ends, which may be an epsilon late, the old one for a slack longer.
    """

    def __init__(self, problem: Problem, names: NameTable) -> None:
        asked = set(problem.goals)
        for activity in problem.activities:
            asked.update((c.var, c.value) for c in activity.details.all_conditions)
        self.facts: dict[tuple[int, int], tuple[str, ...]] = {}
        self.meanings: dict[str, str] = {}
        self.initial: list[str] = []
        self._of_variable: dict[int, list[int]] = {}
        for v, value in sorted(asked):
            variable = problem.variables[v]
            shown = variable.values[value]
            text = str(shown).lower() if isinstance(shown, bool) else shown
            name = names.new(f"is_{variable.id}_{text}")
            facts = [name]
            if variable.changes:
                facts.append(names.new(f"still_{variable.id}_{text}"))
            self.facts[v, value] = tuple(facts)
            for fact in facts:
                self.meanings[fact] = f"{variable.id!r} is {shown!r}"
            self._of_variable.setdefault(v, []).append(value)
            at_first = next((c.value for c in variable.changes if c.at == 0), variable.initial)
            if at_first == value:
                self.initial += facts

    def add_change(self, builder: Builder, v: int, change: TimedChange) -> None:
        """Adds the timed initial literals of a change; those of t = 0 are initial facts."""
        if change.at == 0:
            return
        time = change.at * builder.scale.units_per_tick
        for value in self._of_variable.get(v, ()):
            start, still = self.facts[v, value]
            if value == change.value:
                builder.encoding.timed += [TimedLiteral(time, f, True) for f in (start, still)]
            else:
                late = time + builder.scale.slack
                builder.encoding.timed.append(TimedLiteral(time, start, False))
                builder.encoding.timed.append(TimedLiteral(late, still, False))

    def values_asked(self, variable: int) -> int:
        """The number of values of a variable that conditions and goals name."""
        return len(self._of_variable.get(variable, ()))

    def conditions(self, activity: Activity, at: str) -> list[str]:
        """The facts of an activity's conditions at "start", "all" or "end"."""
        early = at == "start" or not activity.duration_max
        return [
            self.facts[c.var, c.value][0 if early else -1]
            for c in activity.details.conditions
            if c.at == at
        ]

    def goal(self, var: int, value: int) -> str:
        """The fact of a goal."""
        return self.facts[var, value][0]

    def effects(self, activity: Activity, at_end: bool) -> tuple[list[str], list[str]]:
        """The facts that one end of an activity adds and deletes."""
        return self._changed(e for e in activity.details.effects if e.at_end == at_end)

    def _changed(self, effects: Iterable[Effect]) -> tuple[list[str], list[str]]:
        adds: list[str] = []
        deletes: list[str] = []
        for effect in effects:
            for value in self._of_variable.get(effect.var, ()):
                changed = adds if value == effect.value else deletes
                changed += self.facts[effect.var, value]
        return adds, deletes


def contradicts_itself(activity: Activity, *, instant: bool) -> bool:
    """Whether one happening of an activity gives a variable two values, which is impossible."""
    given: dict[tuple[int, bool], int] = {}
    for effect in activity.details.effects:
        happening = effect.var, effect.at_end and not instant
        if given.setdefault(happening, effect.value) != effect.value:
            return True
    return False
