"""Certain repairs: which are offered, what they do to a text, and that nothing else changes."""

from __future__ import annotations

import json
import os
import random
import stat
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from typer.testing import Result

import irc
from irc.cli.repair import repair_text
from irc.diagnostics import Report
from irc.diagnostics.patching import apply_fixes, apply_patches, operations_of
from irc.diagnostics.suggest import Certain, certain_keyword
from irc.driver.compile import check_task
from irc.frontends.files import parse_task
from oracles.generators import random_task
from runs import run_irc


def report_of(text: str) -> Report:
    try:
        reading = parse_task(text)
    except irc.InputError as error:
        return error.report.located()
    return check_task(reading.task, reading.notes).located()


def fixes(text: str) -> list[Any]:
    return [d["fix"] for d in report_of(text).to_list() if d["fix"] is not None]


def repaired(text: str) -> str:
    return repair_text(text, "<test>")[0]


def actions(more: str) -> str:
    jobs = '[{"id": "boil_potato", "duration": 25}, {"id": "eat", "duration": 5}]'
    return f'{{"actions": {jobs}, {more}}}'


# --- certainty ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "known", "meant"),
    [
        ("Boil Potato", ["boil_potato", "eat"], "boil_potato"),
        ("boil-potato", ["boil_potato", "eat"], "boil_potato"),
        ("BOILPOTATO", ["boil potato"], "boil potato"),
        ("ｇｒｉｌｌ", ["grill"], "grill"),
        ("stov", ["stove"], "stove"),
        ("stovee", ["stove"], "stove"),
        ("stvoe", ["stove"], "stove"),
        ("boil_potatoe", ["boil_potato", "eat"], "boil_potato"),
        ("sandwixh", ["sandwich"], "sandwich"),
        # Not certain:
        ("bake", ["cake"], None),
        ("robot3", ["robot1", "robot2"], None),
        ("robot", ["robot1"], None),
        ("robot11", ["robot1"], None),
        ("cut_a", ["cut_b"], None),
        ("cut_ab", ["cut_a"], None),
        ("toasts", ["toast", "toastss"], None),
        ("Grill", ["grill", "GRILL"], None),
        ("boil", ["bake", "fry"], None),
        ("", ["a"], None),
        ("-", ["_"], None),
        ("x" * 500, ["x" * 499], None),
    ],
)
def test_a_name_is_certain_where_only_one_can_be_meant(
    name: str, known: list[str], meant: str | None
) -> None:
    assert Certain(known).match(name) == meant


@pytest.mark.parametrize(
    ("word", "meant"),
    [
        ("minLag", "min_lag"),
        ("duratoin", "duration"),
        ("nam", "name"),
        ("mix", None),
        ("from", None),
        ("deadlines", "deadline"),
    ],
)
def test_words_of_the_ir_are_certain_sooner(word: str, meant: str | None) -> None:
    known = ("min_lag", "max_lag", "min", "max", "duration", "name", "deadline")
    assert certain_keyword(word, known) == meant


# --- what is offered ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "patch"),
    [
        (
            '{"actions": [], "deadlin": 4}',
            [{"op": "move", "from": "/deadlin", "path": "/deadline"}],
        ),
        (
            '{"actions": [], "objective": "minimise_makespan"}',
            [{"op": "replace", "path": "/objective", "value": "minimize_makespan"}],
        ),
        (
            '{"actions": [], "resources": [{"id": "r", "capacity": "2"}]}',
            [{"op": "replace", "path": "/resources/0/capacity", "value": 2}],
        ),
        (
            '{"actions": [], "groups": [{"id": "g", "actions": [], "required": "false"}]}',
            [{"op": "replace", "path": "/groups/0/required", "value": False}],
        ),
        (
            actions('"precedence": [["Boil Potato", "eat"]]'),
            [{"op": "replace", "path": "/precedence/0/0", "value": "boil_potato"}],
        ),
        (
            actions('"dependencies": [{"predecessor": "boil-potato", "successor": "eat"}]'),
            [{"op": "replace", "path": "/dependencies/0/predecessor", "value": "boil_potato"}],
        ),
        (
            actions('"precedence": [["boil_potato", "eat"], ["boil_potato", "eat"]]'),
            [{"op": "remove", "path": "/precedence/1"}],
        ),
        (
            '{"resources": [{"id": "a/b~c"}], "actions": [{"id": "x", "duration": 1,'
            ' "uses": [{"one_of": ["a/b~c", "a/b~c", "a/b~c"]}]}]}',
            [
                {"op": "remove", "path": "/actions/0/uses/0/one_of/2"},
                {"op": "remove", "path": "/actions/0/uses/0/one_of/1"},
            ],
        ),
        (
            '{"actions": [{"id": "x", "duration": 1}], "state": [{"id": "f"}],'
            ' "goals": [{"var": "f", "value": "True"}]}',
            [{"op": "replace", "path": "/goals/0/value", "value": True}],
        ),
        (
            '{"actions": [{"id": "x", "duration": 1, "a/b": 2}], "deadlinee": 5}',
            [{"op": "move", "from": "/deadlinee", "path": "/deadline"}],
        ),
    ],
)
def test_a_repair_is_a_patch_of_the_document_as_it_is_written(text: str, patch: Any) -> None:
    assert fixes(text) == [patch]


@pytest.mark.parametrize(
    "text",
    [
        '{"actions": [], "deadlin": 4, "deadline": 5}',  # The place is taken.
        '{"actions": [], "deadlin": 4, "deadlinee": 5}',  # Two want it.
        actions('"precedence": [{"before": "eat", "after": "boil_potato", "lag": 1, "minlag": 2}]'),
        actions('"precedence": [["eat", "Eat"]]'),  # It would precede itself.
        actions('"precedence": [["eat", "eat"]]'),
        actions('"resources": [{"id": "unused"}]'),
        actions('"goals": ["drink"]'),
        '{"actions": [{"id": "a", "duration": -1}]}',
        '{"actions": [], "resources": [{"id": "r", "capacity": "two"}]}',
        '{"actions": [{"id": "a", "duration": 1}, {"id": "b", "duration": 1}, {"id": "c", '
        '"duration": 1}], "precedence": [["a", "b"], ["b", "c"], ["a", "c"]], "events": '
        '[{"at": 1, "changes": [{"op": "cancel_actions", "actions": ["b"]}]}]}',
    ],
)
def test_where_there_is_doubt_no_repair_is_offered(text: str) -> None:
    assert list(report_of(text))
    assert fixes(text) == []


def test_a_repair_of_a_task_without_text_has_the_field_names_of_the_ir() -> None:
    document = json.loads(actions('"precedence": [["boil_potato", "eat"], ["Boil_potato", "eat"]]'))
    (told,) = irc.check(irc.Task.from_dict(document)).to_list()
    assert told["fix"] == [
        {"op": "replace", "path": "/precedence/1/before", "value": "boil_potato"}
    ]


# --- the text -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("[1, 1]", "[1]"),
        ("[1, 2, 1]", "[1, 2]"),
        ("[1, 1, 2]", "[1, 2]"),
        ("[\n  1,\n  1,\n  2\n ]", "[\n  1,\n  2\n ]"),
        ("[\n  1,\n  2,\n  1,\n  2\n ]", "[\n  1,\n  2\n ]"),
        ("[1 , 1 ,1 , 2 ]", "[1 , 2 ]"),
        ("[1,1,1]", "[1]"),
        ("[\r\n\t1,\r\n\t1\r\n]", "[\r\n\t1\r\n]"),
    ],
)
def test_what_is_taken_out_takes_one_comma_along(before: str, after: str) -> None:
    def text(goals: str) -> str:
        pairs = goals.replace("1", '["boil_potato", "eat"]').replace("2", '["eat", "rest"]')
        return (
            '{"actions": [{"id": "boil_potato", "duration": 25}, {"id": "eat", "duration": 5}, '
            f'{{"id": "rest", "duration": 5}}],\n "precedence": {pairs}}}'
        )

    assert repaired(text(before)) == text(after)


def test_only_what_is_repaired_changes() -> None:
    text = (
        '{ "actions" : [\t{"id":"boil_potato",  "duratoin":1.50e1 },\r\n'
        '{"id": "eat", "duration": 5}\n], "metadata": {"x": [ 1e2 , "\\u00e9" ]},\n'
        '"precedence":[["Boil Potato" ,"eat"], {"before": "boil_potato", "after": "eat"} ] }\n'
    )
    expected = (
        text.replace('"duratoin"', '"duration"')
        .replace('"Boil Potato"', '"boil_potato"')
        .replace(', {"before": "boil_potato", "after": "eat"}', "")
    )
    assert repaired(text) == expected


def test_what_stands_around_the_document_stays() -> None:
    text = 'Sure!\n```json\n{"actions": [], "deadlin": 4}\n```\nDone.'
    assert repaired(text) == text.replace("deadlin", "deadline")


def test_a_text_that_cannot_be_read_stays_as_it_is() -> None:
    for text in ("", "{", '{"actions": [}', "\ufeff", '{"actions": [], "deadlin": NaN}'):
        assert repaired(text) == text


# --- all together -------------------------------------------------------------------------------

MISTAKES = ("field", "reference", "repeated edge", "repeated action", "repeated resource")


def spoilt(document: dict[str, Any], rng: random.Random) -> dict[str, Any]:
    """The document with some mistakes of which each has a certain repair."""
    document = json.loads(json.dumps(document))
    edges, jobs = document.get("precedence", []), document["actions"]
    for _ in range(rng.randint(1, 8)):
        mistake = rng.choice(MISTAKES)
        job = rng.choice(jobs)
        if mistake == "field" and "duration" in job:
            wrong = rng.choice(["duratoin", "Duration", "durations", "duraton"])
            job[wrong] = job.pop("duration")
        elif mistake == "reference" and edges:
            edge = rng.choice(edges)
            end = rng.choice(["before", "after"])
            edge[end] = rng.choice([edge[end].upper(), f" {edge[end]}", f"{edge[end]}_"])
        elif mistake == "repeated edge" and edges:
            edges.insert(rng.randrange(len(edges) + 1), dict(rng.choice(edges)))
        elif mistake == "repeated action":
            jobs.insert(rng.randrange(len(jobs) + 1), json.loads(json.dumps(job)))
        elif mistake == "repeated resource" and document.get("resources"):
            document["resources"].append(dict(rng.choice(document["resources"])))
    return document


def codes(report: Report) -> list[str]:
    return sorted(d.code.id for d in report.errors)


@pytest.mark.parametrize("seed", range(120))
def test_after_the_repair_the_mistakes_are_gone_and_nothing_else_is_wrong(seed: int) -> None:
    rng = random.Random(f"repair {seed}")
    task = random_task(rng)
    document = json.loads(task.model_dump_json(by_alias=True, exclude_defaults=True))
    if not document["actions"]:
        return
    sound = report_of(json.dumps(document))
    text = json.dumps(spoilt(document, rng), indent=rng.choice([None, 1, 2]))
    result, report, fixed = repair_text(text, "<test>")
    assert codes(report) == codes(sound), report.render()
    assert not any(d.fix for d in report)
    assert len(fixed.diagnostics) == 0 or result != text


@pytest.mark.slow
@settings(max_examples=75)
@given(st.randoms(use_true_random=False))
def test_the_patches_of_a_report_do_to_the_document_what_the_edits_do_to_the_text(
    rng: random.Random,
) -> None:
    task = random_task(rng)
    document = json.loads(task.model_dump_json(by_alias=True, exclude_defaults=True))
    if not document["actions"]:
        return
    text = json.dumps(spoilt(document, rng))
    report = report_of(text)
    assert report.source is not None
    edited = json.loads(apply_fixes(report, report.source))
    assert edited == apply_patches(json.loads(text), report)
    assert edited == one_by_one(json.loads(text), report)


def one_by_one(document: Any, report: Report) -> Any:
    """RFC 6902 as it is written, each patch by itself, from the end of the report."""
    for d in reversed(report.to_list()):
        for operation in d["fix"] or ():
            *parents, last = operation.get("from", operation["path"]).split("/")[1:]
            inner = document
            for part in parents:
                inner = inner[int(part) if isinstance(inner, list) else unescaped(part)]
            key = int(last) if isinstance(inner, list) else unescaped(last)
            if operation["op"] == "replace":
                inner[key] = operation["value"]
            elif operation["op"] == "remove":
                del inner[key]
            else:
                inner[operation["path"].rsplit("/", 1)[1]] = inner.pop(key)
    return document


def unescaped(part: str) -> str:
    return part.replace("~1", "/").replace("~0", "~")


def test_what_stands_inside_of_something_removed_is_not_changed_before() -> None:
    text = actions(
        '"precedence": [{"before": "boil_potato", "after": "eat", "type": "finish-start"}, '
        '["Boil_potato", "eat"], ["Boil_potato", "eat"]]'
    )
    assert [o.op for o in operations_of(report_of(text))] == ["remove", "replace"]
    final = json.loads(repaired(text))
    assert final["precedence"] == [
        {"before": "boil_potato", "after": "eat", "type": "finish-start"}
    ]


@pytest.mark.slow
def test_ten_thousand_repairs_take_one_pass() -> None:
    edges = ",\n".join('["Boil_Potato", "eat"]' for _ in range(10_000))
    final = json.loads(repaired(actions(f'"precedence": [{edges}]')))
    assert final["precedence"] == [["boil_potato", "eat"]]


# --- the command --------------------------------------------------------------------------------


def check_fix(*arguments: str | Path) -> Result:
    return run_irc("check", "--fix", *arguments)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-32", "utf-16-be"])
def test_a_file_keeps_its_encoding_and_line_ends(encoding: str, tmp_path: Path) -> None:
    file = tmp_path / "task.json"
    text = '{"actions": [\r\n{"id": "é", "duratoin": 3}\r\n]}\r\n'
    mark = b"\xfe\xff" if encoding == "utf-16-be" else b""
    file.write_bytes(mark + text.encode(encoding))
    result = check_fix(file)
    assert result.exit_code == 0, result.stdout
    assert file.read_bytes() == mark + text.replace("duratoin", "duration").encode(encoding)


@pytest.mark.skipif(os.name != "posix", reason="permissions and links")
def test_a_file_keeps_its_permissions_and_a_link_stays_a_link(tmp_path: Path) -> None:
    file, link = tmp_path / "task.json", tmp_path / "link.json"
    file.write_text('{"actions": [], "deadlin": 4}')
    file.chmod(0o640)
    link.symlink_to(file)
    assert check_fix(link).exit_code == 0
    assert link.is_symlink()
    assert stat.S_IMODE(file.stat().st_mode) == 0o640
    assert json.loads(file.read_text()) == {"actions": [], "deadline": 4}
    assert sorted(p.name for p in tmp_path.iterdir()) == ["link.json", "task.json"]


def test_a_file_without_certain_repairs_is_not_written(tmp_path: Path) -> None:
    file = tmp_path / "task.json"
    file.write_text('{"actions": [{"id": "a", "duration": -1}]}')
    os.utime(file, ns=(1, 1))
    result = check_fix(file)
    assert (result.exit_code, file.stat().st_mtime_ns) == (1, 1)
    assert "error[IRC105]" in result.stdout
    assert "fixed" not in result.stdout


def test_what_was_repaired_and_what_is_left_is_told_to_programs(tmp_path: Path) -> None:
    file = tmp_path / "task.json"
    file.write_text('{"actions": [{"id": "a", "duration": -1}],\n "deadlin": 4}')
    document = json.loads(check_fix(file, "--format", "json").stdout)
    assert [(d["code"], d["line"], d["column"]) for d in document["fixed"]] == [("IRC102", 2, 2)]
    assert [d["code"] for d in document["diagnostics"]] == ["IRC105"]
    assert document["ok"] is False


def test_several_files_are_told_apart(tmp_path: Path) -> None:
    good, bad = tmp_path / "good.json", tmp_path / "bad.json"
    good.write_text('{"actions": []}')
    bad.write_text('{"actions": [], "xyz": 1}')
    both = ["check", str(good), str(bad)]
    result = run_irc(*both)
    assert result.exit_code == 1
    assert f"{good}: no problems found" in result.stdout
    assert f"{bad}: 1 error" in result.stdout
    document = json.loads(run_irc(*both, "--format", "json").stdout)
    assert document["ok"] is False
    assert [(f["file"], f["ok"]) for f in document["files"]] == [
        (str(good), True),
        (str(bad), False),
    ]


def test_standard_input_cannot_be_repaired_in_place() -> None:
    result = run_irc("check", "--fix", "-", stdin="{}")
    assert result.exit_code == 2
    assert "standard input cannot be rewritten" in result.stderr


@pytest.mark.skipif(os.name != "posix" or os.getuid() == 0, reason="root may write anywhere")
def test_a_folder_that_cannot_be_written_is_told(tmp_path: Path) -> None:
    file = tmp_path / "task.json"
    file.write_text('{"actions": [], "deadlin": 4}')
    tmp_path.chmod(0o500)
    try:
        assert check_fix(file).exit_code == 2
    finally:
        tmp_path.chmod(0o700)
