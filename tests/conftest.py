"""What the tests share.

Three tiers (CONTRIBUTING.md says when to run which): `-m fast` leaves out what is marked
`slow` or `alone`, and the tests of the oracles, which have a tier of their own (`-m oracles`);
without options everything runs but `tests/deep`; and `tests/deep`, which runs only where it is
named, goes on with random tasks for as long as `--seconds` says.

Options: `--require-shared-data` makes absent benchmark data a failure instead of a skip;
`--refresh-golden` rewrites the golden files from what the compiler says now.
"""

from __future__ import annotations

import os
import random
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings

from exclusive import machine
from paths import SHARED_DATA, TESTS

# Local search runs as plain Python here: to compile it takes longer than all that tests search.
os.environ.setdefault("IRC_COMPILED", "0")

DEEP, JUDGED = TESTS / "deep", TESTS / "oracles" / "tests"

# The same examples on every machine, and no failure because a machine is slow.
settings.register_profile("irc", deadline=None, derandomize=True, database=None, max_examples=40)
settings.load_profile("irc")


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
    group.addoption(
        "--seconds",
        type=float,
        default=60.0,
        help="how long each test of tests/deep goes on (default: 60)",
    )
    group.addoption(
        "--first-seed",
        type=int,
        default=None,
        help="the seed that each test of tests/deep begins with (default: another one every time)",
    )


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Leaves `tests/deep` out where it is not named itself."""
    if DEEP not in (collection_path, *collection_path.parents):
        return None
    named = [Path(a.split("::")[0]).resolve() for a in config.args]
    return None if any(DEEP in (path, *path.parents) for path in named) else True


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Gives the marks of the tiers: `deep` and `oracles` by folder, `fast` to what is not slow.

    Tests that must be alone come last, so that few processes have to wait for them.
    """
    for item in items:
        if DEEP in item.path.parents:
            item.add_marker("deep")
        elif JUDGED in item.path.parents:
            item.add_marker("oracles")
        elif not any(item.get_closest_marker(mark) for mark in ("slow", "alone")):
            item.add_marker("fast")
    items.sort(key=lambda item: item.get_closest_marker("alone") is not None)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    """Lets a test that is marked `alone` run while no other process runs one."""
    with machine(alone=item.get_closest_marker("alone") is not None):
        return (yield)


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
def seeds(request: pytest.FixtureRequest) -> Iterator[Iterator[int]]:
    """Seeds, one after the other, until `--seconds` are over; what was tried is printed."""
    config = request.config
    first = config.getoption("--first-seed")
    if first is None:
        first = random.SystemRandom().randrange(10**9)
    end = time.monotonic() + config.getoption("--seconds")
    tried = [first]

    def until_the_end() -> Iterator[int]:
        while True:
            yield tried[-1]
            if time.monotonic() > end:
                return
            tried.append(tried[-1] + 1)

    yield until_the_end()
    request.node.user_properties.append(("seeds", f"{first} to {tried[-1]}"))


def pytest_terminal_summary(terminalreporter: Any) -> None:
    """Prints the seeds that tests of `tests/deep` have tried; the last one is where one failed."""
    for report in (r for reports in terminalreporter.stats.values() for r in reports):
        if getattr(report, "when", None) == "teardown":
            for name, value in report.user_properties:
                terminalreporter.write_line(f"{report.nodeid}: {name} {value}")


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
