"""How the searches for one problem differ where several processes search for it at once.

Each has a seed of its own. The first one is what a search alone would be. With one thread each, the
others give local search all of their time where it knows the problem, but for every third, which
proves: it gives CP-SAT all of the time. From the third on, CP-SAT has parameters of another family
each.
"""

from __future__ import annotations

from ortools.sat.python import cp_model

from irc.targets import Part

SINGLE_SHARE = 0.5
SINGLE_SECONDS = 30.0
"""With one worker, the part of the time that local search gets, and the most, before CP-SAT."""

PROVES = 3
"""Every third process proves."""

FAMILIES: tuple[dict[str, object], ...] = (
    {},
    {"linearization_level": 2},
    {"optimize_with_lb_tree_search": True},
    {"use_objective_lb_search": True},
    {"linearization_level": 0},
)
"""Parameters of CP-SAT that lead it to other searches; none changes what is a solution."""


def search_limits(part: Part | None) -> tuple[float, float, bool]:
    """(share of the time, seconds, whether at once) of local search, with one worker.

    Where it does not begin at once, CP-SAT is alone first; after it, CP-SAT has the rest.
    """
    if part is None or part.number == 0:
        return SINGLE_SHARE, SINGLE_SECONDS, False
    if part.number % PROVES == PROVES - 1:
        return 0.0, 0.0, False
    return 1.0, float("inf"), True


def vary(solver: cp_model.CpSolver, part: Part) -> None:
    """Sets the parameters of a part's family."""
    family = FAMILIES[max(0, part.number - 1) % len(FAMILIES)]
    for name, value in family.items():
        setattr(solver.parameters, name, value)
