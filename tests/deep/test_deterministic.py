"""Deterministic calls give the same answer with numba and without it."""

from __future__ import annotations

import pytest

from driver.test_deterministic import answer


def test_numba_makes_no_difference() -> None:
    pytest.importorskip("numba")
    compiled, *with_numba = answer(workers=2, numba=True)
    plain, *without = answer(workers=2, numba=False)
    assert (compiled, plain) == (True, False)
    assert with_numba == without
