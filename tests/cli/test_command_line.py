"""Several files, PDDL, defaults of a project, completion, pipes, and documents of another kind."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import typer

from irc.cli.app import build_app, options_of_commands
from irc.cli.defaults import defaults_for, settings_file
from irc.errors import OptionError
from paths import ROOT
from runs import run_irc

FERRY = ROOT / "examples" / "pddl" / "ferry"
TASK: dict[str, Any] = {"name": "tea", "actions": [{"id": "boil", "duration": 4}]}
IMPOSSIBLE = {**TASK, "name": "late", "deadline": 3}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name, document in (("tea", TASK), ("more", {**TASK, "name": "more"}), ("late", IMPOSSIBLE)):
        (tmp_path / f"{name}.json").write_text(json.dumps(document), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.usefixtures("folder")
def test_several_tasks_are_solved_in_turn_and_written_by_their_names() -> None:
    result = run_irc("solve", "tea.json", "more.json", "-o", "{name}_plan.md")
    assert result.exit_code == 0, result.stderr
    assert [line for line in result.stdout.split("\n") if line.endswith(".json")] == [
        "tea.json",
        "more.json",
    ]
    assert Path("tea_plan.md").read_text().startswith("# tea")
    assert Path("more_plan.md").read_text().startswith("# more")


@pytest.mark.usefixtures("folder")
def test_a_task_without_a_schedule_does_not_stop_the_others() -> None:
    result = run_irc("solve", "late.json", "tea.json", "--format", "json")
    assert result.exit_code == 1
    first, second = map(json.loads, result.stdout.splitlines())
    assert first["outcome"]["exit"] == 1
    assert second["makespan"] == 4


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("tea.json", "more.json", "-o", "plan.json"), "write {name} into its name"),
        (("tea.json", "tea.json", "-o", "{name}.md"), "two of the tasks would be written to one"),
        (("tea.json", "more.json", "--problem", "p.pddl"), "--problem goes with one file"),
        (("-", "-"), "only one of the inputs can be standard input"),
        ((str(FERRY / "problem.pddl"), str(FERRY / "problem.pddl")), "found 0"),
    ],
)
def test_files_that_do_not_go_together_are_refused(arguments: tuple[str, ...], said: str) -> None:
    result = run_irc("solve", *arguments)
    assert result.exit_code == 2
    assert said in result.stderr


@pytest.mark.slow
def test_a_problem_and_its_domain_are_solved_in_either_order() -> None:
    result = run_irc("solve", str(FERRY / "problem.pddl"), str(FERRY / "domain.pddl"))
    assert result.exit_code == 0, result.stderr
    assert "makespan 24 s" in result.stdout


@pytest.mark.parametrize(("part", "other"), [("domain", "problem"), ("problem", "domain")])
def test_half_of_a_task_in_pddl_is_recognised(part: str, other: str) -> None:
    result = run_irc("solve", str(FERRY / f"{part}.pddl"))
    assert result.exit_code == 1
    assert f"this is only the {part} of a task in PDDL" in result.stderr
    assert f"give its {other}, too" in result.stderr


@pytest.mark.parametrize(
    ("document", "said"),
    [
        ({"irc_schedule": "1", "actions": []}, "this is a schedule, not a task"),
        ({"actions": [{"id": "a", "start": 0, "end": 3}]}, "its actions have a start and an end"),
        ({"irc_step": "1", "schedule": {}}, "a step of a running task"),
        ({"irc_manifest": "1", "task": TASK}, "its field 'task' is the task"),
    ],
)
def test_a_document_of_another_kind_is_named(
    document: dict[str, Any], said: str, tmp_path: Path
) -> None:
    (path := tmp_path / "given.json").write_text(json.dumps(document), encoding="utf-8")
    for command in ("check", "solve", "explain"):
        result = run_irc(command, str(path))
        assert result.exit_code == 1
        assert said in result.stdout + result.stderr
        assert "unknown" not in result.stderr


# --- defaults -----------------------------------------------------------------------------------

OPTIONS = {
    "solve": frozenset(["time_limit", "times", "output"]),
    "check": frozenset(["fix"]),
    "show": frozenset(["times"]),
}
HERE = Path("irc.toml")


def test_a_table_is_for_its_command_and_the_rest_for_all_that_have_the_option() -> None:
    settings = {"times": "unit", "solve": {"time-limit": 5, "times": "clock"}}
    assert defaults_for(settings, OPTIONS, HERE) == {
        "solve": {"time_limit": 5, "times": "clock"},
        "check": {},
        "show": {"times": "unit"},
    }


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"time-limt": 5}, "did you mean `time-limit`"),
        ({"sovle": {"times": "unit"}}, "did you mean `solve`"),
        ({"check": {"times": "unit"}}, "no option 'times' of check"),
        ({"output": "x.json"}, "no option 'output'"),
    ],
)
def test_a_name_that_no_command_has_is_an_error(settings: dict[str, Any], said: str) -> None:
    with pytest.raises(OptionError, match=said):
        defaults_for(settings, OPTIONS, HERE)


def test_the_nearest_file_counts_and_a_project_without_settings_is_passed_by(
    tmp_path: Path,
) -> None:
    inner = tmp_path / "a" / "b"
    inner.mkdir(parents=True)
    (tmp_path / "pyproject.toml").write_text("[tool.irc]\nseed = 3\n")
    (tmp_path / "a" / "pyproject.toml").write_text("[project]\nname = 'x'\n")
    assert settings_file(inner) == (tmp_path / "pyproject.toml", {"seed": 3})
    (inner / "irc.toml").write_text("seed = 4\n")
    assert settings_file(inner) == (inner / "irc.toml", {"seed": 4})


def test_a_file_of_settings_with_faults_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "irc.toml").write_text("seed =\n")
    with pytest.raises(OptionError, match="cannot read"):
        settings_file(tmp_path)


def test_every_command_lists_its_options() -> None:
    options = options_of_commands()
    assert {"times", "output", "time_limit"} <= options["solve"]
    assert "times" in options["validate"] & options["explain"] & options["replan"]


# --- the process --------------------------------------------------------------------------------


def process(*arguments: str, folder: Path, **more: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "irc", *arguments],
        capture_output=True,
        text=True,
        cwd=folder,
        env={**os.environ, **more},
    )


@pytest.mark.slow
def test_settings_count_and_wrong_ones_are_named(folder: Path) -> None:
    dated = {**TASK, "origin": "2026-03-02T08:00:00"}
    (folder / "dated.json").write_text(json.dumps(dated), encoding="utf-8")
    (folder / "irc.toml").write_text("[solve]\ntimes = 'unit'\nseed = 3\n")
    assert "start (s)" in process("solve", "dated.json", folder=folder).stdout
    (folder / "irc.toml").write_text("[solve]\ntims = 'unit'\n")
    wrong = process("solve", "dated.json", folder=folder)
    assert wrong.returncode == 2
    assert "did you mean `times`" in wrong.stderr
    assert "Traceback" not in wrong.stderr


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="a shell with pipes")
def test_a_reader_that_ends_early_is_no_error(folder: Path) -> None:
    many = {"actions": [{"id": f"a{k}", "duration": 1} for k in range(1200)]}
    (folder / "many.json").write_text(json.dumps(many), encoding="utf-8")
    command = f"{sys.executable} -m irc solve many.json | head -1"
    done = subprocess.run(command, shell=True, capture_output=True, text=True, cwd=folder)
    assert done.stdout.count("\n") == 1
    assert "Traceback" not in done.stderr
    assert "rror" not in done.stderr


def test_the_version_and_completion() -> None:
    assert run_irc("-V").stdout.startswith("irc ")
    command = typer.main.get_command(build_app())
    names = {option for p in command.params for option in p.opts}
    assert {"--install-completion", "--show-completion", "-V"} <= names
