"""Fewer moves by CP-SAT in parts of a schedule: against brute force, and on a broken shop."""

from __future__ import annotations

from typing import Any

import pytest
from ortools.sat.python import cp_model

import irc
from execution.test_least_movement import (
    broken_shop,
    end_of,
    failure,
    fewest,
    repaired,
    shop,
)
from irc.execution import continuation
from irc.passes.serial_sgs import moved_in, quick_schedule
from irc.passes.unroll import unroll
from irc.retiming.retime import retime
from irc.retiming.to_schedule import schedule_of
from irc.targets import Budget
from irc.validation import validate
from irc_cpsat.encoding.builder import Builder
from irc_cpsat.encoding.encode import write_model
from irc_cpsat.encoding.hints import hinted
from irc_cpsat.encoding.objectives import set_objective
from irc_cpsat.solving import deepening
from irc_cpsat.solving.asking import solver_for
from irc_cpsat.solving.deepening import DeepeningSearch
from irc_cpsat.solving.parts import improve_parts
from irc_cpsat.solving.solution import decisions_of


@pytest.mark.parametrize("seed", range(2))
def test_parts_move_fewer_and_end_no_later(seed: int) -> None:
    task, problem, at = broken_shop(seed)
    problem = unroll(problem, 1)
    known = quick_schedule(problem)
    assert known is not None
    built = write_model(Builder(problem, True, True, found=known))
    model: Any = built.model
    model.add(built.makespan <= end_of(known))
    model.clear_objective()
    set_objective(model, "changes", built.values["changes"])
    found = improve_parts(built, lambda: solver_for(problem, 0), Budget(20))
    assert found is not None
    best = hinted(built)
    assert best is not None
    assert moved_in(problem, best) == found.value(built.values["changes"])
    assert moved_in(problem, best) < moved_in(problem, known)
    schedule = schedule_of(problem, retime(problem, decisions_of(built, found)))
    assert validate(task, schedule, at).valid
    assert schedule.makespan <= problem.to_units(end_of(known))


@pytest.mark.parametrize("seed", range(3))
def test_they_are_the_answer_where_nothing_else_finds_one(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    task, event = shop(seed), failure(seed)
    plan = irc.solve(task, workers=1)
    whole = DeepeningSearch._asked

    def in_vain(self: DeepeningSearch, built: Any, objective: str, *rest: Any) -> Any:
        status, solver = whole(self, built, objective, *rest)
        return (cp_model.UNKNOWN if objective == "changes" else status), solver

    monkeypatch.setattr(DeepeningSearch, "_asked", in_vain)
    monkeypatch.setattr(deepening, "fewer_moves", lambda *_: None)
    monkeypatch.setattr(continuation, "with_fewer_moves", lambda _p, outcome, *_: outcome)
    step = repaired(task, plan, event, 20)
    makespan = int(step.schedule.makespan)
    assert step.moved == fewest(task, plan, f"station{seed % 2}", makespan)
    assert validate(step.task, step.schedule, 2).valid
