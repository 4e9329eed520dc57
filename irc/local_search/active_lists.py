"""List schedules of large shops: parametrised active schedules, the most urgent first."""

# Arrays have no types here, and compiled loops take no generators.
# mypy: disable-error-code="no-any-return"

from __future__ import annotations

from irc.local_search.compiled import Ints, Row, Table, compiled

_FAR = 1 << 60

# The rows of a `Shop`, as `irc.local_search.tabu` has them. (A compiled function reads
# constants of its own module only, or it is not compiled again when they change.)
_RELEASE, _BEFORE_AT, _AFTER_AT, _AFTER, _AFTER_LAG = 0, 1, 4, 5, 6
_WAY_AT, _MACHINE, _LASTS = 7, 8, 9

# The rows of a table to work in.
READY = 0
WAITING = 1
ABLE = 2
FREE = 3
FIRST_END = 4
FIRST_WAY = 5
ORDER = 6
WAY = 7
ROWS = 8


@compiled
def _find_first(shop: Ints, work: Ints, machines: int, i: int) -> None:
    """Finds on which of its ways an operation would end first, and when."""
    work[FIRST_END, i] = _FAR
    for w in range(shop[_WAY_AT, i], shop[_WAY_AT, i + 1]):
        m = shop[_MACHINE, w]
        start = work[READY, i]
        if m >= 0:
            start = max(start, work[FREE, m])
        if start + shop[_LASTS, w] < work[FIRST_END, i]:
            work[FIRST_END, i] = start + shop[_LASTS, w]
            work[FIRST_WAY, i] = w


@compiled
def listed(shop: Table, work: Table, machines: int, urgency: Row, percent: int) -> int:
    """The makespan of a list schedule, whose order and ways are in `work`.

    Of the operations on the machine where one could end first, the most urgent is next, of those
    that could start soon enough: at once (0 percent: no machine waits), or before the first end
    (100 percent: active schedules), or between.

    Sources: Giffler and Thompson, "Algorithms for solving production-scheduling problems",
    Operations Research 8 (1960); Storer, Wu, Vaccari, "New search spaces for sequencing problems
    with application to job shop scheduling", Management Science 38 (1992).
    """
    n = len(urgency)
    able = 0
    for m in range(machines):
        work[FREE, m] = 0
    for i in range(n):
        work[READY, i] = shop[_RELEASE, i]
        work[WAITING, i] = shop[_BEFORE_AT, i + 1] - shop[_BEFORE_AT, i]
        if work[WAITING, i] == 0:
            work[ABLE, able] = i
            able += 1
            _find_first(shop, work, machines, i)
    longest = 0
    for k in range(n):
        soonest, machine, earliest = _FAR, -1, _FAR
        for x in range(able):
            i = work[ABLE, x]
            if work[FIRST_END, i] < soonest:
                soonest = work[FIRST_END, i]
                machine = shop[_MACHINE, work[FIRST_WAY, i]]
        for x in range(able):
            i = work[ABLE, x]
            w = work[FIRST_WAY, i]
            if shop[_MACHINE, w] == machine:
                earliest = min(earliest, work[FIRST_END, i] - shop[_LASTS, w])
        limit = earliest + (soonest - earliest) * percent // 100
        at = -1
        for x in range(able):
            i = work[ABLE, x]
            w = work[FIRST_WAY, i]
            if shop[_MACHINE, w] != machine or work[FIRST_END, i] - shop[_LASTS, w] > limit:
                continue
            if at < 0 or urgency[i] > urgency[work[ABLE, at]]:
                at = x
        i = work[ABLE, at]
        able -= 1
        work[ABLE, at] = work[ABLE, able]
        work[ORDER, k] = i
        work[WAY, i] = work[FIRST_WAY, i]
        end = work[FIRST_END, i]
        longest = max(longest, end)
        if machine >= 0:
            work[FREE, machine] = end
            for x in range(able):
                j = work[ABLE, x]
                for w in range(shop[_WAY_AT, j], shop[_WAY_AT, j + 1]):
                    if shop[_MACHINE, w] == machine:
                        _find_first(shop, work, machines, j)
                        break
        for a in range(shop[_AFTER_AT, i], shop[_AFTER_AT, i + 1]):
            j = shop[_AFTER, a]
            work[READY, j] = max(work[READY, j], end + shop[_AFTER_LAG, a])
            work[WAITING, j] -= 1
            if work[WAITING, j] == 0:
                work[ABLE, able] = j
                able += 1
                _find_first(shop, work, machines, j)
    return longest
