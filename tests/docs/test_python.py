"""The code in README, documentation and docstrings runs as it stands."""

from __future__ import annotations

import doctest
import re
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

from paths import ROOT

BLOCK = re.compile(r"^```python[^\n]*\n(.*?)^```", re.MULTILINE | re.DOTALL)


def python_blocks(page: Path) -> list[tuple[int, str]]:
    """(line of its first line, code) of each Python block of a page."""
    text = page.read_text("utf-8")
    return [(text.count("\n", 0, m.start(1)) + 1, m[1]) for m in BLOCK.finditer(text)]


def pages_with_python() -> Iterator[Any]:
    for page in sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")]):
        code = "".join(code for _, code in python_blocks(page))
        if code:
            yield pytest.param(str(page.relative_to(ROOT)))


@pytest.mark.slow
@pytest.mark.parametrize("page", list(pages_with_python()))
def test_python_blocks_of_a_page_run_in_order(page: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    namespace: dict[str, object] = {"__name__": "page"}
    for line, code in python_blocks(ROOT / page):
        # Leading line ends make a traceback name the line of the page.
        exec(compile("\n" * (line - 1) + code, page, "exec"), namespace)


@pytest.mark.parametrize(
    "module", ["irc", "irc.model.canonical", "irc.model.task", "irc.validation"]
)
def test_examples_in_docstrings_say_what_happens(module: str) -> None:
    result = doctest.testmod(import_module(module))
    assert result.failed == 0
    assert result.attempted > 0
