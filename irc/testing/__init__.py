"""The conformance suite for authors of backends; irc's own backends pass it.

>>> from irc.testing import CONFORMANCE_TASKS
>>> [case.name for case in CONFORMANCE_TASKS][:2]
['one action', 'a chain']
"""

from irc.testing.conformance import (
    CONFORMANCE_TASKS,
    Case,
    ConformanceError,
    check_backend,
)

__all__ = [
    "CONFORMANCE_TASKS",
    "Case",
    "ConformanceError",
    "check_backend",
]
