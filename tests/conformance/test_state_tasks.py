"""Tasks with state, stock, choices and calendars: `cpsat` against an exact search."""

from __future__ import annotations

from typing import Any

import pytest

import irc
from irc.diagnostics import Code
from irc.model import Task
from irc.schedule import Status
from irc.targets import backends, refused_features
from laws import agree, answer_of
from oracles.field_witnesses import WITNESSES, Answer, Witness
from oracles.state_brute_force import optimum
from oracles.state_generators import match_cellar, state_task

TASKS, BATCHES = 150, 5


@pytest.mark.slow
@pytest.mark.parametrize("batch", range(BATCHES))
def test_cpsat_finds_the_optimum_of_random_state_tasks(batch: int) -> None:
    found = 0
    for seed in range(batch, TASKS, BATCHES):
        task = state_task(seed)
        best = optimum(task)
        agree(task, answer_of(task), best)
        found += best is not None
    assert found > TASKS // BATCHES // 4


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_matches_burn_while_what_needs_their_light_is_mended(seed: int) -> None:
    task = match_cellar(seed)
    agree(task, answer_of(task), optimum(task))


def test_some_match_needs_two_happenings_at_one_instant() -> None:
    ranked = [
        entry
        for seed in range(6)
        if (schedule := answer_of(match_cellar(seed))) is not None
        for entry in schedule.entries
        if entry.rank or entry.end_rank
    ]
    assert ranked


# --- the ledger ---------------------------------------------------------------------------------


def answer_vector(task: Task, target: str, **options: Any) -> Answer:
    schedule = irc.solve(task, target, shortcut=False, workers=1, time_limit=30, **options)
    if schedule.status is Status.INFEASIBLE:
        return None
    assert schedule.status is Status.OPTIMAL
    return tuple(o.value for o in schedule.objective)


@pytest.mark.parametrize("witness", WITNESSES, ids=[w.field for w in WITNESSES])
def test_no_field_of_the_ir_is_dropped_by_cpsat(witness: Witness) -> None:
    for task, expected in (
        (witness.task, witness.answer),
        (witness.counterpart, witness.answer_instead),
    ):
        if refused_features(task, backends()["cpsat"]):
            with pytest.raises(irc.InputError):
                irc.compile(task, "cpsat")
            continue
        if irc.check(task).ok:
            assert answer_vector(task, "cpsat") == expected
        else:
            assert expected is None


@pytest.mark.parametrize("target", ["cpsat", "pddl21"])
@pytest.mark.parametrize("witness", WITNESSES, ids=[w.field for w in WITNESSES])
def test_what_a_target_does_not_take_is_refused_with_its_place(
    witness: Witness, target: str
) -> None:
    task = witness.task
    refused = refused_features(task, backends()[target])
    if not irc.check(task).ok:
        return
    if not refused:
        irc.compile(task, target)
        return
    with pytest.raises(irc.InputError) as told:
        irc.compile(task, target)
    errors = told.value.report.errors
    assert {d.code for d in errors} == {Code.UNSUPPORTED}
    assert all(d.pointer and d.hint for d in errors)
