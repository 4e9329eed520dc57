"""Long lists of names in a message."""

from __future__ import annotations

from collections.abc import Sequence


def and_more(shown: Sequence[str], count: int, joint: str = ", ", last: str = " and ") -> str:
    """ "a, b and 7 more": the names shown, and how many of `count` are left."""
    text = joint.join(shown)
    more = count - len(shown)
    return f"{text}{last}{more:,} more" if more > 0 else text
