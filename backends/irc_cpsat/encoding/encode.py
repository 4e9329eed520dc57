"""Encodes a `Problem` as a CP-SAT model.

An activity is an interval; a resource of which only one demand fits at a time is a
`NoOverlap`, any other a `Cumulative`; a choice is one optional interval for each alternative.
An interval of size 0 must be hidden from `NoOverlap` (it could not lie inside another), so an
interval that may have no length is optional there.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from irc.passes.unroll import slots, unroll
from irc.problem import Problem
from irc_cpsat.encoding.activities import add_activities
from irc_cpsat.encoding.batches import add_batches, add_load_work
from irc_cpsat.encoding.builder import Builder, Model
from irc_cpsat.encoding.couplings import add_couplings, add_selections
from irc_cpsat.encoding.happenings import Happenings
from irc_cpsat.encoding.hints import add_hints
from irc_cpsat.encoding.numbers import add_numbers
from irc_cpsat.encoding.objectives import add_makespan, add_objective, values_of
from irc_cpsat.encoding.occurrences import FILE_DEPTH, add_occurrences
from irc_cpsat.encoding.overflow import refuse_overflow
from irc_cpsat.encoding.pools import add_energy, add_pools
from irc_cpsat.encoding.precedence import add_precedence
from irc_cpsat.encoding.presence import add_presence
from irc_cpsat.encoding.reservoirs import add_reservoirs, order_count
from irc_cpsat.encoding.resources import add_resources
from irc_cpsat.encoding.sequences import add_sequences
from irc_cpsat.encoding.setups import add_setup_work, add_setups
from irc_cpsat.encoding.state import add_state
from irc_cpsat.encoding.work import add_work

MODEL_FILE = "model.pbtxt"


def build_model(problem: Problem, *, bounds: bool = True, hints: bool = True) -> Model:
    """The model of a problem; `bounds` and `hints` add what the compiler already knows.

    Of actions that may repeat there are `FILE_DEPTH` occurrences, unless `problem` is unrolled
    already. Raises `Refusal` where sums would not fit 64 bits.
    """
    return write_model(Builder(unroll(problem, FILE_DEPTH), bounds, hints))


def write_model(builder: Builder, *, objective: bool = True) -> Model:
    """Adds all elements to a builder's model; without `objective` any schedule will do.

    Raises `Refusal` where sums would not fit 64 bits.
    """
    refuse_overflow(
        builder.problem,
        builder.safe_horizon,
        builder.rank_count * order_count(builder.problem),
    )
    add_presence(builder)
    add_activities(builder)
    add_precedence(builder)
    add_occurrences(builder)
    literals = add_resources(builder)
    add_work(builder, literals)
    if builder.takers:
        add_setups(builder)
    add_sequences(builder)
    if builder.loads:
        add_batches(builder)
    add_couplings(builder, literals)
    add_selections(builder)
    if builder.bounds:
        add_pools(builder)
    add_reservoirs(builder)
    if builder.problem.has_state:
        happenings = Happenings(builder)
        add_state(builder, happenings)
        add_numbers(builder, happenings)
    makespan = add_makespan(builder)
    if builder.bounds:
        add_energy(builder, makespan)
        if builder.sequences:
            add_setup_work(builder, makespan)
        if builder.batches:
            add_load_work(builder, makespan)
    built = Model(
        model=builder.model,
        problem=builder.problem,
        starts=builder.starts,
        ends=builder.ends,
        makespan=makespan,
        literals=literals,
        sizes=builder.sizes,
        positive=builder.positive,
        present=builder.present,
        modes=builder.modes,
        ranks=builder.ranks,
        values=values_of(builder, makespan, literals),
    )
    if objective:
        add_objective(built)
    add_hints(builder, built)
    return built


def encode_files(problem: Problem) -> tuple[Mapping[str, str], Mapping[str, Any]]:
    """`model.pbtxt`, and which variable (by number) carries which part of the answer."""
    built = build_model(problem)
    first = len(problem.activities)
    names: dict[str, Any] = {
        "makespan": built.makespan.index,
        "actions": {
            activity.id: _variables(built, i) for i, activity in enumerate(problem.activities)
        },
    }
    further = [
        {"action": activity.id, **_variables(built, first + k)}
        for k, activity in enumerate(built.problem.activities[first:])
    ]
    if further:
        names["further"] = further
    if any(slots(a, FILE_DEPTH) != slots(a, FILE_DEPTH + 1) for a in problem.activities):
        names["occurrences"] = FILE_DEPTH
    beyond = problem.objectives[1:]
    if beyond:
        # A model has one objective; the engine solves for the others among its best answers.
        names["objectives_beyond_the_model"] = list(beyond)
    return {MODEL_FILE: str(built.model.proto)}, names


def _variables(built: Model, i: int) -> dict[str, Any]:
    problem, activity = built.problem, built.problem.activities[i]
    shown: dict[str, Any] = {"start": built.starts[i].index}
    end = built.ends[i]
    if end is None:
        shown["duration"] = activity.duration_min
    else:
        shown["end"] = end.index
    choices = {
        str(demand.use): {problem.contention.pools[r].id: literal.index for r, literal in literals}
        for demand, literals in zip(activity.open_demands, built.literals[i], strict=True)
        if literals
    }
    if choices:
        shown["choices"] = choices
    if (present := built.present[i]) is not None:
        shown["present"] = present.index
    if built.modes[i]:
        shown["modes"] = {
            mode.id: literal.index
            for mode, literal in zip(activity.details.modes, built.modes[i], strict=True)
        }
    if (ranks := built.ranks[i] if built.ranks else None) is not None:
        shown["ranks"] = [rank.index for rank in ranks]
    return shown
