"""The page of a report: its parts put together, with everything escaped, and nothing from outside.

A policy in the page lets exactly its own script and its own style run, by their hashes, and forbids
every request. Names that a user wrote are data in JSON, or escaped text: they never become markup.
"""

from __future__ import annotations

import json
import re
from base64 import b64encode
from collections.abc import Mapping, Sequence
from functools import cache
from hashlib import sha256
from html import escape
from importlib.resources import files
from string import Template
from typing import Any

from irc._version import __version__
from irc.display.svg import bars_svg
from irc.errors import IrcError
from irc.execution.step import Step
from irc.model import Task
from irc.outcome import MISUSED
from irc.reporting.html.figures import made_text
from irc.reporting.html.payload import Payload, PlanToShow
from irc.schedule import Schedule

SCRIPTS = (
    "times.js",
    "model.js",
    "paint.js",
    "drawing.js",
    "chart.js",
    "panel.js",
    "main.js",
)
"""The parts of the script, in the order in which they are put together."""

MOST_ROWS = 50_000
"""A report shows at most this many occurrences, of all its plans."""


class ReportTooLarge(IrcError):
    """There are more actions than a browser shows with ease; the text says what to do instead."""

    ends_as = MISUSED


def report_html(
    task: Task,
    schedule: Schedule,
    previous: Schedule | None = None,
    steps: Sequence[Step] | None = None,
) -> str:
    """The report on a schedule of a task: one HTML file that needs nothing else.

    `previous` is an earlier plan of the task, against which changes are shown. `steps` are those of
    a running task, of which `schedule` is the last plan; the page has a slider for them, and the
    changes of each against the one before. Raises `ReportTooLarge`.
    """
    payload = _payload(task, schedule, previous, steps)
    return page(payload, payload.document())


def payload_of(
    task: Task,
    schedule: Schedule,
    previous: Schedule | None = None,
    steps: Sequence[Step] | None = None,
    *,
    live: bool = False,
) -> dict[str, Any]:
    """The payload of the report: everything that its chart and tables show, as a JSON document."""
    return _payload(task, schedule, previous, steps).document(live=live)


def _payload(
    task: Task, schedule: Schedule, previous: Schedule | None, steps: Sequence[Step] | None
) -> Payload:
    plans = [PlanToShow.of_step(step) for step in steps or ()]
    if not plans or plans[-1].schedule != schedule:
        plans.append(PlanToShow(task, schedule))
    rows = sum(len(plan.schedule) for plan in plans)
    if rows > MOST_ROWS:
        raise ReportTooLarge(
            f"a report shows at most {MOST_ROWS:,} actions, and these are {rows:,}:"
            " write a table (.csv or .xlsx), or a report on a part of the task"
        )
    before = None if previous is None else PlanToShow(task, previous)
    return Payload(plans, before)


def page(payload: Payload, document: Mapping[str, Any], *, live: bool = False) -> str:
    """The page with a payload. A page that is `live` may ask the server that it came from."""
    script, style = _script(), _static("report.css")
    last = document["plans"][-1]
    analysis, schedule = payload.analyses[-1], payload.shown[-1].schedule
    return Template(_static("report.html")).substitute(
        policy=policy(script, style, live=live),
        title=escape(document["title"]),
        style=style,
        status=escape(last["status"]),
        status_text=escape(last["status_text"]),
        made=escape(made_text(schedule, analysis)),
        figures="".join(_figure(*figure) for figure in last["figures"]),
        picture=bars_svg(schedule.bars(), analysis.time_unit, document["title"]),
        tables="".join(_table(name, document) for name in document["tables"]),
        footer=escape(
            f"Made by irc {__version__}. Times are exact, and nothing is loaded from elsewhere."
        ),
        payload=data(document),
        script=script,
    )


def policy(script: str, style: str, *, live: bool = False) -> str:
    """The Content-Security-Policy of a page: its own script and style, and no request."""
    asks = "'self'" if live else "'none'"
    return (
        f"default-src 'none'; script-src '{_hash(script)}'; style-src '{_hash(style)}';"
        f" connect-src {asks}; base-uri 'none'; form-action 'none'"
    )


def _hash(text: str) -> str:
    return f"sha256-{b64encode(sha256(text.encode()).digest()).decode()}"


def data(document: Mapping[str, Any]) -> str:
    """JSON that may stand in a script element: it neither ends it nor begins a comment."""
    text = json.dumps(document, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return _UNSAFE.sub(lambda found: f"\\u{ord(found[0]):04x}", text)


_UNSAFE = re.compile("[<>&\u2028\u2029]")


@cache
def _static(name: str) -> str:
    return files(__package__).joinpath("static", name).read_text("utf-8")


@cache
def _script() -> str:
    parts = "\n".join(map(_static, SCRIPTS))
    return f'(() => {{\n"use strict";\n{parts}\n}})();\n'


def _figure(name: str, value: str, note: str) -> str:
    small = f"<small>{escape(note)}</small>" if note else ""
    return f"<div><dt>{escape(name)}</dt><dd>{escape(value)}{small}</dd></div>"


def _table(name: str, document: Mapping[str, Any]) -> str:
    """A table as HTML, with the rows of the last plan; hidden if there are none."""
    table = document["tables"][name]
    columns = table["columns"]
    shown = [k for k, column in enumerate(columns) if column[3]]
    last = document["plans"][-1]
    if name == "actions":
        rows = [document["rows"][r]["c"] for r in last["rows"]]
    else:
        rows = last["tables"][name]
    head = "".join(
        f'<th scope="col" data-column="{k}" data-kind="{columns[k][1]}">'
        f"{escape(columns[k][0])}</th>"
        for k in shown
    )
    body = "".join(_row(row, shown, columns) for row in rows)
    note = f"<p>{escape(table['note'])}</p>" if table["note"] else ""
    title = escape(table["title"])
    return (
        f'<section id="part-{name}"{"" if rows else " hidden"}><h2>{title}</h2>{note}'
        f'<div class="holder" tabindex="0" role="region" aria-label="{title}">'
        f'<table id="table-{name}"><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>'
        "</div></section>\n"
    )


def _row(row: Sequence[str], shown: Sequence[int], columns: Sequence[Sequence[Any]]) -> str:
    cells = []
    for place, k in enumerate(shown):
        kind = columns[k][1]
        attribute = ' dir="auto"' if kind == "text" else f' class="{kind}"'
        if not place:
            cells.append(f'<th scope="row"{attribute}>{escape(row[k])}</th>')
        else:
            cells.append(f"<td{attribute}>{escape(row[k])}</td>")
    return f"<tr>{''.join(cells)}</tr>"
