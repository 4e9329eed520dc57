"""PyJobShop's problems: each feature that it names means the same here, or is refused."""

from __future__ import annotations

import json
from typing import Any

import pytest

import irc
from irc.diagnostics import InputError
from irc.frontends.importers.pyjobshop import import_pyjobshop

Document = dict[str, Any]


def problem(**more: Any) -> Document:
    """Three tasks of 3, 4 and 2 on machines 0 and 1, the first and the last on either."""
    return {
        "jobs": [],
        "resources": [{"type": "machine", "name": "A"}, {"type": "machine", "breaks": []}],
        "tasks": [{}, {}, {}],
        "modes": [
            {"task": 0, "resources": [0], "duration": 3},
            {"task": 0, "resources": [1], "duration": 3},
            {"task": 1, "resources": [0], "duration": 4},
            {"task": 2, "resources": [0], "duration": 2},
            {"task": 2, "resources": [1], "duration": 2},
        ],
        **more,
    }


def solved(document: Document) -> object:
    ((_, task),) = import_pyjobshop(json.dumps(document), "problem.json")
    schedule = irc.solve(task, time_limit=20)
    return schedule.objective[0].value if schedule.answered else str(schedule.status)


@pytest.mark.parametrize(
    ("more", "expected"),
    [
        ({}, 5),
        ({"constraints": {"end_before_start": [{"task1": 1, "task2": 0, "delay": 1}]}}, 8),
        ({"constraints": {"end_at_start": [{"task1": 0, "task2": 2}]}}, 5),
        ({"constraints": {"start_at_start": [{"task1": 0, "task2": 2, "delay": 1}]}}, 6),
        ({"constraints": {"identical_resources": [{"task1": 0, "task2": 1}]}}, 7),
        ({"constraints": {"different_resources": [{"task1": 0, "task2": 2}]}}, 6),
        ({"constraints": {"mode_dependencies": [{"mode1": 1, "modes2": [3]}]}}, 6),
        (
            {
                "constraints": {
                    "setup_times": [
                        {"machine": 0, "task1": a, "task2": b, "duration": 5}
                        for a, b in ((1, 2), (2, 1), (0, 1), (1, 0))
                    ]
                }
            },
            5,
        ),
        ({"resources": [{"type": "machine", "breaks": [[1, 9]]}, {"type": "machine"}]}, 13),
        (
            {
                "resources": [{"type": "machine", "breaks": [[1, 9]]}, {"type": "machine"}],
                "tasks": [{}, {"allow_breaks": True}, {}],
            },
            12,
        ),
        (
            {
                "tasks": [{"optional": True}, {"optional": True}, {}],
                "constraints": {"select_exactly_one": [{"tasks": [0, 1]}]},
            },
            3,
        ),
        (
            {
                "tasks": [{"optional": True}, {"optional": True}, {}],
                "constraints": {
                    "select_all_or_none": [{"tasks": [0, 1]}],
                    "select_at_least_one": [{"tasks": [0], "condition_task": 2}],
                },
            },
            5,
        ),
        ({"tasks": [{"earliest_start": 4}, {"latest_end": 4}, {"earliest_end": 9}]}, 9),
        (
            {
                "tasks": [{"job": 0}, {"job": 1}, {"job": 0}],
                "jobs": [{"due_date": -2, "weight": 3}, {"due_date": 1}],
                "objective": {"weight_total_tardiness": 1},
            },
            20,
        ),
        (
            {
                "tasks": [{"job": 0}, {"job": 1}, {"job": 0}],
                "jobs": [{"due_date": 4}, {"due_date": 1}],
                "objective": {"weight_tardy_jobs": 10, "weight_makespan": 1},
            },
            16,
        ),
        (
            {
                "resources": [{"type": "consumable", "capacity": 4}, {"type": "machine"}],
                "modes": [
                    {"task": 0, "resources": [0], "duration": 1, "demands": [3]},
                    {"task": 0, "resources": [1], "duration": 6},
                    {"task": 1, "resources": [0], "duration": 1, "demands": [1]},
                    {"task": 2, "resources": [0], "duration": 1, "demands": [1]},
                ],
            },
            6,
        ),
    ],
)
def test_a_feature_means_the_same(more: Document, expected: object) -> None:
    assert solved(problem(**more)) == expected


FIXED = [{"task": k, "resources": [0], "duration": d} for k, d in enumerate((3, 4, 2))]
FLOW = [{"task": k, "resources": [k % 2], "duration": d} for k, d in enumerate((1, 5, 4, 1))]
FLOWS = [{"task1": 0, "task2": 1}, {"task1": 2, "task2": 3}]


@pytest.mark.parametrize(
    ("more", "expected"),
    [
        (
            {
                "tasks": [{}, {"earliest_start": 5}, {}],
                "modes": FIXED,
                "constraints": {
                    "consecutive": [{"task1": 0, "task2": 1}],
                    "end_before_start": [{"task1": 0, "task2": 2}],
                },
            },
            11,
        ),
        (
            {
                "tasks": [{}] * 4,
                "modes": FLOW,
                "constraints": {
                    "same_sequence": [{"machine1": 0, "machine2": 1}],
                    "end_before_start": FLOWS,
                    "start_before_start": [{"task1": 2, "task2": 0}],
                },
            },
            10,
        ),
        (
            {
                "tasks": [{}] * 4,
                "modes": FLOW,
                "constraints": {
                    "same_sequence": [
                        {"machine1": 0, "machine2": 1, "tasks1": [0, 2], "tasks2": [3, 1]}
                    ],
                    "end_before_start": FLOWS,
                },
            },
            11,
        ),
        (
            {
                "tasks": [{"optional": True}, {"optional": True}, {}],
                "modes": FIXED,
                "constraints": {
                    "select_all_or_none": [{"tasks": [0, 1], "condition_task": 2}],
                    "select_at_least_one": [{"tasks": [0, 1]}],
                },
            },
            9,
        ),
        (
            {
                "tasks": [{"optional": True, "job": 0}, {"optional": True, "job": 0}, {"job": 1}],
                "jobs": [{"due_date": 2, "weight": 5}, {"due_date": 3}],
                "modes": FIXED,
                "constraints": {"select_exactly_one": [{"tasks": [0, 1]}]},
                "objective": {"weight_total_tardiness": 1},
            },
            7,
        ),
        (
            {
                "tasks": [{"job": 0}, {"optional": True, "job": 0}, {"job": 1}],
                "jobs": [{"deadline": 4}, {}],
                "modes": FIXED,
                "constraints": {"select_at_least_one": [{"tasks": [1]}]},
            },
            "infeasible",
        ),
    ],
    ids=["next", "one order", "listed order", "all or none", "optional job", "its deadline"],
)
def test_orders_and_selections_have_the_optimum_of_pyjobshop(
    more: Document, expected: object
) -> None:
    """The values are those of PyJobShop 0.0.9 (`benchmarks/pyjobshop_agreement.py` has more)."""
    assert solved(problem(**more)) == expected


BREAKS = [[1, 3], [4, 5]]
STOCK = {"type": "consumable", "capacity": 5}


@pytest.mark.parametrize(
    ("resource", "task", "mode", "expected"),
    [
        ({"capacity": 1, "breaks": BREAKS}, {}, {"demands": [0]}, 8),
        ({"capacity": 1, "breaks": BREAKS}, {"allow_breaks": True}, {"demands": [0]}, 6),
        ({**STOCK, "breaks": BREAKS}, {}, {"demands": [5]}, 8),
        ({**STOCK, "breaks": BREAKS}, {"allow_breaks": True}, {"demands": [0]}, 6),
        ({"type": "machine"}, {"allow_idle": True, "latest_start": 0, "earliest_end": 10}, {}, 10),
        (
            {"type": "machine", "breaks": [[4, 12]]},
            {"allow_idle": True, "latest_start": 2, "earliest_end": 10},
            {},
            10,
        ),
        (
            {"type": "machine", "breaks": [[2, 6]]},
            {"allow_idle": True, "allow_breaks": True, "latest_start": 0, "earliest_end": 9},
            {},
            9,
        ),
    ],
    ids=["nothing", "pause", "stock", "no stock", "idle", "idle in a break", "idle and pause"],
)
def test_breaks_bind_what_names_their_resource(
    resource: Document, task: Document, mode: Document, expected: object
) -> None:
    """The values are those of PyJobShop 0.0.9."""
    one = {"task": 0, "resources": [0], "duration": 3, **mode}
    assert solved({"resources": [resource], "tasks": [task], "modes": [one]}) == expected


@pytest.mark.parametrize(
    ("rule", "optional", "expected"),
    [
        ("identical_resources", False, 5),
        ("different_resources", False, 4),
        ("identical_resources", True, 5),
        ("different_resources", True, 3),
    ],
)
def test_resources_of_which_nothing_is_taken_are_compared(
    rule: str, optional: bool, expected: object
) -> None:
    """The values are those of PyJobShop 0.0.9: what is identical is also present together."""
    document = {
        "resources": [{"type": "machine"}, STOCK],
        "tasks": [{}, {"optional": optional}],
        "modes": [
            {"task": 0, "resources": [0, 1], "duration": 3, "demands": [0, 0]},
            {"task": 0, "resources": [0], "duration": 4},
            {"task": 1, "resources": [0, 1], "duration": 2, "demands": [0, 1]},
            {"task": 1, "resources": [1], "duration": 1, "demands": [1]},
        ],
        "constraints": {rule: [{"task1": 0, "task2": 1}]},
    }
    assert solved(document) == expected


def test_a_problem_without_tasks_is_done_at_once() -> None:
    assert solved({"resources": [], "tasks": [], "modes": []}) == 0


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (
            {
                "modes": [{**mode, "duration": 0} for mode in problem()["modes"]],
                "constraints": {"consecutive": [{"task1": 0, "task2": 1}]},
            },
            "a task that takes no time",
        ),
        (
            {"constraints": {"same_sequence": [{"machine1": 0, "machine2": 1}]}},
            "equally many tasks",
        ),
        (
            {
                "tasks": [{"optional": True, "job": 0}, {}, {}],
                "jobs": [{"due_date": 3}],
                "objective": {"weight_total_earliness": 1},
            },
            "the earliness of a job with optional tasks",
        ),
        ({"constraints": {"end_before_strat": []}}, "does not know the constraint"),
        ({"modes": []}, "the task has no mode"),
        ({"modes": [{"task": 7, "resources": [0], "duration": 3}]}, "no index of tasks"),
        ({"modes": [{"task": 0, "resources": "A", "duration": 3}]}, "expected a whole number"),
        ({"modes": [{"task": 0, "resources": [0]}]}, "the field 'duration' is missing"),
        ({"resources": [{"breaks": [[1]]}, {}]}, "expected [start, end]"),
        ({"tasks": 3}, "expected a list"),
    ],
)
def test_what_cannot_be_read_has_its_place(more: Document, message: str) -> None:
    with pytest.raises(InputError) as raised:
        list(import_pyjobshop(json.dumps(problem(**more)), "problem.json"))
    assert message in str(raised.value)
