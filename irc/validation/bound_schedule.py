"""A bound schedule: the entries of a schedule, matched by name with the actions of a task."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import NamedTuple, Protocol, TypeVar

from irc.errors import IrcError
from irc.model import (
    Action,
    DurationRange,
    Group,
    Mode,
    Resource,
    StateGoal,
    StateVariable,
    StockChange,
    Task,
    Use,
)
from irc.model.objectives import is_time
from irc.model.quantities import Number
from irc.model.times import Clock
from irc.model.world_changes import is_world_change
from irc.schedule import ABANDONED, BEGUN, CANCELLED, Entry, LeftOut, Schedule
from irc.validation.open_times import Calendars, Span, time_in


class UncheckedTaskError(IrcError, ValueError):
    """The task itself has a fault, so no schedule of it can be judged; `irc check` reports it."""


class InexactTimeError(IrcError, ValueError):
    """A schedule holds a time that is not an exact number, such as a binary float."""


class Past(NamedTuple):
    """The history of an occurrence that began before the time as of which a schedule is judged.

    Its start and its resources are certain. Its end lies in a range, which is a single time for
    each occurrence that has ended or lasts a fixed time."""

    over: bool
    earliest_end: Number
    latest_end: Number

    @property
    def end_is_certain(self) -> bool:
        """Whether nobody can choose its end any more."""
        return self.earliest_end == self.latest_end


class Occurrence(NamedTuple):
    """An entry of the schedule with the action it is an occurrence of.

    `action` has the stock, state and cost of the chosen mode among its own.
    `shortest` and `longest` bound its duration; both are None where the mode is not known. A
    cancelled occurrence could end at any time. Where it pauses they bound the time from its start
    to its end, which is never the longest, so that its end has a rank of its own.
    `number` is its place in `BoundSchedule.occurrences`; `past` is None for an occurrence that may
    still be planned differently.
    """

    number: int
    entry: Entry
    action: Action
    mode: Mode | None
    shortest: Number | None
    longest: Number | None
    start: Number
    end: Number
    rank: int
    end_rank: int
    past: Past | None
    paused: Number | None = None
    """The closed time between its start and its end; None where it does not pause."""
    most_work: Number | None = None
    """The greatest working time of an occurrence that pauses."""
    by_itself: bool = False
    """Whether it stands for a timed change of state, which no entry says and whose rank is free."""

    @property
    def name(self) -> str:
        """Its name in messages."""
        entry = self.entry
        return repr(entry.id) + (
            f" (occurrence {entry.occurrence})" if entry.occurrence != 1 else ""
        )

    @property
    def uses(self) -> tuple[Use, ...]:
        """The uses it holds from start to end: the action's own and its mode's."""
        return self.action.uses if self.mode is None else self.action.uses + self.mode.uses

    @property
    def ends_freely(self) -> bool:
        """Whether its duration was chosen, so that its end has a rank of its own.

        An ended occurrence keeps the rank that it had, though an observation has fixed its
        duration.
        """
        return self.shortest != self.longest or self.rank != self.end_rank

    @property
    def is_history(self) -> bool:
        """Whether no plan decides it: it is history, or a timed change."""
        return self.past is not None or self.by_itself

    @property
    def ends_by_itself(self) -> bool:
        """Whether it has an end of its own that nobody chose.

        An end that can be chosen may be chosen at an event, after the changes of that event.
        """
        return self.start < self.end and self.shortest == self.longest

    @property
    def cancelled(self) -> bool:
        """Whether it ended before it was done, so that the effects of its end did not happen."""
        return self.entry.status == CANCELLED


@dataclass(frozen=True)
class BoundSchedule:
    """A task and a schedule of it, with every name resolved."""

    task: Task
    clock: Clock
    schedule: Schedule
    actions: dict[str, Action]
    resources: dict[str, Resource]
    variables: dict[str, StateVariable]
    groups: dict[str, Group]
    occurrences: tuple[Occurrence, ...]
    by_action: dict[str, list[Occurrence]]
    done: frozenset[str]
    """The actions that have an entry which is not cancelled."""
    unknown: tuple[Entry, ...]
    """Entries that name no action of the task."""
    at: Number | None = None
    """Entries that began before this time are history; None: no entry is."""
    calendars: Calendars | None = None
    """The closed times until the last end."""
    changes: tuple[Occurrence, ...] = ()
    """The timed changes of state until the last end, numbered behind the occurrences."""

    def closed_times(self, occurrence: Occurrence) -> list[Sequence[Span]]:
        """The closed times of an occurrence: of its calendar, and where it pauses of what it holds.

        What takes no time holds nothing.
        """
        if self.calendars is None:
            return []
        return _closed_times(self.calendars, occurrence.action, occurrence.entry, self.resources)

    @property
    def happening(self) -> tuple[Occurrence, ...]:
        """All occurrences and timed changes, by their numbers."""
        return self.occurrences + self.changes

    @cached_property
    def left_out(self) -> frozenset[LeftOut]:
        """The actions and goals that a running task goes on without; none as of t = 0."""
        return frozenset() if self.at is None else frozenset(self.schedule.left_out)

    @property
    def ranked(self) -> bool:
        """Whether the schedule gives ranks; if not, the validator searches for them."""
        return any(e.rank or e.end_rank not in (None, 0) for e in self.schedule.entries)

    def is_present(self, group: Group) -> bool:
        """Whether all actions of a group are present; a cancelled action is not present."""
        return bool(group.actions) and self.done.issuperset(group.actions)


def bind(task: Task, schedule: Schedule, at: Number | None = None) -> BoundSchedule:
    """Binds a schedule to its task; entries that began before `at` are history.

    Raises `UncheckedTaskError` for a task that refers to a name it does not define, and
    `InexactTimeError` for an entry whose times are not exact numbers.
    """
    if at is not None and not isinstance(at, (int, Fraction)):
        raise InexactTimeError(
            f"cannot judge a schedule as of the time {at!r}; use an int or a Fraction"
        )
    clock = task.clock
    for entry in schedule.entries:
        _check_exact(entry)
    if clock.resolution is not None:
        schedule = _read_at_resolution(schedule, clock)
        at = None if at is None else clock.number(at)
    actions = _by_id("action", task.actions)
    resources = _by_id("resource", task.resources)
    variables = _by_id("state variable", task.state)
    groups = _by_id("group", task.groups)
    _check_references(task, actions, resources, variables)
    calendars = Calendars(task, clock, schedule.makespan)
    occurrences: list[Occurrence] = []
    by_action: dict[str, list[Occurrence]] = {}
    unknown = []
    for entry in schedule.entries:
        action = actions.get(entry.id)
        if action is None:
            unknown.append(entry)
            continue
        occurrence = _occurrence(len(occurrences), entry, action, clock, at)
        if action.breaks == "pause":
            occurrence = _pausing(occurrence, calendars, resources)
        occurrences.append(occurrence)
        by_action.setdefault(entry.id, []).append(occurrence)
    return BoundSchedule(
        task,
        clock,
        schedule,
        actions,
        resources,
        variables,
        groups,
        tuple(occurrences),
        by_action,
        frozenset(o.entry.id for o in occurrences if not o.cancelled),
        tuple(unknown),
        at,
        calendars,
        tuple(_changes(task, schedule, clock, at, len(occurrences))),
    )


def _read_at_resolution(schedule: Schedule, clock: Clock) -> Schedule:
    """The schedule with its times as multiples of the task's resolution."""
    entries = tuple(
        replace(entry, start=clock.number(entry.start), end=clock.number(entry.end))
        for entry in schedule.entries
    )
    stated = tuple(
        replace(
            o,
            value=clock.number(o.value),
            bound=None if o.bound is None else clock.number(o.bound),
        )
        if is_time(o.name)
        else o
        for o in schedule.objective
    )
    return replace(schedule, entries=entries, objective=stated)


def _changes(
    task: Task, schedule: Schedule, clock: Clock, at: Number | None, first: int
) -> Iterator[Occurrence]:
    """The timed changes until the last end, each as an occurrence of an action of its own."""
    last = schedule.makespan
    for variable in task.state:
        given = "set" if variable.is_number else "value"
        times = {clock.number(change.at): change for change in variable.changes}
        for time, change in sorted(times.items()):
            if time > last:
                break
            effect = {"at": "start", "var": variable.id, given: change.value}
            name = f"the timed change of {variable.id}"
            action = Action.model_validate(
                {"id": name, "duration": 0, "start": change.at, "effects": [effect]}
            )
            past = None if at is None or time > at else Past(True, time, time)
            entry = Entry(name, time, time)
            yield Occurrence(
                first, entry, action, None, 0, 0, time, time, 0, 0, past, by_itself=True
            )
            first += 1


def _occurrence(
    number: int, entry: Entry, action: Action, clock: Clock, at: Number | None
) -> Occurrence:
    mode = next((m for m in action.modes if m.id == entry.mode), None)
    duration = action.duration
    if action.modes:
        duration = None if mode is None else mode.duration
    shortest: Number | None
    longest: Number | None
    if isinstance(duration, DurationRange):
        shortest, longest = clock.number(duration.min), clock.number(duration.max)
    else:
        shortest = longest = None if duration is None else clock.number(duration)
    if entry.status == CANCELLED and longest is not None:
        shortest = 0
    past = None if at is None else _past(entry, action, (shortest, longest), clock, at)
    tied = shortest == longest and not (past is not None and past.over)
    end_rank = entry.rank if entry.end_rank is None or tied else entry.end_rank
    return Occurrence(
        number,
        entry,
        action.in_mode(entry.mode),
        mode,
        shortest,
        longest,
        entry.start,
        entry.end,
        entry.rank,
        end_rank,
        past,
    )


def _pausing(
    occurrence: Occurrence, calendars: Calendars, resources: dict[str, Resource]
) -> Occurrence:
    """The occurrence of an action that pauses, with the closed time in it."""
    closed = _closed_times(calendars, occurrence.action, occurrence.entry, resources)
    paused = time_in(closed, occurrence.start, occurrence.end)
    longest = occurrence.longest
    if longest is None:
        return occurrence._replace(paused=paused)
    lasts = occurrence.end - occurrence.start
    return occurrence._replace(
        paused=paused,
        most_work=longest,
        longest=max(longest + paused, lasts) + 1,
        end_rank=occurrence.entry.last_rank,
    )


def _closed_times(
    calendars: Calendars, action: Action, entry: Entry, resources: dict[str, Resource]
) -> list[Sequence[Span]]:
    found = [] if action.calendar is None else [calendars.closed(action.calendar)]
    if action.breaks == "pause" and entry.start < entry.end:
        held = (resources[name] for name, n in entry.resources.items() if n and name in resources)
        found += [calendars.without_capacity(r) for r in held if r.kind != "reservoir"]
    return found


def _past(
    entry: Entry,
    action: Action,
    bounds: tuple[Number | None, Number | None],
    clock: Clock,
    at: Number,
) -> Past | None:
    """Whether an entry is history, and until when; a start at `at` itself is, where its status says
    that it was observed, and a change of the world.
    """
    if entry.start > at or (entry.start == at and not _began_now(entry, action, clock)):
        return None
    shortest, longest = bounds
    over = entry.end <= at
    if over or shortest is None or longest is None or shortest == longest:
        return Past(over, entry.end, entry.end)
    if not shortest <= entry.end - entry.start <= longest:
        return Past(over, entry.end, entry.end)  # It was observed to take another time.
    earliest = max(at, entry.start + shortest)
    return Past(over, earliest, max(earliest, entry.start + longest))


def _began_now(entry: Entry, action: Action, clock: Clock) -> bool:
    """Whether an entry that starts as of when it is judged has begun."""
    if entry.status in (CANCELLED, ABANDONED):
        return action.start is not None and clock.number(action.start) == entry.start
    return entry.status == BEGUN or is_world_change(action, clock)


def _check_exact(entry: Entry) -> None:
    for value in (entry.start, entry.end):
        if not isinstance(value, (int, Fraction)):
            raise InexactTimeError(
                f"the entry of {entry.id!r} has the time {value!r}; use an int or a Fraction"
            )


class _Named(Protocol):
    @property
    def id(self) -> str: ...


_N = TypeVar("_N", bound=_Named)


def _by_id(what: str, parts: Iterable[_N]) -> dict[str, _N]:
    found: dict[str, _N] = {}
    for part in parts:
        first = found.setdefault(part.id, part)
        if first is not part and first != part:
            raise UncheckedTaskError(f"the {what} {part.id!r} is defined twice, in different ways")
    return found


def _check_references(
    task: Task,
    actions: dict[str, Action],
    resources: dict[str, Resource],
    variables: dict[str, StateVariable],
) -> None:
    repeatable = {action.id for action in actions.values() if action.may_repeat}
    renewable = {r.id for r in resources.values() if r.kind != "reservoir"}
    stocks = {r.id for r in resources.values() if r.kind == "reservoir"}
    for action in actions.values():
        _check_action(action, renewable, stocks, variables)
        if action.start is not None and action.id in repeatable:
            raise UncheckedTaskError(f"{action.id!r} may repeat, so it cannot have a fixed start")
    single = actions.keys() - repeatable
    for precedence in task.precedence:
        if precedence.before not in single or precedence.after not in single:
            for name in (precedence.before, precedence.after):
                _require_single(name, actions, repeatable, "a precedence")
    for group in task.groups:
        for name in group.actions:
            _require_single(name, actions, repeatable, f"the group {group.id!r}")
    for goal in task.goals:
        if isinstance(goal, StateGoal):
            _require(goal.var, variables, "a goal")
        else:
            _require(goal, actions, "a goal")


def _check_action(
    action: Action, renewable: set[str], stocks: set[str], variables: dict[str, StateVariable]
) -> None:
    where = f"the action {action.id!r}"
    if action.duration is None and not action.modes:
        raise UncheckedTaskError(f"{where} has neither a duration nor modes")
    for use in _all_uses(action):
        for name in use.alternatives:
            _require(name, renewable, f"a use of {where}")
    parts: tuple[Action | Mode, ...] = (action, *action.modes)
    for part in parts:
        stock_changes: tuple[StockChange, ...] = part.consumes + part.produces
        for change in stock_changes:
            _require(change.resource, stocks, f"a consumption or production of {where}")
        for condition in part.conditions:
            _require(condition.var, variables, f"a condition of {where}")
        for effect in part.effects:
            _require(effect.var, variables, f"an effect of {where}")


def _all_uses(action: Action) -> Iterator[Use]:
    yield from action.uses
    for mode in action.modes:
        yield from mode.uses


def _require_single(
    name: str, actions: dict[str, Action], repeatable: set[str], where: str
) -> None:
    _require(name, actions, where)
    if name in repeatable:
        raise UncheckedTaskError(f"{where} names {name!r}, which may occur more than once")


def _require(name: str, known: Container[str], where: str) -> None:
    if name not in known:
        raise UncheckedTaskError(f"{where} names {name!r}, which the task does not have")
