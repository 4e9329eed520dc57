"""The example of a backend in `examples/backends/minizinc`: its text, its answers, its refusals."""

from __future__ import annotations

import random
import shutil
import sys
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

import irc
from irc.driver.compile import lower_for
from irc.model import Task
from irc.problem.decisions import AnswerError
from irc.schedule import Entry, Schedule, Status
from irc.targets import Backend, Program, SolveOptions
from irc.testing import CONFORMANCE_TASKS, Kind, check_backend, conformance_report
from minizinc_subset import constraints_of, holds, read_data
from paths import ROOT

FOLDER = ROOT / "examples" / "backends" / "minizinc"


@pytest.fixture(scope="module")
def example() -> Iterator[ModuleType]:
    sys.path.insert(0, str(FOLDER))
    import irc_minizinc

    yield irc_minizinc
    sys.path.remove(str(FOLDER))


@pytest.fixture
def backend(example: ModuleType) -> Backend:
    made: Backend = example.MiniZinc()
    return made


def program_of(document: dict[str, Any], backend: Backend) -> Program:
    task = Task.model_validate(document)
    return Program(backend, task, lower_for(task, backend))


KITCHEN: dict[str, Any] = {
    "resources": [{"id": "oven"}, {"id": 'pan"\\(1)'}],
    "actions": [
        {"id": "bake; solve", "duration": 4, "uses": [{"resource": "oven"}]},
        {"id": "call", "duration": 0, "uses": [{"resource": "oven"}]},
        {"id": "fry", "duration": 3, "uses": [{"resource": "oven"}, {"resource": 'pan"\\(1)'}]},
        {"id": "rest", "duration": 2, "release": 5},
    ],
    "precedence": [
        {"before": "bake; solve", "after": "rest", "min_lag": -1},
        {"before": "call", "after": "fry", "min_lag": 2},
    ],
}

DATA = """\
jobs = 4;
horizon = 16;
duration = [4, 0, 3, 2];
release = [0, 0, 0, 5];
arcs = 2;
before = [1, 2];
after = [4, 3];
lag = [-1, 2];
machines = 1;
on = [{1, 3}];
"""


def test_the_data_of_a_task_are_numbers_and_no_text_of_it(
    example: ModuleType, backend: Backend
) -> None:
    program = program_of(KITCHEN, backend)
    assert program.files == {"model.mzn": example.MODEL, "data.dzn": DATA}
    assert program.manifest["names"] == {"jobs": ["bake; solve", "call", "fry", "rest"]}


def random_document(draw: random.Random) -> dict[str, Any]:
    names = "abc"[: draw.randint(2, 3)]
    actions = [
        {
            "id": name,
            "duration": draw.randint(0, 2),
            "release": draw.choice((0, 0, 1)),
            "uses": [{"resource": r} for r in ("oven", "pan") if draw.random() < 0.6],
        }
        for name in names
    ]
    arcs = [
        {"before": a, "after": b, "min_lag": draw.choice((-1, 0, 0, 1))}
        for a in names
        for b in names
        if a < b and draw.random() < 0.3
    ]
    return {
        "resources": [{"id": "oven"}, {"id": "pan"}],
        "actions": actions,
        "precedence": arcs,
    }


@pytest.mark.parametrize("seed", range(12))
def test_the_model_allows_what_the_rules_allow_and_nothing_else(
    seed: int, backend: Backend
) -> None:
    """Every start of every job up to 4 is judged by the text of the model and by the validator."""
    document = random_document(random.Random(seed))
    program = program_of(document, backend)
    constraints = constraints_of(program.files["model.mzn"])
    data = read_data(program.files["data.dzn"])
    allowed = 0
    for starts in product(range(5), repeat=data["jobs"]):
        start = dict(enumerate(starts, 1))
        makespan = max(start[j] + data["duration"][j] for j in start)
        in_model = holds(constraints, {**data, "start": start, "makespan": makespan})
        entries = tuple(
            Entry(
                a.id,
                program.problem.to_units(time),
                program.problem.to_units(time + a.duration_min),
                {use["resource"]: 1 for use in given["uses"]},
            )
            for a, time, given in zip(
                program.problem.activities, starts, document["actions"], strict=True
            )
        )
        verdict = irc.validate(document, Schedule(entries))
        assert in_model == verdict.valid, (document, starts, str(verdict))
        allowed += in_model
    assert allowed


@pytest.fixture
def command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A command `minizinc` that solves the subset."""
    path = tmp_path / "minizinc"
    script = ROOT / "tests" / "minizinc_subset.py"
    path.write_text(f'#!/bin/sh\nexec "{sys.executable}" "{script}"\n')
    path.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:/usr/bin:/bin")
    return path


@pytest.mark.skipif(sys.platform == "win32", reason="the command is a shell script")
def test_the_example_passes_the_conformance_suite(backend: Backend, command: Path) -> None:
    report = conformance_report(backend, 10.0)
    assert report.passes(strict=True), report
    assert len(report.of(Kind.SOLVED)) + len(report.of(Kind.REFUSED)) == len(CONFORMANCE_TASKS)
    assert len(report.of(Kind.SOLVED)) >= 11
    assert {result.detail for result in report.of(Kind.SOLVED)} == {"optimal"}
    refused = {result.case: result.detail for result in report.of(Kind.REFUSED)}
    assert refused["two at a time"].startswith("resource 'board' has capacity 2;")


@pytest.mark.skipif(shutil.which("minizinc") is None, reason="minizinc is not installed")
def test_the_example_passes_the_conformance_suite_with_minizinc_itself(backend: Backend) -> None:
    assert check_backend(backend, strict=True) >= 11


def test_without_the_command_every_case_is_skipped_and_counted(
    backend: Backend, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", "/nowhere")
    report = conformance_report(backend, 1.0)
    assert (report.passes(), report.passes(strict=True)) == (True, False)
    assert len(report.of(Kind.SKIPPED)) >= 11
    assert not report.of(Kind.SOLVED)
    assert "skipped: minizinc: the command 'minizinc' is not on PATH" in str(report)


def test_a_resource_for_two_is_refused_at_its_place(backend: Backend) -> None:
    document = {**KITCHEN, "resources": [{"id": "oven", "capacity": 2}, KITCHEN["resources"][1]]}
    with pytest.raises(irc.Refusal) as caught:
        program_of(document, backend).files  # noqa: B018
    assert caught.value.diagnostic.pointer == ("resources", 0, "capacity")
    huge = {"actions": [{"id": "a", "duration": 2**31}, {"id": "b", "duration": 1}]}
    with pytest.raises(irc.Refusal, match="its horizon is 2,147,483,649 ticks"):
        program_of(huge, backend).files  # noqa: B018


def test_the_last_solution_counts_and_a_broken_one_is_told(
    example: ModuleType, backend: Backend
) -> None:
    program = program_of(KITCHEN, backend)
    first = "job 1 3\njob 2 0\njob 3 7\njob 4 9\n----------\n"
    better = "job 1 0\njob 2 0\njob 3 4\njob 4 5\n----------\n"
    schedule = program.decode(first + better)
    assert [(e.id, e.start) for e in schedule] == [
        ("call", 0),
        ("bake; solve", 0),
        ("fry", 4),
        ("rest", 5),
    ]
    assert program.decode(first).makespan == 7, "re-timed in the order of the solution"
    for text in ("", "job 1 0\n", "job 1 0\n----------\n", "job 5 1\n" + better):
        with pytest.raises(AnswerError):
            program.decode(text)
    proven = example.outcome_of(program, f"{better}==========\n", 0, "")
    assert (proven.status, example.outcome_of(program, better, None, "").status) == (
        Status.OPTIMAL,
        Status.FEASIBLE,
    )
    unsatisfiable = example.outcome_of(program, "=====UNSATISFIABLE=====\n", 0, "")
    assert unsatisfiable.status is Status.INFEASIBLE
    assert example.outcome_of(program, "=====UNKNOWN=====\n", 0, "").status is Status.UNKNOWN
    with pytest.raises(irc.EngineFailed, match="type error"):
        example.outcome_of(program, "", 1, "type error")


@pytest.mark.skipif(sys.platform == "win32", reason="the command is a shell script")
def test_the_example_solves_through_its_engine_within_a_budget(
    example: ModuleType, backend: Backend, command: Path
) -> None:
    from irc.targets import Budget

    program = program_of(KITCHEN, backend)
    outcome = example.Command().solve(program, SolveOptions(seed=3), Budget(20))
    assert outcome.status is Status.OPTIMAL
    assert outcome.schedule.makespan == 7
