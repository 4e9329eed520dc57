"""How a target answers a small task, judged by the exact optimum of the oracle."""

from __future__ import annotations

from typing import Any

from pydantic import ValidationError

from irc.diagnostics import InputError
from irc.driver.solve import solve_task
from irc.model import Task
from irc.schedule import Schedule, Status
from irc.targets import SolveOptions
from irc.validation import validate
from oracles.exhaustive import TooHardError, Vector, best_of
from oracles.shrinking import shrunk


def verdict(document: dict[str, Any], target: str, seconds: float, *, shortcut: bool = True) -> str:
    """In a few words how the answer was; it begins with "wrong" or "crash" where that is a fault.

    An answer "unknown", or one that is not the best, is no fault of a target that proves nothing.
    What the oracle finds too hard is judged by the validator alone. A refusal is named by its
    codes.
    """
    try:
        task = Task.model_validate(document)
    except ValidationError:
        return "not judged: no task"
    known, best = True, None
    try:
        best = best_of(task)
    except TooHardError:
        known = False
    except (LookupError, ValueError):
        return "not judged: no task"
    try:
        options = SolveOptions(target, time_limit=seconds, workers=1, shortcut=shortcut)
        schedule = solve_task(task, options).schedule
    except InputError as refusal:
        codes = {d.code.id for d in refusal.report.errors}
        return _refused(codes, best) if known else "refused, too hard for the oracle"
    except Exception as error:  # noqa: BLE001  (a fuzzer looks for all of them)
        return f"crash: {type(error).__name__}: {error}"
    return _judged(task, schedule, best) if known else _only_validated(task, schedule)


def _only_validated(task: Task, schedule: Schedule) -> str:
    if not schedule.answered:
        return f"{schedule.status}, too hard for the oracle"
    if not validate(task, schedule).valid:
        return "wrong: not valid"
    return "valid, too hard for the oracle"


def _refused(codes: set[str], best: Vector | None) -> str:
    if codes <= {"IRC501"}:
        return "not supported"
    if not all(code.startswith("IRC3") for code in codes):
        return f"refused by {', '.join(sorted(codes))}"
    return "infeasible, by the checks" if best is None else f"wrong: refused by {sorted(codes)}"


def _judged(task: Task, schedule: Schedule, best: Vector | None) -> str:
    """The verdict on an answer of an engine."""
    if schedule.status is Status.UNKNOWN:
        return "unknown" if best is not None else "unknown, and there is none"
    if schedule.status is Status.INFEASIBLE:
        return "infeasible" if best is None else "wrong: called infeasible"
    if best is None:
        return "wrong: a schedule where there is none"
    if not validate(task, schedule).valid:
        return "wrong: not valid"
    signs = [-1 if o.name == "reward" else 1 for o in schedule.objective]
    values = [s * o.value for s, o in zip(signs, schedule.objective, strict=True)]
    least = [s * v for s, v in zip(signs, best, strict=True)]
    if values < least:
        return f"wrong: {values} is better than the best, {least}"
    for sign, level, value, right in zip(signs, schedule.objective, values, least, strict=True):
        if level.bound is not None and sign * level.bound > right:
            return f"wrong: {level.name} can be {right}, below its bound {level.bound}"
        if value != right:
            break
    if values == least:
        return str(schedule.status)
    if schedule.status is Status.OPTIMAL:
        return f"wrong: {values} is called optimal, and {least} is better"
    return "not the best"


def is_fault(said: str) -> bool:
    """Whether a verdict is on something that must not happen."""
    return said.startswith(("wrong", "crash"))


def smallest(
    document: dict[str, Any], target: str, seconds: float, *, shortcut: bool = True
) -> dict[str, Any]:
    """A smaller document with a fault of the same kind."""
    kind = verdict(document, target, seconds, shortcut=shortcut).split(":")[0]

    def fails(smaller: Any) -> bool:
        if not isinstance(smaller, dict):
            return False
        return verdict(smaller, target, seconds, shortcut=shortcut).startswith(kind)

    found: dict[str, Any] = shrunk(document, fails, most=300)
    return found
