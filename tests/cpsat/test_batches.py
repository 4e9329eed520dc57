"""Loads in a CP-SAT model: one way to write each, and a list schedule as a complete hint."""

from __future__ import annotations

from typing import Any

import pytest
from ortools.sat.python import cp_model

from irc.lowering.lower import lower
from irc.model import Task
from irc.passes import run_passes
from irc.passes.serial_sgs import list_schedule
from irc.problem import Problem
from irc_cpsat.encoding.encode import build_model


def problem(*jobs: tuple[Any, int, str, int], capacity: int = 4, **more: Any) -> Problem:
    """Jobs in an oven: duration, amount, family, release."""
    actions = [
        {
            "id": f"j{k}",
            "duration": duration,
            "release": release,
            "uses": [{"resource": "oven", "amount": amount, "family": family}],
        }
        for k, (duration, amount, family, release) in enumerate(jobs)
    ]
    oven = {"id": "oven", "kind": "batch", "capacity": capacity, **more}
    return run_passes(lower(Task.model_validate({"resources": [oven], "actions": actions})))


JOBS = [(3, 2, "red", 0), (3, 2, "red", 1), (3, 1, "blue", 0), (5, 1, "red", 0), (3, 2, "red", 4)]


def test_the_list_schedule_puts_into_a_load_what_fits() -> None:
    found = list_schedule(problem(*((3, 2, family, 0) for family in ("red", "red", "blue"))))
    assert found is not None
    spans = [(int(d.start), int(d.end)) for d in found[0]]  # A tick is 3.
    assert spans[0] == spans[1]
    assert sorted({*spans}) == [(0, 1), (1, 2)]


@pytest.mark.parametrize(
    "window", [None, {"from": 2, "to": 4, "capacity": 0}, {"from": 0, "to": 9, "capacity": 2}]
)
def test_the_list_schedule_is_a_complete_hint(window: dict[str, int] | None) -> None:
    built = build_model(problem(*JOBS, **({} if window is None else {"availability": [window]})))
    assert built.hint is not None
    solver = cp_model.CpSolver()
    solver.parameters.fix_variables_to_their_hinted_value = True
    assert solver.solve(built.model) in (cp_model.OPTIMAL, cp_model.FEASIBLE)
    hinted = {*built.model.proto.solution_hint.vars}
    assert hinted == {*range(len(built.model.proto.variables))}


def test_equal_loads_are_written_in_one_way() -> None:
    """Two jobs of one load, at one time: the first leads, the second joins."""
    built = build_model(problem((3, 2, "red", 0), (3, 2, "red", 0)), hints=False)
    built.model.add(built.makespan == built.problem.to_ticks(3))
    built.model.clear_objective()

    class Count(cp_model.CpSolverSolutionCallback):
        def __init__(self) -> None:
            super().__init__()
            self.found = 0

        def on_solution_callback(self) -> None:
            self.found += 1

    solver, count = cp_model.CpSolver(), Count()
    solver.parameters.enumerate_all_solutions = True
    solver.solve(built.model, count)
    assert count.found == 1
