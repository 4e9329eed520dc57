"""A page of text on a console: its width, its characters, and the format of times.

Names are shown as data: they are never read as markup, control characters are made visible, and
characters that the console's encoding lacks are written as escapes.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable, Iterator
from fractions import Fraction
from os import environ
from typing import NamedTuple

from rich.cells import cell_len, set_cell_size
from rich.console import Console
from rich.text import Text

from irc.model.quantities import Number
from irc.model.times import format_number, unit_seconds

PIPED_WIDTH = 100
"""The number of columns if standard output is not a terminal and `COLUMNS` is not set."""


def answer_console() -> Console:
    """The console for standard output: a terminal's own width, else `COLUMNS`, else 100."""
    if sys.stdout.isatty() or "COLUMNS" in environ:
        return Console()
    return Console(width=PIPED_WIDTH)


def in_a_file() -> bool:
    """Whether standard output is no terminal: then nothing is left out for lack of room."""
    return not sys.stdout.isatty()


def print_lines(page: Page, console: Console, lines: Iterable[Text]) -> None:
    plain = not (console.is_terminal or console.record)
    for line in lines:
        line.truncate(page.width, overflow="crop")
        line.rstrip()
        if plain:  # (Without styles there is nothing for rich to do, which takes its time.)
            console.file.write(f"{line.plain}\n")
        else:
            console.print(line, soft_wrap=True)


class Kind(NamedTuple):
    """The characters and styles of one kind of bars; each character is one cell wide."""

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
    setup: Kind
    crowd: str
    closed: str
    pause: str
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
_YELLOW = ("yellow", "bold yellow")
_BLOCKS = Glyphs(
    critical=Kind("█", "▐", "▐", "◆", *_RED),
    slack=Kind("░", "▕", "▒", "◇", *_CYAN),
    setup=Kind("╌", "╌", "╌", "╌", *_YELLOW),
    crowd="▓",
    closed="·",
    pause="▁",
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
    setup=Kind("~", "~", "~", "~", *_YELLOW),
    crowd="%",
    closed=".",
    pause="_",
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
    """The width of the output, and the characters that its encoding has."""

    def __init__(self, console: Console) -> None:
        self.width = console.width
        self.encoding = console.encoding
        drawing = str(_BLOCKS)  # has every one of its characters
        self.glyphs = _BLOCKS if self._encodable(drawing) == drawing else _ASCII
        self._numbers: dict[str, int] = {}
        self.has_cut = False

    def number(self, name: str) -> int:
        """The number that stands for a name which is too long; the same each time."""
        return self._numbers.setdefault(name, len(self._numbers) + 1)

    def key(self) -> Iterator[str]:
        """A line for each number that stands for a name, with the name."""
        for name, number in self._numbers.items():
            yield f"{self.glyphs.more}[{number}] {name}"

    def beginning(self, text: str, width: int) -> str:
        """At most `width` cells of the beginning of a text."""
        return set_cell_size(text, max(width, 0)).rstrip()

    def _encodable(self, text: str) -> str:
        return text.encode(self.encoding, "backslashreplace").decode(self.encoding)

    def visible(self, name: str) -> str:
        """A name on one line, without characters that move the cursor, are invisible or that the
        encoding lacks.
        """
        if name.isascii() and name.isprintable() and name == name.strip():
            return name
        shown = self._encodable(
            "".join(c if c.isprintable() else _escape(c) for c in name if c not in _JOINERS)
        )
        return shown if shown == shown.strip() else f'"{shown}"'

    def fit(self, text: str, width: int, share: tuple[int, int] = (2, 3)) -> str:
        """At most `width` cells of a text: its two ends with a mark between them.

        The beginning gets the `share` of the room that is not needed for the mark.
        """
        if cell_len(text) <= width:
            return text
        self.has_cut = True
        room = width - len(self.glyphs.more)
        if room < 2:
            return set_cell_size(text, max(width, 0))
        last = room - (room * share[0] + share[1] - 1) // share[1]
        tail = ""
        for character in reversed(text):
            if cell_len(character + tail) > last:
                break
            tail = character + tail
        return set_cell_size(text, room - cell_len(tail)).rstrip() + self.glyphs.more + tail


_JOINERS = frozenset("\u200d\ufe0e\ufe0f")
"""Characters that join two glyphs to one; terminals differ in the width of such a glyph."""


def _escape(character: str) -> str:
    return character.encode("unicode_escape").decode("ascii")


_DIGITS = re.compile(r"(\d+)")


def natural(name: str) -> tuple[tuple[int, str], ...]:
    """A sort key that puts robot2 before robot10."""
    parts = _DIGITS.split(name)
    parts[1::2] = (digits.lstrip("0") for digits in parts[1::2])
    return tuple((len(part) if k % 2 else 0, part) for k, part in enumerate(parts))


def grouped(value: Number) -> str:
    """The exact text of a number with groups of thousands: "58,000,000", "1,000.5", "1/3"."""
    sign, digits, rest = re.fullmatch(r"(-?)(\d+)(.*)", format_number(value)).groups()  # type: ignore[union-attr]
    return f"{sign}{int(digits):,}{rest}"


def with_unit(value: Number, unit: str) -> str:
    """The text of a number with its unit: "1,000 min"."""
    return f"{grouped(value)} {unit}"


UNITS = (("d", 86_400), ("h", 3600), ("min", 60), ("s", 1))
SECONDS = dict(UNITS)


def seconds_in(unit: str) -> Fraction | None:
    """The seconds of a unit; None for a unit of several lengths, such as a month."""
    fewest, most = unit_seconds(unit, 28), unit_seconds(unit, 31)
    return fewest if fewest == most else None


def time_in_words(page: Page, value: Number, unit: str) -> str:
    """The text of a time, with the same time in larger units if they are easier to read."""
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
    words = [f"{number} {name}" for number, name in parts if number]
    if rest or len(words) > 3:
        return f"{shown} ({page.glyphs.about}{' '.join(words[:2])})"
    return f"{shown} ({' '.join(words)})"
