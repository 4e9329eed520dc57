"""The text of a step for people: its events, what has run, and the changes of the plan."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from io import StringIO
from typing import TYPE_CHECKING

from rich.console import Console
from rich.text import Text

from irc.cli.page import PIPED_WIDTH, Page, grouped, print_lines, time_in_words, with_unit
from irc.cli.table import (
    Column,
    entry_resources,
    entry_title,
    middle_cut,
    rank_text,
    table_lines,
    time_columns,
)
from irc.cli.times import ClockText, TimesStyle, dates_of
from irc.events.wording import changes_in_words, listed
from irc.model.quantities import Number
from irc.model.state_values import value_text
from irc.schedule import BEGUN, Entry, Schedule, Status

if TYPE_CHECKING:
    from irc.execution.simulation import Simulation
    from irc.execution.step import Step

_STYLES = {
    Status.OPTIMAL: "bold green",
    Status.FEASIBLE: "bold yellow",
    Status.INFEASIBLE: "bold red",
    Status.UNKNOWN: "bold yellow",
    Status.FAILED: "bold red",
}
_NOTE_STYLES = {"done": "dim", "running": "bold", "new": "green"}

_Key = tuple[str, int]


def clock_of_step(
    step: Step, times: TimesStyle | None, before: Schedule | None = None
) -> ClockText | None:
    """The way in which the times of a step and the plan before it are written; None: as numbers."""
    entries = [*step.schedule.entries, *(() if before is None else before.entries)]
    shown = [0, step.at, *(time for e in entries for time in (e.start, e.end))]
    dates = dates_of(step.task, times, [min(shown), max(shown)])
    return None if dates is None else ClockText(dates, shown)


def print_step(
    step: Step, before: Schedule | None, console: Console, clock: ClockText | None = None
) -> None:
    """Prints the events of a step and the changes of the plan; `before` is the previous plan."""
    page = Page(console)
    unit = step.task.time_unit
    _print_wrapped(page, console, _heading(page, step, unit, clock))
    if not step.schedule.answered:
        return
    if before is not None:
        _print_wrapped(page, console, _movements(page, step, before, clock))
    values = _objective_values(page, step.schedule, unit)
    _print_wrapped(page, console, [values, *_left_out(page, step)])


def print_history(
    step: Step,
    before: Schedule | None,
    console: Console,
    clock: ClockText | None = None,
    *,
    all_rows: bool = False,
) -> None:
    """Prints the table of a step's schedule, with a note on what is done, running or moved."""
    if not step.schedule.entries:
        return
    page = Page(console)
    entries, hidden = middle_cut(step.schedule.entries, all_rows=all_rows)
    notes = [_note(entry, step, before, clock) for entry in entries]

    def style(k: int, title: str) -> str:
        return _NOTE_STYLES.get(notes[k], "") if title in ("action", "note") else ""

    columns = _columns(page, entries, step.task.time_unit, notes, clock)
    console.print()
    print_lines(page, console, table_lines(page, columns, hidden, style))
    _print_wrapped(page, console, [Text(line) for line in page.key()])


def step_as_text(step: Step, before: Schedule | None, times: TimesStyle | None) -> str:
    """The text of a step and its whole schedule, with all rows, as in a file."""
    file = StringIO()
    console = Console(file=file, width=PIPED_WIDTH)
    clock = clock_of_step(step, times, before)
    print_step(step, before, console, clock)
    print_history(step, before, console, clock, all_rows=True)
    return file.getvalue()


def print_end(
    simulation: Simulation,
    last: Step,
    console: Console,
    clock: ClockText | None = None,
    *,
    all_rows: bool = False,
) -> None:
    """Prints the table of the whole history and its objective values."""
    page, unit = Page(console), last.task.time_unit
    if last is not simulation.steps[-1]:
        console.print()
        when = _when(page, last.at, unit, clock)
        _print_wrapped(page, console, [Text(f"the last plan, as of {when}:", "bold")])
    whole = replace(last, completed=(), running=())
    print_history(whole, None, console, clock, all_rows=all_rows)
    steps = len(simulation.steps)
    counts = f"{steps:,} step{'s' if steps != 1 else ''}, moved {simulation.moved:,} in total"
    console.print()
    values = _objective_values(page, last.schedule, unit)
    _print_wrapped(page, console, [Text(counts), values])
    _print_wrapped(page, console, _left_out(page, last))


def _print_wrapped(page: Page, console: Console, texts: Iterator[Text] | list[Text]) -> None:
    lines = (line for text in texts for line in text.wrap(console, page.width))
    print_lines(page, console, lines)


def _when(page: Page, time: Number, unit: str, clock: ClockText | None) -> str:
    """A time in words: by the clock, or with its unit."""
    return time_in_words(page, time, unit) if clock is None else clock.text(time).strip()


def _heading(page: Page, step: Step, unit: str, clock: ClockText | None) -> Iterator[Text]:
    names = [page.visible(event.id) for event in step.events if event.id is not None]
    what = ", ".join(names) or ("an event" if step.events else "the plan")
    yield Text.assemble(
        (f"at {_when(page, step.at, unit, clock)}: {what}", "bold"),
        "  ",
        (str(step.schedule.status), _STYLES[step.schedule.status]),
        ", interrupted" if step.schedule.interrupted else "",
    )
    for event in step.events:
        for line in changes_in_words(event, step.task):
            yield Text(f"  {page.visible(line)}")
    for title, ids in (
        ("done", [name for name in step.completed if name not in step.stopped]),
        ("stopped", step.stopped),
        ("running", step.running),
    ):
        if ids:
            yield Text(f"{title} {len(ids):,}: {listed(map(page.visible, ids))}")
    if step.abandoned:
        yield Text(f"abandoned: {listed(map(page.visible, step.abandoned))}", "yellow")
    if step.schedule.status is Status.INFEASIBLE and not step.at and not step.events:
        yield Text("no schedule exists, even without events: `irc explain` shows why", "red")
    elif step.schedule.status is Status.INFEASIBLE:
        yield Text("no schedule continues the history; keeping the previous plan", "red")
    elif not step.schedule.answered:
        when = "before it was interrupted" if step.schedule.interrupted else "within the limits"
        yield Text(f"no schedule was found {when}", "yellow")


def _movements(page: Page, step: Step, before: Schedule, clock: ClockText | None) -> Iterator[Text]:
    """The lines on what moved, and on what is new or no longer planned."""
    old = {_key(entry): entry for entry in before.entries}
    now = {_key(entry): entry for entry in step.schedule.entries}
    moved = [
        f"{entry_title(page, entry)} {_difference(page, old[key], entry, clock)}"
        for key, entry in now.items()
        if key in old and _difference(page, old[key], entry, clock) and not _is_frozen(entry, step)
    ]
    added = [entry_title(page, entry) for key, entry in now.items() if key not in old]
    gone = [entry_title(page, entry) for key, entry in old.items() if key not in now]
    ends = [
        f"{entry_title(page, entry)} {_change(page, old[key].end, entry.end, clock)}"
        for key, entry in now.items()
        if key in old and old[key].start == entry.start and old[key].end != entry.end
    ]
    if step.events or step.moved:
        names = f": {listed(moved)}" if moved else ""
        yield Text(f"moved {step.moved:,}{names}")
    if ends:
        yield Text(f"other ends: {listed(ends)}")
    if added:
        yield Text(f"new in the plan: {listed(added)}")
    if gone:
        yield Text(f"no longer planned: {listed(gone)}")


def _difference(page: Page, old: Entry, new: Entry, clock: ClockText | None) -> str:
    """The differences of an entry from the previous plan: "10 → 14", "on robot2"; else empty."""
    changes = []
    if old.start != new.start:
        changes.append(_change(page, old.start, new.start, clock))
    if old.resources != new.resources and new.resources:
        changes.append(f"on {entry_resources(page, new)}")
    if old.mode != new.mode and new.mode is not None:
        changes.append(f"as {page.visible(new.mode)}")
    return ", ".join(changes)


def _change(page: Page, old: Number, new: Number, clock: ClockText | None) -> str:
    return f"{_time(old, clock)} {page.glyphs.arrow} {_time(new, clock)}"


def _time(time: Number, clock: ClockText | None) -> str:
    return grouped(time) if clock is None else clock.text(time).strip()


def _objective_values(page: Page, schedule: Schedule, unit: str) -> Text:
    values = [f"makespan {time_in_words(page, schedule.makespan, unit)}"]
    for value in schedule.objective:
        if value.name == "makespan":
            continue
        shown = grouped(value.value)
        values.append(
            f"{value.name} {with_unit(value.value, unit) if _is_time(value.name) else shown}"
        )
    return Text(", ".join(values))


def _left_out(page: Page, step: Step) -> Iterator[Text]:
    """The lines on what is not there: optional groups, and what cannot go on."""
    present = {entry.id for entry in step.schedule.entries}
    groups = [g for g in step.task.groups if not g.required and present.isdisjoint(g.actions)]
    if groups:
        yield Text(f"left out: {listed(page.visible(group.id) for group in groups)}")
    if step.left_out:
        names = (
            what if isinstance(what, str) else f"{what[0]} = {value_text(what[1])}"
            for what in step.left_out
        )
        yield Text(f"cannot go on: {listed(map(page.visible, names))}", "red")


def _is_time(objective: str) -> bool:
    return objective == "tardiness"


def _is_frozen(entry: Entry, step: Step) -> bool:
    """Whether an occurrence had begun by the step, so that the step did not move it."""
    if entry.id in step.completed:
        return entry.end <= step.at
    return entry.id in step.running and entry.start <= step.at


def _key(entry: Entry) -> _Key:
    return entry.id, entry.occurrence


def _note(entry: Entry, step: Step, before: Schedule | None, clock: ClockText | None) -> str:
    """The note on an entry: its status, whether it has run, or its previous place."""
    if entry.status is not None and entry.status != BEGUN:
        return entry.status
    if _is_frozen(entry, step):
        return "done" if entry.end <= step.at else "running"
    if before is None:
        return ""
    old = {_key(e): e for e in before.entries}.get(_key(entry))
    return "new" if old is None else _was(old, entry, clock)


def _was(old: Entry, new: Entry, clock: ClockText | None) -> str:
    if old.start != new.start:
        return f"was {_time(old.start, clock)}"
    if old.resources != new.resources:
        return f"was on {', '.join(sorted(old.resources)) or 'nothing'}"
    return "" if old.mode == new.mode else f"was {old.mode}"


def _columns(
    page: Page,
    entries: Sequence[Entry],
    unit: str,
    notes: list[str],
    clock: ClockText | None,
) -> list[Column]:
    columns = [
        Column("action", [entry_title(page, entry) for entry in entries], flexible=True),
        *time_columns(page, unit, entries, clock),
    ]
    columns = [column for column in columns if not column.title.startswith("duration")]
    optional: Mapping[str, list[str]] = {
        "mode": [page.visible(entry.mode or "") for entry in entries],
        "rank": [rank_text(entry) for entry in entries],
        "resources": [entry_resources(page, entry) for entry in entries],
        "note": [page.visible(note) for note in notes],
    }
    columns += [
        Column(title, cells, flexible=title != "rank")
        for title, cells in optional.items()
        if any(cells)
    ]
    return columns
