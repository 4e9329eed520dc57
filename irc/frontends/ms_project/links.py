"""Links between tasks as precedence: those of summary tasks expanded, working lags as actions.

A lag in working time passes only at open times, which no lag of the IR does. So it becomes an
action, which pauses: a positive lag begins after the end that it follows and ends before the end
that waits for it. A negative lag ends no earlier than the end that it is counted from, and what is
linked comes no earlier than its start. It may last less than the lag, for the lag may reach back
before the beginning of the project; where it surely does not, it lasts exactly so long.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal
from typing import Any, Protocol

from irc.frontends.ms_project.elements import Element
from irc.frontends.ms_project.outline import Ids, Item, Outline

ELAPSED = frozenset([4, 6, 8, 10, 12, 36, 38, 40, 42, 44])
"""The formats of durations and lags that count every hour, open or closed."""

_PERCENT = frozenset([19, 20, 51, 52])
_TYPES = {0: ("finish", "finish"), 1: ("finish", "start"), 2: ("start", "finish")} | {
    3: ("start", "start")
}
_MOST_EDGES = 200_000


@dataclass(frozen=True)
class Link:
    """A link: the ends that it binds, and its lag in minutes."""

    element: Element
    before: Item
    after: Item
    ends: tuple[str, str]
    lag: Decimal
    elapsed: bool


@dataclass
class Links:
    """The precedence of a project, and the actions that are lags."""

    precedence: list[dict[str, Any]]
    lags: list[dict[str, Any]]


def time_of(minutes: Decimal) -> int | str:
    """A length of time as the IR writes it, in the unit `min`."""
    whole = int(minutes)
    return whole if minutes == whole else f"{(minutes * 60).normalize():f} s"


class Open(Protocol):
    """Answers about open times and times of work."""

    def of_lag(self, item: Item) -> str | None:
        """The id of the calendar of lags before a task; None if they pass at all hours."""

    def is_open_before(self, befores: Sequence[Item], after: Item, lag: Decimal) -> bool:
        """Whether `lag` minutes of the calendar of lags lie before the end of one of `befores`."""

    def works_within(self, befores: Sequence[Item], after: Item) -> bool:
        """Whether each of `befores` works at open times of the calendar of lags only."""


def read_links(outline: Outline, open: Open, ids: Ids) -> Links:
    """The precedence of all links."""
    found = Links([], [])
    for item in outline.items.values():
        for one in item.element.all("PredecessorLink"):
            link = _read(one, item, outline)
            if link is None:
                continue
            befores, afters = _ends(link, "before"), _ends(link, "after")
            if len(found.precedence) + len(befores) * len(afters) > _MOST_EDGES:
                one.faults.add(one, f"links of summary tasks come to more than {_MOST_EDGES:,}")
                return found
            calendar = None if link.lag == 0 or link.elapsed else open.of_lag(item)
            if calendar is None:
                found.precedence += [
                    _precedence(b.id, a.id, link.ends, link.lag) for b in befores for a in afters
                ]
            elif _is_exact(link, open, befores):
                lag = _lag(link, open, befores, calendar, ids)
                found.lags.append(lag)
                found.precedence += _around(link, str(lag["id"]), befores, afters)
    return found


def _read(one: Element, after: Item, outline: Outline) -> Link | None:
    uid = one.whole("PredecessorUID", -1)
    name, place = f"task {after.name!r}", one.at("PredecessorUID")
    if one.flag("CrossProject"):
        one.faults.add(one, f"{name}: a link from another project is not read")
        return None
    if uid in outline.inactive:
        return None
    if uid not in outline.items:
        one.faults.add(place, f"{name}: there is no task with the UID {uid}")
        return None
    kind, format = one.whole("Type", 1), one.whole("LagFormat", 7)
    if kind not in _TYPES:
        message = f"{name}: the Type of a link is 0 (FF), 1 (FS), 2 (SF) or 3 (SS)"
        one.faults.add(one.at("Type"), message)
        return None
    lag = Decimal(one.whole("LinkLag")) / 10
    if lag != 0 and format in _PERCENT:
        message = f"{name}: a lag in percent of a duration is not read"
        one.faults.add(one.at("LinkLag"), message, "write it as a time")
    before = outline.items[uid]
    if before in _above(after) or after in _above(before):
        one.faults.add(one, f"{name}: a link between a summary task and its own part")
    return Link(one, before, after, _TYPES[kind], lag, format in ELAPSED)


def _above(item: Item) -> list[Item]:
    return [item.parent, *_above(item.parent)] if item.parent else []


def _ends(link: Link, side: str) -> list[Item]:
    """The tasks whose ends a link binds.

    A summary task ends when all of its tasks have ended, and what it waits for, all of them wait
    for. Its start as what is waited for, or its end as what waits, is that of any one of them: that
    is exact for a single task only.
    """
    item = link.before if side == "before" else link.after
    leaves = list(item.leaves())
    exact = link.ends[0] == "finish" if side == "before" else link.ends[1] == "start"
    if len(leaves) > 1 and not exact:
        what = "start" if side == "before" else "finish"
        message = f"a link to the {what} of the summary task {item.name!r} is not read"
        hint = "link to the task that starts first, or to a milestone"
        link.element.faults.add(link.element, message, hint)
    return leaves


def _precedence(
    before: str, after: str, ends: tuple[str, str], lag: Decimal = Decimal(0)
) -> dict[str, Any]:
    found: dict[str, Any] = {"before": before, "after": after}
    if ends != ("finish", "start"):
        found["type"] = "-".join(ends)
    return {**found, "min_lag": time_of(lag)} if lag else found


def _is_exact(link: Link, open: Open, befores: list[Item]) -> bool:
    """Whether a working lag can be an action; a fault where it cannot.

    A negative one ends when its predecessor does. That can be at the end of an open time, but not
    at its beginning, where work starts, and where only work outside of the calendar ends.
    """
    exact = link.ends == ("finish", "start") and open.works_within(befores, link.after)
    if link.lag > 0 or exact:
        return True
    message = (
        f"task {link.after.name!r}: a negative lag in working time is read for a finish-to-start "
        "link from a task that works in its calendar"
    )
    hint = "write the lag as elapsed time (such as -1 ed)"
    link.element.faults.add(link.element.at("LinkLag"), message, hint)
    return False


def _lag(link: Link, open: Open, befores: list[Item], calendar: str, ids: Ids) -> dict[str, Any]:
    """The action of a working lag."""
    sign = "+" if link.lag > 0 else "-"
    length: Any = time_of(abs(link.lag))
    shown = length if isinstance(length, str) else f"{length} min"
    id = ids.take(f"{link.before.id} {sign} {shown}: {link.after.id}", "lag")
    if link.lag < 0 and not open.is_open_before(befores, link.after, -link.lag):
        length = {"min": 0, "max": length}
    return {"id": id, "duration": length, "calendar": calendar, "breaks": "pause"}


def _around(link: Link, id: str, befores: list[Item], afters: list[Item]) -> list[dict[str, Any]]:
    """The precedence before and after the action of a working lag."""
    first, last = ("start", "finish") if link.lag > 0 else ("finish", "start")
    return [
        *(_precedence(before.id, id, (link.ends[0], first)) for before in befores),
        *(_precedence(id, after.id, (last, link.ends[1])) for after in afters),
    ]
