"""The joint capacities of sets of resources, and intervals of fixed size in modes."""

from __future__ import annotations

from typing import Any

import pytest

from builders import Document, after_passes
from irc.model import Task
from irc_cpsat.encoding import pools
from irc_cpsat.encoding.builder import Builder, Model
from irc_cpsat.encoding.encode import build_model, write_model
from irc_cpsat.encoding.pools import FEW, POOLS_LIMIT, PoolLoad, pool_loads


@pytest.fixture(autouse=True)
def _many(monkeypatch: pytest.MonkeyPatch) -> None:
    """These few activities count as many, for which modes are looked at."""
    monkeypatch.setattr(pools, "FEW", 1)


def flexible(*choices: dict[str, int]) -> Task:
    """Actions with a mode on each of their machines, by its duration there."""
    actions = [
        {
            "id": f"a{i}",
            "modes": [
                {"id": machine, "duration": duration, "uses": [{"resource": machine}]}
                for machine, duration in ways.items()
            ],
        }
        for i, ways in enumerate(choices)
    ]
    machines = sorted({machine for ways in choices for machine in ways})
    resources: list[Document] = [{"id": machine} for machine in machines]
    return Task.model_validate({"actions": actions, "resources": resources})


def pools_of(task: Task) -> list[PoolLoad]:
    builder = Builder(after_passes(task), True, False)
    write_model(builder)
    return pool_loads(builder)


def constraints(model: Model, kind: str) -> list[Any]:
    return [c for c in model.model.proto.constraints if getattr(c, f"has_{kind}")()]


def test_modes_on_different_machines_load_these_machines_together() -> None:
    (pool,) = pools_of(flexible(*[{"m1": 3, "m2": 4}] * 3))
    assert pool.capacity == 2
    assert pool.loads == ((0, 1), (1, 1), (2, 1))


def test_an_activity_with_a_mode_elsewhere_loads_a_pool_with_nothing() -> None:
    task = flexible(*[{"m1": 3, "m2": 4}] * 3, *[{"m1": 2, "m3": 3}] * 2)
    found = {pool.capacity: pool.loads for pool in pools_of(task)}
    assert found[2] == ((0, 1), (1, 1), (2, 1))
    assert found[3] == ((0, 1), (1, 1), (2, 1), (3, 1), (4, 1))


def test_only_the_pools_with_the_most_work_for_their_size_get_a_constraint() -> None:
    ways = [
        {f"m{2 * k}": 1 + k, f"m{2 * k + 1}": 2 + k} for k in range(POOLS_LIMIT + 2) for _ in "abc"
    ]
    found = pools_of(flexible(*ways))
    assert [pool.loads[0][0] // 3 for pool in found] == [5, 4, 3, 2]


def test_three_activities_on_two_machines_are_bounded_before_any_search() -> None:
    from ortools.sat.python import cp_model

    task = flexible(*[{"m1": 4, "m2": 5}] * 3)
    bounded = build_model(after_passes(task))
    solver = cp_model.CpSolver()
    assert solver.solve(bounded.model) == cp_model.OPTIMAL
    assert solver.value(bounded.makespan) == 8
    assert len(constraints(bounded, "cumulative")) == 1
    assert not constraints(build_model(after_passes(task), bounds=False), "cumulative")


def test_an_interval_of_a_mode_has_the_fixed_size_of_the_mode() -> None:
    model = build_model(after_passes(flexible(*[{"m1": 3, "m2": 5}] * 2)), bounds=False)
    optional = [c for c in constraints(model, "interval") if len(c.enforcement_literal)]
    assert sorted(c.interval.size.offset for c in optional) == [3, 3, 5, 5]
    assert not any(len(c.interval.size.vars) for c in optional)


def test_the_work_of_each_mode_fits_on_its_machine_and_on_all_of_them() -> None:
    task = flexible(*[{"m1": 4, "m2": 5}] * 3)
    model = build_model(after_passes(task))
    found = [c.linear for c in constraints(model, "linear") if len(c.linear.vars) > 3]
    assert [sorted(abs(k) for k in linear.coeffs) for linear in found] == [
        [1, 4, 4, 4],
        [1, 5, 5, 5],
        [2, 4, 4, 4, 5, 5, 5],
    ]


def test_of_few_activities_no_modes_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pools, "FEW", FEW)
    assert not pools_of(flexible(*[{"m1": 4, "m2": 5}] * 3))
