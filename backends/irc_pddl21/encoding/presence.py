"""Presence in PDDL: planner-only instants that decline groups and optional activities."""

from __future__ import annotations

from typing import NamedTuple

from irc.problem import Problem
from irc_pddl21.encoding.arcs import SortedArcs
from irc_pddl21.encoding.builder import Builder
from irc_pddl21.encoding.pddl import Operator


class Absence(NamedTuple):
    """Activities that are absent together; `group`: index, None for a single activity."""

    members: tuple[int, ...]
    group: int | None


def absences_of(problem: Problem, arcs: SortedArcs) -> list[Absence]:
    """The absences that a plan must declare: of groups, and of activities that others wait for.

    (An activity that nothing waits for, in no group of several, is absent by not happening.)
    """
    awaited = arcs.awaited
    grouped: set[int] = set()
    found: list[Absence] = []
    for k, group in enumerate(problem.groups):
        if group.required:
            continue
        grouped |= set(group.members)
        if len(group.members) > 1 or awaited & set(group.members):
            found.append(Absence(group.members, k))
    for i, activity in enumerate(problem.activities):
        if activity.details.optional and i not in grouped and i in awaited:
            found.append(Absence((i,), None))
    return found


def add_absences(builder: Builder, absences: list[Absence]) -> None:
    """Adds an instant for each absence, with which a planner declines its members."""
    for absence in absences:
        _add_absence(builder, absence)


def _add_absence(builder: Builder, absence: Absence) -> None:
    if absence.group is None:
        first = absence.members[0]
        described = f"action {builder.problem.activities[first].id!r}"
        text = f"skip_{builder.base[first]}"
    else:
        group = builder.problem.groups[absence.group]
        described, text = f"group {group.id!r}", f"decline_{group.id}"
    name = builder.names.new(text)
    todo = [f"todo_{builder.base[i]}" for i in absence.members]
    given: list[str] = []
    for i in absence.members:
        given += [f"done_{builder.base[i]}", *builder.lag_facts.get(i, ())]
        given += [f"begun_{builder.base[i]}"] if i in builder.begun else []
    operator = Operator(name, None, at_start=todo, start_deletes=todo, start_adds=given)
    builder.add_helper(operator, f"{described} is absent")
