"""Leaves out ground actions that can never happen, false conditions included."""

from __future__ import annotations

from collections.abc import Container, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction

from irc.frontends.importers.pddl.formula import Atom
from irc.frontends.importers.pddl.ground_action import Ground
from irc.frontends.importers.pddl.lifted import Fact


@dataclass
class _Phase:
    """A start or an end that becomes possible when all of its conditions are reached."""

    waiting: int
    gives: list[Atom]
    action: int | None
    """The action that is possible with this; None for a start, whose end must be possible too."""


def reachable(
    actions: Sequence[Ground],
    initial: Iterable[Fact],
    timed: Iterable[tuple[Fraction, Fact, bool]],
    numeric: Container[Fact] = (),
) -> list[Ground]:
    """The actions that could happen if nothing were ever undone, in time linear in their size.

    The effects of a start need only its start conditions, so that two actions may each need an
    effect of the other's start. Numbers, of which the `numeric`
    facts speak, are taken to suit.
    """
    phases: list[_Phase] = []
    waiting: dict[Atom, list[int]] = {}
    ready: list[int] = []

    def add(needs: set[Atom], gives: list[Atom], action: int | None) -> None:
        for atom in needs:
            waiting.setdefault(atom, []).append(len(phases))
        if not needs:
            ready.append(len(phases))
        phases.append(_Phase(len(needs), gives, action))

    for number, action in enumerate(actions):
        tests = [(when, test) for when, test in action.conditions if test.fact not in numeric]
        at_start = {atom for when, atom in tests if when == "start"}
        add(at_start, [atom for when, atom in action.atoms if when == "start"], None)
        every = {atom for _, atom in tests}
        add(every, [atom for when, atom in action.atoms if when == "end"], number)
    reached: set[Atom] = set()
    possible: set[int] = set()

    def reach(atom: Atom) -> None:
        if atom in reached:
            return
        reached.add(atom)
        for index in waiting.get(atom, ()):
            phases[index].waiting -= 1
            if phases[index].waiting == 0:
                ready.append(index)

    true_at_first = set(initial)
    for fact in true_at_first:
        reach(Atom(fact, True))
    for atom in [atom for atom in waiting if not atom.value]:
        if atom.fact not in true_at_first:
            reach(atom)
    for _, fact, value in timed:
        reach(Atom(fact, value))
    while ready:
        phase = phases[ready.pop()]
        if phase.action is not None:
            possible.add(phase.action)
        for atom in phase.gives:
            reach(atom)
    return [action for number, action in enumerate(actions) if number in possible]
