"""The history in a problem's terms: which activity each entry is of, in ticks and indexes."""

from __future__ import annotations

from dataclasses import dataclass, replace

from irc.problem import Activity, PreviousPlace, Problem, Ranks
from irc.problem.choices import UnexplainedError, choices_of
from irc.problem.projection import with_uses
from irc.schedule import CANCELLED, Entry


@dataclass(frozen=True, slots=True)
class ExecutedActivity:
    """An occurrence that has begun. Times are in ticks; `end` is the planned one while it runs.

    `mode` and `resources` (one for each use, None for those of other modes) are None where nobody
    has said them: an observation that something started does not tell what it uses.
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
    """Whether it is a change of the world, which nobody has made."""

    @property
    def cancelled(self) -> bool:
        """Whether it was ended before its time."""
        return self.entry.status == CANCELLED


def executed_activity(
    problem: Problem, activity: Activity, entry: Entry, *, running: bool
) -> ExecutedActivity:
    """What an entry says of an activity that has begun. Raises `UnexplainedError`."""
    mode, resources = choices_of(problem, activity, entry)
    start, end = problem.whole_ticks(entry.start), problem.whole_ticks(entry.end)
    return ExecutedActivity(
        entry, start, end, mode, resources, running, entry.rank, entry.last_rank
    )


def previous_place_of(problem: Problem, activity: Activity, entry: Entry) -> PreviousPlace | None:
    """Where an entry has an activity that may still move; None where it does not say all of it."""
    try:
        mode, resources = choices_of(problem, activity, entry)
    except UnexplainedError:
        return None
    if resources is None or (mode is None and activity.details.modes):
        return None
    return PreviousPlace(problem.whole_ticks(entry.start), mode, resources)


def frozen_choices(activity: Activity) -> tuple[int | None, tuple[int, ...]]:
    """The mode and the resource of each use of an activity that happened: it has no others."""
    mode = 0 if activity.details.modes else None
    return mode, tuple(use.alternatives[0] for use in activity.uses)


def as_executed(
    problem: Problem,
    activity: Activity,
    past: ExecutedActivity,
    now: int,
    ranks: Ranks | None = None,
) -> Activity:
    """The activity as it happened: its start is fixed, and so are mode, resources and, unless it
    is running for a duration of its own choice, its end, and those of its `ranks` that are known.

    What was cancelled neither produces nor changes anything when it ends, and earns nothing. What
    has ended demands nothing any more. Releases, latest starts and deadlines were for the time
    before.
    """
    if activity.details.modes and past.mode is None:
        return _begun(activity, past)
    activity = _in_mode(activity, past)
    shortest = longest = past.end - past.start
    if past.running and not activity.is_fixed and not past.cancelled:
        shortest = max(activity.duration_min, now - past.start)
        longest = max(activity.duration_max, shortest)
    apart = _ends_apart(activity, past, ranks)
    if apart:
        longest = shortest + 1
    uses = activity.uses
    demands = activity.open_demands
    if past.resources is not None:
        taken = [r for r in past.resources if r is not None]
        uses = tuple(
            use._replace(alternatives=(r,)) for use, r in zip(activity.uses, taken, strict=True)
        )
        demands = tuple(
            demand._replace(
                alternatives=tuple(
                    k
                    for k in demand.alternatives
                    if taken[demand.use] in problem.contention.pools[k].members
                )
            )
            for demand in activity.open_demands
        )
    details = activity.details
    details = replace(
        details,
        optional=False,
        repeats=None,
        modes=tuple(m._replace(duration_min=shortest, duration_max=longest) for m in details.modes),
        ranks=ranks,
    )
    if longest == 0:
        # (One happening: what was seen to take no time has changed each variable once, at last.)
        changed = {e.var: e for e in sorted(details.effects, key=lambda e: e.at_end)}
        details = replace(details, effects=tuple(changed.values()))
    if past.cancelled:
        details = replace(
            details,
            stock=tuple(c for c in details.stock if not c.at_end),
            conditions=tuple(c for c in details.conditions if c.at != "end"),
            effects=tuple(e for e in details.effects if not e.at_end),
            due=None,
            reward=0,
        )
    # (What it frees at this instant, ranks may still have to do with.)
    frees_now = bool(problem.variables) and past.end == now
    deadline = past.end if apart else activity.deadline
    if shortest == longest or (deadline is not None and deadline < past.start + shortest):
        deadline = None
    return replace(
        activity,
        start=past.start,
        latest_start=None,
        release=min(activity.release, past.start),
        deadline=deadline,
        duration_min=shortest,
        duration_max=longest,
        uses=uses,
        open_demands=demands if past.running or frees_now else (),
        details=details,
    )


def _ends_apart(activity: Activity, past: ExecutedActivity, ranks: Ranks | None) -> bool:
    """Whether what has ended was of a duration that could be chosen, so that its end has a rank of
    its own. It keeps one where it could still be longer, and a deadline says that it is not.
    """
    details = activity.details
    if past.running or past.cancelled or not (details.conditions or details.effects):
        return False
    if ranks is not None and None not in ranks and ranks.start != ranks.end:
        return True
    return not activity.is_fixed and past.end - past.start < activity.duration_max


def _begun(activity: Activity, past: ExecutedActivity) -> Activity:
    """It has started, and nobody has said in which mode."""
    return replace(
        activity,
        start=past.start,
        latest_start=None,
        release=min(activity.release, past.start),
        details=replace(activity.details, optional=False, repeats=None),
    )


def _in_mode(activity: Activity, past: ExecutedActivity) -> Activity:
    """Only the mode that was chosen is left, with the uses that it has."""
    details = activity.details
    if not details.modes or past.mode is None:
        return activity
    mode = details.modes[past.mode]
    kept = activity.uses_in(past.mode)
    return replace(
        with_uses(activity, kept),
        duration_min=mode.duration_min,
        duration_max=mode.duration_max,
        details=replace(details, modes=(mode,), use_modes=tuple(None for _ in kept)),
    )
