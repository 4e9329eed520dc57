"""Judges a planner's raw plan on the emitted PDDL, without irc's decoder."""

from __future__ import annotations

import re
import tempfile
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

from irc.driver.compile import compile_task
from irc.model import Task
from irc.targets import Program
from irc.targets.process import ProcessLimits, run

_STEP = re.compile(r"^\s*(\d+(?:\.\d+)?)\s*:\s*\(([^)\s]+)\)\s*(?:\[(\d+(?:\.\d+)?)\])?")


def raw_plan(program: Program, engine: str, folder: Path, seconds: float = 30.0) -> str:
    """The output of the engine for the program's two files, which are written into `folder`."""
    from irc.targets import SolveOptions
    from irc_pddl21.planners.kairos import KairosPlanner
    from irc_pddl21.planners.optic import OpticPlanner
    from irc_pddl21.planners.planner import PlannerInput, PlanRequest

    planners = {"auto": KairosPlanner(), "kairos": KairosPlanner(), "optic": OpticPlanner()}
    planner = planners[engine]
    for name, text in program.files.items():
        (folder / name).write_text(text, encoding="utf-8")
    given = PlannerInput(
        PlanRequest(program.problem, first_plan=True, enough=program.problem.bounds.makespan.value),
        program,
        program.names,
        folder / "domain.pddl",
        folder / "problem.pddl",
        SolveOptions(time_limit=seconds, workers=1),
        seconds,
    )
    return run(planner.command(given), ProcessLimits(seconds=seconds)).stdout


def last_plan(text: str) -> list[tuple[Fraction, str, Fraction]]:
    """The last block of steps in the text: start, name, duration."""
    blocks: list[list[tuple[Fraction, str, Fraction]]] = [[]]
    for line in text.splitlines():
        step = _STEP.match(line)
        if step:
            blocks[-1].append((Fraction(step[1]), step[2], Fraction(step[3] or 0)))
        elif blocks[-1]:
            blocks.append([])
    return next((block for block in reversed(blocks) if block), [])


def raw_plan_faults(task: Task, engine: str = "kairos") -> list[str]:
    """The faults of the raw plan: repeated or missing actions, precedence, validation."""
    program = compile_task(task, "pddl21")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        steps = last_plan(raw_plan(program, engine, folder))
        faults = _validator_faults(folder, steps)
    meaning = {n: m["action"] for n, m in program.names["actions"].items()}
    happened = {meaning[n]: (start, start + d) for start, n, d in steps if n in meaning}
    times = [n for _, n, _ in steps]
    if len(set(times)) != len(times):
        faults.append("an action is repeated")
    missing = {a.id for a in task.actions} - happened.keys()
    if missing:
        return [*faults, f"missing: {sorted(missing)[:3]}"]
    faults += [
        f"{e.before} before {e.after} is broken"
        for e in task.precedence
        if e.type == "finish-start" and happened[e.before][1] > happened[e.after][0]
    ]
    return faults


@cache
def _reader() -> Any:
    from unified_planning.environment import get_environment
    from unified_planning.io import PDDLReader

    get_environment().credits_stream = None
    return PDDLReader


def _validator_faults(folder: Path, steps: list[tuple[Fraction, str, Fraction]]) -> list[str]:
    """The verdict of unified-planning's time-triggered validator on the emitted files."""
    from unified_planning.engines.plan_validator import TimeTriggeredPlanValidator
    from unified_planning.plans import ActionInstance, TimeTriggeredPlan

    problem = _reader()().parse_problem(str(folder / "domain.pddl"), str(folder / "problem.pddl"))
    plan = TimeTriggeredPlan(
        [
            (start, ActionInstance(problem.action(name)), duration or None)
            for start, name, duration in steps
        ],
        problem.environment,
    )
    with TimeTriggeredPlanValidator() as validator:
        result = validator.validate(problem, plan)
    return [] if result else [f"validator: {result.reason} {result.log_messages}"]
