"""What the tests share.

Options: `--require-shared-data` makes absent benchmark data a failure instead of a skip;
`--refresh-golden` rewrites the golden files from what the compiler says now.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings

# The same examples on every machine, and no failure because a machine is slow.
settings.register_profile("irc", deadline=None, derandomize=True, database=None)
settings.load_profile("irc")

SHARED_DATA = Path(__file__).resolve().parents[2] / "shared" / "data"


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("irc")
    group.addoption(
        "--require-shared-data",
        action="store_true",
        help="fail, not skip, where the benchmark data beside the project is absent",
    )
    group.addoption(
        "--refresh-golden",
        action="store_true",
        help="rewrite tests/golden/expected from what the compiler says now",
    )


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Skips what a mark says cannot run here."""
    if item.get_closest_marker("shared_data"):
        _require_shared_data(item.config)
    if item.get_closest_marker("optic"):
        _require_optic()


def _require_shared_data(config: pytest.Config) -> None:
    if SHARED_DATA.is_dir():
        return
    reason = f"no benchmark data at {SHARED_DATA}"
    if config.getoption("--require-shared-data"):
        pytest.fail(reason, pytrace=False)
    pytest.skip(reason)


def _require_optic() -> None:
    from irc_pddl21.engines import Optic

    reason = Optic().missing()
    if reason is not None:
        pytest.skip(reason)


@pytest.fixture(scope="session")
def shared_data(pytestconfig: pytest.Config) -> Path:
    """The benchmark data beside the project; tests that read it are skipped where it is absent."""
    _require_shared_data(pytestconfig)
    return SHARED_DATA


@pytest.fixture
def refresh_golden(pytestconfig: pytest.Config) -> bool:
    """Whether golden files are to be rewritten rather than compared."""
    return bool(pytestconfig.getoption("--refresh-golden"))


@pytest.fixture(scope="session")
def shuffled() -> Callable[[Any, random.Random], Any]:
    """Puts the keys and arrays of a document into another order that means the same."""
    return _shuffled


def _shuffled(document: Any, rng: random.Random, key: str = "") -> Any:
    free = key == "metadata"
    if isinstance(document, dict):
        members = [
            (inner, _shuffled(value, rng, key if free else inner))
            for inner, value in document.items()
        ]
        return dict(rng.sample(members, len(members)))
    if not isinstance(document, list):
        return document
    # The items of an array stand under no key, so a pair such as ["a", "b"] stays as it is.
    items = [_shuffled(item, rng, key if free else "") for item in document]
    ordered = free or key in ("", "objective", "events", "changes")
    return items if ordered else rng.sample(items, len(items))
