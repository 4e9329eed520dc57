"""docs/semantics.md: its examples are judged as it says, and every violation has its rule there."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import irc
from irc.schedule.reading import schedule_from_json
from irc.validation import RULES
from paths import ROOT

PAGE = (ROOT / "docs" / "semantics.md").read_text("utf-8")
BLOCK = re.compile(
    r"^\*\*(Task|Valid|Breaks rule ([\d.]+))\*\*\n\n```json\n(.*?)^```$", re.MULTILINE | re.DOTALL
)
BY_NAME = dict(re.findall(r"^\| `(\w+)` \| \[([\d.]+)\]\(#rule-[\d.]+\) \|$", PAGE, re.MULTILINE))


def examples() -> Iterator[Any]:
    """(task, schedule, the rule that it breaks or None), in the order of the page."""
    task = ""
    for number, (kind, rule, body) in enumerate(BLOCK.findall(PAGE)):
        if kind == "Task":
            task = body
        else:
            yield pytest.param(task, body, rule or None, id=f"{number}: {rule or 'valid'}")


@pytest.mark.parametrize(("task", "schedule", "rule"), list(examples()))
def test_an_example_breaks_the_rule_that_it_names_and_no_other(
    task: str, schedule: str, rule: str | None
) -> None:
    verdict = irc.validate(irc.loads(task), schedule_from_json(json.loads(schedule)))
    assert {BY_NAME[v.rule] for v in verdict.violations} == ({rule} if rule else set()), verdict


def test_every_example_task_is_one_that_the_checks_accept() -> None:
    tasks = [body for kind, _, body in BLOCK.findall(PAGE) if kind == "Task"]
    assert len(tasks) >= 7
    for task in tasks:
        assert irc.check(irc.loads(task)).render() == ""


def test_every_rule_has_an_example_that_breaks_it_and_one_that_keeps_it() -> None:
    rules = {rule for _, rule, _ in BLOCK.findall(PAGE) if rule}
    assert rules == {*BY_NAME.values()}
    assert PAGE.count("**Valid**") >= 7


def test_the_rules_of_violations_are_those_of_the_page() -> None:
    numbers = {name: int(rule.split(".")[0]) for name, rule in BY_NAME.items()}
    assert numbers == {name: number for name, number in RULES.items() if number is not None}


def test_every_rule_that_is_linked_to_is_there_once() -> None:
    anchors = re.findall(r'<a id="([\w.-]+)"></a>', PAGE)
    assert len({*anchors}) == len(anchors)
    rules = {anchor.removeprefix("rule-") for anchor in anchors if anchor.startswith("rule-")}
    assert rules == {*BY_NAME.values()}


def test_links_within_the_page_lead_to_a_heading_or_an_anchor() -> None:
    there = set(re.findall(r'<a id="([\w.-]+)"></a>', PAGE))
    for heading in re.findall(r"^#+ (.*)$", PAGE, re.MULTILINE):
        there.add(re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-"))
    assert {*re.findall(r"\]\(#([^)]+)\)", PAGE)} <= there


CITED = re.compile(
    r"\brules? (\d(?:\.\d+)?)((?:, \d(?:\.\d+)?)*)(?: and (\d(?:\.\d+)?))?", re.IGNORECASE
)


def test_every_rule_that_the_code_cites_is_on_the_page() -> None:
    there = {*BY_NAME.values(), *re.findall(r"^### Rule (\d):", PAGE, re.MULTILINE)}
    root = Path(__file__).resolve().parents[2]
    lost = []
    for path in (p for folder in ("irc", "backends") for p in (root / folder).rglob("*.py")):
        for first, more, last in CITED.findall(path.read_text("utf-8")):
            cited = {first, last, *more.split(", ")} - {""}
            lost += [f"{path.relative_to(root)}: rule {rule}" for rule in sorted(cited - there)]
    assert not lost


def test_headings_that_the_code_cites_are_on_the_page() -> None:
    headings = set(re.findall(r"^#+ (.*)$", PAGE, re.MULTILINE))
    root = Path(__file__).resolve().parents[2]
    cited = {
        heading
        for folder in ("irc", "backends", "tests/oracles")
        for path in (root / folder).rglob("*.py")
        for heading in re.findall(r'docs/semantics\.md, "([^"]+)"', path.read_text("utf-8"))
    }
    assert cited
    assert cited <= headings
