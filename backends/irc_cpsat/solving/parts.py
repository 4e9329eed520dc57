"""Fewer moves by CP-SAT on one small part of a schedule after another, all else where it is.

A model of a large task with the number of moves as its objective is too much for CP-SAT within
seconds, while a part of it is solved in a fraction of one. A part is what is near a moved activity
in time: what has to make room for it at its previous place, and what follows from that. It gets a
schedule in which fewer activities move, or is proven to have none.

Source: P. Shaw, "Using constraint programming and local search methods to solve vehicle routing
problems", CP 1998 (large neighbourhood search).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from ortools.sat.python import cp_model

from irc.passes.serial_sgs import moved_in
from irc.targets import Budget
from irc_cpsat.encoding.builder import Hint, Model
from irc_cpsat.encoding.hints import hinted
from irc_cpsat.solving.asking import asked
from irc_cpsat.solving.hinting import hint_all
from irc_cpsat.solving.solution import FoundSolution

SIZES = (40, 80, 160)
"""The activities of a part; larger ones follow where no part of a size helps any more."""

PART_SECONDS = 1.0
"""The time for a part at most."""


Solver = Callable[[], cp_model.CpSolver]


def improve_parts(built: Model, solver: Solver, budget: Budget) -> FoundSolution | None:
    """A solution with fewer moves than the hint of a model, whose hint it is then; None: none.

    The model's objective is the number of moves, and its activities have fixed durations.
    """
    best: FoundSolution | None = None
    for size in SIZES:
        while (found := _sweep(built, solver, size, budget)) is not None:
            best = found
    return best


def _sweep(built: Model, solver: Solver, size: int, budget: Budget) -> FoundSolution | None:
    """Frees one part after another, until each moved activity was in one; what is found last."""
    best, seen = None, set[int]()
    while not budget.is_over and (known := hinted(built)) is not None:
        moved = [i for i in _moved(built, known) if i not in seen]
        if not moved:
            break
        part = _part(built, known, moved[0], size)
        seen |= part
        found = _improved(built, known, part, solver(), budget.at_most(PART_SECONDS))
        if found is not None:
            best = found
            hint_all(built, found.all_values)
    return best


def _moved(built: Model, known: Hint) -> list[int]:
    """The moved activities, in the order of their starts."""
    places, decisions = built.problem.previous.places, known[0]
    found = [i for i, place in enumerate(places) if place and place.start != decisions[i].start]
    return sorted(found, key=lambda i: (decisions[i].start, i))


def _part(built: Model, known: Hint, moved: int, size: int) -> set[int]:
    """The activities nearest in time to where one is and was before."""
    spans = [[*_spans(built, known, i)] for i in range(len(built.problem.activities))]
    first = min(begin for begin, _ in spans[moved])
    last = max(end for _, end in spans[moved])
    free = [i for i, a in enumerate(built.problem.activities) if a.start is None]

    def order(i: int) -> tuple[int, bool, int, int]:
        away = min(max(0, begin - last, first - end) for begin, end in spans[i])
        return away, len(spans[i]) == 1, abs(spans[i][0][0] - spans[moved][0][0]), i

    return {moved, *sorted(free, key=order)[:size]}


def _spans(built: Model, known: Hint, i: int) -> Iterator[tuple[int, int]]:
    """The times of an activity in a schedule and, where they differ, in the previous plan."""
    decision, place = known[0][i], built.problem.previous.places[i]
    start, end = int(decision.start), int(decision.end)
    yield start, end
    if place is not None and place.start != start:
        yield place.start, place.start + end - start


def _improved(
    built: Model, known: Hint, part: set[int], solver: cp_model.CpSolver, budget: Budget
) -> FoundSolution | None:
    """A solution with fewer moves than a known one in which all but a part is where it was."""
    hint: Any = built.model.proto.solution_hint
    values = dict(zip(hint.vars, hint.values, strict=True))
    model = built.model.clone()
    variables: Any = model.proto.variables
    for index in values.keys() & _stay(built, part):
        domain = variables[index].domain
        domain.clear()
        domain.extend([values[index]] * 2)
    model.add(built.values["changes"] < moved_in(built.problem, known))
    # (Nearly all is fixed: to look for more in the model takes longer than to search the part.)
    solver.parameters.cp_model_probing_level = 0
    solver.parameters.linearization_level = 0
    solver.parameters.symmetry_level = 0
    status = asked(solver, model, budget)
    if status not in (cp_model.OPTIMAL, cp_model.FEASIBLE):
        return None
    return FoundSolution(solver.response_proto)


def _stay(built: Model, part: set[int]) -> set[int]:
    """The variables of the starts and the pools of all activities but those of a part."""
    found = set[int]()
    for i, start in enumerate(built.starts):
        if i in part or built.problem.activities[i].start is not None:
            continue
        found.add(start.index)
        for literals in built.literals[i]:
            found.update(literal.index for _, literal in literals)
    return found
