"""Deterministic calls give the same answer on a busy machine, compiled or not."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator

import pytest

from driver.test_deterministic import answer


@pytest.fixture
def busy() -> Iterator[None]:
    """Threads of another process that keep the machine busy."""
    code = "while True: pass"
    children = [subprocess.Popen([sys.executable, "-c", code]) for _ in range(2)]
    yield
    for child in children:
        child.kill()
        child.wait()


def test_a_busy_machine_makes_no_difference(request: pytest.FixtureRequest) -> None:
    first = answer(workers=2)
    request.getfixturevalue("busy")
    assert answer(workers=1, hashes=3) == first


def test_compilation_makes_no_difference() -> None:
    pytest.importorskip("llvmlite")
    first, *compiled = answer(workers=2, is_compiled=True)
    second, *plain = answer(workers=2, is_compiled=False)
    assert (first, second) == (True, False)
    assert compiled == plain
