"""Pictures of a schedule: charts for notebooks, and SVG, PNG and PDF without a browser."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Any

from irc.errors import LibraryMissing
from irc.model import Task
from irc.reporting.analysis import analyse
from irc.reporting.gantt import Spec, gantt
from irc.schedule import Schedule

_SCALE = 2
"""The pixels of a PNG for each pixel of the chart."""


def plot(task: Task, schedule: Schedule) -> Any:
    """The Gantt chart of a schedule as a chart of Altair.

    Raises `LibraryMissing` without Altair, and `OptionError` for too many actions.
    """
    spec = gantt(analyse(task, schedule))
    if find_spec("altair") is None:
        raise LibraryMissing("a chart needs altair: pip install 'irc-compiler[plot]'")
    import altair

    return altair.Chart.from_dict(spec)


def picture(spec: Spec, kind: str) -> bytes:
    """A chart as "svg", "png" or "pdf". Raises `LibraryMissing` without vl-convert."""
    if find_spec("vl_convert") is None:
        raise LibraryMissing("a picture needs vl-convert: pip install 'irc-compiler[plot]'")
    import vl_convert

    if kind == "svg":
        text: str = vl_convert.vegalite_to_svg(spec)
        return text.encode()
    if kind == "png":
        pixels: bytes = vl_convert.vegalite_to_png(spec, scale=_SCALE)
        return pixels
    page: bytes = vl_convert.vegalite_to_pdf(spec)
    return page
