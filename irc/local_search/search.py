"""The local search that fits a problem, behind one interface."""

from __future__ import annotations

from typing import Protocol

from irc.local_search.ways import Found, NotApplicable, Ways, units_of, ways_of
from irc.problem import Problem


class LocalSearch(Protocol):
    """A search that goes on step by step; from the same seed it takes the same steps."""

    def step(self) -> None:
        """Searches on for a little while, counted in moves or in schedules."""

    def give(self, found: Found) -> None:
        """Gives a schedule of somebody else's, from which the search goes on in time."""

    def found(self) -> Found | None:
        """The best schedule so far."""

    @property
    def value(self) -> int | None:
        """The makespan of the best schedule so far, in ticks."""


def search_of(problem: Problem, seed: int = 0, target: int | None = None) -> LocalSearch:
    """The search of a problem, which ends where a schedule ends by `target` (the proven bound).

    Repeats must be unrolled. Raises `irc.local_search.ways.NotApplicable`. Loads numpy, and numba
    where it is installed.
    """
    return search_with(ways_of(problem), seed, target)


def search_with(ways: Ways, seed: int = 0, target: int | None = None) -> LocalSearch:
    """The same for the ways of a problem."""
    least = ways.problem.bounds.makespan.value if target is None else target
    if is_shop(ways):
        from irc.local_search.shop import ShopSearch

        return ShopSearch(ways, seed, least)
    from irc.local_search.project import ProjectSearch

    return ProjectSearch(ways, seed, least)


def is_shop(ways: Ways) -> bool:
    """Whether activities hold one machine each, so that sequences are searched, not lists."""
    try:
        units_of(ways)
    except NotApplicable:
        return False
    return True
