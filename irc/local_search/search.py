"""The local search that fits a problem, behind one interface."""

from __future__ import annotations

from typing import Protocol

from irc.local_search.listing import least_value, listing_of, may_list
from irc.local_search.ways import (
    LARGE,
    MOST_OF_A_PROJECT,
    Found,
    NotApplicable,
    NotInTime,
    Ways,
    knows,
    units_of,
    ways_of,
)
from irc.local_search.ways import may_apply as _knows_ways
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
        """The first objective of the best schedule so far, in its whole numbers."""


def may_apply(problem: Problem) -> bool:
    """Whether nothing but single activities could rule local search out; a quick test."""
    return _knows_ways(problem) or may_list(problem)


LISTS_FROM = 40
"""Of fewer activities CP-SAT soon has a good schedule, before the search would be loaded."""


def begins_with_lists(problem: Problem) -> bool:
    """Whether to search lists for a while before anything else: compiled, of a large problem."""
    if len(problem.activities) < LISTS_FROM or not may_list(problem) or knows(problem):
        return False
    from irc.local_search.compiled import IS_COMPILED

    return IS_COMPILED


def is_large(problem: Problem) -> bool:
    """Whether to search alone, without a solver beside: large, and with a search that fits."""
    if len(problem.activities) < LARGE or problem.objectives != ("makespan",):
        return False
    if not _knows_ways(problem) or any(problem.previous.places):
        return False
    from irc.local_search.compiled import IS_COMPILED

    return IS_COMPILED


def search_of(
    problem: Problem,
    seed: int = 0,
    target: int | None = None,
    *,
    steady: bool = False,
    seconds: float | None = None,
) -> LocalSearch:
    """The search of a problem, which ends where a schedule's value is `target`.

    Without a target it is a proven bound. A `steady` one does as much in a step without llvmlite as
    with it. Repeats must be unrolled. Raises `irc.local_search.ways.NotApplicable`, and `NotInTime`
    where the loops of a search are not compiled within some `seconds`. Loads numpy, and llvmlite
    where it is installed.
    """
    if _knows_ways(problem):
        try:
            return search_with(ways_of(problem), seed, target, steady=steady, seconds=seconds)
        except NotInTime:
            raise
        except NotApplicable:
            pass  # The search over lists knows more about single activities.
    listing = listing_of(problem)
    from irc.local_search.list_search import ListSearch

    _compile("lists", seconds)
    least = least_value(problem) if target is None else target
    return ListSearch(listing, seed, least, steady=steady)


def search_with(
    ways: Ways,
    seed: int = 0,
    target: int | None = None,
    *,
    steady: bool = False,
    seconds: float | None = None,
) -> LocalSearch:
    """The same for ways. Raises `NotApplicable` for a project that is too large.

    Of a large project, windows are searched, unless stock is used up or it is steady.
    """
    least = ways.problem.bounds.makespan.value if target is None else target
    if is_shop(ways):
        if len(ways.of) >= LARGE and not steady:
            from irc.local_search.shop_windows import ShopWindows

            return ShopWindows(ways, seed, least)
        from irc.local_search.shop import ShopSearch

        _compile("tabu", seconds)
        return ShopSearch(ways, seed, least, steady=steady)
    if len(ways.of) >= LARGE and not ways.stock and not steady:
        from irc.local_search.project_windows import ProjectWindows

        return ProjectWindows(ways, seed, least)
    if len(ways.of) > MOST_OF_A_PROJECT:
        raise NotApplicable("it has too many activities for a search of the whole project")
    from irc.local_search.project import ProjectSearch

    _compile("genetic", seconds)
    return ProjectSearch(ways, seed, least, steady=steady)


def _compile(loops: str, seconds: float | None) -> None:
    """Compiles the loops of a search. Raises `NotInTime`."""
    from irc.local_search.compiled import compile_within

    if seconds is not None and not compile_within(f"irc.local_search.{loops}", seconds):
        raise NotInTime("its search is not compiled in time")


def is_shop(ways: Ways) -> bool:
    """Whether activities hold one machine each, so that sequences are searched, not lists."""
    try:
        units_of(ways)
    except NotApplicable:
        return False
    return True
