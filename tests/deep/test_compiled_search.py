"""Compiled, local search takes the same steps as in plain Python, and no index is out of range."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from typing import Any

import pytest

from paths import ROOT

GUARD = """
import numpy

class Guarded(numpy.ndarray):
    def _check(self, at):
        for one in at if isinstance(at, tuple) else (at,):
            assert not isinstance(one, (int, numpy.integer)) or one >= 0, f"index {one}"

    def __getitem__(self, at):
        self._check(at)
        return super().__getitem__(at)

    def __setitem__(self, at, value):
        self._check(at)
        super().__setitem__(at, value)

def guarded(make):
    return lambda *given: make(*given).view(Guarded)

for name in ("zeros", "full", "fromiter"):
    setattr(numpy, name, guarded(getattr(numpy, name)))
"""
"""Compiled code knows no indexes from the end; numpy refuses those that are too large."""

SCRIPT = """
import json, sys
from builders import after_passes
from irc.local_search import compiled, list_search as lists, project as projects, shop as shops
from irc.local_search.search import search_of
from list_search_tasks import list_task
from local_search_tasks import job_shop, project, with_stock

assert compiled.IS_COMPILED == (sys.argv[1] == "1")
shops._ACTIVITY_STEPS, projects._ACTIVITY_BIRTHS = 3_000, 2_000
lists._ACTIVITY_STEPS = 3_000
seed = int(sys.argv[2])
found = []
shop, flexible = job_shop(seed), job_shop(seed, flexible=True)
for document in (shop, flexible, project(seed), with_stock(seed), list_task(seed)):
    search = search_of(after_passes(document), seed, target=0)
    for _ in range(3):
        search.step()
    decisions, pools = search.found()
    found.append([search.value, [[d.start, d.mode] for d in decisions], pools])
print(json.dumps(found))
"""


def found(seed: int, compiled: str, before: str = "") -> Any:
    """The schedules of searches, compiled ("1") or not ("0")."""
    path = os.pathsep.join([str(ROOT / "tests"), os.environ.get("PYTHONPATH", "")])
    run = subprocess.run(
        [sys.executable, "-c", before + SCRIPT, compiled, str(seed)],
        env={**os.environ, "IRC_COMPILED": compiled, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=True,
        cwd=ROOT,
    )
    return json.loads(run.stdout)


def test_both_find_the_same(seeds: Iterator[int]) -> None:
    pytest.importorskip("llvmlite")
    for seed in seeds:
        assert found(seed, "1") == found(seed, "0", GUARD)
