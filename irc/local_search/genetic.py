"""Genetic search over activity lists: serial generation, double justification, crossover.

A solution is an order of all activities that precedence allows, and a way for each. Serial schedule
generation makes a schedule of it: one activity after another, each as early as the resources allow.
Then all are moved as late as they can be, in the order of their ends, and as early as they can be
again, in the order of their starts. The list that this leaves is what parents hand on. Parents are
drawn from all of a large population alike, and a child takes the place of the worst: with fewer, or
with the better ones drawn more often, all are soon the same (docs/benchmarks.md).

The profile of all pools is one list of nodes in the order of time, each with the amounts in use
from its time to that of the next one. Where durations are few ticks, there is a node for each tick
from the beginning (a grid), which is some three times faster. The schedule from the end is the same
generation with precedence turned round.

From the end, much has nothing that it must wait for, and would look at all nodes. So a node at
which many have looked in vain is closed: nothing begins there any more. This bounds what generation
takes by a multiple of the nodes; a list of no more activities than `MOST_VISITS` closes none.

Sources: Hartmann, "A competitive genetic algorithm for resource-constrained project scheduling",
Naval Research Logistics 45 (1998); Hartmann, "Project scheduling with multiple modes: a genetic
algorithm", Annals of Operations Research 102 (2001); Valls, Ballestín, Quintanilla, "Justification
and RCPSP: a technique that pays", EJOR 165 (2005).
"""

# Arrays have no types here, and compiled loops take no generators.
# mypy: disable-error-code="no-any-return"
# ruff: noqa: SIM110

from __future__ import annotations

from typing import Annotated

from irc.local_search.compiled import Ints, Row, Table, compiled

Held = tuple[Row, Row, Row]
"""The arrays `WORD`, `AMOUNT` and `GUARD`."""

Project = Annotated[tuple[Row, ...], 23]
"""Activities with ways; times in ticks.

Of activity i, `WAY_AT[i]` to `WAY_AT[i + 1]` are the places of its ways. Of way w, `HELD_AT[w]` to
`HELD_AT[w + 1]` are the places of what it holds in `WORD` and `AMOUNT`, and `USED_AT` those of what
it uses up in `STOCK` and `USED`. `BEFORE` and `AFTER` have the activities that precedence orders,
with lags.

Several pools share a word, each with a field of bits of its own. The field of a profile holds what
is in use, raised so that an amount that does not fit reaches the highest bit of the field: `GUARD`
has these bits of each word. So one sum tells whether all of them fit.
"""

RELEASE = 0
BEFORE_AT = 1
BEFORE = 2
BEFORE_LAG = 3
AFTER_AT = 4
AFTER = 5
AFTER_LAG = 6
WAY_AT = 7
LASTS = 8
HELD_AT = 9
WORD = 10
AMOUNT = 11
USED_AT = 12
STOCK = 13
USED = 14
GUARD = 15
AVAILABLE = 16
NO_RELEASE = 17
BASE_TIME = 18  # Of the profile with nothing on it: times, and
BASE_USE = 19  # all words, one time after another.
URGENCY = 20
LAST_TIME = 21  # The same profile as from its last change on: for the schedule from the end.
LAST_USE = 22

# The rows of a table to work in.
START = 0
FIRST_NODE = 1
LAST_NODE = 2
CHAIN = 3
LIST = 4
WAY = 5
TIME = 6  # Of each node of the profile: its time,
NEXT = 7  # the next node (-1: none),
BUCKET = 8  # and the first activity that begins there.
MARK = 9
BEST_START = 10
BEST_WAY = 11
LEFT = 12  # What is left of each stock.
WAITING = 13
ABLE = 14
COUNTS = 15
VISITS = 16  # Of each node: how many have looked at it in vain,
OPEN = 17  # and the first node that is open, at it or behind it.
LATEST = 18  # Of each part of the time: the last known node before it (0: none).
BEFORE_LIST = 19
ROWS = 20

# The columns of the row `COUNTS`.
RANDOM = 0
NODES = 1
BEST = 2
BIRTHS = 3
IMPROVED_AT = 4
SIZE = 5
JUSTIFIES = 6
STAMP = 7
TICKS = 8  # Of the grid; 0: there is none.
PARTS = 9  # The parts of the time, and the ticks of each.
PART_TICKS = 10
MOST_ROUNDS = 11  # The most rounds of double justification in a row.
COLUMNS = 12

MOST = 1 << 60
"""More than the value of any solution."""

MOST_VISITS = 500
"""The visits in vain after which a node is closed."""

LACKING = 1 << 52
"""The value of a solution that uses up more stock than there is: this and more."""


@compiled
def _draw(work: Ints, below: int) -> int:
    """A random number below a limit: the generator of Park and Miller."""
    drawn = work[COUNTS, RANDOM] * 48271 % 2147483647
    work[COUNTS, RANDOM] = drawn
    return drawn % below


# --- the profile --------------------------------------------------------------------------------


@compiled
def lay_grid(work: Table, use: Table, amounts: Row) -> None:
    """Makes each node that of a tick, with nothing on it."""
    ticks = work[COUNTS, TICKS]
    for k in range(ticks):
        work[TIME, k] = k
        work[NEXT, k] = k + 1
        work[BUCKET, k] = -1
    _clear_grid(use, amounts, ticks)


@compiled
def _clear_grid(use: Ints, amounts: Ints, ticks: int) -> None:
    """Takes everything off the first ticks; `use` has a row for each word here."""
    words = len(use)
    for r in range(words):
        row = use[r]
        for k in range(ticks):
            row[k] = amounts[k * words + r]


@compiled
def _clear(work: Ints, use: Ints, times: Ints, amounts: Ints) -> None:
    """Makes the profile that of no activity."""
    words = use.shape[1]
    count = len(times)
    for k in range(count):
        work[TIME, k] = times[k]
        work[NEXT, k] = k + 1 if k + 1 < count else -1
        work[BUCKET, k] = -1
        work[VISITS, k] = 0
        work[OPEN, k] = k
        for r in range(words):
            use[k, r] = amounts[k * words + r]
    work[COUNTS, NODES] = count
    for part in range(work[COUNTS, PARTS]):
        work[LATEST, part] = 0
    for k in range(count):
        _announce(work, k)


@compiled
def _announce(work: Ints, node: int) -> None:
    """Makes a node known to the part of the time that begins next, as the last one before it."""
    length = work[COUNTS, PART_TICKS]
    part = (work[TIME, node] + length - 1) // length
    if part < work[COUNTS, PARTS] and work[TIME, node] >= work[TIME, work[LATEST, part]]:
        work[LATEST, part] = node


@compiled
def _node_at(work: Ints, node: int, time: int) -> int:
    """The node of a time: the last one that is not later; it is `node` or behind it."""
    part = min(time // work[COUNTS, PART_TICKS], work[COUNTS, PARTS] - 1)
    while part > 0 and work[LATEST, part] == 0:
        part -= 1
    latest = work[LATEST, part]
    if work[TIME, latest] > work[TIME, node]:
        node = latest
    following = work[NEXT, node]
    while following >= 0 and work[TIME, following] <= time:
        node = following
        following = work[NEXT, node]
    return node


@compiled
def _first_open(work: Ints, node: int) -> int:
    """The first node that is open, at a node or behind it."""
    opened = work[OPEN]
    while opened[node] != node:
        opened[node] = opened[opened[node]]
        node = opened[node]
    return node


@compiled
def _split(work: Ints, use: Ints, node: int, time: int) -> int:
    """The node of a time within that of `node`; a new one, where there is none."""
    if work[TIME, node] == time:
        return node
    new = work[COUNTS, NODES]
    work[COUNTS, NODES] = new + 1
    work[TIME, new] = time
    work[NEXT, new] = work[NEXT, node]
    work[BUCKET, new] = -1
    work[VISITS, new] = work[VISITS, node]
    work[OPEN, new] = new if work[OPEN, node] == node else work[OPEN, node]
    work[NEXT, node] = new
    _announce(work, new)
    for r in range(use.shape[1]):
        use[new, r] = use[node, r]
    return new


@compiled
def _is_full(use: Ints, node: int, held: Held, first: int, last: int) -> bool:
    """Whether a node has no room for what a way holds."""
    word, amount, guard = held
    for k in range(first, last):
        if (use[node, word[k]] + amount[k]) & guard[word[k]]:
            return True
    return False


@compiled
def _count_visit(work: Ints, node: int, behind: int) -> None:
    """Counts a visit in vain of the nodes before another one, and closes those with too many."""
    while node != behind:
        following = work[NEXT, node]
        work[VISITS, node] += 1
        if work[VISITS, node] > MOST_VISITS:
            work[OPEN, node] = following
        node = following


@compiled
def _place(
    work: Ints,
    use: Ints,
    held: Held,
    first: int,
    last: int,
    i: int,
    node: int,
    time: int,
    lasts: int,
) -> int:
    """Places an activity as early as it fits from a time on, at or behind a node; its end."""
    node = _node_at(work, node, time)
    if lasts == 0:
        work[START, i] = time
        work[FIRST_NODE, i] = work[LAST_NODE, i] = _split(work, use, node, time)
        return time
    seen = _first_open(work, node)
    if seen != node:
        node, time = seen, work[TIME, seen]
    while True:
        following = work[NEXT, seen]
        if _is_full(use, seen, held, first, last):
            _count_visit(work, node, following)
            node = seen = _first_open(work, following)
            time = work[TIME, node]
        elif following < 0 or work[TIME, following] >= time + lasts:
            break
        else:
            seen = following
    node = _split(work, use, node, time)
    work[START, i] = time
    work[FIRST_NODE, i] = node
    work[LAST_NODE, i] = _hold(work, use, held, first, last, node, time + lasts)
    return time + lasts


@compiled
def _hold(work: Ints, use: Ints, held: Held, first: int, last: int, node: int, end: int) -> int:
    """Enters what a way holds from a node on until a time; the node of that time."""
    word, amount, _ = held
    while True:
        for k in range(first, last):
            use[node, word[k]] += amount[k]
        following = work[NEXT, node]
        if following < 0 or work[TIME, following] > end:
            new = _split(work, use, node, end)
            for k in range(first, last):
                use[new, word[k]] -= amount[k]
            return new
        node = following
        if work[TIME, node] == end:
            return node


@compiled
def _first_fit(use: Ints, word: int, amount: int, guard: int, time: int, lasts: int) -> int:
    """The first time on the grid, from a time on, at which an amount of one word fits."""
    at, end = time, time + lasts
    while at < end:
        if (use[word, at] + amount) & guard:
            end = at + 1 + lasts
        at += 1
    return end - lasts


@compiled
def _place_on_grid(use: Ints, held: Held, first: int, last: int, time: int, lasts: int) -> int:
    """Enters what a way holds as early as it fits from a time on; the time."""
    word, amount, guard = held
    begin = -1
    while begin < time:
        begin = time
        for k in range(first, last):
            time = _first_fit(use, word[k], amount[k], guard[word[k]], time, lasts)
        if last - first == 1:
            break
    for k in range(first, last):
        row, more = word[k], amount[k]
        for at in range(time, time + lasts):
            use[row, at] += more
    return time


# --- serial generation --------------------------------------------------------------------------


@compiled
def _generate_on_grid(
    work: Ints,
    use: Ints,
    held_at: Ints,
    held: Held,
    lasts: Ints,
    before_at: Ints,
    before: Ints,
    before_lag: Ints,
    release: Ints,
    base_use: Ints,
) -> int:
    """The makespan of the list in `work`, as `_generate` has it; nodes are ticks."""
    starts, begins, ends = work[START], work[FIRST_NODE], work[LAST_NODE]
    order, ways, counts = work[LIST], work[WAY], work[COUNTS]
    _clear_grid(use, base_use, counts[NODES])
    longest = 0
    for k in range(counts[SIZE]):
        i = order[k]
        time = release[i]
        for a in range(before_at[i], before_at[i + 1]):
            time = max(time, ends[before[a]] + before_lag[a])
        way = ways[i]
        time = _place_on_grid(use, held, held_at[way], held_at[way + 1], time, lasts[way])
        starts[i] = begins[i] = time
        ends[i] = time + lasts[way]
        longest = max(longest, ends[i])
    counts[NODES] = longest
    return longest


@compiled
def _generate(
    work: Ints,
    use: Ints,
    held_at: Ints,
    held: Held,
    lasts: Ints,
    before_at: Ints,
    before: Ints,
    before_lag: Ints,
    release: Ints,
    base_time: Ints,
    base_use: Ints,
) -> int:
    """The makespan of the list in `work`, each activity as early as the resources allow."""
    if work[COUNTS, TICKS] > 0:
        return _generate_on_grid(
            work, use, held_at, held, lasts, before_at, before, before_lag, release, base_use
        )
    _clear(work, use, base_time, base_use)
    longest = 0
    for k in range(work[COUNTS, SIZE]):
        i = work[LIST, k]
        time, node = release[i], 0
        for a in range(before_at[i], before_at[i + 1]):
            j = before[a]
            end = work[START, j] + lasts[work[WAY, j]] + before_lag[a]
            if end > time or (end == time and node == 0):
                time, node = end, work[LAST_NODE, j]
        way = work[WAY, i]
        end = _place(work, use, held, held_at[way], held_at[way + 1], i, node, time, lasts[way])
        longest = max(longest, end)
    return longest


@compiled
def _sort(work: Ints, row: int, latest_first: bool) -> None:
    """Sorts the list by the nodes of a row; what is at the same node stays in its order.

    With `latest_first` the result is turned round.
    """
    n = work[COUNTS, SIZE]
    order, nodes, chain, bucket = work[LIST], work[row], work[CHAIN], work[BUCKET]
    following = work[NEXT]
    for k in range(n - 1, -1, -1):
        i = order[k]
        chain[i] = bucket[nodes[i]]
        bucket[nodes[i]] = i
    node, k = 0, 0
    while k < n:
        i = bucket[node]
        bucket[node] = -1
        while i >= 0:
            order[n - 1 - k if latest_first else k] = i
            k += 1
            i = chain[i]
        node = following[node]


@compiled
def _forward(project: Project, work: Ints, use: Ints) -> int:
    return _generate(
        work,
        use,
        project[HELD_AT],
        (project[WORD], project[AMOUNT], project[GUARD]),
        project[LASTS],
        project[BEFORE_AT],
        project[BEFORE],
        project[BEFORE_LAG],
        project[RELEASE],
        project[BASE_TIME],
        project[BASE_USE],
    )


@compiled
def _backward(project: Project, work: Ints, use: Ints) -> int:
    """The same from the end: times count back from there."""
    return _generate(
        work,
        use,
        project[HELD_AT],
        (project[WORD], project[AMOUNT], project[GUARD]),
        project[LASTS],
        project[AFTER_AT],
        project[AFTER],
        project[AFTER_LAG],
        project[NO_RELEASE],
        project[LAST_TIME],
        project[LAST_USE],
    )


@compiled
def _lacking(project: Project, work: Ints) -> int:
    """The stock that the ways in `work` use up beyond what there is."""
    stocks = len(project[AVAILABLE])
    if stocks == 0:
        return 0
    for s in range(stocks):
        work[LEFT, s] = project[AVAILABLE][s]
    for i in range(work[COUNTS, SIZE]):
        way = work[WAY, i]
        for k in range(project[USED_AT][way], project[USED_AT][way + 1]):
            work[LEFT, project[STOCK][k]] -= project[USED][k]
    return _missing(project, work)


@compiled
def _missing(project: Project, work: Ints) -> int:
    """The stock that is missing, as the row `LEFT` has it."""
    total = 0
    for s in range(len(project[AVAILABLE])):
        total += max(0, -work[LEFT, s])
    return total


@compiled
def _change(project: Project, work: Ints, i: int, way: int) -> None:
    """Gives an activity another way, and the row `LEFT` what follows from it."""
    old = work[WAY, i]
    for k in range(project[USED_AT][old], project[USED_AT][old + 1]):
        work[LEFT, project[STOCK][k]] += project[USED][k]
    for k in range(project[USED_AT][way], project[USED_AT][way + 1]):
        work[LEFT, project[STOCK][k]] -= project[USED][k]
    work[WAY, i] = way


@compiled
def _evaluate(project: Project, work: Ints, use: Ints, promising: int) -> int:
    """The value of the list in `work`, whose order is then that of its schedule.

    A schedule with a makespan of at most `promising` is justified while that makes it shorter, in
    as many rounds as the row `COUNTS` allows.
    """
    lacking = _lacking(project, work)
    longest = _forward(project, work, use)
    if not lacking:
        _keep_best(work, longest)
    rounds = 0
    while work[COUNTS, JUSTIFIES] and longest <= promising and rounds < work[COUNTS, MOST_ROUNDS]:
        rounds += 1
        for k in range(work[COUNTS, SIZE]):
            work[BEFORE_LIST, k] = work[LIST, k]
        _sort(work, LAST_NODE, True)
        _backward(project, work, use)
        _sort(work, LAST_NODE, True)
        before, longest = longest, _forward(project, work, use)
        if not lacking:
            _keep_best(work, longest)
        if longest > before:  # (It can be where capacities change, or nodes are closed.)
            for k in range(work[COUNTS, SIZE]):
                work[LIST, k] = work[BEFORE_LIST, k]
            longest = _forward(project, work, use)
        if longest >= before:
            break
    _sort(work, FIRST_NODE, False)
    return LACKING + lacking if lacking else longest


@compiled
def _keep_best(work: Ints, value: int) -> None:
    """Keeps the schedule in `work` where it is the best so far."""
    if value >= work[COUNTS, BEST]:
        return
    work[COUNTS, BEST] = value
    for i in range(work[COUNTS, SIZE]):
        work[BEST_START, i] = work[START, i]
        work[BEST_WAY, i] = work[WAY, i]


# --- lists --------------------------------------------------------------------------------------


@compiled
def _supply(project: Project, work: Ints) -> None:
    """Changes ways by chance while that makes less stock lacking, or as little."""
    lacking = _lacking(project, work)
    n = work[COUNTS, SIZE]
    for _ in range(8 * n):
        if lacking == 0:
            return
        i = _draw(work, n)
        first, count = project[WAY_AT][i], project[WAY_AT][i + 1] - project[WAY_AT][i]
        if count == 1:
            continue
        old = work[WAY, i]
        _change(project, work, i, first + _draw(work, count))
        now = _missing(project, work)
        if now > lacking:
            _change(project, work, i, old)
        else:
            lacking = now


@compiled
def draw(project: Project, work: Table, use: Table, spread: int) -> int:
    """The value of a list drawn at random; the more urgent come first, by up to `spread` percent.

    An activity takes one of its ways at random. Without spread, its shortest.
    """
    n = work[COUNTS, SIZE]
    able = 0
    for i in range(n):
        first, last = project[WAY_AT][i], project[WAY_AT][i + 1]
        work[WAY, i] = first + _draw(work, last - first)
        if spread == 0:
            for w in range(first, last):
                if project[LASTS][w] < project[LASTS][work[WAY, i]]:
                    work[WAY, i] = w
        work[WAITING, i] = project[BEFORE_AT][i + 1] - project[BEFORE_AT][i]
        work[MARK, i] = project[URGENCY][i] * (100 + _draw(work, spread + 1)) // 100
        if work[WAITING, i] == 0:
            work[ABLE, able] = i
            able += 1
    for k in range(n):
        at = 0
        for x in range(1, able):
            if work[MARK, work[ABLE, x]] > work[MARK, work[ABLE, at]]:
                at = x
        i = work[ABLE, at]
        able -= 1
        work[ABLE, at] = work[ABLE, able]
        work[LIST, k] = i
        for a in range(project[AFTER_AT][i], project[AFTER_AT][i + 1]):
            j = project[AFTER][a]
            work[WAITING, j] -= 1
            if work[WAITING, j] == 0:
                work[ABLE, able] = j
                able += 1
    for i in range(n):
        work[MARK, i] = 0
    _supply(project, work)
    return _evaluate(project, work, use, MOST)


@compiled
def take(project: Project, work: Table, use: Table, order: Row, ways: Row) -> int:
    """The value of a given list with given ways."""
    for k in range(work[COUNTS, SIZE]):
        work[LIST, k] = order[k]
        work[WAY, k] = ways[k]
    return _evaluate(project, work, use, MOST)


@compiled
def _cross(work: Ints, lists: Ints, ways: Ints, one: int, other: int) -> None:
    """Two-point crossover: the middle part in the order of the other parent, with its ways."""
    n = work[COUNTS, SIZE]
    work[COUNTS, STAMP] += 1
    stamp = work[COUNTS, STAMP]
    first = _draw(work, n)
    last = first + 1 + _draw(work, n - first)
    for k in range(first):
        i = lists[one, k]
        work[LIST, k] = i
        work[WAY, i] = ways[one, i]
        work[MARK, i] = stamp
    k = first
    for x in range(n):
        if k >= last:
            break
        i = lists[other, x]
        if work[MARK, i] != stamp:
            work[LIST, k] = i
            work[WAY, i] = ways[other, i]
            work[MARK, i] = stamp
            k += 1
    for x in range(n):
        i = lists[one, x]
        if work[MARK, i] != stamp:
            work[LIST, k] = i
            work[WAY, i] = ways[one, i]
            k += 1


@compiled
def _mutate(project: Project, work: Ints) -> None:
    """Swaps neighbours in the list by chance, and gives some activities another way."""
    n = work[COUNTS, SIZE]
    for k in range(n - 1):
        if _draw(work, 20) == 0:
            i, j = work[LIST, k], work[LIST, k + 1]
            free = True
            for a in range(project[BEFORE_AT][j], project[BEFORE_AT][j + 1]):
                free = free and project[BEFORE][a] != i
            if free:
                work[LIST, k] = j
                work[LIST, k + 1] = i
    for i in range(n):
        count = project[WAY_AT][i + 1] - project[WAY_AT][i]
        if count > 1 and _draw(work, 30) == 0:
            work[WAY, i] = project[WAY_AT][i] + _draw(work, count)
    _supply(project, work)


@compiled
def _extremes(values: Ints) -> tuple[int, int]:
    """The places of the best and of the worst value, of equal ones the first."""
    best = worst = 0
    for p in range(1, len(values)):
        if values[p] < values[best]:
            best = p
        if values[p] > values[worst]:
            worst = p
    return best, worst


@compiled
def _keep(
    work: Ints, lists: Ints, starts: Ints, ways: Ints, values: Ints, worst: int, value: int
) -> None:
    """Puts the list in `work` in place of the worst, unless it is a copy."""
    n = work[COUNTS, SIZE]
    for p in range(len(values)):
        if values[p] == value:
            k = 0
            while k < n and starts[p, k] == work[START, k] and ways[p, k] == work[WAY, k]:
                k += 1
            if k == n:
                return
    store(work, lists, starts, ways, values, worst, value)


@compiled
def store(
    work: Table, lists: Table, starts: Table, ways: Table, values: Row, p: int, value: int
) -> None:
    """Puts the list in `work` at a place of the population."""
    values[p] = value
    for k in range(work[COUNTS, SIZE]):
        lists[p, k] = work[LIST, k]
        starts[p, k] = work[START, k]
        ways[p, k] = work[WAY, k]


@compiled
def evolve(
    project: Project,
    work: Table,
    use: Table,
    lists: Table,
    starts: Table,
    ways: Table,
    values: Row,
    births: int,
    target: int,
) -> None:
    """Lets a population have children, until one has a schedule that ends by `target`."""
    for _ in range(births):
        if work[COUNTS, BEST] <= target:
            return
        work[COUNTS, BIRTHS] += 1
        one = _draw(work, len(values))
        _cross(work, lists, ways, one, _draw(work, len(values)))
        _mutate(project, work)
        best, worst = _extremes(values)
        value = _evaluate(project, work, use, values[worst] + values[worst] // 100)
        if value < values[best]:
            work[COUNTS, IMPROVED_AT] = work[COUNTS, BIRTHS]
        if value <= values[worst]:
            _keep(work, lists, starts, ways, values, worst, value)
