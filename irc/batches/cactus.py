"""The cactus plot of a batch: how many tasks a target and engine solves within how many seconds.

A line further to the right solves more tasks, a lower one is faster. Source of the name and form:
the plots of the SAT competitions (Brain, Davenport and Griggio, Benchmarking Solvers, SAT-style,
SC² 2017).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape

from irc.batches.summary import SummaryRow

_COLUMNS, _LINES = 60, 12
_MARKS = "abcdefghijklmnopqrstuvwxyz"
_SEVERAL = "*"
_LEAST_SECONDS = 0.001

_WIDTH, _HEIGHT, _LEFT, _TOP = 640, 360, 60, 20
_COLOURS = ("#1f77b4", "#d62728", "#2ca02c", "#9467bd", "#ff7f0e", "#17becf", "#7f7f7f")
_STYLE = 'font-family="sans-serif" font-size="11"'


def cactus_text(rows: Sequence[SummaryRow]) -> str:
    """The plot in letters, one for each row; empty where nothing is solved."""
    drawn = [row for row in rows if row.times]
    if not drawn:
        return ""
    low, high = _exponents(drawn)
    most = max(len(row.times) for row in drawn)
    cells = [[" "] * _COLUMNS for _ in range(_LINES)]
    for k, row in enumerate(drawn):
        mark = _MARKS[k % len(_MARKS)]
        for column, seconds in _points(row, most):
            line = round((_LINES - 1) * _height(seconds, low, high))
            there = cells[line][column]
            cells[line][column] = mark if there in (" ", mark) else _SEVERAL
    lines = [
        f"{_label(line, low, high):>8} │{''.join(cells[line]).rstrip()}"
        for line in reversed(range(_LINES))
    ]
    axis = f"{'':8} └{'─' * _COLUMNS}"
    ends = f"{'':8}  {'1':<{_COLUMNS // 2}}{f'{most:,} solved':>{_COLUMNS - _COLUMNS // 2}}"
    legend = [
        f"{'':8}  {_MARKS[k % len(_MARKS)]} {row.pair.target} {row.pair.engine}"
        for k, row in enumerate(drawn)
    ]
    several = [f"{'':8}  {_SEVERAL} several"] if any(_SEVERAL in line for line in cells) else []
    return "\n".join(["seconds", *lines, axis, ends, *legend, *several])


def _points(row: SummaryRow, most: int) -> list[tuple[int, float]]:
    """(column, seconds) of the plot in letters: of the tasks in one column, the slowest."""
    found: dict[int, float] = {}
    for k, seconds in enumerate(row.times):
        found[round((_COLUMNS - 1) * k / max(1, most - 1))] = seconds
    return list(found.items())


def _exponents(rows: Sequence[SummaryRow]) -> tuple[float, float]:
    """The lowest and highest power of ten of the seconds, never the same."""
    low = math.floor(math.log10(max(_LEAST_SECONDS, min(row.times[0] for row in rows))))
    high = math.ceil(math.log10(max(_LEAST_SECONDS, max(row.times[-1] for row in rows))))
    return low, max(high, low + 1)


def _height(seconds: float, low: float, high: float) -> float:
    """The place of a time on the axis, from 0 to 1."""
    exponent = math.log10(max(_LEAST_SECONDS, seconds))
    return min(1.0, max(0.0, (exponent - low) / (high - low)))


def _label(line: int, low: float, high: float) -> str:
    """The power of ten on a line of the plot in letters, if there is one."""
    for exponent in range(int(low), int(high) + 1):
        if round((_LINES - 1) * (exponent - low) / (high - low)) == line:
            return f"{10.0**exponent:g}"
    return ""


def cactus_svg(rows: Sequence[SummaryRow]) -> str:
    """The plot as an SVG picture."""
    drawn = [row for row in rows if row.times]
    low, high = _exponents(drawn) if drawn else (-1, 0)
    most = max((len(row.times) for row in drawn), default=1)
    size = f'width="{_WIDTH + 40}" height="{_HEIGHT + 60 + 16 * len(drawn)}"'
    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" {size}>', f'<rect {size} fill="white"/>']
    lines += _grid(low, high, most)
    for k, row in enumerate(drawn):
        colour = _COLOURS[k % len(_COLOURS)]
        points = " ".join(
            f"{_x(i, most):.1f},{_y(seconds, low, high):.1f}" for i, seconds in enumerate(row.times)
        )
        lines.append(f'<polyline points="{points}" fill="none" stroke="{colour}"/>')
        name = escape(f"{row.pair.target} {row.pair.engine}: {len(row.times):,} solved")
        y = _HEIGHT + 50 + 16 * k
        lines.append(f'<text x="{_LEFT}" y="{y}" fill="{colour}" {_STYLE}>{name}</text>')
    return "\n".join([*lines, "</svg>"]) + "\n"


def _grid(low: float, high: float, most: int) -> list[str]:
    lines = []
    for exponent in range(int(low), int(high) + 1):
        y = _y(10.0**exponent, low, high)
        lines.append(f'<line x1="{_LEFT}" x2="{_WIDTH}" y1="{y:.1f}" y2="{y:.1f}" stroke="#ddd"/>')
        lines.append(f'<text x="8" y="{y + 4:.1f}" {_STYLE}>{10.0**exponent:g} s</text>')
    for count in sorted({1, (most + 1) // 2, most}):
        x = _x(count - 1, most)
        lines.append(f'<text x="{x:.1f}" y="{_HEIGHT + 18}" {_STYLE}>{count:,}</text>')
    lines.append(f'<text x="{_WIDTH - 40}" y="{_HEIGHT + 34}" {_STYLE}>solved</text>')
    return lines


def _x(position: int, most: int) -> float:
    return _LEFT + (_WIDTH - _LEFT) * position / max(1, most - 1)


def _y(seconds: float, low: float, high: float) -> float:
    return _TOP + (_HEIGHT - _TOP) * (1 - _height(seconds, low, high))
