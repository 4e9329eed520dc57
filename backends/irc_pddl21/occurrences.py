"""How often activities may happen, and what says that they do not.

Occurrences that must be there, and a few optional ones, are a chain of once-only operators. What
may happen more often is one more operator that can be used again and again: it waits until the
occurrence before has ended, and where there is a greatest number a counter of what is left.
"""

from __future__ import annotations

from typing import NamedTuple

from irc.problem import Activity, Problem
from irc_pddl21.orders import AtLeast

CHAIN_LIMIT = 8
"""So many optional occurrences of an action are written out; beyond them one is used again."""


class Occurrences(NamedTuple):
    """`least` and `written` once-only operators; `again`: how many further ones (None: endless)."""

    least: int
    written: int
    again: int | None = 0


def occurrences_of(activity: Activity) -> Occurrences:
    """What becomes of an activity."""
    details = activity.details
    if details.repeats is None:
        return Occurrences(0 if details.optional else 1, 1)
    least, greatest = details.repeats
    if greatest is None:
        return Occurrences(least, least, None)
    if greatest - least <= CHAIN_LIMIT:
        return Occurrences(least, greatest)
    return Occurrences(least, least, greatest - least)


class Absence(NamedTuple):
    """Activities that are absent together; `group`: index, None for one that is on its own."""

    members: tuple[int, ...]
    group: int | None


def absences(problem: Problem, waited_for: list[AtLeast]) -> list[Absence]:
    """What a plan must declare absent: groups, and optional activities that others wait for.

    (What nobody waits for and belongs to no group of several is absent by not happening.)
    """
    followed = {constraint.frm // 2 for constraint in waited_for}
    grouped: set[int] = set()
    found: list[Absence] = []
    for k, group in enumerate(problem.groups):
        if group.required:
            continue
        grouped |= set(group.members)
        if len(group.members) > 1 or followed & set(group.members):
            found.append(Absence(group.members, k))
    for i, activity in enumerate(problem.activities):
        if activity.details.optional and i not in grouped and i in followed:
            found.append(Absence((i,), None))
    return found
