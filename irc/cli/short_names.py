"""Names cut to a width so that no two of them become the same text."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping

from rich.cells import cell_len

from irc.cli.page import Page

_SHARES = ((2, 3), (1, 2), (1, 3), (0, 1))
"""The parts of the room that the beginning of a name gets, the first choice first."""


class ShortNames:
    """Cuts the texts of one set. Where their ends do not tell them apart, they get numbers.

    A number stands behind the mark of the cut; `Page.key` has the full names.
    """

    def __init__(self, page: Page, texts: Iterable[str]) -> None:
        self.page = page
        self.texts = list(dict.fromkeys(texts))
        self._cut: dict[int, Mapping[str, str]] = {}

    def fit(self, text: str, width: int) -> str:
        """At most `width` cells of a text of the set, which no other text of it becomes."""
        if cell_len(text) <= width:
            return text
        if width not in self._cut:
            self._cut[width] = self._all(width)
        return self._cut[width].get(text) or self.page.fit(text, width)

    def _all(self, width: int) -> dict[str, str]:
        """All texts, each cut in the first way that sets it apart."""
        found = {text: text for text in self.texts if cell_len(text) <= width}
        left = [text for text in self.texts if text not in found]
        for share in _SHARES:
            cut = {text: self.page.fit(text, width, share) for text in left}
            times = Counter([*found.values(), *cut.values()])
            found |= {text: short for text, short in cut.items() if times[short] == 1}
            left = [text for text in left if text not in found]
        taken = set(found.values())
        for text in left:
            number = f"{self.page.glyphs.more}[{self.page.number(text)}]"
            short = self.page.beginning(text, width - len(number)) + number
            while short in taken and len(short) > len(number):
                short = short[1:]
            found[text] = short
            taken.add(short)
        return found
