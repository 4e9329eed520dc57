"""Target "minizinc": precedence and unit resources as a MiniZinc model, and its data beside it.

The model is always the same text; the data are a task. A job is an action, a machine a resource of
capacity 1. The engine is the `minizinc` command with its default solver; where it is not installed
the files can still be written, and the output of a solver read back by `irc extract`.
"""

from __future__ import annotations

import re
import shutil
import tempfile
from collections.abc import Iterable, Mapping
from math import isinf
from pathlib import Path
from typing import Any, ClassVar

from irc.model.features import Feature
from irc.problem import Problem
from irc.problem.decisions import AnswerError, Decision
from irc.retiming.retime import retime
from irc.retiming.to_schedule import schedule_of
from irc.schedule import Schedule, Status
from irc.targets import (
    Backend,
    Budget,
    Engine,
    EngineFailed,
    Outcome,
    Program,
    Refusal,
    SolveOptions,
)
from irc.targets.process import ProcessLimits, run

MODEL = """\
% Jobs with precedence on machines that do one job at a time; the data are in data.dzn.
int: jobs;                            % the number of jobs
int: horizon;                         % some best schedule has ended by then
array[1..jobs] of int: duration;
array[1..jobs] of int: release;
int: arcs;                            % job after[k] starts lag[k] after the end of before[k]
array[1..arcs] of int: before;
array[1..arcs] of int: after;
array[1..arcs] of int: lag;
int: machines;
array[1..machines] of set of int: on; % the jobs of each machine

array[1..jobs] of var 0..horizon: start;
var 0..horizon: makespan;

constraint forall (j in 1..jobs) (start[j] >= release[j]);
constraint forall (j in 1..jobs) (start[j] + duration[j] <= makespan);
constraint forall (k in 1..arcs) (
  start[after[k]] >= start[before[k]] + duration[before[k]] + lag[k]
);
constraint forall (m in 1..machines) (
  forall (i, j in on[m] where i < j) (
    start[i] + duration[i] <= start[j] \\/ start[j] + duration[j] <= start[i]
  )
);

solve minimize makespan;

output ["job \\(j) \\(fix(start[j]))\\n" | j in 1..jobs];
"""
"""The model. Interpolation in its strings is MiniZinc's own: no text of a task is ever in it."""

LARGEST = 2**31 - 1
"""Solvers of MiniZinc have at least 32-bit integers."""

SOLUTION, OPTIMAL, INFEASIBLE = "----------", "==========", "=====UNSATISFIABLE====="
_LINE = re.compile(r"job (\d{1,9}) (\d{1,18})")


class MiniZinc(Backend):
    """Precedence with minimum lags, releases, and resources that do one job at a time."""

    name: ClassVar[str] = "minizinc"
    supports: ClassVar[frozenset[Feature]] = frozenset(
        {
            Feature.ZERO_DURATION,
            Feature.PRECEDENCE,
            Feature.MIN_LAG,
            Feature.NEGATIVE_LAG,
            Feature.RELEASE,
            Feature.RESOURCES,
            Feature.PRESENCE_GOALS,
            Feature.MAKESPAN,
        }
    )

    def encode(self, problem: Problem) -> tuple[Mapping[str, str], Mapping[str, Any]]:
        """`model.mzn`, and `data.dzn`, in which job j is the j-th action, counted from 1."""
        _require_unit_resources(problem)
        horizon = _horizon(problem)
        if horizon > LARGEST:
            raise Refusal(
                f"its horizon is {horizon:,} ticks; this target has at most {LARGEST:,}",
                ("actions",),
                "write times in a larger unit",
            )
        names = {"jobs": [activity.id for activity in problem.activities]}
        return {"model.mzn": MODEL, "data.dzn": _data(problem, horizon)}, names

    def decode(self, problem: Problem, names: Mapping[str, Any], answer: str) -> Schedule:
        """The last solution in the output of a solver: lines "job 3 17", then ten hyphens."""
        start = _last_solution(answer, len(names["jobs"]))
        by_name = dict(zip(names["jobs"], start, strict=True))
        decisions = [
            Decision(by_name[a.id], by_name[a.id] + a.duration_min) for a in problem.activities
        ]
        return schedule_of(problem, retime(problem, decisions))

    def engines(self) -> Mapping[str, Engine]:
        """One engine, which is also the default."""
        engine = Command()
        return {"auto": engine, engine.name: engine}


def _require_unit_resources(problem: Problem) -> None:
    """Refuses resources of another capacity than 1 that actions use; names the first."""
    used = {use.alternatives[0] for activity in problem.activities for use in activity.uses}
    for k in sorted(used):
        resource = problem.resources[k]
        if resource.capacity != 1:
            raise Refusal(
                f"resource {resource.id!r} has capacity {resource.capacity}; "
                "this target has only resources of capacity 1",
                (*resource.origin, "capacity"),
                "give it capacity 1, or choose another target",
            )


def _horizon(problem: Problem) -> int:
    """A time by which some best schedule has ended: all jobs one after another, with all lags."""
    durations = sum(activity.duration_min for activity in problem.activities)
    lags = sum(max(0, arc.min_lag) for arc in problem.arcs)
    return durations + lags + max((a.release for a in problem.activities), default=0)


def _data(problem: Problem, horizon: int) -> str:
    activities, arcs = problem.activities, problem.arcs
    # A job that takes no time holds nothing (rule 4.2).
    on = [
        [
            j
            for j, activity in enumerate(activities, 1)
            if activity.duration_min > 0 and any(k in use.alternatives for use in activity.uses)
        ]
        for k in range(len(problem.resources))
    ]
    shared = [jobs for jobs in on if len(jobs) > 1]
    lines = {
        "jobs": str(len(activities)),
        "horizon": str(horizon),
        "duration": _array(a.duration_min for a in activities),
        "release": _array(a.release for a in activities),
        "arcs": str(len(arcs)),
        "before": _array(arc.before + 1 for arc in arcs),
        "after": _array(arc.after + 1 for arc in arcs),
        "lag": _array(arc.min_lag for arc in arcs),
        "machines": str(len(shared)),
        "on": "[" + ", ".join("{" + ", ".join(map(str, jobs)) + "}" for jobs in shared) + "]",
    }
    return "".join(f"{name} = {value};\n" for name, value in lines.items())


def _array(values: Iterable[int]) -> str:
    return f"[{', '.join(map(str, values))}]"


def _last_solution(answer: str, jobs: int) -> list[int]:
    """The start of each job in the last solution that is complete. Raises `AnswerError`."""
    solutions = answer.split(f"{SOLUTION}\n")[:-1]
    if not solutions:
        raise AnswerError("there is no solution in the text")
    start: dict[int, int] = {}
    for line in solutions[-1].splitlines():
        match = _LINE.fullmatch(line.strip())
        if match is not None:
            start[int(match[1])] = int(match[2])
    missing = [j for j in range(1, jobs + 1) if j not in start]
    if missing or len(start) != jobs:
        raise AnswerError(f"the solution has {len(start)} jobs of {jobs}")
    return [start[j] for j in range(1, jobs + 1)]


class Command(Engine):
    """The `minizinc` command, with its default solver."""

    name: ClassVar[str] = "minizinc"

    def missing(self) -> str | None:
        """The reason why it cannot run, or None."""
        if shutil.which("minizinc") is None:
            return "the command 'minizinc' is not on PATH: see https://www.minizinc.org"
        return None

    def solve(self, program: Program, options: SolveOptions, budget: Budget) -> Outcome:
        """The last solution within the time; `optimal` and `infeasible` are the solver's proofs."""
        limits = ProcessLimits(
            seconds=None if isinf(budget.left) else budget.left, memory_mb=options.memory_limit
        )
        with tempfile.TemporaryDirectory() as folder:
            for name, text in program.files.items():
                (Path(folder) / name).write_text(text, encoding="utf-8")
            command = ["minizinc", "--all-solutions", "--random-seed", str(options.seed)]
            ended = run([*command, "model.mzn", "data.dzn"], limits, cwd=Path(folder))
        return outcome_of(program, ended.stdout, ended.exit_code, ended.stderr)


def outcome_of(program: Program, output: str, exit_code: int | None, errors: str) -> Outcome:
    """The outcome that the output of the command says."""
    if INFEASIBLE in output:
        return Outcome(Status.INFEASIBLE, Command.name)
    if f"{SOLUTION}\n" not in output:
        if exit_code not in (0, None):
            raise EngineFailed(f"minizinc ended with {exit_code}: {errors.strip()[-300:]}")
        return Outcome(Status.UNKNOWN, Command.name)
    proven = any(line == OPTIMAL for line in output.splitlines())
    status = Status.OPTIMAL if proven else Status.FEASIBLE
    return Outcome(status, Command.name, program.decode(output))
