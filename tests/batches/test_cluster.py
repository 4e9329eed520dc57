"""A batch on a real Dask cluster: workers die, the scheduler goes away, no trial is lost."""

from __future__ import annotations

import socket
from collections import Counter
from pathlib import Path

import pytest

from batches.dask_cluster import cluster
from batches.test_batch import chain
from irc.batches.batch import Batch, BatchOptions
from irc.batches.results_file import read_results
from irc.batches.trial import TrialOptions
from irc.errors import IrcError, LibraryMissing

pytest.importorskip("distributed")

TASKS = 60
FORCED = TrialOptions(shortcut=False)


def tasks(count: int = TASKS) -> list[dict[str, object]]:
    """Tasks with names and makespans of their own."""
    return [{**chain(k + 1, 1), "name": f"t{k:02}"} for k in range(count)]


@pytest.mark.slow
@pytest.mark.filterwarnings(
    "ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning"
)
def test_a_killed_worker_and_a_lost_scheduler_cost_no_trial(tmp_path: Path) -> None:
    warnings: list[str] = []
    output = tmp_path / "results.jsonl"
    with cluster(tmp_path, 2) as (found, (first, _)):
        options = BatchOptions(
            trial=FORCED,
            scheduler=found.address,
            output=output,
            processes=1,
            on_warning=warnings.append,
        )
        values = {}
        for count, result in enumerate(Batch(tasks(), options), 1):
            values[result.task] = (result.status, result.objective[0].value)
            if count == TASKS // 3:
                first.kill()
            if count == TASKS // 2:
                assert warnings == []
                found.scheduler.kill()
    assert values == {f"t{k:02}": ("optimal", k + 2) for k in range(TASKS)}
    assert {*Counter(r.task for r in read_results(output)).values()} == {1}
    (warning,) = warnings
    assert "went away" in warning
    assert "the rest is solved on this machine" in warning


@pytest.mark.slow
def test_a_cluster_that_cannot_be_used_is_reported_at_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from irc.cluster import connecting as module

    monkeypatch.setattr(module, "CONNECT_SECONDS", 0.3)
    with socket.socket() as silent:
        silent.bind(("127.0.0.1", 0))
        silent.listen()
        options = BatchOptions(scheduler=f"tcp://127.0.0.1:{silent.getsockname()[1]}")
        with pytest.raises(IrcError, match="cannot reach the scheduler"):
            list(Batch(tasks(1), options))
    with pytest.raises(IrcError, match="cannot reach the scheduler"):
        list(Batch(tasks(1), BatchOptions(scheduler="nonsense://x")))


def test_without_the_extra_its_name_is_given(monkeypatch: pytest.MonkeyPatch) -> None:
    import sys

    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(LibraryMissing, match=r"irc-compiler\[cluster\]"):
        list(Batch(tasks(1), BatchOptions(scheduler="tcp://127.0.0.1:1")))
