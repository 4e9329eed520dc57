"""Plans of an original PDDL problem: read, judged, re-timed, written; also by the commands."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import irc
from irc.diagnostics import InputError
from irc.frontends.importers.pddl import import_pddl
from irc.frontends.importers.pddl.plan import plan_text
from irc.frontends.importers.pddl.plan_reader import read_plan
from irc.model import Task
from irc_pddl21.decoding.plan_reader import read_plans
from paths import SHARED_DATA
from runs import run_irc

DOMAIN = """(define (domain d) (:types robot room)
  (:predicates (in ?r - robot ?a - room) (lit ?a - room) (seen ?a - room) (dark))
  (:durative-action move :parameters (?r - robot ?a ?b - room) :duration (= ?duration 5)
    :condition (at start (in ?r ?a))
    :effect (and (at start (not (in ?r ?a))) (at end (in ?r ?b))))
  (:durative-action look :parameters (?r - robot ?a - room) :duration (= ?duration 2)
    :condition (and (over all (in ?r ?a)) (at start (or (lit ?a) (dark))))
    :effect (at end (seen ?a)))
  (:durative-action light :parameters (?a - room) :duration (= ?duration 1)
    :condition (and) :effect (at end (lit ?a)))
  (:durative-action dim :parameters () :duration (= ?duration 1)
    :condition (and) :effect (at end (dark))))"""
PROBLEM = """(define (problem p) (:domain d) (:objects ann - robot den hall - room)
  (:init (in ann den)) (:goal (seen hall)))"""
PLAN = (
    "0.000: (move ann den hall)  [5.000]\n0.000: (dim)  [1.000]\n5.001: (look ann hall)  [2.000]\n"
)
PRINTS = {
    "a plan file": PLAN,
    "a planner's output": "; Plan found with metric 9\n0: (move ann den hall) [5]\n"
    "7: (dim) [1]\n9: (look ann hall) [2]\n; Plan found with metric 7.001\n" + PLAN,
    "unified-planning's print": "status: SOLVED_SATISFICING\nplan: TimeTriggeredPlan:\n"
    "    0.0: move(ann, den, hall) [5.0]\n    0.0: dim [1.0]\n    5.001: look(ann, hall) [2.0]\n",
    "upper case": PLAN.upper(),
}


def task() -> Task:
    return import_pddl((DOMAIN, "d.pddl"), (PROBLEM, "p.pddl"))


@pytest.mark.parametrize("kind", PRINTS)
def test_a_plan_becomes_a_schedule_with_its_own_times(kind: str) -> None:
    schedule = read_plan(PRINTS[kind], "plan", task())
    assert irc.validate(task(), schedule).valid
    assert [(e.id, float(e.start), float(e.end)) for e in schedule.entries] == [
        ("(move ann den hall)", 0, 5),
        ("(dim)", 0, 1),
        # The variant of `look` whose alternative holds.
        ("(look ann hall) #2", 5.001, 7.001),
    ]
    assert "(look ann hall) [2]" in plan_text(task(), schedule)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("no way", "there is no plan in the text"),
        ("0: (mvoe ann den hall) [5]", "the task has no action '(mvoe ann den hall)'"),
        ("0: (move ann hall attic) [5]", "the task has no action '(move ann hall attic)'"),
    ],
)
def test_what_is_no_plan_of_the_task_is_refused_with_its_line(text: str, message: str) -> None:
    with pytest.raises(InputError) as refused:
        read_plan(text, "plan", task())
    (found,) = refused.value.report.located()
    assert message in found.message
    assert found.line == 1


def files(folder: Path) -> list[Path]:
    paths = [folder / name for name in ("d.pddl", "p.pddl", "plan.txt")]
    for path, text in zip(paths, (DOMAIN, PROBLEM, PLAN), strict=True):
        path.write_text(text)
    return paths


def test_the_commands_take_a_domain_and_a_problem(tmp_path: Path) -> None:
    domain, problem, plan = files(tmp_path)
    result = run_irc("validate", domain, plan, "--problem", problem)
    assert (result.exit_code, "7001/1000" in result.stdout or "7.001" in result.stdout) == (0, True)
    result = run_irc("extract", domain, plan, "--problem", problem, "--format", "json")
    extracted = json.loads(result.stdout)
    assert (extracted["status"], extracted["makespan"]) == ("feasible", 7)
    plan.write_text(PLAN.replace("5.001", "4.001"))
    result = run_irc("validate", domain, plan, "--problem", problem)
    assert result.exit_code == 1
    result = run_irc("extract", domain, plan, "--problem", problem)
    assert (result.exit_code, "IRC602" in result.stderr) == (1, True)


@pytest.mark.slow
def test_a_task_from_pddl_is_solved_and_converted_on_the_command_line(tmp_path: Path) -> None:
    domain, problem, plan = files(tmp_path)
    result = run_irc("solve", domain, "--problem", problem, "--format", "json")
    assert json.loads(result.stdout)["makespan"] == 7
    schedule, back = tmp_path / "s.json", tmp_path / "back.txt"
    original = ("--domain", domain, "--problem", problem)
    assert run_irc("convert", plan, "--from", "pddl-plan", *original, "-o", schedule).exit_code == 0
    assert run_irc("convert", schedule, "--from", "schedule", *original, "-o", back).exit_code == 0
    assert ": (look ann hall) [2]" in back.read_text()
    result = run_irc("convert", plan, "--from", "pddl-plan", "-o", schedule)
    assert (result.exit_code, "--domain" in result.stderr) == (2, True)


def test_a_manifest_takes_plans_of_the_original_too(tmp_path: Path) -> None:
    domain, problem, plan = files(tmp_path)
    result = run_irc(
        "compile", domain, "--problem", problem, "-t", "pddl21", "-o", tmp_path / "out"
    )
    assert result.exit_code == 0
    result = run_irc("extract", tmp_path / "out" / "manifest.json", plan, "--format", "json")
    assert json.loads(result.stdout)["makespan"] == 7


def test_the_print_of_unified_planning_is_read_as_steps() -> None:
    text = "plan: TimeTriggeredPlan:\n    0.0: weld_frame [60.0]\n    60.001: move(a, b) [2.5]\n"
    plan = read_plans(text).best
    assert plan is not None
    assert [(s.name, s.args, float(s.start), float(s.duration or 0)) for s in plan.steps] == [
        ("weld_frame", (), 0.0, 60.0),
        ("move", ("a", "b"), 60.001, 2.5),
    ]


@pytest.mark.shared_data
def test_the_case_of_a_plan_of_the_original() -> None:
    cases = SHARED_DATA / "cases"
    result = run_irc(
        *("extract", cases / "move_d.pddl", cases / "move_popf_plan.txt"),
        *("--problem", cases / "move_p.pddl", "--format", "json"),
    )
    assert json.loads(result.stdout)["makespan"] == 5
    plan = read_plans((cases / "up_plan.txt").read_text()).best
    assert plan is not None
    assert len(plan.steps) == 6
