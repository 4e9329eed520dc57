"""irc: a solver-neutral compiler for asynchronous tasks.

>>> import irc
>>> task = irc.Task("breakfast", time_unit="min")
>>> stove = task.resource("stove")
>>> boil = task.action("boil", "4 min").uses(stove)
>>> fry = task.action("fry", irc.between(5, 8)).uses(stove)
>>> eat = task.action("eat", 10)
>>> [boil, fry] >> eat
Action('eat')
>>> irc.solve(task)["eat"].start
9

Importing this package is cheap: what a call needs is loaded when it is called.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from irc._version import __version__

if TYPE_CHECKING:
    from irc.api import (
        Action,
        Between,
        Event,
        Group,
        Mode,
        Resource,
        Solving,
        StateVariable,
        Task,
        aexplain,
        areplan,
        asimulate,
        asolve,
        asolve_iter,
        batch,
        between,
        check,
        compile,
        explain,
        explain_lateness,
        extract,
        load,
        loads,
        replan,
        simulate,
        solve,
        solve_iter,
        start,
        validate,
    )
    from irc.batches.result import BatchResult
    from irc.diagnostics import Code, Diagnostic, InputError, Report, Severity
    from irc.errors import IrcError, LibraryMissing, NameNotFound, OptionError
    from irc.events.apply import apply
    from irc.execution import Execution, ExecutionState, Simulation, Step, state_at
    from irc.explanation import Explanation, Lateness
    from irc.model.quantities import TimeError
    from irc.outcome import Outcome
    from irc.problem.decisions import AnswerError
    from irc.schedule import Entry, ObjectiveValue, Schedule, Status
    from irc.targets import (
        Cancellation,
        EngineFailed,
        EngineMissing,
        ObjectiveLevel,
        Program,
        Progress,
        Refusal,
        SolveOptions,
        UnknownTarget,
    )
    from irc.validation import Verdict, Violation

_HOMES = {
    "irc.api.batches": "batch",
    "irc.batches.result": "BatchResult",
    "irc.api.calls": (
        "check compile explain explain_lateness extract replan simulate solve validate"
    ),
    "irc.api.elements": "Action Calendar Group Mode Resource StateVariable",
    "irc.api.event": "Event",
    "irc.api.running": "Solving aexplain areplan asimulate asolve asolve_iter solve_iter start",
    "irc.api.task": "Task load loads",
    "irc.api.values": "Between between",
    "irc.targets": (
        "Cancellation EngineFailed EngineMissing ObjectiveLevel Program Progress Refusal "
        "SolveOptions UnknownTarget"
    ),
    "irc.diagnostics": "Code Diagnostic InputError Report Severity",
    "irc.errors": "IrcError LibraryMissing NameNotFound OptionError",
    "irc.explanation": "Explanation Lateness",
    "irc.outcome": "Outcome",
    "irc.events": "apply",
    "irc.execution": "Execution ExecutionState Simulation Step state_at",
    "irc.problem.decisions": "AnswerError",
    "irc.schedule": "Entry ObjectiveValue Schedule Status",
    "irc.model.quantities": "TimeError",
    "irc.validation": "Verdict Violation",
}
"""Where each public name is loaded from."""

__all__ = [
    "Action",
    "AnswerError",
    "BatchResult",
    "Between",
    "Cancellation",
    "Code",
    "Diagnostic",
    "EngineFailed",
    "EngineMissing",
    "Entry",
    "Event",
    "Execution",
    "ExecutionState",
    "Explanation",
    "Group",
    "InputError",
    "IrcError",
    "Lateness",
    "LibraryMissing",
    "Mode",
    "NameNotFound",
    "ObjectiveLevel",
    "ObjectiveValue",
    "OptionError",
    "Outcome",
    "Program",
    "Progress",
    "Refusal",
    "Report",
    "Resource",
    "Schedule",
    "Severity",
    "Simulation",
    "SolveOptions",
    "Solving",
    "StateVariable",
    "Status",
    "Step",
    "Task",
    "TimeError",
    "UnknownTarget",
    "Verdict",
    "Violation",
    "__version__",
    "aexplain",
    "apply",
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
    "state_at",
    "validate",
]


def __getattr__(name: str) -> Any:
    for module, names in _HOMES.items():
        if name in names.split():
            return getattr(import_module(module), name)
    raise AttributeError(f"module 'irc' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
