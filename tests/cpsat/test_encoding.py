"""The CP-SAT model: right constraints, a complete hint, a text that any CP-SAT reads."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Iterator
from typing import Any

import pytest
from google.protobuf import text_format
from ortools.sat import cp_model_pb2
from ortools.sat.python import cp_model

from builders import EITHER, OVEN, Document, after_passes, kitchen_task, power, with_heads_and_tails
from irc.checks import run_checks
from irc.diagnostics import InputError
from irc.driver.compile import compile_task
from irc.model import Task
from irc.passes.serial_sgs import list_schedule
from irc.problem import Problem
from irc.problem.decisions import AnswerError
from irc.targets import Refusal
from irc.validation import validate
from irc_cpsat.encoding.builder import Model
from irc_cpsat.encoding.encode import MODEL_FILE, build_model
from oracles.brute_force import optimal_makespan
from oracles.generators import big_capacity_task, contended_task, hostile_names, random_task


def built(*actions: Document, **more: Any) -> Model:
    return build_model(
        with_heads_and_tails(kitchen_task(*actions, **more)), bounds=False, hints=False
    )


def solved(model: cp_model.CpModel, **parameters: Any) -> tuple[int, cp_model.CpSolver]:
    solver = cp_model.CpSolver()
    solver.parameters.num_workers = 1
    for name, value in parameters.items():
        setattr(solver.parameters, name, value)
    return solver.solve(model), solver


def kinds(model: Model) -> Counter[str]:
    """How often each kind of constraint stands in a model."""
    constraints = parsed(str(model.model.proto)).constraints
    return Counter(c.WhichOneof("constraint") for c in constraints)


def some_problems(count: int) -> Iterator[tuple[Task, Problem]]:
    """Lowered tasks that the checks accept, with all passes and with few."""
    for seed in range(count):
        rng = random.Random(f"cpsat {seed}")
        kinds = (random_task, big_capacity_task, lambda rng: contended_task(rng, 8))
        task = kinds[seed % 3](rng)
        if run_checks(task, lint=False).report.ok:
            yield task, after_passes(task) if seed % 2 else with_heads_and_tails(task)


# --- what becomes what --------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("actions", "no_overlaps", "cumulatives"),
    [
        ([OVEN, OVEN], 1, 0),
        ([power(1), power(1), power(1), power(1)], 0, 1),
        ([power(2), power(2)], 1, 0),
        ([power(2), power(1)], 0, 1),
        ([power(3), power(2)], 1, 0),
        ([EITHER, EITHER, EITHER], 2, 0),
        ([{}, {}], 0, 0),
        ([{**OVEN, "duration": 0}, {**OVEN, "duration": 0}], 0, 0),
    ],
)
def test_what_fits_only_once_must_not_overlap_and_the_rest_is_cumulative(
    actions: list[Document], no_overlaps: int, cumulatives: int
) -> None:
    found = kinds(built(*actions))
    assert (found["no_overlap"], found["cumulative"]) == (no_overlaps, cumulatives)


def test_a_choice_is_one_optional_interval_for_each_alternative() -> None:
    model = built(EITHER, EITHER)
    assert kinds(model)["exactly_one"] == 2
    constraints = parsed(str(model.model.proto)).constraints
    intervals = [c for c in constraints if c.WhichOneof("constraint") == "interval"]
    assert len(intervals) == 4
    assert all(len(c.enforcement_literal) == 1 for c in intervals)


@pytest.mark.parametrize("arc", ["finish-start", "start-start", "finish-finish", "start-finish"])
@pytest.mark.parametrize(("limit", "lag"), [("min_lag", 3), ("min_lag", -1), ("max_lag", 1)])
def test_each_precedence_type_binds_its_two_points(arc: str, limit: str, lag: int) -> None:
    edge = {"before": "a", "after": "b", "type": arc, "min_lag": -9, limit: lag}
    model = built({"duration": 3}, {"duration": 2}, {"duration": 20}, precedence=[edge])
    before, after = arc.split("-")
    for a in range(8):
        for b in range(8):
            trial = model.model.clone()
            trial.add(trial.get_int_var_from_proto_index(model.starts[0].index) == a)
            trial.add(trial.get_int_var_from_proto_index(model.starts[1].index) == b)
            gap = (b + 2 * (after == "finish")) - (a + 3 * (before == "finish"))
            kept = gap >= lag if limit == "min_lag" else -9 <= gap <= lag
            assert (solved(trial)[0] == cp_model.OPTIMAL) is kept


# --- zero lengths -------------------------------------------------------------------------------


MAYBE = {"duration": {"min": 0, "max": 3}, "start": 3}
LONG = {"duration": 6}


@pytest.mark.parametrize(
    ("actions", "makespan"),
    [
        # A milestone inside another's use does not split it.
        ([{**OVEN, **LONG}, {**OVEN, "duration": 0, "start": 3}], 6),
        # A range that may be empty makes room by being empty, on one of two robots too,
        ([{**OVEN, **LONG}, {**OVEN, **MAYBE}], 6),
        ([{**EITHER, **LONG}, {**EITHER, **LONG}, {**EITHER, **MAYBE}], 6),
        ([{**EITHER, **LONG}, {**EITHER, **LONG}, {**EITHER, "duration": MAYBE["duration"]}], 6),
        ([{**power(2), **LONG}, {**power(2), **MAYBE}], 6),
        ([{**power(3), **LONG}, {**power(9), **MAYBE}], 6),
        # but not where it has a length.
        ([{**OVEN, **LONG}, {**OVEN, "duration": {"min": 1, "max": 3}}], 7),
    ],
)
@pytest.mark.parametrize("help", [True, False])
def test_what_may_have_no_length_takes_no_room_when_it_has_none(
    actions: list[Document], makespan: int, help: bool
) -> None:
    problem = with_heads_and_tails(kitchen_task(*actions))
    model = build_model(problem, bounds=help, hints=help).model
    hinted = set(model.proto.solution_hint.vars)
    assert hinted in ({*range(len(model.proto.variables))}, set())
    status, solver = solved(model)
    assert status == cp_model.OPTIMAL
    assert problem.to_units(round(solver.objective_value)) == makespan


def test_a_range_that_must_be_long_holds_what_it_uses() -> None:
    task = kitchen_task(
        {**OVEN, "duration": {"min": 0, "max": 9}},
        {**OVEN, "duration": 4},
        {"duration": 5},
        precedence=[
            {"before": "a", "after": "c", "type": "start-start", "max_lag": 0},
            {"before": "c", "after": "a", "type": "finish-finish", "min_lag": 0},
        ],
    )
    status, solver = solved(
        build_model(with_heads_and_tails(task), bounds=False, hints=False).model
    )
    assert (status, solver.objective_value) == (cp_model.OPTIMAL, optimal_makespan(task))
    assert optimal_makespan(task) == 9


def test_ranges_keep_to_their_ends() -> None:
    for low, high, fits in ((2, 4, True), (2, 3, False), (5, 9, False)):
        action = {"duration": {"min": low, "max": high}, "start": 0}
        edges = [{"before": "a", "after": "b", "max_lag": 0}]
        model = built(action, {"start": 4}, precedence=edges, deadline=6)
        assert (solved(model.model)[0] == cp_model.OPTIMAL) is fits


# --- every model is sound -----------------------------------------------------------------------


@pytest.mark.slow
def test_every_model_is_accepted_and_its_hint_is_a_complete_schedule() -> None:
    hinted = 0
    for task, problem in some_problems(90):
        model = build_model(problem)
        assert model.model.validate() == ""
        found = list_schedule(problem)
        hint = model.model.proto.solution_hint
        if found is None:
            assert len(hint.vars) == 0
            continue
        assert sorted(hint.vars) == list(range(len(model.model.proto.variables))), task
        status, solver = solved(model.model, fix_variables_to_their_hinted_value=True)
        assert status in (cp_model.OPTIMAL, cp_model.FEASIBLE)
        assert solver.objective_value == max((d.end for d in found[0]), default=0)
        hinted += 1
    assert hinted > 50


@pytest.mark.slow
def test_bounds_and_hints_change_no_optimum() -> None:
    for task, problem in some_problems(60):
        best = optimal_makespan(task)
        for bounds, hints in ((False, False), (True, False), (False, True), (True, True)):
            model = build_model(problem, bounds=bounds, hints=hints)
            status, solver = solved(model.model)
            if best is None:
                assert status == cp_model.INFEASIBLE
            else:
                assert status == cp_model.OPTIMAL
                assert problem.to_units(round(solver.objective_value)) == best


def test_sums_beyond_64_bits_are_refused_and_just_below_they_work() -> None:
    huge = kitchen_task({**OVEN, "duration": 2**60 + 1}, {**OVEN, "duration": 2})
    with pytest.raises(Refusal, match="beyond what CP-SAT's 64-bit sums can hold"):
        build_model(with_heads_and_tails(huge))
    with pytest.raises(InputError) as refused:
        compile_task(huge, "cpsat")
    (told,) = refused.value.report
    assert (told.code.id, told.pointer) == ("IRC502", ("actions", 0, "duration"))
    assert told.message.endswith(f": {2**60 + 1} s is its longest time")
    large = with_heads_and_tails(
        kitchen_task({**OVEN, "duration": 2**55 + 1}, {**OVEN, "duration": 2})
    )
    status, solver = solved(build_model(large).model)
    assert (status, solver.value(build_model(large).makespan)) == (cp_model.OPTIMAL, 2**55 + 3)


def test_a_common_unit_keeps_long_times_small() -> None:
    program = compile_task(
        kitchen_task({**OVEN, "duration": 10**30}, {**OVEN, "duration": 2 * 10**30}), "cpsat"
    )
    assert program.manifest["tick"] == "1" + "0" * 30


# --- the text and the way back ------------------------------------------------------------------


def parsed(text: str) -> Any:
    return text_format.Parse(text, cp_model_pb2.CpModelProto())


@pytest.mark.parametrize("seed", range(25))
def test_the_text_is_a_model_whose_variables_are_named_in_the_manifest(seed: int) -> None:
    rng = random.Random(f"text {seed}")
    task = random_task(rng, tighten=0.0)
    task = hostile_names(task, rng) if seed % 2 else task
    program = compile_task(task, "cpsat")
    model = parsed(program.files[MODEL_FILE])
    names, written = program.names, [variable.name for variable in model.variables]
    assert written[names["makespan"]] == "makespan"
    assert names["actions"].keys() == {action.id for action in task.actions}
    told = {names["makespan"]}
    for action, variables in names["actions"].items():
        assert written[variables["start"]] == f"start {action}"
        assert ("end" in variables) != ("duration" in variables)
        told |= {variables["start"], variables.get("end", names["makespan"])}
        for literals in variables.get("choices", {}).values():
            assert all(f" of {action} on {r}" in written[i] for r, i in literals.items())
            told |= set(literals.values())
    untold = {written[i].split(" ")[0] for i in range(len(written)) if i not in told}
    assert untold <= {"duration", "holds", ""}


@pytest.mark.parametrize("seed", range(25))
def test_a_recorded_response_of_the_text_is_read_back_as_the_schedule(seed: int) -> None:
    """Another CP-SAT solves the text; its response alone, as text, gives the schedule."""
    rng = random.Random(f"response {seed}")
    task = random_task(rng, tighten=0.0)
    program = compile_task(task, "cpsat")
    other = cp_model.CpModel()
    assert other.proto.parse_text_format(program.files[MODEL_FILE])
    status, solver = solved(other)
    assert status == cp_model.OPTIMAL
    schedule = program.decode(str(solver.response_proto))
    assert validate(task, schedule).valid
    assert schedule.makespan == optimal_makespan(task)


@pytest.mark.parametrize(
    ("answer", "reason"),
    [
        ("", "there is no solution in the answer"),
        ("hello", "there is no solution in the answer"),
        ("status: INFEASIBLE", "the response has the status INFEASIBLE"),
        ("status: OPTIMAL", "there is no solution in the answer"),
        ("status: FEASIBLE\nsolution: [0]", "belongs to another model"),
        (
            "status: FEASIBLE\nsolution: [0, 0, 0, 0, 0, 0, 0, 0, 0]",
            "takes none of the alternatives",
        ),
    ],
)
def test_an_answer_that_cannot_be_used_is_refused_with_a_reason(answer: str, reason: str) -> None:
    both = {"uses": [{"one_of": ["r1", "r2"]}]}
    program = compile_task(kitchen_task(both, both, {"uses": [{"resource": "r1"}]}), "cpsat")
    with pytest.raises(AnswerError, match=reason):
        program.decode(answer)


@pytest.mark.parametrize("listing", ["solution: [{}]", "{}"])
def test_a_solution_is_read_in_either_way_protocol_buffers_write_it(listing: str) -> None:
    program = compile_task(
        kitchen_task({"duration": 4}, {"duration": 6}, precedence=[["a", "b"]]), "cpsat"
    )
    values = [0, 2, 5]
    lines = "\n".join(f"solution: {v}" for v in values)
    text = listing.format(", ".join(map(str, values)) if "[" in listing else lines)
    schedule = program.decode(f"status: OPTIMAL\n{text}\n")
    assert [(e.id, e.start, e.end) for e in schedule.entries] == [("a", 0, 4), ("b", 4, 10)]
