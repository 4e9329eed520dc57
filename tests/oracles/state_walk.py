"""All schedules of one selection of occurrences at once, tick by tick (see `state_brute_force`)."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import permutations, product
from typing import NamedTuple

from irc.model.quantities import Number
from irc.schedule import Entry, Schedule
from oracles.state_instant import (
    Demand,
    Happening,
    Outcome,
    Values,
    happening_at_end,
    happening_at_start,
    orders,
    whole_happening,
)
from oracles.state_levels import Party, combined, hand_over_orders, level_orders
from oracles.state_ranks import closure, only, ranks
from oracles.state_relaxation import Windows, occurrences
from oracles.state_task import Arc, Fact, Option, Plain, suits

WAITING, OVER = -1, -2


class TooLargeError(Exception):
    """More situations than the caller allows."""


class Worth:
    """What a selection is worth, given its makespan and tardiness; less is better."""

    def __init__(self, plain: Plain, counts: Sequence[int]) -> None:
        self.objective = plain.objective
        self.fixed = {
            "maximize_reward": -plain.reward(counts),
            "minimize_cost": plain.cost(counts),
        }

    def vector(self, makespan: int, tardiness: int) -> tuple[int, ...]:
        """One number for each objective."""
        timed = {"minimize_makespan": makespan, "minimize_tardiness": tardiness, **self.fixed}
        return tuple(timed[name] for name in self.objective)


@dataclass(frozen=True)
class Past:
    """What is known of an execution: at `at` what ended comes first, then the `world` changes by
    itself, then others start. `ranks` are those that starts and ends have had, by action. Of the
    resources `by_time` only time is asked."""

    at: Number
    world: Collection[str]
    ranks: Mapping[str, tuple[int | None, int | None]]
    by_time: Collection[str] = ()


class Run(NamedTuple):
    """An occurrence that has started: how, for how long, and until when."""

    option: Option
    lasts: int
    end: int
    drawn_out: bool = False

    @property
    def is_point(self) -> bool:
        """Whether start and end are one happening."""
        return self.lasts == 0 and not self.drawn_out


class Lag(NamedTuple):
    """What one started occurrence asks of the other end of an arc: a time in [soonest, latest].

    At the time `tight` the ranks decide (None: it cannot come to that any more).
    """

    soonest: int
    latest: int | None
    tight: int | None


class Situation(NamedTuple):
    """All that can still matter at a tick. Times are absolute; `key` makes them relative."""

    states: tuple[int, ...]
    runs: tuple[Run | None, ...]
    lags: tuple[Lag | None, ...]
    values: Values
    levels: tuple[int, ...]
    order: frozenset[Demand]

    def key(self, now: int) -> tuple[object, ...]:
        """Equal for situations with the same future, seen from `now`."""
        runs = tuple(
            r and (r.option, r.lasts == r.option.least, r.lasts == r.option.most, r.end - now)
            for r in self.runs
        )
        lags = tuple(
            lag
            and (
                lag.soonest - now,
                None if lag.latest is None else lag.latest - now,
                None if lag.tight is None else lag.tight - now,
            )
            for lag in self.lags
        )
        return self.states, runs, lags, self.values, self.levels, self.order


@dataclass(frozen=True)
class Step:
    """One tick of a walk: what started, and what was demanded of ranks. A linked list."""

    before: Step | None
    now: int
    starts: tuple[tuple[int, Run], ...]
    demands: tuple[Demand, ...]


@dataclass(frozen=True)
class Final:
    """The best end of a walk so far."""

    vector: tuple[int, ...]
    makespan: int
    path: Step | None


class Walk:
    """Finds the best schedule of one selection that is better than `incumbent`, if there is one."""

    def __init__(
        self,
        plain: Plain,
        counts: Sequence[int],
        windows: Windows,
        incumbent: tuple[int, ...] | None,
        room: int,
        past: Past | None = None,
    ) -> None:
        self.plain, self.counts, self.windows = plain, tuple(counts), windows
        self.owners = occurrences(counts)
        self.jobs = [plain.jobs[j] for j in self.owners]
        self.size = len(self.owners)
        self.worth = Worth(plain, counts)
        self.incumbent, self.room = incumbent, room
        self.visited = 0
        self.best: Final | None = None
        self.timed = "minimize_tardiness" in plain.objective
        first = {j: self.owners.index(j) for j in set(self.owners)}
        self.arcs: list[tuple[int, int, Arc]] = [
            (first[a.before], first[a.after], a)
            for a in plain.arcs
            if a.before in first and a.after in first
        ]
        self.of: list[list[int]] = [
            [k for k, (u, v, _) in enumerate(self.arcs) if i in (u, v)] for i in range(self.size)
        ]
        self.parties = [
            (p, [first[m] for m in p.members])
            for p in plain.parties
            if p.due is not None and p.members and counts[p.members[0]]
        ]
        self.stocks = list(plain.stocks)
        self.outcomes: dict[object, list[Outcome]] = {}
        self.orders: dict[object, frozenset[Demand] | None] = {}
        self.ranked = self._ranked()
        self.past = past
        self.at = None if past is None else Fraction(past.at) / plain.tick
        self.known = tuple(self._known_order())

    def _ranked(self) -> list[bool]:
        """Whose ranks can matter: who touches state, or passes demands on between such ones.

        (So may who shares resources or stock with others.)
        """
        touching = {i for i, job in enumerate(self.jobs) if job.touches_state}
        if touching:
            sharing = (i for i, job in enumerate(self.jobs) if job.shares)
            touching |= set(sharing)
        onward, back = set(touching), set(touching)
        for _ in range(self.size):
            onward |= {v for u, v, _ in self.arcs if u in onward}
            back |= {u for u, v, _ in self.arcs if v in back}
        return [i in onward and i in back for i in range(self.size)]

    def _known_order(self) -> Iterator[Demand]:
        """The order of all ranks that have been."""
        nodes: list[tuple[int, int]] = []
        for i, job in enumerate(self.jobs):
            start, end = (
                (None, None) if self.past is None else self.past.ranks.get(job.id, (None, None))
            )
            if start is not None:
                nodes.append((2 * i, start))
            if end is not None and any(option.ends_freely for option in job.options):
                nodes.append((2 * i + 1, end))
        for (a, one), (b, two) in permutations(nodes, 2):
            if one <= two:
                yield a, b, int(one < two)

    # --- the walk, tick by tick ------------------------------------------------------------------

    def run(self) -> None:
        """Sets `best`."""
        situation = Situation(
            (WAITING,) * self.size,
            (None,) * self.size,
            (None,) * len(self.arcs),
            tuple(sorted(self.plain.initial.items())),
            tuple(self.plain.stocks[name].initial for name in self.stocks),
            frozenset(),
        )
        if not self.size:
            self._finish_empty(situation)
            return
        seen: dict[object, int] = {}
        frontier: dict[Situation, tuple[int, Step | None]] = {situation: (0, None)}
        now = 0
        while frontier:
            following: dict[Situation, tuple[int, Step | None]] = {}
            for situation, (late, path) in frontier.items():
                for after, more, step in self._tick(situation, path, now):
                    if self._is_over(after):
                        self._finish(after, now, late + more, step)
                    elif not self._is_hopeless(after, now, late + more):
                        known = following.get(after)
                        if known is None or late + more < known[0]:
                            following[after] = (late + more, step)
            frontier = self._not_seen(following, seen, now)
            now += 1

    def _not_seen(
        self,
        following: dict[Situation, tuple[int, Step | None]],
        seen: dict[object, int],
        now: int,
    ) -> dict[Situation, tuple[int, Step | None]]:
        self.visited += len(following)
        if self.visited > self.room:
            raise TooLargeError(f"more than {self.room} situations")
        if now <= self.plain.last_constant:
            return following
        kept = {}
        for situation, (late, path) in following.items():
            key = situation.key(now)
            if late < seen.get(key, late + 1):
                seen[key] = late
                kept[situation] = (late, path)
        return kept

    @staticmethod
    def _is_over(situation: Situation) -> bool:
        return all(state == OVER for state in situation.states)

    def _finish_empty(self, situation: Situation) -> None:
        if all(stock.holds(stock.initial) for stock in self.plain.stocks.values()):
            self._finish(situation, 0, 0, None)

    def _finish(self, situation: Situation, now: int, late: int, path: Step | None) -> None:
        values = dict(situation.values)
        if not all(suits(values[var], value) for var, value in self.plain.value_goals):
            return
        vector = self.worth.vector(now, late)
        if self.incumbent is None or vector < self.incumbent:
            self.incumbent = vector
            self.best = Final(vector, now, path)

    def _is_hopeless(self, situation: Situation, now: int, late: int) -> bool:
        makespan, later = now, late
        for i, state in enumerate(situation.states):
            job, run = self.jobs[i], situation.runs[i]
            if state == WAITING:
                start = max(now + 1, self.windows.earliest[i])
                if start > self.windows.latest[i]:
                    return True
                makespan = max(makespan, start + self.windows.tails[i])
                end = start + min(option.least for option in job.options)
            elif run is not None:
                makespan, end = max(makespan, run.end), run.end
            else:
                continue
            if job.due is not None:
                later += job.weight * max(0, end - job.due)
        for lag in situation.lags:
            if lag is not None and lag.latest is not None and lag.latest <= now:
                return True
        return self.incumbent is not None and (self.worth.vector(makespan, later) >= self.incumbent)

    # --- one tick --------------------------------------------------------------------------------

    def _tick(
        self, situation: Situation, path: Step | None, now: int
    ) -> Iterator[tuple[Situation, int, Step | None]]:
        """All that can become of a situation at tick `now`: what is after it, the tardiness that
        it adds, and the path."""
        in_use: dict[str, int] = {}
        for run in situation.runs:
            if run is not None and run.end > now:
                for name, amount in run.option.held:
                    in_use[name] = in_use.get(name, 0) + amount
        if any(amount > self.plain.renewables[r].at(now) for r, amount in in_use.items()):
            return
        for starts in self._choices(situation, now, 0, in_use, ()):
            yield from self._begin(situation, path, now, starts)

    def _choices(
        self,
        situation: Situation,
        now: int,
        i: int,
        in_use: dict[str, int],
        chosen: tuple[tuple[int, Run], ...],
    ) -> Iterator[tuple[tuple[int, Run], ...]]:
        """Which of the occurrences from `i` on start now, and how."""
        while i < self.size and not self._may_start(situation, now, i, chosen):
            i += 1
        if i == self.size:
            yield chosen
            return
        yield from self._choices(situation, now, i + 1, in_use, chosen)
        for run in self._ways(i, now):
            held = run.option.held if run.lasts else ()
            more = {name: in_use.get(name, 0) + amount for name, amount in held}
            if all(amount <= self.plain.renewables[r].at(now) for r, amount in more.items()):
                yield from self._choices(
                    situation, now, i + 1, {**in_use, **more}, (*chosen, (i, run))
                )

    def _may_start(
        self, situation: Situation, now: int, i: int, chosen: Sequence[tuple[int, Run]]
    ) -> bool:
        if situation.states[i] != WAITING:
            return False
        if not self.windows.earliest[i] <= now <= self.windows.latest[i]:
            return False
        if i == 0 or self.owners[i - 1] != self.owners[i]:
            return True
        run = situation.runs[i - 1] or dict(chosen).get(i - 1)
        return situation.states[i - 1] == OVER or (run is not None and run.end == now)

    def _ways(self, i: int, now: int) -> Iterator[Run]:
        job = self.jobs[i]
        for option in job.options:
            for lasts in range(option.least, option.most + 1):
                if job.deadline is not None and now + lasts > job.deadline:
                    break
                if job.earliest_end is not None and now + lasts < job.earliest_end:
                    continue
                yield Run(option, lasts, now + lasts)
                if lasts == 0 and option.ends_freely and self.ranked[i]:
                    yield Run(option, 0, now, drawn_out=True)

    def _begin(
        self,
        situation: Situation,
        path: Step | None,
        now: int,
        starts: tuple[tuple[int, Run], ...],
    ) -> Iterator[tuple[Situation, int, Step | None]]:
        due = tuple(i for i, run in enumerate(situation.runs) if run is not None and run.end == now)
        if not starts and not due:
            yield situation._replace(lags=_clipped(situation.lags, now)), 0, path
            return
        levels = self._levels(situation, starts, due)
        if levels is None:
            return
        orders_of_levels = self._orders_of_levels(situation, starts, due, now)
        if not orders_of_levels:
            return
        asked = self._lags(situation, now, starts)
        if asked is None:
            return
        lags, demands = asked
        demands += [d for i, run in starts for d in self._duration_demands(i, run)]
        demands += self._past_first(situation, starts, due, now)
        states, runs = list(situation.states), list(situation.runs)
        ended = [*due, *(i for i, run in starts if run.lasts == 0)]
        for i, run in starts:
            states[i], runs[i] = 0, run
        for i in ended:
            states[i], runs[i] = OVER, None
        late = self._lateness(ended, states, now)
        clipped = _clipped(lags, now)
        alive = self._alive(runs, clipped)
        outcomes = product(self._outcomes(situation, starts, due), orders_of_levels)
        for (values, by_state), by_levels in outcomes:
            wanted = by_state | by_levels
            kept = self._kept(frozenset([*situation.order, *demands, *wanted, *self.known]), alive)
            if kept is None:
                continue
            after = Situation(tuple(states), tuple(runs), clipped, values, levels, kept)
            yield after, late, Step(path, now, starts, (*demands, *wanted))

    def _levels(
        self, situation: Situation, starts: Sequence[tuple[int, Run]], due: Sequence[int]
    ) -> tuple[int, ...] | None:
        """The stocks after all changes of this tick; None where one leaves its bounds."""
        levels = dict(zip(self.stocks, situation.levels, strict=True))
        for i, run in starts:
            for name, change, at_end in self.jobs[i].stock:
                if not at_end or run.lasts == 0:
                    levels[name] += change
        for i in due:
            for name, change, at_end in self.jobs[i].stock:
                levels[name] += change if at_end else 0
        if all(self.plain.stocks[name].holds(level) for name, level in levels.items()):
            return tuple(levels.values())
        return None

    def _past_first(
        self,
        situation: Situation,
        starts: Sequence[tuple[int, Run]],
        due: Sequence[int],
        now: int,
    ) -> Iterator[Demand]:
        """What ended at an event's instant, then what it changes, then what starts."""
        if self.past is None or now != self.at:
            return
        ended, _ = self._ended_first(situation, starts, due, now)
        changes = [2 * i for i, _ in starts if self.jobs[i].id in self.past.world]
        others = [2 * i for i, _ in starts if self.jobs[i].id not in self.past.world]
        for earlier, later in ((ended, changes), (ended, others), (changes, others)):
            yield from ((a, b, 0) for a, b in product(earlier, later) if self._matter(a, b))

    def _ended_first(
        self,
        situation: Situation,
        starts: Sequence[tuple[int, Run]],
        due: Sequence[int],
        now: int,
    ) -> tuple[list[int], list[int]]:
        """The nodes of what ended at an event's instant, and of what starts at it."""
        if self.past is None or now != self.at:
            return [], []
        # (An end that can be chosen may be chosen at the event, behind its changes.)
        ended = [
            _end_node(i, run)
            for i in due
            if (run := situation.runs[i]) is not None and not run.option.ends_freely
        ]
        return ended, [2 * i for i, _ in starts]

    def _matter(self, *nodes: int) -> bool:
        return all(self.ranked[node // 2] for node in nodes)

    def _orders_of_levels(
        self,
        situation: Situation,
        starts: Sequence[tuple[int, Run]],
        due: Sequence[int],
        now: int,
    ) -> list[frozenset[Demand]]:
        """What each way to order those who share resources or stock demands; none: there is no way.

        Where no rank matters a way need only exist.
        """
        choices = []
        parties = self._stock_parties(situation, starts, due)
        if parties:
            levels = dict(zip(self.stocks, situation.levels, strict=True))
            first, behind = self._ended_first(situation, starts, due, now)
            choices.append(level_orders(self.plain.stocks, levels, parties, first, behind))
        if any(self.ranked):
            choices += self._hand_overs(situation, starts, due, now)
        ways = combined(choices)
        return ways if any(self.ranked) else [frozenset()] if ways else []

    def _stock_parties(
        self, situation: Situation, starts: Sequence[tuple[int, Run]], due: Sequence[int]
    ) -> list[Party]:
        found: dict[int, dict[str, int]] = {}
        ends = [(i, run) for i in due if (run := situation.runs[i]) is not None]
        ends += [(i, run) for i, run in starts if run.lasts == 0]
        points = [(i, 2 * i, False) for i, _ in starts]
        # (Where nothing has a rank, both ends of what takes no time are one happening.)
        points += [(i, _end_node(i, run), True) for i, run in ends]
        for i, node, end in points:
            for name, amount, at_end in self.jobs[i].stock:
                if at_end == end:
                    changes = found.setdefault(node, {})
                    changes[name] = changes.get(name, 0) + amount
        return list(found.items())

    def _hand_overs(
        self,
        situation: Situation,
        starts: Sequence[tuple[int, Run]],
        due: Sequence[int],
        now: int,
    ) -> Iterator[list[tuple[Demand, ...]]]:
        by_time = () if self.past is None else self.past.by_time
        for name, renewable in self.plain.renewables.items():
            if name in by_time:
                continue
            ending, starting, others = [], [], 0
            for i, run in enumerate(situation.runs):
                amount = 0 if run is None else dict(run.option.held).get(name, 0)
                if run is not None and amount and i in due:
                    ending.append((_end_node(i, run), amount))
                else:
                    others += amount
            for i, run in starts:
                amount = dict(run.option.held).get(name, 0)
                if amount and run.lasts:
                    starting.append((2 * i, amount))
            if ending and starting:
                capacity = max(renewable.at(now), renewable.at(now - 1))
                yield hand_over_orders(capacity - others, ending, starting)

    def _lateness(self, ended: Sequence[int], states: Sequence[int], now: int) -> int:
        """The tardiness of what has ended now, if that is an objective."""
        if not self.timed:
            return 0
        late = 0
        for i in ended:
            due = self.jobs[i].due
            late += 0 if due is None else self.jobs[i].weight * max(0, now - due)
        for party, members in self.parties:
            if not set(ended).isdisjoint(members) and all(states[m] == OVER for m in members):
                assert party.due is not None
                late += party.weight * max(0, now - party.due)
        return late

    # --- lags and ranks --------------------------------------------------------------------------

    def _lags(
        self, situation: Situation, now: int, starts: Sequence[tuple[int, Run]]
    ) -> tuple[tuple[Lag | None, ...], list[Demand]] | None:
        """Arcs that touch what starts now: kept, or passed on to the other end. None if broken."""
        runs = dict(starts)
        lags, demands = list(situation.lags), []
        for k in {k for i in runs for k in self.of[i]}:
            u, v, arc = self.arcs[k]
            lag: Lag | None = situation.lags[k]
            if u in runs and v not in runs and situation.states[v] == WAITING:
                lags[k] = _after(arc, runs[u].end if arc.from_end else now)
                continue
            if v in runs and u not in runs and situation.states[u] == WAITING:
                lags[k] = _before(arc, runs[v].end if arc.to_end else now)
                continue
            if u in runs and v in runs:
                lag = _after(arc, runs[u].end if arc.from_end else now)
            late_one, at_end = (v, arc.to_end) if v in runs else (u, arc.from_end)
            time = runs[late_one].end if at_end else now
            lags[k] = None
            if lag is None:
                continue
            if time < lag.soonest or (lag.latest is not None and time > lag.latest):
                return None
            if time == lag.tight and self.ranked[u] and self.ranked[v]:
                demands.append(
                    (
                        self._node(u, arc.from_end, runs, situation),
                        self._node(v, arc.to_end, runs, situation),
                        0,
                    )
                )
        return tuple(lags), [d for d in demands if d[0] != d[1]]

    def _node(self, i: int, at_end: bool, runs: dict[int, Run], situation: Situation) -> int:
        """The node of a point; for what is over, `Run` is gone, and both points have nodes."""
        run = runs.get(i) or situation.runs[i]
        if run is not None:
            return _end_node(i, run) if at_end else 2 * i
        return 2 * i + at_end if any(o.ends_freely for o in self.jobs[i].options) else 2 * i

    def _duration_demands(self, i: int, run: Run) -> list[Demand]:
        """A duration keeps to its bounds in ranks too; a fixed one has one rank."""
        start, end, option = 2 * i, 2 * i + 1, run.option
        if not self.ranked[i]:
            return []
        if run.drawn_out:
            return [(start, end, 1)]
        if not option.ends_freely or run.lasts == 0:
            return [(start, end, 0), (end, start, 0)]
        demands = [(start, end, 0)] if run.lasts == option.least else []
        return demands + ([(end, start, 0)] if run.lasts == option.most else [])

    def _kept(self, demands: frozenset[Demand], alive: frozenset[int]) -> frozenset[Demand] | None:
        """What demands mean for the ranks that still matter; None where no ranks keep them."""
        key = (demands, alive)
        if key not in self.orders:
            order = closure(demands)
            self.orders[key] = (
                None
                if order is None
                else frozenset((a, b, w) for (a, b), w in only(order, alive).items())
            )
        return self.orders[key]

    def _alive(self, runs: Sequence[Run | None], lags: Sequence[Lag | None]) -> frozenset[int]:
        """The nodes whose ranks can still matter after a tick."""
        mattering = {i for i, run in enumerate(runs) if run is not None}
        for (u, v, _), lag in zip(self.arcs, lags, strict=True):
            if lag is not None and lag.tight is not None:
                mattering |= {u, v}
        return frozenset(node for i in mattering for node in (2 * i, 2 * i + 1))

    # --- state -----------------------------------------------------------------------------------

    def _outcomes(
        self, situation: Situation, starts: Sequence[tuple[int, Run]], due: Sequence[int]
    ) -> list[Outcome]:
        touching = [(i, run) for i, run in starts if self.jobs[i].touches_state]
        ended = ((i, situation.runs[i]) for i in due if self.jobs[i].touches_state)
        ending = [(i, run) for i, run in ended if run is not None]
        if not touching and not ending:
            return [(situation.values, frozenset())]
        # All that the happenings of an instant, and what is held throughout it, are made from.
        key = (
            situation.values,
            tuple((i, run is not None) for i, run in enumerate(situation.runs)),
            tuple((i, run.is_point, run.drawn_out, _end_node(i, run)) for i, run in touching),
            tuple((i, _end_node(i, run)) for i, run in ending),
        )
        if key not in self.outcomes:
            happenings = [happening_at_end(self.jobs[i], _end_node(i, run)) for i, run in ending]
            happenings += [h for i, run in touching for h in self._happenings(i, run)]
            self.outcomes[key] = orders(situation.values, self._held(situation, due), happenings)
        return self.outcomes[key]

    def _held(self, situation: Situation, due: Sequence[int]) -> frozenset[Fact]:
        """What must hold throughout this tick: for those that neither start nor end in it."""
        running = (i for i, run in enumerate(situation.runs) if run is not None and i not in due)
        return frozenset(self.plain.bounds) | frozenset(
            (var, value)
            for i in running
            for at, var, value in self.jobs[i].conditions
            if at == "all"
        )

    def _happenings(self, i: int, run: Run) -> list[Happening]:
        job = self.jobs[i]
        if run.is_point:
            return [whole_happening(job, 2 * i)]
        start = happening_at_start(job, 2 * i)
        return [start, happening_at_end(job, 2 * i + 1, 2 * i)] if run.drawn_out else [start]

    # --- the schedule ----------------------------------------------------------------------------

    def _steps(self) -> list[Step]:
        steps: list[Step] = []
        step = None if self.best is None else self.best.path
        while step is not None:
            steps.append(step)
            step = step.before
        return steps[::-1]

    @property
    def tardiness(self) -> int:
        """That of the best schedule, whether it is an objective or not."""
        ends = {i: run.end for step in self._steps() for i, run in step.starts}
        owners = self.owners
        late = sum(
            job.weight * max(0, ends[i] - job.due)
            for i, job in enumerate(self.jobs)
            if job.due is not None
        )
        for party in self.plain.parties:
            if party.due is not None and set(party.members) <= set(owners) and party.members:
                last = max(ends[owners.index(m)] for m in party.members)
                late += party.weight * max(0, last - party.due)
        return late

    def schedule(self) -> Schedule:
        """The best schedule, with ranks."""
        demands = [d for step in self._steps() for d in step.demands]
        found = ranks(demands, range(2 * self.size))
        entries = [
            self._entry(i, step.now, run, found) for step in self._steps() for i, run in step.starts
        ]
        return Schedule(tuple(entries))

    def _entry(self, i: int, start: int, run: Run, found: dict[int, int]) -> Entry:
        return Entry(
            self.jobs[i].id,
            self.plain.time(start),
            self.plain.time(run.end),
            resources=dict(run.option.held),
            mode=run.option.mode,
            occurrence=i - self.owners.index(self.owners[i]) + 1,
            rank=found[2 * i],
            end_rank=found[_end_node(i, run)],
        )


def _end_node(i: int, run: Run) -> int:
    """The node of an end: that of the start where the duration is fixed or both are one."""
    return 2 * i + 1 if run.option.ends_freely and not run.is_point else 2 * i


def _after(arc: Arc, time: int) -> Lag:
    """What an arc asks of `after` once the point of `before` is known."""
    soonest = time + arc.least
    return Lag(soonest, None if arc.most is None else time + arc.most, soonest)


def _before(arc: Arc, time: int) -> Lag:
    """What an arc asks of `before` once the point of `after` is known."""
    latest = time - arc.least
    # Without a maximal lag nothing bounds it from below: the first tick there is will do.
    return Lag(0 if arc.most is None else time - arc.most, latest, latest)


def _clipped(lags: Sequence[Lag | None], now: int) -> tuple[Lag | None, ...]:
    """What is met by all that comes after `now` anyway is forgotten."""
    return tuple(lag and _clip(lag, now) for lag in lags)


def _clip(lag: Lag, now: int) -> Lag | None:
    soonest = max(lag.soonest, now + 1)
    tight = lag.tight if lag.tight is not None and lag.tight > now else None
    if soonest == now + 1 and lag.latest is None and tight is None:
        return None
    return Lag(soonest, lag.latest, tight)
