"""A table in text, in which no line is wider than the console, and the cells of an entry."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import NamedTuple

from rich.cells import cell_len
from rich.text import Text

from irc.cli.page import Page, grouped, natural
from irc.cli.short_names import ShortNames
from irc.cli.times import DAYS_BY_NAME, ClockText
from irc.model.quantities import Number
from irc.schedule import Entry


class Column(NamedTuple):
    """A title and a cell for each row; flexible columns get narrower on a narrow console."""

    title: str
    cells: list[str]
    to_the_right: bool = False
    flexible: bool = False


TABLE_ROWS = 60
"""A longer table is cut in the middle."""

LEAST_FLEXIBLE = 8
"""The least width of a flexible column, in cells."""

_FIRST_TO_GO = ("day", "status", "resources", "rank", "mode", "duration", "slack")
_GAP = "  "


def entry_title(page: Page, entry: Entry) -> str:
    """The name of an occurrence: "stir", "stir #2"."""
    name = page.visible(entry.id)
    return name if entry.occurrence == 1 else f"{name} #{entry.occurrence}"


def rank_text(entry: Entry) -> str:
    """The ranks of an entry: "1"; "0, 1" if the end has another rank than the start."""
    if entry.end_rank is None or entry.end_rank == entry.rank:
        return str(entry.rank) if entry.rank else ""
    return f"{entry.rank}, {entry.end_rank}"


def entry_resources(page: Page, entry: Entry) -> str:
    """The resources that an entry holds, with amounts."""
    held = sorted(entry.resources.items(), key=lambda item: natural(item[0]))
    return ", ".join(counted(page, name, amount) for name, amount in held)


def counted(page: Page, name: str, amount: int) -> str:
    """A resource with its amount, if that is not 1."""
    shown = page.visible(name)
    return shown if amount == 1 else f"{shown} {page.glyphs.times}{amount}"


def time_columns(
    page: Page, unit: str, entries: Sequence[Entry], clock: ClockText | None
) -> Iterator[Column]:
    """The columns of start, end and duration; by the clock, with the day of a long schedule."""
    shown, lengths = page.visible(unit), aligned(entry.duration for entry in entries)
    if clock is None:
        yield Column(f"start ({shown})", aligned(e.start for e in entries), True)
        yield Column("end", aligned(e.end for e in entries), True)
        yield Column("duration", lengths, True)
        return
    if clock.days > DAYS_BY_NAME:
        yield Column("day", [f"{clock.day_number(e.start):,}" for e in entries], True)
    yield Column("start", [clock.text(e.start) for e in entries])
    yield Column("end", [clock.text(e.end) for e in entries])
    yield Column(f"duration ({shown})", lengths, True)


def listed_within(page: Page, before: str, names: Sequence[str]) -> str:
    """A list of names on one line; the last ones are counted where there is no room for them."""
    shown = before
    for k, name in enumerate(names):
        comma = ", " if k else ""
        rest = len(names) - k - 1
        more = f" and {rest:,} more" if rest else ""
        if k and cell_len(shown + comma + name + more) > page.width:
            return f"{shown} and {rest + 1:,} more"
        shown += comma + name
    return page.fit(shown, page.width)


def aligned(values: Iterable[Number]) -> list[str]:
    """The texts of numbers, padded so that their points are under each other."""
    parts = [grouped(value).partition(".") for value in values]
    places = max((len(point + digits) for _, point, digits in parts), default=0)
    return [whole + (point + digits).ljust(places) for whole, point, digits in parts]


def middle_cut(entries: Sequence[Entry], *, all_rows: bool = False) -> tuple[Sequence[Entry], int]:
    """(the entries that a table shows, the number of entries that it leaves out in the middle)."""
    if all_rows or len(entries) <= TABLE_ROWS:
        return entries, 0
    half = TABLE_ROWS // 2
    return (*entries[:half], *entries[-half:]), len(entries) - 2 * half


def table_lines(
    page: Page, columns: list[Column], hidden: int, style: Callable[[int, str], str]
) -> Iterator[Text]:
    """The lines of a table; `style(k, title)` is the style of row k in the column with a title.

    If `hidden` rows were cut out of the middle, a line says so.
    """
    wanted = [column.title for column in columns]
    columns = _fitting(page, columns)
    names = [ShortNames(page, column.cells) for column in columns]
    widths = _widths(page, columns)
    yield Text(_GAP.join(_titles(page, columns, widths)), "bold")
    yield Text(_GAP.join(page.glyphs.rule * width for width in widths), "dim")
    rows = len(columns[0].cells)
    for k in range(rows):
        if hidden and k == rows // 2:
            more = f"{page.glyphs.more} {hidden:,} more rows (use -o or --format json for all)"
            yield Text(more, "dim italic")
        cells = [
            _padded(short.fit(column.cells[k], width), width, column.to_the_right)
            for column, width, short in zip(columns, widths, names, strict=True)
        ]
        yield _styled(cells, [style(k, column.title) for column in columns])
    missing = [title for title in wanted if title not in {column.title for column in columns}]
    if missing:
        yield Text(f"no room for: {', '.join(missing)}", "dim italic")


def _styled(cells: Sequence[str], styles: Sequence[str]) -> Text:
    """A line of cells, each in its style ("": plain)."""
    line, at = Text(_GAP.join(cells)), 0
    for cell, style in zip(cells, styles, strict=True):
        if style:
            line.stylize(style, at, at + len(cell))
        at += len(cell) + len(_GAP)
    return line


def _natural_width(column: Column) -> int:
    return max(map(cell_len, (column.title, *column.cells)))


def _fitting(page: Page, columns: list[Column]) -> list[Column]:
    """The columns without those for which a narrow console has no room."""
    for title in _FIRST_TO_GO:
        least = [
            min(_natural_width(column), LEAST_FLEXIBLE)
            if column.flexible
            else _natural_width(column)
            for column in columns
        ]
        if sum(least) + len(_GAP) * (len(least) - 1) <= page.width:
            return columns
        columns = [column for column in columns if column.title.partition(" (")[0] != title]
    return columns


def _widths(page: Page, columns: list[Column]) -> list[int]:
    """The widths of columns: those of their contents; the widest flexible ones shrink if needed."""
    widths = [_natural_width(column) for column in columns]
    flexible = [k for k, column in enumerate(columns) if column.flexible]
    spare = page.width - sum(widths) - len(_GAP) * (len(widths) - 1)
    while spare < 0:
        widest = max(flexible, key=widths.__getitem__)
        if widths[widest] <= LEAST_FLEXIBLE:
            break
        widths[widest] -= 1
        spare += 1
    return widths


def _titles(page: Page, columns: list[Column], widths: list[int]) -> list[str]:
    return [
        _padded(page.fit(column.title, width), width, column.to_the_right)
        for column, width in zip(columns, widths, strict=True)
    ]


def _padded(text: str, width: int, to_the_right: bool) -> str:
    padding = " " * (width - cell_len(text))
    return padding + text if to_the_right else text + padding
