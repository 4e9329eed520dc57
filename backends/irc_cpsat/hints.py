"""A list schedule as the solution from which CP-SAT starts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from irc.retime import Placed
    from irc_cpsat.builder import Builder, Model


def add_hint(
    builder: Builder,
    built: Model,
    decisions: Sequence[Any],
    choices: Sequence[tuple[int, ...]],
) -> None:
    """A complete assignment, so that CP-SAT starts from a schedule."""
    for i, decision in enumerate(decisions):
        builder.model.add_hint(built.starts[i], decision.start)
        end = built.ends[i]
        if end is not None:
            builder.model.add_hint(end, decision.end)
        for taken, literals in zip(choices[i], built.literals[i], strict=True):
            for r, literal in literals:
                builder.model.add_hint(literal, int(r == taken))
    for i, size in built.sizes.items():
        builder.model.add_hint(size, decisions[i].end - decisions[i].start)
    for i, literal in built.positive.items():
        builder.model.add_hint(literal, int(decisions[i].end > decisions[i].start))
    hinted = builder.model.proto.solution_hint
    values = dict(zip(hinted.vars, hinted.values, strict=True))
    for both, a, b in builder.both_of:
        builder.model.add_hint(both, values[a.index] * values[b.index])
    latest = max((int(d.end) for d in decisions), default=0)
    builder.model.add_hint(built.makespan, max(latest, builder.problem.bound.value))


def add_earlier(builder: Builder, built: Model) -> None:
    """What an earlier schedule says: an incomplete assignment near to good solutions.

    Starts are pushed to where they may be now; modes and resources are those of before.
    """
    problem = builder.problem
    groups: set[int] = set()
    for i, earlier in enumerate(problem.earlier):
        if earlier is None:
            continue
        activity = problem.activities[i]
        builder.model.add_hint(
            built.starts[i], max(earlier.start, activity.release, problem.heads[i])
        )
        present = built.present[i]
        if present is not None and present.index not in groups:
            groups.add(present.index)
            builder.model.add_hint(present, 1)
        for k, chosen in enumerate(built.modes[i]):
            builder.model.add_hint(chosen, int(k == earlier.mode))
        for claim, choices in zip(activity.claims, built.literals[i], strict=True):
            for r, literal in choices:
                taken = earlier.resources[claim.use] in problem.shared[r].members
                builder.model.add_hint(literal, int(taken))


def add_places(builder: Builder, built: Model, places: Sequence[Placed]) -> None:
    """A schedule of a problem with choices: all that its places say of the model's variables."""
    problem, hints = builder.problem, dict[int, int]()
    for i, (activity, place) in enumerate(zip(problem.activities, places, strict=True)):
        if (present := built.present[i]) is not None:
            hints[present.index] = int(place.present)
        for k, mode in enumerate(built.modes[i]):
            hints[mode.index] = int(place.mode == k)
        for claim, choices in zip(activity.claims, built.literals[i], strict=True):
            taken = place.resources[claim.use] if place.present else None
            for r, literal in choices:
                hints[literal.index] = int(taken in problem.shared[r].members)
        if not place.present:
            continue
        hints[built.starts[i].index] = place.start
        if (end := built.ends[i]) is not None:
            hints[end.index] = place.end
        if i in built.sizes:
            hints[built.sizes[i].index] = place.end - place.start
        if i in built.positive:
            hints[built.positive[i].index] = int(place.end > place.start)
        if built.ranks and (ranks := built.ranks[i]) is not None:
            for variable, rank in zip(ranks, (place.rank, place.end_rank), strict=True):
                hints[variable.index] = rank
    for both, a, b in builder.both_of:
        hints[both.index] = hints.get(a.index, 0) * hints.get(b.index, 0)
    latest = max((place.end for place in places), default=0)
    hints[built.makespan.index] = max(latest, problem.bound.value)
    hint = builder.model.proto.solution_hint
    hint.vars.extend([*hints])
    hint.values.extend([*hints.values()])
