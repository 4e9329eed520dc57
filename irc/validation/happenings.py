"""The happenings that concern state: starts and ends that read or change it, and its holds.

This is PDDL2.1 (Fox & Long 2003, section 5) with its separation made infinitesimal: a happening
has a time and a rank, and happenings are ordered by (time, rank).
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

from irc.model import Effect
from irc.model.quantities import Number
from irc.validation.bound_schedule import BoundSchedule, Occurrence
from irc.validation.levels import Given, Need, given_by, need_of
from irc.validation.timing import tight_precedences

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


class Read(NamedTuple):
    """A happening that needs something just before it."""

    happening: Happening
    need: Need


class Write(NamedTuple):
    """A happening that changes the variable."""

    happening: Happening
    change: Given


class Hold(NamedTuple):
    """A condition that must hold from just after one happening to just before another."""

    opening: Happening
    closing: Happening
    need: Need


@dataclass
class Timeline:
    """All happenings and holds of one state variable."""

    reads: list[Read] = field(default_factory=list)
    writes: list[Write] = field(default_factory=list)
    holds: list[Hold] = field(default_factory=list)

    @property
    def past(self) -> Timeline:
        """The part of it that no plan decides: the history, and all timed changes."""
        return Timeline(
            [read for read in self.reads if read.happening.occurrence.past],
            [write for write in self.writes if write.happening.occurrence.is_history],
            [hold for hold in self.holds if hold.opening.occurrence.past],
        )


@dataclass
class Timelines:
    """All happenings of a schedule that concern state, by variable.

    `nodes` gives the rank nodes of each occurrence's start and end: one and the same where its
    duration is fixed.
    """

    nodes: list[tuple[int, int]] = field(default_factory=list)
    node_count: int = 0
    by_variable: dict[str, Timeline] = field(default_factory=dict)


def timelines_of(bound: BoundSchedule, drawn_out: Collection[int]) -> Timelines:
    """The timelines of a schedule.

    `drawn_out` numbers the occurrences that start and end at the same time but at different ranks:
    each has two happenings. Every other occurrence of no duration has one.
    """
    timelines = Timelines(by_variable={name: Timeline() for name in bound.variables})
    for occurrence in bound.happening:
        separate = occurrence.number in drawn_out
        if occurrence.ends_freely and (separate or occurrence.start != occurrence.end):
            nodes = (timelines.node_count, timelines.node_count + 1)
            timelines.node_count += 2
        else:
            nodes = (timelines.node_count, timelines.node_count)
            timelines.node_count += 1
        timelines.nodes.append(nodes)
        if occurrence.action.conditions or occurrence.action.effects:
            _add_occurrence(timelines, occurrence, nodes)
    return timelines


def _add_occurrence(timelines: Timelines, occurrence: Occurrence, nodes: tuple[int, int]) -> None:
    """Adds an occurrence; the end of a cancelled one reads and changes nothing."""
    start = Happening(occurrence.start, nodes[0], occurrence, False)
    end = Happening(occurrence.end, nodes[1], occurrence, True)
    if start.time == end.time and start.node == end.node:
        end = start
    for condition in occurrence.action.conditions:
        timeline, need = timelines.by_variable[condition.var], need_of(condition)
        if condition.at == "start" or (end is start and not occurrence.cancelled):
            timeline.reads.append(Read(start, need))
        elif condition.at == "end":
            if not occurrence.cancelled:
                timeline.reads.append(Read(end, need))
        elif end is not start and start.time <= end.time:
            timeline.holds.append(Hold(start, end, need))
    effects: tuple[Effect, ...] = occurrence.action.effects
    happenings: list[tuple[Happening, Iterable[Effect]]]
    if end is start and not occurrence.cancelled:
        happenings = [(start, effects)]
    else:
        ending = () if occurrence.cancelled else [e for e in effects if e.at == "end"]
        happenings = [(start, [e for e in effects if e.at == "start"]), (end, ending)]
    for happening, own in happenings:
        for var, change in given_by(own):
            timelines.by_variable[var].writes.append(Write(happening, change))


def given_ranks(bound: BoundSchedule, timelines: Timelines) -> list[int]:
    """The rank of each node as the entries state it; those of timed changes are 0 until found."""
    ranks = [0] * timelines.node_count
    for occurrence, (start, end) in zip(bound.happening, timelines.nodes, strict=True):
        ranks[end] = occurrence.end_rank
        ranks[start] = occurrence.rank
    return ranks


def starts_after(bound: BoundSchedule, change: Occurrence) -> Iterator[tuple[Occurrence, int]]:
    """The starts at the instant of a timed change that read, hold or change its variable.

    They come after it. With each: 1 if it reads or changes the variable, so that it has another
    rank, else 0.
    """
    var = change.action.effects[0].var
    for occurrence in bound.occurrences:
        if occurrence.start != change.start:
            continue
        action = occurrence.action
        touches = {c.at for c in action.conditions if c.var == var}
        touches |= {e.at for e in action.effects if e.var == var}
        if occurrence.cancelled:
            touches.discard("end")
        if touches:
            near = "start" in touches or occurrence.start == occurrence.end
            yield occurrence, int(near)


def timing_edges(bound: BoundSchedule, timelines: Timelines) -> Iterator[Edge]:
    """Edges between ranks from durations and precedences that are met with no time to spare."""
    for change in bound.changes:
        node = timelines.nodes[change.number][0]
        for occurrence, strict in starts_after(bound, change):
            yield node, timelines.nodes[occurrence.number][0], strict
    for occurrence, (start, end) in zip(bound.happening, timelines.nodes, strict=True):
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
        edge = (timelines.nodes[before.number][from_end], timelines.nodes[after.number][to_end], 0)
        if edge[0] != edge[1]:
            yield edge


def moment_text(happening: Happening, time: str) -> str:
    """ "its start at 5 s"."""
    return f"its {'end' if happening.at_end else 'start'} at {time}"
