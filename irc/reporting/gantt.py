"""The Gantt chart of a schedule by resource, as one specification of Vega-Lite.

Each resource has a row for each unit that is in use at once; what holds no resource has rows of its
own. Bars are exact: their ends are the times of the schedule, as floats of the task's unit.
"""

from __future__ import annotations

import json
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from heapq import heappop, heappush
from typing import Any, NamedTuple

from irc.errors import OptionError
from irc.model.dates import full
from irc.model.quantities import Number
from irc.model.times import format_number
from irc.reporting.analysis import Analysis
from irc.reporting.date_marks import date_marks
from irc.reporting.names import plain
from irc.reporting.rows import ActionRow
from irc.reporting.tables import held_text

MOST_BARS = 5000
"""A picture with more bars is refused: nothing in it could be distinguished."""

COLOURS = {
    "critical": "#d55e00",
    "not critical": "#56b4e9",
    "set-up": "#f0e442",
    "pause": "#fbe9dd",
    "closed": "#d9d9d9",
    "due date": "#000000",
}
"""Colours that people with any colour vision tell apart (Okabe and Ito 2008)."""

NO_RESOURCE = "no resource"

_ROW, _MOST_NAME = 22, 40
_WIDTHS = (900, 1200, 1500)
_LETTER = 6.5
"""The width of a letter of a label in pixels, roughly."""

Spec = dict[str, Any]


class _Lane(NamedTuple):
    """A row of the chart: its key, and the name that stands before it."""

    key: str
    title: str


def require_size(bars: int) -> None:
    """Raises `OptionError` where a picture would have too many bars."""
    if bars > MOST_BARS:
        raise OptionError(
            f"a picture has room for at most {MOST_BARS:,} actions, and there are {bars:,}: "
            "write a table (plan.xlsx, plan.csv), or the chart of a part of the task"
        )


def gantt(analysis: Analysis) -> Spec:
    """The chart as a document of Vega-Lite 5. Raises `OptionError` for too many bars."""
    require_size(len(analysis.actions))
    lanes, places = _lanes(analysis)
    layers = {
        "closed": [*_closed(analysis, lanes)],
        "set-up": [*_setups(analysis, places)],
        "bars": [*_bars(analysis, places)],
        "pause": [*_pauses(analysis, places)],
        "due date": [*_dues(analysis, places)],
    }
    ends = [value["end"] for values in layers.values() for value in values]
    first = min([0.0, *(due["start"] for due in layers["due date"])])
    last = max([float(analysis.span), *ends])
    width = _width(layers["bars"], last - first)
    kinds = {value["kind"] for values in layers.values() for value in values}
    shared = {
        "y": _rows(lanes),
        "x": {
            "field": "start",
            "type": "quantitative",
            "scale": {"domain": [first, last if last > first else first + 1], "nice": False},
            "axis": _axis(analysis, first, last),
        },
        "color": _colours(kinds),
    }
    drawn = [layer for name, values in layers.items() for layer in _drawn(name, values, shared)]
    drawn += _labels(layers["bars"], shared, width / (last - first) if last > first else 0)
    return {
        "$schema": "https://vega.github.io/schema/vega-lite/v5.json",
        "background": "white",
        "title": {"text": _title(analysis), "anchor": "start"},
        "width": width,
        "height": max(len(lanes), 1) * _ROW,
        "layer": drawn or [{"data": {"values": []}, "mark": "bar"}],
        "config": {"view": {"stroke": None}, "font": "sans-serif"},
    }


def _rows(lanes: Sequence[_Lane]) -> Spec:
    """The axis of rows."""
    keys = [lane.key for lane in lanes]
    titles = {lane.key: lane.title for lane in lanes}
    return {
        "field": "row",
        "type": "nominal",
        "sort": keys,
        "scale": {"domain": keys, "paddingInner": 0.15},
        "axis": {
            "title": None,
            "labelExpr": f"{json.dumps(titles)}[datum.value]",
            "labelLimit": 260,
            "domain": False,
            "ticks": False,
        },
    }


def _colours(kinds: Container[str]) -> Spec:
    """The colours of the kinds that there are, with their legend."""
    names = [name for name in COLOURS if name in kinds]
    return {
        "field": "kind",
        "type": "nominal",
        "scale": {"domain": names, "range": [COLOURS[name] for name in names]},
        "legend": {"title": None, "orient": "top", "symbolType": "square"},
    }


def _width(bars: Sequence[Spec], span: float) -> int:
    """A width in pixels in which most bars have room for their names."""
    long = [bar for bar in bars if bar["end"] > bar["start"]]
    for width in _WIDTHS:
        room = width / span if span else 0
        if sum(_has_room(bar, room) for bar in long) >= 0.7 * len(long):
            return width
    return _WIDTHS[-1]


def _has_room(bar: Spec, room: float) -> bool:
    """Whether the name of a bar fits into it, with `room` pixels for each unit of time."""
    return bool((bar["end"] - bar["start"]) * room >= _LETTER * len(bar["label"]) + 6)


def _title(analysis: Analysis) -> list[str]:
    span = f"makespan {format_number(analysis.span)} {analysis.time_unit}"
    head = [plain(analysis.name), f"{analysis.schedule.status}, {span}"]
    if analysis.dates is not None:
        dates = analysis.dates
        head[1] += f", from {full(dates.at(0))} to {full(dates.at(analysis.span))}"
    return head


_MARKS: Mapping[str, Spec] = {
    "closed": {"type": "bar"},
    "set-up": {"type": "bar", "stroke": "#7f7a00", "strokeWidth": 0.5},
    "bars": {"type": "bar", "stroke": "white", "strokeWidth": 0.5, "cornerRadius": 2},
    "pause": {"type": "bar", "opacity": 0.8},
    "due date": {"type": "tick", "orient": "vertical", "thickness": 2, "size": _ROW, "opacity": 1},
    "milestone": {"type": "point", "shape": "diamond", "filled": True, "size": 70, "opacity": 1},
}


def _drawn(name: str, values: Sequence[Spec], shared: Spec) -> Iterator[Spec]:
    """The layers of one kind of things; bars of no length are milestones."""
    long = [value for value in values if value["end"] > value["start"] or name == "due date"]
    short = [value for value in values if value["end"] == value["start"] and name == "bars"]
    for mark, shown in ((name, long), ("milestone", short)):
        if shown:
            ends = {} if mark in ("due date", "milestone") else {"x2": {"field": "end"}}
            yield {
                "data": {"values": shown},
                "mark": _MARKS[mark],
                "encoding": {**shared, **ends, "tooltip": _tips(shown[0])},
            }


def _tips(value: Spec) -> list[Spec]:
    return [{"field": f"tip.{name}", "title": name} for name in value["tip"]]


def _labels(bars: Sequence[Spec], shared: Spec, room: float) -> list[Spec]:
    """The names inside of bars that have room for them."""
    shown = [
        {"row": bar["row"], "start": (bar["start"] + bar["end"]) / 2, "label": bar["label"]}
        for bar in bars
        if bar["end"] > bar["start"] and _has_room(bar, room)
    ]
    if not shown:
        return []
    encoding = {"y": shared["y"], "x": shared["x"], "text": {"field": "label", "type": "nominal"}}
    mark = {"type": "text", "fontSize": 11, "baseline": "middle"}
    return [{"data": {"values": shown}, "mark": mark, "encoding": encoding}]


# --- rows ---------------------------------------------------------------------------------------

_Places = dict[tuple[str, int], list[tuple[str, str]]]
"""By occurrence, the resource and the key of the row of each bar."""


def _lanes(analysis: Analysis) -> tuple[list[_Lane], _Places]:
    """The rows of the chart, and where each occurrence has its bars."""
    held: dict[str, list[ActionRow]] = {load.resource: [] for load in analysis.loads}
    free: list[ActionRow] = []
    for row in analysis.actions:
        if not row.resources or row.start == row.end:
            free.append(row)
        for name in row.resources if row.start < row.end else ():
            held.setdefault(name, []).append(row)
    labels = {row.resource: row.label for row in analysis.resources}
    lanes: list[_Lane] = []
    places: _Places = {}
    groups = [(name, labels.get(name, name), rows) for name, rows in held.items()]
    if free:
        groups.append(("", NO_RESOURCE, free))
    for number, (name, label, rows) in enumerate(groups):
        count = 1
        for lane, row in _packed(rows):
            count = max(count, lane + 1)
            places.setdefault(row.key, []).append((name, f"{number}.{lane}"))
        title = _cut(label)
        lanes += (_Lane(f"{number}.{lane}", "" if lane else title) for lane in range(count))
    return lanes, places


def _packed(rows: Iterable[ActionRow]) -> Iterator[tuple[int, ActionRow]]:
    """(lane, row) on the fewest lanes on which nothing overlaps."""
    busy: list[tuple[Number, int]] = []
    free: list[int] = []
    count = 0
    for row in sorted(rows, key=lambda r: (r.start, r.end, r.key)):
        while busy and busy[0][0] <= row.start:
            heappush(free, heappop(busy)[1])
        if free:
            lane = heappop(free)
        else:
            lane, count = count, count + 1
        yield lane, row
        heappush(busy, (max(row.end, row.start), lane))


def _cut(name: str) -> str:
    name = plain(name)
    return name if len(name) <= _MOST_NAME else f"{name[: _MOST_NAME - 1]}…"


def _bars(analysis: Analysis, places: _Places) -> Iterator[Spec]:
    for row in analysis.actions:
        label = plain(row.label if row.occurrence == 1 else f"{row.label} #{row.occurrence}")
        tip = {
            "action": label,
            "start": _time(analysis, row.start),
            "end": _time(analysis, row.end),
            "resources": held_text(row.resources),
            "mode": row.mode or "",
            "slack": "not known" if row.slack is None else _length(analysis, row.slack),
            "why": "; ".join(reason.text for reason in row.why),
        }
        for _, lane in places[row.key]:
            kind = "critical" if row.critical else "not critical"
            yield {**_part(lane, row.start, row.end, kind, tip), "label": label}


def _part(row: str, start: Number, end: Number, kind: str, tip: Mapping[str, str]) -> Spec:
    shown = {name: plain(text) for name, text in tip.items()}
    return {"row": row, "start": float(start), "end": float(end), "kind": kind, "tip": shown}


def _closed(analysis: Analysis, lanes: Sequence[_Lane]) -> Iterator[Spec]:
    numbers = {load.resource: k for k, load in enumerate(analysis.loads)}
    for load in analysis.loads:
        own = [lane.key for lane in lanes if lane.key.startswith(f"{numbers[load.resource]}.")]
        for start, end in load.closed:
            tip = {"closed": load.resource, **_span(analysis, start, end)}
            yield from (_part(key, start, end, "closed", tip) for key in own)


def _setups(analysis: Analysis, places: _Places) -> Iterator[Spec]:
    for setup in analysis.setups:
        for name, lane in places.get(setup.after, ()):
            if name == setup.resource and setup.start < setup.end:
                tip = {"set-up": name, **_span(analysis, setup.start, setup.end)}
                yield _part(lane, setup.start, setup.end, "set-up", tip)


def _pauses(analysis: Analysis, places: _Places) -> Iterator[Spec]:
    for pauses in analysis.pauses:
        for start, end in pauses.spans:
            tip = {"pause": pauses.action, **_span(analysis, start, end)}
            for _, lane in places[pauses.action, pauses.occurrence]:
                yield _part(lane, start, end, "pause", tip)


def _dues(analysis: Analysis, places: _Places) -> Iterator[Spec]:
    """The due date of each order, in a row of what ends it."""
    for order in analysis.orders:
        if order.due is not None and order.critical:
            tip = {"order": order.label, "due": _time(analysis, order.due)}
            for _, lane in places[order.critical[-1]][:1]:
                yield _part(lane, order.due, order.due, "due date", tip)


def _span(analysis: Analysis, start: Number, end: Number) -> dict[str, str]:
    return {"from": _time(analysis, start), "to": _time(analysis, end)}


def _time(analysis: Analysis, time: Number) -> str:
    dates = analysis.dates
    text = f"{format_number(time)} {analysis.time_unit}"
    return text if dates is None or not dates.reach(time) else f"{full(dates.at(time))} ({text})"


def _length(analysis: Analysis, time: Number) -> str:
    return f"{format_number(time)} {analysis.time_unit}"


# --- the axis of time ---------------------------------------------------------------------------


def _axis(analysis: Analysis, first: float, last: float) -> Spec:
    axis: Spec = {"title": analysis.time_unit, "grid": True, "labelOverlap": True}
    if analysis.dates is None:
        return axis
    marks = list(date_marks(analysis.dates, Fraction(first), Fraction(last)))
    if not marks:
        return axis
    labels = {f"{float(time):.6f}": text for time, text in marks}
    return {
        **axis,
        "title": None,
        "values": [float(time) for time, _ in marks],
        "labelExpr": f"{json.dumps(labels)}[format(datum.value, '.6f')]",
    }
