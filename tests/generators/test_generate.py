"""`irc generate` writes the families' own formats, IR and English, and always the same bytes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

import irc
from irc.cli.app import build_app
from irc.frontends.formats import load_importer


def generate(folder: Path, *arguments: str) -> int:
    """The exit status of the command."""
    result = CliRunner().invoke(build_app("generate"), ["generate", *arguments, "-o", str(folder)])
    return result.exit_code


def contents(folder: Path) -> dict[str, str]:
    return {
        path.relative_to(folder).as_posix(): path.read_text("utf-8")
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


@pytest.mark.slow
def test_the_files_are_read_by_the_importers_and_are_the_same_each_time(tmp_path: Path) -> None:
    asked = {
        "asyncplan": ("asyncplan", "-n", "5", "-n", "8", "-c", "2", "--seed", "3"),
        "robo": ("robo", "--axis", "easy", "-c", "2"),
        "robo-online": ("robo-online", "--axis", "medium", "-c", "1"),
    }
    for family, arguments in asked.items():
        first, second = tmp_path / f"{family}1", tmp_path / f"{family}2"
        assert generate(first, *arguments) == generate(second, *arguments) == 0
        found = contents(first)
        assert found == contents(second)
        own = {name: text for name, text in found.items() if "/" not in name}
        stems = {
            stem: task
            for name, text in own.items()
            for stem, task in load_importer(family)(text, name)
        }
        assert {f"ir/{stem}.json" for stem in stems} == {n for n in found if n[:3] == "ir/"}
        assert {f"text/{stem}.txt" for stem in stems} == {n for n in found if n[:5] == "text/"}
        for stem in stems:
            assert irc.check(first / "ir" / f"{stem}.json").ok
    graphs = json.loads((tmp_path / "asyncplan1" / "nodes8.json").read_text("utf-8"))
    assert [graph["n_steps"] for graph in graphs] == [8, 8]


def test_a_wrong_request_is_wrong_use(tmp_path: Path) -> None:
    for arguments in (
        ("asyncplam",),
        ("asyncplan", "-n", "1"),
        ("asyncplan", "--axis", "easy"),
        ("robo", "--axis", "eazy"),
    ):
        assert generate(tmp_path / "out", *arguments) == 2
    assert not (tmp_path / "out").exists()
