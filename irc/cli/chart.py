"""The Gantt chart of `irc solve` in text: bars, set-ups, pauses and closed times by resource.

Widths are counted in terminal cells, so that no line is wider than the console.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from heapq import heappop, heappush
from typing import NamedTuple

from rich.cells import cell_len
from rich.text import Text

from irc.cli.axis import Axis, axis_lines, axis_of
from irc.cli.page import Kind, Page, natural
from irc.cli.short_names import ShortNames
from irc.cli.table import LEAST_FLEXIBLE, counted, entry_title, listed_within
from irc.cli.times import ClockText
from irc.model.quantities import Number
from irc.problem import Problem
from irc.problem.objective_values import setups_shown
from irc.schedule import Entry, Schedule

CHART_ROWS = 40
"""A chart with more rows is cut on a terminal; every resource keeps its share of the rows."""

_WIDEST_NAME = 28
"""Cells for a name beside the chart or beside a bar."""

Spans = Sequence[tuple[Number, Number]]
"""Times [start, end) in order, in ticks."""


@dataclass(frozen=True)
class Drawn:
    """The things that a chart shows besides the schedule; times are in ticks.

    `slack` by action, or where that is not known what is `critical`; `closed` times by resource,
    `pauses` by occurrence; `clock` if the axis has dates; `all_rows` if none is left out.
    """

    slack: Mapping[str, int] | None
    critical: Container[tuple[str, int]] | None = None
    closed: Mapping[str, Spans] = field(default_factory=dict)
    pauses: Mapping[tuple[str, int], Spans] = field(default_factory=dict)
    clock: ClockText | None = None
    all_rows: bool = False

    def is_critical(self, entry: Entry) -> bool | None:
        """Whether an occurrence is critical; None where it is not known."""
        if self.slack is not None:
            return self.slack[entry.id] == 0
        return None if self.critical is None else (entry.id, entry.occurrence) in self.critical


class _Bar(NamedTuple):
    """An action in the chart, in ticks; `labels` are its possible labels, the best one first.

    `critical` is None if slack is not known. A set-up of a resource is a bar without labels.
    """

    start: Number
    end: Number
    labels: tuple[str, ...]
    critical: bool | None
    setup: bool = False
    pauses: Spans = ()


_Lanes = list[list[_Bar]]


def chart_lines(page: Page, problem: Problem, schedule: Schedule, shown: Drawn) -> Iterator[Text]:
    """The lines of the chart: rows for each resource, then rows for actions without a resource."""
    held, free = _bars(page, problem, schedule, shown)
    limit = len(schedule.entries) * (len(held) + 1) if shown.all_rows else CHART_ROWS
    bars = [bar for of in (free, *held.values()) for bar in of]
    names = ShortNames(page, (label for bar in bars for label in bar.labels))
    resources = sorted(held, key=natural)
    capacity = {resource.id: resource.greatest_capacity() for resource in problem.resources}
    widest = min(_WIDEST_NAME, page.width // 3)
    titles = [counted(page, name, capacity.get(name, 1)) for name in resources]
    cut = ShortNames(page, titles)
    titles = [cut.fit(title, widest) for title in titles]
    closed = [shown.closed.get(name, ()) for name in resources]
    blocks = [_lanes_by_time(held[name]) for name in resources]
    if free:
        titles.append(page.fit("no resource", widest) if resources else "")
        closed.append(())
    gutter = max(map(cell_len, titles)) + 1 if resources else 0
    span, width = problem.to_ticks(schedule.makespan), page.width - gutter
    axis = axis_of(page, problem, span, width, shown.clock)
    if free:
        rows_left = max(limit - sum(map(len, blocks)), 0)
        blocks.append(_lanes_with_labels(page, free, axis, rows_left))
    shares = _shares([len(lanes) for lanes in blocks], limit)
    yield from axis_lines(page, axis, gutter)
    drawn: list[_Row] = []
    for title, lanes, rows, spans in zip(titles, blocks, shares, closed, strict=True):
        for k, lane in enumerate(lanes[:rows]):
            drawn.append(_Row(page, axis, lane, names, spans))
            name = title if not k else ""
            yield Text.assemble((name + " " * (gutter - cell_len(name)), "bold"), drawn[-1].text())
    hidden = sum(map(len, blocks)) - len(drawn)
    if hidden:
        yield Text(f"{page.glyphs.more} {hidden:,} more rows", "dim italic")
    yield from _legend(page, drawn, known=shown.slack is not None)
    idle = [page.visible(name) for name in sorted(capacity, key=natural) if name not in held]
    if idle:
        yield Text(listed_within(page, "idle: ", idle), "dim")
    yield from _signs_of_names(page, schedule, [capacity.get(name, 1) for name in held])


def _bars(
    page: Page, problem: Problem, schedule: Schedule, shown: Drawn
) -> tuple[dict[str, list[_Bar]], list[_Bar]]:
    """(the bars of each resource, the bars without a resource), both by start."""
    held: dict[str, list[_Bar]] = {}
    free: list[_Bar] = []
    for entry in schedule.entries:
        critical = shown.is_critical(entry)
        title = entry_title(page, entry)
        start, end = problem.to_ticks(entry.start), problem.to_ticks(entry.end)
        pauses = shown.pauses.get((entry.id, entry.occurrence), ())
        bar = _Bar(start, end, (title,), critical, pauses=pauses)
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


def _lanes_with_labels(page: Page, bars: list[_Bar], axis: Axis, rows: int) -> _Lanes:
    """Lanes with room for every label inside or beside its bar, if there are enough rows."""
    if len(bars) > rows * axis.width:
        return _lanes_by_time(bars)
    placed: list[tuple[Number, Number, _Bar]] = []
    for bar in bars:
        cells = axis.cells(bar.start, bar.end)
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

    def __init__(
        self, page: Page, axis: Axis, lane: list[_Bar], names: ShortNames, closed: Spans = ()
    ) -> None:
        self.page, self.axis, self.names = page, axis, names
        self.width = axis.width
        self.shown = [" "] * axis.width
        self.styles = ["dim"] * axis.width
        self.used: set[int] = set()
        for column, _ in axis.labels:
            if column < axis.width:
                self.shown[column] = page.glyphs.grid
        spans = [(bar, axis.cells(bar.start, bar.end)) for bar in lane]
        taken = Counter(cell for _, span in spans for cell in span)
        self.crowds = [cell for cell, bars in taken.items() if bars > 1]
        self.marks: dict[int, str] = {}
        for cell in self._covered(closed):
            self.shown[cell] = self.marks[cell] = page.glyphs.closed
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
        for cell in self._covered(bar.pauses):
            if cell in span and len(span) > 1:
                self._put(cell, self.page.glyphs.pause, kind.style, mark=True)

    def _covered(self, spans: Spans) -> Iterator[int]:
        """The cells whose middle is in one of some times."""
        length = Fraction(self.axis.span, 2 * self.width) if self.axis.span else Fraction(0)
        k = 0
        for cell in range(self.width) if spans and length else ():
            middle = (2 * cell + 1) * length
            while k < len(spans) and spans[k][1] <= middle:
                k += 1
            if k < len(spans) and spans[k][0] <= middle:
                yield cell

    def _kind(self, bar: _Bar) -> Kind:
        if bar.setup:
            return self.page.glyphs.setup
        return self.page.glyphs.critical if bar.critical else self.page.glyphs.slack

    def _label(self, bar: _Bar, span: range) -> None:
        """Writes a label inside the bar, else right or left of it, else cut inside the bar."""
        if bar.setup:
            return
        if not bar.pauses and self._whole_inside(bar, span):
            return
        for label in bar.labels:
            beside = self.names.fit(label, _WIDEST_NAME)
            length = cell_len(beside)
            for first in (span.stop + 1, span.start - length - 1):
                if self._is_free(first, length):
                    self._write(first, beside, "")
                    return
        if len(span) >= LEAST_FLEXIBLE - 1 and not self._whole_inside(bar, span):
            self._inside(bar, span, self.names.fit(bar.labels[-1], len(span) - 2))

    def _whole_inside(self, bar: _Bar, span: range) -> bool:
        """Writes a label inside the bar if it fits there as a whole."""
        for label in bar.labels:
            if _fits_inside(label, span):
                self._inside(bar, span, label)
                return True
        return False

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
            self.marks.pop(cell, None)
        for cell in range(first, end):
            self._put(cell, "", style)
        self.shown[first] = text


def _signs_of_names(page: Page, schedule: Schedule, capacities: list[int]) -> Iterator[Text]:
    """A line on the signs that stand beside names, where there are any."""
    amounts = [amount for entry in schedule.entries for amount in entry.resources.values()]
    signs = (
        (f"{page.glyphs.times}n", "n units", max([*amounts, *capacities], default=1) > 1),
        ("#n", "the n-th time", any(entry.occurrence > 1 for entry in schedule.entries)),
        (page.glyphs.more, "cut short", page.has_cut),
    )
    if shown := [f"{sign} {meaning}" for sign, meaning, used in signs if used]:
        yield Text("   ".join(shown), "dim")


def _legend(page: Page, rows: list[_Row], *, known: bool) -> Iterator[Text]:
    """The lines of the legend: every mark that the rows show, with its meaning.

    `known`: the slack of actions is; without it, critical is what a chain of waits leads on from.
    """
    other = "has slack" if known else "not critical"
    milestone = "milestone" if known else "milestone, not critical"
    seen = {mark for row in rows for mark in row.marks.values()}
    glyphs = page.glyphs
    critical, slack = glyphs.critical, glyphs.slack
    marks = (
        (critical.edge + critical.fill, "critical", critical.style),
        (slack.edge + slack.fill, other, slack.style),
        (critical.short, "critical, short", critical.style),
        (slack.short, f"{other}, short", slack.style),
        (critical.milestone, "critical milestone", critical.style),
        (slack.milestone, milestone, slack.style),
        (glyphs.setup.fill, "set-up", glyphs.setup.style),
        (glyphs.pause, "pause", ""),
        (glyphs.closed, "closed", "dim"),
        (glyphs.crowd, "several actions", ""),
    )
    legend = Text()
    for signs, meaning, style in marks:
        shown = "".join(sign for sign in signs if sign in seen)
        if not shown:
            continue
        seen -= set(shown)
        if legend and cell_len(legend.plain) + len(shown) + len(meaning) + 1 > page.width:
            yield legend
            legend = Text()
        legend.append(shown, style).append(f" {meaning}   ", "dim")
    if legend:
        yield legend
