"""Planners for PDDL2.1 text, each in a child process, and the portfolio of those that are here.

A planner's own times and its claims of optimality are never used: its plan is read for choices
and order, re-timed exactly, and called optimal only where the makespan meets a bound that irc
has computed.
"""

from __future__ import annotations

import os
import re
import shutil
import sys
import tempfile
import time
from abc import abstractmethod
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from importlib.util import find_spec
from pathlib import Path
from typing import Any, ClassVar

from irc.backend import (
    Engine,
    EngineFailed,
    EngineMissing,
    Limits,
    OnProgress,
    Outcome,
    Program,
    Progress,
    Refusal,
)
from irc.diagnostics import Code, Diagnostic
from irc.horizon import safe_horizon
from irc.problem import Problem
from irc.process import CommandNotFound, Ended, ProcessLimits, ProcessResult, run
from irc.retime import AnswerError
from irc.schedule import Schedule, Status
from irc_pddl21.decode import best_of
from irc_pddl21.encode import DOMAIN_FILE, EPSILON, PROBLEM_FILE, encode, names_of
from irc_pddl21.plan_reader import read_plans

DEFAULT_SECONDS = 60.0
"""The time limit where none is given: these planners search on after their best plan."""

DEFAULT_MEMORY_MB = 8192

OPTIC_LARGEST = Fraction(2_147_483_647, 1000)
"""OPTIC keeps time in 32-bit milliseconds."""

KAIROS_LARGEST = 10**13
"""kairos keeps time in doubles, which soon after this lose its epsilon; it then finds nothing."""

ARIES_EPSILON = Fraction(1, 10)
ARIES_LARGEST = 100_000_000
"""aries counts tenths of a unit in 32 bits."""

_STEP = re.compile(r"\s*\d+(?:\.\d+)?\s*:\s*\(")


@dataclass(frozen=True, slots=True)
class _Job:
    """What a planner works on: two files, what their names mean, when to stop.

    `first_plan` asks for any plan, as when the files hold the bound as a deadline.
    """

    problem: Problem
    names: Mapping[str, Any]
    domain: Path
    problem_file: Path
    limits: Limits
    seconds: float
    first_plan: bool

    @property
    def target(self) -> Fraction:
        """A plan of this length (planner time) re-times to the bound; half a tick is for drift."""
        scale: int = self.names["planner_units_per_tick"]
        return (self.problem.bound.value + Fraction(1, 2)) * scale


class _Watcher:
    """Follows a planner's output, re-times each plan as it ends, stops at the bound."""

    def __init__(self, job: _Job, engine: str, on_progress: OnProgress | None) -> None:
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
        try:
            schedule = best_of(self.job.problem, self.job.names, read_plans(block))
        except AnswerError:
            return False  # Told at the end, from the whole output, if nothing better comes.
        if self.best is not None and schedule.makespan >= self.best.makespan:
            return False
        self.best = schedule
        ticks = int(schedule.makespan / self.job.problem.tick)
        if self.on_progress is not None:
            seconds = time.perf_counter() - self.began
            bound = self.job.problem.bound.value
            self.on_progress(Progress(seconds, ticks, bound, self.engine))
        return ticks <= self.job.problem.bound.value


class Planner(Engine):
    """A planner that reads two PDDL files and prints plans."""

    epsilon: ClassVar[Fraction] = EPSILON

    bound_share: ClassVar[float] = 0.25
    """Of the time limit, for a first plan under the deadline "makespan = bound"."""

    @abstractmethod
    def command(self, job: _Job) -> list[str]:
        """What to execute."""

    def environment(self, job: _Job) -> Mapping[str, str] | None:
        """The child's environment; None for this process's own."""
        return None

    def refuse(self, problem: Problem, scale: int) -> None:
        """Raises `Refusal` where the planner cannot hold the problem's numbers."""

    def solve(
        self, program: Program, limits: Limits, on_progress: OnProgress | None = None
    ) -> Outcome:
        """Runs the planner until it ends, its plan meets the bound, or time is over.

        Planners that minimise by themselves tend to stop just above the optimum and cannot prove
        anything, but they find *a* plan under a hard deadline quickly. So they are first asked
        for one that is as short as our lower bound; only without it do they minimise.
        """
        began = time.perf_counter()
        seconds = DEFAULT_SECONDS if limits.seconds is None else limits.seconds
        first: Outcome | None = None
        if self.bound_share and _bound_may_bind(program.problem):
            share = min(seconds, max(0.5, self.bound_share * seconds))
            at_bound = replace(program.problem, deadline=program.problem.bound.value)
            with suppress(EngineFailed):  # It is asked again below, and fails for good there.
                first = self._attempt(program, at_bound, limits, share, on_progress)
                if _proven(program.problem, first):
                    return first
        left = max(0.1, seconds - (time.perf_counter() - began))
        try:
            return _better(first, self._attempt(program, None, limits, left, on_progress))
        except EngineFailed:
            if first is None or first.schedule is None:
                raise
            return first

    def _attempt(
        self,
        program: Program,
        at_bound: Problem | None,
        limits: Limits,
        seconds: float,
        on_progress: OnProgress | None,
    ) -> Outcome:
        """One run: on the program's own files, or for a first plan of a tighter problem."""
        began = time.perf_counter()
        domain, problem_text, names = self._texts(program, at_bound)
        self.refuse(program.problem, names["planner_units_per_tick"])
        with tempfile.TemporaryDirectory(prefix="irc-", ignore_cleanup_errors=True) as folder:
            files = Path(folder, DOMAIN_FILE), Path(folder, PROBLEM_FILE)
            for path, text in zip(files, (domain, problem_text), strict=True):
                path.write_text(text, encoding="utf-8")
            left = max(0.1, seconds - (time.perf_counter() - began))
            job = _Job(program.problem, names, *files, limits, left, at_bound is not None)
            watcher = _Watcher(job, self.name, on_progress)
            result = self._run(job, watcher, Path(folder))
        return self._outcome(job, watcher, result, time.perf_counter() - began)

    def _texts(
        self, program: Program, at_bound: Problem | None
    ) -> tuple[str, str, Mapping[str, Any]]:
        if self.epsilon == EPSILON and at_bound is None:
            return program.files[DOMAIN_FILE], program.files[PROBLEM_FILE], program.names
        problem = at_bound or program.problem
        grounded = encode(problem, self.epsilon)
        text = grounded.encoding
        return text.domain_text(), text.problem_text(), names_of(grounded)

    def _run(self, job: _Job, watcher: _Watcher, folder: Path) -> ProcessResult:
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
        self, job: _Job, watcher: _Watcher, result: ProcessResult, seconds: float
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
            found = best_of(job.problem, job.names, log)
            if schedule is None or found.makespan < schedule.makespan:
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


def _bound_may_bind(problem: Problem) -> bool:
    """Whether a deadline at the bound would say more than the problem does."""
    if not problem.has_contention or not problem.bound.value:
        return False
    return problem.deadline is None or problem.deadline > problem.bound.value


def _last_line(text: str) -> str:
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    return lines[-1][:200] if lines else ""


def _why(result: ProcessResult, reason: str) -> str:
    if result.ended is Ended.TIMEOUT:
        return f"no usable plan within {result.seconds:.1f} s"
    if result.ended is Ended.OUTPUT_LIMIT:
        return "ended because it printed without end"
    return reason


class Optic(Planner):
    """OPTIC, an external command: `$IRC_OPTIC`, or `optic-clp` on PATH, or through planutils."""

    name: ClassVar[str] = "optic"

    def _found(self) -> list[str] | None:
        named = os.environ.get("IRC_OPTIC")
        if named:
            return [named] if shutil.which(named) else None
        for command in ("optic-clp", "optic-cplex", "optic"):
            path = shutil.which(command)
            if path is not None:
                return [path]
        planutils = shutil.which("planutils")
        if planutils and Path.home().joinpath(".planutils", "packages", "optic").is_dir():
            return [planutils, "run", "optic", "--"]
        return None

    def missing(self) -> str | None:
        """Why there is no OPTIC here."""
        if self._found() is not None:
            return None
        named = os.environ.get("IRC_OPTIC")
        if named:
            return f"the engine 'optic' is missing: $IRC_OPTIC names {named!r}, no such command"
        return (
            "the engine 'optic' is missing: put optic-clp on PATH or name it in $IRC_OPTIC "
            "(no package registry carries it), or use --engine kairos"
        )

    def command(self, job: _Job) -> list[str]:
        """OPTIC searches on after its first plan; the watcher stops it at the bound."""
        found = self._found()
        if found is None:
            raise EngineMissing(self.missing() or "the engine 'optic' is missing")
        first = ["-N"] if job.first_plan else []
        return [*found, *first, str(job.domain), str(job.problem_file)]

    def refuse(self, problem: Problem, scale: int) -> None:
        """OPTIC's 32-bit milliseconds must hold the shortest conceivable schedule, and each number
        in the files.
        """
        needed = problem.bound.value * scale + 2 * len(problem.activities) * EPSILON
        if needed > OPTIC_LARGEST:
            raise _beyond_optic("the schedule takes at least", problem.bound.value * scale)
        written = [a.duration_min for a in problem.activities]
        written += [d for i in range(len(written)) if (d := problem.effective_deadline(i))]
        if max(written, default=0) * scale > OPTIC_LARGEST:
            raise _beyond_optic("the task has times of up to", max(written) * scale)


def _beyond_optic(what: str, units: int) -> Refusal:
    return Refusal(
        f"{what} {units} planner time units, but OPTIC's clock ends at {float(OPTIC_LARGEST)}",
        hint="use --engine kairos, or target 'cpsat'",
    )


class Kairos(Planner):
    """The kairos planner (pip install kairos-planner), embedded."""

    name: ClassVar[str] = "kairos"

    def missing(self) -> str | None:
        """Why kairos cannot be imported, if it cannot."""
        if find_spec("kairos") is None:
            return (
                "the engine 'kairos' is missing: pip install kairos-planner "
                "(it has wheels for Linux only)"
            )
        return None

    def refuse(self, problem: Problem, scale: int) -> None:
        """The epsilon must not get lost in the shortest conceivable schedule."""
        if problem.bound.value * scale > KAIROS_LARGEST:
            raise Refusal(
                "the times of this task are beyond what kairos can tell apart",
                hint="use target 'cpsat'",
            )

    def command(self, job: _Job) -> list[str]:
        """The worker script, which loads nothing but kairos."""
        return [
            sys.executable,
            "-P",
            str(Path(__file__).with_name("kairos_worker.py")),
            str(job.domain),
            str(job.problem_file),
            f"{job.seconds:.3f}",
            str(job.limits.memory_mb or 0),
            str(float(job.target)),
            str(job.limits.workers or 1),
            str(job.limits.seed),
            "first" if job.first_plan else "best",
        ]


class Aries(Planner):
    """aries through unified-planning (pip install irc-compiler[up])."""

    name: ClassVar[str] = "aries"
    epsilon: ClassVar[Fraction] = ARIES_EPSILON
    bound_share: ClassVar[float] = 0.0

    def missing(self) -> str | None:
        """Why aries cannot be imported, if it cannot."""
        if find_spec("unified_planning") is None or find_spec("up_aries") is None:
            return "the engine 'aries' is missing: pip install 'irc-compiler[up]'"
        return None

    def command(self, job: _Job) -> list[str]:
        """The worker script."""
        return [
            sys.executable,
            "-P",
            str(Path(__file__).with_name("aries_worker.py")),
            str(job.domain),
            str(job.problem_file),
            f"{job.seconds:.3f}",
        ]

    def environment(self, job: _Job) -> Mapping[str, str]:
        """aries plans up to a horizon of 10,000 units unless told otherwise."""
        horizon = _planner_horizon(job.problem, job.names["planner_units_per_tick"])
        return {**os.environ, "ARIES_PLANNING_HORIZON": str(horizon)}

    def refuse(self, problem: Problem, scale: int) -> None:
        """aries' 32-bit tenths must hold the horizon."""
        if _planner_horizon(problem, scale) > ARIES_LARGEST:
            raise Refusal(
                "the times of this task are beyond aries' 32-bit clock",
                hint="use target 'cpsat'",
            )


def _planner_horizon(problem: Problem, scale: int) -> int:
    return (safe_horizon(problem) + 1) * scale + len(problem.activities)


class Portfolio(Engine):
    """One planner after another within one time limit, until the bound is met; the best is kept.

    OPTIC where there is one, else kairos; then aries; then kairos where OPTIC had its place, at
    once if OPTIC gave nothing.
    """

    name: ClassVar[str] = "auto"

    first_share = 0.6
    """Of the time limit, for the first planner while another is waiting."""

    def __init__(self, planners: tuple[Planner, ...]) -> None:
        self.planners = planners

    def missing(self) -> str | None:
        """Why none of them can run."""
        reasons = [planner.missing() for planner in self.planners]
        return None if None in reasons else "; ".join(r for r in reasons if r)

    def _lineup(self) -> list[Planner]:
        here = [p for p in self.planners if p.missing() is None]
        main = [p for p in here if p.name != Aries.name]
        return main[:1] + [p for p in here if p.name == Aries.name]

    def solve(
        self, program: Program, limits: Limits, on_progress: OnProgress | None = None
    ) -> Outcome:
        """The best answer of all; raises what the last planner raised if none answers."""
        began = time.perf_counter()
        total = DEFAULT_SECONDS if limits.seconds is None else limits.seconds
        best: Outcome | None = None
        notes: list[Diagnostic] = []
        trouble: Exception | None = None
        queue = self._lineup()
        fallback = [p for p in self.planners if p not in queue and p.missing() is None]
        while queue:
            planner = queue.pop(0)
            left = total - (time.perf_counter() - began)
            if left < 0.1:
                break
            share = left * self.first_share if queue or fallback else left
            try:
                outcome = planner.solve(program, replace(limits, seconds=share), on_progress)
            except (EngineFailed, EngineMissing, Refusal) as error:
                trouble = error
                notes.append(Diagnostic(Code.NO_ANSWER, f"{planner.name}: {error}"))
            else:
                notes += outcome.notes
                best = _better(best, outcome)
                if _proven(program.problem, best):
                    break
            if not queue or best is None or best.schedule is None:
                queue, fallback = fallback[:1] + queue, fallback[1:]
        if best is None:
            raise trouble or EngineFailed("no planner answered in time")
        return replace(best, notes=tuple(notes), seconds=time.perf_counter() - began)


def _better(old: Outcome | None, new: Outcome) -> Outcome:
    if old is None or old.schedule is None:
        return new
    if new.schedule is None or new.schedule.makespan >= old.schedule.makespan:
        return old
    return new


def _proven(problem: Problem, outcome: Outcome) -> bool:
    schedule = outcome.schedule
    return schedule is not None and schedule.makespan == problem.to_units(problem.bound.value)


def all_engines() -> Mapping[str, Engine]:
    """The engines of this target by name."""
    planners = (Optic(), Kairos(), Aries())
    return {"auto": Portfolio(planners), **{p.name: p for p in planners}}
