"""The optional groups and actions that an answer leaves out, in words."""

from __future__ import annotations

from collections.abc import Callable

from irc.diagnostics.listing import and_more
from irc.problem import Problem
from irc.schedule import Schedule, Status

NAMES_SHOWN = 12
"""Longer lists end in "and N more"."""


def left_out(problem: Problem, schedule: Schedule) -> list[str]:
    """The ids of the absent groups, then of the absent actions that are in none of them.

    It is empty if there is no answer.
    """
    if schedule.status not in (Status.OPTIMAL, Status.FEASIBLE):
        return []
    present = {entry.id for entry in schedule.entries}
    absent = [i for i, a in enumerate(problem.activities) if a.id not in present]
    gone = set(absent)
    groups = [g for g in problem.groups if not g.required and gone.issuperset(g.members)]
    in_groups = {i for group in groups for i in group.members}
    actions = [problem.activities[i].id for i in absent if i not in in_groups]
    return [*(group.id for group in groups), *actions]


def in_words(names: list[str], visible: Callable[[str], str]) -> str:
    """The line for people: "left out: order2, nap"."""
    return f"left out: {and_more([*map(visible, names[:NAMES_SHOWN])], len(names))}"
