"""`irc prepare`: compiles local search before the first task that needs it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from irc.local_search.compiled import compile_now
from irc.targets import Budget

LOOPS: Mapping[str, str] = {
    "shops": "irc.local_search.tabu",
    "large shops": "irc.local_search.active_lists",
    "projects": "irc.local_search.genetic",
    "due dates, set-ups, calendars": "irc.local_search.lists",
}
"""The module with the loops of each search."""


def compile_searches() -> Iterator[tuple[str, float]]:
    """(name, seconds) of each search, as it is compiled."""
    for name, module in LOOPS.items():
        whole = Budget(math.inf)
        compile_now(module)
        yield name, whole.elapsed
