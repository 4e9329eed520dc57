"""The selection of an engine: a problem with only the chosen activities and modes.

Absent activities are gone, and so are the arcs that bind them. A chosen mode has become the
activity's duration, and the uses of other modes are gone. So no later step has to know about
presence or modes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from irc.problem import Activity, Problem
from irc.problem.decisions import AnswerError, Decision, Placed
from irc.problem.projection import Projection, restricted


@dataclass(frozen=True, slots=True)
class Selection:
    """The present activities of a problem, the decisions about them, and the way back."""

    problem: Problem
    decisions: tuple[Decision, ...]
    way: Projection

    def spread(self, whole: Problem, placed: Sequence[Placed]) -> tuple[Placed, ...]:
        """Converts places in the selection to places in the whole problem, in the chosen modes."""
        in_modes = [
            place if decision.mode is None else replace(place, mode=decision.mode)
            for place, decision in zip(placed, self.decisions, strict=True)
        ]
        return self.way.spread(whole, in_modes)


def select(problem: Problem, decisions: Sequence[Decision]) -> Selection:
    """The selection of the activities that are present, in their chosen modes.

    Raises `AnswerError` where a mode is missing or unknown.
    """
    kept = [i for i, d in enumerate(decisions) if d.present]
    uses = {
        i: problem.activities[i].uses_in(_mode(problem.activities[i], decisions[i]))
        for i in kept
        if problem.activities[i].details.modes
    }
    smaller, way = restricted(problem, activities=kept, uses=uses)
    chosen = way.decisions(decisions)
    if not uses:
        return Selection(smaller, chosen, way)
    places = smaller.previous.places
    selected = replace(
        smaller,
        activities=tuple(_in_mode(a, d) for a, d in zip(smaller.activities, chosen, strict=True)),
        previous=replace(
            smaller.previous,
            places=tuple(None if place is None else place._replace(mode=None) for place in places),
        ),
    )
    return Selection(selected, chosen, way)


def _mode(activity: Activity, decision: Decision) -> int:
    if decision.mode is None or not 0 <= decision.mode < len(activity.details.modes):
        raise AnswerError(f"the answer gives no mode of {activity.id!r}")
    return decision.mode


def _in_mode(activity: Activity, decision: Decision) -> Activity:
    if not activity.details.modes or decision.mode is None:
        return activity
    mode = activity.details.modes[decision.mode]
    details = activity.details
    if details.work:
        details = replace(details, work=(details.work[decision.mode],))
    return replace(
        activity,
        duration_min=mode.duration_min,
        duration_max=mode.duration_max,
        details=details.in_mode(decision.mode),
    )
