"""Tasks as tables: workbooks and CSV files, read, written, and refused cell by cell."""

from __future__ import annotations

import datetime as dt
import io
import json
import zipfile
from pathlib import Path

import openpyxl
import pytest

import irc
from irc.diagnostics import InputError
from irc.frontends.convert import convert_file
from irc.frontends.files import read_task
from irc.frontends.tables.cells import Sheet
from irc.frontends.tables.files import csv_text, workbook_bytes
from irc.frontends.tables.reader import task_of_sheets
from irc.frontends.tables.writer import sheets_of_task, template_sheets
from irc.model import Task
from irc.model.canonical import canonical_task
from paths import EXAMPLES
from runs import run_irc

ACTIONS = [["action", "duration", "uses", "after"], ["cut", 30, "saw", None]]


def task(*sheets: Sheet) -> Task:
    return task_of_sheets(sheets, "plan.xlsx")


def refused(*sheets: Sheet) -> str:
    with pytest.raises(InputError) as raised:
        task(*sheets)
    return str(raised.value)


SAYABLE = [
    *("bakery_rounds.irc", "burger_kitchen.json", "house_build_100.json", "lab_assay.json"),
    *("late_dinner.json", "morning_delivery.json", "pizza_van.json", "print_shop.json"),
    *("rested_combo.irc", "robot_team.json", "roof_repair.json", "sourdough_bread.json"),
    *("sunday_roast.json", "tailor.json"),
]


@pytest.mark.parametrize("name", SAYABLE)
def test_an_example_is_written_and_read_back_equal(name: str, tmp_path: Path) -> None:
    written = {**canonical_task(read_task(EXAMPLES / name).task)}
    written.pop("metadata", None)
    convert_file(str(EXAMPLES / name), None, tmp_path / "plan.xlsx")
    assert canonical_task(read_task(tmp_path / "plan.xlsx").task) == written
    convert_file(str(EXAMPLES / name), None, tmp_path / "plan", target="tables")
    convert_file(str(tmp_path / "plan"), "tables", tmp_path / "back.json")
    assert canonical_task(read_task(tmp_path / "back.json").task) == written


@pytest.mark.parametrize(
    ("name", "what"),
    [("cellar_fuses.irc", "a table has no state variables"), ("pancake_morning.json", "no events")],
)
def test_what_a_table_cannot_say_is_refused(name: str, what: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=what):
        convert_file(str(EXAMPLES / name), None, tmp_path / "plan.xlsx")
    assert not list(tmp_path.iterdir())


def test_the_template_is_a_task_that_can_be_solved(tmp_path: Path) -> None:
    (tmp_path / "plan.xlsx").write_bytes(workbook_bytes(template_sheets()))
    found = read_task(tmp_path / "plan.xlsx").task
    assert irc.solve(found).makespan == 135
    for sheet in template_sheets():
        (tmp_path / f"{sheet.name}.csv").write_text(csv_text(sheet))
    convert_file(str(tmp_path), "tables", tmp_path / "task.json")
    assert canonical_task(read_task(tmp_path / "task.json").task) == canonical_task(found)


FACTORY = {
    "time_unit": "min",
    "resolution": "1 s",
    "origin": "2026-03-02T06:00:00",
    "calendars": [
        {
            "id": "day shift",
            "time_zone": "Europe/Berlin",
            "open": [
                {"days": ["mon", "tue"], "from": "06:00", "to": "14:00"},
                {"days": ["sat"], "from": "08:00", "to": "12:00"},
            ],
            "closed": ["2026-12-25", {"from": "2026-03-03T07:00:00", "to": "2026-03-03T08:30:00"}],
        }
    ],
    "resources": [
        {
            "id": "press",
            "calendar": "day shift",
            "description": "the old one",
            "setups": {
                "initial": "clean",
                "times": [
                    {"from": "*", "to": "red", "time": 30},
                    {"from": "red", "to": "blue", "time": "20 min", "cost": 5},
                ],
            },
        }
    ],
    "actions": [
        {
            "id": "print red",
            "duration": "7 h",
            "breaks": "pause",
            "max_pause": "1 day",
            "uses": [{"resource": "press", "family": "red"}],
        },
        {"id": "read", "duration": 5, "calendar": "day shift", "description": "proofs"},
    ],
    "objective": ["minimize_setup_time", "minimize_makespan"],
}


def test_calendars_pauses_and_set_ups_are_written_and_read_back(tmp_path: Path) -> None:
    (tmp_path / "task.json").write_text(json.dumps(FACTORY))
    written = canonical_task(read_task(tmp_path / "task.json").task)
    convert_file(str(tmp_path / "task.json"), None, tmp_path / "plan.xlsx")
    convert_file(str(tmp_path / "task.json"), None, tmp_path / "folder", target="tables")
    assert canonical_task(read_task(tmp_path / "plan.xlsx").task) == written
    convert_file(str(tmp_path / "folder"), "tables", tmp_path / "back.json")
    assert canonical_task(read_task(tmp_path / "back.json").task) == written


SHOP = {
    "resources": [{"id": "m"}, {"id": "n"}, {"id": "kiln", "kind": "batch", "capacity": 4}],
    "actions": [
        {"id": f"{m}{k}", "duration": 3, "uses": [{"resource": m}]} for m in "mn" for k in (1, 2)
    ]
    + [{"id": "bake", "duration": 3, "uses": [{"resource": "kiln", "family": "red"}]}],
    "sequences": [
        {"consecutive": ["m1", "m2"]},
        {"consecutive": ["n1", "n2"], "resource": "n"},
        {"same_order": ["m", "n"], "jobs": [["m1", "n1"], ["m2", "n2"]]},
        {"same_order": ["n", "m"]},
    ],
}


def test_orders_of_uses_and_loads_are_written_and_read_back(tmp_path: Path) -> None:
    (tmp_path / "task.json").write_text(json.dumps(SHOP))
    written = canonical_task(read_task(tmp_path / "task.json").task)
    convert_file(str(tmp_path / "task.json"), None, tmp_path / "plan.xlsx")
    assert canonical_task(read_task(tmp_path / "plan.xlsx").task) == written


def test_an_order_has_the_same_resources_in_all_its_rows() -> None:
    rows = [["number", "resources", "job"], [1, "m; n", "a; b"], [1, "m", "c"]]
    actions = Sheet("actions", [["action", "duration"], ["a", 1], ["b", 1], ["c", 1]])
    assert "the same resources" in refused(actions, Sheet("same_order", rows))


def test_a_time_of_day_is_a_cell_of_its_own_kind() -> None:
    found = task(
        Sheet("actions", [["action", "calendar"], ["a", "day"]]),
        Sheet("calendars", [["calendar", "days", "from", "to"], ["day", "mon", dt.time(6), "14"]]),
    )
    (only,) = found.calendars[0].open
    assert only.days == ("mon",)


def test_cells_are_read_as_people_write_them() -> None:
    found = task(
        Sheet("Task", [["field", "value"], ["origin", dt.datetime(2026, 3, 2, 8)]]),
        Sheet(
            "Actions",
            [
                [None],
                ["Activity", "Duration", "Due date", "uses", "Predecessors", "deadline"],
                [7, 2.5, dt.datetime(2026, 3, 2, 12), "Ana | Bo; crane x 2", None, None],
                ["b", dt.timedelta(hours=1), "2026-03-02 12:30", None, "7", "2 h"],
                [None, None, None],
            ],
        ),
        Sheet("resources", [["resource", "capacity"], ["Ana"], ["Bo", None], ["crane", 3.0]]),
        Sheet("# notes", [["anything"]]),
    )
    first, second = found.actions
    assert (first.id, str(first.duration)) == ("7", "5/2")
    assert [(u.alternatives, u.amount) for u in first.uses] == [(("Ana", "Bo"), 1), (("crane",), 2)]
    assert found.number(first.due) == 4 * 3600
    assert found.number(second.duration) == 3600
    assert found.number(second.due) == 4.5 * 3600
    assert [(p.before, p.after) for p in found.precedence] == [("7", "b")]


@pytest.mark.parametrize(
    ("sheets", "message"),
    [
        ([Sheet("acts", ACTIONS)], "did you mean `actions`"),
        ([Sheet("actions", [["duration"], [3]])], "the column 'action' is missing"),
        ([Sheet("actions", [["action", "durration"], ["a", 3]])], "did you mean `duration`"),
        ([Sheet("actions", [["action", "id"], ["a", "a"]])], "the column 'action' is there twice"),
        (
            [Sheet("actions", [*ACTIONS, [None, 20]])],
            "sheet 'actions', A3 (action): the cell of 'action' is empty",
        ),
        (
            [Sheet("actions", [["action", "due"], ["a", "02.03.2026"]])],
            "B2 (due): the date '02.03.2026' could be read in several ways",
        ),
        (
            [Sheet("actions", [["action", "duration"], ["a", dt.time(1, 30)]])],
            "expected a length of time, found the time of day 01:30:00",
        ),
        (
            [Sheet("actions", [["action", "duration"], ["a", "three"]])],
            "plan.xlsx, sheet 'actions', row 2",
        ),
        ([Sheet("actions", [*ACTIONS, ["b", 1, None, "cat"]])], "did you mean `cut`"),
        (
            [Sheet("actions", [["action", "weight"], ["a", 1.5]])],
            "expected a whole number, found '1.5'",
        ),
        (
            [Sheet("actions", ACTIONS), Sheet("uses", [["action", "resource"], ["cux", "saw"]])],
            "there is no action 'cux'",
        ),
        (
            [
                Sheet("actions", [["action", "order"], ["a", "A1"]]),
                Sheet("orders", [["order"], ["A2"]]),
            ],
            "no action belongs to the order 'A2'",
        ),
    ],
)
def test_a_fault_names_its_cell(sheets: list[Sheet], message: str) -> None:
    assert message in refused(*sheets)


def test_all_faults_come_at_once() -> None:
    with pytest.raises(InputError) as raised:
        task(
            Sheet("actions", [["action", "weight"], *([f"a{n}", "x"] for n in range(80))]),
            Sheet("uses", [["action", "resource"], ["q", "r"]]),
        )
    assert len(raised.value.report.diagnostics) == 81


def test_merged_cells_are_refused(tmp_path: Path) -> None:
    book = openpyxl.Workbook()
    page = book.active
    page.title = "actions"
    page.append(["action", "duration"])
    page.append(["a", 1])
    page.append([None, 2])
    page.merge_cells("A2:A3")
    book.save(tmp_path / "plan.xlsx")
    with pytest.raises(InputError, match="cells A2:A3 are merged"):
        read_task(tmp_path / "plan.xlsx")


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04 cut", b"<html></html>"])
def test_what_is_no_workbook_is_refused(content: bytes, tmp_path: Path) -> None:
    (tmp_path / "plan.xlsx").write_bytes(content)
    with pytest.raises(InputError, match="is not a workbook"):
        read_task(tmp_path / "plan.xlsx")


def test_a_bomb_is_refused(tmp_path: Path) -> None:
    buffer = io.BytesIO(workbook_bytes([Sheet("actions", ACTIONS)]))
    bomb = '<!DOCTYPE a [<!ENTITY b "bbbbbbbb">' + "".join(
        f'<!ENTITY {chr(99 + n)} "{f"&{chr(98 + n)};" * 10}">' for n in range(12)
    )
    bomb += "]><worksheet><sheetData><row><c t='str'><v>&m;</v></c></row></sheetData></worksheet>"
    with zipfile.ZipFile(buffer) as old, zipfile.ZipFile(tmp_path / "b.xlsx", "w") as new:
        for one in old.infolist():
            inner = "sheet1" in one.filename
            new.writestr(one.filename, bomb if inner else old.read(one))
    with pytest.raises(InputError, match="is not a workbook"):
        read_task(tmp_path / "b.xlsx")
    with zipfile.ZipFile(tmp_path / "z.xlsx", "w", zipfile.ZIP_DEFLATED) as packed:
        packed.writestr("xl/worksheets/sheet1.xml", b" " * 300_000_000)
    with pytest.raises(InputError, match="bytes when unpacked"):
        read_task(tmp_path / "z.xlsx")


def test_no_name_becomes_a_formula(tmp_path: Path) -> None:
    names = ["=1+1", "+a", "-5", "@x", "'=y", "a;b", 'say "x"', "two\nlines"]
    found = Task(actions=[{"id": name, "duration": 1} for name in names])
    sheets = sheets_of_task(found)
    (tmp_path / "plan.xlsx").write_bytes(workbook_bytes(sheets))
    page = openpyxl.load_workbook(tmp_path / "plan.xlsx")["actions"]
    assert [page.cell(r, 1).data_type for r in range(2, 10)] == ["s"] * 8
    (text,) = map(csv_text, sheets)
    assert "\n=1" not in text
    assert "\n'=1+1" in text
    (tmp_path / "plan.csv").write_text(text)
    assert [a.id for a in read_task(tmp_path / "plan.csv").task.actions] == names
    assert [a.id for a in read_task(tmp_path / "plan.xlsx").task.actions] == names


def test_a_csv_file_with_semicolons_and_a_mark_is_read(tmp_path: Path) -> None:
    (tmp_path / "plan.csv").write_text("\ufeffaction;duration\nschön;1.5\n", encoding="utf-8")
    (only,) = read_task(tmp_path / "plan.csv").task.actions
    assert (only.id, str(only.duration)) == ("schön", "3/2")
    (tmp_path / "plan.csv").write_text("action;duration\na;1,5\n")
    with pytest.raises(InputError, match="row 2"):
        read_task(tmp_path / "plan.csv")


@pytest.mark.parametrize("name", ["first.irc", "first.json", "first.xlsx", "first"])
def test_a_first_task_can_be_solved_and_is_not_overwritten(name: str, tmp_path: Path) -> None:
    done = run_irc("new", tmp_path / name)
    assert done.exit_code == 0, done.stderr
    task_file = tmp_path / "task.json"
    convert_file(str(tmp_path / name), "tables" if name == "first" else None, task_file)
    assert irc.solve(task_file).status == "optimal"
    again = run_irc("new", tmp_path / name)
    assert (again.exit_code, "is already there" in again.stderr) == (2, True)
