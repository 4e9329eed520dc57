"""A small still picture of bars in rows, as SVG: for notebooks, and where no script may run.

It has no script, no style sheet and no reference, so it shows wherever HTML does. Its ink is the
colour of the text around it, in light and in dark.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from html import escape

# Okabe and Ito's colours, which people with any kind of colour vision tell apart.
_COLOURS = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#a89c00", "#7a7a7a")

MOST_LINES, MOST_BARS = 24, 120
"""Limits on the lines and bars of a picture; what is left out is counted below it."""

_LINE, _NAME, _TOP, _SIGN = 22, 128, 22, 6.6
"""Heights and widths in pixels: a line, the names beside it, the axis, a letter (about)."""


@dataclass(frozen=True, slots=True)
class Bar:
    """A bar: the row that it is in, its times to draw with, its name, and what pointing at it says.

    `colour` is an index: equal ones look alike. A `marked` bar has a thick frame.
    """

    row: str
    start: float
    end: float
    name: str
    title: str
    colour: int = 0
    marked: bool = False


def bars_svg(bars: Sequence[Bar], unit: str, title: str, width: int = 760) -> str:
    """The picture, with a title for those who cannot see it; empty without bars."""
    if not bars:
        return ""
    shown, lines = _placed(bars)
    end = max((bar.end for bar, _ in shown), default=0) or 1
    scale = (width - _NAME - 12) / end
    height = _TOP + len(lines) * _LINE + 4
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}"'
        f' height="{height}" role="img" font-family="sans-serif" font-size="12"'
        f' fill="currentColor"><title>{escape(title)}</title>',
        *_axis(end, scale, unit, height),
        *(_row_name(k, name) for k, name in enumerate(lines) if name),
        *(_bar(bar, k, scale) for bar, k in shown),
        "</svg>",
    ]
    left_out = len(bars) - len(shown)
    if left_out:
        parts.append(f"<p>… and {left_out:,} more in the picture</p>")
    return "".join(parts)


def _placed(bars: Sequence[Bar]) -> tuple[list[tuple[Bar, int]], list[str]]:
    """(bars with the line of each, the name of each line): bars of a row do not overlap."""
    by_row: dict[str, list[Bar]] = {}
    for bar in bars:
        by_row.setdefault(bar.row, []).append(bar)
    shown: list[tuple[Bar, int]] = []
    lines: list[str] = []
    for name, of in by_row.items():
        ends: list[float] = []
        first = len(lines)
        for bar in sorted(of, key=lambda bar: (bar.start, bar.end)):
            k = next((k for k, end in enumerate(ends) if end <= bar.start), len(ends))
            if first + k >= MOST_LINES or len(shown) >= MOST_BARS:
                continue
            if k == len(ends):
                ends.append(0)
                lines.append("" if k else name)
            ends[k] = bar.end
            shown.append((bar, first + k))
    return shown, lines


def _axis(end: float, scale: float, unit: str, height: int) -> Iterator[str]:
    """The labels of the axis at round numbers, and their lines."""
    step = _step(end, scale)
    for k in range(int(end / step) + 1):
        x = _NAME + k * step * scale
        text = f"{k * step:g} {unit}" if not k else f"{k * step:g}"
        yield (
            f'<path d="M{x:.1f} {_TOP - 4}V{height}" stroke="currentColor" stroke-opacity=".18"/>'
            f'<text x="{x:.1f}" y="12" fill-opacity=".75">{escape(text)}</text>'
        )


def _step(end: float, scale: float) -> float:
    """The smallest round number that is at least 64 pixels long."""
    power = 10.0**-9
    while True:
        for digit in (1, 2, 5):
            if digit * power * scale >= 64 or digit * power >= end:
                return digit * power
        power *= 10


def _row_name(line: int, name: str) -> str:
    y = _TOP + line * _LINE + _LINE * 0.68
    return f'<text x="2" y="{y:.1f}">{escape(_fit(name, _NAME - 8))}</text>'


def _bar(bar: Bar, line: int, scale: float) -> str:
    x, y = _NAME + bar.start * scale, _TOP + line * _LINE + 2
    length = max(2.0, (bar.end - bar.start) * scale)
    colour = _COLOURS[bar.colour % len(_COLOURS)]
    frame = ' stroke-width="2.5"' if bar.marked else ""
    text = _fit(bar.name, length - 8)
    label = f'<text x="{x + 5:.1f}" y="{y + 13}">{escape(text)}</text>' if text else ""
    return (
        f'<g><title>{escape(bar.title)}</title><rect x="{x:.1f}" y="{y}" width="{length:.1f}"'
        f' height="{_LINE - 4}" fill="{colour}" fill-opacity=".35" stroke="{colour}"{frame}/>'
        f"{label}</g>"
    )


def _fit(text: str, room: float) -> str:
    """The text, cut with "…" to about a width; empty where hardly a letter fits."""
    most = int(room / _SIGN)
    if len(text) <= most:
        return text
    return f"{text[: most - 1]}…" if most > 2 else ""
