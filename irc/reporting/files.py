"""The files that a schedule is written to: one table of their endings, and what each needs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from irc.diagnostics import did_you_mean
from irc.driver.files import require_file, write_whole
from irc.errors import LibraryMissing, OptionError
from irc.model import Task
from irc.schedule import Schedule
from irc.schedule.writing import schedule_text

if TYPE_CHECKING:
    from irc.execution.step import Step
    from irc.reporting.analysis import Analysis

HTML_REPORT = "irc.reporting.html"
"""The module with `report_html(task, schedule, previous, steps)`."""


@dataclass(frozen=True)
class Shown:
    """The contents of a file: a schedule of a task; the plan before it, and the steps to it.

    `text` makes the text for people, where the command line offers it.
    """

    task: Task
    schedule: Schedule
    previous: Schedule | None = None
    steps: Sequence[Step] | None = None
    text: Callable[[], str] | None = None


Writer = Callable[[Shown], str | bytes]


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of files: its writer, and what it needs.

    `libraries` are importable names that the `extra` brings. `is_picture`: it has a limit on the
    number of actions; `has_dates`: it needs a task with an origin.
    """

    ending: str
    what: str
    write: Writer
    libraries: tuple[str, ...] = ()
    extra: str = ""
    is_picture: bool = False
    has_dates: bool = False


def _json(shown: Shown) -> str:
    return schedule_text(shown.schedule)


def _text(shown: Shown) -> str:
    return str(shown.schedule) + "\n" if shown.text is None else shown.text()


def _html(shown: Shown) -> str:
    module = import_module(HTML_REPORT)
    page: str = module.report_html(shown.task, shown.schedule, shown.previous, shown.steps)
    return page


def _analysis(shown: Shown) -> Analysis:
    """The analysis of a schedule; most commands write none of the files that need it."""
    from irc.reporting.analysis import analyse

    return analyse(shown.task, shown.schedule)


def _picture(kind: str, shown: Shown) -> bytes:
    from irc.reporting.charts import picture
    from irc.reporting.gantt import gantt

    return picture(gantt(_analysis(shown)), kind)


def _workbook(shown: Shown) -> bytes:
    from irc.frontends.tables.files import workbook_bytes
    from irc.reporting.sheets import workbook_sheets

    return workbook_bytes(workbook_sheets(_analysis(shown)))


def _csv(shown: Shown) -> str:
    from irc.frontends.tables.files import csv_text
    from irc.reporting.sheets import plan_sheet

    return csv_text(plan_sheet(_analysis(shown)))


def _markdown(shown: Shown) -> str:
    from irc.reporting.sheets import markdown

    return markdown(_analysis(shown))


def _calendar(shown: Shown) -> str:
    from irc.frontends.formats import load_plan_exporter

    return load_plan_exporter("icalendar")(shown.task, shown.schedule, False)


_KINDS = (
    Kind(".json", "the schedule, for programs", _json),
    Kind(".html", "a report to look at in a browser", _html),
    *(
        Kind(f".{kind}", "a Gantt chart", partial(_picture, kind), ("vl_convert",), "plot", True)
        for kind in ("svg", "png", "pdf")
    ),
    Kind(".xlsx", "tables, a sheet each", _workbook, ("openpyxl",), "files"),
    Kind(".csv", "the table of the actions", _csv),
    Kind(".ics", "a calendar", _calendar, ("icalendar",), "files", has_dates=True),
    Kind(".md", "tables as text", _markdown),
    Kind(".txt", "the text for people", _text),
)

KINDS: Mapping[str, Kind] = {kind.ending: kind for kind in _KINDS}
"""The kinds of files by their endings."""


def kind_of(path: Path) -> Kind:
    """The kind of a file by the ending of its name; JSON where it has none.

    Raises `OptionError` for an unknown ending, and `LibraryMissing` where an extra is missing.
    """
    ending = path.suffix.lower() or ".json"
    found = KINDS.get(ending)
    if found is None:
        known = ", ".join(KINDS)
        hint = did_you_mean(ending, list(KINDS))
        raise OptionError(
            f"cannot write {str(path)!r}: {hint or 'its name must end in one of ' + known}"
        )
    if found.ending == ".html" and find_spec(HTML_REPORT) is None:
        raise OptionError(f"cannot write {str(path)!r}: this version has no reports as HTML")
    for library in found.libraries:
        if find_spec(library) is None:
            raise LibraryMissing(
                f"a file {found.ending} needs more: pip install 'irc-compiler[{found.extra}]'"
            )
    return found


def require_output(path: Path | None) -> None:
    """Raises where a file could not be written: before the work, not after.

    `OptionError` for an unknown ending, `LibraryMissing` for a missing extra, `WriteError` for a
    folder into which nothing may be written.
    """
    if path is not None:
        kind_of(path)
        require_file(path, tuple(KINDS))


def require_fit(path: Path | None, task: Task) -> None:
    """Raises `OptionError` where a task cannot be shown in a file: also before the work."""
    if path is None:
        return
    kind = kind_of(path)
    if kind.has_dates and task.origin is None:
        raise OptionError(
            f"cannot write {str(path)!r}: it needs dates, and the task has no 'origin'; write the "
            'date-time of t = 0, such as "origin": "2026-03-02T08:00:00+01:00"'
        )
    if kind.is_picture:
        from irc.reporting.gantt import require_size

        least = sum(action.occurrence_bounds[0] for action in task.actions)
        optional = {name for g in task.groups if not g.required for name in g.actions}
        require_size(least - len(optional))


def write_shown(path: Path, shown: Shown) -> None:
    """Writes a file; it appears whole or not at all. Raises what `require_output` raises."""
    write_whole(path, kind_of(path).write(shown))


def save(task: Task, schedule: Schedule, path: str | Path) -> None:
    """Writes a schedule to a file of the kind that its ending names."""
    require_output(Path(path))
    require_fit(Path(path), task)
    write_shown(Path(path), Shown(task, schedule))
