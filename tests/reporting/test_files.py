"""The files of a schedule: their kinds, what they need, and names that are no instructions."""

from __future__ import annotations

import csv
import io
import re
import xml.etree.ElementTree as ET
from datetime import datetime
from pathlib import Path
from typing import Any

import openpyxl
import pytest

import irc
from builders import act, task_of
from irc.driver.files import WriteError
from irc.errors import LibraryMissing, OptionError
from irc.model import Task
from irc.reporting import files
from irc.reporting.analysis import analyse
from irc.reporting.charts import picture
from irc.reporting.files import KINDS, Shown, require_fit, require_output, save
from irc.reporting.gantt import MOST_BARS, gantt
from irc.reporting.sheets import markdown
from irc.schedule import Entry, Schedule

HOSTILE = [
    "<script>alert(1)</script>",
    "=1+1",
    "a|b\nc",
    "]]>&amp;\x00\x0b",
    "שלום עולם",
    "\u202eevil\u202c",
    "👩‍🍳 cook 🍰",
    "'quoted\" \\",
    "${datum}",
]

ORIGIN = "2026-10-24T20:00:00+02:00"


def hostile() -> tuple[Task, Schedule]:
    task = task_of(
        *(act(name, 3, uses=[{"resource": f"r {name}"}], due=2) for name in HOSTILE),
        name="<b>plan</b>",
        time_unit="h",
        origin=ORIGIN,
        resources=[{"id": f"r {name}", "label": f"<i>{name}"} for name in HOSTILE],
    )
    entries = [Entry(name, 3 * k, 3 * k + 3, {f"r {name}": 1}) for k, name in enumerate(HOSTILE)]
    return task, Schedule(tuple(entries)).of(task)


def written(kind: str, tmp_path: Path) -> Path:
    task, schedule = hostile()
    path = tmp_path / f"plan{kind}"
    save(task, schedule, path)
    return path


@pytest.mark.slow
def test_a_picture_is_xml_in_which_names_are_text(tmp_path: Path) -> None:
    text = written(".svg", tmp_path).read_text()
    root = ET.fromstring(text)
    assert not [e for e in root.iter() if e.tag.endswith(("script", "foreignObject"))]
    assert "<script" not in text
    shown = "".join(root.itertext())
    assert "<i><script>alert(1)</script>" in shown
    assert "שלום" in shown
    assert "\u202e" not in shown


@pytest.mark.slow
def test_pictures_of_hostile_names_are_made(tmp_path: Path) -> None:
    assert written(".png", tmp_path).read_bytes().startswith(b"\x89PNG")


@pytest.mark.slow
def test_a_font_that_is_not_there_is_replaced() -> None:
    spec = gantt(analyse(*hostile()))
    spec["config"]["font"] = "No Such Font At All"
    assert picture(spec, "pdf").startswith(b"%PDF")


def test_a_workbook_has_real_dates_and_no_formulas(tmp_path: Path) -> None:
    book = openpyxl.load_workbook(written(".xlsx", tmp_path))
    assert book.sheetnames == ["summary", "plan", "orders", "resources", "days"]
    plan = book["plan"]
    headings = [cell.value for cell in plan[1]]
    assert headings[:5] == ["action", "start (h)", "start_at", "end (h)", "end_at"]
    assert [row[2] for row in plan.iter_rows(min_row=2, values_only=True)][:3] == [
        datetime(2026, 10, 24, 20),
        datetime(2026, 10, 24, 23),
        datetime(2026, 10, 25, 2),
    ]
    assert plan["C2"].is_date
    assert not [c for sheet in book for row in sheet.iter_rows() for c in row if c.data_type == "f"]
    assert "=1+1" in [cell.value for cell in plan["A"]]


def test_csv_has_every_action_and_no_formulas(tmp_path: Path) -> None:
    rows = list(csv.reader(io.StringIO(written(".csv", tmp_path).read_text(), newline="")))
    assert len(rows) == len(HOSTILE) + 1
    assert {len(row) for row in rows} == {len(rows[0])}
    assert not [cell for row in rows for cell in row if cell.startswith("=")]


def test_markdown_has_tables_in_which_names_are_text() -> None:
    text = markdown(analyse(*hostile()))
    plan = text.split("## plan")[1].split("##")[0].strip().split("\n")
    assert len(plan) == len(HOSTILE) + 2
    assert len({len(re.findall(r"(?<!\\)\|", line)) for line in plan}) == 1
    assert "\\<script\\>" in text
    assert "<script" not in text.replace("\\<script", "")


def test_text_and_json_and_calendars_are_written(tmp_path: Path) -> None:
    assert "BEGIN:VEVENT" in written(".ics", tmp_path).read_text()
    assert '"start_at": "2026-10-24T20:00:00+02:00"' in written(".json", tmp_path).read_text()
    assert "makespan 27" in written(".txt", tmp_path).read_text()


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("plan.svgg", "did you mean"),
        ("plan.doc", "its name must end in one of .json, .html, .svg"),
    ],
)
def test_an_unknown_ending_is_refused(name: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(OptionError, match=said):
        require_output(tmp_path / name)


def test_a_folder_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(WriteError, match="there is no folder"):
        require_output(tmp_path / "nowhere" / "plan.svg")


@pytest.mark.parametrize(
    ("kind", "extra"), [(".svg", "plot"), (".xlsx", "files"), (".ics", "files")]
)
def test_a_missing_library_names_the_extra(
    kind: str, extra: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(files, "find_spec", lambda name: None)
    with pytest.raises(LibraryMissing, match=re.escape(f"irc-compiler[{extra}]")):
        require_output(tmp_path / f"plan{kind}")


def test_a_calendar_needs_an_origin() -> None:
    with pytest.raises(OptionError, match="'origin'"):
        require_fit(Path("plan.ics"), task_of(act("a")))


def test_too_many_actions_for_a_picture_are_refused_before_solving() -> None:
    many = task_of(*(act(f"a{k}") for k in range(MOST_BARS + 1)))
    with pytest.raises(OptionError, match=r"5,000 actions.*plan\.xlsx"):
        require_fit(Path("plan.svg"), many)
    require_fit(Path("plan.csv"), many)


def test_every_kind_has_a_writer_and_a_name() -> None:
    assert all(kind.what and kind.ending == ending for ending, kind in KINDS.items())
    task, schedule = hostile()
    assert KINDS[".json"].write(Shown(task, schedule)).startswith("{")  # type: ignore[arg-type]


def _bars(spec: dict[str, Any], kind: str) -> list[tuple[float, float]]:
    return [
        (value["start"], value["end"])
        for layer in spec["layer"]
        for value in layer["data"]["values"]
        if value.get("kind") == kind
    ]


def test_the_chart_draws_bars_set_ups_pauses_closed_times_and_due_dates() -> None:
    task = task_of(
        act("a", 2, uses=[{"resource": "booth", "family": "red"}], due=3),
        act("b", 4, uses=[{"resource": "booth", "family": "blue"}], breaks="pause"),
        resources=[
            {
                "id": "booth",
                "calendar": "day",
                "setups": {"times": [{"from": "red", "to": "blue", "time": 1}]},
            }
        ],
        calendars=[{"id": "day", "every": 10, "open": [{"from": 0, "to": 5}]}],
    )
    booth = {"booth": 1}
    schedule = Schedule((Entry("a", 0, 2, booth), Entry("b", 3, 12, booth, paused=5)))
    spec = gantt(analyse(task, schedule))
    assert sorted(_bars(spec, "critical")) == [(0.0, 2.0), (3.0, 12.0)]
    assert _bars(spec, "set-up") == [(2.0, 3.0)]
    assert _bars(spec, "pause") == [(5.0, 10.0)]
    assert _bars(spec, "closed") == [(5.0, 10.0)]
    assert _bars(spec, "due date") == [(3.0, 3.0)]


def test_what_overlaps_on_a_resource_has_rows_of_its_own() -> None:
    task = task_of(
        act("a", 4, uses=[{"resource": "team"}]),
        act("b", 4, uses=[{"resource": "team"}]),
        act("c", 4, uses=[{"resource": "team"}]),
        resources=[{"id": "team", "capacity": 2}],
    )
    team = {"team": 1}
    entries = Entry("a", 0, 4, team), Entry("b", 2, 6, team), Entry("c", 4, 8, team)
    values = gantt(analyse(task, Schedule(entries)))["layer"][0]["data"]["values"]
    assert {v["label"]: v["row"] for v in values} == {"a": "0.0", "b": "0.1", "c": "0.0"}


@pytest.mark.slow
def test_altair_takes_the_chart() -> None:
    task, schedule = hostile()
    chart = schedule.plot()
    assert chart.to_dict()["width"] >= 900
    assert schedule.plot(task=task).to_dict() == chart.to_dict()


def test_a_schedule_from_a_file_needs_its_task_for_tables() -> None:
    task, schedule = hostile()
    read = irc.Schedule.from_dict(schedule.to_dict())
    with pytest.raises(irc.OptionError, match="task="):
        read.orders()
    assert list(read.orders("pandas", task=task)["lateness"]) == [3 * k + 1 for k in range(9)]


def test_frames_have_a_row_for_each_resource_and_day() -> None:
    _, schedule = hostile()
    assert list(schedule.resources("pandas")["busy"]) == [3] * 9
    days = schedule.days("pandas")
    assert [str(day) for day in days["day"]] == ["2026-10-24", "2026-10-25"]
    assert list(days["begun"]) == [2, 7]
