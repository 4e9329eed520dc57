"""The past comes first: ranks of the history, and the order at an event's instant.

At the instant of an event, ends come first, then the world changes of the event, then starts. The
history keeps its ranks wherever its times are as planned.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace

from irc.execution.executed import ExecutedActivity
from irc.execution.history import History
from irc.execution.state import key_of
from irc.problem import Activity, Arc, Problem, Ranks


def known_ranks(
    problem: Problem, history: History, activity: Activity, past: ExecutedActivity
) -> Ranks | None:
    """The ranks of an executed occurrence; None without state, or where no rank is known.

    A happening that was observed at another time than planned gets a new rank.
    """
    planned = history.plan.get(key_of(past.entry))
    if planned is None or not problem.has_state:
        return None
    start = past.rank if planned.start == past.entry.start else None
    if past.running:
        return None if start is None else Ranks(start, None, at_least=activity.is_fixed)
    if past.cancelled:
        # (Nothing happens at its end, which was to have a rank of its own.)
        return None if start is None else Ranks(start, start)
    end = past.end_rank if planned.end == past.entry.end else None
    if end is None and (activity.is_fixed or past.cancelled):
        # Start and end have one rank, which is that of an end that was not planned.
        return None
    return None if start is None and end is None else Ranks(start, end)


def without_clashes(problem: Problem, executed: Mapping[int, ExecutedActivity]) -> Problem:
    """The problem in which happenings with known ranks that interfere get their ranks anew.

    What is observed, or changes the world, at an instant that was planned otherwise may come to
    have the time and the rank of something else.
    """
    touched: dict[tuple[int, int, int], list[tuple[int, bool]]] = {}
    for i, past in executed.items():
        activity = problem.activities[i]
        for at_end in (False, True):
            rank = _end_rank(problem, i) if at_end else _start_rank(activity)
            time = past.end if at_end else past.start
            one = past.end == past.start and _end_rank(problem, i) == _start_rank(activity)
            if rank is None or (at_end and one):
                continue
            reads, writes = _touched(activity, at_end=at_end, both=one)
            for var in reads | writes:
                touched.setdefault((time, rank, var), []).append((i, var in writes))
    clashing = {
        i
        for members in touched.values()
        if len({i for i, _ in members}) > 1 and any(written for _, written in members)
        for i, _ in members
    }
    if not clashing:
        return problem
    activities = list(problem.activities)
    for i in clashing:
        details = replace(activities[i].details, ranks=None)
        activities[i] = replace(activities[i], details=details)
    return replace(problem, activities=tuple(activities))


def past_first(
    problem: Problem, executed: Mapping[int, ExecutedActivity], now: int
) -> tuple[Problem, dict[int, ExecutedActivity]]:
    """The problem in which no open happening of this instant comes before the history.

    World changes get the least rank at which they come after all ends.
    """
    changes = [
        i for i in executed if executed[i].by_itself and problem.activities[i].details.ranks is None
    ]
    for time in sorted({now, *(executed[i].start for i in changes)}):
        problem, executed = _at_instant(
            problem, executed, time, [i for i in changes if executed[i].start == time], now
        )
    return problem, dict(executed)


def _at_instant(
    problem: Problem,
    executed: Mapping[int, ExecutedActivity],
    time: int,
    changes: Sequence[int],
    now: int,
) -> tuple[Problem, dict[int, ExecutedActivity]]:
    ended = [
        i
        for i, past in executed.items()
        if past.start < past.end == time and not past.running and _is_concerned(problem, i)
    ]
    unknown = [i for i in ended if _end_rank(problem, i) is None]
    known = max((_end_rank(problem, i) or 0 for i in ended), default=0)
    ranks = _change_ranks(problem, changes, _free_ranks(problem, ended), known + len(unknown))
    activities, ranked = list(problem.activities), dict(executed)
    for i, own in ranks.items():
        details = replace(activities[i].details, ranks=Ranks(own, own))
        activities[i] = replace(activities[i], details=details)
        ranked[i] = replace(executed[i], rank=own, end_rank=own)
    # (Some world changes have their ranks from an earlier plan.)
    had = [f.rank for f in executed.values() if f.by_itself and f.start == time]
    rank = max([known, *had, *ranks.values()])
    later = [
        i
        for i, activity in enumerate(activities)
        if _begins(executed.get(i), time, now)
        and activity.details.ranks is None
        and _is_concerned(problem, i)
    ]
    free = _free_ranks(problem, ended)
    for i in later:
        reads, writes = _touched(activities[i], at_end=False)
        least = max(
            [rank, *(free[var, True] for var in reads), *(free[var, False] for var in writes)]
        )
        if least:
            details = replace(activities[i].details, not_before=(time, least))
            activities[i] = replace(activities[i], details=details)
    arcs = [Arc(i, j, origin=-1) for i in unknown for j in (*changes, *later)]
    return replace(problem, activities=tuple(activities), arcs=(*problem.arcs, *arcs)), ranked


def stock_past_first(
    problem: Problem, executed: Mapping[int, ExecutedActivity], now: int
) -> Problem:
    """The problem in which what starts now changes stock behind what has ended now.

    Its level is then that of the past: what starts may give each other what the past has left, and
    not what it took.
    """
    ended = any(
        past.start < past.end == now
        and not past.running
        and any(change.at_end for change in problem.activities[i].details.stock)
        for i, past in executed.items()
    )
    if not ended:
        return problem
    activities = list(problem.activities)
    for i, activity in enumerate(activities):
        details = activity.details
        if details.all_stock and details.not_before is None and _begins(executed.get(i), now, now):
            activities[i] = replace(activity, details=replace(details, not_before=(now, 0)))
    return replace(problem, activities=tuple(activities))


def _begins(past: ExecutedActivity | None, time: int, now: int) -> bool:
    """Whether an activity has begun, or may begin, at an instant that is now or earlier."""
    return time == now if past is None else past.start == time and not past.by_itself


def _is_concerned(problem: Problem, i: int) -> bool:
    return problem.activities[i].details.touches_world


def _start_rank(activity: Activity) -> int | None:
    """The rank of an executed start, where it is known and cannot get higher."""
    ranks = activity.details.ranks
    return None if ranks is None or ranks.at_least else ranks.start


def _end_rank(problem: Problem, i: int) -> int | None:
    """The rank of an executed end, where it is known."""
    ranks = problem.activities[i].details.ranks
    if ranks is None:
        return None
    return ranks.start if problem.activities[i].is_fixed else ranks.end


def _free_ranks(problem: Problem, ended: Sequence[int]) -> Counter[tuple[int, bool]]:
    """The least rank at which a variable may be read (True) or changed after the ends.

    At that rank no end interferes, not even one whose condition did not hold and binds no more."""
    free: Counter[tuple[int, bool]] = Counter()
    for i in ended:
        rank = 1 + (_end_rank(problem, i) or 0)
        reads, writes = _touched(problem.activities[i], at_end=True)
        for var in writes:
            free[var, True] = max(free[var, True], rank)
        for var in reads | writes:
            free[var, False] = max(free[var, False], rank)
    return free


def _touched(
    activity: Activity, *, at_end: bool, both: bool | None = None
) -> tuple[set[int], set[int]]:
    """The variables (and numbers, by `_number_key`) that a start, or an end, reads and changes.

    The start of an activity of no duration has all reads and changes of its end too, unless it is
    known not to be `both`."""
    details = activity.details
    if both is None:
        both = not activity.duration_min
    asked = [(c.var, c.at) for c in details.conditions]
    asked += [(_number_key(c.number), c.at) for c in details.number_conditions]
    own = "end" if at_end else "start"
    reads = {key for key, at in asked if at == own or (both and not at_end)}
    given = [(e.var, e.at_end) for e in details.effects]
    given += [(_number_key(e.number), e.at_end) for e in details.number_effects]
    writes = {key for key, ends in given if ends == at_end or (both and not at_end)}
    return reads, writes


def _number_key(number: int) -> int:
    """A number where variables are counted by index, too."""
    return -1 - number


def _change_ranks(
    problem: Problem, changes: Sequence[int], free: Counter[tuple[int, bool]], rank: int
) -> dict[int, int]:
    """Ranks of world changes: after the ranks of all ends, and in order for each variable."""
    ranks = {
        i: max(
            [rank, *(free[key, False] for key in _touched(problem.activities[i], at_end=False)[1])]
        )
        for i in changes
    }
    for _ in changes:
        for arc in problem.arcs:
            if arc.before in ranks and arc.after in ranks:
                ranks[arc.after] = max(ranks[arc.after], ranks[arc.before] + 1)
    return ranks
