"""Random tasks × backends × engines against brute force, and the suite for backends itself."""

from __future__ import annotations

import random
import re
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any, ClassVar

import pytest

from irc.driver.compile import check_task, compile_task
from irc.driver.solve import solve_task
from irc.model import Task
from irc.targets import Backend, Budget, EngineFailed, Program, SolveOptions, get_backend
from irc.targets.process import ProcessLimits, run
from irc.testing import CONFORMANCE_TASKS, ConformanceError, check_backend
from irc_cpsat import CpSat
from irc_cpsat.engines import OrTools
from irc_pddl21 import Pddl21, planners
from laws import answered, judged
from oracles.brute_force import optimal_makespan
from oracles.generators import big_capacity_task, contended_task, random_task

PLANNER_SECONDS = 5.0


def needs(engine: str) -> None:
    reason = get_backend("pddl21").engines()[engine].missing()
    if reason is not None:
        pytest.skip(reason)


def seeded(make: Callable[..., Task], name: str, count: int, **knobs: Any) -> Iterator[Task]:
    for seed in range(count):
        yield make(random.Random(f"{name} {seed}"), **knobs)


# --- CP-SAT: always the optimum -----------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("part", range(4))
def test_cp_sat_finds_and_proves_every_optimum(part: int) -> None:
    ends = Counter(
        answered(task, "cpsat", "ortools") for task in seeded(random_task, f"cpsat {part}", 50)
    )
    assert set(ends) <= {"optimal", "infeasible", "refused"}
    assert ends["optimal"] > 30
    assert ends["refused"] + ends["infeasible"] > 0


@pytest.mark.slow
def test_cp_sat_finds_and_proves_every_optimum_of_big_capacities() -> None:
    ends = Counter(
        answered(task, "cpsat", "ortools") for task in seeded(big_capacity_task, "big", 30)
    )
    assert set(ends) <= {"optimal", "infeasible", "refused"}


@pytest.mark.slow
def test_the_shortcut_says_what_cp_sat_says() -> None:
    taken = 0
    for task in seeded(random_task, "shortcut", 60, resources=(0, 2), tighten=0.0):
        quick = solve_task(task, SolveOptions(workers=1)).schedule
        assert judged(task, quick, optimal_makespan(task)) == "optimal"
        taken += quick.engine == "critical-path"
    assert 10 < taken < 60


# --- planners: valid, never below the optimum, never called optimal wrongly ---------------------


@pytest.mark.slow
@pytest.mark.parametrize("part", range(3))
def test_kairos_answers_are_valid_and_honest(part: int) -> None:
    needs("kairos")
    tasks = seeded(random_task, f"kairos {part}", 10, tighten=0.1 if part else 0.0)
    ends = Counter(answered(task, "pddl21", "kairos", PLANNER_SECONDS) for task in tasks)
    assert "infeasible" not in ends  # A planner's word is no proof.
    assert ends["optimal"] >= 7


@pytest.mark.slow
def test_kairos_answers_on_contended_tasks_are_valid_and_honest() -> None:
    needs("kairos")
    tasks = list(seeded(contended_task, "robots", 6, n=7))
    ends = Counter(answered(task, "pddl21", "kairos", PLANNER_SECONDS) for task in tasks)
    assert ends["optimal"] >= 4
    assert set(ends) <= {"optimal", "feasible", "unknown"}


@pytest.mark.slow
def test_big_capacities_are_answered_or_refused_with_a_reason() -> None:
    needs("kairos")
    tasks = seeded(big_capacity_task, "big", 30, actions=(2, 5))
    ends = Counter(answered(task, "pddl21", "kairos", 2.0) for task in tasks)
    assert ends["optimal"] + ends["feasible"] > 15
    assert "infeasible" not in ends


@pytest.mark.slow
def test_aries_answers_are_valid_and_honest() -> None:
    needs("aries")
    for task in seeded(random_task, "aries", 3, tighten=0.0, actions=(2, 4)):
        with suppress(EngineFailed):  # Its server can crash.
            assert answered(task, "pddl21", "aries", 3.0) != "infeasible"


@pytest.mark.optic
def test_optic_answers_are_valid_and_honest() -> None:
    tasks = seeded(random_task, "optic", 20, tighten=0.1)
    ends = Counter(answered(task, "pddl21", "optic", PLANNER_SECONDS) for task in tasks)
    assert "infeasible" not in ends
    assert ends["optimal"] + ends["feasible"] + ends["refused"] >= 15


# --- a second opinion on raw plans --------------------------------------------------------------

STEP = re.compile(r"^(\d+(?:\.\d+)?): \(([^)\s]+)\)(?: \[(\d+(?:\.\d+)?)\])?", re.MULTILINE)


def kairos_plan(program: Program, folder: Path) -> str:
    """The first plan that kairos itself prints for the program's files."""
    for name, text in program.files.items():
        (folder / name).write_text(text, encoding="utf-8")
    worker = Path(planners.__file__).with_name("kairos_worker.py")
    files = (str(folder / name) for name in ("domain.pddl", "problem.pddl"))
    command = [sys.executable, "-P", str(worker), *files, "5", "0", "-", "1", "0", "first"]
    return run(command, ProcessLimits(seconds=15)).stdout


@pytest.mark.slow
def test_unified_planning_accepts_the_raw_plans_on_the_emitted_text(tmp_path: Path) -> None:
    """Of tasks without counters: those it reads as intermediate conditions on numbers."""
    needs("kairos")
    pytest.importorskip("unified_planning")
    from unified_planning.engines.plan_validator import TimeTriggeredPlanValidator
    from unified_planning.environment import get_environment
    from unified_planning.io import PDDLReader
    from unified_planning.plans import ActionInstance, TimeTriggeredPlan

    get_environment().credits_stream = None
    accepted = 0
    for task in seeded(random_task, "raw", 14, tighten=0.0, actions=(3, 6)):
        if not check_task(task).ok:
            continue
        program = compile_task(task, "pddl21")
        assert ":fluents" not in program.files["domain.pddl"]
        steps = STEP.findall(kairos_plan(program, tmp_path))
        if not steps:
            continue
        problem = PDDLReader().parse_problem(
            str(tmp_path / "domain.pddl"), str(tmp_path / "problem.pddl")
        )
        plan = TimeTriggeredPlan(
            [
                (
                    Fraction(at),
                    ActionInstance(problem.action(name)),
                    Fraction(lasts) if lasts else None,
                )
                for at, name, lasts in steps
            ],
            problem.environment,
        )
        with TimeTriggeredPlanValidator() as validator:
            verdict = validator.validate(problem, plan)
        assert verdict, (task, verdict.reason, verdict.log_messages)
        accepted += 1
    assert accepted >= 10


# --- the suite for other people's backends ------------------------------------------------------


def test_cp_sat_passes_the_conformance_suite() -> None:
    assert check_backend(CpSat()) == len(CONFORMANCE_TASKS)


def test_the_conformance_tasks_have_the_optima_they_say() -> None:
    for case in CONFORMANCE_TASKS:
        try:
            best = optimal_makespan(case.task)
        except ValueError:
            continue  # Beyond brute force: fractions of a second, or features for other tests.
        assert best == case.optimum, case.name


class Forgetful(CpSat):
    """A backend whose engine is given a problem without some of its parts."""

    name: ClassVar[str] = "forgetful"

    def __init__(self, **nothing: Any) -> None:
        self.nothing = nothing

    def engines(self) -> Any:
        nothing = self.nothing

        class Dropping(OrTools):
            def solve(self, program: Program, options: SolveOptions, budget: Budget) -> Any:
                less = replace(program.problem, **nothing)
                return super().solve(replace(program, problem=less), options, budget)

        return {"ortools": Dropping()}


@pytest.mark.parametrize("nothing", [{"arcs": ()}, {"deadline": None}])
def test_the_conformance_suite_finds_a_backend_that_drops_something(
    nothing: dict[str, Any],
) -> None:
    with pytest.raises(ConformanceError):
        check_backend(Forgetful(**nothing), seconds=1.0)


@pytest.mark.parametrize("backend", [CpSat(), Pddl21()], ids=["cpsat", "pddl21"])
def test_backends_say_what_they_support_and_have_a_default_engine(backend: Backend) -> None:
    assert backend.supports
    assert "auto" in backend.engines()
    assert type(get_backend(backend.name)) is type(backend)
