"""Times that come in while a task runs: rounded, reported once, and refused where none can plan."""

from __future__ import annotations

import json
import random
from fractions import Fraction
from typing import Any

import pytest

import irc
from irc.diagnostics import InputError
from irc.model import Event, Task
from irc.schedule import Entry, Schedule
from irc_pddl21 import Pddl21
from oracles.clock_sessions import faults_of_session
from paths import SHARED_DATA
from runs import run_irc

ARM = {"uses": [{"resource": "arm"}]}


def robot(**more: Any) -> Task:
    return Task.model_validate(
        {
            "resources": [{"id": "arm"}],
            "actions": [
                {"id": "a", "duration": 2.5, **ARM},
                {"id": "b", "duration": 1.25, **ARM},
                {"id": "c", "duration": 4, **ARM},
            ],
            "precedence": [["a", "b"]],
            **more,
        }
    )


def running(task: Task | None = None, **options: Any) -> irc.Execution:
    task = task or robot()
    return irc.Execution(task, irc.solve(task, **options), **options)


def observed(at: Any, action: str, **times: Any) -> Event:
    change = {"op": "observe", "action": action, **times}
    return Event.model_validate({"at": at, "changes": [change]})


KAIROS = Pddl21().engines()["kairos"]
TARGETS = [
    "cpsat",
    pytest.param(
        "pddl21", marks=pytest.mark.skipif(KAIROS.missing() is not None, reason="no kairos")
    ),
]


@pytest.mark.parametrize("target", TARGETS)
def test_a_raw_double_of_a_clock_is_rounded_and_planned_on(target: str) -> None:
    run = running(target=target)
    run.advance(1)
    report = run.observe("c", started=0.10003671646118173)
    (note,) = report.diagnostics
    assert (note.code.id, note.pointer) == ("IRC108", ("changes", 0, "started"))
    assert "0.10003671646118173 is taken as 0.1 s" in note.message
    step = run.replan()
    assert step.schedule["c"].start == Fraction(1, 10)
    assert step.schedule.makespan == Fraction(785, 100)
    assert irc.validate(step.task, step.schedule, at=1).valid


def test_the_rounding_is_reported_once() -> None:
    run = running()
    run.advance(0.123456789)
    assert run.now == Fraction(123, 1000)
    assert [n.code.id for n in run.take_notes()] == ["IRC108"]
    assert not run.observe("c", started=0.0123456789).diagnostics
    assert not run.apply(observed(4.0000123, "c", finished=4.0000121)).diagnostics
    assert not [n for n in run.replan().notes if n.code.id == "IRC108"]


def test_what_was_not_reported_yet_comes_with_the_next_report_or_step() -> None:
    run = running()
    run.advance(0.123456789)
    assert [n.code.id for n in run.replan().notes] == ["IRC108"]
    again = running()
    again.advance(0.123456789)
    again_report = again.observe("c", started=0)
    assert [n.code.id for n in again_report] == ["IRC108"]


def test_a_refused_event_reports_nothing_and_changes_nothing() -> None:
    run = running()
    before = run.copy()
    with pytest.raises(InputError):
        run.apply(observed(0.123456789, "x", started=0.1))
    assert run == before
    assert [n.code.id for n in run.apply(observed(0.123456789, "c", started=0))] == ["IRC108"]


def test_times_that_are_no_finer_stay_as_they_are() -> None:
    run = running()
    assert not run.apply(observed("7/3", "c", started="1/3")).diagnostics
    assert run.now == Fraction(7, 3)
    thirds = Task.model_validate({"actions": [{"id": "a", "duration": "1/30000"}]})
    again = irc.Execution(thirds, irc.solve(thirds))
    again.advance("1/30000")
    assert again.now == Fraction(1, 30000)


@pytest.mark.parametrize("target", TARGETS)
def test_a_given_resolution_holds_for_all_that_comes_in(target: str) -> None:
    run = running(robot(resolution="0.5 s"), target=target)
    assert run.schedule["a"].duration == Fraction(5, 2)
    assert run.schedule["b"].duration == Fraction(3, 2)  # 1.25 s are half way
    run.apply(observed("4.2 s", "c", started="0.3 s"))
    assert (run.now, run.task.number(run.task.actions[2].start)) == (4, Fraction(1, 2))
    step = run.replan()
    assert {(e.start * 2).denominator for e in step.schedule} == {1}


def test_the_plan_and_the_present_are_rounded_too() -> None:
    plan = Schedule((Entry("c", 0.0, 4, {"arm": 1}),))
    raw = Fraction("0.10003671646118173")
    plan = Schedule((Entry("c", raw, raw + 4, {"arm": 1}),))
    run = irc.Execution(robot(), plan, Fraction("1.00000000000000013"))
    assert (run.schedule["c"].start, run.schedule["c"].end, run.now) == (
        Fraction(1, 10),
        Fraction(41, 10),
        1,
    )
    step = run.replan()
    assert step.schedule["c"].start == Fraction(1, 10)
    (note,) = [n for n in step.notes if n.code.id == "IRC108"]
    assert note.pointer == ("actions", 0, "start")


def test_a_short_new_duration_makes_the_resolution_finer() -> None:
    run = running()
    short = {"id": "d", "duration": 0.0004}
    add = {"op": "add_actions", "actions": [short]}
    assert not run.apply(Event.model_validate({"at": 1, "changes": [add]})).diagnostics
    run.apply(observed(1.23456789, "c", started=0.00000012))
    step = run.replan()
    assert step.schedule["d"].duration == Fraction(4, 10_000)
    assert step.schedule["c"].start == Fraction(1, 10**7)


@pytest.mark.parametrize(
    "change",
    [
        {"op": "add_actions", "actions": [{"id": "d", "duration": 0.0004}]},
        {"op": "set_duration", "action": "a", "duration": 0.0004},
    ],
)
def test_a_duration_shorter_than_a_given_resolution_is_refused(change: Any) -> None:
    run = running(robot(resolution="1 ms"))
    with pytest.raises(InputError) as refused:
        run.apply(Event.model_validate({"at": 1, "changes": [change]}))
    (found,) = refused.value.report.errors
    assert (found.code.id, found.pointer[-1]) == ("IRC109", "duration")


@pytest.mark.parametrize("target", TARGETS)
def test_a_time_with_which_no_plan_can_be_made_is_refused_as_it_comes_in(target: str) -> None:
    run = running(target=target)
    change = {"op": "set_duration", "action": "a", "duration": 1e25}
    with pytest.raises(InputError) as refused:
        run.apply(Event.model_validate({"at": 1, "changes": [change]}))
    (found,) = refused.value.report.errors
    assert (found.code.id, found.pointer) == ("IRC502", ("changes", 0, "duration"))
    with pytest.raises(InputError, match="beyond"):
        run.advance(1e25)
    assert run.replan().schedule.answered


def test_a_feature_that_the_target_lacks_is_refused_as_it_comes_in() -> None:
    run = running(target="pddl21")
    change = {"op": "set_objective", "objective": "minimize_earliness"}
    with pytest.raises(InputError) as refused:
        run.apply(Event.model_validate({"at": 1, "changes": [change]}))
    assert [d.code.id for d in refused.value.report.errors] == ["IRC501"]
    assert run.task.objective == ("minimize_makespan",)


def test_an_own_event_with_raw_times_is_applied_and_gone() -> None:
    own = {"at": 0.10003671646118173, "changes": [{"op": "observe", "action": "c", "started": 0.1}]}
    task = irc.loads(robot(events=[own]).model_dump_json(exclude_unset=True)).ir
    episode = irc.simulate(task)
    assert episode.steps[1].at == Fraction(1, 10)
    assert episode.steps[1].task.events == ()
    (note,) = [n for n in episode.steps[1].notes if n.code.id == "IRC108"]
    assert note.pointer == ("events", 0, "at")


@pytest.mark.parametrize("seed", range(12))
def test_whatever_a_clock_says_is_accepted_and_planned_on(seed: int) -> None:
    rng = random.Random(seed)
    lengths = [rng.choice([rng.uniform(0.2, 3), rng.randint(1, 4), 0.1 + 0.2]) for _ in range(4)]
    names = [f"a{k}" for k in range(4)]
    task = Task.model_validate(
        {
            "resources": [{"id": "arm"}],
            "actions": [
                {"id": n, "duration": d, **ARM} for n, d in zip(names, lengths, strict=True)
            ],
            "precedence": [["a0", "a1"]],
        }
    )
    run = irc.Execution(task, irc.solve(task))
    for entry in list(run.schedule):
        late = run.schedule[entry.id].start + Fraction(repr(rng.uniform(0, 0.5)))
        started = max(late, run.now)
        run.apply(observed(started, entry.id, started=started))
        step = run.replan()
        assert step.schedule.answered, step.notes
        ended = started + Fraction(repr(rng.uniform(0.01, 4)))
        run.apply(observed(ended, entry.id, finished=ended))
        step = run.replan()
        assert step.schedule.answered, step.notes
        assert irc.validate(step.task, step.schedule, at=step.at).valid


@pytest.mark.slow
@pytest.mark.parametrize(("target", "seeds"), [("cpsat", range(8)), ("pddl21", range(3))])
def test_whatever_time_is_accepted_can_be_planned_with(target: str, seeds: range) -> None:
    if target == "pddl21" and KAIROS.missing() is not None:
        pytest.skip("no kairos")
    assert {s: told for s in seeds if (told := list(faults_of_session(s, target)))} == {}


# --- cases that people had ------------------------------------------------------------------------

CASES = SHARED_DATA / "cases"
needs_cases = pytest.mark.skipif(
    not (CASES / "raw_float.json").exists(), reason="the cases are not there"
)


@pytest.mark.slow
@needs_cases
@pytest.mark.parametrize("target", TARGETS)
def test_a_session_with_a_raw_double_goes_on(target: str) -> None:
    requests = (CASES / "raw_float.jsonl").read_text()
    told = run_irc("run", CASES / "raw_float.json", "--stdio", "--target", target, stdin=requests)
    answers = [json.loads(line) for line in told.stdout.splitlines()]
    assert [answer["ok"] for answer in answers] == [True] * 4
    assert [note["code"] for answer in answers for note in answer["notes"]] == ["IRC108"]
    assert answers[-1]["step"]["schedule"]["makespan"] == 7.85


@pytest.mark.slow
@needs_cases
@pytest.mark.parametrize("target", TARGETS)
def test_a_nanosecond_beside_a_billion_seconds_is_refused_by_its_name(target: str) -> None:
    told = run_irc("solve", CASES / "tiny_and_huge.json", "--target", target)
    assert told.exit_code == 1
    assert "IRC502" in told.stderr
    assert "0.000000001 s stands beside 1000000000 s" in told.stderr
    assert "tiny_and_huge.json:1:59" in told.stderr
