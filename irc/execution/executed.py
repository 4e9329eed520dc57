"""The history in a problem's terms: which activity each entry is of, in ticks and indexes."""

from __future__ import annotations

from dataclasses import dataclass, replace

from irc.model.times import Number
from irc.problem import Activity, Earlier, Problem, Ranks
from irc.schedule import CANCELLED, Entry


@dataclass(frozen=True, slots=True)
class Fact:
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


class UnexplainedError(Exception):
    """An entry names resources, or a mode, that its action cannot have."""

    def __init__(self, entry: Entry) -> None:
        super().__init__(entry.id)
        self.entry = entry


def ticks_of(problem: Problem, time: Number) -> int:
    """A time of the task's unit, which must be a whole number of ticks, in ticks."""
    ticks = time / problem.tick
    if ticks.denominator != 1:
        raise ValueError(f"{time} is not a whole number of ticks of {problem.tick}")
    return int(ticks)


def fact_of(problem: Problem, activity: Activity, entry: Entry, *, running: bool) -> Fact:
    """What an entry says of an activity that has begun. Raises `UnexplainedError`."""
    mode, resources = choices_of(problem, activity, entry)
    start, end = ticks_of(problem, entry.start), ticks_of(problem, entry.end)
    return Fact(entry, start, end, mode, resources, running, entry.rank, entry.last_rank)


def earlier_of(problem: Problem, activity: Activity, entry: Entry) -> Earlier | None:
    """Where an entry has an activity that may still move; None where it does not say all of it."""
    try:
        mode, resources = choices_of(problem, activity, entry)
    except UnexplainedError:
        return None
    if resources is None or (mode is None and activity.details.modes):
        return None
    return Earlier(ticks_of(problem, entry.start), mode, resources)


def choices_of(
    problem: Problem, activity: Activity, entry: Entry
) -> tuple[int | None, tuple[int | None, ...] | None]:
    """The mode and the resource of each use; None for what the entry leaves open."""
    details = activity.details
    mode: int | None = None
    if details.modes:
        if entry.mode is None:
            return None, None
        names = [m.id for m in details.modes]
        if entry.mode not in names:
            raise UnexplainedError(entry)
        mode = names.index(entry.mode)
    relevant = [
        u
        for u in range(len(activity.uses))
        if not details.modes or details.use_mode(u) in (None, mode)
    ]
    if not entry.resources and relevant:
        return mode, None
    index = {resource.id: k for k, resource in enumerate(problem.resources)}
    held: dict[int, int] = {}
    for name, amount in entry.resources.items():
        if name not in index:
            raise UnexplainedError(entry)
        held[index[name]] = amount
    chosen: list[int | None] = [None] * len(activity.uses)
    # Uses with the fewest alternatives first: there is less to take back.
    order = sorted(relevant, key=lambda u: len(activity.uses[u].alternatives))
    if not _explain(activity, order, 0, held, chosen):
        raise UnexplainedError(entry)
    return mode, tuple(chosen)


def _explain(
    activity: Activity,
    order: list[int],
    at: int,
    held: dict[int, int],
    chosen: list[int | None],
) -> bool:
    """Chooses a resource for each use so that exactly what is held is taken."""
    if at == len(order):
        return not any(held.values())
    use = activity.uses[order[at]]
    for r in use.alternatives:
        if held.get(r, 0) >= use.amount:
            held[r] -= use.amount
            chosen[order[at]] = r
            if _explain(activity, order, at + 1, held, chosen):
                return True
            held[r] += use.amount
    chosen[order[at]] = None
    return False


def as_fact(
    problem: Problem, activity: Activity, fact: Fact, now: int, ranks: Ranks | None = None
) -> Activity:
    """The activity as it happened: its start is fixed, and so are mode, resources and, unless it
    is running for a duration of its own choice, its end, and those of its `ranks` that are known.

    What was cancelled neither produces nor changes anything when it ends, and earns nothing. What
    has ended before claims nothing any more. Releases and deadlines were for the time before.
    """
    if activity.details.modes and fact.mode is None:
        return _begun(activity, fact)
    activity = _in_mode(activity, fact)
    shortest = longest = fact.end - fact.start
    if fact.running and not activity.is_fixed and not fact.cancelled:
        shortest = max(activity.duration_min, now - fact.start)
        longest = max(activity.duration_max, shortest)
    apart = _ends_apart(activity, fact, ranks)
    if apart:
        longest = shortest + 1
    uses = activity.uses
    claims = activity.claims
    if fact.resources is not None:
        taken = [r for r in fact.resources if r is not None]
        uses = tuple(
            use._replace(alternatives=(r,)) for use, r in zip(activity.uses, taken, strict=True)
        )
        claims = tuple(
            claim._replace(
                alternatives=tuple(
                    k for k in claim.alternatives if taken[claim.use] in problem.shared[k].members
                )
            )
            for claim in activity.claims
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
    if fact.cancelled:
        details = replace(
            details,
            stock=tuple(c for c in details.stock if not c.at_end),
            conditions=tuple(c for c in details.conditions if c.at != "end"),
            effects=tuple(e for e in details.effects if not e.at_end),
            due=None,
            reward=0,
        )
    # (What it frees at this instant, ranks may still have to do with.)
    frees_now = bool(problem.variables) and fact.end == now
    deadline = fact.end if apart else activity.deadline
    if shortest == longest or (deadline is not None and deadline < fact.start + shortest):
        deadline = None
    return replace(
        activity,
        start=fact.start,
        release=min(activity.release, fact.start),
        deadline=deadline,
        duration_min=shortest,
        duration_max=longest,
        uses=uses,
        claims=claims if fact.running or frees_now else (),
        details=details,
    )


def _ends_apart(activity: Activity, fact: Fact, ranks: Ranks | None) -> bool:
    """Whether what has ended was of a duration that could be chosen, so that its end has a rank of
    its own. It keeps one where it could still be longer, and a deadline says that it is not.
    """
    details = activity.details
    if fact.running or fact.cancelled or not (details.conditions or details.effects):
        return False
    if ranks is not None and None not in ranks and ranks.start != ranks.end:
        return True
    return not activity.is_fixed and fact.end - fact.start < activity.duration_max


def _begun(activity: Activity, fact: Fact) -> Activity:
    """It has started, and nobody has said in which mode."""
    return replace(
        activity,
        start=fact.start,
        release=min(activity.release, fact.start),
        details=replace(activity.details, optional=False, repeats=None),
    )


def _in_mode(activity: Activity, fact: Fact) -> Activity:
    """Only the mode that was chosen is left, with the uses that it has."""
    details = activity.details
    if not details.modes or fact.mode is None:
        return activity
    mode = details.modes[fact.mode]
    kept = [u for u in range(len(activity.uses)) if details.use_mode(u) in (None, fact.mode)]
    place = {u: k for k, u in enumerate(kept)}
    return replace(
        activity,
        duration_min=mode.duration_min,
        duration_max=mode.duration_max,
        uses=tuple(activity.uses[u] for u in kept),
        claims=tuple(c._replace(use=place[c.use]) for c in activity.claims if c.use in place),
        details=replace(details, modes=(mode,), use_modes=tuple(None for _ in kept)),
    )
