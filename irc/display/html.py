"""HTML for notebooks: headings, tables and lists, with everything escaped."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

MOST_ROWS = 200
"""Longer tables end in "and N more"."""


def heading(text: str) -> str:
    """One line in bold."""
    return f"<p><strong>{escape(text)}</strong></p>"


def table(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table. Columns that are empty in every row are left out."""
    used = [k for k in range(len(columns)) if any(row[k] for row in rows)]
    head = "".join(f"<th>{escape(columns[k])}</th>" for k in used)
    body = "".join(
        f"<tr>{''.join(f'<td>{escape(row[k])}</td>' for k in used)}</tr>"
        for row in rows[:MOST_ROWS]
    )
    return (
        f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
        f"{_rest(len(rows) - MOST_ROWS)}"
    )


def items(texts: Iterable[str]) -> str:
    """A list of texts."""
    listed = list(texts)
    shown = "".join(f"<li>{escape(text)}</li>" for text in listed[:MOST_ROWS])
    return f"<ul>{shown}</ul>{_rest(len(listed) - MOST_ROWS)}"


def preformatted(text: str) -> str:
    """A text whose layout is kept."""
    return f"<pre>{escape(text)}</pre>"


def folded(title: str, html: str) -> str:
    """HTML that shows when its title is chosen."""
    return f"<details><summary>{escape(title)}</summary>{html}</details>"


def _rest(more: int) -> str:
    return f"<p>… and {more} more</p>" if more > 0 else ""
