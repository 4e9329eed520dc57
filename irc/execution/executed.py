"""The history as executed activities of a problem, in ticks and indexes."""

from __future__ import annotations

from dataclasses import dataclass, replace

from irc.problem import PLAIN, Activity, Details, PreviousPlace, Problem, Ranks, together
from irc.problem.choices import UnexplainedError, choices_of
from irc.problem.projection import in_one_mode
from irc.problem.work_times import WorkTimesOf, work_range
from irc.schedule import CANCELLED, Entry


@dataclass(frozen=True, slots=True)
class ExecutedActivity:
    """An occurrence that has begun. Times are in ticks; `end` is the planned one while it runs.

    `mode` and `resources` (one for each use, None for those of other modes) are None where they are
    not known: the observation of a start does not say what the action uses.
    """

    entry: Entry
    start: int
    end: int
    mode: int | None
    resources: tuple[int | None, ...] | None
    running: bool
    rank: int = 0
    end_rank: int = 0
    by_itself: bool = False
    """Whether it is a world change, which no plan contains."""
    least_end: int = 0
    """A time before which it does not end, though it is running and its duration would allow it."""

    @property
    def cancelled(self) -> bool:
        """Whether it was ended before it was done."""
        return self.entry.status == CANCELLED


def executed_activity(
    problem: Problem, activity: Activity, entry: Entry, *, running: bool
) -> ExecutedActivity:
    """The executed activity that an entry describes. Raises `UnexplainedError`."""
    mode, resources = choices_of(problem, activity, entry)
    start, end = problem.whole_ticks(entry.start), problem.whole_ticks(entry.end)
    return ExecutedActivity(
        entry, start, end, mode, resources, running, entry.rank, entry.last_rank
    )


def previous_place_of(problem: Problem, activity: Activity, entry: Entry) -> PreviousPlace | None:
    """The previous place of an open activity by its entry; None if the entry does not give all."""
    try:
        mode, resources = choices_of(problem, activity, entry)
    except UnexplainedError:
        return None
    if resources is None or (mode is None and activity.details.modes):
        return None
    return PreviousPlace(problem.whole_ticks(entry.start), mode, resources)


def frozen_choices(activity: Activity) -> tuple[int | None, tuple[int, ...]]:
    """The mode and the resource of each use of an executed activity, which has no others."""
    mode = 0 if activity.details.modes else None
    return mode, tuple(use.alternatives[0] for use in activity.uses)


def as_executed(
    problem: Problem,
    activity: Activity,
    past: ExecutedActivity,
    now: int,
    ranks: Ranks | None = None,
) -> Activity:
    """The activity as it happened: its start, mode, resources and known `ranks` are fixed.

    Its end is fixed too, unless it is running and its duration can still be chosen. The end of a
    cancelled activity produces and changes nothing, and earns no reward. An ended activity has no
    open demands. Its release, its latest start and its deadline bind no more.
    """
    if activity.details.modes and past.mode is None:
        return _begun(activity, past)
    if activity.details.modes and past.mode is not None:
        activity = in_one_mode(activity, past.mode)
    shortest = longest = past.end - past.start
    if activity.details.work and past.running and not past.cancelled:
        shortest = longest = _end_of_work(problem, activity, past, now) - past.start
    elif past.running and not activity.is_fixed and not past.cancelled:
        least = max(now, past.least_end, activity.earliest_end or 0)
        shortest = max(activity.duration_min, least - past.start)
        longest = max(activity.duration_max, shortest)
    apart = _ends_apart(activity, past, ranks)
    if apart:
        longest = shortest + 1
    elif not past.running and ranks is not None and None in ranks:
        ranks = None  # Start and end have one rank, and one of them is new.
    activity = _with_taken(problem, activity, past)
    details = _as_happened(activity.details, past, shortest, longest, ranks)
    # (Ranks still decide who gets the units that it frees at this instant.)
    frees_now = problem.has_state and past.end == now
    deadline = past.end if apart else activity.deadline
    if shortest == longest or (deadline is not None and deadline < past.start + shortest):
        deadline = None
    return replace(
        activity,
        start=past.start,
        latest_start=None,
        earliest_end=None,
        release=min(activity.release, past.start),
        deadline=deadline,
        duration_min=shortest,
        duration_max=longest,
        open_demands=activity.open_demands if longest and (past.running or frees_now) else (),
        details=details,
    )


def _end_of_work(problem: Problem, activity: Activity, past: ExecutedActivity, now: int) -> int:
    """The end of running work that pauses: as its calendars are now, not before it is known to end.

    Where its working time is a range, it is as long as it was planned.
    """
    least, most = work_range(activity, None)
    if past.resources is None or not most:
        return max(past.end, past.least_end, now)
    times = WorkTimesOf(problem).of(activity, [r for r in past.resources if r is not None])
    end = past.end
    if least == most:
        end = times.end_after(times.work_before(past.start) + least) or past.end
    end = max(end, past.least_end, now)
    return times.next_end(end) or end


def _with_taken(problem: Problem, activity: Activity, past: ExecutedActivity) -> Activity:
    """The activity with only the resources that it took, where they are known."""
    if past.resources is None:
        return activity
    taken = [r for r in past.resources if r is not None]
    pools = problem.contention.pools
    return replace(
        activity,
        uses=tuple(
            use._replace(alternatives=(r,)) for use, r in zip(activity.uses, taken, strict=True)
        ),
        open_demands=tuple(
            demand._replace(
                alternatives=tuple(
                    k for k in demand.alternatives if taken[demand.use] in pools[k].members
                )
            )
            for demand in activity.open_demands
        ),
    )


def _as_happened(
    details: Details, past: ExecutedActivity, shortest: int, longest: int, ranks: Ranks | None
) -> Details:
    """The details of an executed activity that takes from `shortest` to `longest`."""
    if details is PLAIN and ranks is None:
        return details
    details = replace(
        details,
        optional=False,
        repeats=None,
        calendar=details.calendar if details.work else None,
        work=(),
        paused=bool(details.work) or details.paused,
        modes=tuple(m._replace(duration_min=shortest, duration_max=longest) for m in details.modes),
        ranks=ranks,
    )
    if past.cancelled:
        details = replace(
            details,
            stock=tuple(c for c in details.stock if not c.at_end),
            conditions=tuple(c for c in details.conditions if c.at != "end"),
            effects=tuple(e for e in details.effects if not e.at_end),
            number_conditions=tuple(c for c in details.number_conditions if c.at != "end"),
            number_effects=tuple(e for e in details.number_effects if not e.at_end),
            due=None,
            reward=0,
        )
    if longest == 0:
        # (An activity of no duration is one happening, which gives each variable its last value.)
        changed = {e.var: e for e in sorted(details.effects, key=lambda e: e.at_end)}
        levels = together(e._replace(at_end=False) for e in details.number_effects)
        details = replace(details, effects=tuple(changed.values()), number_effects=levels)
    return details


def _ends_apart(activity: Activity, past: ExecutedActivity, ranks: Ranks | None) -> bool:
    """Whether the end of an ended activity has a rank of its own: its duration could be chosen.

    It keeps that rank where it could be longer, and a deadline says that it is not.
    """
    details = activity.details
    if past.running or past.cancelled or details.work:
        return False
    if not details.touches_state:
        return False
    if ranks is not None and None not in ranks and ranks.start != ranks.end:
        return True
    return not activity.is_fixed and past.end - past.start < activity.duration_max


def _begun(activity: Activity, past: ExecutedActivity) -> Activity:
    """The activity with a fixed start, where its mode is not known."""
    return replace(
        activity,
        start=past.start,
        latest_start=None,
        earliest_end=activity.earliest_end if past.running else None,
        release=min(activity.release, past.start),
        details=replace(activity.details, optional=False, repeats=None),
    )
