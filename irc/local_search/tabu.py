"""Tabu search over the sequences of machines: moves in critical blocks, and to other machines.

A solution is a way (machine and duration) for each operation and a topological order of them all;
the sequence of each machine follows from it. In each step a critical path is drawn at random.
Within its blocks operations move to the ends of the block, and the first and the last one move
inwards (the neighbourhood N7); an operation with several ways moves to another one, between two
operations of that machine. Moves are judged by estimates from heads and tails, and done after an
exact test that no cycle arises. The order is mended within the segment that a move concerns, heads
are found again from there on, and tails from there back: nearly half of them change, so that to
look for those that do takes longer than to find them all.

Sources: Nowicki and Smutnicki, "A fast taboo search algorithm for the job shop problem", Management
Science 42 (1996); Balas and Vazacopoulos, "Guided local search with shifting bottleneck for job
shop scheduling", Management Science 44 (1998); Zhang, Li, Guan, Rao, "A tabu search algorithm with
a new neighborhood structure for the job shop scheduling problem", Computers & Operations Research
34 (2007); Mastrolilli and Gambardella, "Effective neighbourhood functions for the flexible job shop
problem", Journal of Scheduling 3 (2000).
"""

# Arrays have no types here, and compiled loops take no generators.
# mypy: disable-error-code="no-any-return"

from __future__ import annotations

from irc.local_search.compiled import Ints, Row, Table, compiled

# The rows of a walk: a solution, what follows from it, the best one so far, and room to work in.
WAY = 0
DURATION = 1
LEFT = 2  # The neighbours on a machine (-1: none), and
RIGHT = 3
FIRST = 4  # the first operation of each machine.
ORDER = 5
POSITION = 6
HEAD = 7  # The earliest start,
READY = 8  # as far as precedence alone makes it.
TAIL = 9  # The time from the end to the end of the schedule,
REST = 10  # as far as precedence alone makes it.
PATH = 11
SCRATCH = 12
MARK = 13
SEGMENT = 14
BEST_WAY = 15
BEST_ORDER = 16
BEST_HEAD = 17
COUNTS = 18
MOVE = 19
LAST = 20  # The operations that nothing must follow.
ROWS = 21

# The columns of the row `COUNTS`.
MAKESPAN = 0
BEST = 1
STEP = 2
IMPROVED_AT = 3
RANDOM = 4
STAMP = 5
SIZE = 6
MACHINES = 7
ORDERS = 8
REACH = 9  # The most places that a move goes within a block.
LAST_COUNT = 10

# The columns of the row `MOVE`: the best move, and one that is tabu, drawn at random.
_KIND, _WHAT, _WHERE, _TO, _VALUE, _TIES = 0, 1, 2, 3, 4, 5
_TABU = 6

COLUMNS = 12
"""The least number of columns of a walk; it has one for each operation and each machine, too."""

# What a move does.
_NONE = 0
_AFTER = 1
_BEFORE = 2
_ELSEWHERE = 3

_FAR = 1 << 60


Shop = Table
"""Operations, each of which holds one machine or none; times in ticks.

A table with these rows. Of operation i, `WAY_AT[i]` to `WAY_AT[i + 1]` are the places of its ways
in `MACHINE` (-1: none) and `LASTS`. In the same way `BEFORE` and `AFTER` have the operations that
precedence orders, with their lags.
"""

RELEASE = 0
BEFORE_AT = 1
BEFORE = 2
BEFORE_LAG = 3
AFTER_AT = 4
AFTER = 5
AFTER_LAG = 6
WAY_AT = 7
MACHINE = 8
LASTS = 9


@compiled
def _draw(walk: Ints, below: int) -> int:
    """A random number below a limit: the generator of Park and Miller."""
    drawn = walk[COUNTS, RANDOM] * 48271 % 2147483647
    walk[COUNTS, RANDOM] = drawn
    return drawn % below


# --- heads and tails ----------------------------------------------------------------------------


@compiled
def _find_heads(shop: Shop, walk: Ints, low: int) -> None:
    """Finds heads again from a position of the order on."""
    for k in range(low, walk[COUNTS, SIZE]):
        i = walk[ORDER, k]
        time = shop[RELEASE, i]
        for a in range(shop[BEFORE_AT, i], shop[BEFORE_AT, i + 1]):
            j = shop[BEFORE, a]
            time = max(time, walk[HEAD, j] + walk[DURATION, j] + shop[BEFORE_LAG, a])
        walk[READY, i] = time
        j = walk[LEFT, i]
        if j >= 0:
            time = max(time, walk[HEAD, j] + walk[DURATION, j])
        walk[HEAD, i] = time


@compiled
def _find_tails(shop: Shop, walk: Ints, high: int) -> None:
    """Finds tails again from a position of the order back."""
    for k in range(high, -1, -1):
        i = walk[ORDER, k]
        time = 0
        for a in range(shop[AFTER_AT, i], shop[AFTER_AT, i + 1]):
            j = shop[AFTER, a]
            time = max(time, walk[DURATION, j] + walk[TAIL, j] + shop[AFTER_LAG, a])
        walk[REST, i] = time
        j = walk[RIGHT, i]
        if j >= 0:
            time = max(time, walk[DURATION, j] + walk[TAIL, j])
        walk[TAIL, i] = time


@compiled
def _find_makespan(walk: Ints) -> None:
    longest = 0
    for k in range(walk[COUNTS, LAST_COUNT]):
        i = walk[LAST, k]
        longest = max(longest, walk[HEAD, i] + walk[DURATION, i])
    walk[COUNTS, MAKESPAN] = longest


@compiled
def _find_last(shop: Shop, walk: Ints) -> None:
    """Finds the operations that nothing must follow: one of them ends last."""
    count = 0
    for i in range(walk[COUNTS, SIZE]):
        followed = False
        for a in range(shop[AFTER_AT, i], shop[AFTER_AT, i + 1]):
            followed = followed or shop[AFTER_LAG, a] >= 0
        if not followed:
            walk[LAST, count] = i
            count += 1
    walk[COUNTS, LAST_COUNT] = count


@compiled
def load(shop: Shop, walk: Table, tabu: Row, order: Row, way: Row) -> None:
    """Makes a solution, of a topological order and ways, the current one; nothing is tabu."""
    n = len(order)
    for m in range(walk[COUNTS, MACHINES]):
        walk[FIRST, m] = -1
        walk[SEGMENT, m] = -1
    for k in range(n):
        i = order[k]
        walk[ORDER, k] = i
        walk[POSITION, i] = k
        walk[WAY, i] = way[i]
        walk[DURATION, i] = shop[LASTS, way[i]]
        walk[LEFT, i] = -1
        walk[RIGHT, i] = -1
        m = shop[MACHINE, way[i]]
        if m < 0:
            continue
        last = walk[SEGMENT, m]
        walk[LEFT, i] = last
        if last < 0:
            walk[FIRST, m] = i
        else:
            walk[RIGHT, last] = i
        walk[SEGMENT, m] = i
    for k in range(len(tabu)):
        tabu[k] = 0
    walk[COUNTS, STEP] = 0
    walk[COUNTS, IMPROVED_AT] = 0
    _find_last(shop, walk)
    _find_heads(shop, walk, 0)
    _find_tails(shop, walk, n - 1)
    _find_makespan(walk)
    walk[COUNTS, BEST] = _FAR
    _keep_if_better(walk)


@compiled
def _keep_if_better(walk: Ints) -> None:
    """Keeps the current solution where it is the best so far."""
    if walk[COUNTS, MAKESPAN] >= walk[COUNTS, BEST]:
        return
    walk[COUNTS, BEST] = walk[COUNTS, MAKESPAN]
    walk[COUNTS, IMPROVED_AT] = walk[COUNTS, STEP]
    for k in range(walk[COUNTS, SIZE]):
        walk[BEST_ORDER, k] = walk[ORDER, k]
        walk[BEST_WAY, k] = walk[WAY, k]
        walk[BEST_HEAD, k] = walk[HEAD, k]


# --- changes of sequences -----------------------------------------------------------------------


@compiled
def _unlink(shop: Shop, walk: Ints, i: int) -> None:
    """Takes an operation out of the sequence of its machine."""
    before, after = walk[LEFT, i], walk[RIGHT, i]
    if before >= 0:
        walk[RIGHT, before] = after
    else:
        m = shop[MACHINE, walk[WAY, i]]
        if m >= 0:
            walk[FIRST, m] = after
    if after >= 0:
        walk[LEFT, after] = before
    walk[LEFT, i] = -1
    walk[RIGHT, i] = -1


@compiled
def _link(shop: Shop, walk: Ints, i: int, before: int, after: int) -> None:
    """Puts an operation between two of its machine (-1: there is none)."""
    walk[LEFT, i] = before
    walk[RIGHT, i] = after
    if after >= 0:
        walk[LEFT, after] = i
    if before >= 0:
        walk[RIGHT, before] = i
    else:
        m = shop[MACHINE, walk[WAY, i]]
        if m >= 0:
            walk[FIRST, m] = i


@compiled
def _put(walk: Ints, at: int, i: int) -> None:
    walk[ORDER, at] = i
    walk[POSITION, i] = at


@compiled
def _reorder_later(shop: Shop, walk: Ints, i: int, behind: int) -> bool:
    """Mends the order where `i` now comes behind an operation that was later; False: a cycle.

    What follows from `i` within the segment moves behind it too.
    """
    low, high = walk[POSITION, i], walk[POSITION, behind]
    walk[COUNTS, STAMP] += 1
    stamp = walk[COUNTS, STAMP]
    walk[MARK, i] = stamp
    moved = 0
    for k in range(low, high + 1):
        x = walk[ORDER, k]
        follows = walk[MARK, x] == stamp
        if not follows:
            follows = walk[LEFT, x] >= 0 and walk[MARK, walk[LEFT, x]] == stamp
            for a in range(shop[BEFORE_AT, x], shop[BEFORE_AT, x + 1]):
                follows = follows or walk[MARK, shop[BEFORE, a]] == stamp
        if follows:
            if x == behind:
                return False
            walk[MARK, x] = stamp
            walk[SEGMENT, moved] = x
            moved += 1
    at = low
    for k in range(low, high + 1):
        x = walk[ORDER, k]
        if walk[MARK, x] != stamp:
            _put(walk, at, x)
            at += 1
    for k in range(moved):
        _put(walk, at + k, walk[SEGMENT, k])
    return True


@compiled
def _reorder_earlier(shop: Shop, walk: Ints, i: int, ahead: int) -> bool:
    """Mends the order where `i` now comes before an operation that was earlier; False: a cycle."""
    low, high = walk[POSITION, ahead], walk[POSITION, i]
    walk[COUNTS, STAMP] += 1
    stamp = walk[COUNTS, STAMP]
    walk[MARK, i] = stamp
    moved = 0
    for k in range(high, low - 1, -1):
        x = walk[ORDER, k]
        precedes = walk[MARK, x] == stamp
        if not precedes:
            precedes = walk[RIGHT, x] >= 0 and walk[MARK, walk[RIGHT, x]] == stamp
            for a in range(shop[AFTER_AT, x], shop[AFTER_AT, x + 1]):
                precedes = precedes or walk[MARK, shop[AFTER, a]] == stamp
        if precedes:
            if x == ahead:
                return False
            walk[MARK, x] = stamp
            walk[SEGMENT, moved] = x
            moved += 1
    at = high
    for k in range(high, low - 1, -1):
        x = walk[ORDER, k]
        if walk[MARK, x] != stamp:
            _put(walk, at, x)
            at -= 1
    for k in range(moved):
        _put(walk, at - k, walk[SEGMENT, k])
    return True


@compiled
def _insert(shop: Shop, walk: Ints, i: int, way: int, before: int, after: int) -> bool:
    """Moves an operation to a way, between two of its machine; False, and no change: a cycle."""
    old_before, old_after, old_way = walk[LEFT, i], walk[RIGHT, i], walk[WAY, i]
    _unlink(shop, walk, i)
    walk[WAY, i] = way
    walk[DURATION, i] = shop[LASTS, way]
    _link(shop, walk, i, before, after)
    low = high = walk[POSITION, i]
    fits = True
    if before >= 0 and walk[POSITION, before] > low:
        high = walk[POSITION, before]
        fits = _reorder_later(shop, walk, i, before)
    elif after >= 0 and walk[POSITION, after] < low:
        low = walk[POSITION, after]
        fits = _reorder_earlier(shop, walk, i, after)
    if fits:
        _find_heads(shop, walk, low)
        _find_tails(shop, walk, high)
        _find_makespan(walk)
        return True
    _unlink(shop, walk, i)
    walk[WAY, i] = old_way
    walk[DURATION, i] = shop[LASTS, old_way]
    _link(shop, walk, i, old_before, old_after)
    return False


# --- estimates ----------------------------------------------------------------------------------


@compiled
def _end_of(walk: Ints, i: int) -> int:
    return 0 if i < 0 else walk[HEAD, i] + walk[DURATION, i]


@compiled
def _rest_from(walk: Ints, i: int) -> int:
    return 0 if i < 0 else walk[DURATION, i] + walk[TAIL, i]


@compiled
def _estimate_after(walk: Ints, u: int, v: int) -> int:
    """About the longest path through those from `u` to `v` once `u` is right behind `v`."""
    end = _end_of(walk, walk[LEFT, u])
    first = walk[RIGHT, u]
    x = first
    while True:
        start = max(walk[READY, x], end)
        walk[SCRATCH, x] = start
        end = start + walk[DURATION, x]
        if x == v:
            break
        x = walk[RIGHT, x]
    rest = max(_rest_from(walk, walk[RIGHT, v]), walk[REST, u]) + walk[DURATION, u]
    longest = max(walk[READY, u], end) + rest
    while True:
        rest = max(walk[REST, x], rest) + walk[DURATION, x]
        longest = max(longest, walk[SCRATCH, x] + rest)
        if x == first:
            return longest
        x = walk[LEFT, x]


@compiled
def _estimate_before(walk: Ints, v: int, u: int) -> int:
    """About the longest path through those from `u` to `v` once `v` is right before `u`."""
    start = max(walk[READY, v], _end_of(walk, walk[LEFT, u]))
    end = start + walk[DURATION, v]
    x = u
    while x != v:
        walk[SCRATCH, x] = max(walk[READY, x], end)
        end = walk[SCRATCH, x] + walk[DURATION, x]
        x = walk[RIGHT, x]
    rest = _rest_from(walk, walk[RIGHT, v])
    longest = 0
    x = walk[LEFT, v]
    while True:
        rest = max(walk[REST, x], rest) + walk[DURATION, x]
        longest = max(longest, walk[SCRATCH, x] + rest)
        if x == u:
            break
        x = walk[LEFT, x]
    rest = max(walk[REST, v], rest) + walk[DURATION, v]
    return max(longest, start + rest)


# --- what is tabu -------------------------------------------------------------------------------


@compiled
def _arc(walk: Ints, before: int, after: int) -> int:
    """The place in `arcs` of an order of two operations (of very many, several share one)."""
    return (before * walk[COUNTS, SIZE] + after) & (walk[COUNTS, ORDERS] - 1)


@compiled
def _is_tabu_after(walk: Ints, tabu: Ints, u: int, v: int) -> bool:
    x = u
    while x != v:
        x = walk[RIGHT, x]
        if tabu[_arc(walk, x, u)] > walk[COUNTS, STEP]:
            return True
    return False


@compiled
def _is_tabu_before(walk: Ints, tabu: Ints, v: int, u: int) -> bool:
    x = v
    while x != u:
        x = walk[LEFT, x]
        if tabu[_arc(walk, v, x)] > walk[COUNTS, STEP]:
            return True
    return False


@compiled
def _forbid(walk: Ints, tabu: Ints, kind: int, i: int, other: int, until: int) -> None:
    """Makes the orders that a move undoes tabu."""
    x = i
    while x != other:
        if kind == _AFTER:
            x = walk[RIGHT, x]
            tabu[_arc(walk, i, x)] = until
        else:
            x = walk[LEFT, x]
            tabu[_arc(walk, x, i)] = until


# --- moves --------------------------------------------------------------------------------------


@compiled
def _offer(walk: Ints, kind: int, i: int, where: int, to: int, value: int, banned: bool) -> None:
    """Takes a move as the best one if it is; among equals, and of tabu ones, by chance.

    A tabu move is one all the same if it seems to give a better schedule than the best so far. To
    another way it is not: such an estimate knows only the paths through the operation, and would
    seem so too often.
    """
    at = 0
    if banned and (value >= walk[COUNTS, BEST] or kind == _ELSEWHERE):
        at = _TABU
    elif value > walk[MOVE, _VALUE]:
        return
    elif value < walk[MOVE, _VALUE]:
        walk[MOVE, _TIES] = 0
    walk[MOVE, at + _TIES] += 1
    if _draw(walk, walk[MOVE, at + _TIES]) == 0:
        walk[MOVE, at + _KIND] = kind
        walk[MOVE, at + _WHAT] = i
        walk[MOVE, at + _WHERE] = where
        walk[MOVE, at + _TO] = to
        walk[MOVE, at + _VALUE] = value


@compiled
def _offer_after(walk: Ints, tabu: Ints, u: int, v: int) -> None:
    if walk[REST, u] <= walk[DURATION, v] + walk[TAIL, v]:
        value = _estimate_after(walk, u, v)
        _offer(walk, _AFTER, u, v, 0, value, _is_tabu_after(walk, tabu, u, v))


@compiled
def _offer_before(walk: Ints, tabu: Ints, v: int, u: int) -> None:
    if walk[HEAD, u] + walk[DURATION, u] >= walk[READY, v]:
        value = _estimate_before(walk, v, u)
        _offer(walk, _BEFORE, v, u, 0, value, _is_tabu_before(walk, tabu, v, u))


@compiled
def _offer_block(walk: Ints, tabu: Ints, first: int, last: int) -> None:
    """The moves within a critical block, from its first to its last operation.

    None goes further than `REACH` in the row `COUNTS`.
    """
    reach, length, x = walk[COUNTS, REACH], 0, first
    while x != last:
        length += 1
        x = walk[RIGHT, x]
    for side in range(2):
        x, k = first, 0
        while True:
            near_first, near_last = k <= reach, length - k <= reach
            u, v = (x, last) if side == 0 else (first, x)
            if u != v and (side == 0 or v != last) and (near_last if side == 0 else near_first):
                _offer_after(walk, tabu, u, v)
            u, v = (first, x) if side == 0 else (x, last)
            near = near_first if side == 0 else near_last
            if u != v and walk[RIGHT, u] != v and (side == 0 or u != first) and near:
                _offer_before(walk, tabu, v, u)
            if x == last:
                break
            x, k = walk[RIGHT, x], k + 1


@compiled
def _offer_elsewhere(shop: Shop, walk: Ints, tabu: Ints, i: int) -> None:
    """The moves of an operation to its other ways, each to the best place on that machine.

    Places before those that end before it is ready, or behind those whose rest is shorter than
    its own, are never better.
    """
    ready, rest = walk[READY, i], walk[REST, i]
    for way in range(shop[WAY_AT, i], shop[WAY_AT, i + 1]):
        lasts = shop[LASTS, way]
        banned = tabu[walk[COUNTS, ORDERS] + way] > walk[COUNTS, STEP]
        if way == walk[WAY, i] or (not banned and ready + lasts + rest > walk[MOVE, _VALUE]):
            continue
        m = shop[MACHINE, way]
        least, where = _FAR, -1
        a = -1
        b = -1 if m < 0 else walk[FIRST, m]
        while True:
            if b == i:
                b = walk[RIGHT, b]
            if a >= 0 and walk[DURATION, a] + walk[TAIL, a] < rest:
                break
            if b < 0 or walk[HEAD, b] + walk[DURATION, b] >= ready:
                value = max(ready, _end_of(walk, a)) + lasts + max(rest, _rest_from(walk, b))
                if value < least:
                    least, where = value, a
            if b < 0:
                break
            a, b = b, walk[RIGHT, b]
        if least < _FAR:
            _offer(walk, _ELSEWHERE, i, where, way, least, banned)


@compiled
def _find_path(shop: Shop, walk: Ints) -> int:
    """The length of a critical path, drawn at random; `path` has it from its end back."""
    end, count = -1, 0
    for k in range(walk[COUNTS, LAST_COUNT]):
        i = walk[LAST, k]
        if walk[HEAD, i] + walk[DURATION, i] == walk[COUNTS, MAKESPAN]:
            count += 1
            if _draw(walk, count) == 0:
                end = i
    length = 0
    i = end
    while i >= 0:
        walk[PATH, length] = i
        length += 1
        start = walk[HEAD, i]
        following, count = -1, 0
        j = walk[LEFT, i]
        if j >= 0 and walk[HEAD, j] + walk[DURATION, j] == start:
            following, count = j, 1
        if walk[READY, i] == start and start > shop[RELEASE, i]:
            for a in range(shop[BEFORE_AT, i], shop[BEFORE_AT, i + 1]):
                j = shop[BEFORE, a]
                if walk[HEAD, j] + walk[DURATION, j] + shop[BEFORE_LAG, a] == start:
                    count += 1
                    if _draw(walk, count) == 0:
                        following = j
        i = following
    return length


@compiled
def _offer_all(shop: Shop, walk: Ints, tabu: Ints) -> None:
    """The moves on a critical path: within its blocks, and of its operations to other ways."""
    walk[MOVE, _KIND] = _NONE
    walk[MOVE, _VALUE] = _FAR
    walk[MOVE, _TIES] = 0
    walk[MOVE, _TABU + _KIND] = _NONE
    walk[MOVE, _TABU + _TIES] = 0
    length = _find_path(shop, walk)
    k = 0
    while k < length:
        last = walk[PATH, k]
        first = last
        k += 1
        while k < length and walk[LEFT, first] == walk[PATH, k] and walk[PATH, k] >= 0:
            first = walk[PATH, k]
            k += 1
        if first != last:
            _offer_block(walk, tabu, first, last)
    for k in range(length):
        i = walk[PATH, k]
        if shop[WAY_AT, i + 1] - shop[WAY_AT, i] > 1:
            _offer_elsewhere(shop, walk, tabu, i)


@compiled
def _do(shop: Shop, walk: Ints, tabu: Ints, at: int, tenure: int) -> bool:
    """Does the move at a place of `move`; whether there is one, and it makes no cycle."""
    kind, i = walk[MOVE, at + _KIND], walk[MOVE, at + _WHAT]
    if kind == _NONE:
        return False
    until = walk[COUNTS, STEP] + tenure
    old = walk[WAY, i]
    way = old
    before = after = walk[MOVE, at + _WHERE]
    if kind == _ELSEWHERE:
        way = walk[MOVE, at + _TO]
        m = shop[MACHINE, way]
        if before >= 0:
            after = walk[RIGHT, before]
        elif m >= 0:
            after = walk[FIRST, m]
        if after == i:
            after = walk[RIGHT, i]
    else:
        _forbid(walk, tabu, kind, i, before, until)
        if kind == _AFTER:
            after = walk[RIGHT, before]
        else:
            before = walk[LEFT, after]
    if not _insert(shop, walk, i, way, before, after):
        return False
    if kind == _ELSEWHERE:
        tabu[walk[COUNTS, ORDERS] + old] = until + shop[WAY_AT, i + 1] - shop[WAY_AT, i]
    return True


@compiled
def search(shop: Shop, walk: Table, tabu: Row, steps: int, patience: int, target: int) -> int:
    """Searches on; the number of steps done.

    It ends after `steps`, after `patience` steps without a better schedule, or with one that
    ends by `target`.
    """
    n = walk[COUNTS, SIZE]
    machines = max(1, walk[COUNTS, MACHINES])
    tenure = 10 + n // machines // machines
    spread = max(4, tenure // 2 + n // 40)
    done = 0
    while done < steps and walk[COUNTS, BEST] > target:
        if walk[COUNTS, STEP] - walk[COUNTS, IMPROVED_AT] >= patience:
            break
        walk[COUNTS, STEP] += 1
        done += 1
        _offer_all(shop, walk, tabu)
        chosen = tenure + _draw(walk, spread)
        moves = False
        for at in range(0, 2 * _TABU, _TABU):
            moves = moves or _do(shop, walk, tabu, at, chosen)
        if not moves:
            walk[COUNTS, IMPROVED_AT] = walk[COUNTS, STEP] - patience
            break
        _keep_if_better(walk)
    return done
