"""`irc prepare` calls each search on a task that it fits."""

from __future__ import annotations

import pytest

from builders import problem_for_cpsat
from irc.cli.prepare import _tasks
from irc.local_search import compiled
from irc.local_search.list_search import ListSearch
from irc.local_search.project import ProjectSearch
from irc.local_search.search import search_of
from irc.local_search.shop import ShopSearch
from runs import run_irc


def test_there_is_a_task_for_each_search() -> None:
    found = [type(search_of(problem_for_cpsat(task))) for _, task in _tasks()]
    assert found == [ShopSearch, ProjectSearch, ProjectSearch, ListSearch]


def test_without_llvmlite_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compiled, "IS_COMPILED", False)
    result = run_irc("prepare")
    assert result.exit_code == 4
    assert "pip install 'irc-compiler[fast]'" in result.stderr
