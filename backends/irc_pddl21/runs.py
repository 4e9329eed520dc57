"""One run of a planner in a child process: files in, the best plan out, re-timed.

A planner's own times and its claims of optimality are never used: its plan is read for choices
and order, re-timed exactly, and where there is state, stock or choice also validated before it
counts.
"""

from __future__ import annotations

import re
import tempfile
import time
from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

from irc.diagnostics import Code, Diagnostic
from irc.problem import Problem
from irc.problem.decisions import AnswerError
from irc.schedule import Schedule, Status
from irc.targets import (
    Engine,
    EngineFailed,
    EngineMissing,
    Limits,
    OnProgress,
    Outcome,
    Program,
    Progress,
)
from irc.targets.process import CommandNotFound, Ended, ProcessLimits, ProcessResult, run
from irc_pddl21.decode import Accept, best_of
from irc_pddl21.encode import DOMAIN_FILE, EPSILON, PROBLEM_FILE, encode
from irc_pddl21.grounded import names_of
from irc_pddl21.plan_reader import read_plans
from irc_pddl21.worth import worth_of

DEFAULT_SECONDS = 60.0
"""The time limit where none is given: these planners search on after their best plan."""

DEFAULT_MEMORY_MB = 8192

_LEAST_SECONDS = 0.1

_STEP = re.compile(r"\s*\d+(?:\.\d+)?\s*:\s*\(")


class Wish(NamedTuple):
    """What a planner is asked for.

    `problem` is what it reads: the program's own, or one with less choice or an earlier deadline.
    `first_plan`: any plan of it will do. A plan whose makespan is `enough` (ticks) ends the run.
    `search` is one of the planner's kinds of search, "" its usual one. `loose`: see
    `irc_pddl21.loose`.
    """

    problem: Problem
    first_plan: bool
    enough: int
    search: str = ""
    loose: bool = False


@dataclass(frozen=True, slots=True)
class Job:
    """What a planner works on: two files, what their names mean, when to stop."""

    wish: Wish
    program: Program
    names: Mapping[str, Any]
    domain: Path
    problem_file: Path
    limits: Limits
    seconds: float

    @property
    def target(self) -> Fraction:
        """A plan of this length (planner time) re-times to enough; half a tick is for drift."""
        scale: int = self.names["planner_units_per_tick"]
        return (self.wish.enough + Fraction(1, 2)) * scale


class _Watcher:
    """Follows a planner's output, re-times each plan as it ends, stops at the bound."""

    def __init__(self, job: Job, engine: str, on_progress: OnProgress | None) -> None:
        self.job = job
        self.engine = engine
        self.on_progress = on_progress
        self.began = time.perf_counter()
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

    def _take(self, block: str) -> bool:
        problem = self.job.program.problem
        try:
            log = read_plans(block)
            schedule = best_of(problem, self.job.names, log, accepted_by(self.job.program))
        except AnswerError:
            return False  # Told at the end, from the whole output, if nothing better comes.
        if self.best is not None and worth_of(problem, schedule) >= worth_of(problem, self.best):
            return False
        self.best = schedule
        ticks = int(schedule.makespan / problem.tick)
        if self.on_progress is not None:
            seconds = time.perf_counter() - self.began
            self.on_progress(Progress(seconds, ticks, problem.bound.value, self.engine))
        return ticks <= self.job.wish.enough


def accepted_by(program: Program) -> Accept | None:
    """The validator's word on a schedule; None where re-timing already leaves nothing to judge."""
    if program.judge is not None:
        return program.judge
    problem = program.problem
    if problem.is_plain and not problem.has_calendars:
        return None
    from irc.validation import validate

    def accept(schedule: Schedule) -> str | None:
        verdict = validate(program.task, schedule)
        return None if verdict.valid else "; ".join(v.message for v in verdict.violations[:2])

    return accept


class Planner(Engine):
    """A planner that reads two PDDL files and prints plans."""

    epsilon: ClassVar[Fraction] = EPSILON

    under_deadlines: ClassVar[bool] = True
    """Whether it finds plans under hard deadlines quickly."""

    searches: ClassVar[tuple[str, ...]] = ("",)
    """The kinds of search to try in turn where one plan is wanted."""

    @abstractmethod
    def command(self, job: Job) -> list[str]:
        """What to execute."""

    def environment(self, job: Job) -> Mapping[str, str] | None:
        """The child's environment; None for this process's own."""
        return None

    def refuse(self, problem: Problem, scale: int) -> None:
        """Raises `Refusal` where the planner cannot hold the problem's numbers."""

    def solve(
        self, program: Program, limits: Limits, on_progress: OnProgress | None = None
    ) -> Outcome:
        """The best answer this planner gives within the limits, by the strategy of the task."""
        from irc_pddl21.strategy import solve_with

        return solve_with(self, program, limits, on_progress)

    def attempt(
        self,
        program: Program,
        wish: Wish,
        limits: Limits,
        seconds: float,
        on_progress: OnProgress | None = None,
    ) -> Outcome:
        """One run. Raises `EngineFailed` where it breaks down without any plan."""
        began = time.perf_counter()
        domain, problem_text, names = self._texts(program, wish)
        self.refuse(program.problem, names["planner_units_per_tick"])
        with tempfile.TemporaryDirectory(prefix="irc-", ignore_cleanup_errors=True) as folder:
            files = Path(folder, DOMAIN_FILE), Path(folder, PROBLEM_FILE)
            for path, text in zip(files, (domain, problem_text), strict=True):
                path.write_text(text, encoding="utf-8")
            left = max(_LEAST_SECONDS, seconds - (time.perf_counter() - began))
            job = Job(wish, program, names, *files, limits, left)
            watcher = _Watcher(job, self.name, on_progress)
            result = self._run(job, watcher, Path(folder))
        return self._outcome(job, watcher, result, time.perf_counter() - began)

    def _texts(self, program: Program, wish: Wish) -> tuple[str, str, Mapping[str, Any]]:
        if self.epsilon == EPSILON and wish.problem is program.problem and not wish.loose:
            return program.files[DOMAIN_FILE], program.files[PROBLEM_FILE], program.names
        grounded = encode(wish.problem, self.epsilon, loose=wish.loose)
        text = grounded.encoding
        return text.domain_text(), text.problem_text(), names_of(grounded)

    def _run(self, job: Job, watcher: _Watcher, folder: Path) -> ProcessResult:
        memory = job.limits.memory_mb or DEFAULT_MEMORY_MB
        limits = ProcessLimits(seconds=job.seconds, memory_mb=memory)
        try:
            return run(
                self.command(job),
                limits,
                cwd=folder,
                env=self.environment(job),
                on_line=watcher,
            )
        except CommandNotFound as error:
            raise EngineMissing(str(error)) from None

    def _outcome(
        self, job: Job, watcher: _Watcher, result: ProcessResult, seconds: float
    ) -> Outcome:
        log = read_plans(result.stdout)
        damaged = [d for block in log.plans for d in block.damage]
        notes = [
            Diagnostic(
                Code.DAMAGED,
                f"{self.name} printed a damaged line ({d.reason}): {d.text[:80]!r}",
                hint="that plan was not used",
            )
            for d in damaged[:5]
        ]
        schedule, reason = watcher.best, ""
        try:
            problem = job.program.problem
            found = best_of(problem, job.names, log, accepted_by(job.program))
            if schedule is None or worth_of(problem, found) < worth_of(problem, schedule):
                schedule = found
        except AnswerError as error:
            reason = str(error)
        if schedule is not None:
            return Outcome(Status.FEASIBLE, self.name, schedule, 0, seconds, tuple(notes))
        if result.ended is Ended.EXITED and result.exit_code and not log.unsolvable:
            raise EngineFailed(
                f"{self.name} failed with exit status {result.exit_code}: "
                f"{_last_line(result.stderr) or _last_line(result.stdout) or 'no message'}"
            )
        if result.ended is Ended.SIGNALLED:
            raise EngineFailed(f"{self.name} was ended by signal {result.signal}")
        notes.append(Diagnostic(Code.NO_ANSWER, f"{self.name}: {_why(result, reason)}"))
        return Outcome(Status.UNKNOWN, self.name, None, 0, seconds, tuple(notes))


def _last_line(text: str) -> str:
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    return lines[-1][:200] if lines else ""


def _why(result: ProcessResult, reason: str) -> str:
    if result.ended is Ended.TIMEOUT:
        return f"no usable plan within {result.seconds:.1f} s"
    if result.ended is Ended.OUTPUT_LIMIT:
        return "ended because it printed without end"
    return reason
