"""`irc prepare` compiles every module that has compiled functions."""

from __future__ import annotations

import pytest

from irc.cli import prepare
from irc.local_search import compiled
from paths import ROOT
from runs import run_irc


def test_it_compiles_every_module_with_compiled_functions() -> None:
    folder = ROOT / "irc" / "local_search"
    found = {f.stem for f in folder.glob("*.py") if "\n@compiled\n" in f.read_text()}
    assert {f"irc.local_search.{name}" for name in found} == {*prepare.LOOPS.values()}


def test_it_says_how_long_each_took(monkeypatch: pytest.MonkeyPatch) -> None:
    done: list[str] = []
    monkeypatch.setattr(compiled, "IS_COMPILED", True)
    monkeypatch.setattr(prepare, "compile_now", done.append)
    result = run_irc("prepare")
    assert not result.exit_code
    assert done == [*prepare.LOOPS.values()]
    assert "large shops: 0.0 s" in result.stderr + result.stdout


def test_without_llvmlite_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compiled, "IS_COMPILED", False)
    result = run_irc("prepare")
    assert result.exit_code == 4
    assert "pip install 'irc-compiler[fast]'" in result.stderr
