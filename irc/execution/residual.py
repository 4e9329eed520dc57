"""The residual problem: the rest of a frozen problem, with the present as time 0, for planners.

A planner begins at 0 and would have to plan the whole history again. In the residual problem, ended
activities are gone: their effects are in the initial state and the initial stock, and lags to them
are releases, deadlines or lags to an instant of their own. A running activity starts at once and
takes the rest of its duration. Activities that end right now have ended, and the world changes of
this instant have happened: the past comes first. The way back leads through the frozen problem,
which is re-timed as a whole.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

from irc.errors import IrcError
from irc.execution.executed import ExecutedActivity, frozen_choices
from irc.execution.fresh_names import fresh_name
from irc.execution.lags import Lags, twins
from irc.execution.numbers import numbers_now
from irc.passes.unroll import unroll
from irc.problem import (
    IMPOSSIBLE_DEADLINE,
    Activity,
    Condition,
    ContendedPool,
    Details,
    Effect,
    NumberCondition,
    NumberEffect,
    OpenCalendar,
    PreviousPlan,
    Problem,
    Renewable,
    Reservoir,
    StockChange,
    TimedChange,
    Variable,
    Window,
)
from irc.problem.choices import decision_of
from irc.problem.decisions import ABSENT, Decision
from irc.problem.projection import restricted
from irc.retiming.retime import retime
from irc.retiming.to_schedule import schedule_of
from irc.schedule import Entry, Schedule


class PastError(IrcError):
    """An activity that is still required had to happen earlier; the text names it."""


@dataclass(frozen=True)
class ResidualProblem:
    """The residual problem of `whole`: `places` maps its activities to indexes in `problem`."""

    whole: Problem
    executed: Mapping[int, ExecutedActivity]
    now: int
    problem: Problem
    places: Mapping[int, int]

    def merged(self, whole: Problem, schedule: Schedule) -> Schedule:
        """The schedule of the `whole` problem: the history and a schedule of the residual problem.

        (`whole` has the activities of the frozen problem, after any passes.) Raises `AnswerError`.
        """
        entries: dict[str, list[Entry]] = {}
        for entry in schedule.entries:
            entries.setdefault(entry.id, []).append(entry)
        depth = max((len(found) for found in entries.values()), default=0)
        unrolled = unroll(whole, depth)
        rank = 1 + max((f.end_rank for f in self.executed.values()), default=0)
        decisions = [
            self._decision(unrolled, i, activity, entries, rank)
            for i, activity in enumerate(unrolled.activities)
        ]
        return schedule_of(unrolled, retime(unrolled, decisions))

    @cached_property
    def _first(self) -> Mapping[str, int]:
        """The number of the first open occurrence of each action."""
        return {
            a.id: a.details.occurrence
            for i, a in enumerate(self.whole.activities)
            if i not in self.executed
        }

    def _decision(
        self,
        whole: Problem,
        i: int,
        activity: Activity,
        entries: Mapping[str, list[Entry]],
        rank: int,
    ) -> Decision:
        past = self.executed.get(i)
        if past is not None:
            start_rank, end, end_rank = past.rank, past.end, past.end_rank
            if i in self.places:
                entry = entries[self.problem.activities[self.places[i]].id][0]
                end = self.now + self.whole.whole_ticks(entry.end)
                end_rank = rank + entry.last_rank
                start_rank = rank + entry.rank if past.start == self.now else past.rank
            mode, chosen = frozen_choices(activity)
            return Decision(past.start, end, chosen, mode=mode, rank=start_rank, end_rank=end_rank)
        found = entries.get(activity.id, [])
        number = activity.details.occurrence - self._first[activity.id]
        if number >= len(found):
            return ABSENT
        entry = sorted(found, key=lambda e: e.occurrence)[number]
        return decision_of(whole, activity, entry, now=self.now, rank=rank)


def residual_problem(
    problem: Problem, executed: Mapping[int, ExecutedActivity], now: int
) -> ResidualProblem:
    """The residual problem of a frozen problem, before the passes that simplify it.

    Raises `PastError` where a required activity had to happen earlier.
    """
    if problem.deadline is not None and problem.deadline < now:
        problem = _all_too_late(problem, executed)
    kept = [i for i in range(len(problem.activities)) if i not in executed or executed[i].running]
    left, way = restricted(problem, activities=kept)
    places = way.activities.new
    names = Counter(a.id for a in problem.activities)
    activities = []
    for i, activity in zip(kept, left.activities, strict=True):
        past = executed.get(i)
        if past is None:
            activities.append(_shifted(activity, now, _end_before(problem, i, executed)))
        else:
            activities.append(_residual(activity, past, now, names))
    arcs = Lags(executed, now, places, activities, names)
    renumbered = dict(zip(way.arcs.old, left.arcs, strict=True))
    for k, arc in enumerate(problem.arcs):
        arcs.add(arc, renumbered.get(k), keep=problem.has_state)
    if problem.has_state:
        arcs.arcs += twins(problem, executed, places)
    deadline = problem.deadline
    residual = replace(
        left,
        activities=tuple(arcs.activities),
        arcs=tuple(arcs.arcs),
        resources=tuple(_later(r, now) for r in problem.resources),
        contention=replace(
            left.contention, pools=tuple(_pool_later(p, now) for p in left.contention.pools)
        ),
        deadline=None if deadline is None else deadline - now,
        calendars=tuple(_calendar_later(c, now) for c in problem.calendars),
        horizon=None if problem.horizon is None else max(0, problem.horizon - now),
        reservoirs=_stock_now(problem, executed, now, places),
        variables=_state_now(problem, executed, now, places),
        numbers=numbers_now(problem, executed, now, places),
        previous=_previous_later(left.previous, len(arcs.activities), now),
    )
    return ResidualProblem(problem, executed, now, residual, places)


def _all_too_late(problem: Problem, executed: Mapping[int, ExecutedActivity]) -> Problem:
    """The problem after the task's deadline: no activity can start, and none may be required."""
    activities = list(problem.activities)
    for i, activity in enumerate(activities):
        if i in executed:
            continue
        if not _may_be_absent(activity):
            raise PastError("the task's deadline has passed, but not all required actions are done")
        activities[i] = replace(activity, deadline=IMPOSSIBLE_DEADLINE)
    return replace(problem, activities=tuple(activities), deadline=None)


def _may_be_absent(activity: Activity) -> bool:
    repeats = activity.details.repeats
    return activity.details.optional or (repeats is not None and repeats[0] == 0)


def _previous_later(plan: PreviousPlan, size: int, now: int) -> PreviousPlan:
    """The previous plan of `size` activities, seen from now; added activities have no place."""
    places = [None if p is None else p._replace(start=p.start - now) for p in plan.places]
    added = size - len(places) if places else 0
    return replace(
        plan,
        places=(*places, *[None] * added),
        recurring={
            i: tuple(p._replace(start=p.start - now) for p in more)
            for i, more in plan.recurring.items()
        },
        warm_start=(),
    )


def _end_before(problem: Problem, i: int, executed: Mapping[int, ExecutedActivity]) -> int:
    """The end of the previous occurrence of an activity; 0 where there is none."""
    previous = problem.activities[i].details.previous_occurrence
    return 0 if previous is None else executed[previous].end


def _is_over(past: ExecutedActivity, at_end: bool, now: int, left: bool) -> bool:
    """Whether the start, or the end, of an executed activity has happened for certain."""
    return not left or (not at_end and past.start < now)


def _shifted(activity: Activity, now: int, after: int) -> Activity:
    """An open activity with all its times counted from now, and its occurrences from 1.

    `after` is the end of its previous occurrence.
    """
    if activity.start is not None and activity.start < now and not activity.details.optional:
        raise PastError(f"{activity.id!r} has a fixed start that has passed, but has not begun")
    latest = activity.latest_start
    if latest is not None and latest < now and not _may_be_absent(activity):
        raise PastError(f"{activity.id!r} has a latest start that has passed, but has not begun")
    deadline = activity.deadline
    if any(limit is not None and limit < now for limit in (activity.start, latest)):
        deadline = IMPOSSIBLE_DEADLINE
    details = activity.details
    due, release = details.due, max(activity.release, after)
    if due is not None or details.previous_occurrence is not None or details.occurrence != 1:
        due = None if due is None else due - now
        details = replace(details, due=due, previous_occurrence=None, occurrence=1)
    if details.not_before is not None:
        details = replace(details, not_before=None)
    if details.entered is not None:
        details = replace(details, entered=details.entered - now)
    return replace(
        activity,
        release=max(0, release - now),
        start=None if activity.start is None else max(0, activity.start - now),
        latest_start=None if latest is None else max(0, latest - now),
        earliest_end=None if activity.earliest_end is None else max(0, activity.earliest_end - now),
        deadline=None if deadline is None else max(IMPOSSIBLE_DEADLINE, deadline - now),
        details=details,
    )


def _residual(
    activity: Activity, past: ExecutedActivity, now: int, names: Counter[str]
) -> Activity:
    """The rest of a running activity: it starts at once, without the effects of its start."""
    elapsed = now - past.start
    shortest = max(0, activity.duration_min - elapsed)
    longest = max(0, activity.duration_max - elapsed)
    details = activity.details
    name = activity.id
    if names[name] > 1:  # An occurrence of an action that may have more.
        name = fresh_name(f"{name} ({details.occurrence})", names)
        names[name] += 1
        shortest = longest = max(0, past.end - now)
    own = Details(
        modes=tuple(
            m._replace(
                duration_min=shortest,
                duration_max=longest,
                stock=_stock_left(m.stock, elapsed),
                conditions=_conditions_left(m.conditions, elapsed),
                effects=_effects_left(m.effects, elapsed),
                number_conditions=_limits_left(m.number_conditions, elapsed),
                number_effects=_changes_left(m.number_effects, elapsed),
            )
            for m in details.modes
        ),
        use_modes=details.use_modes,
        stock=_stock_left(details.stock, elapsed),
        conditions=_conditions_left(details.conditions, elapsed),
        effects=_effects_left(details.effects, elapsed),
        number_conditions=_limits_left(details.number_conditions, elapsed),
        number_effects=_changes_left(details.number_effects, elapsed),
        due=None if details.due is None else details.due - now,
        weight=details.weight,
        reward=details.reward,
        cost=details.cost,
        paused=details.paused,
        entered=None if details.entered is None else details.entered - now,
    )
    return replace(
        activity,
        id=name,
        start=0,
        latest_start=None,
        earliest_end=None if activity.earliest_end is None else max(0, activity.earliest_end - now),
        release=0,
        deadline=None
        if activity.deadline is None
        else max(IMPOSSIBLE_DEADLINE, activity.deadline - now),
        duration_min=shortest,
        duration_max=longest,
        details=own,
    )


def _stock_left(stock: tuple[StockChange, ...], elapsed: int) -> tuple[StockChange, ...]:
    """The changes of stock that come after the start, if that was before now."""
    return tuple(c for c in stock if c.at_end or not elapsed)


def _conditions_left(conditions: tuple[Condition, ...], elapsed: int) -> tuple[Condition, ...]:
    return tuple(c for c in conditions if c.at != "start" or not elapsed)


def _effects_left(effects: tuple[Effect, ...], elapsed: int) -> tuple[Effect, ...]:
    return tuple(e for e in effects if e.at_end or not elapsed)


def _limits_left(
    conditions: tuple[NumberCondition, ...], elapsed: int
) -> tuple[NumberCondition, ...]:
    return tuple(c for c in conditions if c.at != "start" or not elapsed)


def _changes_left(effects: tuple[NumberEffect, ...], elapsed: int) -> tuple[NumberEffect, ...]:
    return tuple(e for e in effects if e.at_end or not elapsed)


def _later(resource: Renewable, now: int) -> Renewable:
    if not resource.windows:
        return resource
    return replace(resource, windows=_windows_later(resource.windows, now))


def _calendar_later(calendar: OpenCalendar, now: int) -> OpenCalendar:
    times = ((max(0, start - now), end - now) for start, end in calendar.times if end > now)
    return replace(calendar, times=tuple(times))


def _pool_later(pool: ContendedPool, now: int) -> ContendedPool:
    if not pool.windows:
        return pool
    return replace(pool, windows=_windows_later(pool.windows, now))


def _windows_later(windows: Iterable[Window], now: int) -> tuple[Window, ...]:
    return tuple(
        Window(max(0, w.start - now), w.end - now, w.capacity) for w in windows if w.end > now
    )


def _stock_now(
    problem: Problem, executed: Mapping[int, ExecutedActivity], now: int, places: Mapping[int, int]
) -> tuple[Reservoir, ...]:
    """The reservoirs with the levels that the history leaves."""
    levels = [r.initial for r in problem.reservoirs]
    for i, past in executed.items():
        for change in problem.activities[i].details.stock:
            if _is_over(past, change.at_end, now, i in places):
                levels[change.reservoir] += change.amount
    return tuple(
        replace(r, initial=level) for r, level in zip(problem.reservoirs, levels, strict=True)
    )


def _state_now(
    problem: Problem, executed: Mapping[int, ExecutedActivity], now: int, places: Mapping[int, int]
) -> tuple[Variable, ...]:
    """The variables with the values that the history leaves."""
    values = [v.initial for v in problem.variables]
    writes: list[tuple[int, int, int, int, int]] = []
    for i, past in executed.items():
        for effect in problem.activities[i].details.effects:
            if not _is_over(past, effect.at_end, now, i in places):
                continue
            time, rank = (past.end, past.end_rank) if effect.at_end else (past.start, past.rank)
            # (Ends at an instant come before changes of the world at it, and starts after them.)
            stage = 0 if past.start < time else 2
            writes.append((time, rank, stage, effect.var, effect.value))
    for var, variable in enumerate(problem.variables):
        for at, value in variable.changes:
            ended = [r for t, r, stage, v, _ in writes if (t, stage, v) == (at, 0, var)]
            if at <= now:
                writes.append((at, max(ended, default=-1), 1, var, value))
    for _, _, _, var, value in sorted(writes):
        values[var] = value
    return tuple(
        replace(v, initial=value, changes=_changes_later(v, now))
        for v, value in zip(problem.variables, values, strict=True)
    )


def _changes_later(variable: Variable, now: int) -> tuple[TimedChange, ...]:
    """The timed changes of a variable that are still to come, counted from now."""
    return tuple(TimedChange(c.at - now, c.value) for c in variable.changes if c.at > now)
