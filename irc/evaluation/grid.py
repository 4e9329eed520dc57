"""Tables as grids of cells, and grids as text, Markdown, CSV and LaTeX."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum

from irc.evaluation.figure import Figure, Rate, Table, number, walk
from irc.evaluation.statistics import interval

LIST_COLUMNS = {
    "ir_control": ("makespan", "plan"),
    "nl_ir": ("answers", "read", "makespan", "exact"),
    "plan_no_overflow": ("right", "of"),
}
"""The names of the columns of tables whose leaves are lists."""


class Layout(StrEnum):
    """How a report is written."""

    text = "text"
    json = "json"
    csv = "csv"
    latex = "latex"
    markdown = "markdown"


@dataclass(frozen=True)
class Grid:
    """A title, the names of the columns, and rows of cells; the first cells name the row."""

    title: str
    columns: Sequence[str]
    rows: Sequence[Sequence[str]]


def grid_of(name: str, table: Table, *, intervals: bool = True) -> Grid:
    """A table with its last names as columns and those before them as rows."""
    cells: dict[tuple[str, ...], dict[str, str]] = {}
    columns: dict[str, None] = {}
    for path, figure in walk(table):
        *row, column = _named(name, path) or ("value",)
        columns.setdefault(column)
        cells.setdefault(tuple(row), {})[column] = cell(figure, intervals=intervals)
    depth = max((len(row) for row in cells), default=0)
    rows = [
        [*row, *[""] * (depth - len(row)), *(found.get(column, "") for column in columns)]
        for row, found in cells.items()
    ]
    return Grid(name, [*[""] * depth, *columns], rows)


def _named(table: str, path: tuple[str, ...]) -> tuple[str, ...]:
    """The path with names instead of positions in a list."""
    if path and path[-1].isdigit():
        names = LIST_COLUMNS.get(path[-2] if len(path) > 1 else "", LIST_COLUMNS.get(table))
        if names is not None and int(path[-1]) < len(names) and path[-1] in "0123":
            return (*path[:-1], names[int(path[-1])])
    return path


def cell(figure: Figure, *, intervals: bool = True) -> str:
    """A figure as text: "0.96 [0.88, 1.00]"; a count as it is."""
    value = number(figure)
    if not isinstance(figure, Rate):
        return f"{value:g}"
    places = 2 if figure.scale == 1 else 1
    if not intervals:
        return f"{value:.{places}f}"
    low, high = interval(figure)
    return f"{value:.{places}f} [{low:.{places}f}, {high:.{places}f}]"


# --- layouts ------------------------------------------------------------------------------------


def text(grid: Grid) -> str:
    """The grid in aligned columns."""
    lines = [list(grid.columns), *map(list, grid.rows)]
    widths = [max(len(line[k]) for line in lines) for k in range(len(grid.columns))]
    body = ("  ".join(c.ljust(w) for c, w in zip(line, widths, strict=True)) for line in lines)
    return "\n".join([grid.title, *(line.rstrip() for line in body)])


def markdown(grid: Grid) -> str:
    """The grid as a Markdown table under a heading."""
    lines = [grid.columns, ["---"] * len(grid.columns), *grid.rows]
    body = ("| " + " | ".join(c.replace("|", "\\|") for c in line) + " |" for line in lines)
    return "\n".join([f"## {grid.title}", "", *body])


_SPECIAL = re.compile(r"([&%$#_{}])")


def latex(grid: Grid) -> str:
    """The grid as a LaTeX tabular with a caption."""
    lines = [" & ".join(map(_escaped, line)) + r" \\" for line in (grid.columns, *grid.rows)]
    return "\n".join(
        [
            r"\begin{table}",
            rf"\caption{{{_escaped(grid.title)}}}",
            rf"\begin{{tabular}}{{{'l' * len(grid.columns)}}}",
            lines[0],
            r"\hline",
            *lines[1:],
            r"\end{tabular}",
            r"\end{table}",
        ]
    )


def _escaped(words: str) -> str:
    return _SPECIAL.sub(r"\\\1", words)


WRITERS: dict[Layout, Callable[[Grid], str]] = {
    Layout.text: text,
    Layout.markdown: markdown,
    Layout.latex: latex,
}


def csv_text(tables: dict[str, Table]) -> str:
    """All figures in long form, one a line, with their intervals."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(["table", "figure", "value", "low", "high"])
    for name, table in tables.items():
        for path, figure in walk(table):
            low, high = interval(figure) if isinstance(figure, Rate) else ("", "")
            writer.writerow([name, "/".join(_named(name, path)), number(figure), low, high])
    return stream.getvalue()
