"""The old schedule, shifted, as what engines start from."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import irc
from irc.execution import Execution
from irc.execution.freeze import freeze, with_groups
from irc.execution.history import History
from irc.execution.warm_start import warm_start
from irc.lowering.lower import lower
from irc.model import Event, Task
from irc.passes import run_passes
from irc.problem.decisions import Placed
from irc.schedule import Entry, Schedule

OVEN = [{"id": "oven"}]


def baking(**fields: Any) -> Task:
    """A dough that is risen, and baked in one of two ways; a tart that may be."""
    task: dict[str, Any] = {
        "resources": OVEN,
        "state": [{"id": "risen"}],
        "actions": [
            {"id": "rise", "duration": 4, "effects": [{"at": "end", "var": "risen"}]},
            {
                "id": "bake",
                "modes": [
                    {"id": "hot", "duration": 3, "uses": [{"resource": "oven"}]},
                    {"id": "slow", "duration": 9},
                ],
                "conditions": [{"at": "start", "var": "risen"}],
            },
            {
                "id": "tart",
                "duration": 2,
                "occurs": "optional",
                "uses": [{"resource": "oven"}],
                "reward": 1,
            },
        ],
        **fields,
    }
    return Task.model_validate(task)


PLAN = Schedule(
    (
        Entry("rise", 0, 4),
        Entry("tart", 2, 4, {"oven": 1}),
        Entry("bake", 4, 7, {"oven": 1}, mode="hot", rank=1),
    )
)


def places(task: Task, schedule: Schedule, at: int, **ends: int) -> dict[str, Placed]:
    """What is found, by action; `ends` are later than planned."""
    history = History.of(schedule, at)
    for name, end in ends.items():
        history.entries[name, 1] = replace(history.entries[name, 1], end=end)
    problem = lower(task, [at])
    ticks = problem.whole_ticks(at)
    frozen = freeze(problem, history, at, ticks)
    whole = run_passes(with_groups(frozen, ()))
    found = warm_start(whole, frozen.executed, history.plan)
    return {a.id: p for a, p in zip(whole.activities, found, strict=False)}


def test_modes_choices_and_ranks_stay_and_times_shift() -> None:
    longer = baking()
    longer = longer.model_copy(
        update={
            "actions": (longer.actions[0].model_copy(update={"duration": 6}), *longer.actions[1:])
        }
    )
    found = places(longer, PLAN, 1, rise=6)
    assert (found["rise"].start, found["rise"].end) == (0, 6)
    assert (found["bake"].start, found["bake"].mode, found["bake"].rank) == (6, 0, 1)
    assert found["tart"].present
    assert found["tart"].start <= 4


def test_what_was_left_out_stays_out() -> None:
    found = places(baking(), Schedule((PLAN.entries[0], PLAN.entries[2])), 1)
    assert not found["tart"].present


def test_nothing_is_found_where_the_old_order_does_not_survive() -> None:
    assert not places(baking(deadline=6), PLAN, 1)


def test_an_engine_without_any_time_still_answers_with_it() -> None:
    import random

    rng = random.Random(4)
    task = Task.model_validate(
        {
            "resources": [{"id": f"r{k}"} for k in range(4)],
            "actions": [
                {
                    "id": f"a{i}",
                    "duration": rng.randint(1, 9),
                    "occurs": "optional",
                    "reward": 1,
                    "uses": [{"resource": f"r{rng.randrange(4)}"}],
                }
                for i in range(60)
            ],
            "objective": ["maximize_reward", "minimize_makespan"],
        }
    )
    plan = irc.solve(task, time_limit=20)
    run = Execution(task, plan, time_limit=0.001, workers=1)
    broken = {"op": "set_capacity", "resource": "r0", "capacity": 0, "from": 20, "to": 30}
    run.apply(Event.model_validate({"at": 10, "changes": [broken]}))
    step = run.replan()
    assert step.schedule.answered
    assert len(step.schedule.entries) == 60
