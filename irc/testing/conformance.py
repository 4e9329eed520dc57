"""The conformance suite for backends: irc's own pass it, and so should those of third parties.

>>> from irc.testing import CONFORMANCE_TASKS
>>> [case.name for case in CONFORMANCE_TASKS][:2]
['one action', 'a chain']

A package that brings a backend calls `check_backend(MyBackend())` in its own tests, or
`python -m irc.testing TARGET`.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from enum import StrEnum

from irc.diagnostics import Code, InputError
from irc.driver.compile import lower_for
from irc.driver.judge import finish, validate_schedule
from irc.errors import IrcError
from irc.model import Task
from irc.schedule import Schedule, Status
from irc.targets import (
    Backend,
    Budget,
    Engine,
    EngineMissing,
    Outcome,
    Program,
    Refusal,
    SolveOptions,
    refused_features,
)
from irc.testing.cases import CONFORMANCE_TASKS, Case

PATIENCE = 10.0
"""Seconds after which an engine that has not solved a case fails it."""


class Kind(StrEnum):
    """How a case ended for an engine, or for the whole backend."""

    SOLVED = "solved"
    UNANSWERED = "unanswered"
    REFUSED = "refused"
    SKIPPED = "skipped"
    FAILED = "failed"


@dataclass(frozen=True)
class CaseResult:
    """The result of a case. `engine` is None where no engine was asked; `detail` says why."""

    case: str
    rule: str | None
    engine: str | None
    kind: Kind
    detail: str = ""

    def __str__(self) -> str:
        rule = "" if self.rule is None else f" (rule {self.rule})"
        engine = "" if self.engine is None else f", {self.engine}"
        return f"{self.case}{rule}{engine}: {self.detail or self.kind}"


@dataclass(frozen=True)
class ConformanceReport:
    """All results of a backend: cases that were solved, refused, skipped, failed."""

    target: str
    results: tuple[CaseResult, ...]

    def of(self, kind: Kind) -> tuple[CaseResult, ...]:
        """The results of one kind."""
        return tuple(result for result in self.results if result.kind is kind)

    def passes(self, *, strict: bool = False) -> bool:
        """Whether no case failed; if `strict`, also whether none was skipped, and one solved."""
        if self.of(Kind.FAILED):
            return False
        return not strict or bool(self.of(Kind.SOLVED) and not self.of(Kind.SKIPPED))

    def __str__(self) -> str:
        """The number of results of each kind, what failed, and why engines were skipped."""
        counts = Counter(result.kind for result in self.results)
        head = ", ".join(f"{counts[kind]} {kind}" for kind in Kind if counts[kind])
        lines = [f"target {self.target}: {head or 'no engine'}"]
        lines += [f"  failed: {result}" for result in self.of(Kind.FAILED)]
        missing = {(r.engine, r.detail): None for r in self.of(Kind.SKIPPED)}
        lines += [f"  skipped: {engine}: {why}" for engine, why in missing]
        return "\n".join(lines)


class ConformanceError(IrcError, AssertionError):
    """A backend that breaks the contract; the message says on which cases, which rules and how."""


def check_backend(backend: Backend, seconds: float = PATIENCE, *, strict: bool = False) -> int:
    """Runs every conformance task through a backend and all of its engines.

    Returns the number of (task, engine) pairs solved and validated. A task with a feature that the
    backend does not support must be refused. Raises `ConformanceError` where a case fails; if
    `strict`, also where an engine is missing, or nothing was solved.
    """
    report = conformance_report(backend, seconds)
    if not report.passes(strict=strict):
        raise ConformanceError(str(report))
    return len(report.of(Kind.SOLVED))


def conformance_report(
    backend: Backend,
    seconds: float = PATIENCE,
    cases: Iterable[Case] = CONFORMANCE_TASKS,
    engine: str | None = None,
) -> ConformanceReport:
    """The results of all cases, with all engines of a backend or with the one that is named."""
    results = [result for case in cases for result in _results(case, backend, seconds, engine)]
    return ConformanceReport(backend.name, tuple(results))


class _Fault(Exception):
    """A break of the contract, in words."""


def _results(
    case: Case, backend: Backend, seconds: float, wanted: str | None
) -> Iterator[CaseResult]:
    try:
        program = _program(case, backend)
    except _Refused as refused:
        yield CaseResult(case.name, case.rule, None, Kind.REFUSED, str(refused))
        return
    except _Fault as fault:
        yield CaseResult(case.name, case.rule, None, Kind.FAILED, str(fault))
        return
    for name, engine in backend.engines().items():
        if name == (wanted or name) and (name != "auto" or wanted):
            kind, detail = _asked(case, program, engine, seconds)
            yield CaseResult(case.name, case.rule, name, kind, detail)


class _Refused(Exception):
    """A documented refusal: by a feature, or by `irc.targets.Refusal`."""


def _program(case: Case, backend: Backend) -> Program:
    """The program of a case. Raises `_Refused` or `_Fault`."""
    refused = refused_features(case.task, backend)
    try:
        program = Program(backend, case.task, lower_for(case.task, backend))
    except InputError as error:
        if refused:
            raise _Refused(error.report.errors[0].message) from None
        raise _Fault(f"a supported task is not accepted: {error}") from None
    if refused:
        raise _Fault("a feature that the backend does not support was not refused")
    try:
        _check_encoding(case, program)
    except (Refusal, InputError) as error:
        raise _Refused(_refusal(error)) from None
    except _Fault:
        raise
    except Exception as error:
        raise _Fault(f"encode raises {_raised(error)}; to refuse, raise Refusal") from error
    return program


def _refusal(error: Refusal | InputError) -> str:
    """The message of a documented refusal. Raises `_Fault` for any other error of the input."""
    if isinstance(error, Refusal):
        if not str(error).strip():
            raise _Fault("a Refusal has no message")
        return str(error)
    codes = {d.code for d in error.report.errors}
    if codes <= {Code.UNSUPPORTED, Code.OUT_OF_RANGE}:
        return error.report.errors[0].message
    raise _Fault(f"a supported task is not accepted: {error}")


def _raised(error: Exception) -> str:
    return f"{type(error).__name__}: {error}"


def _check_encoding(case: Case, program: Program) -> None:
    turned = {
        key: list(reversed(value)) if isinstance(value, list) else value
        for key, value in reversed(case.document.items())
    }
    task = Task.model_validate(turned)
    again = Program(program.backend, task, lower_for(task, program.backend))
    if dict(again.files) != dict(program.files):
        raise _Fault("the files depend on the order of the input")
    if again.manifest_text() != program.manifest_text():
        raise _Fault("the manifest depends on the order of the input")
    json.loads(program.manifest_text())


def _asked(case: Case, program: Program, engine: Engine, seconds: float) -> tuple[Kind, str]:
    """How an engine ends on a case, and why."""
    budget = Budget(seconds)
    try:
        missing = engine.missing()
        if missing is not None:
            return Kind.SKIPPED, missing
        outcome = engine.solve(program, SolveOptions(time_limit=seconds, workers=1), budget)
        schedule = finish(case.task, program.problem, outcome, program.target, budget.elapsed)
        return _judged(case, program, outcome, schedule, seconds)
    except EngineMissing as error:
        return Kind.SKIPPED, str(error)
    except (Refusal, InputError) as error:
        try:
            return Kind.REFUSED, _refusal(error)
        except _Fault as fault:
            return Kind.FAILED, str(fault)
    except _Fault as fault:
        return Kind.FAILED, str(fault)
    except Exception as error:  # noqa: BLE001 - whatever the backend under test raises
        return Kind.FAILED, f"no schedule follows from the answer: {_raised(error)}"


def _judged(
    case: Case, program: Program, outcome: Outcome, schedule: Schedule, seconds: float
) -> tuple[Kind, str]:
    """How good an outcome is. Raises `_Fault` where it is wrong."""
    best = case.optimum
    if best is not None and program.problem.to_units(outcome.bound) > best:
        bound = program.problem.to_units(outcome.bound)
        raise _Fault(f"{bound} is called a lower bound, but the optimum is {best}")
    if outcome.schedule is None:
        return _without_schedule(best, schedule.status, seconds)
    verdict = validate_schedule(case.task, schedule)
    if not verdict.valid:
        raise _Fault("; ".join(f"breaks {violation}" for violation in verdict.violations))
    if best is None or schedule.makespan < best:
        raise _Fault(f"{schedule.makespan} beats the optimum {best}")
    if schedule.status is Status.OPTIMAL and schedule.makespan != best:
        raise _Fault(f"{schedule.makespan} is called optimal, but the optimum is {best}")
    return Kind.SOLVED, str(schedule.status)


def _without_schedule(best: int | None, status: Status, seconds: float) -> tuple[Kind, str]:
    if status is Status.INFEASIBLE and best is None:
        return Kind.SOLVED, str(status)
    if status is Status.UNKNOWN and (best is None or seconds < PATIENCE):
        return Kind.UNANSWERED, str(status)
    raise _Fault(f"the status is {status}, but the optimum is {best}")
