"""`irc run`: what a request is answered, what it changes, and what a restart brings back."""

from __future__ import annotations

import json
import random
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import irc
from crash_runs import MODES, Kitchen
from irc.execution import Execution, replan
from irc.schedule import Schedule
from irc.service.journal import Journal
from irc.service.protocol import MAX_LINE
from irc.service.session import Session
from irc.service.snapshot import SnapshotError, from_snapshot, to_snapshot
from irc.targets import EngineFailed, SolveOptions
from oracles.online_random import play
from runs import run_irc

VAN: dict[str, Any] = {
    "name": "van",
    "resources": [{"id": "van"}],
    "actions": [
        {"id": name, "duration": 10, "uses": [{"resource": "van"}]} for name in ("ann", "bob")
    ],
    "precedence": [["ann", "bob"]],
    "events": [
        {"id": "jam", "at": 4, "changes": [{"op": "set_duration", "action": "ann", "duration": 12}]}
    ],
}
JAM = '{"do": "apply", "event": "#jam", "replan": true, "id": "j"}'


def session() -> Session:
    task = irc.Task.from_dict(VAN).ir
    return Session.start(Execution(task, irc.solve(task)))


def told(session: Session, line: str) -> dict[str, Any]:
    document: dict[str, Any] = json.loads(session.answer(line.encode() + b"\n").line())
    return document


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "van.json"
    path.write_text(json.dumps(VAN))
    return path


def run(
    file: Path, *lines: str, journal: bool = False, **options: str
) -> tuple[int, list[Any], str]:
    """(exit status, answers, standard error) of a whole session."""
    arguments = ["run", str(file), "--stdio"]
    arguments += ["--journal", str(file.with_name("run.journal"))] if journal else []
    arguments += [text for name, value in options.items() for text in (f"--{name}", value)]
    result = run_irc(*arguments, stdin="\n".join(lines))
    assert result.exception is None or isinstance(result.exception, SystemExit)
    return (
        result.exit_code,
        [json.loads(line) for line in result.stdout.splitlines()],
        result.stderr,
    )


# --- requests -----------------------------------------------------------------------------------


@pytest.mark.slow
def test_each_request_gets_one_answer_on_one_line_with_its_id(file: Path) -> None:
    code, answers, errors = run(
        file,
        '{"do": "advance", "to": "3 s", "id": 1}',
        "",
        JAM,
        '{"do": "state"}',
        '{"do": "stop"}',
    )
    greeting, advanced, replanned, state, stopped = answers
    assert (code, errors) == (0, "")
    assert (greeting["irc_run"], greeting["now"], greeting["recovered"]) == ("1", 0, 0)
    assert (advanced["ok"], advanced["id"], advanced["now"]) == (True, 1, 3)
    assert (replanned["id"], replanned["now"]) == ("j", 4)
    step = replanned["step"]
    assert (step["event"], step["running"], step["moved"]) == (["jam"], ["ann"], 1)
    assert step["schedule"]["makespan"] == 22
    assert "id" not in state
    assert state["state"]["schedule"]["actions"] == step["schedule"]["actions"]
    assert (state["state"]["running"], state["state"]["open"]) == (["ann"], ["bob"])
    assert stopped == {"ok": True, "now": 4, "notes": []}


def test_what_was_observed_is_planned_around_when_it_is_asked_for() -> None:
    van = session()
    assert told(van, '{"do": "advance", "to": 2.5}')["ok"]
    assert told(van, '{"do": "observe", "action": "ann", "started": 2.25}')["ok"]
    assert told(van, '{"do": "state"}')["state"]["replan_needed"]
    step = told(van, '{"do": "replan"}')["step"]
    assert [(a["id"], a["start"], a["end"]) for a in step["schedule"]["actions"]] == [
        ("ann", 2.25, 12.25),
        ("bob", 12.25, 22.25),
    ]
    assert not told(van, '{"do": "state"}')["state"]["replan_needed"]


@pytest.mark.parametrize(
    ("line", "code", "pointer"),
    [
        ("", "IRC002", ""),
        ("advance", "IRC002", ""),
        ('{"do": "advance", "to": 5', "IRC002", ""),
        ('{"do": "state"} {"do": "state"}', "IRC002", ""),
        ('{"do": "state", "do": "stop"}', "IRC004", ""),
        ("[" * 100_000, "IRC006", ""),
        ('{"do": "advance", "to": 1e999999999}', "IRC104", "/to"),
        ('{"do": "advance", "to": NaN}', "IRC005", ""),
        ("[1]", "IRC103", ""),
        ("{}", "IRC101", ""),
        ('{"do": "advnce", "to": 5}', "IRC103", "/do"),
        ('{"do": ["stop"]}', "IRC103", "/do"),
        ('{"do": "advance"}', "IRC101", ""),
        ('{"do": "advance", "to": "soon"}', "IRC104", "/to"),
        ('{"do": "advance", "to": null}', "IRC101", ""),
        ('{"do": "advance", "to": -1}', "IRC104", "/to"),
        ('{"do": "advance", "to": "2026-03-01T08:00:00Z"}', "IRC104", "/to"),
        ('{"do": "advance", "to": 1}', "IRC705", "/to"),
        ('{"do": "state", "id": [1]}', "IRC103", "/id"),
        ('{"do": "replan", "to": 5}', "IRC102", "/to"),
        ('{"do": "observe", "action": "ann"}', "IRC101", ""),
        ('{"do": "observe", "action": "an", "started": 1}', "IRC201", "/action"),
        (
            '{"do": "observe", "action": "ann", "occurrence": 0, "started": 1}',
            "IRC103",
            "/occurrence",
        ),
        (
            '{"do": "observe", "action": "ann", "occurrence": 2, "started": 1}',
            "IRC704",
            "/occurrence",
        ),
        ('{"do": "observe", "action": "ann", "started": 7}', "IRC705", "/started"),
        ('{"do": "apply", "event": "#jams"}', "IRC201", "/event"),
        ('{"do": "apply", "event": 3}', "IRC103", "/event"),
        ('{"do": "apply", "event": {"at": 1}}', "IRC705", "/event/at"),
        ('{"do": "apply", "event": {"chnges": []}}', "IRC102", "/event/chnges"),
        ('{"do": "apply", "event": {}, "replan": "yes"}', "IRC103", "/replan"),
        (
            '{"do": "apply", "event": {"changes": [{"op": "cancel_actions", "actions": ["x"]}]}}',
            "IRC201",
            "/event/changes/0/actions/0",
        ),
    ],
)
def test_a_wrong_request_is_told_where_and_changes_nothing(
    line: str, code: str, pointer: str
) -> None:
    van = session()
    told(van, '{"do": "advance", "to": 2}')
    before = told(van, '{"do": "state"}')
    answer = told(van, line)
    assert not answer["ok"]
    (found, *_) = answer["error"]["diagnostics"]
    assert (found["code"], found["pointer"]) == (code, pointer), found
    assert answer["error"]["message"] == found["message"]
    assert found["hint"] or "expected" in found["message"]
    assert told(van, '{"do": "state"}') == before


def test_a_request_whose_replanning_fails_is_forgotten_as_a_whole(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    van = session()
    before = van.state()

    def fail(_self: Execution, **_: object) -> None:
        raise EngineFailed("the engine broke down")

    with monkeypatch.context() as patched:
        patched.setattr(Execution, "replan", fail)
        answer = told(van, JAM)
    assert answer["error"] == {"message": "the engine broke down", "diagnostics": []}
    assert (van.state(), answer["now"]) == (before, 0)
    assert told(van, JAM)["step"]["schedule"]["makespan"] == 22


def test_a_line_that_is_too_long_is_skipped_and_the_next_one_read(file: Path) -> None:
    longest = '{"do": "state", "x": "' + "x" * MAX_LINE
    code, answers, _ = run(file, longest, '{"do": "advance", "to": 2}')
    assert code == 0
    assert [a["ok"] for a in answers] == [True, False, True]
    assert answers[1]["error"]["diagnostics"][0]["code"] == "IRC006"


# --- the journal --------------------------------------------------------------------------------


def test_a_restart_needs_no_solver_and_stands_where_the_last_run_did(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lines = ['{"do": "advance", "to": 2}', '{"do": "fly"}', JAM, '{"do": "state"}']
    _, answers, _ = run(file, *lines, journal=True)
    monkeypatch.setattr("irc.execution.execution.solve_step", None)
    monkeypatch.setattr("irc.cli.run.solve_task", None)
    _, (greeting, state), _ = run(file, '{"do": "state"}', journal=True)
    assert (greeting["recovered"], greeting["last_id"], greeting["now"]) == (2, "j", 4)
    assert greeting["state"] == answers[-1]["state"] == state["state"]


def test_a_torn_last_line_is_noted_and_the_journal_continued(file: Path) -> None:
    run(file, '{"do": "advance", "to": 2}', '{"do": "advance", "to": 3}', journal=True)
    journal = file.with_name("run.journal")
    journal.write_bytes(journal.read_bytes()[:-5])
    code, (greeting, _), errors = run(file, '{"do": "advance", "to": 5}', journal=True)
    assert (code, greeting["now"], greeting["recovered"]) == (0, 2, 1)
    assert [note["code"] for note in greeting["notes"]] == ["IRC606"]
    assert "IRC606" in errors
    assert run(file, journal=True)[1][0]["now"] == 5


def test_a_journal_of_another_task_or_schedule_is_refused(file: Path) -> None:
    run(file, journal=True)
    schedule = file.with_name("other.json")
    schedule.write_text(
        '{"actions": [{"id": "ann", "start": 1, "end": 11}, {"id": "bob", "start": 11, "end": 21}]}'
    )
    code, answers, errors = run(file, journal=True, schedule=str(schedule))
    assert (code, answers) == (1, [])
    assert "another schedule" in errors
    file.write_text(json.dumps({**VAN, "name": "lorry"}))
    code, answers, errors = run(file, journal=True)
    assert (code, answers) == (1, [])
    assert "IRC607" in errors
    assert "the journal belongs to another task (van), not to this one (lorry)" in errors


def test_a_task_that_has_changed_is_told_from_another_one(file: Path) -> None:
    run(file, '{"do": "advance", "to": 2}', journal=True)
    text = file.read_text()
    ann = {**VAN["actions"][0], "duration": 11}
    cem = {"id": "cem", "duration": 1}
    changed = {**VAN, "actions": [ann, VAN["actions"][1], cem], "deadline": 90}
    file.write_text(json.dumps(changed))
    code, answers, errors = run(file, journal=True)
    assert (code, answers) == (1, [])
    assert "IRC608" in errors
    assert "'ann' of 'actions', 'cem' of 'actions' (new), 'deadline'" in errors
    unnamed = {key: value for key, value in changed.items() if key != "name"}
    file.write_text(json.dumps(unnamed))
    assert "IRC607" in run(file, journal=True)[2]
    file.write_text(text)
    assert run(file, journal=True)[1][0]["now"] == 2, "nothing was lost by trying"


def test_where_the_journal_cannot_be_written_nothing_is_acknowledged(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run(file, '{"do": "advance", "to": 2}', journal=True)

    def full(_handle: int) -> None:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patched:
        patched.setattr("os.fsync", full)
        code, answers, errors = run(
            file, '{"do": "advance", "to": 3}', '{"do": "advance", "to": 4}', journal=True
        )
    assert (code, [a["ok"] for a in answers]) == (2, [True, False])
    assert "No space left" in answers[1]["error"]["message"]
    assert answers[1]["now"] == 2, "what was not written has not happened"
    assert "No space left" in errors
    assert run(file, journal=True)[1][0]["now"] == 2


def test_wrong_use_is_told_and_nothing_is_begun(file: Path) -> None:
    result = run_irc("run", file)
    assert (result.exit_code, result.stdout) == (2, "")
    assert "--stdio" in result.stderr
    run(file, journal=True)
    code, answers, errors = run(file, journal=True, engine="abacus")
    assert (code, answers) == (2, [])
    assert "there is no engine 'abacus'" in errors
    code, answers, errors = run(Path("-"))
    assert (code, answers) == (2, [])
    assert "standard input is for the requests" in errors


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_every_beginning_of_a_journal_brings_back_the_state_of_its_last_line(
    seed: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    options = SolveOptions(time_limit=20.0, workers=1)
    first, *more = play(seed, None, lambda t, s, at, e: replan(t, s, at, e, options=options))
    journal, _ = Journal.open(path := tmp_path / "run.journal")

    def begun(schedule: Schedule) -> Execution:
        return Execution(first.task, schedule, options=options)

    held = Session.start(begun(first.schedule), journal)
    states = [held.state()]
    for event in (event for played in (first, *more) for event in played.events):
        document = event.model_dump(mode="json", by_alias=True, exclude_unset=True)
        assert told(held, json.dumps({"do": "apply", "event": document, "replan": True}))["ok"]
        states.append(held.state())
    journal.close()
    monkeypatch.setattr("irc.execution.execution.solve_step", None)
    lines = path.read_bytes().splitlines(keepends=True)
    for count, state in enumerate(states, 1):
        path.write_bytes(b"".join(lines[:count]))
        journal, found = Journal.open(path)
        with journal:
            assert found is not None
            again = Session.resume(begun, first.task, journal, found)
        assert again.state() == state


# --- crashes ------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="there is no SIGKILL")
def test_killed_at_random_points_it_forgets_nothing_that_it_acknowledged(tmp_path: Path) -> None:
    kitchen = Kitchen(tmp_path, random.Random(5))
    for k in range(4):
        kitchen.crash(MODES[k % 2])
    process = kitchen.start()
    kitchen.check(kitchen.read(process))
    assert kitchen.acknowledged
    kitchen.look()
    kitchen.damage(60)
    assert kitchen.damaged["refused"] > 0
    process.send_signal(signal.SIGTERM)
    assert process.wait(30) == 0, "being told to end is an orderly end"
    process.communicate()


@pytest.mark.slow
def test_a_second_process_cannot_have_the_journal(file: Path) -> None:
    command = [sys.executable, "-m", "irc", "run", str(file), "--stdio"]
    command += ["--journal", str(file.with_name("run.journal"))]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        process.stdout.readline()
        code, answers, errors = run(file, journal=True)
        assert (code, answers) == (2, [])
        assert "in use by another process" in errors
        process.communicate()
    assert process.returncode == 0


# --- snapshots ----------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_a_snapshot_gives_back_the_execution_at_every_step(seed: int) -> None:
    options = SolveOptions(time_limit=20.0, workers=1)
    first, *more = play(seed, None, lambda t, s, at, e: replan(t, s, at, e, options=options))
    execution = Execution(first.task, first.schedule, options=options)
    for event in (event for played in (first, *more) for event in played.events):
        execution.apply(event)
        for _ in range(2):
            written = json.dumps(to_snapshot(execution), allow_nan=False)
            again = from_snapshot(json.loads(written), options)
            assert again == execution
            assert again.state() == execution.state()
            execution.replan()


def test_a_restart_needs_only_the_requests_since_the_last_snapshot(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    requests = [f'{{"do": "advance", "to": "{k}/200", "id": {k}}}' for k in range(1, 351)]
    run(file, *requests[:250], JAM, journal=True)
    _, answers, _ = run(file, *requests[250:], '{"do": "advance", "to": 4.5}', journal=True)
    assert answers[0]["recovered"] == 251
    calls: list[object] = []
    replay = Session._replay
    monkeypatch.setattr(Session, "_replay", lambda self, e: (calls.append(e), replay(self, e)))
    _, (greeting,), _ = run(file, journal=True)
    assert (greeting["recovered"], greeting["now"], greeting["last_id"]) == (252, 4.5, None)
    assert len(calls) == 2
    assert greeting["state"]["schedule"]["makespan"] == 22


def test_where_no_snapshot_can_be_read_all_requests_are_replayed(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    requests = [f'{{"do": "advance", "to": "{k}/200", "id": {k}}}' for k in range(1, 121)]
    run(file, *requests, journal=True)

    def unknown(*_: object) -> Execution:
        raise SnapshotError("of another version")

    monkeypatch.setattr("irc.service.session.from_snapshot", unknown)
    _, (greeting,), _ = run(file, journal=True)
    assert (greeting["recovered"], greeting["now"], greeting["last_id"]) == (120, 0.6, 120)
    journal = file.with_name("run.journal")
    lines = journal.read_bytes().splitlines(keepends=True)
    last = max(k for k, line in enumerate(lines) if b'"snapshot"' in line)
    journal.write_bytes(b"".join([lines[0], *lines[last:]]))  # as a long journal is shortened
    code, answers, errors = run(file, journal=True)
    assert (code, answers) == (1, [])
    assert "IRC609" in errors
    assert f"irc {irc.__version__} wrote it" in errors


def test_a_disk_too_full_for_a_snapshot_is_said_and_ends_nothing(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Journal, "save", full)
    requests = [f'{{"do": "advance", "to": "{k}/200", "id": {k}}}' for k in range(1, 121)]
    code, answers, errors = run(file, *requests, journal=True)
    assert (code, {answer["ok"] for answer in answers}, len(answers)) == (0, {True}, 121)
    note = "note: no snapshot could be added to the journal: No space left on device\n"
    assert errors == 2 * note
    assert run(file, journal=True)[1][0]["recovered"] == 120


@pytest.mark.parametrize(
    "document",
    [
        {},
        [],
        {"state": {}, "task_sha256": ""},
        {"state": {"task": {"$": "Path", "of": "x"}}, "task_sha256": ""},
        {"state": {"task": {"$": "Task", "of": '{"actions": [{}]}'}}, "task_sha256": ""},
        {"state": {"task": {"$": "Task", "of": '{"actions": []}'}}, "task_sha256": "0"},
        {"state": {"task": {"$": "Entry"}}, "task_sha256": "0"},
        {"state": {"task": {"$": "Fraction", "of": "1/0"}}, "task_sha256": "0"},
        {"state": {"task": {"$": "dict", "of": [[{"$": "set", "of": []}, 1]]}}},
    ],
)
def test_a_snapshot_that_is_none_is_refused(document: Any) -> None:
    with pytest.raises(SnapshotError):
        from_snapshot(document, SolveOptions())
