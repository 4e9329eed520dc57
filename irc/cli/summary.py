"""The summary of a long schedule: how many actions, what is late, what is busy."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from rich.text import Text

from irc.cli.page import Page, with_unit
from irc.cli.table import listed_within

if TYPE_CHECKING:
    from irc.reporting.analysis import Analysis

_NAMED = 3
"""At most this many resources and orders are named."""


def summary_lines(page: Page, analysis: Analysis) -> Iterator[Text]:
    """The lines of the summary."""
    used = [row for row in analysis.resources if row.actions]
    critical = sum(row.critical for row in analysis.actions)
    yield counts_line(len(analysis.actions), critical, len(used))
    yield from _lateness(page, analysis)
    busy = [row for row in used if row.utilisation is not None]
    busy.sort(key=lambda row: (-(row.utilisation or 0), row.resource))
    if busy:
        names = [
            f"{page.visible(row.resource)} {float(100 * (row.utilisation or 0)):.0f} %"
            for row in busy[:_NAMED]
        ]
        yield Text(listed_within(page, "busiest: ", names))


def counts_line(actions: int, critical: int, used: int) -> Text:
    """The numbers of actions, of resources that they use, and of critical actions."""
    on = f" on {used:,} resource{'s' if used != 1 else ''}" if used else ""
    return Text(f"{actions:,} actions{on}, {critical:,} of them critical")


def _lateness(page: Page, analysis: Analysis) -> Iterator[Text]:
    dated = [row for row in analysis.orders if row.due is not None and row.lateness is not None]
    late = sorted((row for row in dated if row.tardiness), key=lambda r: -(r.tardiness or 0))
    if not dated:
        return
    if not late:
        yield Text(f"all {len(dated):,} orders are on time")
        return
    names = [
        f"{page.visible(row.order)} by {with_unit(row.tardiness or 0, analysis.time_unit)}"
        for row in late[:_NAMED]
    ]
    head = f"late: {len(late):,} of {len(dated):,} orders, most "
    yield Text(listed_within(page, head, names))
