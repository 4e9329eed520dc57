"""What each target makes of one small task for each feature, to the byte.

`pytest tests/golden --refresh-golden` rewrites the expected files; read the difference before you
commit it.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

from irc.diagnostics import InputError
from irc.driver.compile import check_task, compile_task
from irc.frontends.files import read_task

HERE = Path(__file__).parent
TASKS = sorted(path.stem for path in (HERE / "tasks").glob("*.json"))
TARGETS = ("cpsat", "pddl21")
FILES = ("domain.pddl", "problem.pddl", "model.pbtxt", "names.json")


@cache
def compiled(task: str) -> dict[str, str]:
    """All files of all targets for a task, and what their manifests say of the names."""
    reading = read_task(HERE / "tasks" / f"{task}.json")
    files: dict[str, str] = {}
    names = {}
    for target in TARGETS:
        program = compile_task(reading.task, target)
        files |= program.files
        names[target] = program.names
    files["names.json"] = json.dumps(names, indent=2, ensure_ascii=False) + "\n"
    return files


def expected(task: str, file: str) -> Path:
    return HERE / "expected" / task / file


@pytest.mark.parametrize("file", FILES)
@pytest.mark.parametrize("task", TASKS)
def test_a_task_is_compiled_to_the_expected_text(
    task: str, file: str, refresh_golden: bool
) -> None:
    text = compiled(task)[file]
    path = expected(task, file)
    if refresh_golden:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8", newline="\n")
    assert text == path.read_bytes().decode("utf-8")


@pytest.mark.parametrize("task", TASKS)
def test_targets_write_no_other_files(task: str) -> None:
    assert sorted(compiled(task)) == sorted(FILES)


@pytest.mark.parametrize("task", TASKS)
def test_golden_tasks_are_without_fault(task: str) -> None:
    try:
        reading = read_task(HERE / "tasks" / f"{task}.json")
    except InputError as error:
        pytest.fail(str(error))
    assert check_task(reading.task, reading.notes).ok


def test_no_expected_file_is_left_of_a_task_that_is_gone(refresh_golden: bool) -> None:
    wanted = {expected(task, file) for task in TASKS for file in FILES}
    stale = set(files_in(HERE / "expected")) - wanted
    if refresh_golden:
        for path in stale:
            path.unlink()
            if not any(path.parent.iterdir()):
                path.parent.rmdir()
        stale = set()
    assert stale == set()


def files_in(folder: Path) -> Iterator[Path]:
    return (path for path in folder.rglob("*") if path.is_file())
