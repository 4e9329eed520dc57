"""`irc show`, the files that commands write for people, and times by the clock."""

from __future__ import annotations

import json
import re
from functools import cache
from pathlib import Path
from typing import Any

import pytest

import irc
from irc.model import Task
from irc.schedule import Schedule
from runs import run_irc

WEEK: dict[str, Any] = {
    "name": "week",
    "time_unit": "h",
    "origin": "2026-10-22T06:00:00+02:00",
    "calendars": [
        {"id": "day", "time_zone": "Europe/Berlin", "open": [{"from": "06:00", "to": "14:00"}]}
    ],
    "resources": [{"id": "booth", "calendar": "day"}],
    "actions": [
        {"id": "sand", "duration": 6, "uses": [{"resource": "booth"}]},
        {"id": "paint", "duration": 10, "uses": [{"resource": "booth"}], "breaks": "pause"},
    ],
    "precedence": [["sand", "paint"]],
    "groups": [{"id": "frame", "actions": ["sand", "paint"], "due": "2026-10-23T10:00:00+02:00"}],
    "events": [{"at": 2, "changes": [{"op": "set_duration", "action": "paint", "duration": 12}]}],
}


@cache
def planned() -> Schedule:
    """The plan of the week."""
    return irc.solve(WEEK, workers=1)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a task, its plan, and a task without dates."""
    plan = planned()
    (tmp_path / "week.json").write_text(json.dumps(WEEK), encoding="utf-8")
    (tmp_path / "plan.json").write_text(json.dumps(plan.to_dict()), encoding="utf-8")
    (tmp_path / "bare.json").write_text('{"actions": [{"id": "a", "duration": 3}]}', "utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.usefixtures("folder")
def test_a_saved_schedule_is_shown_by_the_clock() -> None:
    result = run_irc("show", "week.json", "plan.json")
    assert result.exit_code == 0, result.stderr
    assert "Thu 22 Oct 2026 06:00 to Fri 23 Oct 2026 14:00 (Europe/Berlin)" in result.stdout
    assert "paint   Thu 12:00  Fri 14:00" in result.stdout
    assert "▁ pause" in result.stdout


@pytest.mark.usefixtures("folder")
def test_times_are_numbers_where_that_is_asked_for() -> None:
    result = run_irc("show", "week.json", "plan.json", "--times", "unit")
    assert "start (h)" in result.stdout
    assert "Oct" not in result.stdout


@pytest.mark.usefixtures("folder")
def test_dates_without_an_origin_are_refused() -> None:
    result = run_irc("solve", "bare.json", "--times", "clock")
    assert result.exit_code == 2
    assert "the task has no 'origin'" in result.stderr


@pytest.mark.usefixtures("folder")
def test_a_schedule_of_another_task_is_refused_with_its_place() -> None:
    result = run_irc("show", "bare.json", "plan.json")
    assert result.exit_code == 1
    assert "made for another task" in result.stderr
    plan = json.loads(Path("plan.json").read_text("utf-8"))
    del plan["task_sha256"]
    Path("other.json").write_text(json.dumps(plan), "utf-8")
    result = run_irc("show", "bare.json", "other.json")
    assert result.exit_code == 1
    assert "of another task: there is no action 'sand' and 1 more" in result.stderr
    assert "other.json" in result.stderr


@pytest.mark.usefixtures("folder")
def test_a_schedule_that_breaks_rules_is_shown_with_a_note() -> None:
    plan = {"actions": [{"id": "sand", "start": 0, "end": 6, "resources": {"booth": 1}}]}
    Path("half.json").write_text(json.dumps(plan), "utf-8")
    result = run_irc("show", "week.json", "half.json")
    assert result.exit_code == 0
    assert "not valid: rule 1, presence" in result.stderr
    assert "sand" in result.stdout


@pytest.mark.usefixtures("folder")
def test_json_has_the_rows_of_every_table() -> None:
    document = json.loads(run_irc("show", "week.json", "plan.json", "--format", "json").stdout)
    assert document["irc_tables"] == "1"
    (order,) = document["orders"]
    assert (order["order"], order["end"], order["due"], order["lateness"]) == ("frame", 32, 28, 4)
    assert order["end_at"] == "2026-10-23T14:00:00+02:00"
    assert [row["day"] for row in document["days"]] == ["2026-10-22", "2026-10-23"]


COMMANDS = {
    "solve": ("solve", "week.json"),
    "simulate": ("simulate", "week.json"),
    "replan": ("replan", "week.json", "--schedule", "plan.json", "--at", "2"),
    "show": ("show", "week.json", "plan.json"),
}


@pytest.mark.slow
@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize(
    ("name", "ending"),
    [
        *(("show", ending) for ending in ("svg", "html", "txt", "json")),
        *((name, ending) for name in ("solve", "simulate", "replan") for ending in ("md", "txt")),
    ],
)
def test_every_command_writes_every_kind(name: str, ending: str) -> None:
    command = COMMANDS[name]
    result = run_irc(*command, "-o", f"out.{ending}")
    assert result.exit_code == 0, result.stderr
    assert f"wrote out.{ending}" in result.stderr
    assert Path(f"out.{ending}").stat().st_size > 100


@pytest.mark.usefixtures("folder")
def test_json_has_dates_beside_the_numbers_and_reads_them_back() -> None:
    entry = json.loads(Path("plan.json").read_text("utf-8"))["actions"][1]
    assert (entry["start"], entry["start_at"]) == (6, "2026-10-22T12:00:00+02:00")
    schedule = planned()
    read = Schedule.from_dict(schedule.to_dict())
    assert read == schedule
    assert read["paint"].end_at == schedule["paint"].end_at
    assert str(read["paint"].end_at) == "2026-10-23 14:00:00+02:00"


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"start_at": "2026-10-22T07:00:00+02:00"}, "but 'start' is 0"),
        ({"end_at": "soon"}, "but 'end' is 6"),
        ({"end_at": 5}, "must be a date-time"),
    ],
)
def test_a_date_that_contradicts_its_number_is_an_error(change: dict[str, Any], said: str) -> None:
    document = Schedule.from_dict(
        {"actions": [{"id": "a", "start": 0, "end": 6}], "time_unit": "h"}
    ).of(Task.model_validate(WEEK))
    written = document.to_dict()
    assert written["actions"][0]["end_at"] == "2026-10-22T12:00:00+02:00"
    written["actions"][0] |= change
    with pytest.raises(irc.InputError, match=said):
        Schedule.from_dict(written)


@pytest.mark.parametrize("fields", [{"origin": "today"}, {"time_zone": "Europe/Nowhere"}])
def test_a_wrong_origin_of_a_schedule_is_an_error(fields: dict[str, str]) -> None:
    document = {"actions": [], "time_unit": "h", "origin": "2026-01-01T00:00:00Z", **fields}
    with pytest.raises(irc.InputError, match="'origin'"):
        Schedule.from_dict(document)


def test_dates_keep_the_clock_of_the_calendars_when_it_is_put_back() -> None:
    document = {**WEEK, "origin": "2026-10-24T20:00:00+02:00", "events": [], "groups": []}
    schedule = irc.solve(document, workers=1)
    assert str(schedule["sand"].start_at) == "2026-10-25 06:00:00+01:00"
    other = {**document, "origin": "2026-10-24T18:00:00+00:00"}
    assert str(irc.solve(other, workers=1)["sand"].start_at) == "2026-10-25 05:00:00+00:00"


def test_dates_without_a_zone_stay_without() -> None:
    schedule = irc.solve(
        {"origin": "2026-03-02T08:00:00", "actions": [{"id": "a", "duration": 90}]}
    )
    entry = schedule["a"]
    assert (str(entry.start_at), str(entry.end_at)) == (
        "2026-03-02 08:00:00",
        "2026-03-02 08:01:30",
    )
    assert irc.solve({"actions": [{"id": "a", "duration": 3}]})["a"].start_at is None


def test_a_notebook_shows_dates_where_there_are_any() -> None:
    html = planned()._repr_html_()
    assert "<td>Thu 22 Oct 2026 12:00</td><td>Fri 23 Oct 2026 14:00</td>" in html
    bare = {"actions": [{"id": "a", "duration": 3}]}
    assert "<th>start (s)</th>" in irc.solve(bare)._repr_html_()


def test_a_verdict_says_when_a_rule_is_broken(tmp_path: Path) -> None:
    (tmp_path / "week.json").write_text(json.dumps(WEEK), encoding="utf-8")
    plan = {
        "actions": [
            {"id": "sand", "start": 10, "end": 16, "resources": {"booth": 1}},
            {"id": "paint", "start": 24, "end": 50, "resources": {"booth": 1}},
        ]
    }
    (tmp_path / "plan.json").write_text(json.dumps(plan), encoding="utf-8")
    files = str(tmp_path / "week.json"), str(tmp_path / "plan.json")
    shown = run_irc("validate", *files)
    assert shown.exit_code == 1
    assert re.search(r"\n {4}\w{3} 2\d Oct 2026 \d\d:00", shown.stdout)
    assert "Oct" not in run_irc("validate", *files, "--times", "unit").stdout


def test_an_explanation_speaks_by_the_clock(tmp_path: Path) -> None:
    document = {
        "time_unit": "min",
        "origin": "2026-03-02T22:00:00",
        "actions": [{"id": "a", "duration": 90}, {"id": "b", "duration": 60, "due": 100}],
        "precedence": [["a", "b"]],
    }
    (path := tmp_path / "task.json").write_text(json.dumps(document), encoding="utf-8")
    assert "Mon 22:00 – Mon 23:30  'a' takes 90 min" in run_irc("explain", str(path)).stdout
    late = run_irc("explain", str(path), "--why", "b").stdout
    assert "'b' ends at Tue 00:30, 50 min late (due at Mon 23:40)" in late
    assert "0 – 90  'a' takes" in run_irc("explain", str(path), "--times", "unit").stdout


def test_a_step_speaks_by_the_clock(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "week.json").write_text(json.dumps(WEEK), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    shown = run_irc("simulate", "week.json").stdout
    assert "at Thu 22 Oct 2026 08:00" in shown or "at Thu 08:00" in shown
    assert "start (h)" in run_irc("simulate", "week.json", "--times", "unit").stdout
