"""The mean gap over time: as a picture where matplotlib is installed, and in letters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

Curves = Mapping[str, Sequence[tuple[float, float]]]
"""For each competitor, (processor seconds, mean gap)."""

_COLUMNS, _LINES, _HIGHEST = 60, 14, 0.3
_MARKS = "abcdefghijklmnopqrstuvwxyz"


def letters(curves: Curves) -> str:
    """The plot in letters: a letter for each competitor, `*` where several meet."""
    if not curves:
        return ""
    shown = [gap for curve in curves.values() for _, gap in curve if gap <= _HIGHEST]
    top = max(shown, default=_HIGHEST) or 0.01
    last = max(curve[-1][0] for curve in curves.values())
    cells = [[" "] * (_COLUMNS + 1) for _ in range(_LINES + 1)]
    for k, curve in enumerate(curves.values()):
        for at, gap in curve:
            if gap > top:
                continue
            line, column = round(_LINES * (1 - gap / top)), round(_COLUMNS * at / last)
            there, mark = cells[line][column], _MARKS[k % len(_MARKS)]
            cells[line][column] = mark if there in (" ", mark) else "*"
    lines = [
        f"{100 * top * (1 - k / _LINES):6.2f} % |{''.join(row).rstrip()}"
        for k, row in enumerate(cells)
    ]
    names = [f"  {_MARKS[k % len(_MARKS)]} {name}" for k, name in enumerate(curves)]
    axis = f"{'':9}+{'-' * _COLUMNS} {last:g} s of processor time for each worker"
    return "\n".join([*lines, axis, *names])


def picture(curves: Curves, path: Path) -> str | None:
    """Draws the plot; returns why it could not be drawn, if so."""
    try:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    except ImportError:
        return "no picture: matplotlib is not installed (pip install matplotlib)"
    figure = Figure(figsize=(7, 4.5), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    for name, curve in curves.items():
        axes.plot([at for at, _ in curve], [100 * gap for _, gap in curve], label=name)
    axes.set_xlabel("seconds of processor time for each worker")
    axes.set_ylabel("mean gap in %")
    axes.set_yscale("log")
    axes.grid(alpha=0.3)
    axes.legend()
    figure.savefig(path)
    return None
