"""What the history breaks of state and stock: repair and validator agree about what is carried.

Every continuation of small tasks at whole times is judged by the validator, and the repair finds
one that is as good as the best that it accepts.
"""

from __future__ import annotations

import random
from dataclasses import replace
from itertools import product
from typing import Any

import pytest

from builders import task_of
from irc import validate
from irc.model import Task
from irc.schedule import Entry, Schedule, Status
from online_cases import action, carried, entry, plan, repaired, starts

TARGETS = ("cpsat", "pddl21")
HAND = [{"id": "hand"}]
DARK = {"op": "set_state", "var": "light", "value": False}


def needs(*at: str, value: object = True) -> dict[str, Any]:
    return {"conditions": [{"at": a, "var": "light", "value": value} for a in at]}


def gives(value: object, at: str = "start") -> dict[str, Any]:
    return {"effects": [{"at": at, "var": "light", "value": value}]}


def room(*actions: dict[str, Any], initial: bool = True, **fields: Any) -> Task:
    light = {"id": "light", "initial": initial, **fields.pop("light", {})}
    return task_of(*actions, state=[light], resources=HAND, **fields)


@pytest.mark.parametrize("target", ["cpsat", pytest.param("pddl21", marks=pytest.mark.slow)])
def test_what_an_open_action_restores_no_other_takes_away_while_it_is_needed(target: str) -> None:
    task = room(
        action("read", 4, **needs("all")),
        action("on", 1, "hand", **gives(True)),
        action("off", 1, "hand", **needs("start"), **gives(False)),
    )
    old = plan(entry("read", 0, 4), entry("on", 4, 5, "hand"), entry("off", 5, 6, "hand"))
    step = repaired(task, old, 1, DARK, target=target)
    assert starts(step.schedule) == {"read": 0, "light at 1": 1, "on": 1, "off": 4}
    assert sum("needs" in message or "level" in message for message in carried(step)) == 1


def test_a_value_may_change_to_another_while_the_needed_one_is_not_there() -> None:
    """Only the needed value is protected; `cpsat` says so exactly."""
    values = ["green", "amber", "red"]
    task = room(
        action("cross", 4, **needs("all", value="green")),
        action("warn", 1, "hand", **gives("amber")),
        action("clear", 1, "hand", **needs("start", value="amber"), **gives("green")),
        initial="green",
        light={"values": values},
    )
    old = plan(entry("cross", 0, 4), entry("warn", 4, 5, "hand"), entry("clear", 5, 6, "hand"))
    red = {"op": "set_state", "var": "light", "value": "red"}
    step = repaired(task, old, 1, red)
    assert starts(step.schedule) == {"cross": 0, "light at 1": 1, "warn": 1, "clear": 2}


def test_an_open_action_with_a_fixed_start_is_no_history() -> None:
    task = room(
        action("read", 4, **needs("all")),
        action("off", 1, start=2, **gives(False)),
    )
    step = repaired(task, plan(entry("read", 0, 4), entry("off", 4, 5)), 1)
    assert step.schedule.status is Status.INFEASIBLE


def test_a_timed_change_breaks_what_runs_and_is_carried() -> None:
    changes = [{"at": 5, "value": False}, {"at": 9, "value": True}]
    task = room(
        action("read", 7, **needs("all", "end")),
        action("look", 1, **needs("start")),
        light={"changes": changes},
    )
    step = repaired(task, plan(entry("read", 1, 8), entry("look", 9, 10)), 6)
    assert starts(step.schedule) == {"read": 1, "look": 9}
    assert sum("needs" in message for message in carried(step)) == 2


@pytest.mark.parametrize("number", [False, True])
def test_a_schedule_in_force_without_ranks_has_those_under_which_it_is_valid(number: bool) -> None:
    """At 0 `look` comes before `on`, which only ranks can say."""
    light: dict[str, Any] = {"id": "light", "kind": "number"} if number else {"id": "light"}
    dark: dict[str, Any] = {"equals": 0} if number else {"value": False}
    lit: dict[str, Any] = {"add": 1} if number else {"value": True}
    task = task_of(
        action("look", 2, conditions=[{"at": "start", "var": "light", **dark}]),
        action("on", 1, effects=[{"at": "start", "var": "light", **lit}]),
        action("rest", 1),
        state=[light],
    )
    step = repaired(task, plan(entry("look", 0, 2), entry("on", 0, 1), entry("rest", 1, 2)), 1)
    assert starts(step.schedule) == {"look": 0, "on": 0, "rest": 1}
    ranks = {e.id: e.rank for e in step.schedule.entries}
    assert ranks["look"] < ranks["on"]


@pytest.mark.parametrize("at", [2, 3, 4])
def test_what_waits_for_a_timed_change_is_not_left_out(at: int) -> None:
    """Before the change, at its instant, and after it."""
    task = room(
        action("sit", 3),
        action("read", 3, **needs("start")),
        initial=False,
        light={"changes": [{"at": 3, "value": True}]},
    )
    step = repaired(task, plan(entry("sit", 0, 3), entry("read", 5, 8)), at)
    assert starts(step.schedule) == {"sit": 0, "read": max(3, at)}
    assert not step.left_out


@pytest.mark.parametrize("target", TARGETS)
def test_an_end_whose_condition_comes_back_too_late_is_carried(target: str) -> None:
    task = room(
        action("read", 4, **needs("end")), action("on", 1, release=10, **gives(True, "end"))
    )
    step = repaired(task, plan(entry("read", 0, 4), entry("on", 10, 11)), 1, DARK, target=target)
    assert starts(step.schedule) == {"read": 0, "light at 1": 1, "on": 10}
    assert sum("needs" in message or "level" in message for message in carried(step)) == 1


def test_an_end_whose_condition_can_come_back_in_time_gets_it() -> None:
    """Though the whole takes longer than it would if the condition were carried."""
    task = room(
        action("read", 4, **needs("end")),
        action("on", 3, "hand", **gives(True, "end")),
        action("dust", 8, "hand"),
    )
    old = plan(entry("read", 0, 4), entry("dust", 1, 9, "hand"), entry("on", 9, 12, "hand"))
    step = repaired(task, old, 1, DARK)
    assert not any("just before its end" in message for message in carried(step))


@pytest.mark.parametrize("target", TARGETS)
def test_stock_that_comes_too_late_for_what_runs_is_carried(target: str) -> None:
    task = task_of(
        action("bake", 4, consumes=[{"resource": "flour", "at": "end"}]),
        action("mill", 1, release=10, produces=[{"resource": "flour"}]),
        resources=[{"id": "flour", "kind": "reservoir"}],
    )
    step = repaired(task, plan(entry("bake", 0, 4), entry("mill", 10, 11)), 1, target=target)
    assert starts(step.schedule) == {"bake": 0, "mill": 10}
    assert sum("needs" in message or "level" in message for message in carried(step)) == 1


def test_a_failed_occurrence_of_two_happenings_at_one_time_becomes_one() -> None:
    task = room(
        action("flash", {"min": 0, "max": 1}, occurs="optional", **gives(True, "end")),
        action("wait", 6),
        initial=False,
    )
    old = plan(entry("flash", 3, 3, rank=0, end_rank=1), entry("wait", 0, 6))
    failed = {"op": "observe", "action": "flash", "started": 3, "finished": 3, "status": "failed"}
    step = repaired(task, old, 5, failed)
    assert step.schedule.status is Status.OPTIMAL


def test_a_failed_occurrence_whose_end_was_to_have_another_rank_ends_with_that_of_its_start() -> (
    None
):
    task = room(
        action("flash", {"min": 1, "max": 3}, occurs="optional", **gives(True, "end")),
        action("wait", 6),
        initial=False,
    )
    old = plan(entry("flash", 3, 4, rank=0, end_rank=3), entry("wait", 0, 6))
    failed = {"op": "observe", "action": "flash", "started": 3, "finished": 4, "status": "failed"}
    step = repaired(task, old, 5, failed)
    assert step.schedule.status is Status.OPTIMAL


def test_an_observation_at_the_instant_of_a_change_gives_ranks_anew() -> None:
    """Both had rank 0, planned for other times: now they come one after the other."""
    task = room(action("flash", 2, **gives(True), occurs="optional"), action("wait", 6))
    old = plan(entry("flash", 1, 2), entry("light at 0", 0, 0), entry("wait", 0, 6))
    off = {"at": "start", "var": "light", "value": False}
    change = action("light at 0", 0, start=0, effects=[off])
    changed = task.model_validate({**task.model_dump(), "actions": [*task.actions, change]})
    seen = {"op": "observe", "action": "flash", "started": 0, "finished": 2}
    step = repaired(changed, old, 3, seen)
    assert step.schedule.status is Status.OPTIMAL


# --- against every continuation -------------------------------------------------------------------

LATEST = 7
VALUES = ("x", "y", "z")


def random_case(seed: int) -> tuple[Task, Schedule, list[dict[str, Any]]]:
    """Something that runs until 4 and needs a value, and two or three open actions."""
    rng = random.Random(f"carried {seed}")
    values = VALUES[: rng.choice((2, 3, 3))]

    def touching(kind: str, at: tuple[str, ...]) -> list[dict[str, Any]]:
        return [{"at": rng.choice(at), "var": "light", "value": rng.choice(values)}]

    runs = action("runs", 4, conditions=touching("conditions", ("all", "all", "end")))
    before = action("before", rng.choice((2, 3)), effects=touching("effects", ("start", "end")))
    opens = [
        action(
            name,
            rng.choice((0, 1, 2)),
            effects=touching("effects", ("start", "end")),
            **({"conditions": touching("conditions", ("start",))} if rng.random() < 0.5 else {}),
        )
        for name in "abc"[: rng.choice((2, 2, 3))]
    ]
    light = {"id": "light", "values": list(values), "initial": rng.choice(values)}
    if rng.random() < 0.3:
        light["changes"] = [{"at": rng.choice((2, 3, 5)), "value": rng.choice(values)}]
    task = task_of(runs, before, *opens, state=[light])
    past = [entry("runs", 0, 4), entry("before", 0, before["duration"])]
    later = [entry(a["id"], LATEST, LATEST + a["duration"]) for a in opens]
    change = {"op": "set_state", "var": "light", "value": rng.choice(values)}
    return task, plan(*past, *later), [change] if rng.random() < 0.5 else []


def best_makespan(task: Task, step_entries: tuple[Entry, ...]) -> int | None:
    """The least makespan of a continuation that the validator accepts at 1.

    Those in which the end of what runs finds its value come first.
    """
    past = [replace(e, rank=0, end_rank=None) for e in step_entries if e.id not in "abc"]
    opens = [a for a in task.actions if a.id in "abc"]
    best: tuple[bool, int] | None = None
    for times in product(range(1, LATEST), repeat=len(opens)):
        ends = [(a.id, t, t + int(a.duration)) for a, t in zip(opens, times, strict=True)]  # type: ignore[arg-type]
        schedule = Schedule((*past, *(Entry(*e) for e in ends)))
        makespan = int(schedule.makespan)
        if best is not None and (False, makespan) >= best:
            continue
        verdict = validate(task, schedule, at=1)
        if verdict.valid:
            unmet = any("just before its end" in v.message for v in verdict.carried)
            best = min(best or (unmet, makespan), (unmet, makespan))
    return None if best is None else best[1]


def random_number_case(seed: int) -> tuple[Task, Schedule, list[dict[str, Any]]]:
    """Something that runs until 4 and needs a level throughout, and open actions that change it."""
    rng = random.Random(f"carried level {seed}")

    def effect() -> dict[str, Any]:
        change = {"set": rng.randint(0, 4)} if rng.random() < 0.25 else {"add": rng.choice((-2, 2))}
        return {"at": rng.choice(("start", "end")), "var": "fuel", **change}

    limits = rng.choice(({"at_least": 2}, {"at_most": 2}, {"at_least": 1, "at_most": 3}))
    runs = action("runs", 4, conditions=[{"at": "all", "var": "fuel", **limits}])
    before = action("before", rng.choice((2, 3)), effects=[effect()])
    opens = [
        action(name, rng.choice((0, 1, 2)), effects=[effect()])
        for name in "abc"[: rng.choice((2, 2, 3))]
    ]
    fuel = {"id": "fuel", "kind": "number", "initial": rng.randint(0, 4), "min": -9, "max": 9}
    if rng.random() < 0.3:
        fuel |= {"min": 0, "max": 4}
    if rng.random() < 0.3:
        fuel["changes"] = [{"at": rng.choice((2, 3, 5)), "value": rng.randint(0, 4)}]
    task = task_of(runs, before, *opens, state=[fuel])
    past = [entry("runs", 0, 4), entry("before", 0, before["duration"])]
    later = [entry(a["id"], LATEST, LATEST + a["duration"]) for a in opens]
    change = {"op": "set_state", "var": "fuel", "value": rng.randint(0, 4)}
    return task, plan(*past, *later), [change] if rng.random() < 0.6 else []


def test_limits_that_are_met_again_are_not_broken_again_while_they_are_needed() -> None:
    task = task_of(
        action("run", 6, conditions=[{"at": "all", "var": "fuel", "at_least": 3}]),
        action("fill", 1, "hand", effects=[{"at": "end", "var": "fuel", "add": 4}]),
        action(
            "use",
            1,
            "hand",
            conditions=[{"at": "start", "var": "fuel", "at_least": 4}],
            effects=[{"at": "start", "var": "fuel", "add": -4}],
        ),
        state=[{"id": "fuel", "kind": "number", "initial": 4, "min": 0}],
        resources=HAND,
    )
    old = plan(entry("run", 0, 6), entry("fill", 6, 7, "hand"), entry("use", 7, 8, "hand", rank=1))
    empty = {"op": "set_state", "var": "fuel", "value": 1}
    for target in TARGETS:
        step = repaired(task, old, 1, empty, target=target)
        assert starts(step.schedule) == {"run": 0, "fuel at 1": 1, "fill": 1, "use": 6}
        assert sum("needs it to stay" in message for message in carried(step)) == 1


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("fills", [False, True])
def test_a_number_that_what_runs_takes_out_of_its_bounds(target: str, fills: bool) -> None:
    """What is open prevents that if it can; else it is carried."""
    fill = action("fill", 1, effects=[{"at": "end", "var": "fuel", "add": 1}])
    task = task_of(
        action("run", 3, effects=[{"at": "end", "var": "fuel", "add": -1}]),
        action("rest", 1),
        *([{**fill, "occurs": "optional"}] if fills else []),
        state=[{"id": "fuel", "kind": "number", "initial": 1, "min": 0}],
    )
    empty = {"op": "set_state", "var": "fuel", "value": 0}
    step = repaired(task, plan(entry("run", 0, 3), entry("rest", 3, 4)), 1, empty, target=target)
    assert ("fill" in starts(step.schedule)) is fills
    assert any("stays at least 0" in message for message in carried(step)) is not fills


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("of", [random_case, random_number_case])
def test_the_best_continuation_is_the_best_that_the_validator_accepts(of: Any, seed: int) -> None:
    task, old, changes = of(seed)
    step = repaired(task, old, 1, *changes)
    best = best_makespan(step.task, step.schedule.entries or old.entries)
    if step.schedule.answered and not step.left_out:
        # (Ranks that the validator does not look for may allow more.)
        assert best is None or step.schedule.makespan <= best
    elif not step.left_out:
        assert best is None or best >= LATEST
