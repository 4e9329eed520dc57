"""Occurrences of repeated actions in PDDL.

Mandatory occurrences, and a few optional ones, are a chain of once-only operators. Further ones are
one more operator that can be used again and again: it waits until the previous occurrence has
ended, and where there is a greatest number a counter says how many are left.
"""

from __future__ import annotations

from typing import NamedTuple

from irc.problem import Activity

CHAIN_LIMIT = 8
"""The most optional occurrences of an action that are written out; beyond them one is reused."""


class Occurrences(NamedTuple):
    """`least` and `written` once-only operators; `again`: how many further ones (None: endless)."""

    least: int
    written: int
    again: int | None = 0


def occurrences_of(activity: Activity) -> Occurrences:
    """The operators that an activity becomes."""
    details = activity.details
    if details.repeats is None:
        return Occurrences(0 if details.optional else 1, 1)
    least, greatest = details.repeats
    if greatest is None:
        return Occurrences(least, least, None)
    if greatest - least <= CHAIN_LIMIT:
        return Occurrences(least, greatest)
    return Occurrences(least, least, greatest - least)
