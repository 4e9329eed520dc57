"""`irc check --format sarif`: what SARIF 2.1.0 requires, and that it says what the report says.

`faults_of` holds a log against the rules of the standard that concern what irc writes (OASIS SARIF
2.1.0: required properties, types, enumerations, and what must agree with what).
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from irc.diagnostics.catalogue import load_catalogue
from irc.frontends.texts import read_text
from paths import CORPUS
from runs import run_irc

FILES = sorted(
    path
    for folder in ("text", "places", "shape", "names", "time", "style", "several")
    for path in (CORPUS / folder).iterdir()
)

LOG = {"$schema": str, "version": str, "runs": list}
RUN = {"tool": dict, "columnKind": str, "artifacts": list, "results": list}
DRIVER = {
    "name": str,
    "version": str,
    "semanticVersion": str,
    "informationUri": str,
    "rules": list,
}
RULE = {
    "id": str,
    "name": str,
    "shortDescription": dict,
    "fullDescription": dict,
    "help": dict,
    "defaultConfiguration": dict,
}
RESULT = {"ruleId": str, "ruleIndex": int, "level": str, "message": dict, "locations": list}
REGION = {"startLine": int, "startColumn": int, "endLine": int, "endColumn": int}
LEVELS = {"none", "note", "warning", "error"}


def sarif(*files: Path) -> dict[str, Any]:
    result = run_irc("check", "--format", "sarif", *files)
    assert result.stderr == ""
    log: dict[str, Any] = json.loads(result.stdout)
    return log


def wrong_shape(value: Any, shape: dict[str, type], where: str, *optional: str) -> Iterator[str]:
    """Missing, unknown and wrongly typed properties of an object."""
    if not isinstance(value, dict):
        yield f"{where} is no object"
        return
    yield from (f"{where} lacks {key}" for key in shape.keys() - value.keys())
    yield from (f"{where} has {key}" for key in value.keys() - shape.keys() - set(optional))
    yield from (
        f"{where}.{key} is no {kind.__name__}"
        for key, kind in shape.items()
        if key in value and not isinstance(value[key], kind)
    )


def faults_of(log: dict[str, Any]) -> Iterator[str]:
    yield from wrong_shape(log, LOG, "log")
    if log["version"] != "2.1.0":
        yield "3.13.2: the version"
    for run in log["runs"]:
        yield from wrong_shape(run, RUN, "run")
        if run["columnKind"] not in ("utf16CodeUnits", "unicodeCodePoints"):
            yield "3.14.17: columnKind"
        yield from wrong_shape(run["tool"], {"driver": dict}, "tool")
        driver = run["tool"]["driver"]
        yield from wrong_shape(driver, DRIVER, "driver")
        uris = [artifact["location"]["uri"] for artifact in run["artifacts"]]
        if len(set(uris)) < len(uris):
            yield "3.14.15: artifacts are unique"
        yield from faults_of_rules(driver["rules"])
        for result in run["results"]:
            yield from faults_of_result(result, driver["rules"], uris)


def faults_of_rules(rules: list[Any]) -> Iterator[str]:
    for rule in rules:
        yield from wrong_shape(rule, RULE, "rule")
        for text in ("shortDescription", "fullDescription", "help"):
            yield from wrong_shape(rule[text], {"text": str}, text)
        if not rule["shortDescription"]["text"].endswith("."):
            yield "3.49.9: a short description is a sentence"
        if rule["defaultConfiguration"]["level"] not in LEVELS:
            yield "3.50.3: level"
    if len({rule["id"] for rule in rules}) < len(rules):
        yield "3.19.23: rules are unique"


def faults_of_result(result: Any, rules: list[Any], uris: list[str]) -> Iterator[str]:
    yield from wrong_shape(result, RESULT, "result", "fixes")
    if rules[result["ruleIndex"]]["id"] != result["ruleId"]:
        yield "3.27.6: ruleIndex and ruleId agree"
    if result["level"] not in LEVELS or not result["message"]["text"]:
        yield "3.27.10: level and message"
    for location in result["locations"]:
        physical = location["physicalLocation"]
        yield from wrong_shape(physical, {"artifactLocation": dict}, "place", "region")
        if physical["artifactLocation"]["uri"] not in uris:
            yield "3.4.3: the artifact is in the run"
        if "region" in physical:
            yield from faults_of_region(physical["region"])
        for logical in location.get("logicalLocations", ()):
            yield from wrong_shape(logical, {"fullyQualifiedName": str, "kind": str}, "logical")
            if not re.fullmatch(r"(/[^/]*)+", logical["fullyQualifiedName"]):
                yield "a logical location is a JSON pointer"
    for fix in result.get("fixes", ()):
        yield from wrong_shape(fix, {"description": dict, "artifactChanges": list}, "fix")
        for change in fix["artifactChanges"]:
            if not change["replacements"]:
                yield "3.56.3: a change replaces something"
            for replacement in change["replacements"]:
                yield from faults_of_region(replacement["deletedRegion"])


def faults_of_region(region: Any) -> Iterator[str]:
    yield from wrong_shape(region, REGION, "region")
    start = (region["startLine"], region["startColumn"])
    end = (region["endLine"], region["endColumn"])
    if min(start) < 1 or end < start:
        yield f"3.30: {start} to {end} is no region"


@pytest.mark.slow
@pytest.mark.parametrize("file", FILES, ids=lambda path: path.name)
def test_a_log_keeps_the_rules_of_the_standard_and_tells_what_the_report_tells(file: Path) -> None:
    log = sarif(file)
    assert list(faults_of(log)) == []
    report = run_irc("check", "--format", "json", file)
    diagnostics = json.loads(report.stdout)["diagnostics"]
    (run,) = log["runs"]
    told = []
    for result in run["results"]:
        (location,) = result["locations"]
        region = location["physicalLocation"].get("region", {})
        names = location.get("logicalLocations", [{"fullyQualifiedName": ""}])
        place = (region.get("startLine"), region.get("startColumn"))
        told.append((result["ruleId"], result["level"], names[0]["fullyQualifiedName"], *place))
    assert told == [
        (d["code"], d["severity"], d["pointer"], d["line"], d["column"]) for d in diagnostics
    ]
    for result, diagnostic in zip(run["results"], diagnostics, strict=True):
        # A text that is not JSON is repaired by edits of the text alone, and has no JSON Patch.
        if diagnostic["code"] != "IRC002":
            assert ("fixes" in result) == (diagnostic["fix"] is not None)


def text_in(region: dict[str, int], text: str) -> str:
    """What a region stands for, counted as the standard says."""
    lines = text.split("\n")
    starts = [0]
    for line in lines:
        starts.append(starts[-1] + len(line) + 1)
    start = starts[region["startLine"] - 1] + region["startColumn"] - 1
    end = starts[region["endLine"] - 1] + region["endColumn"] - 1
    return text[start:end]


def test_regions_cover_the_value_in_characters(tmp_path: Path) -> None:
    file = tmp_path / "task.json"
    text = '{"actions": [{"id": "🥔", "duration": -25},\r\n\t{"id": "é", "duratio": 3}]}'
    file.write_bytes(text.encode())
    regions = [
        r["locations"][0]["physicalLocation"]["region"] for r in sarif(file)["runs"][0]["results"]
    ]
    assert [text_in(region, text) for region in regions] == ["-25", '"']


def test_replacements_applied_to_the_text_are_the_repair() -> None:
    file = CORPUS / "names" / "repetitions.json"
    text, _ = read_text(file)
    results = sarif(file)["runs"][0]["results"]
    replacements = [
        replacement
        for result in results
        for fix in result["fixes"]
        for change in fix["artifactChanges"]
        for replacement in change["replacements"]
    ]
    for replacement in reversed(replacements):
        region = replacement["deletedRegion"]
        lines = text.split("\n")
        offset = sum(len(line) + 1 for line in lines[: region["startLine"] - 1])
        start = offset + region["startColumn"] - 1
        end = start + len(text_in(region, text))
        text = text[:start] + replacement["insertedContent"]["text"] + text[end:]
    assert json.loads(text) == {
        "actions": [{"id": "peel", "duration": 10}, {"id": "boil", "duration": 25}],
        "precedence": [["peel", "boil"]],
        "objective": ["minimize_makespan"],
    }


def test_rules_are_those_of_the_catalogue_and_each_once_over_all_files() -> None:
    files = [CORPUS / "names" / "repetitions.json", CORPUS / "names" / "wrong_kinds.json"]
    (run,) = sarif(*files)["runs"]
    rules = run["tool"]["driver"]["rules"]
    assert [rule["id"] for rule in rules] == ["IRC203", "IRC207"]
    assert rules[0]["fullDescription"]["text"] == load_catalogue()["IRC203"].explanation
    assert [a["location"]["uri"] for a in run["artifacts"]] == [f.as_uri() for f in files]


def test_a_file_without_text_has_a_result_without_region(tmp_path: Path) -> None:
    (result,) = sarif(tmp_path / "absent.json")["runs"][0]["results"]
    assert result["ruleId"] == "IRC001"
    assert "region" not in result["locations"][0]["physicalLocation"]


def test_paths_become_uris(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "my tasks").mkdir()
    file = Path("my tasks") / "süß #1.json"
    file.write_text("{}")
    (artifact,) = sarif(file)["runs"][0]["artifacts"]
    assert artifact["location"]["uri"] == "my%20tasks/s%C3%BC%C3%9F%20%231.json"


def test_a_sound_file_gives_a_log_without_results(tmp_path: Path) -> None:
    file = tmp_path / "task.json"
    file.write_text('{"actions": [{"id": "a", "duration": 3}]}')
    log = sarif(file)
    assert list(faults_of(log)) == []
    assert log["runs"][0]["results"] == []


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ("version", "2.0.0"),
        ("runs/0/columnKind", "bytes"),
        ("runs/0/results/0/ruleId", "IRC999"),
        ("runs/0/results/0/level", "fatal"),
        ("runs/0/results/0/colour", "red"),
        ("runs/0/results/0/locations/0/physicalLocation/region/startColumn", 0),
        ("runs/0/results/0/locations/0/physicalLocation/artifactLocation/uri", "other"),
        ("runs/0/tool/driver/informationUri", None),
    ],
)
def test_what_breaks_the_standard_would_be_found(path: str, value: object) -> None:
    log: Any = sarif(CORPUS / "names" / "repetitions.json")
    inner, (*parents, last) = log, path.split("/")
    for part in parents:
        inner = inner[int(part) if part.isdigit() else part]
    inner[last] = value
    assert list(faults_of(log))
