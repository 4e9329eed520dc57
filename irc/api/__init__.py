"""The Python API: in, tasks built in code or read; out, schedules, reports and explanations.

`calls` has the functions (`solve`, `check`, …), `task` and `elements` the classes to build with,
`event` the changes of a running task, `batches` many tasks at once, `running` what runs in the
background or is awaited. All of it is exported from `irc`.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from irc.api.batches import batch
    from irc.api.calls import (
        check,
        compile,
        explain,
        explain_lateness,
        extract,
        replan,
        simulate,
        solve,
        validate,
    )
    from irc.api.elements import Action, Group, Mode, Resource, StateVariable
    from irc.api.event import Event
    from irc.api.running import (
        Solving,
        aexplain,
        areplan,
        asimulate,
        asolve,
        asolve_iter,
        solve_iter,
        start,
    )
    from irc.api.task import Task, load, loads
    from irc.api.values import Between, between

_HOMES = {
    "batches": "batch",
    "calls": "check compile explain explain_lateness extract replan simulate solve validate",
    "elements": "Action Group Mode Resource StateVariable",
    "event": "Event",
    "running": "Solving aexplain areplan asimulate asolve asolve_iter solve_iter start",
    "task": "Task load loads",
    "values": "Between between",
}

__all__ = [
    "Action",
    "Between",
    "Event",
    "Group",
    "Mode",
    "Resource",
    "Solving",
    "StateVariable",
    "Task",
    "aexplain",
    "areplan",
    "asimulate",
    "asolve",
    "asolve_iter",
    "batch",
    "between",
    "check",
    "compile",
    "explain",
    "explain_lateness",
    "extract",
    "load",
    "loads",
    "replan",
    "simulate",
    "solve",
    "solve_iter",
    "start",
    "validate",
]


def __getattr__(name: str) -> Any:
    for module, names in _HOMES.items():
        if name in names.split():
            return getattr(import_module(f"irc.api.{module}"), name)
    raise AttributeError(f"module 'irc.api' has no attribute {name!r}")
