"""The past comes first: at an event's instant t, what ended at t, then its changes, then starts.

The instants concerned are those of changes of the world, and the one as of which a schedule is
judged. The order is one of ranks and weak: what must not share a rank says so by interference. It
is asked of all that has to do with state or stock. An end that could be chosen is not bound: a
schedule does not say whether it had come by then, which is before the event's changes, or was
chosen at the event, in their knowledge and so behind them. (Who repairs a schedule knows it: there
what is completed is bound, whatever its duration.)
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from irc.model.quantities import Number
from irc.model.world_changes import is_world_change
from irc.validation.bound_schedule import BoundSchedule, Occurrence
from irc.validation.verdict import Violations

Point = tuple[Occurrence, bool]
"""An occurrence, and whether its end is meant."""


class EventInstant(NamedTuple):
    """What ended at an event's instant, the world's changes at it, and what starts at it."""

    time: Number
    ended: tuple[Occurrence, ...]
    changes: tuple[Occurrence, ...]
    starts: tuple[Occurrence, ...]


def event_instants(bound: BoundSchedule) -> Iterator[EventInstant]:
    """The instants at which the past comes first, where something has to do with the order."""
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
        if occurrence.end in ended and occurrence.ends_by_itself:
            ended[occurrence.end].append(occurrence)
        if occurrence.start in starts:
            starts[occurrence.start].append(occurrence)
    for time, own in changes.items():
        if (ended[time] or own) and (own or starts[time]):
            yield EventInstant(time, tuple(ended[time]), tuple(own), tuple(starts[time]))


def _is_concerned(occurrence: Occurrence) -> bool:
    action = occurrence.action
    return bool(action.conditions or action.effects or action.consumes or action.produces)


def check_past_first(bound: BoundSchedule, violations: Violations) -> None:
    """The ranks that a schedule gives keep that order."""
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
        f"{before.name} with rank {rank}; what ended comes first, then what an event changes, then "
        "what starts",
        [occurrence.entry.id, before.entry.id],
        (time,),
        carried=occurrence.past is not None and before.past is not None,
    )


def past_first_pairs(bound: BoundSchedule) -> Iterator[tuple[Sequence[Point], Sequence[Point]]]:
    """Happenings and those that come no earlier than all of them."""
    for instant in event_instants(bound):
        ended = [(occurrence, True) for occurrence in instant.ended]
        changes = [(occurrence, False) for occurrence in instant.changes]
        starts = [(occurrence, False) for occurrence in instant.starts]
        if ended and changes:
            yield ended, changes
        if starts:
            yield (changes or ended), starts
