"""A page of text on a console: its width, its characters, and how times are written on it.

Names are shown as data: never read as markup, control characters made visible, and what the
console's encoding lacks written as escapes.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable
from fractions import Fraction
from os import environ
from typing import NamedTuple

from rich.cells import cell_len, set_cell_size
from rich.console import Console
from rich.text import Text

from irc.model.quantities import Number
from irc.model.times import format_number, unit_seconds

PIPED_WIDTH = 100
"""Columns where standard output is no terminal and nothing else says how many."""


def answer_console() -> Console:
    """The console for standard output: a terminal's own width, else `COLUMNS`, else 100."""
    if sys.stdout.isatty() or "COLUMNS" in environ:
        return Console()
    return Console(width=PIPED_WIDTH)


def print_lines(page: Page, console: Console, lines: Iterable[Text]) -> None:
    for line in lines:
        line.truncate(page.width, overflow="crop")
        line.rstrip()
        console.print(line, soft_wrap=True)


class Kind(NamedTuple):
    """How bars of one kind look; each character is one cell wide."""

    fill: str
    edge: str
    short: str
    milestone: str
    style: str
    label_style: str


class Glyphs(NamedTuple):
    """The characters of a drawing; those of the chart are one cell wide each."""

    critical: Kind
    slack: Kind
    crowd: str
    rule: str
    tick: str
    first_tick: str
    grid: str
    times: str
    more: str
    about: str
    arrow: str
    good: str
    bad: str


_RED, _CYAN = ("red", "bold white on red"), ("cyan", "bold cyan")
_BLOCKS = Glyphs(
    critical=Kind("█", "▐", "▐", "◆", *_RED),
    slack=Kind("░", "▕", "▒", "◇", *_CYAN),
    crowd="▓",
    rule="─",
    tick="┼",
    first_tick="├",
    grid="┊",
    times="×",
    more="…",
    about="≈",
    arrow="→",
    good="✔",
    bad="✘",
)
_ASCII = Glyphs(
    critical=Kind("#", "[", "[", "*", *_RED),
    slack=Kind("=", "(", "(", "o", *_CYAN),
    crowd="%",
    rule="-",
    tick="+",
    first_tick="+",
    grid=":",
    times="x",
    more="...",
    about="about ",
    arrow="->",
    good="",
    bad="",
)


class Page:
    """Where an answer is shown: how wide it is and which characters it can take."""

    def __init__(self, console: Console) -> None:
        self.width = console.width
        self.encoding = console.encoding
        drawing = str(_BLOCKS)  # has every one of its characters
        self.glyphs = _BLOCKS if self._encodable(drawing) == drawing else _ASCII

    def _encodable(self, text: str) -> str:
        return text.encode(self.encoding, "backslashreplace").decode(self.encoding)

    def visible(self, name: str) -> str:
        """A name on one line: nothing in it moves the cursor, is unseen or cannot be written."""
        if name.isascii() and name.isprintable() and name == name.strip():
            return name
        shown = self._encodable(
            "".join(c if c.isprintable() else _escape(c) for c in name if c not in _JOINERS)
        )
        return shown if shown == shown.strip() else f'"{shown}"'

    def fit(self, text: str, width: int) -> str:
        """At most `width` cells of a text: its two ends, where names differ, and a mark between."""
        if cell_len(text) <= width:
            return text
        room = width - len(self.glyphs.more)
        if room < 2:
            return set_cell_size(text, max(width, 0))
        last = room // 3
        tail = ""
        for character in reversed(text):
            if cell_len(character + tail) > last:
                break
            tail = character + tail
        return set_cell_size(text, room - cell_len(tail)).rstrip() + self.glyphs.more + tail


_JOINERS = frozenset("\u200d\ufe0e\ufe0f")
"""They ask for one glyph in place of two, and terminals do not agree on how wide that is."""


def _escape(character: str) -> str:
    return character.encode("unicode_escape").decode("ascii")


_DIGITS = re.compile(r"(\d+)")


def natural(name: str) -> tuple[tuple[int, str], ...]:
    """A sort key that puts robot2 before robot10."""
    parts = _DIGITS.split(name)
    parts[1::2] = (digits.lstrip("0") for digits in parts[1::2])
    return tuple((len(part) if k % 2 else 0, part) for k, part in enumerate(parts))


def grouped(value: Number) -> str:
    """Exact text with thousands set apart: "58,000,000", "1,000.5", "1/3"."""
    sign, digits, rest = re.fullmatch(r"(-?)(\d+)(.*)", format_number(value)).groups()  # type: ignore[union-attr]
    return f"{sign}{int(digits):,}{rest}"


def with_unit(value: Number, unit: str) -> str:
    """ "1,000 min"."""
    return f"{grouped(value)} {unit}"


UNITS = (("d", 86_400), ("h", 3600), ("min", 60), ("s", 1))
SECONDS = dict(UNITS)


def seconds_in(unit: str) -> Fraction | None:
    """None where it is not known for certain: a month has as many days as its task says."""
    fewest, most = unit_seconds(unit, 28), unit_seconds(unit, 31)
    return fewest if fewest == most else None


def time_in_words(page: Page, value: Number, unit: str) -> str:
    """The exact value, and the same in greater units where they make it easier to grasp."""
    shown, seconds = with_unit(value, unit), seconds_in(unit)
    if seconds is None:
        return shown
    rest: Number = value * seconds
    parts: list[tuple[int, str]] = []
    for name, length in UNITS:
        if parts or rest >= length:
            parts.append((int(rest // length), name))
            rest %= length
    if not parts or seconds >= SECONDS[parts[0][1]]:
        return shown
    told = [f"{number} {name}" for number, name in parts if number]
    if rest or len(told) > 3:
        return f"{shown} ({page.glyphs.about}{' '.join(told[:2])})"
    return f"{shown} ({' '.join(told)})"
