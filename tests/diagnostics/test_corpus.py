"""The corpus of wrong inputs: each finding has exactly the code, line and column of the table.

Files and table are under `tests/corpus/`; the table says itself how it is read. `--refresh-golden`
writes what irc says now into it, and puts files that have no row yet below `[irc check {file}]`.
"""

from __future__ import annotations

import json
import re
import shutil
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

from irc.diagnostics import Code
from irc.diagnostics.catalogue import load_catalogue
from paths import CORPUS
from runs import Told, run_command, run_irc

TABLE = CORPUS / "table.txt"
SUPPORT = "support"
CHECK = "irc check {file}"

_SECTION = re.compile(r"\[(.+)\] (\d)")
_ENGINE = re.compile(r"\{engine (\w+)\} ")

needs_planner = pytest.mark.skipif(
    not sys.platform.startswith("linux"), reason="the planner is a shell script"
)


@dataclass(frozen=True)
class Row:
    """A wrong input, the command it is given to, and what must be told of it."""

    file: str
    command: str
    exit_code: int
    findings: tuple[str, ...]

    def run(self, folder: Path) -> Told:
        """What the command says of the file."""
        for support in (CORPUS / SUPPORT).iterdir():
            shutil.copy(support, folder / support.name)
        given = folder / Path(self.file).name
        shutil.copy(CORPUS / self.file, given)
        engine = _ENGINE.match(self.command)
        command = self.command[engine.end() :] if engine else self.command
        *earlier, last = command.replace("{file}", given.name).split(" ; ")
        for step in earlier:
            assert run_command(step, folder).exit_code == 0, step
        return run_command(last, folder, engine=(engine[1], given) if engine else None)


def read_table() -> list[Row]:
    rows = []
    command, exit_code = "", 0
    for line in TABLE.read_text("utf-8").splitlines():
        if section := _SECTION.fullmatch(line):
            command, exit_code = section[1], int(section[2])
        elif line and not line.startswith("#"):
            file, *findings = line.split()
            rows.append(Row(file, command, exit_code, tuple(findings)))
    return rows


ROWS = read_table()


def shown(told: Told) -> tuple[str, ...]:
    return tuple(code if place is None else f"{code}@{place}" for code, place in told.findings)


@needs_planner
@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row.file} {row.command.split()[1]}")
def test_each_wrong_input_is_told_what_the_table_says(row: Row, tmp_path: Path) -> None:
    told = row.run(tmp_path)
    assert (shown(told), told.exit_code) == (row.findings, row.exit_code), told.text


CHECKED = [row for row in ROWS if row.command == CHECK]


@pytest.mark.parametrize("row", CHECKED, ids=lambda row: row.file)
def test_programs_are_told_the_same_with_a_pointer_that_leads_somewhere(row: Row) -> None:
    result = run_irc("check", CORPUS / row.file, "--format", "json")
    assert (result.exit_code, result.stderr) == (row.exit_code, "")
    diagnostics = json.loads(result.stdout)["diagnostics"]
    told = tuple(
        d["code"] if d["line"] is None else f"{d['code']}@{d['line']}:{d['column']}"
        for d in diagnostics
    )
    assert told == row.findings
    for d in diagnostics:
        assert re.fullmatch(r"(/[^/]*)*", d["pointer"])
        assert d["message"]
        assert d["hint"] or re.search("expected|write", d["message"]), "nobody is told what to do"


# --- the corpus is complete ---------------------------------------------------------------------


def test_every_code_of_the_project_is_in_the_corpus() -> None:
    told = {finding.partition("@")[0] for row in ROWS for finding in row.findings}
    assert {code.id for code in Code} - told == set()
    assert told <= set(load_catalogue())


def test_every_file_of_the_corpus_has_a_row_and_every_row_a_file() -> None:
    files = {
        path.relative_to(CORPUS).as_posix()
        for path in CORPUS.rglob("*.*")
        if path.is_file() and path != TABLE and path.parent.name != SUPPORT
    }
    assert {row.file for row in ROWS} == files
    assert len(files) >= 140


@pytest.mark.parametrize(
    ("file", "mistakes"),
    [
        ("several/five_mistakes.json", 5),
        ("several/five_names.json", 5),
        ("several/twelve_mistakes.json", 12),
        ("dsl/five_mistakes.irc", 5),
        ("english/six_mistakes.md", 6),
    ],
)
def test_as_many_mistakes_are_told_as_were_made(file: str, mistakes: int) -> None:
    (row,) = (row for row in ROWS if row.file == file)
    assert len(row.findings) == mistakes


@needs_planner
def test_the_table_can_be_refreshed(refresh_golden: bool, tmp_path: Path) -> None:
    if not refresh_golden:
        pytest.skip("only with --refresh-golden")
    text = TABLE.read_text("utf-8")
    for number, row in enumerate(ROWS):
        (folder := tmp_path / str(number)).mkdir()
        findings = " ".join(shown(row.run(folder)))
        pattern = rf"^{re.escape(row.file)}( .*)?$"
        text = re.sub(pattern, f"{row.file} {findings}".rstrip(), text, flags=re.MULTILINE)
    TABLE.write_text(text, encoding="utf-8", newline="\n")
