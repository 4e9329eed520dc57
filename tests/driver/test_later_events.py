"""What is planned as of t = 0 does not see the task's events, and says so."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

import irc
from irc.diagnostics import Code, Severity
from irc.driver.extract import extract_answer
from irc.driver.solve import solve_task
from runs import run_irc

KITCHEN: dict[str, Any] = {
    "resources": [{"id": "stove"}],
    "actions": [
        {"id": "boil", "duration": 4, "uses": [{"resource": "stove"}]},
        {"id": "fry", "duration": 3, "uses": [{"resource": "stove"}]},
    ],
}
AT_ONCE = {"at": 0, "changes": [{"op": "set_duration", "action": "boil", "duration": 60}]}
LATER = {"at": 5, "changes": [{"op": "cancel_actions", "actions": ["fry"]}]}
REVISED = {**KITCHEN, "events": [LATER, AT_ONCE]}


@pytest.mark.parametrize("target", ["cpsat", "pddl21"])
def test_a_program_is_that_of_the_task_without_its_events(target: str) -> None:
    program = irc.compile(REVISED, target)
    assert program.files == irc.compile(KITCHEN, target).files
    (note,) = program.notes
    assert (note.code, note.severity) == (Code.LATER_EVENTS, Severity.NOTE)
    assert "without the task's 2 events" in note.message
    assert irc.compile(KITCHEN, target).notes == ()


def test_an_answer_is_valid_as_of_the_start_and_not_even_an_event_at_0_is_seen() -> None:
    task = irc.Task.from_dict(REVISED).ir
    answer = solve_task(task)
    assert (answer.schedule.status, answer.schedule.makespan) == ("optimal", 7)
    assert irc.validate(task, answer.schedule).valid
    assert [note.code for note in answer.notes] == [Code.LATER_EVENTS]


@pytest.mark.slow
def test_an_answer_extracted_later_says_it_too() -> None:
    program = irc.compile(REVISED, "cpsat")
    answer = extract_answer(program.manifest, "solution: [0, 4, 7]\nstatus: OPTIMAL\n")
    assert answer.schedule.makespan == 7
    assert [note.code for note in answer.notes] == [Code.LATER_EVENTS]


@pytest.mark.parametrize(
    "command",
    [
        ("solve",),
        ("solve", "--format", "json"),
        ("compile", "--target", "pddl21"),
        ("compile", "--target", "cpsat", "--format", "json"),
        ("explain", "--format", "json"),
        ("targets",),
    ],
)
@pytest.mark.parametrize("language", ["json", "irc"])
def test_commands_tell_it_at_the_first_event_and_keep_standard_output_clean(
    command: tuple[str, ...], language: str, tmp_path: Path
) -> None:
    file = tmp_path / f"kitchen.{language}"
    (tmp_path / "task.json").write_text(json.dumps(REVISED, indent=0), "utf-8")
    assert run_irc("convert", str(tmp_path / "task.json"), "-o", str(file)).exit_code == 0
    result = run_irc(*command, str(file))
    assert result.exit_code == 0
    place = re.search(
        r"note\[IRC503\]: .* without the task's 2 events\n  --> (.*):(\d+):", result.stderr
    )
    assert place is not None
    assert place[1] == str(file)
    assert "at 5" in file.read_text("utf-8").splitlines()[int(place[2]) - 1].replace('"at":', "at")
    assert "IRC503" not in result.stdout
    if "json" in command:
        json.loads(result.stdout)
