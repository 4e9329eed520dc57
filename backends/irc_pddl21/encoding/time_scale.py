"""The planner's unit of time: units per tick, and the slack of bounds from above.

Planners separate dependent happenings by an epsilon, so a chain of k of them ends k epsilons
late. Every bound from above therefore gets `slack`, and one tick is `units_per_tick` planner
units, so that all slack together stays below one tick: then an exact integer schedule with the
same choices and order exists (a relaxed cycle of the temporal network is short of 0 by less than
1, and weights are whole).
"""

from __future__ import annotations

from fractions import Fraction
from math import ceil
from typing import NamedTuple

from irc.problem import Activity, Problem
from irc_pddl21.encoding.occurrences import occurrences_of

EPSILON = Fraction(1, 1000)
"""The separation of dependent happenings in OPTIC and kairos, in planner time."""

ENDLESS = 64
"""The number of occurrences assumed of an action that may happen without end.
(A plan with more of them may miss a limit by an epsilon; a plan that cannot be re-timed is not
used.)"""

_GREATEST_SCALE = 10_000


class TimeScale(NamedTuple):
    """Planner units per tick, and the slack (planner units) of each bound from above.

    `shortened`: actions are shorter by the slack; see `irc_pddl21.decoding.rounding`.
    """

    units_per_tick: int
    slack: int
    shortened: bool = False

    def duration(self, least: int, greatest: int) -> tuple[int, int]:
        """Least and greatest duration in planner units, of an action given in ticks."""
        shorter = self.slack if self.shortened else 0
        longest = greatest * self.units_per_tick - (shorter if least == greatest else 0)
        return max(0, least * self.units_per_tick - shorter), longest


def time_scale(
    problem: Problem, epsilon: Fraction, *, envelopes: int, helpers: int, shortened: bool
) -> TimeScale:
    """The scale of a problem, for planners with the given epsilon.

    `helpers` counts the operators that only the planner needs, `envelopes` among them.
    """
    closings = envelopes + sum(
        problem.effective_deadline(i) is not None
        or a.start is not None
        or a.latest_start is not None
        or _has_calendar(problem, a)
        for i, a in enumerate(problem.activities)
    )
    closings += sum(1 for _ in problem.timed_changes)
    if shortened:
        # Every action is one, and times are rounded to the nearest tick.
        closings = 2 * (closings + len(problem.activities))
    if not closings:
        return TimeScale(1, 0, shortened)
    occurrences = [occurrences_of(activity) for activity in problem.activities]
    operators = helpers + sum(
        o.written + (ENDLESS if o.again is None else o.again) for o in occurrences
    )
    slack = ceil(epsilon * 2 * (operators + 1))
    scale = 10
    while scale <= slack * (closings + 1) and scale < _GREATEST_SCALE:
        scale *= 10
    while scale <= 2 * slack:
        scale *= 10
    return TimeScale(scale, slack, shortened)


def _has_calendar(problem: Problem, activity: Activity) -> bool:
    return bool(activity.details.calendar is not None or activity.details.work) or any(
        problem.contention.pools[r].windows for c in activity.open_demands for r in c.alternatives
    )
