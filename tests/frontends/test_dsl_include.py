"""`include`: files of the task's own folder, their faults told in them, and nothing beyond."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest

import irc
from irc.diagnostics import Report
from irc.frontends.dsl import include
from runs import run_irc

KITCHEN = "resource grill, fryer\nresource board capacity 2\n"
TASK = 'include "kitchen.irc"\nfry onions 8 on fryer\nchop 2 on board\ngrill 3 on grill\n'


def files(folder: Path, **texts: str) -> Path:
    """Writes `name.irc` for each text and returns the path of `task.irc`."""
    for name, text in texts.items():
        (folder / f"{name}.irc").write_text(text, "utf-8")
    return folder / "task.irc"


def told(report: Report) -> list[tuple[str, str, int | None, int | None]]:
    """(code, file, line, column) of every error."""
    return [
        (d.code.id, Path(d.within.name).name if d.within else "", d.line, d.column)
        for d in report.located().errors
    ]


@pytest.mark.slow
def test_what_a_file_declares_is_there_where_it_is_included(tmp_path: Path) -> None:
    path = files(tmp_path, task=TASK, kitchen=KITCHEN)
    assert [r.id for r in irc.load(path).ir.resources] == ["grill", "fryer", "board"]
    assert list(irc.check(path)) == []


def test_a_file_below_the_folder_includes_beside_itself(tmp_path: Path) -> None:
    (tmp_path / "sub").mkdir()
    files(tmp_path / "sub", a='include "b.irc"\n', b="resource r\n")
    path = files(tmp_path, task='include "sub/a.irc"\nx 1 on r\n')
    assert irc.check(path).ok


def test_a_fault_in_an_included_file_is_told_there(tmp_path: Path) -> None:
    path = files(
        tmp_path, task=TASK, kitchen="resource grill, fryer, board\n\nresource x capacity y"
    )
    assert told(irc.check(path)) == [("IRC010", "kitchen.irc", 3, 21)]


def test_what_the_checks_find_in_an_included_file_is_told_there(tmp_path: Path) -> None:
    kitchen = "# shared\nresource grill, fryer, board\nprep 3 on bord\n"
    path = files(tmp_path, task=TASK + "y 1 on z\n", kitchen=kitchen)
    report = irc.check(path)
    assert told(report) == [("IRC201", "", 5, 8), ("IRC201", "kitchen.irc", 3, 11)]
    shown = report.render()
    assert "kitchen.irc:3:11\n 3 | prep 3 on bord" in shown
    assert f"{path}:5:8\n 5 | y 1 on z" in shown


def test_json_output_names_the_included_file(tmp_path: Path) -> None:
    path = files(tmp_path, task=TASK, kitchen="resource grill, fryer, board\nprep 3 on bord\n")
    result = run_irc("check", path, "--format", "json")
    (found,) = json.loads(result.stdout)["diagnostics"]
    assert (found["line"], found["column"]) == (2, 11)
    assert found["file"] == str(tmp_path / "kitchen.irc")


def test_places_are_those_of_the_texts_that_were_read(tmp_path: Path) -> None:
    """A file that is changed or gone meanwhile does not move a place."""
    path = files(tmp_path, task=TASK, kitchen=KITCHEN + "prep 3 on bord\n")
    task = irc.load(path).ir
    (tmp_path / "kitchen.irc").write_text("\n\n\n")
    assert told(irc.check(task)) == [("IRC201", "kitchen.irc", 3, 11)]
    task = irc.load(files(tmp_path, task=TASK + "y 1 on z\n", kitchen=KITCHEN)).ir
    (tmp_path / "kitchen.irc").unlink()
    assert told(irc.check(task)) == [("IRC201", "", 5, 8)]


def test_a_file_that_includes_itself_is_told(tmp_path: Path) -> None:
    path = files(tmp_path, task='include "task.irc"\nx 1\n')
    assert told(irc.check(path)) == [("IRC015", "", 1, 9)]


def test_files_that_include_each_other_are_told_with_the_way_round(tmp_path: Path) -> None:
    path = files(tmp_path, task='include "a.irc"\nx 1', a='include "b.irc"', b='include "a.irc"')
    report = irc.check(path)
    assert told(report) == [("IRC015", "b.irc", 1, 9)]
    assert "a.irc → b.irc → a.irc" in report.errors[0].message


@pytest.mark.parametrize(
    "name", ["../outside.irc", "sub/../../outside.irc", "link.irc", "linked/outside.irc"]
)
def test_an_include_that_leaves_the_folder_is_refused(tmp_path: Path, name: str) -> None:
    inside = tmp_path / "inside"
    (inside / "sub").mkdir(parents=True)
    (tmp_path / "outside.irc").write_text("resource secret\n")
    try:
        os.symlink(tmp_path / "outside.irc", inside / "link.irc")
        os.symlink(tmp_path, inside / "linked")
    except OSError:
        pytest.skip("no symbolic links here")
    path = files(inside, task=f'include "{name}"\nx 1 on secret')
    report = irc.check(path)
    assert told(report) == [("IRC015", "", 1, 9)]
    assert "secret" not in report.render().replace("on secret", "")


def test_whether_there_is_a_file_outside_the_folder_is_not_told(tmp_path: Path) -> None:
    (tmp_path / "inside").mkdir()
    (tmp_path / "there.irc").write_text("resource secret\n")
    messages = {
        irc.check(files(tmp_path / "inside", task=f'include "../{name}.irc"\nx 1'))
        .errors[0]
        .message.replace(name, "")
        for name in ("there", "nowhere")
    }
    assert messages == {"'../.irc' leads out of the task's folder"}


@pytest.mark.parametrize("name", ["/etc/passwd", "C:\\\\temp\\\\x.irc", "\\\\\\\\host\\\\x"])
def test_an_absolute_path_is_refused(tmp_path: Path, name: str) -> None:
    report = irc.check(files(tmp_path, task=f'include "{name}"\nx 1'))
    assert told(report) == [("IRC015", "", 1, 9)]
    assert "absolute" in report.errors[0].message


def test_a_missing_file_is_told_with_the_one_that_was_meant(tmp_path: Path) -> None:
    report = irc.check(files(tmp_path, task='include "kitchn.irc"\nx 1', kitchen=KITCHEN))
    assert told(report) == [("IRC015", "", 1, 9)]
    assert report.errors[0].hint == "did you mean `kitchen.irc`?"


def test_what_is_no_plain_file_or_no_text_is_refused(tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "binary.irc").write_bytes(b"\xff\xfe\x00\xd8\x89")
    task = 'include "folder"\ninclude "binary.irc"\ninclude ""\nx 1'
    report = irc.check(files(tmp_path, task=task))
    assert [(code, line) for code, _, line, _ in told(report)] == [
        ("IRC015", 1),
        ("IRC015", 2),
        ("IRC015", 3),
    ]


def test_a_pipe_is_not_waited_for(tmp_path: Path) -> None:
    if not hasattr(os, "mkfifo"):
        pytest.skip("no pipes here")
    os.mkfifo(tmp_path / "pipe.irc")
    report = irc.check(files(tmp_path, task='include "pipe.irc"\nx 1'))
    assert told(report) == [("IRC015", "", 1, 9)]


def test_the_size_of_all_included_files_is_bounded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(include, "MAX_INCLUDED_BYTES", 100)
    path = files(tmp_path, task='include "a.irc"\nx 1', a="# " + "x" * 200)
    assert told(irc.check(path)) == [("IRC015", "", 1, 9)]


def test_files_that_include_each_file_twice_do_not_multiply_without_end(tmp_path: Path) -> None:
    for i in range(40):
        (tmp_path / f"f{i}.irc").write_text(f'include "f{i + 1}.irc"\ninclude "f{i + 1}.irc"\n')
    (tmp_path / "f40.irc").write_text("resource r\n")
    report = irc.check(files(tmp_path, task='include "f0.irc"\nx 1'))
    assert not report.ok
    assert {code for code, *_ in told(report)} == {"IRC015"}


def test_a_text_that_is_no_file_includes_nothing() -> None:
    with pytest.raises(irc.InputError) as caught:
        irc.loads('x 1\ninclude "kitchen.irc"')
    assert told(caught.value.report) == [("IRC015", "", 2, 9)]


def test_an_include_in_a_for_is_refused(tmp_path: Path) -> None:
    path = files(tmp_path, task='for a in b: include "kitchen.irc"\nx 1', kitchen=KITCHEN)
    assert told(irc.check(path)) == [("IRC010", "", 1, 13)]


def test_names_that_a_faulty_include_may_declare_are_not_called_unknown(tmp_path: Path) -> None:
    path = files(tmp_path, task='include "missing.irc"\nx 1 on grill')
    assert told(irc.check(path)) == [("IRC015", "", 1, 9)]
