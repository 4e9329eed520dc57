"""What an engine chose, as a problem of only that.

Absent activities are gone, and with them the arcs that would bind them; a chosen mode has become
the activity's duration, and the uses of other modes are gone. So nothing behind this has to know
of presence or modes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from irc.problem import Activity, PreviousPlace, Problem
from irc.problem.decisions import ABSENT_PLACE, AnswerError, Decision, Placed


@dataclass(frozen=True, slots=True)
class Selection:
    """The present activities of a problem.

    `kept[k]` is the index that activity k has in the whole problem; `uses[k]` says the same of
    each of its uses.
    """

    problem: Problem
    decisions: tuple[Decision, ...]
    kept: tuple[int, ...]
    uses: tuple[tuple[int, ...], ...]

    def spread(self, whole: Problem, placed: Sequence[Placed]) -> tuple[Placed, ...]:
        """Places in the selection → places in the whole problem."""
        places = [ABSENT_PLACE] * len(whole.activities)
        for k, (i, place) in enumerate(zip(self.kept, placed, strict=True)):
            resources: list[int | None] = [None] * len(whole.activities[i].uses)
            for u, r in zip(self.uses[k], place.resources, strict=True):
                resources[u] = r
            places[i] = replace(place, resources=tuple(resources), mode=self.decisions[k].mode)
        return tuple(places)


def select(problem: Problem, decisions: Sequence[Decision]) -> Selection:
    """The activities that the decisions say are present, in the modes they say.

    Raises `AnswerError` where a mode is missing or unknown.
    """
    kept = [i for i, d in enumerate(decisions) if d.present]
    place = {i: k for k, i in enumerate(kept)}
    uses = [_uses(problem.activities[i], decisions[i]) for i in kept]
    selected = replace(
        problem,
        activities=tuple(
            _in_mode(problem.activities[i], decisions[i], u)
            for i, u in zip(kept, uses, strict=True)
        ),
        arcs=tuple(
            a._replace(before=place[a.before], after=place[a.after])
            for a in problem.arcs
            if a.before in place and a.after in place
        ),
        state_precedences=tuple(
            (place[a], place[b]) for a, b in problem.state_precedences if a in place and b in place
        ),
        contention=replace(problem.contention, fixed_choices=_settled(problem, place, uses)),
        previous=replace(problem.previous, places=_earlier(problem, kept, uses)),
    )
    return Selection(
        selected,
        tuple(_with_uses(decisions[i], u) for i, u in zip(kept, uses, strict=True)),
        tuple(kept),
        tuple(uses),
    )


def _uses(activity: Activity, decision: Decision) -> tuple[int, ...]:
    """Which of an activity's uses apply."""
    details = activity.details
    if not details.modes:
        return tuple(range(len(activity.uses)))
    if decision.mode is None or not 0 <= decision.mode < len(details.modes):
        raise AnswerError(f"the answer says no mode of {activity.id!r}")
    return tuple(
        u for u in range(len(activity.uses)) if details.use_mode(u) in (None, decision.mode)
    )


def _in_mode(activity: Activity, decision: Decision, uses: tuple[int, ...]) -> Activity:
    if not activity.details.modes or decision.mode is None:
        return activity
    mode = activity.details.modes[decision.mode]
    return replace(
        activity,
        duration_min=mode.duration_min,
        duration_max=mode.duration_max,
        uses=tuple(activity.uses[u] for u in uses),
    )


def _with_uses(decision: Decision, uses: tuple[int, ...]) -> Decision:
    if len(uses) == len(decision.chosen) or not decision.chosen:
        return decision
    return replace(decision, chosen=tuple(decision.chosen[u] for u in uses))


def _earlier(
    problem: Problem, kept: Sequence[int], uses: Sequence[tuple[int, ...]]
) -> tuple[PreviousPlace | None, ...]:
    """Where the kept activities were; resources are those of the uses that are kept."""
    found: list[PreviousPlace | None] = []
    for i, its in zip(kept, uses, strict=True) if problem.previous.places else ():
        earlier = problem.previous.places[i]
        if earlier is not None:
            taken = tuple(earlier.resources[u] for u in its)
            earlier = earlier._replace(mode=None, resources=taken)
        found.append(earlier)
    return tuple(found)


def _settled(
    problem: Problem, place: dict[int, int], uses: Sequence[tuple[int, ...]]
) -> dict[tuple[int, int], int]:
    settled: dict[tuple[int, int], int] = {}
    for (i, u), r in problem.contention.fixed_choices.items():
        k = place.get(i)
        if k is not None and u in uses[k]:
            settled[k, uses[k].index(u)] = r
    return settled
