"""Solutions from which CP-SAT starts: a list schedule, a known schedule, or an earlier one."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import Any

from irc.problem.decisions import Decision, Placed
from irc_cpsat.encoding.batches import Loads
from irc_cpsat.encoding.builder import Builder, Hint, Model
from irc_cpsat.encoding.setups import SetupSequence

Takes = Callable[[int, int, int], bool]
"""Whether an activity (index) takes a pool (index) for one of its open demands (number)."""


def add_hints(builder: Builder, built: Model) -> None:
    """Adds the best hint that is known, if any is wanted."""
    problem = builder.problem
    if builder.hint is not None:
        decisions, choices = builder.hint
        _add_assignment(builder, built, decisions, lambda i, c, r: choices[i][c] == r)
        built.hint = builder.hint
    elif problem.previous.warm_start and builder.hints:
        _add_known_schedule(builder, built, problem.previous.warm_start)
    elif any(problem.previous.places) and builder.hints:
        _add_earlier_schedule(builder, built)


def hint_at(builder: Builder, built: Model, found: Hint) -> None:
    """Makes a list schedule the hint, in place of any other."""
    decisions, choices = found
    model: Any = builder.model  # (This method of ortools has no types.)
    model.clear_hints()
    _add_assignment(builder, built, decisions, lambda i, c, r: choices[i][c] == r)
    built.hint = found


def hinted(built: Model) -> Hint | None:
    """The hint of a model as a list schedule, where it names every start and end."""
    hint: Any = built.model.proto.solution_hint
    values = dict(zip(hint.vars, hint.values, strict=True))
    decisions: list[Decision] = []
    choices: list[tuple[int, ...]] = []
    for i, activity in enumerate(built.problem.activities):
        start, end = values.get(built.starts[i].index), built.ends[i]
        until = None if start is None else start + activity.duration_min
        until = until if end is None else values.get(end.index)
        if start is None or until is None:
            return None
        decisions.append(Decision(start, until))
        choices.append(
            tuple(
                next((r for r, x in literals if values.get(x.index)), demand.alternatives[0])
                for demand, literals in zip(activity.open_demands, built.literals[i], strict=True)
            )
        )
    return decisions, choices


def without_hint(built: Model) -> None:
    """Takes the hint out of a model; the schedule stays known as `built.hint`."""
    model: Any = built.model  # (This method of ortools has no types.)
    model.clear_hints()


def _add_assignment(
    builder: Builder, built: Model, places: Sequence[Decision | Placed], takes: Takes
) -> None:
    """Adds a complete assignment, so that CP-SAT starts from a schedule."""
    hints: dict[int, int] = {}
    for i, place in enumerate(places):
        if (present := built.present[i]) is not None:
            hints[present.index] = int(place.present)
        for k, mode in enumerate(built.modes[i]):
            hints[mode.index] = int(place.mode == k)
        if place.present:
            hints[built.starts[i].index] = int(place.start)
            if (end := built.ends[i]) is not None:
                hints[end.index] = int(place.end)
        activity = builder.problem.activities[i]
        for c, (demand, literals) in enumerate(
            zip(activity.open_demands, built.literals[i], strict=True)
        ):
            # (A use of another mode takes nothing.)
            active = place.present and activity.details.use_mode(demand.use) in (None, place.mode)
            for r, literal in literals:
                hints[literal.index] = int(active and takes(i, c, r))
    hints |= _derived(built, places)
    for both, a, b in builder.conjunctions.values():
        hints[both.index] = hints.get(a.index, 0) * hints.get(b.index, 0)
    for sequence in builder.sequences:
        hints |= _sequence_hints(sequence, places, hints)
    for loads in builder.batches:
        hints |= _load_hints(loads, places, hints)
    latest = max((int(place.end) for place in places), default=0)
    hints[built.makespan.index] = max(latest, builder.problem.bounds.makespan.value)
    hint = builder.model.proto.solution_hint
    hint.vars.extend([*hints])
    hint.values.extend([*hints.values()])


def _derived(built: Model, places: Sequence[Decision | Placed]) -> dict[int, int]:
    """The durations and ranks of the activities that are present."""
    hints: dict[int, int] = {}
    for i, size in built.sizes.items():
        if places[i].present:
            hints[size.index] = int(places[i].end - places[i].start)
    for i, positive in built.positive.items():
        if places[i].present:
            hints[positive.index] = int(places[i].end > places[i].start)
    for ranks, place in zip(built.ranks, places, strict=False):
        if ranks is not None and place.present:
            hints[ranks[0].index], hints[ranks[1].index] = place.rank, place.end_rank
    return hints


def _sequence_hints(
    sequence: SetupSequence, places: Sequence[Decision | Placed], hints: Mapping[int, int]
) -> dict[int, int]:
    """The arcs and orders of a circuit, as known places have them."""
    taken = [
        k
        for k, t in enumerate(sequence.takers)
        if places[t.activity].present
        and (t.literal is None or hints.get(t.literal.index, 0))
        and places[t.activity].end > places[t.activity].start
    ]
    order = sorted(taken, key=lambda k: places[sequence.takers[k].activity].start)
    rounds = [0, *(k + 1 for k in order), 0]
    followed = {*pairwise(rounds)}
    found = {arc.index: int(pair in followed) for pair, arc in sequence.arcs.items()}
    if sequence.empty is not None:
        found[sequence.empty.index] = int(not order)
    for (k, after), first in sequence.orders.items():
        if k < after:
            one, other = (places[sequence.takers[n].activity] for n in (k, after))
            found[first.index] = int(one.start <= other.start)
    return found


def _load_hints(
    loads: Loads, places: Sequence[Decision | Placed], hints: Mapping[int, int]
) -> dict[int, int]:
    """Who leads and joins loads, and the order of each two uses, as known places have them."""
    spans = [(places[t.activity].start, places[t.activity].end) for t in loads.takers]
    taken = [
        places[t.activity].present
        and (t.literal is None or bool(hints.get(t.literal.index, 0)))
        and spans[k][0] < spans[k][1]
        for k, t in enumerate(loads.takers)
    ]
    leader: dict[object, int] = {}
    for k, span in enumerate(spans):
        if taken[k]:
            leader.setdefault((span, loads.takers[k].family), k)
    own = [leader.get((span, t.family)) for span, t in zip(spans, loads.takers, strict=True)]
    found = {join.index: int(taken[k] and own[k] == j) for (k, j), join in loads.joins.items()}
    for k, lead in enumerate(loads.leads):
        if lead is not True and lead is not loads.takers[k].literal:
            found[lead.index] = int(taken[k] and own[k] == k)
    for (j, k), literal in loads.orders.items():
        found[literal.index] = int(taken[j] and taken[k] and spans[j][1] <= spans[k][0])
    for (j, k), literal in loads.together.items():
        found[literal.index] = int(taken[j] and taken[k] and spans[j] == spans[k])
    return found


def _add_known_schedule(builder: Builder, built: Model, places: Sequence[Placed]) -> None:
    """Adds a schedule of the problem whose uses are known."""
    problem = builder.problem

    def takes(i: int, c: int, r: int) -> bool:
        taken = places[i].resources[problem.activities[i].open_demands[c].use]
        return taken in problem.contention.pools[r].members

    _add_assignment(builder, built, places, takes)


def _add_earlier_schedule(builder: Builder, built: Model) -> None:
    """Adds an incomplete assignment near to good solutions: the places of the previous plan.

    Starts are pushed to where they may be now; modes and resources are the earlier ones.
    """
    problem = builder.problem
    hinted: set[int] = set()
    for i, place in enumerate(problem.previous.places):
        if place is None:
            continue
        activity = problem.activities[i]
        builder.model.add_hint(
            built.starts[i], max(place.start, activity.release, problem.bounds.heads[i])
        )
        present = built.present[i]
        if present is not None and present.index not in hinted:
            hinted.add(present.index)
            builder.model.add_hint(present, 1)
        for k, chosen in enumerate(built.modes[i]):
            builder.model.add_hint(chosen, int(k == place.mode))
        for demand, choices in zip(activity.open_demands, built.literals[i], strict=True):
            for r, literal in choices:
                taken = place.resources[demand.use] in problem.contention.pools[r].members
                builder.model.add_hint(literal, int(taken))
