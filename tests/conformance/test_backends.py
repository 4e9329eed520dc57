"""Random tasks × backends × engines against brute force, and the suite for backends itself."""

from __future__ import annotations

import random
import re
import sys
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

from irc.driver.compile import check_task, compile_task, lower_for
from irc.driver.solve import solve_task
from irc.model import Task
from irc.passes.serial_sgs import quick_schedule
from irc.problem import Bounds, Problem
from irc.problem.decisions import Decision
from irc.retiming.retime import retime
from irc.retiming.to_schedule import schedule_of
from irc.schedule import Schedule, Status
from irc.targets import (
    Backend,
    Budget,
    EngineFailed,
    Outcome,
    Program,
    Refusal,
    SolveOptions,
    get_backend,
)
from irc.targets.process import ProcessLimits, run
from irc.testing import (
    CONFORMANCE_TASKS,
    ConformanceError,
    Kind,
    check_backend,
    conformance_report,
)
from irc.testing.__main__ import main as conformance
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
@pytest.mark.parametrize("part", range(2))
def test_cp_sat_finds_and_proves_every_optimum(part: int) -> None:
    ends = Counter(
        answered(task, "cpsat", "ortools") for task in seeded(random_task, f"cpsat {part}", 30)
    )
    assert set(ends) <= {"optimal", "infeasible", "refused"}
    assert ends["optimal"] > 18
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
    tasks = list(seeded(contended_task, "robots", 4, n=7))
    ends = Counter(answered(task, "pddl21", "kairos", PLANNER_SECONDS) for task in tasks)
    assert ends["optimal"] >= 2
    assert set(ends) <= {"optimal", "feasible", "unknown"}


@pytest.mark.slow
def test_big_capacities_are_answered_or_refused_with_a_reason() -> None:
    needs("kairos")
    tasks = seeded(big_capacity_task, "big", 15, actions=(2, 5))
    ends = Counter(answered(task, "pddl21", "kairos", 2.0) for task in tasks)
    assert ends["optimal"] + ends["feasible"] > 7
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
    for task in seeded(random_task, "raw", 8, tighten=0.0, actions=(3, 6)):
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
    assert accepted >= 5


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


def forget(problem: Problem, *what: str) -> dict[str, Any]:
    """The activities of a problem, or its arcs, without something."""
    if what[0] in ("min_lag", "max_lag"):
        value = 0 if what[0] == "min_lag" else None
        return {"arcs": tuple(replace(arc, **{what[0]: value}) for arc in problem.arcs)}
    none = {"release": 0}
    changed = (replace(a, **{name: none.get(name) for name in what}) for a in problem.activities)
    return {"activities": tuple(changed)}


FORGOTTEN: dict[str, tuple[str, Callable[[Problem], dict[str, Any]]]] = {
    "precedence": ("3.1", lambda p: {"arcs": ()}),
    "minimum lags": ("3.1", lambda p: forget(p, "min_lag")),
    "maximum lags": ("3.1", lambda p: forget(p, "max_lag")),
    "releases": ("2.3", lambda p: forget(p, "release")),
    "fixed starts": ("2.4", lambda p: forget(p, "start")),
    "deadlines": (
        "2.5",
        lambda p: {
            "activities": tuple(
                replace(a, deadline=None, effective_deadline=None) for a in p.activities
            ),
            "deadline": None,
        },
    ),
    "latest starts": ("2.6", lambda p: forget(p, "latest_start")),
    "the capacity": (
        "4.2",
        lambda p: {
            "contention": replace(
                p.contention, pools=tuple(replace(pool, capacity=99) for pool in p.contention.pools)
            )
        },
    ),
}


@pytest.mark.parametrize("what", FORGOTTEN)
def test_a_wrong_encoding_is_named_with_case_and_rule(what: str) -> None:
    rule, forgotten = FORGOTTEN[what]

    class Less(CpSat):
        def engines(self) -> Any:
            class Dropping(OrTools):
                def solve(self, program: Program, options: SolveOptions, budget: Budget) -> Any:
                    known = {"bounds": Bounds(), **forgotten(program.problem)}
                    less = replace(program.problem, **known)
                    outcome = super().solve(replace(program, problem=less), options, budget)
                    if outcome.schedule is None:
                        return outcome
                    return replace(outcome, schedule=redone(program.problem, outcome.schedule))

            return {"ortools": Dropping()}

    cases = [case for case in CONFORMANCE_TASKS if case.rule == rule]
    report = conformance_report(Less(), 5.0, cases)
    assert not report.passes()
    assert f"(rule {rule})" in str(report)
    named = {result.case for result in report.of(Kind.FAILED)}
    assert named <= {case.name for case in cases}


def test_a_backend_that_does_not_pass_raises_with_all_that_failed() -> None:
    with pytest.raises(
        ConformanceError, match=r"failed: .*\(rule 4.2\), ortools: 25 is called opt"
    ):
        check_backend(with_engine(first_answer), 5.0)


def with_engine(solve: Callable[[Program, SolveOptions, Budget], Outcome], **more: Any) -> Backend:
    """A backend with one engine of its own; `more` are methods of the engine."""

    class Asked(OrTools):
        def solve(self, program: Program, options: SolveOptions, budget: Budget) -> Outcome:
            return solve(program, options, budget)

    for name, method in more.items():
        setattr(Asked, name, method)
    return type("Other", (CpSat,), {"engines": lambda _: {"ortools": Asked()}})()


def first_answer(program: Program, *_: Any) -> Outcome:
    """Calls optimal what comes first: one action after the other, in the order of the task."""
    problem = program.problem
    found = quick_schedule(problem)
    decisions = [Decision(0, a.duration_min) for a in problem.activities]
    if found is not None:
        decisions = list(found[0])
    return Outcome(Status.OPTIMAL, "first", schedule_of(problem, retime(problem, decisions)))


def test_a_backend_that_calls_its_first_answer_optimal_is_caught() -> None:
    report = conformance_report(with_engine(first_answer), 5.0)
    failed = {result.case: result.detail for result in report.of(Kind.FAILED)}
    assert "is called optimal" in failed["the first order is never the best"]


RULES: dict[str, Callable[[Any, int, int], Any]] = {
    "by name": lambda a, head, tail: a.id,
    "by name, backwards": lambda a, head, tail: tuple(-ord(c) for c in a.id),
    "shortest first": lambda a, head, tail: a.duration_min,
    "longest first": lambda a, head, tail: -a.duration_min,
    "longest tail first": lambda a, head, tail: -tail,
    "earliest head first": lambda a, head, tail: head,
    "longest path first": lambda a, head, tail: -(head + a.duration_min + tail),
    "longest rest first": lambda a, head, tail: -(a.duration_min + tail),
}
MACHINES = {"a1": "mill", "a2": "mill", "b1": "saw", "b2": "saw", "c1": "lathe", "c2": "lathe"}


@pytest.mark.parametrize("at_once", [True, False])
@pytest.mark.parametrize("rule", RULES)
def test_no_usual_rule_finds_the_best_first_order(rule: str, at_once: bool) -> None:
    """Serial and parallel schedule generation with the usual priorities."""
    (case,) = (c for c in CONFORMANCE_TASKS if c.name == "the first order is never the best")
    problem = lower_for(case.task, CpSat())
    bounds = zip(problem.activities, problem.bounds.heads, problem.bounds.tails, strict=True)
    waiting = [a for a, _, _ in sorted(bounds, key=lambda known: RULES[rule](*known))]
    before: dict[str, set[str]] = {a.id: set() for a in waiting}
    for arc in problem.arcs:
        before[problem.activities[arc.after].id].add(problem.activities[arc.before].id)
    end: dict[str, int] = {}
    busy: dict[str, list[tuple[int, int]]] = defaultdict(list)
    while waiting:
        starts = []
        for a in (a for a in waiting if before[a.id] <= end.keys()):
            start = max((end[b] for b in before[a.id]), default=0)
            taken = busy[MACHINES.get(a.id, a.id)]
            while any(start < to and begin < start + a.duration_min for begin, to in taken):
                start += 1
            starts.append((start, a))
        start, chosen = min(starts, key=lambda s: s[0]) if at_once else starts[0]
        end[chosen.id] = start + chosen.duration_min
        busy[MACHINES.get(chosen.id, chosen.id)].append((start, end[chosen.id]))
        waiting.remove(chosen)
    assert case.optimum is not None
    assert max(end.values()) > case.optimum


def test_a_documented_refusal_is_a_result_and_not_a_crash() -> None:
    class Picky(CpSat):
        def encode(self, problem: Problem) -> Any:
            if len(problem.activities) > 2:
                raise Refusal("more than two actions", ("actions",))
            return super().encode(problem)

    report = conformance_report(Picky(), 5.0)
    assert report.passes(strict=True)
    assert len(report.of(Kind.REFUSED)) == sum(
        len(case.document["actions"]) > 2 for case in CONFORMANCE_TASKS
    )
    assert check_backend(Picky(), 5.0) == len(report.of(Kind.SOLVED))


def test_other_errors_and_wrong_claims_are_failures() -> None:
    class Broken(CpSat):
        def encode(self, problem: Problem) -> Any:
            raise KeyError("j7")

    report = conformance_report(Broken(), 1.0)
    assert len(report.of(Kind.FAILED)) == len(CONFORMANCE_TASKS)
    assert "encode raises KeyError: 'j7'; to refuse, raise Refusal" in str(report)

    def infeasible(*_: Any) -> Outcome:
        return Outcome(Status.INFEASIBLE, "x")

    assert "the status is infeasible, but the optimum is 5" in str(
        conformance_report(with_engine(infeasible), 1.0)
    )

    def bound(program: Program, *_: Any) -> Outcome:
        return Outcome(Status.UNKNOWN, "x", bound=10**9)

    assert "is called a lower bound, but the optimum is 5" in str(
        conformance_report(with_engine(bound), 1.0)
    )


def test_a_missing_engine_is_skipped_and_counted_and_fails_where_it_is_strict() -> None:
    absent = with_engine(first_answer, missing=lambda _: "pip install abacus")
    report = conformance_report(absent, 1.0)
    assert len(report.of(Kind.SKIPPED)) == len(CONFORMANCE_TASKS)
    assert str(report) == (
        f"target cpsat: {len(CONFORMANCE_TASKS)} skipped\n  skipped: ortools: pip install abacus"
    )
    assert (report.passes(), report.passes(strict=True)) == (True, False)
    assert check_backend(absent, 1.0) == 0
    with pytest.raises(ConformanceError, match="pip install abacus"):
        check_backend(absent, 1.0, strict=True)


def test_the_suite_is_a_command(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("IRC_OPTIC", raising=False)
    monkeypatch.setenv("PATH", "/nowhere")
    assert conformance(["cpsat", "--strict", "--verbose"]) == 0
    said = capsys.readouterr().out
    assert said.endswith(f"target cpsat: {len(CONFORMANCE_TASKS)} solved\n")
    assert "solved: a release that decides the order (rule 2.3), ortools: optimal\n" in said
    missing = ["pddl21", "--engine", "optic", "--seconds", "1"]
    assert conformance(missing) == 0
    assert conformance([*missing, "--strict"]) == 1
    assert conformance(["abacus"]) == 2


def redone(problem: Problem, schedule: Schedule) -> Schedule:
    """The schedule with the same decisions, re-timed for the whole problem as `decode` does it."""
    decisions = []
    for activity in problem.activities:
        entry = schedule[activity.id]
        start, end = (int(problem.to_ticks(time)) for time in (entry.start, entry.end))
        decisions.append(Decision(start, end))
    return schedule_of(problem, retime(problem, decisions))


@pytest.mark.parametrize("backend", [CpSat(), Pddl21()], ids=["cpsat", "pddl21"])
def test_backends_say_what_they_support_and_have_a_default_engine(backend: Backend) -> None:
    assert backend.supports
    assert "auto" in backend.engines()
    assert type(get_backend(backend.name)) is type(backend)
