"""Rule 5: the levels of reservoirs, after one happening after another.

The happenings of one instant come in the order of their ranks. Within a rank there must be one
order, the same for all reservoirs, in which no level leaves its bounds after any happening. The
amounts that one happening takes and gives count together. Where all that is taken, or all that is
given, fits at once, every order suits, and the sweep is O(n log n).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby
from operator import attrgetter
from typing import NamedTuple

from irc.model import Resource
from irc.model.quantities import Number
from irc.validation.bound_schedule import BoundSchedule, Occurrence
from irc.validation.resources import RankPairs, given_rank_pairs
from irc.validation.verdict import Violations, listed

ORDERS = 100_000
"""Within one rank, the search looks at no more than this number of sets of happenings that could
have come first. (Whether an order exists is NP-hard: it packs bins.)"""

Changes = tuple[tuple[int, int], ...]
"""A happening's change of each reservoir: (its number, amount), no amount 0."""


_Step = tuple[Number, list[tuple[Occurrence, int]]]
"""A time, and the happenings that change a reservoir then, within one rank, with amounts."""


class StockHappening(NamedTuple):
    """A start or an end that changes stock, or both at once.

    `stage` is 0 for an end at the instant as of which the schedule is judged, else 1.
    """

    time: Number
    rank: int
    stage: int
    occurrence: Occurrence
    at_end: bool
    changes: Changes


class TiedHappenings(NamedTuple):
    """The happenings of one time, rank and stage, which may come in any order."""

    time: Number
    members: tuple[StockHappening, ...]


def reservoirs(bound: BoundSchedule) -> list[Resource]:
    """The reservoirs; their numbers are their places here."""
    return [r for r in bound.resources.values() if r.kind == "reservoir"]


def stock_happenings(bound: BoundSchedule, ranks: RankPairs) -> Iterator[StockHappening]:
    """All happenings that change stock. The end of a cancelled occurrence changes nothing."""
    number = {resource.id: k for k, resource in enumerate(reservoirs(bound))}
    for occurrence in bound.occurrences:
        action = occurrence.action
        if not (action.consumes or action.produces):
            continue
        rank, end_rank = ranks[occurrence.number]
        one = (occurrence.start, rank) == (occurrence.end, end_rank)
        found: dict[bool, Counter[int]] = {False: Counter(), True: Counter()}
        for change in action.consumes:
            at_end = (change.at or "start") == "end"
            if not (at_end and occurrence.cancelled):
                found[at_end and not one][number[change.resource]] -= change.amount
        for change in action.produces:
            at_end = (change.at or "end") == "end"
            if not (at_end and occurrence.cancelled):
                found[at_end and not one][number[change.resource]] += change.amount
        for at_end, amounts in found.items():
            changes = tuple(sorted((r, amount) for r, amount in amounts.items() if amount))
            if changes:
                time, its = (occurrence.end, end_rank) if at_end else (occurrence.start, rank)
                stage = 0 if time == bound.at and occurrence.start < time else 1
                yield StockHappening(time, its, stage, occurrence, at_end, changes)


def groups_of(happenings: Iterable[StockHappening]) -> list[TiedHappenings]:
    """The happenings in the order of time, rank and stage."""
    ordered = sorted(happenings, key=attrgetter("time", "rank", "stage"))
    return [
        TiedHappenings(key[0], tuple(members))
        for key, members in groupby(ordered, key=attrgetter("time", "rank", "stage"))
    ]


def check_reservoirs(
    bound: BoundSchedule, violations: Violations, ranks: RankPairs | None = None
) -> None:
    """Checks that every level stays within its bounds, after each happening."""
    its = reservoirs(bound)
    if not its:
        return
    ranks = given_rank_pairs(bound) if ranks is None else ranks
    groups = groups_of(stock_happenings(bound, ranks))
    steps: list[list[_Step]] = [[] for _ in its]
    for group in groups:
        for r, members in _members_by_reservoir(group).items():
            steps[r].append((group.time, members))
    for resource, own in zip(its, steps, strict=True):
        if not own or own[0][0] > 0:
            # A reservoir that no action changes at t = 0 has its initial level there.
            own.insert(0, (0, []))
        _check_levels(resource, own, violations)
    levels = [resource.initial for resource in its]
    for group in groups:
        _check_order(its, levels, group, violations)
        levels = after(levels, group.members)


def _members_by_reservoir(group: TiedHappenings) -> dict[int, list[tuple[Occurrence, int]]]:
    found: dict[int, list[tuple[Occurrence, int]]] = {}
    for happening in group.members:
        for r, amount in happening.changes:
            found.setdefault(r, []).append((happening.occurrence, amount))
    return found


def after(levels: Sequence[int], happenings: Iterable[StockHappening]) -> list[int]:
    """The levels after some happenings."""
    following = list(levels)
    for happening in happenings:
        for r, amount in happening.changes:
            following[r] += amount
    return following


def is_within(resource: Resource, level: int) -> bool:
    """Whether a level is within the bounds of a reservoir."""
    return resource.min <= level and (resource.max is None or level <= resource.max)


def _check_levels(resource: Resource, steps: Sequence[_Step], violations: Violations) -> None:
    """Checks the level after all happenings of each group."""
    level, was_within, was_carried = resource.initial, True, False
    by_history, has_history = resource.initial, False
    for time, members in steps:
        net = sum(amount for _, amount in members)
        past = [amount for occurrence, amount in members if occurrence.past]
        level += net
        by_history += sum(past)
        has_history = has_history or bool(past)
        within = is_within(resource, level)
        if level < resource.min:
            worse, mended_by = net < 0, min(level - by_history, net - sum(past))
        else:
            worse, mended_by = net > 0, min(by_history - level, sum(past) - net)
        # Open occurrences make it no worse, neither so far nor at this instant.
        carried = has_history and mended_by >= 0
        if not within and (was_within or worse or (was_carried and not carried)):
            doers = [occurrence.entry.id for occurrence, _ in members]
            _add_level(resource, time, level, doers, carried, violations)
        was_within, was_carried = within, not within and carried


def _add_level(
    resource: Resource,
    time: Number,
    level: int,
    doers: list[str],
    carried: bool,
    violations: Violations,
) -> None:
    if level < resource.min:
        limit = f"below its minimum {resource.min}"
    else:
        limit = f"above its maximum {resource.max}"
    by = f" (after {listed(doers, len(doers))})" if doers else ""
    violations.add(
        "reservoir",
        f"the level of {resource.id!r} is {level} at {violations.time(time)}, {limit}{by}",
        doers,
        (time,),
        carried=carried,
    )


# --- the order within a rank ---


def _check_order(
    its: Sequence[Resource], levels: Sequence[int], group: TiedHappenings, violations: Violations
) -> None:
    if len(group.members) < 2:
        return
    tight = tight_reservoirs(its, levels, group.members)
    if not tight:
        return
    found = has_order(its, levels, group.members, tight)
    if found:
        return
    members = [h for h in group.members if any(r in tight for r, _ in h.changes)]
    names = list(dict.fromkeys(h.occurrence.entry.id for h in members))
    stocks = listed((its[r].id for r in sorted(tight)), len(tight))
    who, when = listed(names, len(names)), violations.time(group.time)
    if found is None:
        rule = "undecided"
        message = f"whether some order of {who} at {when} keeps {stocks} within bounds is too hard"
    else:
        rule, message = "reservoir", f"no order of {who} at {when} keeps {stocks} within bounds"
    carried = all(h.occurrence.past for h in members)
    violations.add(rule, message, names, (group.time,), carried=carried)


def tight_reservoirs(
    its: Sequence[Resource], levels: Sequence[int], happenings: Sequence[StockHappening]
) -> frozenset[int]:
    """The reservoirs that some order of the happenings takes out of bounds.

    Those that are out of bounds before or after all of them are left out: no order helps.
    """
    given, taken = _sums(change for h in happenings for change in h.changes)
    found = set()
    for r in {*given, *taken}:
        resource, level = its[r], levels[r]
        high, low = level + given[r], level - taken[r]
        if not is_within(resource, level) or not is_within(resource, high - taken[r]):
            continue
        if not (is_within(resource, high) and is_within(resource, low)):
            found.add(r)
    return frozenset(found)


def _sums(changes: Iterable[tuple[int, int]]) -> tuple[Counter[int], Counter[int]]:
    """The sum of all amounts that each reservoir gets, and of all that are taken from it."""
    given: Counter[int] = Counter()
    taken: Counter[int] = Counter()
    for r, amount in changes:
        (given if amount > 0 else taken)[r] += abs(amount)
    return given, taken


def has_order(
    its: Sequence[Resource],
    levels: Sequence[int],
    happenings: Sequence[StockHappening],
    tight: frozenset[int],
) -> bool | None:
    """Whether some order keeps the tight reservoirs within bounds; None: too hard to decide.

    Happenings that can only help come first, and those that can only harm come last. Of the rest,
    those with the same changes count together, and the done ones are a set, whatever their order.
    """
    kinds = Counter(tuple((r, a) for r, a in h.changes if r in tight) for h in happenings)
    del kinds[()]
    now = {r: levels[r] for r in tight}
    _place_safe_ones(its, now, kinds)
    left = tuple(kinds.items())
    start = tuple(count for _, count in left)
    seen, open_sets = {start}, [start]
    while open_sets:
        counts = open_sets.pop()
        if not any(counts):
            return True
        level = dict(now)
        for (changes, all_of_them), count in zip(left, counts, strict=True):
            for r, amount in changes:
                level[r] += amount * (all_of_them - count)
        for k, (changes, _) in enumerate(left):
            if counts[k] and all(is_within(its[r], level[r] + amount) for r, amount in changes):
                following = (*counts[:k], counts[k] - 1, *counts[k + 1 :])
                if following not in seen:
                    seen.add(following)
                    open_sets.append(following)
        if len(seen) > ORDERS:
            return None
    return False


def _place_safe_ones(its: Sequence[Resource], now: dict[int, int], kinds: Counter[Changes]) -> None:
    """Removes from `kinds` all that can come first without harm (`now` follows), or last."""
    while True:
        given, taken = Counter[int](), Counter[int]()
        for changes, count in kinds.items():
            for r, amount in changes:
                (given if amount > 0 else taken)[r] += abs(amount) * count
        above = {r for r in now if not is_within(its[r], max(its[r].min, now[r] + given[r]))}
        below = {r for r in now if now[r] - taken[r] < its[r].min}
        safe = [
            changes
            for changes in kinds
            if _is_safe(changes, above, below, 1) or _is_safe(changes, above, below, -1)
        ]
        if not safe:
            return
        for changes in safe:
            count = kinds.pop(changes)
            if _is_safe(changes, above, below, 1):
                for r, amount in changes:
                    now[r] += amount * count


def _is_safe(changes: Changes, above: set[int], below: set[int], sign: int) -> bool:
    """Whether a happening does no harm if it comes first (`sign` 1) or last (-1)."""
    return all(r not in (above if amount * sign > 0 else below) for r, amount in changes)
