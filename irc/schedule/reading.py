"""Reads schedule documents, and reports every fault in them."""

from __future__ import annotations

from collections.abc import Mapping
from decimal import Decimal
from fractions import Fraction
from typing import Any

from irc.diagnostics import Code, Findings, InputError, Report, did_you_mean
from irc.diagnostics.source import Pointer, Source
from irc.model.dates import Dates
from irc.model.nulls import without_nulls
from irc.model.quantities import Number, TimeError, exact
from irc.model.times import format_number, parse_number, parse_span
from irc.schedule.entry import Entry, LeftOut
from irc.schedule.schedule import ObjectiveValue, Schedule, Status
from irc.schedule.writing import SCHEDULE_VERSION

_SCHEDULE_FIELDS = frozenset(
    [
        "irc_schedule",
        "task",
        "task_sha256",
        "status",
        "makespan",
        "objective",
        "actions",
        "target",
        "engine",
        "seconds",
        "time_unit",
        "origin",
        "time_zone",
        "outcome",
        "interrupted",
        "repeatable",
        "left_out",
    ]
)


_ENTRY_FIELDS = frozenset(
    [
        *("id", "start", "end", "resources", "mode", "occurrence", "rank", "end_rank", "status"),
        *("paused", "start_at", "end_at"),
    ]
)


def schedule_from_json(raw: Mapping[str, Any], source: Source | None = None) -> Schedule:
    """Reads a schedule document; only `actions` with `id`, `start` and `end` are required.

    Raises `InputError` with every fault. The stated makespan must be that of the entries.
    """
    reader = _ScheduleReader(Findings())
    schedule = reader.schedule(without_nulls(raw))
    if reader.findings.items:
        raise InputError(Report(tuple(reader.findings.items), source))
    return schedule


_MOST_SECONDS = 1e300
"""Limit on seconds: more does not fit into a float."""


class _ScheduleReader:
    def __init__(self, findings: Findings) -> None:
        self.findings = findings
        self.dates: Dates | None = None

    def _fault(
        self, message: str, pointer: Pointer, *, hint: str | None = None, at_key: bool = False
    ) -> None:
        self.findings.add(Code.BAD_SCHEDULE, message, pointer, hint=hint, at_key=at_key)

    def _unknown_field(self, what: str, pointer: Pointer, known: frozenset[str]) -> None:
        key = str(pointer[-1])
        hint = did_you_mean(key, sorted(known)) or f"known fields are {', '.join(sorted(known))}"
        self._fault(f"{what} has no field {key!r}", pointer, hint=hint, at_key=True)

    def schedule(self, raw: Mapping[str, Any]) -> Schedule:
        for key in raw.keys() - _SCHEDULE_FIELDS:
            self._unknown_field("a schedule", (key,), _SCHEDULE_FIELDS)
        version = raw.get("irc_schedule", SCHEDULE_VERSION)
        if version != SCHEDULE_VERSION:
            self._fault(f"unknown schedule version {version!r}; expected '1'", ("irc_schedule",))
        self.dates = self._dates(raw)
        actions = raw.get("actions")
        if not isinstance(actions, list):
            self._fault(
                "a schedule needs 'actions', a list",
                ("actions",) if actions else (),
                hint='expected "actions": [{"id": "a", "start": 0, "end": 3}, …]',
            )
            actions = []
        entries = tuple(
            entry
            for i, item in enumerate(actions)
            if (entry := self.entry(item, ("actions", i))) is not None
        )
        status = self._status(raw)
        schedule = Schedule(
            entries,
            status,
            self._objective(raw.get("objective") or []),
            self._text(raw, "task"),
            self._text(raw, "task_sha256"),
            self._text(raw, "target"),
            self._text(raw, "engine"),
            self._seconds(raw),
            self._text(raw, "time_unit"),
            self._flag(raw, "interrupted"),
            left_out=self._left_out(raw.get("left_out")),
            repeatable=self._flag(raw, "repeatable") if "repeatable" in raw else None,
            dates=self.dates,
        )
        self._check_makespan(raw, schedule)
        return schedule

    def _status(self, raw: Mapping[str, Any]) -> Status:
        value = raw.get("status", "feasible")
        if value not in list(Status):
            self._fault(
                f"unknown status {value!r}; known are {', '.join(Status)}",
                ("status",),
                hint=did_you_mean(str(value), list(Status)) or "leave it out, or use one of these",
            )
            return Status.FEASIBLE
        return Status(value)

    def _left_out(self, raw: Any) -> tuple[LeftOut, ...]:
        found: list[LeftOut] = []
        for k, what in enumerate(raw if isinstance(raw, list) else []):
            if isinstance(what, str):
                found.append(what)
            elif (
                isinstance(what, dict)
                and what.keys() == {"var", "value"}
                and isinstance(what["var"], str)
                and isinstance(what["value"], (bool, str))
            ):
                found.append((what["var"], what["value"]))
            else:
                self._fault("expected an action, or a 'var' and its 'value'", ("left_out", k))
        if not isinstance(raw, (list, type(None))):
            self._fault("'left_out' must be a list", ("left_out",))
        return tuple(found)

    def _dates(self, raw: Mapping[str, Any]) -> Dates | None:
        """The dates that a document states by its origin, time zone and unit."""
        origin, name = self._text(raw, "origin"), self._text(raw, "time_zone")
        if origin is None or not isinstance(raw.get("time_unit"), str):
            return None
        try:
            return Dates.read(origin, name, raw["time_unit"])
        except TimeError as error:
            self._fault(f"'origin': {error}", ("origin",))
            return None

    def _check_date(self, raw: Mapping[str, Any], key: str, time: Number, at: Pointer) -> None:
        """Reports a date-time that contradicts the time beside it."""
        stated, dates = raw.get(key), self.dates
        if stated is None or self.findings.items:
            return
        hint = f"leave {key!r} out: it follows from the time beside it and the 'origin'"
        if not isinstance(stated, str):
            self._fault(f"{key!r} must be a date-time as text", (*at, key), hint=hint)
        elif dates is not None and not dates.agree(stated, time):
            beside = f"{key.removesuffix('_at')!r} is {format_number(time)}"
            self._fault(f"{key!r} is {stated}, but {beside}", (*at, key), hint=hint)

    def _text(self, raw: Mapping[str, Any], key: str) -> str | None:
        value = raw.get(key)
        if value is not None and not isinstance(value, str):
            self._fault(f"'{key}' must be text", (key,))
            return None
        return value

    def _flag(self, raw: Mapping[str, Any], key: str) -> bool:
        value = raw.get(key, False)
        if not isinstance(value, bool):
            self._fault(f"'{key}' must be true or false", (key,))
            return False
        return value

    def _seconds(self, raw: Mapping[str, Any]) -> float | None:
        value = raw.get("seconds")
        if isinstance(value, bool) or not isinstance(value, (int, float, Decimal, type(None))):
            self._fault("'seconds' must be a number", ("seconds",))
            return None
        if value is not None and not -_MOST_SECONDS < value < _MOST_SECONDS:
            self._fault("'seconds' is out of range", ("seconds",))
            return None
        return None if value is None else float(value)

    def _check_makespan(self, raw: Mapping[str, Any], schedule: Schedule) -> None:
        if raw.get("makespan") is None or self.findings.items:
            return
        stated = self.time(raw["makespan"], ("makespan",))
        if stated != schedule.makespan and not self.findings.items:
            latest = format_number(schedule.makespan)
            self._fault(
                f"the latest end is {latest}, not the stated makespan",
                ("makespan",),
                hint="correct the makespan or the times, or leave the makespan out",
            )

    def _objective(self, raw: Any) -> tuple[ObjectiveValue, ...]:
        if not isinstance(raw, list) or not all(
            isinstance(o, dict) and isinstance(o.get("name"), str) and "value" in o for o in raw
        ):
            self._fault("'objective' must be a list of {name, value, bound}", ("objective",))
            return ()
        values = []
        for i, o in enumerate(raw):
            value = self.time(o["value"], ("objective", i, "value"))
            bound = o.get("bound")
            values.append(
                ObjectiveValue(
                    o["name"],
                    value,
                    None if bound is None else self.time(bound, ("objective", i, "bound")),
                )
            )
        return tuple(values)

    def entry(self, raw: Any, pointer: Pointer) -> Entry | None:
        """One entry, or None where it names no action."""
        if not isinstance(raw, dict) or not isinstance(raw.get("id"), str):
            self._fault("expected an object with 'id', 'start' and 'end'", pointer)
            return None
        for key in raw.keys() - _ENTRY_FIELDS:
            self._unknown_field("an entry", (*pointer, key), _ENTRY_FIELDS)
        for key in ("start", "end"):
            if key not in raw:
                message = f"the entry of {raw['id']!r} has no '{key}'"
                self._fault(message, pointer, hint=f'add "{key}": …')
        mode, status = raw.get("mode"), raw.get("status")
        for key in ("mode", "status"):
            if not isinstance(raw.get(key), (str, type(None))):
                self._fault(f"'{key}' must be text", (*pointer, key))
        start = self.time(raw.get("start", 0), (*pointer, "start"))
        end = self.time(raw.get("end", 0), (*pointer, "end"))
        self._check_date(raw, "start_at", start, pointer)
        self._check_date(raw, "end_at", end, pointer)
        return Entry(
            raw["id"],
            start,
            end,
            self._resources(raw.get("resources"), (*pointer, "resources")),
            mode if isinstance(mode, str) else None,
            self._whole(raw, "occurrence", 1, pointer),
            self._whole(raw, "rank", 0, pointer),
            self._whole(raw, "end_rank", None, pointer),
            status if isinstance(status, str) else None,
            self.time(raw.get("paused", 0), (*pointer, "paused")),
        )

    def _whole(self, raw: Mapping[str, Any], key: str, default: Any, pointer: Pointer) -> Any:
        value = raw.get(key, default)
        if value is not default and type(value) is not int:
            self._fault(f"'{key}' must be a whole number", (*pointer, key))
            return default
        return value

    def _resources(self, raw: Any, pointer: Pointer) -> Mapping[str, int]:
        if raw is None:
            return {}
        if isinstance(raw, dict) and all(type(v) is int for v in raw.values()):
            return dict(raw)
        self._fault("'resources' must map names to whole amounts", pointer)
        return {}

    def time(self, raw: Any, pointer: Pointer) -> Number:
        """A number of the task's unit; 0 after a fault has been reported."""
        try:
            value = parse_number(raw) if isinstance(raw, str) else parse_span(raw)
        except TimeError as error:
            hint = 'write a number of the task\'s time unit, such as 3, 0.5 or "1/3"'
            self._fault(f"'{pointer[-1]}': {error}", pointer, hint=hint)
            return 0
        if not isinstance(value, (int, Fraction)):
            self._fault(f"'{pointer[-1]}': expected a number of the task's time unit", pointer)
            return 0
        return exact(value) if isinstance(value, Fraction) else value
