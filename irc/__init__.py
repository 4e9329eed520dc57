"""irc: a solver-neutral compiler for asynchronous tasks.

>>> import irc
>>> task = irc.Task(actions=[{"id": "boil", "duration": "4 min"}, {"id": "eat", "duration": 60}],
...                 precedence=[["boil", "eat"]])
>>> irc.solve(task).makespan
300

Importing this package is cheap: what a call needs is loaded when it is called.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from irc._version import __version__

if TYPE_CHECKING:
    from irc.api import check, compile, explain, extract, load, loads, solve, validate
    from irc.diagnostics import Diagnostic, InputError, Report
    from irc.explanation import Explanation
    from irc.model import Task
    from irc.schedule import Schedule, Status

_HOMES = {
    "check": "irc.api",
    "compile": "irc.api",
    "explain": "irc.api",
    "extract": "irc.api",
    "load": "irc.api",
    "loads": "irc.api",
    "solve": "irc.api",
    "validate": "irc.api",
    "Diagnostic": "irc.diagnostics",
    "Explanation": "irc.explanation",
    "InputError": "irc.diagnostics",
    "Report": "irc.diagnostics",
    "Task": "irc.model",
    "Schedule": "irc.schedule",
    "Status": "irc.schedule",
}

__all__ = [
    "Diagnostic",
    "Explanation",
    "InputError",
    "Report",
    "Schedule",
    "Status",
    "Task",
    "__version__",
    "check",
    "compile",
    "explain",
    "extract",
    "load",
    "loads",
    "solve",
    "validate",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'irc' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted(__all__)
