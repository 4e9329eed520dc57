"""Nothing that an editor can send makes the server's features fail, and they say what irc says."""

from __future__ import annotations

import json
import random
import sys
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dsl_kitchen import KITCHEN
from paths import CORPUS, ROOT
from runs import run_irc

pytest.importorskip("lsprotocol")

import asyncio

from lsprotocol import types

from irc.frontends.convert import convert_file
from irc.lsp.analysis import MOST_CHARACTERS, analyse
from irc.lsp.documents import Documents
from irc.lsp.findings import shown
from irc.lsp.positions import Encoding, Lines
from irc.lsp.service import Service
from irc.lsp.worker import AnalysisWorker

EXAMPLES = sorted(p for p in (ROOT / "examples").iterdir() if p.suffix in (".json", ".txt"))
WRONG = sorted(
    p for p in CORPUS.rglob("*") if p.suffix in (".json", ".irc", ".txt") and p.is_file()
    and p.name != "table.txt"
)  # fmt: skip

PIECES = ["{", "}", "[", "]", '"', ":", ",", "\\", "#", "\n", "\n    ", "\t", " ", "0", "-> ",
          "after ", "for x in a, b:", "event at 3:", "é", "𝄞", "\ud800", "\r", "\ufeff", "=",
          "null", "include \"", "..", "metadata {"]  # fmt: skip


def readable(path: Path) -> str | None:
    try:
        return path.read_text("utf-8")
    except UnicodeDecodeError:
        return None


@pytest.fixture(scope="module")
def texts(tmp_path_factory: pytest.TempPathFactory) -> list[tuple[str, str]]:
    """(language, text) of real files: the examples in JSON and in the DSL, English, wrong ones."""
    folder = tmp_path_factory.mktemp("dsl")
    found = [("irc", KITCHEN)]
    for path in EXAMPLES:
        text = path.read_text("utf-8")
        found.append(("json" if path.suffix == ".json" else "plaintext", text))
        if path.suffix == ".json" and len(text) < 5000:
            output = folder / f"{path.stem}.irc"
            convert_file(str(path), "irc", output)
            found.append(("irc", output.read_text("utf-8")))
    wrong = [(p, readable(p)) for p in WRONG]
    found += [
        ("irc" if p.suffix == ".irc" else "json", text)
        for p, text in wrong
        if text is not None and len(text) < 5000
    ]
    assert {language for language, _ in found} == {"irc", "json", "plaintext"}
    return [(language, text) for language, text in found if len(text) < 20_000]


def ask_everything(text: str, language: str, offset: int, encoding: Encoding) -> None:
    """Every feature at a place; what they answer lies within the text."""
    documents = Documents()
    documents.encoding = encoding
    document = documents.open("untitled:a", 1, text, None, language)
    service = Service(AnalysisWorker(documents))
    service.markdown = True
    lines = document.lines
    at = types.Position(*lines.place(offset))
    everything = types.Range(types.Position(0, 0), types.Position(len(lines.starts), 0))

    async def ask() -> None:
        published = await service.diagnostics(document.uri)
        assert published is not None
        for finding in published.diagnostics:
            within(finding.range, lines)
        offered = await service.completion(document.uri, at)
        assert offered is not None
        for item in offered.items:
            assert isinstance(item.text_edit, types.TextEdit)
            within(item.text_edit.range, lines)
            assert item.text_edit.range.start.line <= at.line
        for symbol in await service.symbols(document.uri) or ():
            within(symbol.range, lines)
            within(symbol.selection_range, lines)
            whole, name = symbol.range, symbol.selection_range
            assert (whole.start.line, whole.start.character) <= (
                name.start.line,
                name.start.character,
            )
            assert symbol.name
        for location in await service.definition(document.uri, at) or ():
            within(location.range, lines)
        hover = await service.hover(document.uri, at)
        if hover is not None and hover.range is not None:
            within(hover.range, lines)
        for edit in await service.formatting(document.uri) or ():
            within(edit.range, lines)
        await service.code_actions(document.uri, everything, None)

    asyncio.run(ask())


def within(range_: types.Range, lines: Lines) -> None:
    """A range is in order, and of places that there are."""
    start = (range_.start.line, range_.start.character)
    end = (range_.end.line, range_.end.character)
    assert start <= end
    for line, character in (start, end):
        assert lines.place(lines.offset(line, character)) == (line, character)


def edited(text: str, draw: random.Random) -> tuple[str, int]:
    """A text after a few random edits, and where the last one was."""
    at = 0
    for _ in range(draw.randint(1, 4)):
        at = draw.randint(0, len(text))
        gone = draw.choice([0, 0, 1, 1, 5, 200])
        new = draw.choice([*PIECES, "", "".join(draw.choices(PIECES, k=5))])
        text = text[:at] + new + text[at + gone :]
        at += len(new)
    return text, at


@pytest.mark.slow
@settings(max_examples=75, deadline=None)
@given(st.integers(0, 2**32), st.sampled_from(list(Encoding)))
def test_no_edit_of_a_real_file_makes_a_feature_fail(
    texts: list[tuple[str, str]], seed: int, encoding: Encoding
) -> None:
    draw = random.Random(seed)
    language, text = draw.choice(texts)
    text, at = edited(text, draw)
    ask_everything(text, language, at, encoding)


@pytest.mark.slow
@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32))
def test_no_truncated_file_makes_a_feature_fail(texts: list[tuple[str, str]], seed: int) -> None:
    draw = random.Random(seed)
    language, text = draw.choice(texts)
    end = draw.randint(0, len(text))
    ask_everything(text[:end], language, end, Encoding.UTF_16)


@pytest.mark.slow
@settings(max_examples=40, deadline=None)
@given(st.text(max_size=60), st.sampled_from(["irc", "json", "plaintext", ""]), st.data())
def test_no_text_at_all_makes_a_feature_fail(text: str, language: str, data: st.DataObject) -> None:
    ask_everything(text, language, data.draw(st.integers(0, len(text))), Encoding.UTF_16)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "language"),
    [
        ("[" * 100_000, "json"),
        ('{"actions": ' + '{"a":' * 100_000, "json"),
        ('"' * 150_000, "irc"),
        ("boil 3 after " + "a, " * 15_000, "irc"),
        ("a" * 150_000, "irc"),
        ("for x in 1 .. 999999999: boil {x} 3", "irc"),
        ("\n".join("    " * i + f"for x{i} in a, b:" for i in range(200)), "irc"),
        ("\x00\x01" * 1000, "irc"),
    ],
)
def test_pathological_texts_are_bounded(text: str, language: str) -> None:
    ask_everything(text, language, len(text), Encoding.UTF_16)


def test_a_text_beyond_all_measure_is_not_checked_but_told() -> None:
    text = "a" * (MOST_CHARACTERS + 1)
    (found,) = shown(analyse(text, "a.irc", None), text)
    assert "not checked while it is typed" in found.message


@pytest.mark.slow
@pytest.mark.parametrize("path", WRONG, ids=lambda p: str(p.relative_to(CORPUS)))
def test_the_findings_are_those_of_the_command(path: Path) -> None:
    """Codes and places of every wrong input, as `irc check` tells them."""
    text = readable(path)
    if text is None:
        pytest.skip("not UTF-8, which an editor would have decoded by itself")
    said = run_irc("check", path, "--format", "json")
    document = json.loads(said.stdout)
    expected = [
        (d["code"], d["line"], d["column"])
        for d in document["diagnostics"]
        if "file" not in d and d["line"] is not None
    ]
    analysis = analyse(text, str(path), path)
    lines = Lines(text, Encoding.UTF_32)
    found = []
    for one in shown(analysis, text):
        assert one.of is not None
        if one.elsewhere is None and one.of.line is not None:
            # irc counts no byte-order mark, and no lone carriage return.
            before = text[: one.start]
            column = one.start - (before.rfind("\n") + 1) - analysis.lead * ("\n" not in before)
            found.append((one.of.code.id, before.count("\n") + 1, column + 1))
            assert lines.offset(*lines.place(one.start)) <= one.start
    assert found == expected[: len(found)]
    assert len(found) == len(expected)


def test_the_server_module_is_importable_where_the_extra_is() -> None:
    import irc.lsp.server

    assert "irc.lsp.server" in sys.modules
    assert irc.lsp.server.PAUSE_SECONDS <= 0.1
