"""The catalogue of diagnostics: complete, true to what irc says, and the source of its page.

`--refresh-golden` writes what irc says now into the entries (`output`) and the page anew.
"""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path

import pytest
from typer.testing import Result

from irc.diagnostics import Code, Severity
from irc.diagnostics.catalogue import CatalogueEntry, load_catalogue, load_families
from irc.diagnostics.catalogue.page import diagnostics_page
from paths import ROOT
from runs import Told, run_command, run_irc

CATALOGUE = ROOT / "irc" / "diagnostics" / "catalogue"
ENTRIES = list(load_catalogue().values())

NOT_IN_A_TEXT = (
    Code.NO_SCHEDULE,
    Code.DAMAGED,
    Code.NO_ANSWER,
    Code.OTHER_JOURNAL,
    Code.CHANGED_TASK,
    Code.CARRIED,
    Code.NO_CONTINUATION,
    *(Code.DAMAGED, Code.NO_ANSWER, Code.CARRIED, Code.NO_CONTINUATION),
    Code.NOT_AS_PLANNED,
)

runs_planners = pytest.mark.skipif(
    not sys.platform.startswith("linux"), reason="the planner is a shell script"
)


def told_of(entry: CatalogueEntry, example: str, encoding: str, folder: Path) -> Told:
    """What the entry's command says of one of its examples."""
    for name, text in entry.files.items():
        (folder / name).write_text(text, encoding="utf-8")
    (folder / entry.file).write_bytes(example.encode(encoding))
    for command in entry.before:
        assert run_command(command, folder).exit_code == 0
    printed = folder / entry.file
    engine = None if entry.printed_by is None else (entry.printed_by, printed)
    return run_command(entry.command, folder, engine=engine)


def refresh(entry: CatalogueEntry, told: str) -> None:
    """Writes what is told into the entry."""
    for file in CATALOGUE.glob("*.toml"):
        head, found, rest = file.read_text("utf-8").partition(f"[codes.{entry.code.id}]\n")
        if found:
            # What is told, which may hold anything but three quotes, goes in as it is.
            before, _, after = rest.partition("output = '''")
            after = after.partition("'''")[2]
            text = f"{head}{found}{before}output = '''\n{told}\n'''{after}"
            file.write_text(text, encoding="utf-8")


def test_every_code_has_an_entry_and_every_entry_a_code() -> None:
    assert list(load_catalogue()) == [code.id for code in Code]


@runs_planners
@pytest.mark.parametrize("entry", ENTRIES, ids=lambda e: e.code.id)
def test_the_bad_example_is_told_this_code_and_no_other_in_these_words(
    entry: CatalogueEntry, tmp_path: Path, refresh_golden: bool
) -> None:
    told = told_of(entry, entry.bad, entry.encoding, tmp_path)
    assert {code for code, _ in told.findings} == {entry.code.id}, told.text
    assert (told.exit_code != 0) is (entry.code.severity is Severity.ERROR) or entry.printed_by
    if refresh_golden:
        refresh(entry, told.text)
    else:
        assert told.text == entry.output


@runs_planners
@pytest.mark.parametrize("entry", ENTRIES, ids=lambda e: e.code.id)
def test_of_the_good_example_nothing_is_to_be_said(entry: CatalogueEntry, tmp_path: Path) -> None:
    told = told_of(entry, entry.good, "utf-8", tmp_path)
    assert (told.exit_code, told.text) == (0, "")


@pytest.mark.parametrize("entry", ENTRIES, ids=lambda e: e.code.id)
def test_an_entry_says_where_unless_no_text_is_at_fault(entry: CatalogueEntry) -> None:
    places = re.findall(rf"^  --> {re.escape(entry.file)}:\d+:\d+$", entry.output, re.MULTILINE)
    assert places or entry.code in NOT_IN_A_TEXT


def test_an_entry_is_written_in_sentences() -> None:
    for entry in ENTRIES:
        assert entry.explanation.endswith("."), entry.code
        assert not entry.remedy.endswith("."), entry.code
        assert entry.remedy[0] in "`" or entry.remedy[0].islower(), entry.code
    assert all(family.title and family.about.endswith(".") for family in load_families())


# --- the page -----------------------------------------------------------------------------------


def test_the_page_of_diagnostics_is_what_the_catalogue_writes(refresh_golden: bool) -> None:
    page = ROOT / "docs" / "diagnostics.md"
    if refresh_golden:
        load_families.cache_clear()
        load_catalogue.cache_clear()
        page.write_text(diagnostics_page(), encoding="utf-8", newline="\n")
    assert page.read_text("utf-8") == diagnostics_page()


def test_the_page_lists_every_code_with_severity_and_summary() -> None:
    rows = re.findall(r"^\| \[(IRC\d+)\]\(#irc\d+\) \| (\w+) \| (.+?) \|", diagnostics_page(), re.M)
    assert rows == [(code.id, str(code.severity), code.summary) for code in Code]


# --- the command --------------------------------------------------------------------------------


def explain_code(*arguments: str) -> Result:
    return run_irc("explain-code", *arguments)


@pytest.mark.parametrize("given", ["IRC201", "irc201", "201"])
def test_a_code_is_explained_with_both_examples_and_what_is_told(given: str) -> None:
    shown = explain_code(given).stdout
    entry = load_catalogue()["IRC201"]
    flat = "\n".join(line.removeprefix("    ") for line in shown.splitlines())
    for part in (entry.bad.strip(), entry.output, entry.good.strip()):
        assert part in flat
    for part in (entry.explanation, entry.remedy):
        assert part in " ".join(shown.split())


def test_a_code_is_explained_to_programs() -> None:
    document = json.loads(explain_code("IRC603", "--format", "json").stdout)
    assert document["code"] == "IRC603"
    assert document["severity"] == "warning"
    assert document["printed_by"] == "optic"
    assert document["bad"] == load_catalogue()["IRC603"].bad


def test_an_unknown_code_is_wrong_use_and_a_close_one_is_named() -> None:
    result = explain_code("IRC20l")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "there is no diagnostic 'IRC20l'; did you mean `IRC20" in result.stderr


def test_without_a_code_all_are_listed() -> None:
    lines = explain_code().stdout
    assert re.findall(r"^  (IRC\d+) ", lines, re.M) == [code.id for code in Code]
    codes = json.loads(explain_code("--format", "json").stdout)["codes"]
    assert [c["code"] for c in codes] == [code.id for code in Code]
