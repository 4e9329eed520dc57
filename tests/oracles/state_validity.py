"""Is a given schedule valid (docs/semantics.md)? Rule by rule, slowly, with every rank tried.

A second opinion on the validator and on `oracles.state_brute_force`, whose search knows nothing of
this module. Times may be any fractions of the tick here.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations, permutations

from irc.model import Task
from irc.schedule import Entry, Schedule
from oracles.state_task import Arc, Job, Option, Plain, Value, become, read, suits, together

Place = tuple[Fraction, int]
"""A time and a rank."""


@dataclass(frozen=True)
class _Case:
    """An entry with its action; times in ticks."""

    entry: Entry
    j: int
    job: Job
    option: Option
    start: Fraction
    end: Fraction

    @property
    def lasts(self) -> Fraction:
        return self.end - self.start


def is_valid(task: Task, schedule: Schedule) -> bool:
    """Whether some ranks make the schedule valid; ranks that it gives itself are disregarded."""
    plain = read(task)
    index = {job.id: j for j, job in enumerate(plain.jobs)}
    counts = [0] * len(plain.jobs)
    cases: list[_Case] = []
    for entry in schedule.entries:
        if entry.id not in index or entry.status is not None:
            return False
        case = _case(plain, index[entry.id], entry)
        if case is None:
            return False
        counts[case.j] += 1
        cases.append(case)
    return (
        plain.is_selection(counts)
        and all(_occurrences_in_order(cases, j) for j in range(len(plain.jobs)))
        and all(_arc_holds(arc, cases) for arc in plain.arcs)
        # (What no order within an instant mends, ranks do not mend either.)
        and _capacities_suffice(plain, cases, _one_rank(cases))
        and _stocks_hold(plain, cases, _one_rank(cases))
        and any(_story_holds(plain, cases, ranks) for ranks in _all_ranks(plain, cases))
    )


def _case(plain: Plain, j: int, entry: Entry) -> _Case | None:
    """Rule 2, but for the precedence; None where it is broken or the resources are unexplained."""
    job = plain.jobs[j]
    start, end = Fraction(entry.start) / plain.tick, Fraction(entry.end) / plain.tick
    held = tuple(sorted(entry.resources.items()))
    for option in job.options:
        if (option.mode, option.held) == (entry.mode, held) and (
            option.least <= end - start <= option.most
        ):
            break
    else:
        return None
    if start < job.release or (job.start is not None and start != job.start):
        return None
    if job.latest_start is not None and start > job.latest_start:
        return None
    if job.earliest_end is not None and end < job.earliest_end:
        return None
    if job.deadline is not None and end > job.deadline:
        return None
    return _Case(entry, j, job, option, start, end)


def _occurrences_in_order(cases: Sequence[_Case], j: int) -> bool:
    own = sorted((c for c in cases if c.j == j), key=lambda c: c.entry.occurrence)
    if [c.entry.occurrence for c in own] != list(range(1, len(own) + 1)):
        return False
    return all(
        a.start <= b.start and (a.end <= b.start or b.end <= a.start)
        for a, b in combinations(own, 2)
    )


def _ends_of(arc: Arc, cases: Sequence[_Case]) -> tuple[Fraction, Fraction] | None:
    before = [c for c in cases if c.j == arc.before]
    after = [c for c in cases if c.j == arc.after]
    if not before or not after:
        return None
    return (
        before[0].end if arc.from_end else before[0].start,
        after[0].end if arc.to_end else after[0].start,
    )


def _arc_holds(arc: Arc, cases: Sequence[_Case]) -> bool:
    points = _ends_of(arc, cases)
    if points is None:
        return True
    lag = points[1] - points[0]
    return arc.least <= lag and (arc.most is None or lag <= arc.most)


def _capacities_suffice(
    plain: Plain, cases: Sequence[_Case], ranks: Mapping[tuple[int, bool], int]
) -> bool:
    """Use and capacity are constant between these instants, and between the ranks of one."""
    behind = 1 + max(ranks.values(), default=0)
    places = [((c.start, ranks[i, False]), (c.end, ranks[i, True])) for i, c in enumerate(cases)]
    for name, resource in plain.renewables.items():
        instants = {c.start for c in cases} | {Fraction(w[0]) for w in resource.windows}
        instants |= {Fraction(w[1]) for w in resource.windows}
        for instant in instants:
            capacity = earlier = resource.capacity
            for begin, end, other in resource.windows:
                capacity = other if begin <= instant < end else capacity
                earlier = other if begin < instant <= end else earlier
            for rank in range(behind + 1):
                running = [
                    c
                    for c, (start, end) in zip(cases, places, strict=True)
                    if c.lasts and start <= (instant, rank) < end
                ]
                used = sum(dict(c.option.held).get(name, 0) for c in running)
                if running and used > (capacity if rank == behind else max(capacity, earlier)):
                    return False
    return True


def _stocks_hold(
    plain: Plain, cases: Sequence[_Case], ranks: Mapping[tuple[int, bool], int]
) -> bool:
    """One happening after another: by time, by rank, and in some order within a rank."""
    happenings: dict[Place, dict[int, dict[str, int]]] = {}
    for i, c in enumerate(cases):
        for name, amount, at_end in c.job.stock:
            place = (c.end, ranks[i, True]) if at_end else (c.start, ranks[i, False])
            own = happenings.setdefault(place, {}).setdefault(i, {})
            own[name] = own.get(name, 0) + amount
    levels = {name: stock.initial for name, stock in plain.stocks.items()}
    for name, stock in plain.stocks.items():
        touched = any(
            time <= 0 and name in changes
            for (time, _), its in happenings.items()
            for changes in its.values()
        )
        if not touched and not stock.holds(stock.initial):
            return False
    for _, its in sorted(happenings.items()):
        if not any(
            _keeps_stock(plain, levels, order) for order in permutations(list(its.values()))
        ):
            return False
        for changes in its.values():
            for name, amount in changes.items():
                levels[name] += amount
    return True


def _keeps_stock(
    plain: Plain, levels: Mapping[str, int], order: Sequence[Mapping[str, int]]
) -> bool:
    now = dict(levels)
    for changes in order:
        for name, amount in changes.items():
            now[name] += amount
            if not plain.stocks[name].holds(now[name]):
                return False
    return True


# --- rule 6 -------------------------------------------------------------------------------------


def _all_ranks(plain: Plain, cases: Sequence[_Case]) -> Iterator[dict[tuple[int, bool], int]]:
    """Every order, with ties, of all ranks: a map from (entry, whether its end) to a rank.

    The rank of what touches no state, shares nothing and has no precedence is of no account. The
    others are tried in all orders: seven of them have 47,293, so this is for a handful of entries.
    """
    bound = {j for arc in plain.arcs for j in (arc.before, arc.after)}
    nodes: list[tuple[int, bool]] = []
    for i, case in enumerate(cases):
        if not (case.job.touches_state or case.job.shares) and case.j not in bound:
            continue
        nodes.append((i, False))
        if case.option.ends_freely:
            nodes.append((i, True))
    if not plain.initial:
        nodes = []
    for ranks in _weak_orders(nodes):
        for i in range(len(cases)):
            ranks.setdefault((i, False), 0)
            ranks.setdefault((i, True), ranks[i, False])
        yield ranks


def _one_rank(cases: Sequence[_Case]) -> dict[tuple[int, bool], int]:
    return {(i, at_end): 0 for i in range(len(cases)) for at_end in (False, True)}


def _weak_orders(
    nodes: Sequence[tuple[int, bool]],
) -> Iterator[dict[tuple[int, bool], int]]:
    """All ways to put nodes into ranks 0, 1, … without a gap; all in rank 0 first."""
    if not nodes:
        yield {}
        return
    for size in range(len(nodes), 0, -1):
        for lowest in combinations(nodes, size):
            rest = [node for node in nodes if node not in lowest]
            for higher in _weak_orders(rest):
                yield dict.fromkeys(lowest, 0) | {n: rank + 1 for n, rank in higher.items()}


def _story_holds(
    plain: Plain, cases: Sequence[_Case], ranks: Mapping[tuple[int, bool], int]
) -> bool:
    return (
        all(_duration_keeps_ranks(c, ranks[i, False], ranks[i, True]) for i, c in enumerate(cases))
        and all(_arc_keeps_ranks(arc, cases, ranks) for arc in plain.arcs)
        and _capacities_suffice(plain, cases, ranks)
        and _stocks_hold(plain, cases, ranks)
        and _plays_through(plain, cases, ranks)
    )


def _duration_keeps_ranks(case: _Case, start: int, end: int) -> bool:
    """A duration with its infinitesimal part lies in its range too."""
    least, most = (case.option.least, 0), (case.option.most, 0)
    return least <= (case.lasts, end - start) <= most


def _arc_keeps_ranks(
    arc: Arc, cases: Sequence[_Case], ranks: Mapping[tuple[int, bool], int]
) -> bool:
    points = _ends_of(arc, cases)
    if points is None or points[1] - points[0] > arc.least:
        return True
    before = next(i for i, c in enumerate(cases) if c.j == arc.before)
    after = next(i for i, c in enumerate(cases) if c.j == arc.after)
    return ranks[after, arc.to_end] >= ranks[before, arc.from_end]


def _plays_through(
    plain: Plain, cases: Sequence[_Case], ranks: Mapping[tuple[int, bool], int]
) -> bool:
    starts = [(case.start, ranks[i, False]) for i, case in enumerate(cases)]
    ends = [(case.end, ranks[i, True]) for i, case in enumerate(cases)]
    world: dict[str, Value] = dict(plain.initial)
    for place in sorted({*starts, *ends}):
        readers: dict[str, set[int]] = {}
        writers: dict[str, set[int]] = {}
        following = dict(world)
        given: dict[str, object] = {}
        for i, case in enumerate(cases):
            for at, var, value in case.job.conditions:
                if place in _reading_places(at, starts[i], ends[i]):
                    readers.setdefault(var, set()).add(i)
                    if not suits(world[var], value):
                        return False
            for var, change in together(
                (var, value)
                for at, var, value in case.job.effects
                if place == (starts[i] if at == "start" else ends[i])
            ):
                writers.setdefault(var, set()).add(i)
                if given.setdefault(var, change) != change:
                    return False
                following[var] = become(world[var], change)
        for var, who in writers.items():
            if len(who | readers.get(var, set())) > 1:
                return False
        world = following
        if not all(suits(world[var], bounds) for var, bounds in plain.bounds):
            return False
        for i, case in enumerate(cases):
            if starts[i] <= place < ends[i]:
                for at, var, value in case.job.conditions:
                    if at == "all" and not suits(world[var], value):
                        return False
    return all(suits(world[var], value) for var, value in plain.value_goals)


def _reading_places(at: str, start: Place, end: Place) -> tuple[Place, ...]:
    """Where a condition looks at the value just before; what takes no time has one place."""
    if start == end or at == "start":
        return (start,)
    return (end,) if at == "end" else ()
