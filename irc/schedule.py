"""Schedules: the time, mode and resources of each occurrence, in exact numbers."""

from __future__ import annotations

import json
from collections.abc import Container, Iterator, Mapping
from dataclasses import dataclass, field, replace
from datetime import datetime
from decimal import Decimal
from enum import StrEnum
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

from irc.diagnostics import Code, Diagnostic, Findings, InputError, Report, did_you_mean
from irc.diagnostics.source import Pointer, Source
from irc.display.views import view
from irc.errors import NameNotFound, OptionError
from irc.model.dates import Dates, full
from irc.model.nulls import without_nulls
from irc.model.quantities import Number, TimeError, exact
from irc.model.times import format_number, json_number, parse_number, parse_span
from irc.outcome import INTERRUPTED, Outcome

if TYPE_CHECKING:
    from irc.display.svg import Bar
    from irc.model.task import Task

SCHEDULE_VERSION = "1"

CANCELLED = "cancelled"
"""The status of an entry that ended before it was done."""

ABANDONED = "abandoned"
"""The status of an entry that ran for a group that is given up."""

BEGUN = "begun"
"""The status of an entry that was observed to begin at the very instant of a replanning."""


LeftOut = str | tuple[str, bool | str]
"""An action, or a goal on state: a variable and its value."""


class Status(StrEnum):
    """The result of solving. `optimal` and `infeasible` always have a proof."""

    OPTIMAL = "optimal"
    FEASIBLE = "feasible"
    INFEASIBLE = "infeasible"
    UNKNOWN = "unknown"
    FAILED = "failed"


@dataclass(frozen=True, slots=True)
class Entry:
    """One occurrence of an action. Times are in the task's unit; resources map to amounts held."""

    id: str
    start: Number
    end: Number
    resources: Mapping[str, int] = field(default_factory=dict)
    mode: str | None = None
    occurrence: int = 1
    rank: int = 0
    end_rank: int | None = None
    status: str | None = None
    paused: Number = field(default=0, compare=False)
    """The closed time between its start and its end, in which its work pauses."""
    dates: Dates | None = field(default=None, compare=False, repr=False)
    """The dates of its task, where this has an origin."""

    @property
    def start_at(self) -> datetime | None:
        """Its start as a date-time, in the zone of the task's dates; None without an origin.

        Raises `irc.TimeError` beyond the years 1 to 9999.
        """
        return None if self.dates is None else self.dates.at(self.start)

    @property
    def end_at(self) -> datetime | None:
        """Its end as a date-time; see `start_at`."""
        return None if self.dates is None else self.dates.at(self.end)

    @property
    def last_rank(self) -> int:
        """The rank of its end: where none is given, that of its start."""
        return self.rank if self.end_rank is None else self.end_rank

    @property
    def duration(self) -> Number:
        """The time from its start to its end."""
        length = self.end - self.start
        return length if isinstance(length, int) else exact(length)


@dataclass(frozen=True, slots=True)
class ObjectiveValue:
    """The value reached for one objective, and a proven bound on it (None: none is known)."""

    name: str
    value: Number
    bound: Number | None = None


COLUMNS = (
    "action",
    "occurrence",
    "start",
    "end",
    "duration",
    "mode",
    "resources",
    "status",
)
"""The columns of a row of a schedule."""


def _by_time(entry: Entry) -> tuple[Number, int, Number, str, int]:
    return entry.start, entry.rank, entry.end, entry.id, entry.occurrence


@dataclass(frozen=True, slots=True)
class Schedule:
    """An answer: entries by start time, and what is known about them.

    `schedule["eat"]` is the entry of an action, `schedule["eat", 2]` that of its second occurrence.
    Iterating gives all entries in order of time. `interrupted`: planning was ended before it was
    done, so that a better answer may be close, or any.
    """

    entries: tuple[Entry, ...]
    status: Status = Status.FEASIBLE
    objective: tuple[ObjectiveValue, ...] = ()
    task: str | None = None
    task_sha256: str | None = None
    target: str | None = None
    engine: str | None = None
    seconds: float | None = None
    time_unit: str | None = None
    interrupted: bool = False
    reasons: tuple[Diagnostic, ...] = field(default=(), repr=False, compare=False)
    left_out: tuple[LeftOut, ...] = ()
    """The required actions and goals that a running task goes on without."""
    dates: Dates | None = field(default=None, repr=False, compare=False)
    """The dates of its task, where this has an origin; its entries have them, too."""
    made_for: Task | None = field(default=None, repr=False, compare=False)
    """The task that it answers, where irc has made it in this process."""
    _index: dict[tuple[str, int], Entry] | None = field(
        default=None, init=False, repr=False, compare=False
    )

    def __post_init__(self) -> None:
        dates = self.dates
        if dates is not None and any(entry.dates is not dates for entry in self.entries):
            dated = tuple(replace(entry, dates=dates) for entry in self.entries)
            object.__setattr__(self, "entries", dated)

    def of(self, task: Task) -> Schedule:
        """The schedule with the dates of a task, to which its tables and charts refer."""
        return replace(self, dates=Dates.of(task), made_for=task)

    @property
    def has_dates(self) -> bool:
        """Whether all of its times have a date-time."""
        dates = self.dates
        return dates is not None and dates.reach(0) and dates.reach(self.makespan)

    def __iter__(self) -> Iterator[Entry]:
        """The entries in order of time."""
        return iter(sorted(self.entries, key=_by_time))

    def __len__(self) -> int:
        return len(self.entries)

    def __bool__(self) -> bool:
        """Always true: a schedule without entries is an answer too (see `answered`)."""
        return True

    def __contains__(self, key: object) -> bool:
        """Whether it has an entry for an action (its id, or its id and occurrence)."""
        if isinstance(key, Entry):
            return key in self.entries
        return ((key, 1) if isinstance(key, str) else key) in self._by_key()

    def __getitem__(self, key: str | tuple[str, int]) -> Entry:
        """The entry of an action. Raises `irc.NameNotFound` (a `KeyError`) where there is none."""
        name, occurrence = (key, 1) if isinstance(key, str) else key
        found = self._by_key().get((name, occurrence))
        if found is not None:
            return found
        times = sum(entry.id == name for entry in self.entries)
        if times:
            raise NameNotFound(
                f"{name!r} has no occurrence {occurrence} in the schedule: it happens {times}"
                f" time{'s' if times > 1 else ''}"
            )
        hint = did_you_mean(name, {entry.id for entry in self.entries})
        said = hint or "it may be optional, or of another task"
        raise NameNotFound(f"{name!r} is not in the schedule; {said}")

    def _by_key(self) -> dict[tuple[str, int], Entry]:
        if self._index is None:
            index = {(entry.id, entry.occurrence): entry for entry in self.entries}
            object.__setattr__(self, "_index", index)
            return index
        return self._index

    @property
    def makespan(self) -> Number:
        """The latest end; 0 for an empty schedule."""
        return max((entry.end for entry in self.entries), default=0)

    @property
    def outcome(self) -> Outcome:
        """How the call ended; without a schedule, with the diagnostics that say why: `reasons`."""
        if self.interrupted:
            return Outcome.of(INTERRUPTED, self.reasons, answered=self.answered)
        return Outcome.of(str(self.status), self.reasons, _MESSAGES.get(self.status))

    @property
    def answered(self) -> bool:
        """Whether there is an answer (an empty schedule can be one)."""
        return self.status in (Status.OPTIMAL, Status.FEASIBLE)

    def __str__(self) -> str:
        """A line about the whole, and an aligned line for each entry."""
        rows = [
            (e.id, format_number(e.start), format_number(e.end), _held(e)) for e in self.entries
        ]
        name, start, end = (max((len(row[k]) for row in rows), default=0) for k in range(3))
        lines = [
            f"  {n:{name}}  {s:>{start}} – {e:>{end}}{self._unit}  {held}".rstrip()
            for n, s, e, held in rows
        ]
        return "\n".join([self._headline(), *lines])

    @property
    def _unit(self) -> str:
        return f" {self.time_unit}" if self.time_unit else ""

    def _headline(self) -> str:
        """The status and the makespan, in a line."""
        head = f"{self.task or 'schedule'}: {self.status}"
        if self.interrupted:
            head += ", interrupted"
        if not self.answered:
            return head
        return f"{head}, makespan {format_number(self.makespan)}{self._unit}"

    def _repr_html_(self) -> str:
        """The schedule as a picture and a table, for notebooks."""
        from irc.display.html import heading, table
        from irc.display.svg import bars_svg

        dated = self.has_dates
        unit = f" ({self.time_unit})" if self.time_unit and not dated else ""
        columns = ("action", "occurrence", f"start{unit}", f"end{unit}", "mode", "resources", "")
        rows = [
            (
                e.id,
                str(e.occurrence) if e.occurrence > 1 else "",
                *(_time_shown(e, time, dated) for time in (e.start, e.end)),
                e.mode or "",
                _held(e),
                e.status or "",
            )
            for e in self
        ]
        if not rows:
            return heading(self._headline())
        picture = bars_svg(self.bars(), self.time_unit or "", self._headline())
        return heading(self._headline()) + picture + table(columns, rows)

    def bars(self, marked: Container[str] = ()) -> list[Bar]:
        """A bar for each resource of each entry, to be drawn; those in `marked` stand out."""
        from irc.display.svg import Bar

        names = sorted({name for entry in self.entries for name in entry.resources})
        colours = {name: k for k, name in enumerate(names)}
        rows = [(e, row) for e in self for row in sorted(e.resources) or [""]]
        rows.sort(key=lambda pair: (pair[1] == "", pair[1]))
        unit = self._unit
        return [
            Bar(
                row or "no resource",
                float(e.start),
                float(e.end),
                e.id,
                f"{e.id}: {format_number(e.start)} – {format_number(e.end)}{unit}",
                colours.get(row, len(names)),
                e.id in marked,
            )
            for e, row in rows
        ]

    def to_rows(self) -> list[dict[str, Any]]:
        """A dictionary for each entry, in order of time, with exact times in the task's unit.

        With an origin it also has `start_at` and `end_at`, as date-times.
        """
        dated = self.has_dates
        return [
            {
                "action": e.id,
                "occurrence": e.occurrence,
                "start": e.start,
                "end": e.end,
                "duration": e.duration,
                "mode": e.mode,
                "resources": dict(e.resources),
                "status": e.status,
                **({"start_at": e.start_at, "end_at": e.end_at} if dated else {}),
            }
            for e in self
        ]

    def to_dataframe(self, library: str | None = None) -> Any:
        """A data frame of pandas or polars with the columns of `to_rows`.

        Without `library`, the one that is imported already, or else installed. Resources are a
        text; times are floats where any is a fraction. Raises `irc.LibraryMissing`.
        """
        from irc.display.frames import to_frame

        rows = [{**row, "resources": _held(e)} for row, e in zip(self.to_rows(), self, strict=True)]
        columns = (*COLUMNS, "start_at", "end_at") if self.has_dates else COLUMNS
        return to_frame(columns, rows, library)

    def orders(self, library: str | None = None, *, task: Task | None = None) -> Any:
        """A data frame with a row for each order: start, end, due date, lateness, critical part.

        Orders are groups, and actions with due dates. `task` is needed for a schedule that was
        read from a file. Raises `irc.LibraryMissing`, and `irc.OptionError` without a task.
        """
        return view("orders")(self._task(task), self, library)

    def resources(self, library: str | None = None, *, task: Task | None = None) -> Any:
        """A data frame with a row for each renewable resource: busy, set-up, idle, closed times.

        The arguments are those of `orders`.
        """
        return view("resources")(self._task(task), self, library)

    def days(self, library: str | None = None, *, task: Task | None = None) -> Any:
        """A data frame with a row for each day: what starts, ends and is due, the use of resources.

        Without an origin it has no rows. The arguments are those of `orders`.
        """
        return view("days")(self._task(task), self, library)

    def plot(self, *, task: Task | None = None) -> Any:
        """A Gantt chart by resource, as a chart of Altair; notebooks show it, `save` writes it.

        Raises what `orders` raises, and `irc.OptionError` for more rows than a picture can show.
        """
        return view("plot")(self._task(task), self)

    def save(self, path: str | Path, *, task: Task | None = None) -> None:
        """Writes it to a file of the kind that the ending names, such as `.svg` or `.xlsx`.

        The kinds are those of `irc show -o`. Raises `irc.OptionError` for another ending, and
        `irc.WriteError` where the file cannot be written.
        """
        view("save")(self._task(task), self, path)

    def _task(self, given: Task | None) -> Task:
        """The task to which tables and charts refer. Raises `irc.OptionError` where none is."""
        found = self.made_for if given is None else getattr(given, "ir", given)
        if found is None:
            raise OptionError("this schedule does not know its task: give it as `task=`")
        return found

    @classmethod
    def from_dict(cls, document: Mapping[str, Any]) -> Schedule:
        """The schedule that a document holds. Raises `InputError` with every fault."""
        return schedule_from_json(document)

    def to_dict(self) -> dict[str, Any]:
        """The document that `irc solve --format json` writes."""
        dated = self.has_dates
        return {
            "irc_schedule": SCHEDULE_VERSION,
            "task": self.task,
            "task_sha256": self.task_sha256,
            **({} if self.time_unit is None else {"time_unit": self.time_unit}),
            **(self.dates.to_dict() if self.dates is not None and dated else {}),
            "status": str(self.status),
            **({"interrupted": True} if self.interrupted else {}),
            "makespan": json_number(self.makespan) if self.answered else None,
            "objective": [
                {
                    "name": o.name,
                    "value": json_number(o.value),
                    "bound": None if o.bound is None else json_number(o.bound),
                }
                for o in self.objective
            ],
            "actions": [_entry_json(entry, dated) for entry in self.entries],
            **({"left_out": list(map(_left_out_json, self.left_out))} if self.left_out else {}),
            "target": self.target,
            "engine": self.engine,
            "seconds": self.seconds,
            **({} if self.answered else {"outcome": self.outcome.to_dict()}),
        }


_MESSAGES = {Status.FAILED: "the engine broke down before it had an answer"}


def _time_shown(entry: Entry, time: Number, dated: bool) -> str:
    """A time of an entry as a number, or as a date-time."""
    return full(entry.dates.at(time)) if dated and entry.dates else format_number(time)


def _held(entry: Entry) -> str:
    """The resources of an entry in words: "board ×2, grill"."""
    return ", ".join(
        name if amount == 1 else f"{name} ×{amount}"
        for name, amount in sorted(entry.resources.items())
    )


def _left_out_json(what: LeftOut) -> str | dict[str, Any]:
    return what if isinstance(what, str) else {"var": what[0], "value": what[1]}


def _entry_json(entry: Entry, dated: bool) -> dict[str, Any]:
    shown: dict[str, Any] = {
        "id": entry.id,
        "start": json_number(entry.start),
        "end": json_number(entry.end),
    }
    if dated and (dates := entry.dates) is not None:
        shown |= {"start_at": dates.text(entry.start), "end_at": dates.text(entry.end)}
    if entry.occurrence != 1:
        shown["occurrence"] = entry.occurrence
    if entry.mode is not None:
        shown["mode"] = entry.mode
    if entry.resources:
        shown["resources"] = dict(sorted(entry.resources.items()))
    if entry.rank:
        shown["rank"] = entry.rank
    if entry.end_rank is not None and entry.end_rank != entry.rank:
        shown["end_rank"] = entry.end_rank
    if entry.paused:
        shown["paused"] = json_number(entry.paused)
    if entry.status is not None:
        shown["status"] = entry.status
    return shown


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


def dump_json(document: Mapping[str, Any]) -> str:
    """JSON text as the project writes files: a line for each field and for each list entry."""
    fields = [f"  {json.dumps(key)}: {_lines(value)}" for key, value in document.items()]
    return "{\n" + ",\n".join(fields) + "\n}\n"


def _lines(value: Any) -> str:
    encode = json.JSONEncoder(ensure_ascii=False, allow_nan=False).encode
    if not isinstance(value, list) or not value or not isinstance(value[0], dict):
        return encode(value)
    return "[\n" + ",\n".join(f"    {encode(item)}" for item in value) + "\n  ]"
