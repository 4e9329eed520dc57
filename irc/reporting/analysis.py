"""The analysis of a schedule: all that tables, charts and reports show, in exact numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from irc.lowering.lower import lower
from irc.model import Action, Task
from irc.model.dates import Dates
from irc.model.quantities import Number
from irc.problem import Problem
from irc.problem.decisions import AnswerError
from irc.problem.objective_values import setups_done
from irc.reporting.closed import ClosedTimes, Interval, union, within
from irc.reporting.levels import (
    actions_in_modes,
    loads,
    state_happenings,
    states,
    stock_happenings,
    stocks,
)
from irc.reporting.orders import chain_to, on_chains, order_rows
from irc.reporting.reasons import Reasons, exact_of
from irc.reporting.resources import day_rows, resource_rows
from irc.reporting.rows import (
    ActionRow,
    DayRow,
    Key,
    Load,
    OrderRow,
    Pauses,
    Reason,
    ResourceRow,
    SetupRow,
    State,
    Stock,
)
from irc.retiming.slack import slacks
from irc.schedule import Entry, Schedule


@dataclass(frozen=True)
class Analysis:
    """All that there is to see of a schedule; times are in the task's time unit.

    `span` is the makespan, to which closed times, loads and resources are followed. `dates` turns
    times into date-times, where the task has an origin and its dates reach the makespan. `critical`
    is a chain of waits that ends with the makespan; `slack_known` whether the slacks of actions are
    (`ActionRow.slack`). `objective` are the schedule's values.
    """

    name: str
    time_unit: str
    schedule: Schedule
    dates: Dates | None
    span: Number
    actions: tuple[ActionRow, ...]
    orders: tuple[OrderRow, ...]
    resources: tuple[ResourceRow, ...]
    days: tuple[DayRow, ...]
    loads: tuple[Load, ...]
    stocks: tuple[Stock, ...]
    states: tuple[State, ...]
    setups: tuple[SetupRow, ...]
    pauses: tuple[Pauses, ...]
    closed_calendars: Mapping[str, tuple[Interval, ...]]
    critical: tuple[Key, ...]
    slack_known: bool

    def action(self, key: Key) -> ActionRow:
        """The row of an occurrence. Raises `KeyError`."""
        return next(row for row in self.actions if row.key == key)


def analyse(
    task: Task,
    schedule: Schedule,
    problem: Problem | None = None,
    slack: Mapping[str, int] | None = None,
    *,
    reasons: bool = True,
) -> Analysis:
    """The analysis of a schedule of a task.

    The schedule is one that was made for the task, or judged against it: its entries name actions
    of the task. A `problem` that was lowered from the task saves the work, and so does its `slack`
    by action, in ticks. Without `reasons`, which take half of the time, there are none where slack
    says what is critical, and chains of waits have their last occurrence only. Takes O(n log n).
    """
    problem = lower(task) if problem is None else problem
    known = {action.id for action in task.actions}
    entries = tuple(entry for entry in schedule if entry.id in known)
    span = schedule.makespan
    closed = ClosedTimes(task, span)
    actions = actions_in_modes(task, entries)
    held = loads(entries)
    setups = tuple(_setups(problem, replace(schedule, entries=entries)))
    stock = stock_happenings(entries, actions)
    state = state_happenings(task, entries, actions)
    free = _slack(problem, schedule, slack)
    why = dict[Key, tuple[Reason, ...]]()
    if reasons or not free:
        known_reasons = Reasons(
            task,
            entries,
            actions,
            closed=closed,
            loads=held,
            setups=setups,
            stock=stock,
            state=state,
        )
        why = {(entry.id, entry.occurrence): known_reasons.of(entry) for entry in entries}
    lasts = [(e.id, e.occurrence) for e in entries if e.end == span]
    critical = frozenset(k for k, s in free.items() if not s) if free else on_chains(lasts, why)
    orders = tuple(order_rows(task, entries, why))
    dates = Dates.of(task)
    dates = dates if dates is not None and dates.reach(span) and dates.reach(0) else None
    loaded = tuple(
        Load(r.id, held.get(r.id, ((0, 0),)), closed.capacity(r), closed.of_resource(r))
        for r in task.resources
        if r.kind == "renewable"
    )
    return Analysis(
        name=task.name or schedule.task or "schedule",
        time_unit=task.time_unit,
        schedule=schedule,
        dates=dates,
        span=span,
        actions=tuple(_action_rows(task, entries, why, free, critical)),
        orders=orders,
        resources=tuple(resource_rows(task, entries, loaded, setups, span)),
        days=tuple(day_rows(dates, entries, loaded, orders, span)),
        loads=loaded,
        stocks=tuple(stocks(task, stock)),
        states=tuple(states(task, state)),
        setups=setups,
        pauses=tuple(_pauses(task, entries, actions, closed)),
        closed_calendars={c.id: closed.of_calendar(c.id) for c in task.calendars},
        critical=_longest(lasts, why),
        slack_known=bool(free),
    )


def _longest(lasts: Sequence[Key], why: Mapping[Key, tuple[Reason, ...]]) -> tuple[Key, ...]:
    """A chain of waits to the makespan, of those the one with the fewest occurrences."""
    chains = [chain_to(last, why) for last in sorted(lasts)[:20]]
    return min(chains, key=len, default=())


def _slack(
    problem: Problem, schedule: Schedule, known: Mapping[str, int] | None
) -> dict[Key, Number]:
    """The slack of each occurrence; empty where it is not known.

    Groups that are present bind nothing in time but deadlines, which their actions have.
    """
    found = known
    if found is None:
        try:
            found = slacks(replace(problem, groups=()), schedule)
        except AnswerError:
            return {}
    return {(name, 1): problem.to_units(ticks) for name, ticks in found.items()}


def _setups(problem: Problem, schedule: Schedule) -> list[SetupRow]:
    if not problem.has_setups:
        return []
    return [
        SetupRow(
            name,
            exact_of(after.start - time),
            after.start,
            None if before is None else (before.id, before.occurrence),
            (after.id, after.occurrence),
            cost,
        )
        for name, before, after, time, cost in setups_done(problem, schedule)
    ]


def _pauses(
    task: Task, entries: Sequence[Entry], actions: Mapping[Key, Action], closed: ClosedTimes
) -> list[Pauses]:
    """The closed times within occurrences that pause: of their calendar and of what they hold."""
    resources = {resource.id: resource for resource in task.resources}
    found = []
    for entry in entries:
        action = actions[entry.id, entry.occurrence]
        if action.breaks != "pause":
            continue
        spans = [closed.of_calendar(action.calendar)]
        spans += [closed.of_resource(resources[r]) for r in entry.resources if r in resources]
        cut = union(part for own in spans for part in within(own, entry.start, entry.end))
        if cut:
            found.append(Pauses(entry.id, entry.occurrence, tuple(cut)))
    return found


def _action_rows(
    task: Task,
    entries: Sequence[Entry],
    why: Mapping[Key, tuple[Reason, ...]],
    free: Mapping[Key, Number],
    critical: frozenset[Key],
) -> list[ActionRow]:
    actions = {action.id: action for action in task.actions}
    orders: dict[str, list[str]] = {}
    for group in task.groups:
        for name in group.actions:
            orders.setdefault(name, []).append(group.id)
    rows, number = [], task.clock.number
    for entry in entries:
        action, key = actions[entry.id], (entry.id, entry.occurrence)
        due = None if action.due is None else number(action.due)
        rows.append(
            ActionRow(
                action=entry.id,
                occurrence=entry.occurrence,
                label=action.label or entry.id,
                start=entry.start,
                end=entry.end,
                duration=entry.duration,
                paused=entry.paused,
                mode=entry.mode,
                resources=dict(entry.resources),
                orders=tuple(orders.get(entry.id, ())),
                release=number(action.release),
                due=due,
                lateness=None if due is None else exact_of(entry.end - due),
                slack=free.get(key),
                critical=key in critical,
                status=entry.status,
                why=why.get(key, ()),
            )
        )
    return rows
