"""`irc eval reproduce` on the visible half of the recorded answers: every figure agrees."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import pytest

from paths import SHARED_DATA
from runs import run_irc

TOLERANCE, BY_MEANING = 0.0011, 1.0
MEANING_TABLES = ("faithfulness_meaning_pddl",)


def leaves(document: Any, path: tuple[str | int, ...] = ()) -> Iterator[tuple[Any, float]]:
    if isinstance(document, dict):
        for name, inner in document.items():
            yield from leaves(inner, (*path, name))
    elif isinstance(document, list):
        for k, inner in enumerate(document):
            yield from leaves(inner, (*path, k))
    else:
        yield path, document


@pytest.mark.shared_data
def test_all_figures_of_the_visible_half_agree() -> None:
    expected = json.loads((SHARED_DATA / "recorded/answers/expected.json").read_text("utf-8"))
    result = run_irc("eval", "reproduce", "--data", SHARED_DATA, "--format", "json")
    document = json.loads(result.stdout)
    found = dict(leaves(document["tables"]))
    wrong = {
        path: (found.get(path), value)
        for path, value in leaves(expected)
        if path not in found
        or abs(found[path] - value) > (BY_MEANING if path[0] in MEANING_TABLES else TOLERANCE)
    }
    assert wrong == {}
    assert found.keys() == {path for path, _ in leaves(expected)}
    assert len(document["errata"]) > 15
    assert all(0 < comparison["p"] <= 1 for comparison in document["comparisons"])
