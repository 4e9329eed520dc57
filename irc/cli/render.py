"""The output of `irc solve` for people: a headline, a table of the actions, and a Gantt chart.

Widths are counted in terminal cells, so that no line is wider than the console and the same text
can go into a pipe.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from fractions import Fraction
from heapq import heappop, heappush
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

from rich.cells import cell_len
from rich.console import Console
from rich.text import Text

from irc.cli.absent import in_words, left_out
from irc.cli.page import (
    UNITS,
    Kind,
    Page,
    grouped,
    natural,
    print_lines,
    seconds_in,
    time_in_words,
    with_unit,
)
from irc.cli.table import (
    LEAST_FLEXIBLE,
    Column,
    aligned,
    counted,
    entry_resources,
    entry_title,
    middle_cut,
    rank_text,
    table_lines,
)
from irc.model.quantities import Number, exact
from irc.problem import Problem
from irc.problem.decisions import AnswerError
from irc.problem.objective_values import setups_shown
from irc.retiming.slack import slacks
from irc.schedule import Entry, ObjectiveValue, Schedule, Status

if TYPE_CHECKING:
    from irc.driver.judge import Answer

CHART_ROWS = 40
"""A chart with more rows is cut; every resource keeps its share of the rows."""

HUMAN_SPAN = 10_000
"""A longer axis counts in minutes, hours or days, if the unit allows."""

_WIDEST_NAME = 28
"""Cells for a name beside the chart or beside a bar."""


def print_answer(answer: Answer, console: Console) -> None:
    """Prints an answer for people: the status and objective values, every action, and the chart.

    Lines are at most as wide as the console. Colours appear only on terminals. If the encoding has
    no box and block characters, ASCII characters replace them.
    """
    page = Page(console)
    schedule, problem = answer.schedule, answer.problem
    lines = [*_headline(page, problem, schedule)]
    slack: dict[str, int] | None = None
    try:
        if schedule.answered:
            slack = slacks(problem, schedule)
    except AnswerError as error:
        lines.append(Text(page.visible(f"slack is not known: {error}"), "dim"))
    print_lines(page, console, (line for text in lines for line in text.wrap(console, page.width)))
    if not schedule.entries:
        return
    for block in (_table, _chart):
        console.print()
        print_lines(page, console, block(page, problem, schedule, slack))


# --- headline -----------------------------------------------------------------------------------

_STATUS_STYLES = {
    Status.OPTIMAL: "bold green",
    Status.FEASIBLE: "bold yellow",
    Status.INFEASIBLE: "bold red",
    Status.UNKNOWN: "bold yellow",
    Status.FAILED: "bold red",
}


def _headline(page: Page, problem: Problem, schedule: Schedule) -> Iterator[Text]:
    yield Text.assemble(
        (page.visible(schedule.task or "unnamed task"), "bold"),
        "  ",
        (_status(page, schedule), _STATUS_STYLES[schedule.status]),
    )
    if schedule.entries:
        makespan = ObjectiveValue("makespan", schedule.makespan)
        for value in schedule.objective or (makespan,):
            yield Text(_objective_line(page, problem, schedule, value))
    else:
        yield Text(page.visible(_why_nothing(problem, schedule)))
    absent = left_out(problem, schedule)
    if absent:
        yield Text(in_words(absent, page.visible))
    made = [
        f"{what} {page.visible(name)}"
        for what, name in (("target", schedule.target), ("engine", schedule.engine))
        if name is not None
    ]
    if schedule.seconds is not None:
        made.append(f"{schedule.seconds:.{1 if schedule.seconds >= 10 else 3}f} s")
    if made:
        yield Text(", ".join(made), "dim")


def _status(page: Page, schedule: Schedule) -> str:
    glyphs, status = page.glyphs, schedule.status
    mark = {Status.OPTIMAL: glyphs.good, Status.INFEASIBLE: glyphs.bad}.get(status, "")
    gap = _gap(schedule) if status is Status.FEASIBLE else ""
    ended = ", interrupted" if schedule.interrupted else ""
    return f"{mark} {status}{ended}{gap}".strip()


def _gap(schedule: Schedule) -> str:
    """The gap between the first objective that is not proven optimal and its bound, in words."""
    for value in schedule.objective:
        if value.bound is None:
            return " (no bound known)"
        if value.bound != value.value:
            reached, bound = Fraction(value.value), Fraction(value.bound)
            percent = float(100 * abs(reached - bound) / max(abs(reached), abs(bound)))
            return f" (gap {percent:.1f} %)" if percent >= 0.05 else " (gap below 0.1 %)"
    return ""


def _objective_line(page: Page, problem: Problem, schedule: Schedule, value: ObjectiveValue) -> str:
    if value.name != "makespan":
        bound = "" if value.bound is None else f", bound {grouped(value.bound)}"
        return f"{value.name.replace('_', ' ')} {grouped(value.value)}{bound}"
    makespan = f"makespan {time_in_words(page, value.value, problem.time_unit)}"
    if value.bound is None:
        return makespan
    if value.bound == problem.to_units(problem.bounds.makespan.value):
        reason = page.visible(problem.bounds.makespan.reason)
    else:
        reason = page.visible(f"proved by {schedule.engine or 'the engine'}")
    return f"{makespan}, bound {with_unit(value.bound, problem.time_unit)}: {reason}"


def _why_nothing(problem: Problem, schedule: Schedule) -> str:
    status = schedule.status
    least, unit, reason = (
        problem.bounds.makespan.value,
        problem.time_unit,
        problem.bounds.makespan.reason,
    )
    needed = f"; at least {with_unit(problem.to_units(least), unit)} are needed: {reason}"
    if status is Status.UNKNOWN:
        when = "before it was interrupted" if schedule.interrupted else "within the limits"
        return f"no schedule was found {when}{needed if least else ''}"
    if status is Status.FAILED:
        return "the engine broke down before it had an answer"
    if not problem.activities:
        return "there is nothing to do"
    if status is not Status.INFEASIBLE:
        return "the schedule is empty"
    if problem.deadline is not None and least > problem.deadline:
        deadline = with_unit(problem.to_units(problem.deadline), unit)
        return f"no schedule meets the deadline of {deadline}{needed}"
    return "no schedule keeps all precedences, lags, windows and capacities at once"


# --- table --------------------------------------------------------------------------------------


_MARKED = ("action", "slack")


def _table(
    page: Page, problem: Problem, schedule: Schedule, slack: dict[str, int] | None
) -> Iterator[Text]:
    entries, hidden = middle_cut(schedule.entries)

    def style(k: int, title: str) -> str:
        critical = slack is not None and slack[entries[k].id] == 0
        return "red" if critical and title in _MARKED else ""

    yield from table_lines(page, _columns(page, problem, entries, slack), hidden, style)


def _columns(
    page: Page, problem: Problem, entries: Sequence[Entry], slack: dict[str, int] | None
) -> list[Column]:
    unit = problem.time_unit
    columns = [
        Column("action", [entry_title(page, entry) for entry in entries], flexible=True),
        Column(f"start ({page.visible(unit)})", aligned(e.start for e in entries), True),
        Column("end", aligned(e.end for e in entries), True),
        Column("duration", aligned(exact(Fraction(e.end - e.start)) for e in entries), True),
    ]
    texts: list[tuple[str, Callable[[Entry], str]]] = [
        ("mode", lambda entry: page.visible(entry.mode or "")),
        ("rank", rank_text),
        ("resources", lambda entry: entry_resources(page, entry)),
        ("status", lambda entry: page.visible(entry.status or "")),
    ]
    for title, text in texts:
        cells = [text(entry) for entry in entries]
        if any(cells):
            columns.append(Column(title, cells, flexible=title not in ("status", "rank")))
    if slack is not None:
        free = aligned(problem.to_units(slack[entry.id]) for entry in entries)
        marked = [
            shown if slack[entry.id] else "critical"
            for entry, shown in zip(entries, free, strict=True)
        ]
        columns.append(Column("slack", marked, True))
    return columns


# --- chart --------------------------------------------------------------------------------------


class _Bar(NamedTuple):
    """An action in the chart, in ticks; `labels` are its possible labels, the best one first.

    `critical` is None if slack is not known. A set-up of a resource is a bar without labels.
    """

    start: Number
    end: Number
    labels: tuple[str, ...]
    critical: bool | None
    setup: bool = False


_Lanes = list[list[_Bar]]


def _chart(
    page: Page, problem: Problem, schedule: Schedule, slack: dict[str, int] | None
) -> Iterator[Text]:
    """The lines of the chart: rows for each resource, then rows for actions without a resource."""
    held, free = _bars(page, problem, schedule, slack)
    names = sorted(held, key=natural)
    capacity = {resource.id: resource.greatest_capacity() for resource in problem.resources}
    widest = min(_WIDEST_NAME, page.width // 3)
    titles = [page.fit(counted(page, name, capacity.get(name, 1)), widest) for name in names]
    blocks = [_lanes_by_time(held[name]) for name in names]
    if free:
        titles.append("no resource" if names else "")
    gutter = max(map(cell_len, titles)) + 1 if names else 0
    axis = _axis(page, problem, problem.to_ticks(schedule.makespan), page.width - gutter)
    if free:
        rows_left = CHART_ROWS - sum(map(len, blocks))
        blocks.append(_lanes_with_labels(page, free, axis, rows_left))
    shares = _shares([len(lanes) for lanes in blocks], CHART_ROWS)
    yield from _axis_lines(page, axis, gutter)
    drawn: list[_Row] = []
    for title, lanes, rows in zip(titles, blocks, shares, strict=True):
        for k, lane in enumerate(lanes[:rows]):
            drawn.append(_Row(page, axis, lane))
            name = title if not k else ""
            yield Text.assemble((name + " " * (gutter - cell_len(name)), "bold"), drawn[-1].text())
    hidden = sum(map(len, blocks)) - len(drawn)
    if hidden:
        yield Text(f"{page.glyphs.more} {hidden:,} more rows", "dim italic")
    if legend := _legend(page, drawn):
        yield legend
    idle = [page.visible(name) for name in sorted(capacity, key=natural) if name not in held]
    if idle:
        yield Text(page.fit(f"idle: {', '.join(idle)}", page.width), "dim")


def _bars(
    page: Page, problem: Problem, schedule: Schedule, slack: dict[str, int] | None
) -> tuple[dict[str, list[_Bar]], list[_Bar]]:
    """(the bars of each resource, the bars without a resource), both by start."""
    held: dict[str, list[_Bar]] = {}
    free: list[_Bar] = []
    for entry in schedule.entries:
        critical = None if slack is None else slack[entry.id] == 0
        title = entry_title(page, entry)
        start, end = problem.to_ticks(entry.start), problem.to_ticks(entry.end)
        bar = _Bar(start, end, (title,), critical)
        if not entry.resources or entry.start == entry.end:
            free.append(bar)
            continue
        for name, amount in entry.resources.items():
            counted = f"{title} {page.glyphs.times}{amount}"
            labels = (title,) if amount == 1 else (counted, title)
            held.setdefault(name, []).append(bar._replace(labels=labels))
    for name, bar in _setup_bars(problem, schedule):
        held[name].append(bar)
    for bars in (free, *held.values()):
        bars.sort(key=lambda bar: (bar.start, bar.end))
    return held, free


def _setup_bars(problem: Problem, schedule: Schedule) -> Iterator[tuple[str, _Bar]]:
    """The set-ups of each resource, each right before the use that it is for."""
    if not problem.has_setups:
        return
    for resource, end, time in setups_shown(problem, schedule):
        yield problem.resources[resource].id, _Bar(end - time, end, (), None, setup=True)


def _lanes_by_time(bars: Iterable[_Bar]) -> _Lanes:
    """The fewest lanes on which no bars overlap (interval partitioning)."""
    return _lanes((bar.start, bar.end, bar) for bar in bars)


def _lanes(placed: Iterable[tuple[Number, Number, _Bar]]) -> _Lanes:
    """Lanes on which nothing overlaps, from (first, end, bar) in order; low lanes fill first."""
    lanes: _Lanes = []
    busy: list[tuple[Number, int]] = []
    free: list[int] = []
    for first, end, bar in placed:
        while busy and busy[0][0] <= first:
            heappush(free, heappop(busy)[1])
        if free:
            lane = heappop(free)
        else:
            lane = len(lanes)
            lanes.append([])
        lanes[lane].append(bar)
        heappush(busy, (end, lane))
    return lanes


class _Axis(NamedTuple):
    """A time axis: the ticks that it covers, its width in cells, and the cells with a label."""

    span: Number
    width: int
    labels: list[tuple[int, str]]

    def column(self, time: Number) -> int:
        """The cell whose left edge is nearest to a time, rounded half up."""
        if not self.span:
            return 0
        over = time.numerator * self.span.denominator
        under = time.denominator * self.span.numerator
        return (2 * over * self.width + under) // (2 * under)

    def cells(self, bar: _Bar) -> range:
        """The cells of a bar; at least one, inside the chart."""
        first = min(self.column(bar.start), self.width - 1)
        return range(first, max(self.column(bar.end), first + 1))


def _lanes_with_labels(page: Page, bars: list[_Bar], axis: _Axis, rows: int) -> _Lanes:
    """Lanes with room for every label inside or beside its bar, if there are enough rows."""
    if len(bars) > rows * axis.width:
        return _lanes_by_time(bars)
    placed: list[tuple[Number, Number, _Bar]] = []
    for bar in bars:
        cells = axis.cells(bar)
        beside = cell_len(page.fit(bar.labels[0], _WIDEST_NAME)) + 2
        if _fits_inside(bar.labels[0], cells):
            placed.append((cells.start, cells.stop, bar))
        elif cells.stop + beside - 1 <= axis.width:
            placed.append((cells.start, cells.stop + beside, bar))
        else:
            placed.append((max(0, cells.start - beside), cells.stop, bar))
    placed.sort(key=lambda item: item[:2])
    lanes = _lanes(placed)
    return lanes if len(lanes) <= rows else _lanes_by_time(bars)


def _fits_inside(label: str, cells: range) -> bool:
    """Whether a label fits into a bar behind the edge, which shows the kind of the bar."""
    return cell_len(label) < len(cells)


def _shares(wanted: Sequence[int], limit: int) -> list[int]:
    """The number of rows for each: as many as it wants, or its share of the limit."""
    if sum(wanted) <= limit:
        return list(wanted)
    level = max(most for most in range(limit + 1) if sum(min(w, most) for w in wanted) <= limit)
    shares = [min(w, level) for w in wanted]
    left = limit - sum(shares)
    for k, w in enumerate(wanted):
        if left and w > shares[k]:
            shares[k] += 1
            left -= 1
    return shares


class _Row:
    """A row of the chart: a text and a style for each cell, bars and the labels of bars.

    A cell that several bars share has a mark of its own.
    """

    def __init__(self, page: Page, axis: _Axis, lane: list[_Bar]) -> None:
        self.page = page
        self.width = axis.width
        self.shown = [" "] * axis.width
        self.styles = ["dim"] * axis.width
        self.used: set[int] = set()
        for column, _ in axis.labels:
            if column < axis.width:
                self.shown[column] = page.glyphs.grid
        spans = [(bar, axis.cells(bar)) for bar in lane]
        taken = Counter(cell for _, span in spans for cell in span)
        self.crowds = [cell for cell, bars in taken.items() if bars > 1]
        self.marks: dict[int, str] = {}
        # Critical bars come last, so that a shared cell has their colour.
        for bar, span in sorted(spans, key=lambda item: bool(item[0].critical)):
            self._bar(bar, span)
        for cell in self.crowds:
            self._put(cell, page.glyphs.crowd, self.styles[cell], mark=True)
        for bar, span in spans:
            if len(span) > 1 or taken[span.start] == 1:
                self._label(bar, span)

    def text(self) -> Text:
        """The row as text, with neighbouring cells of one style joined."""
        row = Text()
        start = 0
        for cell in range(1, self.width + 1):
            if cell == self.width or self.styles[cell] != self.styles[start]:
                row.append("".join(self.shown[start:cell]), self.styles[start])
                start = cell
        return row

    def _bar(self, bar: _Bar, span: range) -> None:
        """Draws a bar, or the mark of a milestone."""
        kind = self._kind(bar)
        for cell in span:
            glyph = kind.fill if cell > span.start else kind.edge
            if len(span) == 1:
                glyph = kind.milestone if bar.start == bar.end else kind.short
            self._put(cell, glyph, kind.style, mark=True)

    def _kind(self, bar: _Bar) -> Kind:
        if bar.setup:
            return self.page.glyphs.setup
        return self.page.glyphs.critical if bar.critical else self.page.glyphs.slack

    def _label(self, bar: _Bar, span: range) -> None:
        """Writes a label inside the bar, else right or left of it, else cut inside the bar."""
        if bar.setup:
            return
        for label in bar.labels:
            if _fits_inside(label, span):
                self._inside(bar, span, label)
                return
        for label in bar.labels:
            beside = self.page.fit(label, _WIDEST_NAME)
            length = cell_len(beside)
            for first in (span.stop + 1, span.start - length - 1):
                if self._is_free(first, length):
                    self._write(first, beside, "")
                    return
        if len(span) >= LEAST_FLEXIBLE - 1:
            self._inside(bar, span, self.page.fit(bar.labels[-1], len(span) - 2))

    def _inside(self, bar: _Bar, span: range, label: str) -> None:
        room = len(span) - 1
        padded = f" {label} " if room >= cell_len(label) + 3 else label
        first = span.start + 1 + (room - cell_len(padded)) // 2
        self._write(first, padded, self._kind(bar).label_style)

    def _is_free(self, first: int, length: int) -> bool:
        """Whether a text fits there, inside the chart, with a space on either side."""
        end = first + length
        return first >= 0 and end <= self.width and self.used.isdisjoint(range(first - 1, end + 1))

    def _put(self, cell: int, shown: str, style: str, *, mark: bool = False) -> None:
        self.shown[cell], self.styles[cell] = shown, style
        self.used.add(cell)
        self.marks.pop(cell, None)
        if mark:
            self.marks[cell] = shown

    def _write(self, first: int, text: str, style: str) -> None:
        """Writes a text into its first cell; its other cells become empty."""
        end = first + cell_len(text)
        for cell in {first - 1, end} & set(range(self.width)) - self.used:
            self.shown[cell] = " "
        for cell in range(first, end):
            self._put(cell, "", style)
        self.shown[first] = text


def _legend(page: Page, rows: list[_Row]) -> Text:
    """The legend: every mark that the rows show, with its meaning."""
    seen = {mark for row in rows for mark in row.marks.values()}
    critical, slack = page.glyphs.critical, page.glyphs.slack
    marks = (
        (critical.edge + critical.fill, "critical", critical.style),
        (slack.edge + slack.fill, "has slack", slack.style),
        (critical.short, "critical, short", critical.style),
        (slack.short, "has slack, short", slack.style),
        (critical.milestone, "critical milestone", critical.style),
        (slack.milestone, "milestone", slack.style),
        (page.glyphs.setup.fill, "set-up", page.glyphs.setup.style),
        (page.glyphs.crowd, "several actions", ""),
    )
    legend = Text()
    for glyphs, meaning, style in marks:
        if shown := "".join(glyph for glyph in glyphs if glyph in seen):
            legend.append(shown, style).append(f" {meaning}   ", "dim")
            seen -= set(shown)
    return legend


# --- time axis ----------------------------------------------------------------------------------

_CLOCK_STEPS = {60: (1, 2, 5, 10, 15, 30, 60, 120, 240), 3600: (1, 2, 3, 6, 12, 24, 48, 96)}
"""Round steps of minutes and hours, by the seconds in the unit."""

_LEAST_APART = 8


def _axis(page: Page, problem: Problem, span: Number, width: int) -> _Axis:
    """An axis from 0 to the makespan; its labels stand at round numbers and do not touch."""
    makespan = exact(Fraction(span * problem.tick))
    unit, length = _axis_unit(problem.time_unit, makespan)
    bare = _Axis(span, max(width, 1), [(0, f"0 {page.visible(unit)}")])
    ticks = length / problem.tick
    for step in _steps(unit, Fraction(makespan) / length) if span else ():
        labels = _labels(bare, ticks, step)
        if _apart(labels):
            return _evened(bare, ticks, step)
    return bare


def _evened(axis: _Axis, ticks: Fraction, step: Number) -> _Axis:
    """The axis with labels, a little narrower if this makes their distances equal."""
    share = step * ticks / axis.span
    whole = axis.width - axis.width % share.denominator
    if whole > axis.width * 0.85:
        axis = axis._replace(width=whole)
    return axis._replace(labels=_labels(axis, ticks, step))


def _axis_unit(unit: str, span: Number) -> tuple[str, Number]:
    """(the unit of the axis, its length in the task's units)."""
    seconds = seconds_in(unit)
    if seconds is not None and span >= HUMAN_SPAN:
        for name, length in UNITS:
            if length > seconds and span * seconds >= 5 * length:
                return name, exact(length / seconds)
    return unit, 1


def _steps(unit: str, span: Fraction) -> Iterator[Number]:
    """Possible distances between labels: increasing round numbers, up to beyond the span."""
    scale = Fraction(1)
    while 1000 * scale < span:
        scale *= 10
    while 100 * scale > span:
        scale /= 10
    steps = {digit * scale * 10**power for digit in (1, 2, 5) for power in range(4)}
    seconds = seconds_in(unit)
    if seconds in _CLOCK_STEPS:
        clock = _CLOCK_STEPS[int(seconds)]
        steps = {s for s in steps if s < clock[0] or s > clock[-1]} | set(map(Fraction, clock))
    yield from map(exact, sorted(steps))


def _labels(axis: _Axis, ticks: Fraction, step: Number) -> list[tuple[int, str]]:
    """The cell and the text of each label, `step` units of `ticks` apart; empty if too many."""
    number = int(axis.span // (step * ticks)) + 1
    if number > axis.width:
        return []
    texts = (grouped(exact(Fraction(k * step))) for k in range(1, number))
    columns = (axis.column(k * step * ticks) for k in range(1, number))
    return [*axis.labels[:1], *zip(columns, texts, strict=True)]


def _apart(labels: list[tuple[int, str]]) -> bool:
    return bool(labels) and all(
        right - left >= max(cell_len(text) + 3, _LEAST_APART)
        for (left, text), (right, _) in pairwise(labels)
    )


def _axis_lines(page: Page, axis: _Axis, gutter: int) -> Iterator[Text]:
    """The line of labels, each beginning at its place, and the line of their marks.

    A last label that is too wide moves to the left or is left out.
    """
    shown, line = "", [page.glyphs.rule] * axis.width
    for column, text in axis.labels:
        first = min(column, axis.width - cell_len(text))
        if not shown or first > cell_len(shown):
            shown += " " * (first - cell_len(shown)) + text
        if column < axis.width:
            line[column] = page.glyphs.tick if column else page.glyphs.first_tick
    for drawn in (shown, "".join(line)):
        yield Text(" " * gutter + drawn, "dim")
