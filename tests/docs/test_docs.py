"""The documentation tells the truth: its code runs, its outputs are real, its tables complete."""

from __future__ import annotations

import ast
import builtins
import os
import re
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

import irc
from irc.cli.app import build_app
from irc.model import Event, Task
from irc.model.base import Node
from irc.model.features import Feature
from irc.model.lazy import Lazy, adapter
from irc.targets import get_backend
from paths import ROOT

README = "README.md"
OUR_PAGES = sorted(
    str(path.relative_to(ROOT))
    for path in (
        *ROOT.glob("*.md"),
        *ROOT.glob("docs/*.md"),
        *ROOT.glob("examples/*.md"),
        *ROOT.glob("benchmarks/*.md"),
    )
)
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
FILE_BLOCK = re.compile(r"<!-- file: (\S+) -->\n```\w+\n(.*?)^```$", re.MULTILINE | re.DOTALL)
SECONDS = re.compile(r"(?<=, )[\d.]+ s$", re.MULTILINE)
MODULE = "docs/adding-a-backend.md"

needs_kairos = pytest.mark.skipif(find_spec("kairos") is None, reason="kairos is for Linux only")
needs_a_shell = pytest.mark.skipif(os.name != "posix", reason="the commands are for a POSIX shell")


def read(page: str) -> str:
    return (ROOT / page).read_text("utf-8")


def blocks(page: str, language: str) -> list[str]:
    """The contents of a page's fenced blocks in one language."""
    return [body for found, body in BLOCK.findall(read(page)) if found == language]


def pages_with(language: str) -> list[str]:
    return [page for page in OUR_PAGES if blocks(page, language)]


# --- Python -------------------------------------------------------------------------------------


def wrong_prints(source: str, namespace: dict[str, Any]) -> list[str]:
    """Runs a block; what `print(…)  # text` lines of it printed other than the text."""
    lines = source.splitlines()
    found: dict[int, str] = {}

    def noted_print(*values: object) -> None:
        found[sys._getframe(1).f_lineno] = " ".join(map(str, values))

    namespace["print"] = noted_print
    exec(compile(ast.parse(source), "<documentation>", "exec"), namespace)
    promised = {
        number: line.split("  # ", 1)[1]
        for number, line in enumerate(lines, 1)
        if line.startswith("print(") and "  # " in line
    }
    return [
        f"{lines[number - 1]!r} printed {found.get(number)!r}"
        for number, text in promised.items()
        if found.get(number) != text
    ]


@pytest.mark.slow
@needs_kairos
@pytest.mark.parametrize("page", pages_with("python"))
def test_the_python_of_a_page_runs_and_prints_what_it_says(
    page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    os.symlink(ROOT / "examples", tmp_path / "examples")
    monkeypatch.chdir(tmp_path)
    namespace: dict[str, Any] = {"__name__": "documentation", "__builtins__": builtins}
    wrong = [fault for body in blocks(page, "python") for fault in wrong_prints(body, namespace)]
    assert not wrong


# --- commands -----------------------------------------------------------------------------------


def sessions(page: str) -> list[tuple[str, str]]:
    """(command, output) of a page's console blocks."""
    return [
        (command, output)
        for body in blocks(page, "console")
        for command, output in re.findall(r"^\$ (.*)\n((?:(?!\$ ).*\n)*)", body, re.MULTILINE)
    ]


def stable(command: str, output: str) -> str:
    """An output without what may differ from run to run.

    Seconds always do; and of several optimal schedules a solver may show any, so that of `solve`
    only the headline counts.
    """
    lines = SECONDS.sub("… s", output).rstrip().split("\n")
    if command.startswith("irc solve") and "" in lines:
        lines = lines[: lines.index("")]
    return "\n".join(lines)


def install_the_documented_backend(folder: Path) -> None:
    """Puts the page's backend on a path as `pip install` would."""
    (folder / "irc_serial.py").write_text(blocks(MODULE, "python")[0], encoding="utf-8")
    (about := folder / "irc_serial-0.1.dist-info").mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: irc-serial\nVersion: 0.1\n")
    points = re.search(r'"irc\.backends"\]\n(\w+) = "(.*)"', blocks(MODULE, "toml")[0])
    assert points is not None
    (about / "entry_points.txt").write_text(f"[irc.backends]\n{points[1]} = {points[2]}\n")


def run_in_shell(command: str, folder: Path, python_path: Path | None) -> str:
    quiet = {"COLUMNS", "FORCE_COLOR", "CLICOLOR_FORCE", "TTY_COMPATIBLE"}
    environment = {key: value for key, value in os.environ.items() if key not in quiet}
    environment["PATH"] = f"{Path(sys.executable).parent}{os.pathsep}{environment['PATH']}"
    environment["PYTHONUTF8"] = "1"
    if python_path is not None:
        environment["PYTHONPATH"] = str(python_path)
    done = subprocess.run(
        command,
        shell=True,
        cwd=folder,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        encoding="utf-8",
        timeout=120,
        check=False,
    )
    return done.stdout


@pytest.mark.slow
@needs_kairos
@needs_a_shell
@pytest.mark.parametrize("page", pages_with("console"))
def test_commands_print_what_the_page_shows(page: str, tmp_path: Path) -> None:
    if shutil.which("irc", path=str(Path(sys.executable).parent)) is None:
        pytest.skip("the irc script is not beside this Python")
    os.symlink(ROOT / "examples", tmp_path / "examples")
    for name, body in FILE_BLOCK.findall(read(page)):
        (tmp_path / name).write_text(body, encoding="utf-8")
    python_path = None
    if page == MODULE:
        (python_path := tmp_path / "installed").mkdir()
        install_the_documented_backend(python_path)
    for command, output in sessions(page):
        printed = run_in_shell(command, tmp_path, python_path)
        assert stable(command, printed) == stable(command, output), command


def test_the_readme_has_the_two_blocks_that_ci_runs_and_no_other() -> None:
    text = read(README)
    marked = re.findall(r"^<!-- ci:(\w+) -->\n```sh\n(.+)\n```$", text, re.MULTILINE)
    assert [name for name, _ in marked] == ["install", "test"]
    assert len(re.findall(r"^```(?:sh|bash|shell)$", text, re.MULTILINE)) == len(marked)


def test_the_readme_has_a_row_for_every_command() -> None:
    rows = set(re.findall(r"^\| `irc ([\w-]+)", read(README), re.MULTILINE))
    app = build_app()
    assert rows == {found.name for found in (*app.registered_commands, *app.registered_groups)}


# --- tasks and the IR ---------------------------------------------------------------------------


def whole_tasks() -> list[Any]:
    return [
        pytest.param(body, id=f"{page} {number}")
        for page in (README, "docs/ir.md")
        for number, body in enumerate(blocks(page, "json"), 1)
        if body not in dict(FILE_BLOCK.findall(read(page))).values()
    ]


@pytest.mark.parametrize("text", whole_tasks())
def test_nothing_is_to_be_said_of_a_documented_task(text: str) -> None:
    report = irc.check(irc.loads(text))
    assert list(report) == [], report.render()


def nodes_below(model: type[Node]) -> set[type[Node]]:
    """A model of the IR and all that its fields can hold."""
    found: set[type[Node]] = set()
    waiting: list[Any] = [model]
    while waiting:
        item = waiting.pop()
        if isinstance(item, type) and issubclass(item, Node):
            if item not in found:
                found.add(item)
                for field in item.model_fields.values():
                    waiting.append(field.annotation)
                    waiting += [
                        adapter(mark.module, mark.name)._type
                        for mark in field.metadata
                        if isinstance(mark, Lazy)
                    ]
        else:
            waiting += getattr(item, "__args__", ())
    return found


def test_the_reference_names_every_field_and_every_value_of_the_ir() -> None:
    page = read("docs/ir.md")
    models = nodes_below(Task) | nodes_below(Event)
    assert len(models) > 30
    fields = {f.alias or name for model in models for name, f in model.model_fields.items()}
    unnamed = {name for name in fields if not re.search(rf"`{name}`|\"{name}\"", page)}
    assert not unnamed
    schema = str(Task.model_json_schema(by_alias=True)) + str(Event.model_json_schema())
    values = set(re.findall(r"'(?:const|default)': '([\w-]+)'", schema))
    for listed in re.findall(r"'enum': \[(.*?)\]", schema):
        values |= set(re.findall(r"'([\w-]+)'", listed))
    assert {value for value in values if not re.search(rf"[`\"]{value}[`\"]", page)} == set()


# --- tables -------------------------------------------------------------------------------------


def test_the_readme_names_what_a_target_of_ours_refuses() -> None:
    named = re.search(r"<!-- refused -->\n(.*?)\.\n", read(README), re.DOTALL)
    assert named is not None
    refused = {feature.value for feature in set(Feature) - get_backend("pddl21").supports}
    assert set(re.split(r",\s+", named[1])) == refused
    assert get_backend("cpsat").supports == set(Feature)


def test_the_pddl_on_the_page_of_targets_is_what_is_written() -> None:
    shown = re.findall(
        r"<!-- from: (\S+) -->\n```lisp\n(.*?)```", read("docs/backends.md"), re.DOTALL
    )
    assert shown
    for path, text in shown:
        domain = irc.compile(ROOT / path, "pddl21").files["domain.pddl"]
        assert " ".join(text.split()) in " ".join(domain.split())


def test_links_between_pages_lead_somewhere() -> None:
    lost = [
        f"{page}: {target}"
        for page in OUR_PAGES
        for target in re.findall(r"\]\((?!https?://)([^)#]+)[^)]*\)", read(page))
        if not (ROOT / page).parent.joinpath(target).exists()
    ]
    assert not lost
