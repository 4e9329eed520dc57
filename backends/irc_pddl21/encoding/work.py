"""Calendars of activities, and work that pauses, in PDDL.

An activity with a calendar starts while a fact says that it is open, and needs another one
throughout. Work that pauses takes longer than its working time: the pause follows from the start,
and is the same for all starts between a few times (`irc.problem.work_times`). So there is an
operator for each different pause, which starts while a fact says that the pause is that long. Where
the working time is a range there is one for the least of it, and one for each two open times in
which it may start and end. All these facts are switched by timed initial literals.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import chain
from typing import NamedTuple

from irc.problem import Activity
from irc.problem.work_times import FOREVER, Interval, WorkTimes, WorkTimesOf
from irc.targets import Refusal
from irc_pddl21.encoding.builder import Builder
from irc_pddl21.encoding.pddl import NOTHING, Additions
from irc_pddl21.encoding.variants import Variant

MOST_TIMINGS = 400
"""A variant of an activity that would have more operators for its pauses is refused."""

NEVER_ENDS = FOREVER >> 1
"""Later than any end of an interval that ends."""


class Timing(NamedTuple):
    """The least and the greatest time from start to end (ticks), and what limits these two."""

    span: tuple[int, int]
    additions: Additions = NOTHING


class _Work(NamedTuple):
    """Working times that pause, from `head` to `latest`."""

    times: WorkTimes
    least: int
    most: int
    max_pause: int | None
    head: int
    latest: int


class WorkFacts:
    """The timings of variants; activities with equal open times share their facts."""

    def __init__(self, builder: Builder) -> None:
        self.builder, self.problem = builder, builder.problem
        self.times = WorkTimesOf(builder.problem)
        self._facts: dict[tuple[object, ...], str] = {}
        self._timings: dict[_Work, list[Timing]] = {}

    def of(self, i: int, variant: Variant) -> list[Timing]:
        """All timings of a variant of activity i; none where it never fits.

        Raises `Refusal` where there are more than `MOST_TIMINGS`.
        """
        activity = self.problem.activities[i]
        details = activity.details
        if not details.work and (details.calendar is None or details.paused):
            return [Timing(variant.span)]
        if not details.work:
            return [Timing(variant.span, self._in_open_times(activity, variant))]
        pools = self.problem.contention.pools
        # (Pools of several members have no closed times.)
        held = sorted({pools[r].members[0] for r in variant.resources})
        times = self.times.of(activity, held if variant.span[1] else ())
        head = self.problem.bounds.heads[i] if self.problem.bounds.heads else activity.release
        work = _Work(times, *variant.span, details.max_pause, head, self.builder.latest[i])
        if work not in self._timings:
            self._timings[work] = self._pausing(activity, work)
        return self._timings[work]

    def _in_open_times(self, activity: Activity, variant: Variant) -> Additions:
        """Starts, and goes on, while the calendar of an activity is open."""
        intervals = self.times.of_calendar(activity).intervals
        start = self._fact("hours_for_starts", intervals, late=False)
        if not variant.span[1]:
            return Additions(at_start=start)
        return Additions(at_start=start, over_all=self._fact("hours_for_work", intervals))

    def _pausing(self, activity: Activity, work: _Work) -> list[Timing]:
        made = self._fixed(work)
        if work.least < work.most:  # (What needs no fact at its end is found sooner.)
            made = chain(made, self._ranging(work))
        timings: list[Timing] = []
        for timing in made:
            if work.max_pause is not None and timing.span[0] - work.least > work.max_pause:
                continue
            timings.append(timing)
            if len(timings) > MOST_TIMINGS:
                raise Refusal(
                    f"the work of action {activity.id!r} has more than {MOST_TIMINGS} different "
                    "pauses, more than target 'pddl21' writes out",
                    (*activity.origin, "breaks"),
                    "give it a fixed duration or an earlier deadline, or use target 'cpsat'",
                )
        return timings

    def _fixed(self, work: _Work) -> Iterator[Timing]:
        """One timing for each different pause of the least working time."""
        starts: dict[int, list[Interval]] = {}
        for piece in work.times.pieces(work.least, work.latest):
            if piece.last >= work.head:
                starts.setdefault(piece.pause, []).append((piece.first, piece.last + 1))
        for pause, windows in sorted(starts.items()):
            length = work.least + pause
            fits = self._fact("pause_fits", windows, late=False)
            yield Timing((length, length), Additions(at_start=fits))

    def _ranging(self, work: _Work) -> Iterator[Timing]:
        """One timing for each two open times in which the work may start and end."""
        intervals, before = work.times.intervals, work.times.before
        for j, first in enumerate(intervals):
            if first[1] <= work.head:
                continue
            for k in range(j, len(intervals)):
                last = intervals[k]
                closed = last[0] - first[0] - (before[k] - before[j])
                if k > j and last[0] + 1 - (first[1] - 1) - closed > work.most:
                    break
                if last[0] + (k > j) > work.latest:
                    break
                if last[1] - first[0] - closed < work.least:
                    continue
                start = self._fact("hours_for_starts", [first], late=False)
                end = self._fact("hours_for_ends", [(last[0] + (k > j), last[1])])
                span = work.least + closed, work.most + closed
                yield Timing(span, Additions(at_start=start, at_end=end))

    def _fact(
        self, text: str, intervals: Sequence[Interval], *, late: bool = True
    ) -> tuple[str, ...]:
        """A fact that holds in intervals, if there are other times. `late`: and a slack longer."""
        if tuple(intervals) == ((0, FOREVER),):
            return ()
        key = (*intervals, late)
        if key not in self._facts:
            name = self.builder.names.new(f"{text}_{len(self._facts) + 1}")
            initially = bool(intervals) and intervals[0][0] <= 0
            self._facts[key] = self.builder.fact(name, initially=initially)
            self.builder.grounded.tokens[name] = "by open times it is possible now"
            self._add_literals(name, intervals, late=late)
        return (self._facts[key],)

    def _add_literals(self, name: str, intervals: Sequence[Interval], *, late: bool) -> None:
        scale = self.builder.scale
        for start, end in intervals:
            if start > 0:
                self.builder.switch(name, start * scale.units_per_tick, True)
            if end < NEVER_ENDS:
                close = end * scale.units_per_tick + (scale.slack if late else 0)
                self.builder.switch(name, close, False)
