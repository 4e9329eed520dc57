"""The HTML report: its numbers are the schedule's; nothing in it becomes markup or a request."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from fractions import Fraction
from html.parser import HTMLParser
from typing import Any

import pytest

from irc.driver.solve import solve_task
from irc.execution.simulation import simulate
from irc.frontends.files import read_task
from irc.model import Task
from irc.model.times import format_number, parse_number
from irc.reporting.html import ReportTooLarge, payload_of, report_html
from irc.reporting.html.page import data
from irc.schedule import Entry, Schedule, Status
from irc.targets import SolveOptions
from paths import EXAMPLES
from reporting.shops import shop

START, END, RESOURCES = 4, 5, 8
NAMES = ["</script><script>alert(1)</script>", "<!-- خبز 🍕", "a\u2028b & \"c\" 'd'"]


class _Reader(HTMLParser):
    """The elements of a page, the texts of its scripts, and its attributes."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.scripts: list[str] = []
        self.cells: list[list[str]] = []
        self._inside: str | None = None
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))
        self._inside = tag
        if tag == "script":
            self.scripts.append("")
        if tag == "tr":
            self.cells.append([])
        if tag in ("td", "th") and self.cells:
            self.cells[-1].append("")

    def handle_endtag(self, tag: str) -> None:
        self._inside = None

    def handle_data(self, data: str) -> None:
        if self._inside == "script":
            self.scripts[-1] += data
        if self._inside in ("td", "th"):
            self.cells[-1][-1] += data


def _payload(html: str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(_Reader(html).scripts[0])
    return found


def _solved(task: Task) -> Schedule:
    return solve_task(task, SolveOptions("cpsat", time_limit=5)).schedule


def _task(*, names: list[str] = NAMES, **more: Any) -> tuple[Task, Schedule]:
    """A task of three actions one after the other, and its schedule with times in thirds."""
    actions = [{"id": name, "duration": "1/3", "uses": [{"resource": "r<b>"}]} for name in names]
    resources = [{"id": "r<b>"}]
    task = Task(name=names[0], time_unit="h", resources=resources, actions=actions, **more)
    third = Fraction(1, 3)
    entries = [Entry(n, k * third, (k + 1) * third, {"r<b>": 1}) for k, n in enumerate(names)]
    return task, Schedule(tuple(entries), time_unit="h")


@pytest.mark.slow
def test_the_report_has_exactly_the_times_and_resources_of_the_schedule() -> None:
    for seed in range(6):
        task = Task(**shop(seed))
        schedule = _solved(task)
        html = report_html(task, schedule)
        payload = _payload(html)
        (plan,) = payload["plans"]
        rows = [payload["rows"][r] for r in plan["rows"]]
        names = [resource["name"] for resource in payload["resources"]]
        shown = {
            (row["c"][0], int(row["c"][1] or 1)): (
                parse_number(row["c"][START]),
                parse_number(row["c"][END]),
                {names[r]: amount for r, amount in row["u"]},
            )
            for row in rows
        }
        wanted = {(e.id, e.occurrence): (e.start, e.end, dict(e.resources)) for e in schedule}
        assert shown == wanted
        cells = _Reader(html).cells
        for entry in schedule:
            texts = {entry.id, format_number(entry.start), format_number(entry.end)}
            assert any(texts <= set(row) for row in cells)


@pytest.mark.slow
def test_due_dates_and_lateness_are_those_of_the_task() -> None:
    for seed in range(6):
        document = shop(seed)
        task = Task(**document)
        schedule = _solved(task)
        (plan,) = payload_of(task, schedule)["plans"]
        by_order = {cells[0]: cells for cells in plan["tables"]["orders"]}
        for group in document["groups"]:
            end = max(entry.end for entry in schedule if entry.id in group["actions"])
            cells = by_order[group["id"]]
            assert cells[6] == format_number(end)
            if "due" in group:
                assert cells[7] == format_number(end - group["due"])
                assert cells[3] == ("late" if end > group["due"] else "on time")


def test_names_with_markup_stay_texts() -> None:
    task, schedule = _task()
    html = report_html(task, schedule)
    read = _Reader(html)
    assert sum(tag == "script" for tag, _ in read.elements) == 2
    assert not any(tag in ("b", "img", "iframe", "link", "object") for tag, _ in read.elements)
    assert [row["c"][0] for row in _payload(html)["rows"]] == NAMES
    assert any(NAMES[0] in row for row in read.cells)
    assert "\u2028" not in read.scripts[0]
    assert "<!--" not in html.split("<body>")[1]


def test_data_in_a_script_element_can_neither_end_it_nor_begin_a_comment() -> None:
    text = data({"a": "</script><!--\u2028\u2029&"})
    assert not set(text) & set("<>&\u2028\u2029")
    assert json.loads(text) == {"a": "</script><!--\u2028\u2029&"}


def test_the_page_refers_to_nothing_and_lets_only_its_own_script_run() -> None:
    task, schedule = _task()
    read = _Reader(report_html(task, schedule))
    refers = {"src", "href", "action", "data", "srcset", "poster", "style", "onclick", "onload"}
    found = {
        (k, v) for _, attributes in read.elements for k, v in attributes.items() if k in refers
    }
    assert found == {("href", "#tables")}
    policy = next(a["content"] for t, a in read.elements if t == "meta" and "http-equiv" in a)
    assert policy is not None
    assert "default-src 'none'" in policy
    assert "connect-src 'none'" in policy
    assert "unsafe" not in policy
    for script in read.scripts[1:]:
        assert not re.search(r"https?://|\bimport\b|innerHTML|document\.write|\beval\b", script)


def test_the_hashes_of_the_policy_are_those_of_what_stands_in_the_page() -> None:
    from base64 import b64encode
    from hashlib import sha256

    task, schedule = _task()
    html = report_html(task, schedule)
    for tag in ("style", "script"):
        (content,) = re.findall(rf"<{tag}>(.*?)</{tag}>", html, re.DOTALL)
        digest = b64encode(sha256(content.encode()).digest()).decode()
        assert f"{tag}-src 'sha256-{digest}'" in html


def test_clock_times_follow_the_zone_of_the_calendars_over_a_change_of_clocks() -> None:
    task = read_task(str(EXAMPLES / "paint_shop_week.irc")).task
    schedule = Schedule((Entry("mix colours", 0, 3), Entry("sand frame", 120, 126, {"booth": 1})))
    payload = payload_of(task, schedule)
    assert payload["origin"]["local"] == "2026-10-22T06:00:00.000"
    assert payload["origin"]["offsets"] == [["0", 0], ["69", -3600]]
    assert [row["c"][2] for row in payload["rows"]] == [
        "Thu 2026-10-22 06:00",
        "Tue 2026-10-27 05:00",
    ]


def test_without_an_origin_there_are_no_clock_times() -> None:
    task, schedule = _task()
    payload = payload_of(task, schedule)
    assert payload["origin"] is None
    used = {column[0] for column in payload["tables"]["actions"]["columns"] if column[3]}
    assert "start (h)" in used
    assert "starts" not in used
    assert [row["c"][START] for row in payload["rows"]] == ["0", "1/3", "2/3"]


def test_a_previous_plan_is_kept_apart_and_its_changes_are_listed() -> None:
    task, schedule = _task(names=["a", "b", "c"])
    moved = [replace(e, start=e.start + 1, end=e.end + 1) for e in schedule.entries[1:]]
    previous = replace(schedule, entries=(*moved, schedule.entries[0]))
    payload = payload_of(task, schedule, previous)
    assert [payload["rows"][r]["c"][START] for r in payload["previous"]] == ["0", "4/3", "5/3"]
    changes = payload["plans"][0]["tables"]["changes"]
    assert [row[:3] for row in changes] == [
        ["b", "", "earlier by 1 h"],
        ["c", "", "earlier by 1 h"],
    ]


@pytest.mark.slow
def test_steps_share_the_rows_that_stay() -> None:
    task = read_task(str(EXAMPLES / "pancake_morning.json")).task
    simulation = simulate(task, time_limit=5)
    payload = payload_of(task, simulation.final, steps=simulation.steps)
    plans = payload["plans"]
    assert [plan["at"] for plan in plans] == [format_number(s.at) for s in simulation.steps]
    for plan, step in zip(plans, simulation.steps, strict=True):
        rows = [payload["rows"][r]["c"] for r in plan["rows"]]
        assert [(c[0], c[START], c[END]) for c in rows] == [
            (e.id, format_number(e.start), format_number(e.end)) for e in step.schedule
        ]
    assert len(payload["rows"]) < sum(len(plan["rows"]) for plan in plans)
    assert plans[-1]["events"]


@pytest.mark.slow
def test_a_report_of_two_thousand_actions_is_small() -> None:
    names = [f"order {k // 10} step {k % 10}" for k in range(2000)]
    actions = [{"id": n, "duration": 5, "uses": [{"resource": f"machine {k % 50}"}]}
               for k, n in enumerate(names)]  # fmt: skip
    resources = [{"id": f"machine {k}"} for k in range(50)]
    task = Task(time_unit="min", resources=resources, actions=actions)
    entries = tuple(
        Entry(n, k // 50 * 5, k // 50 * 5 + 5, {f"machine {k % 50}": 1})
        for k, n in enumerate(names)
    )
    assert len(report_html(task, Schedule(entries)).encode()) < 4_000_000


def test_too_many_actions_for_a_page_are_refused_with_what_to_do_instead(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("irc.reporting.html.page.MOST_ROWS", 2)
    task, schedule = _task()
    with pytest.raises(ReportTooLarge, match=r"at most 2 actions, and these are 3.*write a table"):
        report_html(task, schedule)


def test_a_schedule_without_entries_has_a_report() -> None:
    task, _ = _task()
    html = report_html(task, Schedule((), Status.INFEASIBLE))
    (plan,) = _payload(html)["plans"]
    assert (plan["status"], plan["rows"]) == ("infeasible", [])
    assert plan["figures"] == [["schedule", "none", "no schedule exists"]]
