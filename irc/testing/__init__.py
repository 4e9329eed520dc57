"""The conformance suite for authors of backends; irc's own backends pass it.

>>> from irc.testing import CONFORMANCE_TASKS
>>> [case.name for case in CONFORMANCE_TASKS][:2]
['one action', 'a chain']
"""

from irc.testing.cases import CONFORMANCE_TASKS, Case
from irc.testing.conformance import (
    CaseResult,
    ConformanceError,
    ConformanceReport,
    Kind,
    check_backend,
    conformance_report,
)

__all__ = [
    "CONFORMANCE_TASKS",
    "Case",
    "CaseResult",
    "ConformanceError",
    "ConformanceReport",
    "Kind",
    "check_backend",
    "conformance_report",
]
