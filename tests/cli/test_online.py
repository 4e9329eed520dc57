"""`irc replan` and `irc simulate`: what they take, what they show, what they write."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import Result

from paths import EXAMPLES
from runs import run_irc

MORNING = EXAMPLES / "pancake_morning.json"
VAN: dict[str, Any] = {
    "name": "van",
    "time_unit": "min",
    "resources": [{"id": "van"}],
    "actions": [
        {"id": name, "duration": 10, "uses": [{"resource": "van"}]} for name in ("ann", "bob")
    ],
    "precedence": [["ann", "bob"]],
}
PLAN = {
    "actions": [
        {"id": "ann", "start": 0, "end": 10, "resources": {"van": 1}},
        {"id": "bob", "start": 10, "end": 20, "resources": {"van": 1}},
    ]
}
LONGER = {"op": "set_duration", "action": "ann", "duration": 12}


@pytest.fixture
def van(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a task and its plan."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "van.json").write_text(json.dumps(VAN))
    (tmp_path / "plan.json").write_text(json.dumps(PLAN))
    return tmp_path


def replan(at: str, *options: str, input: str | None = None) -> Result:
    return run_irc(
        "replan", "van.json", "--schedule", "plan.json", "--at", at, *options, stdin=input
    )


def starts(schedule: dict[str, Any]) -> dict[str, Any]:
    return {entry["id"]: entry["start"] for entry in schedule["actions"]}


# --- replan -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "document", [{"changes": [LONGER]}, [{"at": "2.29 min", "changes": [LONGER]}]]
)
def test_an_event_or_a_list_of_them_comes_from_standard_input(van: Path, document: Any) -> None:
    result = replan("2.29", "--event", "-", "--format", "json", input=json.dumps(document))
    assert (result.exit_code, result.stderr) == (0, "")
    step = json.loads(result.stdout)
    assert (step["irc_step"], step["at"], step["running"], step["moved"]) == ("1", 2.29, ["ann"], 1)
    assert starts(step["schedule"]) == {"ann": 0, "bob": 12}


def test_events_are_found_in_a_language_models_answer(van: Path) -> None:
    answer = f"Sure [1]:\n```json\n{json.dumps([{'changes': [LONGER]}], indent=1)}\n```\nDone."
    result = replan("3", "--event", "-", input=answer)
    assert result.exit_code == 0
    assert "note[IRC003]: there is a code fence around the JSON document" in result.stderr
    assert "moved 1: bob 10 → 12" in result.stdout
    wrong = answer.replace("ann", "anne")
    told = replan("3", "--event", "-", input=wrong).stderr
    assert "<stdin>:8:15" in told
    assert "did you mean `ann`?" in told


def test_events_can_be_written_in_the_dsl(van: Path) -> None:
    (van / "jam.irc").write_text("event jam at 3: set duration of ann = 12\n")
    step = json.loads(replan("3", "--event", "jam.irc", "--format", "json").stdout)
    assert (step["event"], starts(step["schedule"])) == (["jam"], {"ann": 0, "bob": 12})
    text = "# a jam\nevent at 3:\n    set duration of anne = 12\n"
    told = replan("3", "--event", "-", input=text).stderr
    assert "<stdin>:3:21" in told
    assert "did you mean `ann`?" in told


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("event at 3: cancel bob\ncarl 3\n", "x.irc:2:1"),
        ("unit min\nevent at 3: cancel bob\n", "x.irc:1:6"),
        ("event at 3: set deadline of bob = 12\n", "x.irc:1:26"),
        ("event at 2: cancel bob\n", "x.irc:1:10"),
        ("\n", "x.irc:1:1"),
    ],
)
def test_a_file_of_events_in_the_dsl_has_nothing_else(van: Path, text: str, place: str) -> None:
    (van / "x.irc").write_text(text)
    result = replan("3", "--event", "x.irc")
    assert (result.exit_code, result.stdout) == (1, "")
    assert f"--> {place}\n" in result.stderr
    assert "hint: " in result.stderr


def test_several_events_are_taken_in_their_order(van: Path) -> None:
    (van / "one.json").write_text(json.dumps([{"changes": [LONGER]}, {"changes": []}]))
    added = {"op": "add_actions", "actions": [{"id": "eve", "duration": 1}]}
    (van / "two.json").write_text(json.dumps({"changes": [{**LONGER, "duration": 15}, added]}))
    result = replan("3", "--event", "one.json", "--event", "two.json", "--format", "json")
    step = json.loads(result.stdout)
    assert step["event"] == [None, None, None]
    assert starts(step["schedule"]) == {"ann": 0, "eve": 3, "bob": 15}


def test_the_text_says_what_happened_what_is_settled_and_what_moved(van: Path) -> None:
    (van / "jam.json").write_text(json.dumps({"id": "jam", "changes": [LONGER]}))
    lines = replan("4", "--event", "jam.json", "-o", "new.json").stdout.splitlines()
    assert lines[:6] == [
        "at 4 min: jam  optimal",
        "  ann takes 12 min",
        "running 1: ann",
        "moved 1: bob 10 → 12",
        "other ends: ann 10 → 12",
        "makespan 22 min, changes 1",
    ]
    assert [line.split() for line in lines[-2:]] == [
        ["ann", "0", "12", "van", "running"],
        ["bob", "12", "22", "van", "was", "10"],
    ]


def test_date_times_are_also_told_in_the_tasks_unit(van: Path) -> None:
    (van / "van.json").write_text(json.dumps({**VAN, "origin": "2026-03-01T17:00:00"}))
    until = {"op": "set_capacity", "resource": "van", "capacity": 0, "to": "2026-03-01T17:30:00"}
    event = json.dumps({"at": "2026-03-01T17:10:00", "changes": [until]})
    told = replan("10", "--event", "-", input=event).stdout
    assert "van has a capacity of 0 until 2026-03-01T17:30:00 (30 min)" in told


def test_what_is_stopped_while_it_runs_is_not_called_done(van: Path) -> None:
    event = {"changes": [{"op": "cancel_actions", "actions": ["ann"]}]}
    result = replan("4", "--event", "-", input=json.dumps(event))
    lines = result.stdout.splitlines()
    assert lines[1:4] == ["  cancelled: ann", "stopped 1: ann", "moved 1: bob 10 → 4"]
    assert lines[-2].split() == ["ann", "0", "4", "van", "cancelled"]


def test_the_next_step_goes_on_from_what_the_last_one_wrote(van: Path) -> None:
    (van / "jam.json").write_text(json.dumps({"changes": [LONGER]}))
    assert (
        replan("4", "--event", "jam.json", "-o", "s.json", "--task-output", "t.irc").exit_code == 0
    )
    result = run_irc(
        "replan", "van.json", "--schedule", "s.json", "--at", "12", "--event", "jam.json"
    )
    assert result.exit_code == 1
    assert "made for another task, or the task has changed since" in result.stderr
    late = {"changes": [{"op": "observe", "action": "bob", "started": 13}]}
    (van / "late.json").write_text(json.dumps(late))
    arguments = ("--schedule", "s.json", "--at", "13", "--event", "late.json", "--format", "json")
    step = json.loads(run_irc("replan", "t.irc", *arguments).stdout)
    assert (step["completed"], step["running"]) == (["ann"], ["bob"])
    assert step["schedule"]["makespan"] == 23


@pytest.mark.slow
def test_of_a_task_with_events_of_its_own_those_of_the_time_apply(tmp_path: Path) -> None:
    plan, first, second = (tmp_path / f"{k}.json" for k in range(3))
    run_irc("solve", MORNING, "-o", plan)
    assert run_irc("replan", MORNING, "-s", plan, "--at", "1", "-o", first).exit_code == 0
    result = run_irc("replan", MORNING, "-s", first, "--at", "3", "-o", second, "--format", "json")
    step = json.loads(result.stdout)
    assert step["event"] == ["griddle fails"]
    named = run_irc("replan", MORNING, "-s", first, "--at", "3", "--event", "#griddle fails")
    assert named.stdout.startswith("at 3 min: griddle fails  optimal")
    # By the schedule of before any event, what came until then has happened since.
    since = run_irc("replan", MORNING, "-s", plan, "--at", "3", "--format", "json")
    assert json.loads(since.stdout)["event"] == ["late start", "griddle fails"]
    simulated = json.loads(run_irc("simulate", MORNING, "--format", "json").stdout)
    assert simulated["steps"][2]["schedule"]["actions"] == step["schedule"]["actions"]


@pytest.mark.parametrize(
    ("options", "code", "message"),
    [
        (("--at", "soon"), 2, "--at soon: cannot read 'soon' as a time"),
        (("--at", "-1"), 2, "the task begins at 0"),
        (("--at", "3", "--event", "-", "--event", "-"), 2, "only one of the inputs"),
        (("--at", "3", "--event", "#jam"), 1, "the task has no event '#jam'"),
        (("--at", "3", "--event", "no.json"), 1, "cannot read 'no.json'"),
        (("--at", "3", "--engine", "abacus"), 2, "there is no engine 'abacus'"),
        (("--at", "3", "--stability", "-5%"), 2, "stability"),
        (("--at", "3", "--stability", "5"), 2, "5 is more than the whole"),
    ],
)
def test_wrong_use_is_told_in_a_line(
    van: Path, options: tuple[str, ...], code: int, message: str
) -> None:
    result = run_irc("replan", "van.json", "--schedule", "plan.json", *options)
    assert (result.exit_code, result.stdout) == (code, "")
    assert message in " ".join(result.stderr.split())


def test_a_schedule_that_is_no_plan_or_not_of_this_task_is_refused(van: Path) -> None:
    (van / "plan.json").write_text('{"status": "infeasible", "actions": []}')
    assert "its status is infeasible" in replan("3").stderr
    (van / "plan.json").write_text('{"actions": [{"id": "tim", "start": 0, "end": 10}]}')
    result = replan("3")
    assert result.exit_code == 1
    assert "plan.json:1:" in result.stderr
    assert "'tim', which the task does not have" in result.stderr


def test_where_nothing_continues_what_has_run_the_old_plan_stays(van: Path) -> None:
    event = json.dumps({"changes": [{"op": "set_deadline", "deadline": 15}]})
    result = replan("3", "--event", "-", "-o", "new.json", input=event)
    assert result.exit_code == 1
    assert result.stdout.startswith("at 3 min: an event  infeasible\n")
    assert "keeping the previous plan" in result.stdout
    assert not (van / "new.json").exists()


# --- simulate -----------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_simulation_tells_each_step_and_ends_with_the_verdict(tmp_path: Path) -> None:
    result = run_irc("simulate", MORNING, "-o", tmp_path / "s.json", "--steps", tmp_path / "steps")
    heads = [line for line in result.stdout.splitlines() if line.startswith("at ")]
    assert heads == [
        "at 0 min: the plan  optimal",
        "at 1 min: late start  optimal",
        "at 3 min: griddle fails  optimal",
        "at 9 min: guest  optimal",
    ]
    assert result.stdout.endswith(
        "4 steps, moved 4 in total\nmakespan 17 min, reward 10, changes 0\n"
        "valid: makespan 17 min, reward 10\n"
    )
    documents = [json.loads(p.read_text()) for p in sorted((tmp_path / "steps").iterdir())]
    whole = json.loads(run_irc("simulate", MORNING, "--format", "json").stdout)
    for one, other in zip(documents, whole["steps"], strict=True):
        assert starts(one["schedule"]) == starts(other["schedule"])
        assert {**one, "schedule": 0} == {"irc_step": "1", **other, "schedule": 0}
    final = json.loads((tmp_path / "s.json").read_text())
    assert final["actions"] == whole["final"]["actions"]
    assert (whole["irc_simulation"], whole["makespan"], whole["moved"]) == ("1", 17, 4)


def test_a_simulation_begins_with_the_schedule_it_is_given_and_goes_on_without_a_way_on(
    van: Path,
) -> None:
    events = [
        {"id": "fog", "at": 2, "changes": [{"op": "set_deadline", "deadline": 15}]},
        {"id": "sun", "at": 5, "changes": []},
    ]
    (van / "van.json").write_text(json.dumps({**VAN, "events": events}))
    late = {
        **PLAN,
        "actions": [{**a, "end": a["end"] + 1, "start": a["start"] + 1} for a in PLAN["actions"]],
    }
    (van / "plan.json").write_text(json.dumps(late))
    result = run_irc("simulate", "van.json", "--schedule", "plan.json")
    assert result.exit_code == 1
    assert "makespan 21 min" in result.stdout
    assert "at 2 min: fog  infeasible" in result.stdout
    assert "at 5 min: fog, sun  infeasible" in result.stdout
    assert (
        json.loads(run_irc("simulate", "van.json", "--format", "json").stdout)["makespan"] is None
    )
