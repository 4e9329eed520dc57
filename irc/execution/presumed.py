"""The facts of a running task as of a time: observations, and the part of the plan presumed.

In the mode "assume" a plan is presumed to be carried out as it is, unless something else was
observed or it cannot have been (`irc.execution.possible`). In the mode "confirm" nothing has begun
or ended until that was observed.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from math import floor

from irc.events.observed import Outcome
from irc.execution.history import History, without_begun
from irc.execution.observations import Observed
from irc.execution.possible import Happened
from irc.execution.state import Key, key_of
from irc.execution.work_spans import WorkSpans
from irc.model import Action, DurationRange, Task, Use
from irc.model.quantities import Number, exact
from irc.model.times import Clock, common_tick
from irc.model.world_changes import is_world_change
from irc.schedule import CANCELLED, Entry, Schedule

_NOTHING = Observed()


@dataclass(frozen=True)
class Presumed:
    """Entries as they are taken to be, and those of them that have begun (`begun`)."""

    entries: dict[Key, Entry]
    begun: set[Key]


def presumed(
    history: History, task: Task, now: Number, actions: Mapping[str, Action] | None = None
) -> Presumed:
    """The facts as of `now` about a task without its observations, and its plan.

    `actions` are those of the task, where some are to be taken as an event has revised them.
    """
    return _Presuming(history, task, now, actions).all()


def as_of(history: History, task: Task, now: Number) -> History:
    """The history as it is taken to be at `now`: its entries, and which of them have begun.

    `task` is the task without its observations.
    """
    taken = presumed(history, task, now)
    cancelled = dict(history.cancelled)
    failed = {key[0]: o.ended for key, o in history.observed.items() if o.failed}
    for action in task.actions if failed else ():
        ended = failed.get(action.id)
        if ended is not None and not action.may_repeat:
            cancelled[action.id] = ended
    return replace(
        history,
        entries=taken.entries,
        begun=taken.begun,
        cancelled=cancelled,
        least_ends=dict(_least_ends(history, taken, task, now)),
    )


def _least_ends(
    history: History, taken: Presumed, task: Task, now: Number
) -> Iterator[tuple[Key, Number]]:
    """Times before which what runs of actions that repeat does not end."""
    if history.assumes and not history.observed:
        return
    spans = _spans(task, history, task.actions)
    repeat = {action.id: action for action in task.actions if action.may_repeat}
    for key in taken.begun if repeat else ():
        action, entry = repeat.get(key[0]), taken.entries[key]
        observed = history.observed.get(key, _NOTHING)
        seen = observed.end is not None and observed.ended is None
        if action is None or entry.end <= now or not (seen or not history.assumes):
            continue
        usual = length_of(action, entry, spans, task.clock) == spans.work(action, entry)
        soonest = min(entry.end, soon(action, entry, task, now, spans))
        yield key, soonest if usual else entry.end


def not_as_planned(history: History, now: Number) -> list[Entry]:
    """The entries that should have begun by `now` and cannot have, of a history as of then."""
    if not history.assumes:
        return []
    return [
        entry
        for key, entry in history.entries.items()
        if entry.start < now
        and key not in history.begun
        and (history.held is None or entry.start < history.held)
        and not _waits(history, key, entry)
    ]


def fix_begun(history: History, task: Task, now: Number) -> None:
    """Keeps what has begun by now, before an event revises the task."""
    begun = presumed(history, task, now).begun
    history.late |= {
        key
        for key, entry in history.entries.items()
        if entry.start < now and key not in begun and entry.status is None
    }
    history.begun = begun


def adopt(history: History, schedule: Schedule, now: Number, begun: Collection[Key]) -> None:
    """Takes a schedule as the one that is carried out from now on; `begun` has begun by now."""
    failed = {key for key, observed in history.observed.items() if observed.failed}
    history.plan = {key_of(entry): entry for entry in schedule.entries}
    # (That it failed is an observation, which may be corrected.)
    history.entries = {
        key: replace(entry, status=None) if key in failed else without_begun(entry)
        for key, entry in history.plan.items()
    }
    history.begun = {k for k, e in history.entries.items() if k in begun or e.start < now}
    history.late, history.held, history.disturbed = set(), None, False


def outcomes(history: History, task: Task, now: Number) -> list[Outcome]:
    """The facts as of `now` that have to be written into the task.

    `history` is as it is taken to be at `now`. Of actions that may repeat, only the history knows.
    """
    found: list[Outcome] = []
    if not history.observed and history.assumes:
        return found
    actions = {a.id: a for a in task.actions if not a.may_repeat}
    spans = _spans(task, history, task.actions)
    for key, entry in history.entries.items():
        action = actions.get(key[0])
        if action is None or key not in history.begun:
            continue
        observed = history.observed.get(key, _NOTHING)
        if not observed.has_begun and (history.assumes or key in history.done):
            continue
        outcome = _outcome(history, task, action, entry, observed, now, spans)
        found.append(outcome._replace(resources=tuple(entry.resources)))
    return found


def _spans(task: Task, history: History, actions: Iterable[Action]) -> WorkSpans:
    """The working times of a task, for all times that the history knows."""

    def instants() -> Iterator[Number]:
        for entry in (*history.entries.values(), *history.plan.values()):
            yield from (entry.start, entry.end)
        for observed in history.observed.values():
            for fact in observed.facts:
                yield from (fact.time, fact.expected or 0)
        for action in actions:
            yield from _durations(action, task.clock)

    return WorkSpans(task, instants())


def _outcome(
    history: History,
    task: Task,
    action: Action,
    entry: Entry,
    observed: Observed,
    now: Number,
    spans: WorkSpans,
) -> Outcome:
    started, took = observed.started, entry.end - entry.start
    if started is None and entry.start == now:
        started = now
    if observed.failed:
        return Outcome(action.id, started, at_least=took, failed=entry.end, began=entry.start)
    if entry.status == CANCELLED:
        return Outcome(action.id, started, at_least=took, began=entry.start)
    if observed.ended is not None:
        return Outcome(action.id, started, took, began=entry.start)
    usual = length_of(action, entry, spans, task.clock)
    expected = observed.end is not None and observed.end.expected is not None
    if usual is None:
        return Outcome(action.id, started)
    other = usual != spans.work(action, entry)
    if other or (expected and observed.end is not None and not observed.end.as_planned):
        return Outcome(action.id, started, took, began=entry.start)
    seen_now = observed.end is not None and observed.end.time == now
    if entry.end > now and (seen_now or not history.assumes):
        soonest = min(entry.end, soon(action, entry, task, now, spans))
        return Outcome(action.id, started, at_least=soonest - entry.start, began=entry.start)
    return Outcome(action.id, started)


def length_of(action: Action, entry: Entry, spans: WorkSpans, clock: Clock) -> Number | None:
    """The duration of an occurrence, without pauses: by the task if fixed, by the plan if a range.

    None where the action has modes and the entry gives none.
    """
    duration = action.duration
    if action.modes:
        duration = next((m.duration for m in action.modes if m.id == entry.mode), None)
    if duration is None:
        return None
    if isinstance(duration, DurationRange):
        planned = spans.work(action, entry)
        return max(clock.number(duration.min), min(planned, clock.number(duration.max)))
    return clock.number(duration)


def _waits(history: History, key: Key, entry: Entry) -> bool:
    """Whether an occurrence was observed not to have begun when it was to.

    A plan that has it begin later, or was made at that very instant, is presumed like any other.
    """
    observed = history.observed.get(key, _NOTHING)
    if observed.begin is None or not observed.waits:
        return False
    time = observed.begin.time
    return entry.start < time or (entry.start == time and key in history.begun)


def _order(entry: Entry) -> tuple[Number, int, str, int]:
    """The order in which entries are asked whether they can have begun."""
    return entry.start, entry.rank, entry.id, entry.occurrence


class _Presuming:
    def __init__(
        self, history: History, task: Task, now: Number, actions: Mapping[str, Action] | None
    ) -> None:
        self.history, self.task, self.now = history, task, now
        self.clock = task.clock
        self._actions = actions

    @cached_property
    def actions(self) -> Mapping[str, Action]:
        if self._actions is not None:
            return self._actions
        return {a.id: a for a in self.task.actions}

    def all(self) -> Presumed:
        history = self.history
        keys = [*history.entries, *(k for k in history.observed if k not in history.entries)]
        known: dict[Key, Entry] = {}
        possible: list[Entry] = []
        entries: dict[Key, Entry] = {}
        for key in keys:
            observed = history.observed.get(key, _NOTHING)
            entry = history.entries.get(key)
            if observed.has_begun:
                known[key] = entries[key] = self._as_observed(key, entry, observed)
            elif entry is None or (_waits(history, key, entry) and entry.status == CANCELLED):
                continue
            else:
                entries[key] = self._to_its_end(entry) if key in history.begun else entry
                if _waits(history, key, entry):
                    continue
                if key in history.fixed:
                    known[key] = entries[key]
                elif self._is_due(key, entry):
                    possible.append(entries[key])
        if not possible or (history.assumes and self._as_planned(known)):
            begun = {*known, *map(key_of, possible)}
            return Presumed(_ended(entries, begun, self), begun)
        return self._judged(entries, known, sorted(possible, key=_order))

    def _as_planned(self, known: Mapping[Key, Entry]) -> bool:
        """Whether nothing has come in since the last plan, and what is known goes as planned."""
        plan = self.history.plan
        return not self.history.disturbed and all(
            key in plan and plan[key].end == entry.end for key, entry in known.items()
        )

    def _is_due(self, key: Key, entry: Entry) -> bool:
        """Whether an occurrence has begun if all goes as planned."""
        history = self.history
        if key in history.begun:
            return True
        if entry.start >= self.now or key in history.late:
            return False
        if history.assumes and (history.held is None or entry.start < history.held):
            return True
        if entry.start < entry.end:
            return False
        action = self.actions.get(entry.id)
        return action is not None and is_world_change(action, self.clock)

    def _judged(
        self, entries: dict[Key, Entry], known: dict[Key, Entry], possible: list[Entry]
    ) -> Presumed:
        """The facts where each of `possible` has begun if it can have, beside what is `known`.

        The first that cannot have begun has not, and then all are asked again.
        """
        happened = Happened.all_of(self.task, (*known.values(), *possible), self.now)
        happened.certain = known
        happened.planned = {k: e for k, e in entries.items() if k not in happened.begun}
        happened.order = {key_of(entry): k for k, entry in enumerate(possible)}
        numbers: dict[str, list[int]] = {}
        for name, number in happened.begun:
            numbers.setdefault(name, []).append(number)
        place = 0
        while place < len(possible):
            entry = possible[place]
            place += 1
            key = key_of(entry)
            if key not in happened.begun or not self._is_forbidden(happened, entry):
                continue
            after = [(key[0], number) for number in numbers[key[0]] if number > key[1]]
            later = [k for k in after if k in happened.begun]
            if any(k in known for k in later):
                continue
            for k in (key, *later):  # Occurrences are numbered by start.
                happened.planned[k] = happened.begun[k]
                happened.remove(happened.begun[k])
            if entry.status == CANCELLED:
                del entries[key], happened.planned[key]
            place = min(place, self._first_that_relies_on(happened, entry, possible))
        begun = set(happened.begun)
        return Presumed(_ended(entries, begun, self), begun)

    def _is_forbidden(self, happened: Happened, entry: Entry) -> bool:
        """Whether what has happened forbids the start of an entry.

        What an event forbade after it had begun is no reason that it has not.
        """
        reasons = happened.reasons(entry)
        if not reasons or key_of(entry) not in self.history.begun:
            return bool(reasons)
        planned = self.history.entries.get(key_of(entry), entry)
        return bool(reasons - self.history.came_later - self._as_the_plan_has_it.reasons(planned))

    @cached_property
    def _as_the_plan_has_it(self) -> Happened:
        """The facts if all is carried out as planned, and as events have changed it."""
        happened = Happened.all_of(self.task, self.history.entries.values(), self.now)
        observed = (key for key, o in self.history.observed.items() if o.has_begun)
        happened.certain = {*self.history.fixed, *observed}
        return happened

    def _first_that_relies_on(
        self, happened: Happened, entry: Entry, possible: Sequence[Entry]
    ) -> int:
        """The first place of what an entry that has not begun may have let begin."""
        same_time = bisect_left(possible, entry.start, key=lambda e: e.start)
        after = (happened.order.get((name, 1)) for name in happened.after.get(entry.id, ()))
        return min((same_time, *(place for place in after if place is not None)))

    def _as_observed(self, key: Key, entry: Entry | None, observed: Observed) -> Entry:
        """The entry of what was observed to have begun."""
        name, number = key
        if entry is None:
            start = observed.started if observed.started is not None else 0
            entry = Entry(name, start, start, occurrence=number)
        action = self.actions.get(name)
        if observed.way is not None:
            entry = with_way(entry, observed, action)
        length = entry.end - entry.start
        if observed.started is not None or observed.way is not None:
            start = entry.start if observed.started is None else observed.started
            its = None if action is None else length_of(action, entry, self.spans, self.clock)
            end, entry = entry.end, replace(entry, start=start)
            if entry.status != CANCELLED:
                end = start + length
                if action is not None and its is not None:
                    end = self.spans.end(action, entry, its)
            entry = replace(entry, end=max(start, end))
        if observed.ended is not None:
            status = CANCELLED if observed.failed else None
            return replace(entry, end=observed.ended, status=status)
        if entry.status == CANCELLED:
            return entry
        if observed.end is not None:
            return self._still_running(entry, observed)
        return self._to_its_end(entry)

    def _still_running(self, entry: Entry, observed: Observed) -> Entry:
        """The entry of what was observed to run: it ends as expected, or in a while."""
        assert observed.end is not None
        expected = observed.end.expected
        if expected is not None and (expected > self.now or self.history.assumes):
            return replace(entry, end=expected)
        return replace(entry, end=max(entry.end, self.soon(entry)))

    def _to_its_end(self, entry: Entry) -> Entry:
        """The entry of what has begun: an end that must be observed is still to come."""
        if self.history.assumes or entry.status == CANCELLED or entry.end > self.now:
            return entry
        if key_of(entry) in self.history.done or self._is_an_instant(entry):
            return entry
        return replace(entry, end=self.soon(entry))

    def _is_an_instant(self, entry: Entry) -> bool:
        return entry.end == entry.start

    def soon(self, entry: Entry) -> Number:
        """When to expect an end that is overdue."""
        return soon(self.actions.get(entry.id), entry, self.task, self.now, self.spans)

    @cached_property
    def spans(self) -> WorkSpans:
        """The working times of what has begun."""
        return _spans(self.task, self.history, self.actions.values())


def soon(action: Action | None, entry: Entry, task: Task, now: Number, spans: WorkSpans) -> Number:
    """When to expect an end that is overdue: a tenth of its duration from now.

    (In steps of the durations of the task, where these are not too coarse.)
    """
    clock = task.clock
    its = None if action is None else length_of(action, entry, spans, clock)
    length = its or entry.end - entry.start
    grid = common_tick(d for a in task.actions for d in _durations(a, clock))
    least = Fraction(length) / 10
    if grid <= least:
        least = floor(least / grid) * grid
    elif 2 * grid <= length or not length:
        least = grid
    return clock.number(exact(now + least))


def _ended(entries: dict[Key, Entry], begun: set[Key], presuming: _Presuming) -> dict[Key, Entry]:
    """The entries, with ends that must be observed still to come for what has just begun."""
    if presuming.history.assumes:
        return entries
    for key in begun:
        if key not in presuming.history.observed:
            entries[key] = presuming._to_its_end(entries[key])
    return entries


def _durations(action: Action, clock: Clock) -> Iterator[Number]:
    for duration in (action.duration, *(mode.duration for mode in action.modes)):
        if isinstance(duration, DurationRange):
            yield clock.number(duration.min)
            yield clock.number(duration.max)
        elif duration is not None:
            yield clock.number(duration)


def with_way(entry: Entry, observed: Observed, action: Action | None) -> Entry:
    """The entry in the mode, and with the resources, that were observed.

    What was not observed is as planned; where that is not known either, no resource is.
    """
    if observed.way is None or action is None:
        return entry
    mode = observed.way.mode or entry.mode
    own = next((m for m in action.modes if m.id == mode), None)
    uses = [*action.uses, *(own.uses if own is not None else ())]
    taken = way_of(uses, observed.way.resources, entry.resources)
    return replace(entry, mode=mode, resources=taken or {})


def way_of(
    uses: Sequence[Use], named: Sequence[str], planned: Mapping[str, int]
) -> dict[str, int] | None:
    """The amounts of resources that the uses of an action hold, if it is done by those `named`.

    Uses that none of them is for keep what was planned. None where that is not known, or where
    there are not as many uses for what is named.
    """
    chosen: list[str | None] = [None] * len(uses)

    def match(k: int) -> bool:
        """Whether a use can be found for each of the names from the k-th on."""
        if k == len(named):
            return True
        for u in sorted(range(len(uses)), key=lambda u: planned.get(named[k], 0) < uses[u].amount):
            if chosen[u] is None and named[k] in uses[u].alternatives:
                chosen[u] = named[k]
                if match(k + 1):
                    return True
                chosen[u] = None
        return False

    if not match(0):
        return None
    left, held = dict(planned), dict[str, int]()
    for u, use in sorted(enumerate(uses), key=lambda item: len(item[1].alternatives)):
        name = chosen[u]
        if name is None:
            kept = [r for r in use.alternatives if left.get(r, 0) >= use.amount]
            only = use.alternatives if len(use.alternatives) == 1 else ()
            name = next(iter((*kept, *only)), None)
        if name is None:
            return None
        left[name] = left.get(name, 0) - use.amount
        held[name] = held.get(name, 0) + use.amount
    return held
