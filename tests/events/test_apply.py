"""Events revise a task: what each operation makes of it, whatever it was saved as in between."""

from __future__ import annotations

import random
from collections import Counter
from copy import deepcopy
from fractions import Fraction
from typing import Any

import pytest

from irc import InputError
from irc.checks import run_checks
from irc.checks.events import check_event
from irc.driver.judge import validate_schedule
from irc.driver.solve import solve_task
from irc.events.apply import apply
from irc.model import Event, Task
from irc.model.canonical import task_sha256, written_task
from irc.schedule import Entry, Schedule

Document = dict[str, Any]

KITCHEN: Document = {
    "resources": [{"id": "oven", "capacity": 2}, {"id": "flour", "kind": "reservoir"}],
    "state": [{"id": "light"}],
    "actions": [
        {"id": "mix", "duration": 2},
        {"id": "bake", "duration": 5, "uses": [{"resource": "oven"}]},
        {"id": "serve", "duration": 1, "deadline": 30},
    ],
    "precedence": [["mix", "bake"], {"before": "bake", "after": "serve", "min_lag": 1}],
    "groups": [{"id": "order", "actions": ["bake", "serve"], "deadline": 40}],
    "goals": ["serve", "mix"],
}


def kitchen(**more: Any) -> Task:
    return Task(**deepcopy({**KITCHEN, **more}))


def event(*changes: Document, at: Any = 10) -> Event:
    return Event(at=at, changes=changes)


def revised(*changes: Document, at: Any = 10, task: Task | None = None, **starts: int) -> Task:
    return apply(task or kitchen(), event(*changes, at=at), starts)


def change(op: str, **fields: Any) -> Document:
    return {"op": op, **fields}


def capacity_at(task: Task, moment: Any, resource: str = "oven") -> int:
    (found,) = (r for r in task.resources if r.id == resource)
    inside = [w.capacity for w in found.availability if w.from_ <= moment < w.to]
    assert len(inside) <= 1
    return inside[0] if inside else found.capacity


def action(task: Task, name: str) -> Any:
    (found,) = (a for a in task.actions if a.id == name)
    return found


# --- capacities ---------------------------------------------------------------------------------


def test_a_capacity_without_a_window_holds_from_the_event_on() -> None:
    task = revised(change("set_capacity", resource="oven", capacity=1))
    assert [capacity_at(task, t) for t in (0, Fraction("9.9"), 10, 10**9)] == [2, 2, 1, 1]


def test_a_failure_in_a_window_leaves_the_rest_as_it_was() -> None:
    fault = change("set_capacity", resource="oven", capacity=0, **{"from": 12, "to": 15})
    task = revised(fault)
    assert [capacity_at(task, t) for t in (11, 12, 14, 15)] == [2, 0, 0, 2]


def test_a_window_changes_nothing_before_its_event() -> None:
    fault = change("set_capacity", resource="oven", capacity=0, **{"from": 3, "to": 15})
    assert [capacity_at(revised(fault), t) for t in (3, 9, 10, 15)] == [2, 2, 0, 2]


@pytest.mark.parametrize("seed", range(200))
def test_capacities_are_at_each_instant_what_the_last_change_says(seed: int) -> None:
    rng = random.Random(seed)
    borders = sorted(rng.sample(range(30), 4))
    windows = [
        {"from": a, "to": b, "capacity": rng.randint(0, 4)} for a, b in (borders[:2], borders[2:])
    ]
    task = kitchen(resources=[{"id": "oven", "capacity": 2, "availability": windows}])
    expected = [capacity_at(task, t) for t in range(40)]
    at = 0
    for _ in range(rng.randint(1, 4)):
        at += rng.randint(0, 8)
        fault = change("set_capacity", resource="oven", capacity=rng.randint(0, 4))
        begin, end = at, 40
        if rng.random() < 0.5:
            begin = fault["from"] = at + rng.randint(-3, 5) if at >= 3 else at
        if rng.random() < 0.6:
            end = fault["to"] = max(at, begin) + rng.randint(1, 6)
        expected = [
            fault["capacity"] if max(at, begin) <= t < end else c for t, c in enumerate(expected)
        ]
        task = apply(task, event(fault, at=at))
    assert [capacity_at(task, t) for t in range(40)] == expected
    report = run_checks(task, lint=False).report
    assert report.ok or report.contradicts


# --- cancellations ------------------------------------------------------------------------------


def test_what_is_cancelled_may_have_ended_by_then_but_cannot_happen_later() -> None:
    task = revised(change("cancel_actions", actions=["bake"]))
    others = (Entry("mix", 0, 2), Entry("serve", 12, 13))

    def verdict(start: int) -> bool:
        baked = Entry("bake", start, start + 5, {"oven": 1})
        return validate_schedule(task, Schedule((*others, baked))).valid

    assert verdict(5)
    assert not verdict(6)
    assert validate_schedule(task, Schedule(others)).valid


def test_precedences_goals_and_groups_no_longer_name_what_is_cancelled() -> None:
    task = revised(change("cancel_actions", actions=["serve"]))
    assert [(e.before, e.after) for e in task.precedence] == [("mix", "bake")]
    assert task.goals == ("mix",)
    assert task.groups[0].actions == ("bake",)
    emptied = revised(change("cancel_actions", actions=["serve", "bake"]))
    assert emptied.groups == ()


def test_a_group_that_is_taken_back_takes_along_only_what_no_other_group_wants() -> None:
    groups = [*KITCHEN["groups"], {"id": "party", "actions": ["bake"]}]
    task = revised(change("cancel_groups", groups=["order"]), task=kitchen(groups=groups))
    assert [g.id for g in task.groups] == ["party"]
    assert action(task, "bake").occurs == "once"
    assert (action(task, "serve").occurs, action(task, "serve").deadline) == ("optional", 10)


def test_a_cancelled_task_is_solved_without_what_was_cancelled() -> None:
    schedule = solve_task(revised(change("cancel_groups", groups=["order"]))).schedule
    assert [entry.id for entry in schedule.entries] == ["mix"]


# --- the world and what is seen of it -----------------------------------------------------------


def test_a_change_of_the_world_is_seen_by_what_comes_after_it() -> None:
    seen = {"conditions": [{"at": "start", "var": "light"}]}
    actions = [{"id": "read", "duration": 1, **seen}]
    dark = Task(state=[{"id": "light"}], actions=actions)
    lit = revised(change("set_state", var="light"), at=Fraction("2.29"), task=dark)
    start = {e.id: e.start for e in solve_task(lit).schedule.entries}
    assert start == {"light at 2.29": Fraction("2.29"), "read": Fraction("2.29")}


def test_of_two_changes_of_one_variable_at_one_instant_the_later_counts() -> None:
    for last in (True, False):
        changes = [change("set_state", var="light", value=v) for v in (not last, last)]
        task = revised(*changes, change("set_goals", goals=[{"var": "light", "value": last}]))
        assert solve_task(task).schedule.answered
        wrong = revised(*changes, change("set_goals", goals=[{"var": "light", "value": not last}]))
        assert not solve_task(wrong).schedule.answered


def test_an_id_that_is_taken_is_not_given_to_a_change_of_the_world() -> None:
    taken = [{"id": "light at 10", "duration": 3}, *KITCHEN["actions"]]
    task = revised(change("set_state", var="light"), task=kitchen(actions=taken))
    assert action(task, "light at 10 (2)").start == 10
    assert len(task.precedence) == 2


def test_what_was_observed_is_what_the_task_says() -> None:
    seen = change("observe", action="bake", started=4, finished=8)
    task = revised(seen)
    assert (action(task, "bake").start, action(task, "bake").duration) == (4, 4)


def test_an_observed_end_needs_a_start_and_takes_it_from_the_schedule() -> None:
    seen = change("observe", action="bake", finished=8)
    assert action(revised(seen, bake=2), "bake").duration == 6
    with pytest.raises(InputError, match="IRC704"):
        revised(seen)


def test_what_did_start_is_not_held_to_its_release() -> None:
    late = revised(change("set_release", action="bake", release=7), at=1)
    task = revised(change("observe", action="bake", started=4), task=late)
    assert action(task, "bake").release == 4


def test_what_did_start_is_not_held_to_its_latest_start() -> None:
    serve = {"id": "serve", "duration": 1, "latest_start": 3}
    actions = [serve if a["id"] == "serve" else a for a in KITCHEN["actions"]]
    seen = change("observe", action="serve", started=4)
    task = revised(seen, task=kitchen(actions=actions))
    assert (action(task, "serve").start, action(task, "serve").latest_start) == (4, 4)


# --- the function as a whole --------------------------------------------------------------------


def test_an_event_of_the_task_is_no_longer_among_its_events() -> None:
    events = [
        {"at": 1, "changes": [change("set_release", action="mix", release=3)]},
        {"at": 2, "changes": []},
    ]
    task = kitchen(events=events)
    after = apply(task, task.events[0])
    assert [e.at for e in after.events] == [2]
    assert [e.at for e in task.events] == [1, 2]


def test_an_event_that_does_not_fit_is_told_where_it_stands_and_not_applied() -> None:
    wrong = event(
        change("set_release", action="mix", release=3), change("cancel_actions", actions=["back"])
    )
    (found,) = check_event(kitchen(), wrong)
    assert (found.code.id, found.pointer) == ("IRC201", ("changes", 1, "actions", 0))
    assert found.hint == "did you mean `bake`?"
    with pytest.raises(InputError):
        apply(kitchen(), wrong)


def test_over_stays_over_from_one_event_to_the_next() -> None:
    task = revised(change("cancel_actions", actions=["bake"]), at=3)
    for late in (
        change("cancel_actions", actions=["bake"]),
        change("set_deadline", action="bake", deadline=50),
        change("add_groups", groups=[{"id": "new", "actions": ["bake"]}]),
    ):
        (found,) = check_event(task, event(late, at=3))
        assert found.code.id == "IRC702"


_OPERATIONS = 16


def _random_change(rng: random.Random, task: Task, at: int, number: int) -> Document:
    """A change of any operation that may or may not fit the task."""
    name = rng.choice([a.id for a in task.actions])
    other = rng.choice([a.id for a in task.actions])
    group = rng.choice([*(g.id for g in task.groups), "order"])
    edge = {"before": name, "after": other}
    edges = [{"before": e.before, "after": e.after} for e in task.precedence] or [edge]
    window = {"from": at + rng.randint(0, 3), "to": at + rng.randint(4, 6)}
    oven = {"resource": "oven", "capacity": rng.randint(0, 3)}
    added = {"id": f"new {number}", "duration": "1/3", "uses": [{"resource": "oven"}]}
    changes = [
        change("add_actions", actions=[added]),
        change("cancel_actions", actions=[name]),
        change("set_duration", action=name, duration=rng.choice([0.1, "2 min", 7])),
        change("add_precedence", precedence=[{**edge, "min_lag": rng.randint(-2, 3)}]),
        change("remove_precedence", precedence=[rng.choice(edges)]),
        change("add_resources", resources=[{"id": f"robot {number}"}]),
        change("set_capacity", **oven, **rng.choice([{}, window])),
        change("set_deadline", deadline=at + 50, **rng.choice([{}, {"action": name}])),
        change("set_release", action=name, release="0.5 h"),
        change("add_groups", groups=[{"id": f"group {number}", "actions": [name]}]),
        change("cancel_groups", groups=[group]),
        change("set_goals", goals=[name, {"var": "light"}]),
        change("set_state", var="light", value=rng.random() < 0.5),
        change("add_state", state=[{"id": f"fact {number}", "values": ["a", "b"], "initial": "a"}]),
        change("set_objective", objective=["maximize_reward", "minimize_makespan"]),
        change("observe", action=name, started=max(0, at - 3), finished=at),
    ]
    assert len(changes) == _OPERATIONS
    return rng.choice(changes)


@pytest.mark.slow
def test_saving_between_events_changes_nothing_and_every_revision_is_a_sound_task() -> None:
    applied: Counter[str] = Counter()
    for seed in range(200):
        rng = random.Random(seed)
        straight = saved = kitchen()
        at = 0
        for number in range(rng.randint(1, 5)):
            at += rng.randint(0, 6)
            raw = _random_change(rng, straight, at, number)
            earlier, before = straight, written_task(straight)
            revision = event(raw, at=at)
            if not check_event(straight, revision).ok:
                with pytest.raises(InputError):
                    apply(straight, revision)
                continue
            straight = apply(straight, revision)
            applied[raw["op"]] += 1
            assert written_task(earlier) == before
            saved = apply(Task.model_validate(written_task(saved)), revision)
            assert written_task(saved) == written_task(straight)
            assert task_sha256(saved) == task_sha256(straight)
            codes = {d.code.id for d in run_checks(straight, lint=False).report.errors}
            assert not {c for c in codes if c.startswith(("IRC1", "IRC2"))}, (raw, codes)
    assert len(applied) == _OPERATIONS
    assert min(applied.values()) >= 20, applied
