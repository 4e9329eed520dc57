"""The judge of running tasks accepts the best repair, made by hand, and says what is wrong else."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from irc.events.apply import apply
from irc.execution.step import Step
from irc.model import Event, Task
from irc.schedule import Entry, ObjectiveValue, Schedule, Status
from oracles.online_continuation import continuation, frozen
from oracles.online_judge import judge_step

TASK = Task.model_validate(
    {
        "resources": [{"id": "van"}, {"id": "fuel", "kind": "reservoir", "initial": 3}],
        "actions": [
            {"id": "load", "duration": 2, "uses": [{"resource": "van"}]},
            {
                "id": "drive",
                "duration": 3,
                "uses": [{"resource": "van"}],
                "consumes": [{"resource": "fuel", "amount": 1}],
            },
            {"id": "sign", "duration": 1},
        ],
        "precedence": [["load", "drive"], ["drive", "sign"]],
        "groups": [{"id": "order", "actions": ["drive", "sign"], "required": False, "reward": 4}],
        "objective": ["maximize_reward", "minimize_makespan"],
    }
)
OLD = Schedule(
    (Entry("load", 0, 2, {"van": 1}), Entry("drive", 2, 5, {"van": 1}), Entry("sign", 5, 6))
)
EVENT = Event.model_validate(
    {"at": 3, "changes": [{"op": "set_duration", "action": "drive", "duration": 5}]}
)
STOP = Event.model_validate({"at": 3, "changes": [{"op": "set_deadline", "deadline": 5}]})
WHOLE = Event.model_validate(
    {"at": 1, "changes": [{"op": "set_capacity", "resource": "van", "capacity": 0, "to": 4}]}
)


def step(
    event: Event, entries: tuple[Entry, ...], reward: int, moved: int, status: str = "optimal"
) -> Step:
    makespan = max((e.end for e in entries), default=0)
    values = (ObjectiveValue("reward", reward), ObjectiveValue("makespan", makespan))
    at = TASK.number(event.at)
    return Step(
        at,
        (event,),
        tuple(e.id for e in OLD.entries if e.start < at and e.end <= at),
        tuple(e.id for e in OLD.entries if e.start < at < e.end),
        moved,
        Schedule(entries, Status(status), values if entries else ()),
        apply(TASK, event),
    )


LATER = (
    Entry("load", 0, 2, {"van": 1}),
    Entry("drive", 2, 7, {"van": 1}),
    Entry("sign", 7, 8),
)
GOOD = step(EVENT, LATER, 4, 1)


def with_entry(good: Step, k: int, **fields: object) -> Step:
    entries = list(good.schedule.entries)
    entries[k] = replace(entries[k], **fields)  # type: ignore[arg-type]
    return replace(good, schedule=replace(good.schedule, entries=tuple(entries)))


def test_the_best_repair_is_accepted_and_compared() -> None:
    judged = judge_step(TASK, OLD, GOOD, [EVENT])
    assert judged.faults == []
    assert judged.equal


WRONG: dict[str, tuple[Callable[[], Step], str]] = {
    "history": (lambda: with_entry(GOOD, 0, resources={}), "history: load"),
    "end": (lambda: with_entry(GOOD, 1, end=6), "history: drive ends at 6"),
    "gone": (
        lambda: replace(GOOD, schedule=replace(GOOD.schedule, entries=LATER[1:])),
        "history: load, which had started, is gone",
    ),
    "past": (lambda: with_entry(GOOD, 2, start=1, end=2), "past: sign"),
    "order": (lambda: with_entry(GOOD, 2, start=6, end=7), "validator: precedence"),
    "late": (lambda: with_entry(GOOD, 2, start=8, end=9), "compare: (4, 9) (called optimal)"),
    "moved": (lambda: replace(GOOD, moved=0), "moved: 1 moved, and it says 0"),
    "snapshot": (lambda: replace(GOOD, running=()), "snapshot: running are ['drive']"),
    "task": (lambda: replace(GOOD, task=TASK), "task: the task in force"),
    "abandoned": (
        lambda: replace(
            step(EVENT, (LATER[0], replace(LATER[1], status="abandoned")), 0, 1),
            abandoned=("order",),
        ),
        "abandoned: ['order'], where 0 would do",
    ),
    "infeasible": (lambda: step(EVENT, (), 0, 0, "infeasible"), "compare: called infeasible"),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_repair_is_refused(name: str) -> None:
    make, said = WRONG[name]
    faults = judge_step(TASK, OLD, make(), [EVENT]).faults
    assert any(fault.startswith(said) for fault in faults), faults


def test_an_order_that_no_continuation_finishes_is_given_up() -> None:
    ran = (LATER[0], replace(OLD.entries[1], status="abandoned"))
    given_up = replace(step(STOP, ran, 0, 1), abandoned=("order",))
    judged = judge_step(TASK, OLD, given_up, [STOP])
    assert judged.faults == []
    assert judged.equal


def test_a_plan_that_could_stay_may_not_move() -> None:
    event = Event.model_validate({"at": 3, "changes": [{"op": "set_deadline", "deadline": 20}]})
    task = TASK.model_copy(update={"objective": ("maximize_reward",)})
    moved = replace(step(event, (*OLD.entries[:2], Entry("sign", 6, 7)), 4, 1), task=task)
    moved = replace(
        moved,
        schedule=replace(moved.schedule, objective=(ObjectiveValue("reward", 4),)),
        task=apply(task, event),
    )
    assert judge_step(task, OLD, moved, [event]).faults == [
        "stability: 1 moved, and the old plan is still valid and as good"
    ]


def test_what_runs_keeps_the_capacity_that_an_event_takes_away() -> None:
    task = apply(TASK, WHOLE)
    best = continuation(task, frozen(TASK, task, OLD, 1, [WHOLE]), 1).best
    assert best is not None
    starts = {e.id: (e.start, e.end) for e in best.schedule.entries}
    assert starts == {"load": (0, 2), "drive": (4, 7), "sign": (7, 8)}
