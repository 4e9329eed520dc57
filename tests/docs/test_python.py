"""The examples in docstrings run and print what they say (those of pages: `test_docs.py`)."""

from __future__ import annotations

import doctest
from importlib import import_module

import pytest


@pytest.mark.parametrize(
    "module", ["irc", "irc.model.canonical", "irc.model.task", "irc.validation"]
)
def test_examples_in_docstrings_say_what_happens(module: str) -> None:
    result = doctest.testmod(import_module(module))
    assert result.failed == 0
    assert result.attempted > 0
