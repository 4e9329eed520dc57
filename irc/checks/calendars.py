"""Checks of calendars, and of what actions and resources say about them."""

from __future__ import annotations

from datetime import datetime, time
from typing import TYPE_CHECKING

from irc.diagnostics import Code, Findings, did_you_mean
from irc.diagnostics.source import Pointer
from irc.lowering.calendar_horizon import CalendarTimes, last_closed
from irc.model import Action, Calendar, ClosedTime, OpenTime, Task
from irc.model.base import write_time
from irc.model.quantities import TimeError
from irc.model.zones import zone, zone_names

if TYPE_CHECKING:
    from irc.checks.structure import DeclaredNames, TimeChecks


def check_calendars(
    task: Task, names: DeclaredNames, times: TimeChecks, findings: Findings
) -> None:
    """Reports every fault of a task's calendars, and of references to them."""
    before = len(findings.items)
    for i, calendar in enumerate(task.calendars):
        _Check(task, calendar, ("calendars", i), times, findings).run()
    _check_origin(task, findings)
    for i, resource in enumerate(task.resources):
        if resource.calendar is not None:
            names.require("calendar", resource.calendar, ("resources", i, "calendar"))
    for i, action in enumerate(task.actions):
        if not action.is_simple:
            _check_action(action, ("actions", i), names, times, findings)
    if len(findings.items) == before and task.calendars:
        _check_never_open(task, findings)


def _check_action(
    action: Action, at: Pointer, names: DeclaredNames, times: TimeChecks, findings: Findings
) -> None:
    if action.calendar is not None:
        names.require("calendar", action.calendar, (*at, "calendar"))
    if action.max_pause is None:
        return
    if action.breaks != "pause":
        findings.add(
            Code.WITHOUT_EFFECT,
            f"action {action.id!r} does not pause, so 'max_pause' has no meaning",
            (*at, "max_pause"),
            at_key=True,
            hint='add "breaks": "pause", or remove it',
        )
    number = times.number(action.max_pause, "max_pause", (*at, "max_pause"))
    if number is not None and number < 0:
        findings.add(
            Code.NEGATIVE_TIME,
            f"the longest pause of action {action.id!r} is negative",
            (*at, "max_pause"),
            hint="a pause is 0 or more",
        )


def _check_origin(task: Task, findings: Findings) -> None:
    """Reports an origin without a zone that calendars of different zones would read differently."""
    if task.origin is None or task.origin.tzinfo is not None:
        return
    named = {c.time_zone for c in task.calendars if c.every is None}
    if len(named) < 2 or named == {None}:
        return
    known = next((found for name in sorted(map(str, named)) if (found := zone(name))), None)
    hint = "give the origin an offset from UTC"
    if known is not None:
        hint += f', such as "{task.origin.replace(tzinfo=known).isoformat()}"'
    findings.add(
        Code.INCOMPLETE,
        "the origin has no time zone, and the calendars have different ones",
        ("origin",),
        hint=hint,
    )


def _check_never_open(task: Task, findings: Findings) -> None:
    """Reports calendars without any open time, or without one before the task's deadline."""
    known = CalendarTimes(task, task.clock)
    try:
        deadline = None if task.deadline is None else task.number(task.deadline)
    except TimeError:
        return
    for i, calendar in enumerate(task.calendars):
        names = frozenset([calendar.id])
        until = known.search_span(names) + last_closed(calendar, task.clock)
        opened = known.of(names).until(until if deadline is None else min(until, deadline))
        if opened and (deadline is None or opened[0][0] < deadline):
            continue
        by = "" if deadline is None else " before the task's deadline"
        findings.add(
            Code.WINDOW,
            f"calendar {calendar.id!r} is never open{by}",
            ("calendars", i),
            hint="add open times, or remove closed ones",
        )


class _Check:
    """The checks of one calendar."""

    def __init__(
        self, task: Task, calendar: Calendar, at: Pointer, times: TimeChecks, findings: Findings
    ) -> None:
        self.task, self.calendar, self.at = task, calendar, at
        self.times, self.findings = times, findings
        self.name = f"calendar {calendar.id!r}"

    def run(self) -> None:
        """Adds every fault."""
        if self.calendar.every is None:
            self._zone()
            if self.task.origin is None:
                self.findings.add(
                    Code.INCOMPLETE,
                    f"{self.name} has times of day, but the task has no origin to count them from",
                    self.at,
                    hint='add "origin": "2026-03-02T06:00:00", or say how often it repeats: '
                    '"every": "1 day"',
                )
        else:
            self._cycle()
        for k, part in enumerate(self.calendar.open):
            self._opening(part, (*self.at, "open", k))
        for k, closed in enumerate(self.calendar.closed):
            self._closing(closed, (*self.at, "closed", k))

    def _zone(self) -> None:
        name = self.calendar.time_zone
        if name is None or zone(name) is not None:
            return
        known = zone_names()
        same_end = [z for z in known if z.rsplit("/", 1)[-1].lower() == name.lower()]
        hint = f"did you mean `{min(same_end)}`?" if same_end else did_you_mean(name, known)
        self.findings.add(
            Code.UNKNOWN_NAME,
            f"there is no time zone {name!r}",
            (*self.at, "time_zone"),
            hint=hint or "a zone has a name of the IANA database, such as `Europe/Berlin`",
        )

    def _cycle(self) -> None:
        calendar = self.calendar
        for field in ("time_zone",):
            if getattr(calendar, field) is not None:
                self.findings.add(
                    Code.WITHOUT_EFFECT,
                    f"{self.name} counts from t = 0, so '{field}' has no meaning",
                    (*self.at, field),
                    at_key=True,
                    hint='remove it, or write times of day instead of "every"',
                )
        every = self.times.number(calendar.every or 0, "every", (*self.at, "every"))
        if every is not None and every <= 0:
            self.findings.add(
                Code.NEGATIVE_TIME,
                f"{self.name} repeats after no time",
                (*self.at, "every"),
                hint='a cycle takes some time, such as "1 day"',
            )

    def _opening(self, part: OpenTime, at: Pointer) -> None:
        cyclic = self.calendar.every is not None
        if cyclic and part.days:
            self.findings.add(
                Code.WITHOUT_EFFECT,
                f"{self.name} counts cycles, not days of the week",
                (*at, "days"),
                at_key=True,
                hint='remove the days, or write times of day instead of "every"',
            )
        for field, said in (("from", part.from_), ("to", part.to)):
            if isinstance(said, str) is cyclic:
                self.findings.add(
                    Code.BAD_TIME,
                    f"'{field}' of {self.name} is {_shown(said)}, "
                    + ("not a time since the cycle began" if cyclic else "not a time of day"),
                    (*at, field),
                    hint="write it as 6, or '6 h'" if cyclic else 'write it as "06:00"',
                )
            elif cyclic and not isinstance(said, str):
                self._in_cycle(field, said, (*at, field))

    def _in_cycle(self, field: str, said: object, at: Pointer) -> None:
        number = self.times.number(said, field, at)  # type: ignore[arg-type]
        every = self.times.clock.exact(self.calendar.every or 0)
        if number is not None and not 0 <= number <= every:
            self.findings.add(
                Code.BAD_TIME,
                f"'{field}' of {self.name} is {_shown(said)}, outside of its cycle",
                at,
                hint=f"a cycle goes from 0 to {_shown(self.calendar.every)}",
            )

    def _closing(self, closed: object, at: Pointer) -> None:
        if isinstance(closed, ClosedTime):
            if isinstance(closed.from_, datetime) and isinstance(closed.to, datetime):
                empty = closed.from_.replace(tzinfo=None) >= closed.to.replace(tzinfo=None)
            else:
                start = self.times.number(closed.from_, "from", (*at, "from"))
                end = self.times.number(closed.to, "to", (*at, "to"))
                empty = start is not None and end is not None and start >= end
            if empty:
                self.findings.add(
                    Code.EMPTY_RANGE,
                    f"this closed time of {self.name} begins at {_shown(closed.from_)} "
                    f"and ends at {_shown(closed.to)}, so it is empty",
                    at,
                    hint="swap the two, or correct one of them",
                )
        elif not isinstance(closed, datetime) or closed.time() != time():
            self.findings.add(
                Code.BAD_TIME,
                f"{_shown(closed)} is no day on which {self.name} is closed",
                at,
                hint='write a date, such as "2026-12-25", or a {"from": …, "to": …}',
            )


def _shown(said: object) -> str:
    return said if isinstance(said, str) else str(write_time(said))
