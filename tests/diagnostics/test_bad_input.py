"""Whatever stands in a file, the answer is diagnostics with places: no traceback and no wait.

One table for all that a user, or a language model, gets wrong.
"""

from __future__ import annotations

import json
import random
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from typer.testing import Result

import irc
from irc.frontends.json.document import decode_bytes
from irc.model import Task
from runs import run_irc

SECONDS = 15
"""What 50 MB of rubbish may take: some two seconds, and patience with a busy machine."""

MB = 1_000_000


@dataclass(frozen=True)
class Bad:
    """A bad input and every error it must be told: code, line and column (None: no place)."""

    name: str
    content: bytes
    errors: tuple[tuple[str, int | None, int | None], ...]
    said: str = ""
    """What a message or a hint must contain, of any of them."""


def bad(name: str, content: str | bytes, *errors: tuple[str, int, int], said: str = "") -> Bad:
    return Bad(name, content.encode() if isinstance(content, str) else content, errors, said)


def action(fields: str) -> str:
    """A task with one action of length 1, on the second line, and some more fields of it."""
    return f'{{"actions": [\n  {{"id": "a", {fields}}}\n]}}'


def actions(count: int, rest: str = "") -> str:
    """A task with actions a, b, c … of length 3 on a line each, and more fields on the last."""
    lines = ",\n".join(f'  {{"id": "{c}", "duration": 3}}' for c in "abcdefgh"[:count])
    return f'{{"actions": [\n{lines}\n],\n{rest}}}'


DEEP = 100_000

TEXT = [
    bad("empty file", "", ("IRC002", 1, 1), said="the input is empty"),
    bad("only blanks", " \n\n ", ("IRC002", 3, 1), said="the input is empty"),
    bad("no JSON at all", "Sorry, I cannot do that.", ("IRC002", 1, 1), said="no JSON object"),
    bad("a list", "[1, 2]", ("IRC002", 1, 1), said="no JSON object"),
    bad("null", "null", ("IRC002", 1, 1)),
    bad("cut in a string", '{\n "actions": [\n  {"id": "a", "dura', ("IRC002", 3, 15)),
    bad(
        "cut between elements",
        '{\n "actions": [\n  {"id": "a", "duration": 1}',
        ("IRC002", 3, 28),
        said="the array '[' of line 2 is not closed",
    ),
    bad("cut in a number", '{"actions": [{"id": "a", "duration": 1', ("IRC002", 1, 38)),
    bad("cut in a word", '{"actions": [{"id": "a", "required": tr', ("IRC002", 1, 38)),
    bad(
        "trailing comma",
        '{"actions": [1,]}',
        ("IRC002", 1, 15),
        ("IRC103", 1, 14),
        said="remove this comma",
    ),
    bad("no comma", '{"actions": []\n "name": "x"}', ("IRC002", 2, 2), said="expected ','"),
    bad("no colon", '{"actions" []}', ("IRC002", 1, 12), said="expected ':'"),
    bad("single quotes", "{'actions': []}", ("IRC002", 1, 2), said="double quotes"),
    bad("a comment", '{"actions": [] // none\n}', ("IRC002", 1, 16)),
    bad("Python's True", action('"duration": True'), ("IRC002", 2, 27), ("IRC104", 2, 27)),
    bad("an escape that is none", '{"actions": "\\x"}', ("IRC002", 1, 14)),
    bad(
        "a tab in a string",
        '{"actions": "\t"}',
        ("IRC002", 1, 14),
        ("IRC103", 1, 13),
        said="control character",
    ),
    bad("two tasks", '{"actions": []}\n{"actions": [1]}', ("IRC002", 2, 1), said="exactly one"),
    bad(
        "not a number",
        '{"actions": [NaN,\n Infinity,\n -Infinity]}',
        ("IRC005", 1, 14),
        ("IRC005", 2, 2),
        ("IRC005", 3, 2),
        said="NaN is not a number in JSON",
    ),
    bad("5,000 digits", action(f'"duration": {"7" * 5000}'), ("IRC005", 2, 27)),
    bad("-5,000 digits", action(f'"duration": 1, "cost": -{"7" * 5000}'), ("IRC005", 2, 38)),
    bad(
        "a key twice",
        '{"actions": [{"id": "a",\n  "id": "b", "duration": 1}],\n"actions": []}',
        ("IRC004", 2, 3),
        ("IRC004", 3, 1),
        said="the key 'actions' appears twice",
    ),
    bad("deep lists", f'{{"actions": {"[" * DEEP}{"]" * DEEP}}}', ("IRC006", 1, 76)),
    bad("deep lists, not closed", f'{{"actions": {"[" * DEEP}', ("IRC006", 1, 76)),
    bad("deep objects", '{"a":' * DEEP + "1" + "}" * DEEP, ("IRC006", 1, 321)),
    bad("just too deep", '{"a":' * 65 + "1" + "}" * 65, ("IRC006", 1, 321), said="64 levels"),
    bad(
        "Latin-1", action('"duration": 1, "label": "caf\xe9"').encode("latin-1"), ("IRC001", 2, 43)
    ),
    bad("a picture", b"\x89PNG\r\n\x1a\n" + bytes(range(256)), ("IRC001", 1, 1)),
    bad("zeros", bytes(1000), ("IRC002", 1, 1)),
    bad("half of UTF-16", b"\xff\xfe{\x00\x00\xd8", ("IRC001", 1, 2), said="UTF-16"),
    bad("UTF-16 without its mark", action('"duration": 1').encode("utf-16-le"), ("IRC002", 1, 2)),
]

SHAPE = [
    bad("no actions", "{}", ("IRC101", 1, 1), said="the task has no 'actions'"),
    bad("actions of the wrong type", '{"actions": 3}', ("IRC103", 1, 13), said="expected a list"),
    bad(
        "each action of the wrong type",
        '{"actions": [1,\n"x",\nnull,\n[],\n{}]}',
        ("IRC103", 1, 14),
        ("IRC103", 2, 1),
        ("IRC103", 3, 1),
        ("IRC103", 4, 1),
        ("IRC101", 5, 1),
    ),
    bad(
        "fields of the wrong type",
        '{"actions": [{"id": 1,\n"duration": true}],\n"resources": "grill",\n"deadline": {},\n'
        '"days_per_month": 2.5,\n"groups": [{"id": "g", "actions": [], "required": 1}]}',
        ("IRC103", 1, 21),
        ("IRC104", 2, 13),
        ("IRC103", 3, 14),
        ("IRC104", 4, 13),
        ("IRC103", 5, 19),
        ("IRC103", 6, 51),
    ),
    bad(
        "version 2", '{"irc": "2", "actions": []}', ("IRC103", 1, 9), said="expected '1', found '2'"
    ),
    bad(
        "misspelt field",
        action('"duraton": 3, "duration": 3'),
        ("IRC102", 2, 15),
        said="`duration`",
    ),
    bad("misspelt part", '{"actions": [], "resouces": []}', ("IRC102", 1, 17), said="`resources`"),
    bad(
        "misspelt objective",
        '{"actions": [], "objective": "minimise_makespan"}',
        ("IRC103", 1, 30),
        said="`minimize_makespan`",
    ),
    bad("no objective", '{"actions": [], "objective": []}', ("IRC103", 1, 30)),
    bad("empty id", '{"actions": [{"id": "", "duration": 1}]}', ("IRC103", 1, 21)),
    bad("half a character", '{"actions": [{"id": "\\ud800", "duration": 1}]}', ("IRC002", 1, 21)),
    bad("10^400", action(f'"duration": 1{"0" * 400}'), ("IRC104", 2, 27), said="40 digits"),
    bad("1e400", action('"duration": 1e400'), ("IRC104", 2, 27), said="40 digits"),
    bad("1e-400", action('"duration": 1e-400'), ("IRC104", 2, 27)),
    bad("1e9999999999", action('"duration": 1e9999999999'), ("IRC104", 2, 27)),
    bad(
        "a capacity of 1e400",
        '{"actions": [], "resources": [{"id": "r",\n"capacity": 1e400}]}',
        ("IRC103", 2, 13),
        said="whole number",
    ),
    bad(
        "half a unit",
        '{"actions": [], "resources": [{"id": "r",\n"capacity": 0.5}]}',
        ("IRC103", 2, 13),
        said="whole number",
    ),
    bad("a time that is none", action('"duration": "soon"'), ("IRC104", 2, 27), said="1 h 30 min"),
    bad(
        "an unknown unit", action('"duration": "3 fortnights"'), ("IRC104", 2, 27), said="known are"
    ),
    bad("a division by zero", action('"duration": "1/0"'), ("IRC104", 2, 27)),
    bad(
        "a date without origin", action('"duration": 1, "release": "2026-03-01"'), ("IRC104", 2, 41)
    ),
    bad("no such date", '{"origin": "2026-02-30", "actions": []}', ("IRC104", 1, 12)),
    bad("a number as date", '{"origin": 5, "actions": []}', ("IRC104", 1, 12)),
    bad(
        "resource and one_of",
        action('"duration": 1, "uses": [{"resource": "r", "one_of": ["r"]}]'),
        ("IRC103", 2, 39),
        said="either 'resource' or 'one_of'",
    ),
    bad("a triple as precedence", actions(3, '"precedence": [["a", "b", "c"]]'), ("IRC103", 6, 16)),
    bad(
        "an alias and its name",
        actions(2, '"precedence": [{"before": "a",\n"after": "b", "lag": 1, "min_lag": 2}]'),
        ("IRC103", 5, 16),
        said="mean the same",
    ),
    bad("no end of a range", action('"duration": {"min": 1}'), ("IRC101", 2, 27), said="no 'max'"),
    bad(
        "an unknown operation",
        '{"actions": [], "events": [{"at": 1,\n"changes": [{"op": "stop"}]}]}',
        ("IRC103", 2, 20),
    ),
]

MEANING = [
    bad(
        "negative times",
        '{"actions": [\n{"id": "a", "duration": -1},\n{"id": "b", "duration": "-2 min"},\n'
        '{"id": "c", "duration": 1, "release": -1},\n{"id": "d", "duration": 1, "deadline": -3}]}',
        ("IRC105", 2, 25),
        ("IRC105", 3, 25),
        ("IRC105", 4, 39),
        ("IRC105", 5, 40),
        said="the duration of action 'b' is negative: -2 min",
    ),
    bad("an empty range", action('"duration": {"min": 3, "max": 2}'), ("IRC106", 2, 27)),
    bad(
        "a cycle",
        actions(3, '"precedence": [["a", "b"], ["b", "c"],\n["c", "a"]]'),
        ("IRC301", 7, 1),
        said="'c' → 'a' → 'b' → 'c'",
    ),
    bad("an action before itself", actions(1, '"precedence": [["a", "a"]]'), ("IRC204", 4, 16)),
    bad(
        "unknown ids",
        '{"actions": [{"id": "boil_potato", "duration": 1,\n'
        '"uses": [{"resource": "pot"},\n{"one_of": ["x"]}]}],\n'
        '"precedence": [{"before": "boil_potatoe",\n"after": "boil_potato"}],\n'
        '"goals": ["eat",\n{"var": "hungry"}],\n"groups": [{"id": "g", "actions": ["cut"]}]}',
        ("IRC201", 2, 23),
        ("IRC201", 3, 13),
        ("IRC201", 4, 27),
        ("IRC201", 6, 11),
        ("IRC201", 7, 9),
        ("IRC201", 8, 36),
        said="did you mean `boil_potato`?",
    ),
    bad(
        "unknown ids in aliases",
        '{"actions": [{"id": "a", "duration": 1}],\n"dependencies": [\n'
        '{"predecessor": "a", "successor": "b"}]}',
        ("IRC201", 3, 35),
    ),
    bad(
        "one id, two actions",
        '{"actions": [{"id": "a", "duration": 1},\n{"id": "a", "duration": 2}]}',
        ("IRC202", 2, 8),
        said="action number 1",
    ),
    bad(
        "nothing to choose from",
        action('"duration": 1, "uses": [{"one_of": []}]'),
        ("IRC205", 2, 50),
    ),
    bad(
        "release + duration > deadline",
        action('"duration": 5, "release": 3,\n"deadline": 7'),
        ("IRC302", 3, 13),
        said="must be at least 8 s",
    ),
    bad(
        "critical path > deadline",
        actions(2, '"precedence": [["a", "b"]],\n"deadline": 5'),
        ("IRC303", 6, 13),
        said="critical path: 'a' → 'b'",
    ),
    bad(
        "critical path > an action's deadline",
        '{"actions": [{"id": "a", "duration": 3},\n{"id": "b", "duration": 3, "deadline": 5}],\n'
        '"precedence": [["a", "b"]]}',
        ("IRC303", 2, 40),
        said="critical path: 'a' → 'b'",
    ),
    bad(
        "demand > capacity",
        '{"resources": [{"id": "r", "capacity": 2}], "actions": [\n'
        '{"id": "a", "duration": 3, "uses": [{"resource": "r", "amount": 3}]},\n'
        '{"id": "b", "duration": 3, "uses": [{"resource": "r"}, {"resource": "r", "amount": 2}]}]}',
        ("IRC304", 2, 36),
        ("IRC304", 3, 36),
        said="needs 3 units of 'r' in all",
    ),
    bad(
        "a minimum above its maximum",
        actions(2, '"precedence": [{"before": "a", "after": "b",\n"min_lag": 5, "max_lag": 3}]'),
        ("IRC106", 6, 26),
    ),
    bad(
        "lags that contradict each other",
        actions(
            3,
            '"precedence": [["a", "b"], ["b", "c"],\n{"before": "a", "after": "c", "max_lag": 2}]',
        ),
        ("IRC305", 7, 42),
        said="by 1 s",
    ),
    bad(
        "an unknown value",
        '{"state": [{"id": "v", "values": ["raw", "done"], "initial": "raw"}],\n"actions": [],\n'
        '"goals": [{"var": "v", "value": "doen"}]}',
        ("IRC210", 3, 33),
        said="`done`",
    ),
]

SEVERAL = [
    bad(
        "everything at once",
        '{"resources": [{"id": "oven"}], "deadline": 5, "actions": [\n'
        '{"id": "mix", "duration": -1},\n'
        '{"id": "bake", "duration": 9, "uses": [{"resource": "ovne"}]},\n'
        '{"id": "cool", "duration": 3, "uses": [{"resource": "oven", "amount": 2}]},\n'
        '{"id": "eat", "duration": "1 min"}],\n'
        '"precedence": [["bake", "cool"],\n["cool", "bake"],\n["eat", "eta"]]}',
        ("IRC303", 1, 45),
        ("IRC105", 2, 27),
        ("IRC201", 3, 53),
        ("IRC304", 4, 39),
        ("IRC301", 7, 1),
        ("IRC201", 8, 9),
        said="did you mean `eat`?",
    )
]

TABLE = [*TEXT, *SHAPE, *MEANING, *SEVERAL]


def irc_check(path: Path, *options: str) -> Result:
    return run_irc("check", path, *options)


def places(diagnostics: list[dict[str, Any]]) -> list[tuple[str, int, int]]:
    return [(d["code"], d["line"], d["column"]) for d in diagnostics if d["severity"] == "error"]


@pytest.mark.slow
@pytest.mark.parametrize("row", TABLE, ids=lambda row: row.name)
def test_every_error_is_told_at_its_place(row: Bad, tmp_path: Path) -> None:
    file = tmp_path / "task.json"
    file.write_bytes(row.content)
    result = irc_check(file, "--format", "json")
    assert isinstance(result.exception, SystemExit)
    assert result.exit_code == 1
    report = json.loads(result.stdout)
    assert (report["ok"], result.stderr) == (False, "")
    assert sorted(places(report["diagnostics"])) == sorted(row.errors)
    assert row.said in "\n".join(f"{d['message']} {d['hint']}" for d in report["diagnostics"])


@pytest.mark.slow
@pytest.mark.parametrize("row", TABLE, ids=lambda row: row.name)
def test_the_text_for_people_points_at_the_same_place(row: Bad, tmp_path: Path) -> None:
    file = tmp_path / "task.json"
    file.write_bytes(row.content)
    result = irc_check(file)
    assert result.exit_code == 1
    for code, line, column in row.errors:
        assert f"error[{code}]" in result.stdout
        assert f"--> {file}:{line}:{column}\n" in result.stdout
    assert "Traceback" not in result.output


@pytest.mark.parametrize(
    ("row", "command"),
    [
        *(
            (row, command)
            for row in (TEXT[0], SHAPE[1], MEANING[2])
            for command in (["compile", "-t", "pddl21"], ["compile", "-t", "cpsat"], ["solve"])
        ),
        (TEXT[0], ["targets"]),
        (SHAPE[1], ["targets"]),
    ],
    ids=lambda value: value.name if isinstance(value, Bad) else " ".join(value),
)
def test_other_commands_tell_the_same_of_a_bad_file(
    row: Bad, command: list[str], tmp_path: Path
) -> None:
    file = tmp_path / "task.json"
    file.write_bytes(row.content)
    result = run_irc(*command, file, "--format", "json")
    assert result.exit_code == 1
    document = json.loads(result.stdout)
    assert places(document["outcome"]["diagnostics"]) == list(row.errors)
    assert document.get("diagnostics", document["outcome"]["diagnostics"])


def test_the_caret_stands_under_the_fault(tmp_path: Path) -> None:
    file = tmp_path / "task.json"
    file.write_text('{"actions": [\n  {"id": "boil", "duration": -4}\n]}')
    lines = irc_check(file).stdout.splitlines()
    (shown,) = (i for i, line in enumerate(lines) if line.startswith(" 2 | "))
    assert lines[shown][lines[shown + 1].index("^") :].startswith("-4}")


# Numbers and texts that a target cannot hold


def compiled_or_refused(document: dict[str, Any], target: str) -> None:
    """Compiles, or says why not: both are answers."""
    try:
        irc.compile(document, target).manifest_text().encode()
    except irc.InputError as error:
        assert error.report.errors, "a refusal without a reason"  # noqa: PT017


@pytest.mark.parametrize("target", ["cpsat", "pddl21"])
@pytest.mark.parametrize("field", ["duration", "release", "deadline", "start"])
def test_times_beyond_64_bits_are_compiled_or_refused(field: str, target: str) -> None:
    first = {"id": "a", "duration": 1, "uses": [{"resource": "r"}], field: 10**38}
    second = {"id": "b", "duration": 1, "uses": [{"resource": "r"}]}
    compiled_or_refused({"resources": [{"id": "r"}], "actions": [first, second]}, target)


def two_in_a_row(*, duration: object = 1, **lags: int) -> dict[str, Any]:
    return {
        "actions": [{"id": "a", "duration": duration}, {"id": "b", "duration": 1}],
        "precedence": [{"before": "a", "after": "b", **lags}],
    }


@pytest.mark.parametrize(
    "document",
    [
        two_in_a_row(min_lag=-(10**30)),
        two_in_a_row(max_lag=10**30),
        {**two_in_a_row(duration={"min": 1, "max": 10**30}), "deadline": 9},
    ],
    ids=["minimum lag", "maximum lag", "longest duration"],
)
def test_what_never_binds_is_compiled_or_refused_beyond_64_bits(document: dict[str, Any]) -> None:
    compiled_or_refused(document, "cpsat")


def two_of(capacity: int, amount: int) -> dict[str, Any]:
    uses = [{"resource": "r", "amount": amount}]
    return {
        "resources": [{"id": "r", "capacity": capacity}],
        "actions": [{"id": c, "duration": 1, "uses": uses} for c in "ab"],
    }


@pytest.mark.parametrize("digits", [6, 18, 19, 900])
def test_huge_amounts_are_compiled_or_refused_for_cp_sat(digits: int) -> None:
    compiled_or_refused(two_of(3 * 10**digits, 2 * 10**digits), "cpsat")


def test_huge_amounts_are_compiled_or_refused_for_pddl() -> None:
    compiled_or_refused(two_of(3 * 10**900, 2 * 10**900), "pddl21")


@pytest.mark.parametrize("field", ["name", "description", "metadata"])
def test_half_a_character_is_refused_wherever_it_stands(field: str) -> None:
    document = {"actions": [], field: {"x": "\ud800"} if field == "metadata" else "\ud800"}
    with pytest.raises(irc.InputError):
        irc.loads(json.dumps(document))


def test_decimals_in_the_metadata_are_carried_through() -> None:
    task = irc.loads('{"actions": [], "metadata": {"rate": 0.1, "far": [1e400]}}').ir
    manifest = json.loads(irc.compile(task, "pddl21").manifest_text())
    assert manifest["task"]["metadata"] == {"rate": 0.1, "far": ["1E+400"]}


# What is no fault


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-32"])
def test_text_with_a_byte_order_mark_is_read(encoding: str, tmp_path: Path) -> None:
    file = tmp_path / "task.json"
    file.write_bytes('{"actions": [{"id": "é", "duration": 3}]}'.encode(encoding))
    assert [a.id for a in irc.load(file).ir.actions] == ["é"]
    assert irc_check(file).exit_code == 0


def test_a_fault_behind_a_byte_order_mark_is_told_at_its_column(tmp_path: Path) -> None:
    file = tmp_path / "task.json"
    file.write_bytes(b"\xef\xbb\xbf" + action('"duration": -1').encode())
    result = irc_check(file, "--format", "json")
    assert places(json.loads(result.stdout)["diagnostics"]) == [("IRC105", 2, 27)]


def test_chatter_around_a_task_is_set_aside_and_places_stay_those_of_the_file(
    tmp_path: Path,
) -> None:
    file = tmp_path / "answer.md"
    task = action('"duration": -1')
    file.write_text(f"Sure!\n```json\n{task}\n```\nAnything else?")
    diagnostics = json.loads(irc_check(file, "--format", "json").stdout)["diagnostics"]
    assert places(diagnostics) == [("IRC105", 4, 27)]
    assert [d["code"] for d in diagnostics if d["severity"] == "note"] == ["IRC003"]


# Files that are none


def test_a_folder_is_not_read(tmp_path: Path) -> None:
    result = irc_check(tmp_path)
    assert (result.exit_code, result.stderr) == (1, "")
    assert f"cannot read '{tmp_path}'" in result.stdout


def test_a_file_that_is_not_there_is_told(tmp_path: Path) -> None:
    result = irc_check(tmp_path / "absent.json")
    assert result.exit_code == 1
    assert "error[IRC001]: cannot read" in result.stdout


def test_a_path_that_no_file_can_have_is_told() -> None:
    with pytest.raises(irc.InputError, match="cannot read"):
        irc.load("task\x00.json")


# Size


def twenty_mb_of(pattern: bytes) -> bytes:
    return pattern * (20 * MB // len(pattern))


RUBBISH = {
    "{": "IRC002",
    "[": "IRC002",
    "[[[[": "IRC002",
    '{"a":': "IRC006",
    "[{": "IRC002",
    '{"': "IRC002",
    "{} ": "IRC101",
    '{"a":1}': "IRC101",
    '"': "IRC002",
    " ": "IRC002",
    "\x00": "IRC002",
    "```{": "IRC002",
}


@pytest.mark.slow
@pytest.mark.parametrize("pattern", RUBBISH)
def test_twenty_megabytes_of_one_thing_are_refused_in_seconds(pattern: str, tmp_path: Path) -> None:
    file = tmp_path / "task.json"
    file.write_bytes(twenty_mb_of(pattern.encode()))
    began = time.process_time()
    report = irc.check(file)
    assert report.render()
    assert time.process_time() - began < SECONDS
    assert RUBBISH[pattern] in {d.code.id for d in report.errors}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("begin", "pattern", "code"),
    [
        ('{"actions": ', "[", "IRC006"),
        ('{"name": "', "x", "IRC002"),
        ('{"name": ', "7", "IRC005"),
        ("{", '"a": 1, ', "IRC004"),
        ('{"actions": [', "NaN, ", "IRC005"),
    ],
)
def test_twenty_megabytes_within_a_document_are_refused_in_seconds(
    begin: str, pattern: str, code: str, tmp_path: Path
) -> None:
    file = tmp_path / "task.json"
    file.write_bytes(begin.encode() + twenty_mb_of(pattern.encode()))
    began = time.process_time()
    report = irc.check(file)
    assert report.render()
    assert time.process_time() - began < SECONDS
    assert code in {d.code.id for d in report.errors}


@pytest.mark.slow
def test_twenty_megabytes_of_random_bytes_are_refused_in_seconds(tmp_path: Path) -> None:
    file = tmp_path / "task.json"
    file.write_bytes(random.Random(1).randbytes(20 * MB))
    began = time.process_time()
    report = irc.check(file)
    assert report.render()
    assert time.process_time() - began < SECONDS
    assert [d.code.id for d in report.errors] == ["IRC001"]


@pytest.mark.slow
def test_thousands_of_faults_are_told_without_a_flood(tmp_path: Path) -> None:
    file = tmp_path / "task.json"
    lines = ",\n".join(f'{{"id": "a{i}", "duration": -1}}' for i in range(5000))
    file.write_text(f'{{"actions": [{lines}]}}')
    report = irc.check(file)
    assert len(report.errors) == 5000
    text = irc_check(file).stdout
    assert text.count("error[IRC105]") == 50
    assert "… and 4950 more of IRC105" in text
    assert "5000 errors" in text


# Fuzzing

SEED = json.dumps(
    {
        "irc": "1",
        "name": "grilled chicken sandwich",
        "time_unit": "s",
        "resources": [
            {"id": "grill", "capacity": 1},
            {"id": "robot1"},
            {"id": "robot2"},
            {"id": "flour", "kind": "reservoir", "initial": 3, "min": 0},
        ],
        "state": [{"id": "chicken", "values": ["raw", "grilled"], "initial": "raw"}],
        "actions": [
            {
                "id": "grill_chicken",
                "duration": "10 s",
                "uses": [{"resource": "grill"}, {"one_of": ["robot1", "robot2"]}],
                "conditions": [{"at": "start", "var": "chicken", "value": "raw"}],
                "effects": [{"at": "end", "var": "chicken", "value": "grilled"}],
            },
            {"id": "stack_chicken", "duration": {"min": "1/3", "max": 0.5}, "release": 1e1},
        ],
        "precedence": [
            {"before": "grill_chicken", "after": "stack_chicken", "min_lag": 3},
            ["grill_chicken", "stack_chicken"],
        ],
        "goals": [{"var": "chicken", "value": "grilled"}, "stack_chicken"],
        "groups": [{"id": "order", "actions": ["stack_chicken"], "required": True}],
        "events": [
            {"at": 5, "changes": [{"op": "set_duration", "action": "stack_chicken", "duration": 4}]}
        ],
        "deadline": "2 min",
        "objective": ["minimize_makespan"],
        "metadata": {"rate": 0.1},
    }
).encode()


def loaded(data: bytes) -> Task | None:
    """The task, or None where an `InputError` says in words why there is none."""
    try:
        return irc.loads(decode_bytes(data, "<test>")).ir
    except irc.InputError as error:
        return None if error.report.errors and error.report.render() else pytest.fail("no reason")


positions = st.integers(0, len(SEED))
pieces = st.binary(max_size=4) | st.sampled_from(
    [b'"', b"{", b"}", b"[", b"]", b",", b":", b"-", b"1e9", b"null", b"NaN", b"\\u", b"\\ud800"]
)
edits = st.lists(st.tuples(positions, st.integers(0, 8), pieces), min_size=1, max_size=6)


def edited(changes: list[tuple[int, int, bytes]]) -> bytes:
    data = bytearray(SEED)
    for at, removed, piece in changes:
        data[at : at + removed] = piece
    return bytes(data)


@pytest.mark.slow
@settings(max_examples=200)
@given(changes=edits)
@example(changes=[(0, 0, b"\xff\xfe")])
@example(changes=[(0, 1, b"")])
def test_a_mutated_document_raises_nothing_but_input_errors(
    changes: list[tuple[int, int, bytes]], tmp_path_factory: pytest.TempPathFactory
) -> None:
    file = tmp_path_factory.getbasetemp() / "mutated.json"
    file.write_bytes(edited(changes))
    report = irc.check(file)
    assert report.ok or report.render()
    for d in report.located():
        assert d.line is None or d.line >= 1
        assert d.severity != "error" or d.line is not None
    task = loaded(file.read_bytes())
    assert report.ok is (task is not None and irc.check(task).ok)


values = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats(allow_nan=False, allow_infinity=False)
    | st.text(max_size=8)
    | st.sampled_from(
        ["a", "b", "1 h", "-1 s", "P1D", "2026-03-01", "start", "once", 10**50, 1e300]
    ),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=6), inner, max_size=3)
    ),
    max_leaves=6,
)


@st.composite
def documents_with_a_wrong_value(draw: st.DrawFn) -> Any:
    """The seed with one value, anywhere, replaced by any other."""
    document = json.loads(SEED)
    inner: Any = document
    while True:
        keys = list(inner) if isinstance(inner, dict) else range(len(inner))
        key = draw(st.sampled_from(list(keys)))
        if isinstance(inner[key], (dict, list)) and inner[key] and draw(st.booleans()):
            inner = inner[key]
            continue
        inner[key] = draw(values)
        return document


@pytest.mark.slow
@settings(max_examples=150)
@given(documents_with_a_wrong_value())
def test_any_value_anywhere_raises_nothing_but_input_errors(document: Any) -> None:
    task = loaded(json.dumps(document).encode())
    if task is None:
        return
    report = irc.check(task)
    assert report.ok or report.render()
    if report.ok:
        for target in ("cpsat", "pddl21"):
            with suppress(irc.InputError):
                irc.compile(task, target)
