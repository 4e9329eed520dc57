"""A verdict for people: every violation, with its times by the clock where there are dates."""

from __future__ import annotations

from collections.abc import Iterator

from irc.model.dates import Dates, full
from irc.validation.verdict import Verdict, Violation

_MOST_TIMES = 4


def verdict_text(verdict: Verdict, dates: Dates | None) -> str:
    """The text of a verdict; with dates, a line below each violation says when it is."""
    text = str(verdict)
    if dates is None:
        return text
    said = {
        f"  {violation}": line
        for violation in (*verdict.violations, *verdict.carried)
        if (line := _moments(violation, dates))
    }
    return "\n".join(_with_moments(text.split("\n"), said))


def _with_moments(lines: list[str], said: dict[str, str]) -> Iterator[str]:
    for line in lines:
        yield line
        if line in said:
            yield f"    {said[line]}"


def _moments(violation: Violation, dates: Dates) -> str:
    """The times of a violation as dates, each once."""
    times = [time for time in dict.fromkeys(violation.times) if dates.reach(time)][:_MOST_TIMES]
    return ", ".join(full(dates.at(time)) for time in times)
