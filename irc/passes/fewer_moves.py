"""A list schedule in which little moves: what must move goes into gaps that the others leave.

Serial schedule generation in the order of the previous plan, where each activity that is still to
be placed has its previous place reserved. One whose place is gone looks for a gap among these
places; where that moves more of its successors than it saves, or comes too late, it takes the first
room beside what has been placed, and the reservations in its way are lost. Several rules for that
choice are tried. All is heuristic: the result is a schedule, and says nothing about the least
number of moves.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from typing import NamedTuple

from irc.passes.resource_profile import UNREACHABLE_TIME, Profile
from irc.passes.serial_sgs import (
    Choice,
    Found,
    as_previously_chosen,
    keeps_windows,
    moved_in,
    order_of,
    ready_behind,
    room_for,
    take_room,
)
from irc.problem import Arc, Problem
from irc.problem.decisions import Decision

TRIES = 4
"""At most this many times a rule is tried; each try puts off less than the one before."""

MOST_FOLLOWED = 40
"""At most this many successors are followed to see how many move."""


PARTS = (3, 6, 12, 24)
"""The numbers of parts of the time of which one is free."""


class Rule(NamedTuple):
    """A rule for the choice between a gap and the first room.

    On pools of which more than the part `tight` of the time that is left is in use, the order
    stays. Elsewhere a gap is taken where it moves no more than `patience` times as many others.
    """

    tight: float
    patience: float


RULES = (Rule(1.1, 1.0), Rule(0.97, 1.0), Rule(0.97, 4.0), Rule(0.97, 0.5))
"""Those by which all activities are placed anew."""

RULES_OF_PARTS = (Rule(0.97, 1.0), Rule(1.1, 1.0), Rule(1.1, 4.0))
"""Those by which a part of them is."""


def knows_moves(problem: Problem) -> bool:
    """Whether `fewer_moves` knows all that there is in a problem with a previous plan.

    That is lags, windows and resources, with the makespan as the only objective.
    """
    return (
        problem.is_plain
        and problem.objectives == ("makespan",)
        and any(problem.previous.places)
        and not (problem.has_setups or problem.has_batches or problem.has_work)
        and all(activity.is_fixed for activity in problem.activities)
    )


def fewer_moves(
    problem: Problem, known: Found, is_over: Callable[[], bool] = lambda: False
) -> Found | None:
    """A list schedule that ends no later than a `known` one, and in which fewer activities move.

    First all activities are placed anew, then those of one part of the time after another, as long
    as that helps and until `is_over`. None where no schedule is better than the known one. The
    problem is one that it knows (`knows_moves`), after the passes.
    """
    search = _Search(problem, known, is_over)
    if len(search.placing.order) < len(problem.activities):
        return None  # The lags make a circle.
    for rule in RULES:
        search.try_rule(rule)
    while sum(search.sweep(rule) for rule in RULES_OF_PARTS):
        pass  # (All rules are tried, whichever helps.)
    return None if search.best is known else search.best


class _Search:
    """The search for a schedule in which little moves; `best` is the best one so far."""

    def __init__(self, problem: Problem, known: Found, is_over: Callable[[], bool]) -> None:
        self.problem, self.best, self.is_over = problem, known, is_over
        self.most = moved_in(problem, known)
        self.placing = _Placing(problem, max((int(d.end) for d in known[0]), default=0))

    def try_rule(self, rule: Rule, free: Collection[int] | None = None) -> bool:
        """Places activities anew, all or those that are `free`; whether that is better."""
        if not self.most or self.is_over():
            return False
        found = self.placing.by(rule, self.best, free, self.is_over)
        count = self.most if found is None else moved_in(self.problem, found)
        if found is None or count >= self.most:
            return False
        self.best, self.most = found, count
        return True

    def sweep(self, rule: Rule) -> bool:
        """Frees one part of the time after another, parts of several sizes; whether that helps."""
        helps = False
        for count in PARTS:
            for part in range(2 * count - 1):
                if not self.is_over() and (free := self._part(part, count)):
                    helps = self.try_rule(rule, free) or helps
        return helps

    def _part(self, part: int, count: int) -> set[int]:
        """The activities of a part of the time, where some of them have moved.

        Each of the `count` parts overlaps the next one by half.
        """
        starts = [int(decision.start) for decision in self.best[0]]
        free = [i for i, a in enumerate(self.problem.activities) if a.start is None]
        free.sort(key=lambda i: (starts[i], i))
        first = part * len(free) // (2 * count)
        chosen = free[first : first + max(1, len(free) // count)]
        places = self.problem.previous.places
        moved = any((place := places[i]) and place.start != starts[i] for i in chosen)
        return set(chosen) if moved else set()


class _Placing:
    """Places the activities of a problem by rules; all ends by `latest`."""

    def __init__(self, problem: Problem, latest: int) -> None:
        self.problem = as_previously_chosen(problem)
        self.latest = latest
        places = problem.previous.places
        self.before = [None if place is None else place.start for place in places]
        self.known: Found | None = None
        self.order = order_of(problem, [0] * len(problem.activities)) or []
        self.incoming: list[list[Arc]] = [[] for _ in problem.activities]
        self.outgoing: list[list[Arc]] = [[] for _ in problem.activities]
        for arc in problem.arcs:
            self.incoming[arc.after].append(arc)
            self.outgoing[arc.before].append(arc)
        self.shares = self._shares()

    def _take_known(self, known: Found) -> None:
        """Takes a schedule as the known one: its starts give the order, after what is fixed."""
        if known is self.known:
            return
        self.known, self.start = known, [int(decision.start) for decision in known[0]]
        priorities = [
            start if activity.start is None else start - UNREACHABLE_TIME
            for activity, start in zip(self.problem.activities, self.start, strict=True)
        ]
        self.order = order_of(self.problem, priorities) or []
        ends = [int(decision.end) for decision in known[0]]
        self.by_time = sorted(range(len(ends)), key=lambda i: (-self.start[i], -ends[i]))

    def by(
        self,
        rule: Rule,
        known: Found,
        free: Collection[int] | None = None,
        is_over: Callable[[], bool] = lambda: False,
    ) -> Found | None:
        """The schedule by a rule; None where it finds none that ends in time.

        All that is not `free` stays where the known schedule has it. Where an activity would be too
        late, what has made it late takes no gaps in another try.
        """
        self._take_known(known)
        self.free = free
        self.hurried: set[int] = set()
        self.tight = {r for r, share in enumerate(self.shares) if share > rule.tight}
        self.patience = rule.patience
        self.last = self._last_starts(known)
        if not self._fix_all(known):
            return None
        for _ in range(TRIES):
            late = None if is_over() else self._try()
            if is_over():
                return None
            if late is None:
                found = self.decisions, self.choices
                return found if keeps_windows(self.problem, self.decisions) else None
            before = len(self.hurried)
            self.hurried.update(self._causes(late))
            if len(self.hurried) == before:
                return None
        return None

    def _causes(self, late: int) -> Iterator[int]:
        """Moved activities that make one late: those before it, or in the room that it needs."""
        waiting, seen = [late], {late}
        while waiting:
            i = waiting.pop()
            yield i
            before = [arc.before for arc in self.incoming[i] if self._has_moved(arc.before)]
            waiting += [j for j in before if j not in seen]
            seen.update(before)
        ready = self._ready(late)
        end = self.last[late] + self.problem.activities[late].duration_min
        pools = {r for d in self.problem.activities[late].open_demands for r in d.alternatives}
        for j in range(len(self.placed)):
            place = self.decisions[j]
            overlaps = place.start < end and ready < place.end
            if overlaps and self._has_moved(j) and pools.intersection(self.choices[j]):
                yield j

    def _has_moved(self, i: int) -> bool:
        start = self.before[i]
        return self.placed[i] and start is not None and self.decisions[i].start != start

    def _fix_all(self, known: Found) -> bool:
        """Places all that has to stay where it is; False where there is no room for it."""
        count, pools = len(self.problem.activities), self.problem.contention.pools
        self.decisions = [Decision(0, 0)] * count
        self.choices: list[Choice] = [()] * count
        self.placed = [False] * count
        self.taken = self.reserved = [Profile(pool) for pool in pools]
        for i in filter(self._is_fixed, self.order):
            place = self.start[i], known[1][i]
            if self.free is None:
                found = room_for(self.problem.activities[i], self.start[i], self.taken)
                if found is None or found[0] != self.problem.activities[i].start:
                    return False
                place = found
            self._put(i, *place)
        self.fixed = self.decisions, self.choices, self.placed, self.taken
        self.movable = [i for i in self.order if not self.placed[i]]
        old = [(start, i) for i in self.movable if (start := self.before[i]) is not None]
        self.by_place = [i for _, i in sorted(old)]
        return True

    def _try(self) -> int | None:
        """Places all activities; returns the first one that would be too late, if there is one."""
        decisions, choices, placed, taken = self.fixed
        self.decisions, self.choices, self.placed = [*decisions], [*choices], [*placed]
        self.taken, self.reserved = ([profile.copy() for profile in taken] for _ in range(2))
        self.reservations: dict[int, tuple[int, Choice]] = {}
        self.by_pool: list[list[int]] = [[] for _ in taken]
        for i in self.by_place:
            self._reserve(i)
        return next((i for i in self.movable if not self._place(i)), None)

    def _is_fixed(self, i: int) -> bool:
        """Whether an activity has a fixed start, or stays where it is known to be."""
        stays = self.free is not None and i not in self.free
        return stays or self.problem.activities[i].start is not None

    def _shares(self) -> list[float]:
        """The part of each pool that is in use from the first previous place to the latest end."""
        pools = self.problem.contention.pools
        began = min((s for s in self.before if s is not None), default=0)
        work = [0] * len(pools)
        for activity in self.problem.activities:
            if activity.start is not None and activity.start + activity.duration_min <= began:
                continue
            for demand in activity.open_demands:
                if len(demand.alternatives) == 1:
                    work[demand.alternatives[0]] += demand.amount * activity.duration_min
        room = []
        for pool in pools:
            profile = Profile(pool)
            room.append(profile.room_between(began, self.latest))
        return [done / has if has else 2.0 for done, has in zip(work, room, strict=True)]

    def _last_starts(self, known: Found) -> list[int]:
        """The last start of each activity with which all can end in time.

        On tight pools the order is that of the known schedule.
        """
        activities = self.problem.activities
        last = [self._latest_start(i) for i in range(len(activities))]
        following: dict[int, tuple[int, int]] = {}
        for i in self.by_time:
            length = activities[i].duration_min
            if self._is_fixed(i):
                last[i] = self.start[i]
            else:
                last[i] = min((last[i], *self._limits_behind(i, last)))
            for pool in self.tight.intersection(known[1][i]) if length else ():
                begun, limit = following.get(pool, (0, 0))
                if self.start[i] + length <= begun:
                    last[i] = min(last[i], limit - length)
                following[pool] = self.start[i], last[i]
        return last

    def _latest_start(self, i: int) -> int:
        activity = self.problem.activities[i]
        end = self.latest - self.problem.bounds.tails[i]
        deadline = self.problem.effective_deadline(i)
        start = (end if deadline is None else min(end, deadline)) - activity.duration_min
        return start if activity.latest_start is None else min(start, activity.latest_start)

    def _limits_behind(self, i: int, last: Sequence[int]) -> Iterator[int]:
        """The limits that the last starts of its successors put on the start of an activity."""
        for arc in self.outgoing[i]:
            back = self.problem.activities[arc.after].duration_min if arc.to_end else 0
            length = self.problem.activities[i].duration_min if arc.from_end else 0
            yield last[arc.after] + back - arc.min_lag - length

    # --- one activity ---

    def _reserve(self, i: int) -> None:
        """Reserves the previous place of an activity where there is room for it."""
        start = self.before[i]
        if start is None or start < self.problem.bounds.heads[i] or start > self.last[i]:
            return
        found = room_for(self.problem.activities[i], start, self.reserved)
        if found is None or found[0] != start:
            return
        take_room(self.problem.activities[i], *found, self.reserved)
        self.reservations[i] = found
        for pool in dict.fromkeys(found[1]):
            self.by_pool[pool].append(i)

    def _place(self, i: int) -> bool:
        """Places an activity; False where it would end too late."""
        activity = self.problem.activities[i]
        ready = max(self.problem.bounds.heads[i], self._ready(i))
        kept = self.reservations.get(i)
        if kept is not None:
            self._release(i)
            if ready <= kept[0]:
                self._put(i, *kept)
                return True
        last, start = self.last[i], self.before[i]
        if start is not None and kept is None:
            ready = max(ready, start)
        gap = room_for(activity, ready, self.reserved)
        room = room_for(activity, ready, self.taken)
        if gap is not None and gap[0] <= last and (room is None or self._prefers(i, gap, room)):
            self._put(i, *gap)
            return True
        if room is None or room[0] > last:
            return False
        for k in self._in_the_way(i, *room):
            self._release(k)
        self._put(i, *room)
        return True

    def _ready(self, i: int) -> int:
        """The first time at which what comes before an activity lets it start."""
        duration = self.problem.activities[i].duration_min
        return ready_behind(self.incoming[i], duration, self.decisions)

    def _put(self, i: int, start: int, choice: Choice) -> None:
        """Places an activity for good."""
        activity = self.problem.activities[i]
        take_room(activity, start, choice, self.taken)
        if self.reserved is not self.taken:
            take_room(activity, start, choice, self.reserved)
        self.decisions[i] = Decision(start, start + activity.duration_min)
        self.choices[i], self.placed[i] = choice, True

    def _release(self, i: int) -> None:
        """Gives a reservation back."""
        start, choice = self.reservations.pop(i)
        take_room(self.problem.activities[i], start, choice, self.reserved, -1)
        for pool in dict.fromkeys(choice):
            self.by_pool[pool].remove(i)

    # --- the choice between a gap and the first room ---

    def _prefers(self, i: int, gap: tuple[int, Choice], room: tuple[int, Choice]) -> bool:
        """Whether an activity takes a gap rather than the first room."""
        if gap[0] == room[0]:
            return True
        if i in self.hurried or self.tight.intersection(room[1]):
            return False
        lost = self._in_the_way(i, *room)
        end = room[0] + self.problem.activities[i].duration_min
        by_room = self._pushed(i, room[0]) + sum(1 + self._pushed(k, end) for k in lost)
        return self._pushed(i, gap[0]) <= self.patience * by_room

    def _in_the_way(self, i: int, start: int, choice: Choice) -> list[int]:
        """The reservations that are lost where an activity takes a room beside what is placed."""
        activity = self.problem.activities[i]
        lost: list[int] = []
        needed: dict[int, int] = {}
        for demand, pool in zip(activity.open_demands, choice, strict=True):
            needed[pool] = needed.get(pool, 0) + demand.amount
        end = start + activity.duration_min
        for pool, amount in needed.items() if end > start else ():
            profile = self.reserved[pool]
            while (time := profile.first_without(start, end, amount)) is not None:
                k = max(self._holding(pool, time, lost), key=lambda k: (self._begins(k), k))
                take_room(self.problem.activities[k], *self.reservations[k], self.reserved, -1)
                lost.append(k)
        for k in lost:  # (They are lost only where this room is chosen.)
            take_room(self.problem.activities[k], *self.reservations[k], self.reserved)
        return lost

    def _holding(self, pool: int, time: int, lost: Collection[int]) -> Iterator[int]:
        """The reservations, but for those that are `lost`, that hold some of a pool at a time."""
        for k in self.by_pool[pool]:
            begins = self._begins(k)
            if begins <= time < begins + self.problem.activities[k].duration_min and k not in lost:
                yield k

    def _begins(self, i: int) -> int:
        return self.reservations[i][0]

    def _pushed(self, i: int, start: int) -> int:
        """The number of successors whose reservations are lost where an activity starts then."""
        times: dict[int, int] = {i: start}
        waiting = [i]
        while waiting and len(times) <= MOST_FOLLOWED:
            before = waiting.pop()
            for arc in self.outgoing[before]:
                j = arc.after
                if j not in self.reservations:
                    continue
                begun = times[before]
                length = self.problem.activities[before].duration_min if arc.from_end else 0
                back = self.problem.activities[j].duration_min if arc.to_end else 0
                ready = begun + length + arc.min_lag - back
                if ready > max(times.get(j, 0), self._begins(j)):
                    times[j] = ready
                    waiting.append(j)
        return len(times) - 1
