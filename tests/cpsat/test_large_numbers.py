"""Times and amounts beyond 64 bits: harmless where no schedule reaches them, else refused."""

from __future__ import annotations

from typing import Any

import pytest

import irc
from builders import document_of, engine_schedule
from irc.driver.compile import compile_task
from irc.model import Task
from irc.problem import Activity, Arc, ContendedPool, Contention, Problem, Window
from irc.problem.horizon import within
from irc.schedule import Status

HUGE = 50 * 10**18 + 1

STATE = {"state": [{"id": "lit"}]}
PRESS = {"resources": [{"id": "press"}]}
USE = {"uses": [{"resource": "press"}]}


def lights(name: str, duration: Any = 1, **fields: Any) -> dict[str, Any]:
    effects = [{"at": "end", "var": "lit", "value": True}]
    return {"id": name, "duration": duration, "effects": effects, **fields}


def presses(name: str, duration: Any = 1, **fields: Any) -> dict[str, Any]:
    return {"id": name, "duration": duration, **USE, **fields}


def document(*actions: dict[str, Any], **fields: Any) -> dict[str, Any]:
    return document_of(*actions, **{"deadline": 10, **fields})


ONE_OR_OTHER = {
    "objective": ["maximize_reward", "minimize_makespan"],
    "deadline": 10,
    "actions": [
        {"id": "a", "duration": 1, "occurs": "optional", "reward": 1},
        {"id": "b", "duration": 1, "occurs": "optional", "reward": 2},
    ],
}

LAG = {"before": "a", "after": "b"}

NEVER_REACHED = {
    "the greatest duration": (document(lights("a", {"min": 1, "max": HUGE}), **STATE), [1]),
    "the duration of what may be absent": (
        document(lights("a"), lights("b", HUGE, occurs="optional"), **STATE),
        [1],
    ),
    "the duration of a mode": (
        document(
            {
                "id": "a",
                **USE,
                "modes": [{"id": "m", "duration": HUGE}, {"id": "n", "duration": 2}],
            },
            presses("b"),
            **PRESS,
        ),
        [3],
    ),
    "a release of what may be absent": (
        document(lights("a"), lights("b", release=HUGE, occurs="optional"), **STATE),
        [1],
    ),
    "a fixed start of what may be absent": (
        document(lights("a"), lights("b", start=HUGE, occurs="optional"), **STATE),
        [1],
    ),
    "a due date": (
        {
            **PRESS,
            "objective": "minimize_tardiness",
            "actions": [presses("a", due=HUGE), presses("b", due=1)],
        },
        [0],
    ),
    "a minimal lag that two cannot keep": (
        {**ONE_OR_OTHER, "precedence": [{**LAG, "min_lag": HUGE}]},
        [2, 1],
    ),
    "a maximal lag that two cannot keep": (
        {**ONE_OR_OTHER, "precedence": [{**LAG, "min_lag": -2 * HUGE, "max_lag": -HUGE}]},
        [2, 1],
    ),
    "lags that never bind": (
        {**ONE_OR_OTHER, "precedence": [{**LAG, "min_lag": -HUGE, "max_lag": HUGE}]},
        [3, 1],
    ),
    "windows that close long after the deadline": (
        document(
            *(presses(name) for name in "abc"),
            resources=[
                {
                    "id": "press",
                    "availability": [
                        {"from": 1, "to": 4, "capacity": 0},
                        {"from": 8, "to": HUGE, "capacity": 0},
                        {"from": HUGE, "to": 2 * HUGE, "capacity": 2},
                    ],
                }
            ],
        ),
        [6],
    ),
    "a capacity that is never contended for": (
        document(
            presses("a"),
            presses("b"),
            {"id": "c", "duration": 1, "uses": [{"resource": "hall"}]},
            resources=[{"id": "press"}, {"id": "hall", "capacity": HUGE}],
        ),
        [2],
    ),
}


@pytest.mark.parametrize("case", NEVER_REACHED)
def test_numbers_that_no_schedule_reaches_do_no_harm(case: str) -> None:
    raw, expected = NEVER_REACHED[case]
    schedule = engine_schedule(raw)
    assert schedule.status is Status.OPTIMAL
    assert [o.value for o in schedule.objective] == expected
    compile_task(Task.model_validate(raw), "cpsat")


REFUSED = {
    "the times": ({"resources": [{"id": "press"}], "actions": [presses("a", HUGE), presses("b")]}),
    "the weights": (
        {
            **PRESS,
            "objective": "minimize_tardiness",
            "actions": [presses("a", due=0, weight=HUGE), presses("b", due=0)],
        }
    ),
    "the rewards": (
        {
            "objective": "maximize_reward",
            "actions": [{"id": "a", "duration": 1, "occurs": "optional", "reward": HUGE}],
        }
    ),
    "units of 'press'": (
        {
            "resources": [{"id": "press", "capacity": HUGE}],
            "actions": [
                {
                    "id": name,
                    "duration": 1,
                    "uses": [{"resource": "press", "amount": HUGE // 2 + 1}],
                }
                for name in "ab"
            ],
        }
    ),
    "the amounts of reservoir 'flour'": (
        {
            "resources": [{"id": "flour", "kind": "reservoir", "initial": HUGE}],
            "actions": [
                {"id": "a", "duration": 1, "consumes": [{"resource": "flour", "amount": HUGE}]}
            ],
        }
    ),
}


@pytest.mark.parametrize("what", REFUSED)
def test_what_would_overflow_is_refused_by_its_name(what: str) -> None:
    with pytest.raises(irc.InputError) as refused:
        engine_schedule(REFUSED[what])
    (told,) = refused.value.report
    assert told.code.id == "IRC502"
    assert what in told.message


def test_what_cannot_be_reached_becomes_the_first_tick_after_the_horizon() -> None:
    problem = Problem(
        None,
        "s",
        irc.compile({"actions": [{"id": "a", "duration": 1}]}, "cpsat").problem.tick,
        (Activity("a", 2, 900, release=3, start=800), Activity("b", 1, 1)),
        contention=Contention(
            (ContendedPool("r", 2, (0,), 1, (Window(4, 700, 2), Window(700, 800, 0))),)
        ),
        arcs=(Arc(0, 1, min_lag=-500, max_lag=500), Arc(1, 0, min_lag=600, max_lag=-600)),
    )
    near = within(problem, 9)
    assert near.activities == (Activity("a", 2, 10, release=3, start=10), Activity("b", 1, 1))
    assert near.contention.pools == (ContendedPool("r", 2, (0,), 1, (Window(4, 10, 2),)),)
    assert near.arcs == (Arc(0, 1, min_lag=-10, max_lag=None), Arc(1, 0, min_lag=10, max_lag=-10))
