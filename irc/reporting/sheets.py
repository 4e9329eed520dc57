"""Tables as sheets of a workbook, as CSV and as Markdown."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from datetime import date, datetime
from fractions import Fraction
from typing import Any

from irc.frontends.tables.cells import Sheet, Value
from irc.model.quantities import Number
from irc.model.times import format_number
from irc.reporting.analysis import Analysis
from irc.reporting.names import plain
from irc.reporting.tables import Table, action_table, as_float, summary_rows, tables_of


def workbook_sheets(analysis: Analysis) -> list[Sheet]:
    """A sheet with a summary, then one for each table; dates are real, numbers are floats."""
    summary = [[name, _cell(value)] for name, value in summary_rows(analysis)]
    sheets = [Sheet("summary", [["field", "value"], *summary])]
    return sheets + [_sheet(table.without_empty(), analysis) for table in tables_of(analysis)]


def plan_sheet(analysis: Analysis) -> Sheet:
    """The sheet of the actions, with exact numbers."""
    table = action_table(analysis).without_empty()
    rows = [[_exact_cell(row[name]) for name in table.columns] for row in table.rows]
    return Sheet(table.name, [table.headings(analysis.time_unit), *rows])


def _sheet(table: Table, analysis: Analysis) -> Sheet:
    rows = [[_cell(row[name]) for name in table.columns] for row in table.rows]
    return Sheet(table.name, [table.headings(analysis.time_unit), *rows])


def _cell(value: Any) -> Value:
    if isinstance(value, bool):
        return "yes" if value else None
    found: Value = as_float(value)
    return found


def _exact_cell(value: Any) -> Value:
    if isinstance(value, bool):
        return "yes" if value else None
    if isinstance(value, Fraction):
        return format_number(value)
    found: Value = value
    return found


def markdown(analysis: Analysis) -> str:
    """A heading, the summary, and each table, in Markdown (GitHub's tables)."""
    lines = [f"# {_escaped(analysis.name)}", ""]
    lines += [f"- {name}: {_written(value)}" for name, value in summary_rows(analysis)[1:]]
    for table in tables_of(analysis):
        shown = table.without_empty()
        lines += ["", f"## {shown.name}", ""]
        rows = [[_written(row[name], name) for name in shown.columns] for row in shown.rows]
        headings = [_escaped(heading) for heading in shown.headings(analysis.time_unit)]
        lines += _markdown_table(headings, rows)
    return "\n".join([*lines, ""])


def _markdown_table(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> Iterator[str]:
    yield f"| {' | '.join(headings)} |"
    yield f"|{'---|' * len(headings)}"
    for row in rows:
        yield f"| {' | '.join(row)} |"


def _written(value: str | Number | date | bool | None, column: str = "") -> str:
    """A value in Markdown; names are escaped, numbers exact but for a utilisation."""
    if value is None or value is False:
        return ""
    if value is True:
        return "yes"
    if isinstance(value, datetime):
        return value.isoformat(" ", "minutes" if not value.second else "auto")
    if isinstance(value, date):
        return value.isoformat()
    if isinstance(value, str):
        return _escaped(value)
    return f"{float(100 * value):.1f} %" if column == "utilisation" else format_number(value)


_MARKS = re.compile(r"([\\`*_{}\[\]<>()#+!|~&$^-])")


def _escaped(text: str) -> str:
    """A text in which nothing is markup, on one line."""
    return _MARKS.sub(r"\\\1", plain(text))
