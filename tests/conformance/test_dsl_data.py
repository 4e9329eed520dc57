"""The benchmark data in the DSL: printed, read back as the same tasks, laid out for good."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import irc
from irc.frontends.dsl.formatter import format_dsl
from irc.frontends.dsl.printer import print_task
from irc.frontends.dsl.task import dsl_task
from irc.frontends.files import read_task
from irc.frontends.importers.asyncplan import import_asyncplan
from irc.model import Task
from paths import ROOT


def comes_back(task: Task) -> bool:
    text = print_task(task)
    return dsl_task(text).task == task and format_dsl(text) == text


@pytest.mark.slow
def test_every_example_and_golden_task_comes_back() -> None:
    paths = [
        path
        for folder in (ROOT / "examples", ROOT / "tests" / "golden" / "tasks")
        for path in folder.iterdir()
        if path.suffix in (".json", ".irc")
    ]
    assert len(paths) > 20
    assert [path.name for path in paths if not comes_back(read_task(path).task)] == []


@pytest.mark.slow
def test_the_smaller_graphs_of_asyncplan_come_back(shared_data: Path) -> None:
    tasks = [
        task
        for size in (5, 10, 15)
        for _, task in import_asyncplan(
            (shared_data / "asyncplan_xxl" / f"nodes{size}.json").read_text("utf-8"), "a.json"
        )
    ]
    assert (len(tasks), [t.name for t in tasks if not comes_back(t)]) == (150, [])


@pytest.mark.slow
def test_recorded_answers_come_back(shared_data: Path) -> None:
    files = sorted((shared_data / "recorded" / "nl_ir").glob("*.json"))
    records = [record for f in files for record in json.loads(f.read_text("utf-8"))[::3]]
    lost = [r["id"] for r in records if not comes_back(irc.loads(r["response"]).ir)]
    assert (len(records), lost) == (102, [])
