"""Accuracy by size as an SVG picture: a line for each method, the mean of all models."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from irc.evaluation.figure import Rate, Table, walk

_WIDTH, _HEIGHT, _MARGIN, _GAP = 420, 260, 44, 40
_COLOURS = ("#1f77b4", "#d62728", "#2ca02c", "#9467bd")
_TITLES = {
    "xxl_makespan": "makespan",
    "xxl_plan_paper": "plan, the paper's rules",
    "xxl_plan_meaning": "plan, by meaning",
}
_TEXT = 'font-family="sans-serif" font-size="11"'


def accuracy_by_size(tables: Mapping[str, Table]) -> str:
    """The picture: a panel for each of the size tables that is there."""
    panels = [(title, tables[name]) for name, title in _TITLES.items() if name in tables]
    width = len(panels) * (_WIDTH + _GAP) + _GAP
    drawn = [
        line
        for k, (title, table) in enumerate(panels)
        for line in _panel(title, _means(table), _GAP + k * (_WIDTH + _GAP))
    ]
    head = f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{_HEIGHT + 90}">'
    background = f'<rect width="{width}" height="{_HEIGHT + 90}" fill="white"/>'
    return "\n".join([head, background, *drawn, "</svg>"]) + "\n"


def _means(table: Table) -> dict[str, dict[int, float]]:
    """By method and size: the mean over the models."""
    values: dict[str, dict[int, list[float]]] = {}
    for (method, _, size), figure in walk(table):
        if isinstance(figure, Rate) and figure.values:
            values.setdefault(method, {}).setdefault(int(size), []).append(figure.value)
    return {
        method: {size: sum(found) / len(found) for size, found in sorted(sizes.items())}
        for method, sizes in values.items()
    }


def _panel(title: str, means: Mapping[str, Mapping[int, float]], left: int) -> list[str]:
    largest = max((size for sizes in means.values() for size in sizes), default=1)
    lines = [f'<text x="{left}" y="20" {_TEXT} font-weight="bold">{title}</text>']
    lines += _axes(left, largest)
    for k, (method, sizes) in enumerate(means.items()):
        colour = _COLOURS[k % len(_COLOURS)]
        points = " ".join(
            f"{_x(left, size, largest):.1f},{_y(value):.1f}" for size, value in sizes.items()
        )
        lines.append(
            f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="2"/>'
        )
        x = left + _MARGIN + 90 * k
        lines.append(f'<text x="{x}" y="{_HEIGHT + 75}" fill="{colour}" {_TEXT}>{method}</text>')
    return lines


def _axes(left: int, largest: int) -> list[str]:
    marks: Sequence[float] = (0, 0.25, 0.5, 0.75, 1)
    right = left + _WIDTH
    lines = [
        f'<line x1="{left + _MARGIN}" x2="{right}" y1="{_y(m):.1f}" y2="{_y(m):.1f}" '
        f'stroke="#ddd"/><text x="{left}" y="{_y(m) + 4:.1f}" {_TEXT}>{m:g}</text>'
        for m in marks
    ]
    sizes = [largest * k // 5 for k in range(1, 6)]
    lines += [
        f'<text x="{_x(left, size, largest) - 8:.1f}" y="{_HEIGHT + 45}" {_TEXT}>{size}</text>'
        for size in sizes
    ]
    return lines


def _x(left: int, size: int, largest: int) -> float:
    return left + _MARGIN + (_WIDTH - _MARGIN) * size / largest


def _y(value: float) -> float:
    return 30 + _HEIGHT * (1 - value)
