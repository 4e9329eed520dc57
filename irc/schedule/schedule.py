"""Schedules: the time, mode and resources of each occurrence, in exact numbers."""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Any

from irc.diagnostics import Diagnostic, did_you_mean
from irc.display.views import view
from irc.errors import NameNotFound, OptionError
from irc.model.dates import Dates, full
from irc.model.quantities import Number
from irc.model.times import format_number
from irc.outcome import INTERRUPTED, Outcome
from irc.schedule.entry import Entry, LeftOut
from irc.schedule.writing import document

if TYPE_CHECKING:
    from irc.display.svg import Bar
    from irc.model.task import Task


class Status(StrEnum):
    """The result of solving. `optimal` and `infeasible` always have a proof."""

    OPTIMAL = "optimal"
    FEASIBLE = "feasible"
    INFEASIBLE = "infeasible"
    UNKNOWN = "unknown"
    FAILED = "failed"


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
    done, so that a better answer may be close, or any. `repeatable`: whether the same deterministic
    call gives the same answer again; None where it was not a deterministic one.
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
    repeatable: bool | None = None
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
        from irc.schedule.reading import schedule_from_json

        return schedule_from_json(document)

    def to_dict(self) -> dict[str, Any]:
        """The document that `irc solve --format json` writes."""
        return document(self)


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
