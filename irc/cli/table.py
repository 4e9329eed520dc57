"""A table in text, in which no line is wider than the console, and the cells of an entry."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import NamedTuple

from rich.cells import cell_len
from rich.text import Text

from irc.cli.page import Page, grouped, natural
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

_FIRST_TO_GO = ("status", "resources", "rank", "mode", "duration")
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


def aligned(values: Iterable[Number]) -> list[str]:
    """The texts of numbers, padded so that their points are under each other."""
    parts = [grouped(value).partition(".") for value in values]
    places = max((len(point + digits) for _, point, digits in parts), default=0)
    return [whole + (point + digits).ljust(places) for whole, point, digits in parts]


def middle_cut(entries: Sequence[Entry]) -> tuple[Sequence[Entry], int]:
    """(the entries that a table shows, the number of entries that it leaves out in the middle)."""
    if len(entries) <= TABLE_ROWS:
        return entries, 0
    half = TABLE_ROWS // 2
    return (*entries[:half], *entries[-half:]), len(entries) - 2 * half


def table_lines(
    page: Page, columns: list[Column], hidden: int, style: Callable[[int, str], str]
) -> Iterator[Text]:
    """The lines of a table; `style(k, title)` is the style of row k in the column with a title.

    If `hidden` rows were cut out of the middle, a line says so.
    """
    columns = _fitting(page, columns)
    widths = _widths(page, columns)
    yield Text(_GAP.join(_padded(page, [c.title for c in columns], columns, widths)), "bold")
    yield Text(_GAP.join(page.glyphs.rule * width for width in widths), "dim")
    rows = len(columns[0].cells)
    for k in range(rows):
        if hidden and k == rows // 2:
            more = f"{page.glyphs.more} {hidden:,} more rows (use -o or --format json for all)"
            yield Text(more, "dim italic")
        cells = _padded(page, [column.cells[k] for column in columns], columns, widths)
        yield Text(_GAP).join(
            Text(cell, style(k, column.title)) for cell, column in zip(cells, columns, strict=True)
        )


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
        columns = [column for column in columns if column.title != title]
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


def _padded(page: Page, cells: list[str], columns: list[Column], widths: list[int]) -> list[str]:
    padded = []
    for cell, column, width in zip(cells, columns, widths, strict=True):
        text = page.fit(cell, width)
        padding = " " * (width - cell_len(text))
        padded.append(padding + text if column.to_the_right else text + padding)
    return padded
