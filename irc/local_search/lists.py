"""Simulated annealing over lists of activities, and the schedule that each list stands for.

A solution is an order of all activities that precedence allows, and a way for each. One activity
after another is placed where it ends first: in a line (a pool whose uses follow each other) in the
first gap with room for it and for the set-ups around it, or behind the last use; elsewhere where
the profile has room. Its open times say when it can start, and when its work is done.

A neighbour has one activity, or several of a line, elsewhere in the list, together with those that
precedence keeps before or after them, or in another way. The evaluation of a neighbour ends as soon
as its value is known to be above what would be accepted.

Sources: Kirkpatrick, Gelatt, Vecchi, "Optimization by simulated annealing", Science 220 (1983);
Kolisch, "Serial and parallel resource-constrained project scheduling methods revisited", EJOR 90
(1996), for serial generation.
"""

# Arrays have no types here, and compiled loops take no generators.
# mypy: disable-error-code="no-any-return"

from __future__ import annotations

from irc.local_search.compiled import Ints, Row, Table, Tables, compiled
from irc.local_search.listing import (
    AFTER,
    AFTER_AT,
    AMOUNT,
    BASE_AT,
    BASE_TIME,
    BASE_USED,
    BEFORE,
    BEFORE_AT,
    CAPACITY,
    CLOSE,
    COST,
    DUE,
    ENDING,
    ENDING_AT,
    ENDINGS,
    ENTERED,
    FAMILIES,
    FAMILY,
    FLOW_TIME,
    FROM_END,
    HELD_AT,
    IS_LINE,
    LAG,
    LATEST_END,
    LATEST_START,
    MAKESPAN,
    MAX_TARDINESS,
    MEMBERS,
    NEVER,
    OF_COST,
    OF_SETUP_COST,
    OF_SETUP_TIME,
    OPEN,
    OPEN_AT,
    PARTS,
    PAUSE,
    POOL,
    POOLS,
    RELEASE,
    SETUP_AT,
    SETUP_COST,
    SETUP_TIME,
    SINCE,
    TAIL,
    TARDINESS,
    TARDY,
    TIMES,
    WAY_AT,
    WEIGHT,
    WORK,
)

# The rows of a table to work in.
START = 0
END = 1
WAY = 2  # Of the list in hand; -1: the one that ends first.
NEW = 3  # The list in hand.
LIST = 4  # The list that the search is at, and
LIST_WAY = 5  # its ways.
BEST_LIST = 6
BEST_WAY = 7
BEST_START = 8
BEST_END = 9
MARK = 10
SHARED = 11  # The pools of the activity that moves.
LEFT = 12  # Of what activities end: how many have not ended,
LATEST = 13  # and the latest end of the others.
USES = 14  # The uses of each line, and the places of each profile.
ASIDE = 15
GAP = 16  # No gap of a line is longer.
COUNTS = 17
ROWS = 18

# The columns of the row `COUNTS`.
RANDOM = 0
SIZE = 1
CURRENT = 2
BEST = 3
STAMP = 4
APPENDS = 5  # Whether uses with set-ups go behind the last use.
STEP = 6  # Of the cycle.
LENGTH = 7  # Of the cycle, in steps.
HEAT = 8  # The temperature at which the cycle begins, times 1024.
LONGEST = 9  # The parts of the objective so far:
LATE = 10
LATE_COUNT = 11
LATEST_BY = 12
FLOW = 13
COSTS = 14
BROKEN = 15
COLUMNS = 16

LACKING = 1 << 58
"""The value of a list that breaks limits: this, and more by how much."""


@compiled
def _draw(work: Ints, below: int) -> int:
    """A random number below a limit: the generator of Park and Miller."""
    drawn = work[COUNTS, RANDOM] * 48271 % 2147483647
    work[COUNTS, RANDOM] = drawn
    return drawn % below


# --- placing ------------------------------------------------------------------------------------


@compiled
def _span(plan: Ints, way: int, time: int) -> tuple[int, int]:
    """The first start from a time on that the open times of a way allow, and its end."""
    lasts, times = plan[plan[WORK] + way], plan[plan[TIMES] + way]
    if times < 0:
        return time, time + lasts
    low, last = plan[plan[OPEN_AT] + times], plan[plan[OPEN_AT] + times + 1]
    high = last
    while low < high:
        middle = (low + high) // 2
        if plan[plan[CLOSE] + middle] > time:
            high = middle
        else:
            low = middle + 1
    for k in range(low, last):
        start = max(time, plan[plan[OPEN] + k])
        end = start + lasts
        m = k
        while m < last and end > plan[plan[CLOSE] + m] and plan[plan[PAUSE] + way] >= 0:
            m += 1
            if m < last:
                end += plan[plan[OPEN] + m] - plan[plan[CLOSE] + m - 1]
        if (
            m < last
            and end <= plan[plan[CLOSE] + m]
            and end - start - lasts <= max(0, plan[plan[PAUSE] + way])
        ):
            return start, end
    return NEVER, NEVER


@compiled
def _setup(plan: Ints, pool: int, before: int, after: int) -> int:
    """The time of a set-up."""
    at = plan[plan[SETUP_AT] + pool]
    if at < 0:
        return 0
    return plan[plan[SETUP_TIME] + at + before * plan[plan[FAMILIES] + pool] + after]


@compiled
def _following(work: Ints, lines: Ints, pool: int, start: int) -> int:
    """The place of the first use of a line that starts at a time or later."""
    low, high = 0, work[USES, pool]
    while low < high:
        middle = (low + high) // 2
        if lines[0, pool, middle] >= start:
            high = middle
        else:
            low = middle + 1
    return low


@compiled
def _next_on_line(
    plan: Ints, work: Ints, lines: Ints, pool: int, family: int, start: int, end: int, lasts: int
) -> int:
    """The start itself where a line has room, else a later one to try.

    In no gap that is shorter than `lasts` there is room: it may take longer, but not less.
    """
    last = k = work[USES, pool]
    if lasts <= work[GAP, pool]:
        k = _following(work, lines, pool, start)
    if k:
        free = lines[1, pool, k - 1] + _setup(plan, pool, lines[2, pool, k - 1], family)
    else:
        free = plan[plan[SINCE] + pool] + _setup(plan, pool, 0, family)
    free = max(free, start)
    needed = end - start if free == start else lasts
    while k < last:
        following = lines[2, pool, k]
        if free + needed + _setup(plan, pool, family, following) <= lines[0, pool, k]:
            break
        free = max(free, lines[1, pool, k] + _setup(plan, pool, following, family))
        needed = lasts
        k += 1
    return free


@compiled
def _node(work: Ints, lines: Ints, pool: int, time: int) -> int:
    """The place of the profile of a pool that holds a time."""
    low, high = 0, work[USES, pool]
    while high - low > 1:
        middle = (low + high) // 2
        if lines[0, pool, middle] <= time:
            low = middle
        else:
            high = middle
    return low


@compiled
def _next_in_profile(
    plan: Ints, work: Ints, lines: Ints, pool: int, amount: int, start: int, end: int
) -> int:
    """The start itself where a profile has room, else a later one to try."""
    limit = plan[plan[CAPACITY] + pool] - amount
    last = work[USES, pool]
    k = _node(work, lines, pool, start)
    while k < last and lines[0, pool, k] < end:
        if lines[1, pool, k] > limit:
            while k < last and lines[1, pool, k] > limit:
                k += 1
            return lines[0, pool, k] if k < last else NEVER
        k += 1
    return start


@compiled
def _fit(plan: Ints, work: Ints, lines: Ints, way: int, time: int) -> tuple[int, int]:
    """The first start from a time on at which a way fits, and its end."""
    lasts = plan[plan[WORK] + way]
    while True:
        start, end = _span(plan, way, time)
        if start >= NEVER:
            return NEVER, NEVER
        time = start
        for k in range(plan[plan[HELD_AT] + way], plan[plan[HELD_AT] + way + 1]):
            pool = plan[plan[POOL] + k]
            if plan[plan[IS_LINE] + pool]:
                later = _next_on_line(
                    plan, work, lines, pool, plan[plan[FAMILY] + k], start, end, lasts
                )
            else:
                later = _next_in_profile(
                    plan, work, lines, pool, plan[plan[AMOUNT] + k], start, end
                )
            time = max(time, later)
        if time == start:
            return start, end
        if time >= NEVER:
            return NEVER, NEVER


@compiled
def _make_room(work: Ints, lines: Ints, pool: int, k: int) -> None:
    """Moves what a pool has from a place on by one."""
    count = work[USES, pool]
    work[USES, pool] = count + 1
    for x in range(count, k, -1):
        lines[0, pool, x] = lines[0, pool, x - 1]
        lines[1, pool, x] = lines[1, pool, x - 1]
        lines[2, pool, x] = lines[2, pool, x - 1]


@compiled
def _take_in_line(
    plan: Ints, work: Ints, lines: Ints, pool: int, family: int, start: int, end: int
) -> None:
    """Adds a use to a line. The longest gap is known for lines where uses go into gaps."""
    last = work[USES, pool]
    k = _following(work, lines, pool, start)
    if k == last and not (work[COUNTS, APPENDS] and plan[plan[SETUP_AT] + pool] >= 0):
        free = plan[plan[SINCE] + pool]
        before = 0
        if k:
            free = lines[1, pool, k - 1]
            before = lines[2, pool, k - 1]
        gap = start - free - _setup(plan, pool, before, family)
        work[GAP, pool] = max(work[GAP, pool], gap)
    _make_room(work, lines, pool, k)
    lines[0, pool, k] = start
    lines[1, pool, k] = end
    lines[2, pool, k] = family


@compiled
def _split(work: Ints, lines: Ints, pool: int, time: int) -> int:
    """The place of a profile that begins at a time."""
    k = _node(work, lines, pool, time)
    if lines[0, pool, k] == time:
        return k
    _make_room(work, lines, pool, k + 1)
    lines[0, pool, k + 1] = time
    lines[1, pool, k + 1] = lines[1, pool, k]
    return k + 1


@compiled
def _take(plan: Ints, work: Ints, lines: Ints, way: int, start: int, end: int) -> None:
    """Takes what a way holds."""
    for k in range(plan[plan[HELD_AT] + way], plan[plan[HELD_AT] + way + 1]):
        pool = plan[plan[POOL] + k]
        if plan[plan[IS_LINE] + pool]:
            _take_in_line(plan, work, lines, pool, plan[plan[FAMILY] + k], start, end)
        else:
            first = _split(work, lines, pool, start)
            for x in range(first, _split(work, lines, pool, end)):
                lines[1, pool, x] += plan[plan[AMOUNT] + k]


# --- the schedule of a list ---------------------------------------------------------------------


@compiled
def _clear(plan: Ints, work: Ints, lines: Ints) -> None:
    """Makes the schedule that of no activity."""
    for pool in range(plan[POOLS]):
        work[GAP, pool] = 0
        first = plan[plan[BASE_AT] + pool]
        work[USES, pool] = (
            0 if plan[plan[IS_LINE] + pool] else plan[plan[BASE_AT] + pool + 1] - first
        )
        for k in range(work[USES, pool]):
            lines[0, pool, k] = plan[plan[BASE_TIME] + first + k]
            lines[1, pool, k] = plan[plan[BASE_USED] + first + k]
    for e in range(plan[ENDINGS]):
        work[LEFT, e] = plan[plan[MEMBERS] + e]
        work[LATEST, e] = 0
    for k in range(LONGEST, BROKEN + 1):
        work[COUNTS, k] = 0


@compiled
def _ready(plan: Ints, work: Ints, i: int) -> int:
    """The first start of an activity that its release and those before it allow."""
    time = plan[plan[RELEASE] + i]
    for a in range(plan[plan[BEFORE_AT] + i], plan[plan[BEFORE_AT] + i + 1]):
        j = plan[plan[BEFORE] + a]
        since = work[END, j] if plan[plan[FROM_END] + a] else work[START, j]
        time = max(time, since + plan[plan[LAG] + a])
    return time


@compiled
def _schedule(plan: Ints, work: Ints, lines: Ints, i: int) -> bool:
    """Places an activity where it ends first; False where there is no place."""
    ready = _ready(plan, work, i)
    way = work[WAY, i]
    if way >= 0:
        start, end = _fit(plan, work, lines, way, ready)
    else:
        start, end = NEVER, NEVER
        for w in range(plan[plan[WAY_AT] + i], plan[plan[WAY_AT] + i + 1]):
            begin, over = _fit(plan, work, lines, w, ready)
            if over < end:
                start, end, way = begin, over, w
    if start >= NEVER:
        return False
    work[WAY, i] = way
    work[START, i] = start
    work[END, i] = end
    _take(plan, work, lines, way, start, end)
    return True


@compiled
def _count(plan: Ints, work: Ints, i: int) -> None:
    """Counts in the parts of the objective that an activity has its place."""
    start, end = work[START, i], work[END, i]
    work[COUNTS, LONGEST] = max(work[COUNTS, LONGEST], end + plan[plan[TAIL] + i])
    work[COUNTS, COSTS] += plan[plan[COST] + work[WAY, i]]
    work[COUNTS, BROKEN] += max(0, start - plan[plan[LATEST_START] + i]) + max(
        0, end - plan[plan[LATEST_END] + i]
    )
    for a in range(plan[plan[ENDING_AT] + i], plan[plan[ENDING_AT] + i + 1]):
        e = plan[plan[ENDING] + a]
        work[LEFT, e] -= 1
        work[LATEST, e] = max(work[LATEST, e], end)
        if work[LEFT, e]:
            continue
        weight = plan[plan[WEIGHT] + e]
        over = work[LATEST, e] - plan[plan[DUE] + e]
        if over > 0:
            work[COUNTS, LATE] += weight * over
            work[COUNTS, LATE_COUNT] += weight
            work[COUNTS, LATEST_BY] = max(work[COUNTS, LATEST_BY], weight * over)
        if plan[plan[ENTERED] + e] < NEVER:
            work[COUNTS, FLOW] += weight * (work[LATEST, e] - plan[plan[ENTERED] + e])


@compiled
def _value(plan: Ints, work: Ints) -> int:
    """The objective without set-ups, as far as it is known."""
    parts = plan[PARTS]
    if work[COUNTS, BROKEN]:
        return LACKING + work[COUNTS, BROKEN]
    return (
        plan[parts + MAKESPAN] * work[COUNTS, LONGEST]
        + plan[parts + TARDINESS] * work[COUNTS, LATE]
        + plan[parts + TARDY] * work[COUNTS, LATE_COUNT]
        + plan[parts + MAX_TARDINESS] * work[COUNTS, LATEST_BY]
        + plan[parts + FLOW_TIME] * work[COUNTS, FLOW]
    )


@compiled
def _of_setups(plan: Ints, work: Ints, lines: Ints) -> int:
    """The part of the objective that set-ups have."""
    total = 0
    by_time, by_cost = plan[plan[PARTS] + OF_SETUP_TIME], plan[plan[PARTS] + OF_SETUP_COST]
    if by_time == 0 and by_cost == 0:
        return 0
    for pool in range(plan[POOLS]):
        at, before = plan[plan[SETUP_AT] + pool], 0
        for k in range(work[USES, pool] if at >= 0 else 0):
            after = lines[2, pool, k]
            place = at + before * plan[plan[FAMILIES] + pool] + after
            total += (
                by_time * plan[plan[SETUP_TIME] + place] + by_cost * plan[plan[SETUP_COST] + place]
            )
            before = after
    return total


@compiled
def _evaluate(plan: Ints, work: Ints, lines: Ints, limit: int) -> int:
    """The value of the list in hand, or a number above the limit where it is above that."""
    _clear(plan, work, lines)
    for k in range(work[COUNTS, SIZE]):
        i = work[NEW, k]
        if not _schedule(plan, work, lines, i):
            return NEVER
        _count(plan, work, i)
        if _value(plan, work) > limit:
            return NEVER
    value = _value(plan, work)
    if value >= LACKING:
        return value
    value += plan[plan[PARTS] + OF_COST] * work[COUNTS, COSTS] + _of_setups(plan, work, lines)
    if value < work[COUNTS, BEST]:
        work[COUNTS, BEST] = value
        for k in range(work[COUNTS, SIZE]):
            work[BEST_LIST, k] = work[NEW, k]
            work[BEST_WAY, k] = work[WAY, k]
            work[BEST_START, k] = work[START, k]
            work[BEST_END, k] = work[END, k]
    return value


# --- neighbours ---------------------------------------------------------------------------------


@compiled
def _shift(plan: Ints, work: Ints, low: int, high: int, earlier: bool) -> None:
    """Moves what is marked to one end of a part of the list in hand, with all that must come along.

    That is what precedes it by precedence, if it moves to the beginning, or else what follows it.
    """
    stamp = work[COUNTS, STAMP]
    arcs_at, arcs = (AFTER_AT, AFTER) if earlier else (BEFORE_AT, BEFORE)
    for x in range(high - low + 1):
        i = work[NEW, high - x if earlier else low + x]
        for a in range(plan[plan[arcs_at] + i], plan[plan[arcs_at] + i + 1]):
            if work[MARK, plan[plan[arcs] + a]] == stamp:
                work[MARK, i] = stamp
    at = low
    for first in range(2):
        for k in range(low, high + 1):
            i = work[NEW, k]
            if (work[MARK, i] == stamp) == (earlier == (first == 0)):
                work[ASIDE, at] = i
                at += 1
    for k in range(low, high + 1):
        work[NEW, k] = work[ASIDE, k]


@compiled
def _share_of(plan: Ints, work: Ints, i: int) -> None:
    """Marks the pools that an activity holds."""
    stamp = work[COUNTS, STAMP]
    way = max(plan[plan[WAY_AT] + i], work[LIST_WAY, i])
    for k in range(plan[plan[HELD_AT] + way], plan[plan[HELD_AT] + way + 1]):
        work[SHARED, plan[plan[POOL] + k]] = stamp


@compiled
def _shares(plan: Ints, work: Ints, i: int) -> bool:
    """Whether an activity holds a pool that is marked."""
    stamp = work[COUNTS, STAMP]
    way = max(plan[plan[WAY_AT] + i], work[LIST_WAY, i])
    for k in range(plan[plan[HELD_AT] + way], plan[plan[HELD_AT] + way + 1]):
        if work[SHARED, plan[plan[POOL] + k]] == stamp:
            return True
    return False


@compiled
def _walk(plan: Ints, work: Ints, at: int, count: int, earlier: bool) -> int:
    """The place in the list of the `count`-th rival before (or behind) a place."""
    n = work[COUNTS, SIZE]
    to = at
    k = at
    while count > 0:
        k += -1 if earlier else 1
        if k < 0 or k >= n:
            break
        if _shares(plan, work, work[LIST, k]):
            to = k
            count -= 1
    return to


@compiled
def _distance(work: Ints) -> int:
    """How many rivals an activity passes: often one or two, at times any number."""
    kind = _draw(work, 4)
    if kind < 2:
        return 1 + _draw(work, 2)
    if kind == 2:
        return 1 + _draw(work, 8)
    return 1 + _draw(work, work[COUNTS, SIZE])


@compiled
def _neighbour(plan: Ints, work: Ints) -> bool:
    """Makes a neighbour of the list that the search is at the list in hand; False: it is none."""
    n = work[COUNTS, SIZE]
    for k in range(n):
        work[NEW, k] = work[LIST, k]
        work[WAY, k] = work[LIST_WAY, k]
    work[COUNTS, STAMP] += 1
    stamp = work[COUNTS, STAMP]
    at = _draw(work, n)
    i = work[LIST, at]
    first, ways = plan[plan[WAY_AT] + i], plan[plan[WAY_AT] + i + 1] - plan[plan[WAY_AT] + i]
    chosen = _draw(work, 4) if ways > 1 else 0
    if chosen == 1:
        work[WAY, i] = -1
    elif chosen > 1:
        work[WAY, i] = first + _draw(work, ways)
        if chosen == 2:
            return work[WAY, i] != work[LIST_WAY, i]
    _share_of(plan, work, i)
    earlier = _draw(work, 2) == 0
    to = _walk(plan, work, at, _distance(work), earlier)
    if to == at:
        return chosen > 0
    work[MARK, i] = stamp
    back = at
    if _draw(work, 3) == 0:
        # (A block of rivals moves together.)
        back = _walk(plan, work, at, 1 + _draw(work, 3), not earlier)
        for k in range(min(at, back), max(at, back) + 1):
            if _shares(plan, work, work[LIST, k]):
                work[MARK, work[LIST, k]] = stamp
    elif _draw(work, 3) == 0:
        # (Two rivals change places: the other one goes where this one was, too.)
        _swap(plan, work, at, to)
        return True
    _shift(plan, work, min(to, back), max(to, back), earlier)
    return True


@compiled
def _swap(plan: Ints, work: Ints, one: int, other: int) -> None:
    """Two activities of the list in hand change places, as far as precedence allows."""
    low, high = min(one, other), max(one, other)
    i, j = work[NEW, low], work[NEW, high]
    work[COUNTS, STAMP] += 1
    work[MARK, j] = work[COUNTS, STAMP]
    _shift(plan, work, low, high, True)
    place = low
    while work[NEW, place] != i:
        place += 1
    work[COUNTS, STAMP] += 1
    work[MARK, i] = work[COUNTS, STAMP]
    _shift(plan, work, place, high, False)


# --- the search ---------------------------------------------------------------------------------


@compiled
def _accept(work: Ints, value: int) -> None:
    """Makes the list in hand the one that the search is at, in the order of its starts."""
    n = work[COUNTS, SIZE]
    better = value < work[COUNTS, CURRENT]
    work[COUNTS, CURRENT] = value
    for k in range(n):
        i = work[NEW, k]
        work[LIST_WAY, k] = work[WAY, k]
        x = k
        if better:
            # (Lists are nearly in this order. What starts together keeps its order.)
            while x > 0 and work[START, work[LIST, x - 1]] > work[START, i]:
                work[LIST, x] = work[LIST, x - 1]
                x -= 1
        work[LIST, x] = i


@compiled
def take(plan: Row, work: Table, lines: Tables, order: Row, ways: Row) -> int:
    """The value of a given list with given ways, from which the search goes on."""
    for k in range(work[COUNTS, SIZE]):
        work[NEW, k] = order[k]
        work[WAY, k] = ways[k]
    value = _evaluate(plan, work, lines, NEVER)
    if value < NEVER:
        work[COUNTS, CURRENT] = NEVER
        _accept(work, value)
    return value


@compiled
def warm(plan: Row, work: Table, lines: Tables, count: int) -> int:
    """The mean by which neighbours are worse than the list that the search is at."""
    total, worse = 0, 0
    for _ in range(count):
        if _neighbour(plan, work):
            value = _evaluate(plan, work, lines, NEVER)
            if work[COUNTS, CURRENT] < value < LACKING:
                total += value - work[COUNTS, CURRENT]
                worse += 1
    return total // worse if worse else 0


@compiled
def anneal(
    plan: Row, work: Table, lines: Tables, cooling: Row, chances: Row, steps: int, target: int
) -> None:
    """Goes on with the cycle for some steps, until the target is met or the cycle is over.

    `cooling` has the temperature over the cycle as parts of 1024, `chances` the negative logarithms
    of evenly spread numbers between 0 and 1, times 1024.
    """
    for _ in range(steps):
        if work[COUNTS, BEST] <= target or work[COUNTS, STEP] >= work[COUNTS, LENGTH]:
            return
        heat = (
            work[COUNTS, HEAT]
            * cooling[work[COUNTS, STEP] * len(cooling) // work[COUNTS, LENGTH]]
            // 1024
        )
        work[COUNTS, STEP] += 1
        if not _neighbour(plan, work):
            continue
        chance = chances[_draw(work, len(chances))]
        limit = work[COUNTS, CURRENT] + (
            heat * chance >> 20 if heat < 1 << 40 else heat // 1024 * chance
        )
        value = _evaluate(plan, work, lines, limit)
        if value <= limit:
            _accept(work, value)
