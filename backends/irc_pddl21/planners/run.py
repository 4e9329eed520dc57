"""One run of a planner in a child process: files in, the best plan out, re-timed.

A planner's own times and its word on optimality are never used: its plan is read for choices
and order, re-timed exactly, and where there is state, stock or choice also validated before it
counts.
"""

from __future__ import annotations

import re
import tempfile
from collections.abc import Mapping
from math import ceil
from pathlib import Path
from typing import Any

from irc.diagnostics import Code, Diagnostic
from irc.problem.decisions import AnswerError
from irc.problem.objective_values import schedule_values
from irc.schedule import Schedule, Status
from irc.targets import (
    Budget,
    EngineFailed,
    EngineMissing,
    ObjectiveLevel,
    Outcome,
    Program,
    Progress,
    SolveOptions,
)
from irc.targets.process import CommandNotFound, Ended, ProcessLimits, ProcessResult, run
from irc_pddl21.decoding.decode import Accept, best_of
from irc_pddl21.decoding.original import names_of_original, with_actions_of
from irc_pddl21.decoding.plan_log import PlanLog
from irc_pddl21.decoding.plan_reader import read_plans
from irc_pddl21.encoding.encode import DOMAIN_FILE, PROBLEM_FILE, encode
from irc_pddl21.encoding.grounded import names_of
from irc_pddl21.encoding.time_scale import EPSILON
from irc_pddl21.objective_values import objective_values
from irc_pddl21.planners.planner import LEAST_SECONDS, Planner, PlannerInput, PlanRequest

DEFAULT_MEMORY_MB = 8192

_STEP = re.compile(r"\s*\d+(?:\.\d+)?\s*:\s*\(")


def run_planner(
    planner: Planner,
    program: Program,
    request: PlanRequest,
    options: SolveOptions,
    budget: Budget,
) -> Outcome:
    """The outcome of one run, which gets `LEAST_SECONDS` even where the budget is over, unless it
    was cancelled.

    Raises `EngineFailed` where the planner breaks down without any plan, `Refusal` where it cannot
    hold the problem's numbers.
    """
    if budget.is_cancelled:
        return Outcome(Status.UNKNOWN, planner.name)
    domain, problem_text, names = _texts(planner, program, request)
    planner.refuse(program.problem, ceil(names["planner_units_per_tick"]))
    with tempfile.TemporaryDirectory(prefix="irc-", ignore_cleanup_errors=True) as folder:
        files = Path(folder, DOMAIN_FILE), Path(folder, PROBLEM_FILE)
        for path, text in zip(files, (domain, problem_text), strict=True):
            path.write_text(text, encoding="utf-8")
        left = max(LEAST_SECONDS, budget.left)
        given = PlannerInput(request, program, names, *files, options, left)
        watcher = _OutputWatcher(given, planner.name, budget)
        result = _run(planner, given, watcher, Path(folder))
    return _outcome(planner.name, given, watcher, result, budget.elapsed)


def _texts(
    planner: Planner, program: Program, request: PlanRequest
) -> tuple[str, str, Mapping[str, Any]]:
    original = program.task.original
    if request.original and original is not None:
        return original.domain, original.problem, names_of_original(program.problem)
    is_own = request.problem is program.problem and not (request.shortened or request.limits)
    if is_own and planner.epsilon == EPSILON:
        return program.files[DOMAIN_FILE], program.files[PROBLEM_FILE], program.names
    grounded = encode(
        request.problem, planner.epsilon, shortened=request.shortened, limits=request.limits
    )
    text = grounded.encoding
    return text.domain_text(), text.problem_text(), names_of(grounded)


def _run(
    planner: Planner, given: PlannerInput, watcher: _OutputWatcher, folder: Path
) -> ProcessResult:
    memory = given.options.memory_limit or DEFAULT_MEMORY_MB
    limits = ProcessLimits(seconds=given.seconds, memory_mb=memory)
    command, environment = planner.command(given), planner.environment(given)
    try:
        return run(
            command,
            limits,
            cwd=folder,
            env=environment,
            on_line=watcher,
            cancel=watcher.budget.cancel,
        )
    except CommandNotFound as error:
        raise EngineMissing(str(error)) from None


class _OutputWatcher:
    """Follows a planner's output, re-times each plan as it ends, stops at the bound."""

    def __init__(self, given: PlannerInput, engine: str, budget: Budget) -> None:
        self.given = given
        self.engine = engine
        self.budget = budget
        self.lines: list[str] = []
        self.best: Schedule | None = None

    def __call__(self, line: str) -> bool:
        if _STEP.match(line):
            self.lines.append(line)
            return False
        if not self.lines:
            return False
        block, self.lines = "\n".join(self.lines) + "\n", []
        return self._take(block)

    @property
    def pending(self) -> str:
        """The lines of the plan that has not ended yet."""
        return "".join(f"{line}\n" for line in self.lines)

    def _take(self, block: str) -> bool:
        problem = self.given.program.problem
        try:
            log = _read(self.given, block)
            schedule = best_of(problem, self.given.names, log, accepted_by(self.given.program))
        except AnswerError:
            return False  # Reported at the end, from the whole output, if nothing better comes.
        if not _is_better(self.given.program, schedule, self.best):
            return False
        self.best = schedule
        self._tell(schedule)
        return problem.whole_ticks(schedule.makespan) <= self.given.request.enough

    def _tell(self, schedule: Schedule) -> None:
        """Passes on a better plan, in the objectives of the program."""
        problem, on_progress = self.given.program.problem, self.given.options.on_progress
        if on_progress is None:
            return
        values = schedule_values(problem, schedule)
        least = problem.to_units(problem.bounds.makespan.value)
        first = problem.objectives[0]
        levels = tuple(
            ObjectiveLevel(name, values[name], least if name == first == "makespan" else None)
            for name in problem.levels
        )
        on_progress(Progress(self.budget.elapsed, self.engine, first, levels, lambda: schedule))


def accepted_by(program: Program) -> Accept | None:
    """The validator's judgement of a schedule; None where re-timing leaves nothing to judge."""
    if program.judge is not None:
        return program.judge
    problem = program.problem
    if problem.is_plain and not problem.has_calendars:
        return None
    from irc.validation import validate

    def accept(schedule: Schedule) -> str | None:
        judgement = validate(program.task, schedule)
        return None if judgement.valid else "; ".join(v.message for v in judgement.violations[:2])

    return accept


def _read(given: PlannerInput, text: str) -> PlanLog:
    """The plans of a text, with the names of the program's actions."""
    log, original = read_plans(text), given.program.task.original
    if not given.request.original or original is None:
        return log
    return with_actions_of(original, log)


def _is_better(program: Program, new: Schedule, old: Schedule | None) -> bool:
    if old is None:
        return True
    return objective_values(program.problem, new) < objective_values(program.problem, old)


def _outcome(
    engine: str,
    given: PlannerInput,
    watcher: _OutputWatcher,
    result: ProcessResult,
    seconds: float,
) -> Outcome:
    """The best schedule seen while the planner ran, or in what it printed last of all.

    (The last plan may have been cut short, and so not seen; where no plan could be used, the whole
    output is read again, for the reason. A call that was cancelled does without it.)
    """
    seen = watcher.best
    if seen is not None and result.ended is Ended.CANCELLED:
        return Outcome(Status.FEASIBLE, engine, seen, 0, seconds)
    log = _read(given, result.stdout if seen is None else watcher.pending)
    notes = _damage_notes(engine, log if seen is None else read_plans(result.stdout))
    schedule, reason = seen, ""
    try:
        problem = given.program.problem
        found = best_of(problem, given.names, log, accepted_by(given.program))
        if _is_better(given.program, found, schedule):
            schedule = found
    except AnswerError as error:
        reason = str(error)
    if schedule is not None:
        return Outcome(Status.FEASIBLE, engine, schedule, 0, seconds, tuple(notes))
    if result.ended is Ended.EXITED and result.exit_code and not log.unsolvable:
        raise EngineFailed(
            f"{engine} failed with exit status {result.exit_code}: "
            f"{_last_line(result.stderr) or _last_line(result.stdout) or 'no message'}"
        )
    if result.ended is Ended.SIGNALLED:
        raise EngineFailed(f"{engine} was ended by signal {result.signal}")
    notes.append(Diagnostic(Code.NO_ANSWER, f"{engine}: {_why(result, reason)}"))
    return Outcome(Status.UNKNOWN, engine, None, 0, seconds, tuple(notes))


def _damage_notes(engine: str, log: PlanLog) -> list[Diagnostic]:
    damaged = [d for block in log.plans for d in block.damage]
    return [
        Diagnostic(
            Code.DAMAGED,
            f"{engine} printed a damaged line ({d.reason}): {d.text[:80]!r}",
            hint="that plan was not used",
        )
        for d in damaged[:5]
    ]


def _last_line(text: str) -> str:
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    return lines[-1][:200] if lines else ""


def _why(result: ProcessResult, reason: str) -> str:
    if result.ended is Ended.CANCELLED:
        return f"no usable plan when it was ended, after {result.seconds:.1f} s"
    if result.ended is Ended.TIMEOUT:
        return f"no usable plan within {result.seconds:.1f} s"
    if result.ended is Ended.OUTPUT_LIMIT:
        return "ended because it printed without end"
    return reason
