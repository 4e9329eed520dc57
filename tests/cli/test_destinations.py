"""Names of files that could not be written are refused before anything is planned."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest

import irc
from irc.driver.files import WriteError, require_file, require_folder
from irc.targets import Engine
from irc_cpsat.engines import OrTools
from runs import run_irc

TASK = {
    "resources": [{"id": "van"}],
    "actions": [{"id": n, "duration": 3, "uses": [{"resource": "van"}]} for n in "ab"],
    "events": [{"at": 1, "changes": [{"op": "set_duration", "action": "b", "duration": 4}]}],
}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a task, its plan and a file; in it no engine may be asked."""

    def solve(self: Engine, *_: object) -> None:
        raise AssertionError("it was planned before the file was refused")

    plan = irc.solve(TASK)
    (tmp_path / "task.json").write_text(json.dumps(TASK), encoding="utf-8")
    (tmp_path / "plan.json").write_text(json.dumps(plan.to_dict()), encoding="utf-8")
    (tmp_path / "file").write_text("", encoding="utf-8")
    monkeypatch.setattr(OrTools, "solve", solve)
    monkeypatch.chdir(tmp_path)
    return tmp_path


SOLVE = ("solve", "task.json", "--no-shortcut")
SIMULATE = ("simulate", "task.json")
REPLAN = ("replan", "task.json", "--schedule", "plan.json", "--at", "1")


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize("command", [SOLVE, SIMULATE, REPLAN], ids=lambda c: str(c[0]))
@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("nowhere/out.json", "there is no folder 'nowhere'"),
        ("file/out.json", "there is no folder 'file'"),
        (".", "it is a folder"),
        ("out.doc", "its name must end in one of .json, .html"),
        ("out.json.bak", "its name must end in one of .json, .html"),
    ],
)
def test_a_file_that_cannot_be_written_is_refused_first(
    command: tuple[str, ...], name: str, said: str
) -> None:
    for format in ("text", "json"):
        result = run_irc(*command, "-o", name, "--format", format)
        assert result.exit_code == 2
        assert said in result.stderr
    assert said in json.loads(result.stdout)["message"]


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize(
    ("more", "said"),
    [
        ((*REPLAN, "--task-output", "task.txt"), "its name must end in .json or .irc"),
        ((*REPLAN, "--task-output", "nowhere/task.irc"), "there is no folder 'nowhere'"),
        ((*SIMULATE, "--steps", "file"), "'file' is no folder"),
        ((*SIMULATE, "--steps", "file/steps"), "'file' is no folder"),
        (("compile", "task.json", "--target", "pddl21", "-o", "file"), "'file' is no folder"),
    ],
)
def test_other_files_and_folders_likewise(more: tuple[str, ...], said: str) -> None:
    result = run_irc(*more)
    assert (result.exit_code, said in result.stderr) == (2, True)


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize(
    ("more", "said"),
    [
        (("--target", "cpsatt"), "there is no target 'cpsatt'"),
        (("--engine", "ortolls"), "there is no engine 'ortolls'"),
        (("--format", "yaml"), "yaml"),
        (("--time-limit", "0"), "0"),
    ],
)
def test_options_that_cannot_be_are_refused_first(more: tuple[str, ...], said: str) -> None:
    for command in (SOLVE, SIMULATE, REPLAN):
        result = run_irc(*command, *more)
        assert (result.exit_code, said in result.output) == (2, True)


def test_what_can_be_written_is_accepted(tmp_path: Path) -> None:
    for name in ("out.json", "OUT.JSON", "out", ".out"):
        require_file(tmp_path / name)
    require_file(None)
    require_folder(None)
    require_folder(tmp_path / "a" / "b")
    (tmp_path / "old.json").touch()
    require_file(tmp_path / "old.json")


@pytest.mark.skipif(os.name == "nt" or os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_in_which_nothing_may_be_written(tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    with pytest.raises(WriteError, match="nothing may be written"):
        require_file(tmp_path / "out.json")
    with pytest.raises(WriteError, match="nothing may be written"):
        require_folder(tmp_path / "steps")


@pytest.mark.skipif(not Path(os.devnull).exists(), reason="there is no such device")
def test_a_device_is_no_file_to_be_replaced() -> None:
    with pytest.raises(WriteError, match="no ordinary file"):
        require_file(Path(os.devnull))
