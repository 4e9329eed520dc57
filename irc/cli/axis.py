"""The time axis of a chart in text: round numbers of a unit, or hours and days by the clock."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import pairwise
from typing import NamedTuple

from rich.cells import cell_len
from rich.text import Text

from irc.cli.page import UNITS, Page, grouped, seconds_in
from irc.cli.times import ClockText
from irc.model.quantities import Number, exact
from irc.problem import Problem
from irc.reporting.date_marks import date_marks

HUMAN_SPAN = 10_000
"""A longer axis counts in minutes, hours or days, if the unit allows."""


class Axis(NamedTuple):
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

    def cells(self, start: Number, end: Number) -> range:
        """The cells of a bar; at least one, inside the chart."""
        first = min(self.column(start), self.width - 1)
        return range(first, max(self.column(end), first + 1))


_CLOCK_STEPS = {60: (1, 2, 5, 10, 15, 30, 60, 120, 240), 3600: (1, 2, 3, 6, 12, 24, 48, 96)}
"""Round steps of minutes and hours, by the seconds in the unit."""

_LEAST_APART = 8


def axis_of(
    page: Page, problem: Problem, span: Number, width: int, clock: ClockText | None = None
) -> Axis:
    """An axis from 0 to the makespan; its labels stand at round numbers and do not touch.

    With a clock they stand at round hours, or at midnights.
    """
    makespan = exact(Fraction(span * problem.tick))
    if clock is not None:
        return _by_clock(problem, span, makespan, max(width, 1), clock)
    unit, length = _axis_unit(problem.time_unit, makespan)
    bare = Axis(span, max(width, 1), [(0, f"0 {page.visible(unit)}")])
    ticks = length / problem.tick
    for step in _steps(unit, Fraction(makespan) / length) if span else ():
        labels = _labels(bare, ticks, step)
        if _apart(labels):
            return _evened(bare, ticks, step)
    return bare


def _by_clock(
    problem: Problem, span: Number, makespan: Number, width: int, clock: ClockText
) -> Axis:
    axis = Axis(span, width, [(0, clock.text(0).strip())])
    marks = date_marks(clock.dates, 0, makespan, most=max(width // 12, 1)) if span else ()
    for time, text in marks:
        column = axis.column(problem.to_ticks(time))
        last, before = axis.labels[-1]
        if column >= last + cell_len(before) + 2 and column + cell_len(text) <= width:
            axis.labels.append((column, text))
    return axis


def _evened(axis: Axis, ticks: Fraction, step: Number) -> Axis:
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


def _labels(axis: Axis, ticks: Fraction, step: Number) -> list[tuple[int, str]]:
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


def axis_lines(page: Page, axis: Axis, gutter: int) -> Iterator[Text]:
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
