"""The lags of a residual problem: between open activities, and those to the past."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import pairwise

from irc.execution.executed import ExecutedActivity
from irc.execution.fresh_names import fresh_name
from irc.problem import IMPOSSIBLE_DEADLINE, Activity, Arc, Problem

_NOW = "now"
"""The id of the instant that lags to the past are counted from."""


class Lags:
    """The arcs between activities of the residual problem, and the demands of arcs to the past."""

    def __init__(
        self,
        executed: Mapping[int, ExecutedActivity],
        now: int,
        places: Mapping[int, int],
        activities: list[Activity],
        names: Counter[str],
    ) -> None:
        self.executed, self.now, self.places = executed, now, places
        self.activities, self.names = activities, names
        self.arcs: list[Arc] = []
        self.anchor: int | None = None

    def add(self, arc: Arc, renumbered: Arc | None, *, keep: bool) -> None:
        """Adds an arc of the frozen problem; `renumbered` is that arc in the residual problem.

        With `keep` it stays an arc wherever possible: at equal times it orders ranks.
        """
        left = self._is_to_come(arc.before, arc.from_end) and self._is_to_come(
            arc.after, arc.to_end
        )
        if renumbered is not None and keep and left:
            self.arcs.append(renumbered)
            return
        before = self._known(arc.before, at_end=arc.from_end)
        after = self._known(arc.after, at_end=arc.to_end)
        if renumbered is not None and before is None and after is None:
            self.arcs.append(renumbered)
        elif before is not None and after is None:
            least = before + arc.min_lag
            most = None if arc.max_lag is None else before + arc.max_lag
            self._between(self.places[arc.after], arc.to_end, least, most)
        elif before is None and after is not None:
            least_before = None if arc.max_lag is None else after - arc.max_lag
            self._between(self.places[arc.before], arc.from_end, least_before, after - arc.min_lag)

    def _is_to_come(self, i: int, at_end: bool) -> bool:
        """Whether a point of an activity belongs to the residual problem."""
        past = self.executed.get(i)
        return past is None or (i in self.places and (at_end or past.start == self.now))

    def _known(self, i: int, *, at_end: bool) -> int | None:
        """The time from now to a point of an executed activity; None if it is not decided yet."""
        past = self.executed.get(i)
        if past is None:
            return None
        if not at_end:
            return past.start - self.now
        if i in self.places and not self.activities[self.places[i]].is_fixed:
            return None
        return past.end - self.now

    def _between(self, i: int, at_end: bool, least: int | None, most: int | None) -> None:
        """Demands that a point of activity i lies between two instants."""
        activity = self.activities[i]
        if least is not None and (activity.is_fixed or not at_end):
            release = least - activity.duration_min if at_end else least
            activity, least = replace(activity, release=max(activity.release, release)), None
        if most is not None and (activity.is_fixed or at_end):
            deadline = max(IMPOSSIBLE_DEADLINE, most if at_end else most + activity.duration_min)
            if activity.deadline is None or deadline < activity.deadline:
                activity = replace(activity, deadline=deadline)
            most = None
        self.activities[i] = activity
        if least is not None and least > 0:
            self.arcs.append(Arc(self._anchor(), i, False, at_end, least, None, -1))
        if most is not None:
            self.arcs.append(Arc(i, self._anchor(), at_end, False, -most, None, -1))

    def _anchor(self) -> int:
        """The activity that stands for the present."""
        if self.anchor is None:
            self.anchor = len(self.activities)
            # (Nothing else is named after this one.)
            self.activities.append(Activity(fresh_name(_NOW, self.names), 0, 0, start=0))
        return self.anchor


def twins(
    problem: Problem, executed: Mapping[int, ExecutedActivity], places: Mapping[int, int]
) -> Iterator[Arc]:
    """Arcs between activities that begin together and end together: ends in the order of starts.

    (With a fixed duration both have the same rank.)
    """
    alike: dict[tuple[int, int], list[int]] = {}
    for i in sorted(places):
        if i in executed and problem.activities[i].is_fixed:
            alike.setdefault((executed[i].start, executed[i].end), []).append(i)
    for its in alike.values():
        for i, j in pairwise(sorted(its, key=lambda i: executed[i].rank)):
            if executed[i].rank < executed[j].rank:
                yield Arc(places[i], places[j], to_end=True, origin=-1)
