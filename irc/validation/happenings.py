"""What happens to state: the starts and ends that read or change it, and what is held between.

This is PDDL2.1 (Fox & Long 2003, section 5) with its separation made infinitesimal: a happening
has a time and a rank, and happenings are ordered by (time, rank).
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

from irc.model.base import StateValue
from irc.model.quantities import Number
from irc.validation.bound_schedule import BoundSchedule, Occurrence
from irc.validation.timing import tight_precedences

Value = StateValue | None
"""The value of a state variable; None where nothing has given it one yet."""

Edge = tuple[int, int, int]
"""(a, b, least): the rank of node b is at least that of node a plus `least` (0 or 1)."""

Edges = tuple[Edge, ...]


class Happening(NamedTuple):
    """A start or an end, or both where an occurrence takes no time.

    `node` stands for its rank; happenings of one time and one node are the same happening.
    """

    time: Number
    node: int
    occurrence: Occurrence
    at_end: bool


class Access(NamedTuple):
    """A happening that needs a value just before it, or gives one."""

    happening: Happening
    value: StateValue


class Hold(NamedTuple):
    """A value needed from just after one happening to just before another."""

    opening: Happening
    closing: Happening
    value: StateValue


@dataclass
class Timeline:
    """All that one state variable goes through."""

    reads: list[Access] = field(default_factory=list)
    writes: list[Access] = field(default_factory=list)
    holds: list[Hold] = field(default_factory=list)

    @property
    def past(self) -> Timeline:
        """What of it is history."""
        return Timeline(
            [read for read in self.reads if read.happening.occurrence.past],
            [write for write in self.writes if write.happening.occurrence.past],
            [hold for hold in self.holds if hold.opening.occurrence.past],
        )


@dataclass
class Story:
    """All happenings of a schedule that concern state, by variable.

    `nodes` gives the rank nodes of each occurrence's start and end: one and the same where its
    duration is fixed.
    """

    nodes: list[tuple[int, int]] = field(default_factory=list)
    node_count: int = 0
    timelines: dict[str, Timeline] = field(default_factory=dict)


def tell(bound: BoundSchedule, drawn_out: Collection[int]) -> Story:
    """The story of a schedule.

    `drawn_out` numbers the occurrences that start and end at the same time but at different ranks,
    and so are two happenings; every other one of no duration is a single happening.
    """
    story = Story(timelines={name: Timeline() for name in bound.variables})
    for occurrence in bound.occurrences:
        separate = occurrence.number in drawn_out
        if occurrence.ends_freely and (separate or occurrence.start != occurrence.end):
            nodes = (story.node_count, story.node_count + 1)
            story.node_count += 2
        else:
            nodes = (story.node_count, story.node_count)
            story.node_count += 1
        story.nodes.append(nodes)
        if occurrence.action.conditions or occurrence.action.effects:
            _tell_occurrence(story, occurrence, nodes)
    return story


def _tell_occurrence(story: Story, occurrence: Occurrence, nodes: tuple[int, int]) -> None:
    """What was cancelled held its conditions until then; nothing of its end has happened."""
    start = Happening(occurrence.start, nodes[0], occurrence, False)
    end = Happening(occurrence.end, nodes[1], occurrence, True)
    if start.time == end.time and start.node == end.node:
        end = start
    for condition in occurrence.action.conditions:
        timeline, value = story.timelines[condition.var], condition.value
        if condition.at == "start" or (end is start and not occurrence.cancelled):
            timeline.reads.append(Access(start, value))
        elif condition.at == "end":
            if not occurrence.cancelled:
                timeline.reads.append(Access(end, value))
        elif end is not start and start.time <= end.time:
            timeline.holds.append(Hold(start, end, value))
    for effect in occurrence.action.effects:
        if effect.at == "end" and occurrence.cancelled:
            continue
        happening = start if effect.at == "start" else end
        story.timelines[effect.var].writes.append(Access(happening, effect.value))


def given_ranks(bound: BoundSchedule, story: Story) -> list[int]:
    """The rank of each node as the entries state it."""
    ranks = [0] * story.node_count
    for occurrence, (start, end) in zip(bound.occurrences, story.nodes, strict=True):
        ranks[end] = occurrence.end_rank
        ranks[start] = occurrence.rank
    return ranks


def timing_edges(bound: BoundSchedule, story: Story) -> Iterator[Edge]:
    """What durations and precedences kept with no time to spare demand of the ranks."""
    for occurrence, (start, end) in zip(bound.occurrences, story.nodes, strict=True):
        if start == end:
            continue
        lasts = occurrence.end - occurrence.start
        if lasts == 0:
            yield start, end, 1
        elif lasts == occurrence.shortest:
            yield start, end, 0
        if lasts == occurrence.longest:
            yield end, start, 0
    for before, from_end, after, to_end in tight_precedences(bound):
        edge = (story.nodes[before.number][from_end], story.nodes[after.number][to_end], 0)
        if edge[0] != edge[1]:
            yield edge


def moment_text(happening: Happening, time: str) -> str:
    """ "its start at 5 s"."""
    return f"its {'end' if happening.at_end else 'start'} at {time}"
