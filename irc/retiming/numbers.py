"""Number variables in re-timing: orders of happenings that keep every level as in the answer.

The changes of a number keep their order, so its level after each of them stays. A condition at a
happening stays between the changes around it; one that holds throughout opens no earlier than the
change before it, and closes no later than the first change that its limits do not allow.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import NamedTuple

from irc.problem import Activity, NumberCondition, NumberEffect, Problem
from irc.problem.decisions import AnswerError, Decision
from irc.retiming.state import Happening, HappeningOrder, Key, between, is_one_happening


class _Change(NamedTuple):
    key: Key
    happening: Happening
    effects: tuple[NumberEffect, ...]

    def level(self, before: int) -> int:
        """The level after it."""
        for effect in self.effects:
            before = effect.amount if effect.sets else before + effect.amount
        return before


class _Read(NamedTuple):
    key: Key
    happening: Happening
    condition: NumberCondition


class _Hold(NamedTuple):
    opening: tuple[Key, Happening]
    closing: tuple[Key, Happening]
    condition: NumberCondition


@dataclass(slots=True)
class _Timeline:
    """The reads, changes and holds of one number."""

    reads: list[_Read] = field(default_factory=list)
    changes: list[_Change] = field(default_factory=list)
    holds: list[_Hold] = field(default_factory=list)


def number_orders(
    problem: Problem,
    decisions: Sequence[Decision],
    tolerance: Fraction | int,
    *,
    only: int | None = None,
) -> Iterator[HappeningOrder]:
    """The orders of happenings that numbers demand: of all, or of one `only`.

    A level that is reached within `tolerance` after it is needed counts as reached in time. Raises
    `AnswerError` where the decisions leave a condition unmet.
    """
    for k, timeline in enumerate(_timelines(problem, decisions)):
        if only is None or only == k:
            yield from _NumberOrder(problem, k, timeline, tolerance).orders()


def number_suits(problem: Problem, decisions: Sequence[Decision], only: int) -> bool:
    """Whether all conditions, bounds and goals on a number hold exactly, and nothing interferes."""
    order = _NumberOrder(problem, only, _timelines(problem, decisions)[only], 0)
    ends = (d.end for d, a in zip(decisions, problem.activities, strict=True) if a.origin)
    return order.suits(max(ends, default=0))


def _timelines(problem: Problem, decisions: Sequence[Decision]) -> list[_Timeline]:
    timelines = [_Timeline() for _ in problem.numbers]
    for i, (activity, decision) in enumerate(zip(problem.activities, decisions, strict=True)):
        if activity.details.number_conditions or activity.details.number_effects:
            _add_activity(timelines, i, activity, decision)
    return timelines


def _add_activity(
    timelines: list[_Timeline], i: int, activity: Activity, decision: Decision
) -> None:
    one = is_one_happening(activity, decision)
    start = ((decision.start, decision.rank), Happening(i, False))
    end = start if one else ((decision.end, decision.end_rank), Happening(i, True))
    for condition in activity.details.number_conditions:
        timeline = timelines[condition.number]
        if one or condition.at == "start":
            timeline.reads.append(_Read(*start, condition))
        elif condition.at == "end":
            timeline.reads.append(_Read(*end, condition))
        else:
            timeline.holds.append(_Hold(start, end, condition))
    together: dict[tuple[int, bool], list[NumberEffect]] = {}
    for effect in activity.details.number_effects:
        together.setdefault((effect.number, effect.at_end and not one), []).append(effect)
    for (number, at_end), effects in together.items():
        change = _Change(*(end if at_end else start), tuple(effects))
        timelines[number].changes.append(change)


class _NumberOrder:
    """One number's changes in order, and the demands of reads and holds on them."""

    def __init__(
        self, problem: Problem, k: int, timeline: _Timeline, tolerance: Fraction | int
    ) -> None:
        self.problem, self.number = problem, problem.numbers[k]
        self.timeline, self.tolerance = timeline, tolerance
        self.changes = sorted(timeline.changes)
        self.keys = [change.key for change in self.changes]
        self.levels = [self.number.initial]
        for change in self.changes:
            self.levels.append(change.level(self.levels[-1]))

    def orders(self) -> Iterator[HappeningOrder]:
        for before, after in zip(self.changes, self.changes[1:], strict=False):
            yield from between(before.happening, after.happening, strict=True)
        for read in self.timeline.reads:
            yield from self._read(read)
        for hold in self.timeline.holds:
            yield from self._hold(hold)
        for change, ends in self._takings():
            yield from between(ends, change.happening, strict=False)

    def _takings(self) -> Iterator[tuple[_Change, Happening]]:
        """The changes that break protected limits, each with the end of what needs these."""
        for k, change in enumerate(self.changes):
            details = self.problem.activities[change.happening.activity].details
            for p in details.protects_limits:
                if p.activity < 0 or self.problem.numbers[p.condition.number] is not self.number:
                    continue
                before, after = map(p.condition.allows, self.levels[k : k + 2])
                if before and not after:
                    yield change, Happening(p.activity, True)

    def suits(self, last: Fraction | int) -> bool:
        """Whether everything holds exactly, with the changes until the last end."""
        timeline, levels = self.timeline, self.levels
        touched: list[tuple[Key, Happening]] = [(c.key, c.happening) for c in timeline.changes]
        touched += [(r.key, r.happening) for r in timeline.reads]
        count = bisect_right(self.keys, last, key=lambda key: key[0])
        goals = [
            g for g in self.problem.number_goals if self.problem.numbers[g.number] is self.number
        ]
        return (
            all(
                change.key != key or change.happening == happening
                for change in timeline.changes
                for key, happening in touched
            )
            and all(map(self.number.allows, levels[: count + 1]))
            and all(
                r.condition.allows(levels[bisect_left(self.keys, r.key)]) for r in timeline.reads
            )
            and all(map(self._is_held, timeline.holds))
            and all(g.allows(levels[count]) for g in goals)
        )

    def _is_held(self, hold: _Hold) -> bool:
        first = bisect_right(self.keys, hold.opening[0])
        last = bisect_left(self.keys, hold.closing[0])
        return all(map(hold.condition.allows, self.levels[first : max(first, last) + 1]))

    def _read(self, read: _Read) -> Iterator[HappeningOrder]:
        done = self._done(bisect_left(self.keys, read.key), read)
        if done:
            yield from between(self.changes[done - 1].happening, read.happening, strict=True)
        if done < len(self.changes):
            yield from between(read.happening, self.changes[done].happening, strict=True)

    def _hold(self, hold: _Hold) -> Iterator[HappeningOrder]:
        key, opening = hold.opening
        done = self._done(bisect_right(self.keys, key), _Read(key, opening, hold.condition))
        if done:
            yield from between(self.changes[done - 1].happening, opening, strict=False)
        breaking = next(
            (
                change
                for change, level in zip(self.changes[done:], self.levels[done + 1 :], strict=True)
                if not hold.condition.allows(level)
            ),
            None,
        )
        if breaking is None:
            return
        key, closing = hold.closing
        if breaking.key < key and breaking.key[0] < key[0] - self.tolerance:
            raise AnswerError(
                f"{self._name(opening)} needs limits of {self.number.id!r} throughout, "
                f"which {self._name(breaking.happening)} leaves in between"
            )
        yield from between(closing, breaking.happening, strict=False)

    def _done(self, count: int, need: _Read) -> int:
        """The number of changes before a need: those before it in the answer.

        Failing that, the next ones within the tolerance by which it is met.
        """
        if need.condition.allows(self.levels[count]):
            return count
        for k in range(count, len(self.changes)):
            change = self.changes[k]
            if change.key[0] > need.key[0] + self.tolerance:
                break
            if change.happening.activity == need.happening.activity:
                break
            if need.condition.allows(self.levels[k + 1]):
                return k + 1
        raise AnswerError(
            f"{self._name(need.happening)} needs a level of {self.number.id!r} "
            "that it does not have then"
        )

    def _name(self, happening: Happening) -> str:
        return repr(self.problem.activities[happening.activity].id)
