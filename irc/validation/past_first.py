"""The past comes first: at an event's instant, first ends, then its changes, then starts.

The rule holds at the instants of world changes, and at the instant as of which a schedule is
judged. It orders ranks weakly: interference says which happenings must not share a rank. It applies
to all happenings that concern state or stock. An end whose time could be chosen may have been
chosen at the event, after its changes, so the rule does not bind it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from irc.model.quantities import Number
from irc.model.world_changes import is_world_change
from irc.validation.bound_schedule import BoundSchedule, Occurrence
from irc.validation.verdict import Violations

Point = tuple[Occurrence, bool]
"""An occurrence, and whether the happening is its end."""


class EventInstant(NamedTuple):
    """The ends at an event's instant, the world changes at it, and the starts at it."""

    time: Number
    ended: tuple[Occurrence, ...]
    changes: tuple[Occurrence, ...]
    starts: tuple[Occurrence, ...]


def event_instants(bound: BoundSchedule) -> Iterator[EventInstant]:
    """The instants at which the past comes first, where the order concerns some happening."""
    changes: dict[Number, list[Occurrence]] = {} if bound.at is None else {bound.at: []}
    others: list[Occurrence] = []
    for occurrence in filter(_is_concerned, bound.occurrences):
        if is_world_change(occurrence.action, bound.clock):
            changes.setdefault(occurrence.start, []).append(occurrence)
        else:
            others.append(occurrence)
    ended: dict[Number, list[Occurrence]] = {time: [] for time in changes}
    starts: dict[Number, list[Occurrence]] = {time: [] for time in changes}
    for occurrence in others if changes else ():
        if occurrence.end in ended and _ended_by_itself(occurrence):
            ended[occurrence.end].append(occurrence)
        if occurrence.start in starts:
            starts[occurrence.start].append(occurrence)
    for time, own in changes.items():
        if (ended[time] or own) and (own or starts[time]):
            yield EventInstant(time, tuple(ended[time]), tuple(own), tuple(starts[time]))


def _ended_by_itself(occurrence: Occurrence) -> bool:
    """Whether its end was not chosen: a running action may be ended after an event's changes."""
    return occurrence.start < occurrence.end and occurrence.shortest == occurrence.longest


def _is_concerned(occurrence: Occurrence) -> bool:
    action = occurrence.action
    return bool(action.conditions or action.effects or action.consumes or action.produces)


def check_past_first(bound: BoundSchedule, violations: Violations) -> None:
    """Checks that the ranks which a schedule gives keep that order."""
    for instant in event_instants(bound):
        before = max(instant.ended, key=lambda o: o.end_rank, default=None)
        rank = 0 if before is None else before.end_rank
        for later in (instant.changes, instant.starts):
            for occurrence in later:
                if before is not None and occurrence.rank < rank:
                    _add_too_early(occurrence, before, rank, instant.time, violations)
            last = max(later, key=lambda o: o.rank, default=None)
            if last is not None and (before is None or last.rank > rank):
                before, rank = last, last.rank


def _add_too_early(
    occurrence: Occurrence, before: Occurrence, rank: int, time: Number, violations: Violations
) -> None:
    violations.add(
        "rank",
        f"{occurrence.name} starts at {violations.time(time)} with rank {occurrence.rank}, before "
        f"{before.name} with rank {rank}; ends come first, then changes by events, then starts",
        [occurrence.entry.id, before.entry.id],
        (time,),
        carried=occurrence.past is not None and before.past is not None,
    )


def past_first_pairs(bound: BoundSchedule) -> Iterator[tuple[Sequence[Point], Sequence[Point]]]:
    """Pairs of happenings: those that come first, and those that come no earlier."""
    for instant in event_instants(bound):
        ended = [(occurrence, True) for occurrence in instant.ended]
        changes = [(occurrence, False) for occurrence in instant.changes]
        starts = [(occurrence, False) for occurrence in instant.starts]
        if ended and changes:
            yield ended, changes
        if starts:
            yield (changes or ended), starts
