"""What is left of a frozen problem, with the present as time 0: what planners are given.

A planner begins at 0 and would have to live through the whole history again. Here what has ended is
gone: its effects are in the initial state and the initial stock, lags to it are releases, deadlines
or lags to an instant of its own, what runs is an activity that starts at once and takes the rest of
its time. What has ended just now is over too, and the world has changed: the past comes first. The
way back leads through the frozen problem, which is re-timed as a whole.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from irc.execution.executed import Fact, choices_of, ticks_of
from irc.execution.fresh_names import fresh_name
from irc.execution.lags import Lags, twins
from irc.lowering.choices import NEVER
from irc.passes.unroll import unroll
from irc.problem import (
    Activity,
    Details,
    Earlier,
    Problem,
    Renewable,
    Reservoir,
    Shared,
    Variable,
    Window,
)
from irc.problem.decisions import ABSENT, Decision
from irc.retiming.retime import retime
from irc.retiming.to_schedule import schedule_of
from irc.schedule import Entry, Schedule


class PastError(Exception):
    """Something that must still happen would have had to happen before; the text says what."""


@dataclass(frozen=True)
class Rebased:
    """What is left of `whole`: `places` says where each of its activities stands in `problem`."""

    whole: Problem
    facts: Mapping[int, Fact]
    now: int
    problem: Problem
    places: Mapping[int, int]

    def merged(self, whole: Problem, schedule: Schedule) -> Schedule:
        """A schedule of what is left, with the history before it: one of the `whole` problem.

        (`whole` has the activities of the frozen problem, after any passes.) Raises `AnswerError`.
        """
        entries: dict[str, list[Entry]] = {}
        for entry in schedule.entries:
            entries.setdefault(entry.id, []).append(entry)
        depth = max((len(found) for found in entries.values()), default=0)
        unrolled = unroll(whole, depth)
        rank = 1 + max((f.end_rank for f in self.facts.values()), default=0)
        decisions = [
            self._decision(unrolled, i, activity, entries, rank)
            for i, activity in enumerate(unrolled.activities)
        ]
        return schedule_of(unrolled, retime(unrolled, decisions))

    @cached_property
    def _first(self) -> Mapping[str, int]:
        """The number of the first occurrence of each action that has not begun."""
        return {
            a.id: a.details.occurrence
            for i, a in enumerate(self.whole.activities)
            if i not in self.facts
        }

    def _decision(
        self,
        whole: Problem,
        i: int,
        activity: Activity,
        entries: Mapping[str, list[Entry]],
        rank: int,
    ) -> Decision:
        fact = self.facts.get(i)
        if fact is not None:
            start_rank, end, end_rank = fact.rank, fact.end, fact.end_rank
            if i in self.places:
                entry = entries[self.problem.activities[self.places[i]].id][0]
                end = self.now + ticks_of(self.whole, entry.end)
                end_rank = rank + entry.last_rank
                start_rank = rank + entry.rank if fact.start == self.now else fact.rank
            mode = 0 if activity.details.modes else None
            chosen = tuple(use.alternatives[0] for use in activity.uses)
            return Decision(fact.start, end, chosen, mode=mode, rank=start_rank, end_rank=end_rank)
        found = entries.get(activity.id, [])
        number = activity.details.occurrence - self._first[activity.id]
        if number >= len(found):
            return ABSENT
        entry = sorted(found, key=lambda e: e.occurrence)[number]
        return self._placed(whole, activity, entry, rank)

    def _placed(self, whole: Problem, activity: Activity, entry: Entry, rank: int) -> Decision:
        mode, chosen = choices_of(whole, activity, entry)
        return Decision(
            self.now + ticks_of(self.whole, entry.start),
            self.now + ticks_of(self.whole, entry.end),
            chosen or (),
            mode=mode,
            rank=rank + entry.rank,
            end_rank=rank + entry.last_rank,
        )


def rebase(problem: Problem, facts: Mapping[int, Fact], now: int) -> Rebased:
    """What is left of a frozen problem, before the passes that say what need not be asked.

    Raises `PastError` where what is left had to happen before.
    """
    if problem.deadline is not None and problem.deadline < now:
        problem = _all_too_late(problem, facts)
    kept = [i for i in range(len(problem.activities)) if i not in facts or facts[i].running]
    names = Counter(a.id for a in problem.activities)
    places = {i: k for k, i in enumerate(kept)}
    activities = []
    for i in kept:
        fact, activity = facts.get(i), problem.activities[i]
        if fact is None:
            activities.append(_shifted(activity, now, facts))
        else:
            activities.append(_residual(activity, fact, now, names))
    arcs = Lags(facts, now, places, activities, names)
    for arc in problem.arcs:
        arcs.add(arc, keep=bool(problem.variables))
    if problem.variables:
        arcs.arcs += twins(problem, facts, places)
    deadline = problem.deadline
    return Rebased(
        problem,
        facts,
        now,
        replace(
            problem,
            activities=tuple(arcs.activities),
            arcs=tuple(arcs.arcs),
            resources=tuple(_later(r, now) for r in problem.resources),
            shared=tuple(_shared_later(s, now) for s in problem.shared),
            deadline=None if deadline is None else deadline - now,
            reservoirs=_stock_now(problem, facts, now, places),
            variables=_state_now(problem, facts, now, places),
            groups=tuple(
                replace(g, members=members)
                for g in problem.groups
                if (members := tuple(places[i] for i in g.members if i in places))
            ),
            wanted=tuple(places[i] for i in problem.wanted if i in places),
            sequel=tuple(
                (places[a], places[b]) for a, b in problem.sequel if a in places and b in places
            ),
            earlier=_earlier(problem, kept, len(arcs.activities), now),
            start_from=(),
            recurring={
                places[i]: tuple(e._replace(start=e.start - now) for e in more)
                for i, more in problem.recurring.items()
            },
        ),
        places,
    )


def _all_too_late(problem: Problem, facts: Mapping[int, Fact]) -> Problem:
    """The problem behind the task's deadline: nothing new can happen, and nothing may have to."""
    activities = list(problem.activities)
    for i, activity in enumerate(activities):
        if i in facts:
            continue
        repeats = activity.details.repeats
        if not activity.details.optional and (repeats is None or repeats[0] > 0):
            raise PastError("the task's deadline has passed, and not everything is done")
        activities[i] = replace(activity, deadline=NEVER)
    return replace(problem, activities=tuple(activities), deadline=None)


def _earlier(
    problem: Problem, kept: Sequence[int], size: int, now: int
) -> tuple[Earlier | None, ...]:
    if not problem.earlier:
        return ()
    found = [problem.earlier[i] for i in kept]
    shifted = [None if e is None else e._replace(start=e.start - now) for e in found]
    return (*shifted, *(None for _ in range(size - len(shifted))))


def _is_over(fact: Fact, at_end: bool, now: int, left: bool) -> bool:
    """Whether what a fact does at its start, or its end, has been done for good."""
    return not left or (not at_end and fact.start < now)


def _shifted(activity: Activity, now: int, facts: Mapping[int, Fact]) -> Activity:
    """An open activity: all its times are earlier by now, and it counts its occurrences anew."""
    if activity.start is not None and activity.start < now and not activity.details.optional:
        raise PastError(f"{activity.id!r} has a fixed start that has passed, and has not begun")
    deadline = activity.deadline
    if activity.start is not None and activity.start < now:
        deadline = NEVER
    details = activity.details
    due, release = details.due, activity.release
    if details.previous is not None:
        release = max(release, facts[details.previous].end)
    if due is not None or details.previous is not None or details.occurrence != 1:
        due = None if due is None else due - now
        details = replace(details, due=due, previous=None, occurrence=1)
    if details.not_before is not None:
        details = replace(details, not_before=None)
    return replace(
        activity,
        release=max(0, release - now),
        start=None if activity.start is None else max(0, activity.start - now),
        deadline=None if deadline is None else max(NEVER, deadline - now),
        details=details,
    )


def _residual(activity: Activity, fact: Fact, now: int, names: Counter[str]) -> Activity:
    """The rest of what runs: it starts at once, and what it did at its start before is done."""
    elapsed = now - fact.start
    shortest = max(0, activity.duration_min - elapsed)
    longest = max(0, activity.duration_max - elapsed)
    details = activity.details
    name = activity.id
    if names[name] > 1:  # An occurrence of an action of which more may follow.
        name = fresh_name(f"{name} ({details.occurrence})", names)
        names[name] += 1
        shortest = longest = max(0, fact.end - now)
    own = Details(
        modes=tuple(m._replace(duration_min=shortest, duration_max=longest) for m in details.modes),
        use_modes=details.use_modes,
        stock=tuple(c for c in details.stock if c.at_end or not elapsed),
        conditions=tuple(c for c in details.conditions if c.at != "start" or not elapsed),
        effects=tuple(e for e in details.effects if e.at_end or not elapsed),
        due=None if details.due is None else details.due - now,
        weight=details.weight,
        reward=details.reward,
        cost=details.cost,
    )
    return replace(
        activity,
        id=name,
        start=0,
        release=0,
        deadline=None if activity.deadline is None else max(NEVER, activity.deadline - now),
        duration_min=shortest,
        duration_max=longest,
        details=own,
    )


def _later(resource: Renewable, now: int) -> Renewable:
    if not resource.windows:
        return resource
    return replace(resource, windows=_windows_later(resource.windows, now))


def _shared_later(shared: Shared, now: int) -> Shared:
    if not shared.windows:
        return shared
    return replace(shared, windows=_windows_later(shared.windows, now))


def _windows_later(windows: Iterable[Window], now: int) -> tuple[Window, ...]:
    return tuple(
        Window(max(0, w.start - now), w.end - now, w.capacity) for w in windows if w.end > now
    )


def _stock_now(
    problem: Problem, facts: Mapping[int, Fact], now: int, places: Mapping[int, int]
) -> tuple[Reservoir, ...]:
    """What the past has left of each reservoir."""
    levels = [r.initial for r in problem.reservoirs]
    for i, fact in facts.items():
        for change in problem.activities[i].details.stock:
            if _is_over(fact, change.at_end, now, i in places):
                levels[change.reservoir] += change.amount
    return tuple(
        replace(r, initial=level) for r, level in zip(problem.reservoirs, levels, strict=True)
    )


def _state_now(
    problem: Problem, facts: Mapping[int, Fact], now: int, places: Mapping[int, int]
) -> tuple[Variable, ...]:
    """What the past has made of each variable."""
    values = [v.initial for v in problem.variables]
    writes: list[tuple[int, int, bool, int, int]] = []
    for i, fact in facts.items():
        for effect in problem.activities[i].details.effects:
            if not _is_over(fact, effect.at_end, now, i in places):
                continue
            time, rank = (fact.end, fact.end_rank) if effect.at_end else (fact.start, fact.rank)
            # (What ended at an instant comes before what happened at it by itself.)
            writes.append((time, rank, fact.start == time, effect.var, effect.value))
    for _, _, _, var, value in sorted(writes):
        values[var] = value
    return tuple(
        replace(v, initial=value) for v, value in zip(problem.variables, values, strict=True)
    )
