"""`Problem` → PDDL2.1: parameterless actions, positive conditions only.

Every activity has a fact `todo` that its start takes away and a fact `done` that its end gives.
A precedence is a condition on such facts; a minimum lag is a planner-only *wait* between them; a
maximum lag (or a negative minimum) is a planner-only *envelope*: it must have begun before the
one point and must still run at the other, and it is no longer than the lag. Windows are timed
initial literals. Capacity is one token fact for each unit (measured: numeric counters let a
planner take and give back at one instant, which validators reject); only where tokens would
multiply beyond a budget a counter takes their place, and the re-timed plan is validated anyway.

An optional activity is not in the goal. Where others wait for it, or it belongs to a group, a
planner-only instant *declines* it: it takes all `todo` facts away and gives all `done` facts, so
that it happens before all of the members start or not at all.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from irc.passes.restrict import decide_presence, drop_ample_stock
from irc.problem import Problem
from irc_pddl21.encoding.activities import Elements, add_activities
from irc_pddl21.encoding.arcs import sort_arcs
from irc_pddl21.encoding.builder import Builder
from irc_pddl21.encoding.couplings import add_couplings
from irc_pddl21.encoding.grounded import Grounded, names_of
from irc_pddl21.encoding.numbers import add_numbers
from irc_pddl21.encoding.objectives import add_objective
from irc_pddl21.encoding.precedence import add_precedence
from irc_pddl21.encoding.presence import absences_of, add_absences
from irc_pddl21.encoding.reservoirs import add_reservoirs
from irc_pddl21.encoding.resources import add_resources
from irc_pddl21.encoding.selections import add_selections
from irc_pddl21.encoding.setups import add_setups, counters_of, uses_with_setups
from irc_pddl21.encoding.state import add_state
from irc_pddl21.encoding.time_scale import EPSILON, time_scale
from irc_pddl21.encoding.time_windows import add_time_windows
from irc_pddl21.encoding.work import WorkFacts

DOMAIN_FILE, PROBLEM_FILE = "domain.pddl", "problem.pddl"


def encode(
    problem: Problem,
    epsilon: Fraction = EPSILON,
    *,
    shortened: bool = False,
    limits: Mapping[str, int] | None = None,
) -> Grounded:
    """The problem as operators and facts, for planners with the given epsilon.

    `shortened`: with actions that are shorter by the slack; see `irc_pddl21.decoding.rounding`.
    `limits`: the greatest set-up time (ticks) and cost, by the short names of the objectives.

    Raises `Refusal` where an activity has too many ways to be carried out, or none.
    """
    problem = drop_ample_stock(decide_presence(problem))
    arcs = sort_arcs(problem)
    absences = absences_of(problem, arcs)
    scale = time_scale(
        problem,
        epsilon,
        envelopes=len(arcs.envelopes) + 2 * len(arcs.meetings),
        helpers=len(arcs.waits)
        + len(arcs.envelopes)
        + len(arcs.meetings)
        + len(absences)
        + uses_with_setups(problem)
        + len(problem.selections),
        shortened=shortened,
    )
    builder = Builder(problem, scale)
    add_precedence(builder, arcs)
    add_time_windows(builder)
    units = add_resources(builder)
    objective = add_objective(builder)
    counters = counters_of(builder, objective, limits or {})
    elements = Elements(
        units=units,
        state=add_state(builder),
        levels=add_reservoirs(builder),
        numbers=add_numbers(builder),
        objective=objective,
        couplings=add_couplings(builder, units),
        selections=add_selections(builder),
        setups=add_setups(builder, units, counters),
        work=WorkFacts(builder),
        declined=frozenset(i for absence in absences for i in absence.members),
    )
    add_activities(builder, elements)
    add_absences(builder, absences)
    builder.encoding.goal += [elements.state.goal(*goal) for goal in problem.goals]
    builder.encoding.drop_unused_facts()
    return builder.grounded


def encode_files(problem: Problem) -> tuple[Mapping[str, str], Mapping[str, Any]]:
    """The two PDDL files, and the meaning of their names and numbers for the manifest."""
    grounded = encode(problem)
    files = {
        DOMAIN_FILE: grounded.encoding.domain_text(),
        PROBLEM_FILE: grounded.encoding.problem_text(),
    }
    return files, names_of(grounded)
