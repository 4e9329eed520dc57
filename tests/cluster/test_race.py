"""One task on a real Dask cluster: workers search together, die, and are left."""

from __future__ import annotations

import socket
import sys
import threading
import time
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest

import irc
from api.test_running import shop
from batches.dask_cluster import Cluster, cluster
from irc.cluster import connecting
from irc.cluster.connecting import ClusterError, _require_workers
from irc.cluster.race import Contact, Race
from irc.cluster.solving import solve_on_cluster
from irc.errors import LibraryMissing, OptionError
from irc.schedule import Status
from irc.targets import Budget, Cancellation, Exchange, Part, Progress, SolveOptions
from irc.validation import validate
from irc_cpsat.solving.variations import search_limits
from local_search_tasks import job_shop

pytest.importorskip("distributed")

quiet = pytest.mark.filterwarnings(
    "ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning"
)


def processes_of(found: Cluster) -> dict[str, Any]:
    """What runs on each worker: the tasks that it executes."""
    from distributed import Client

    with Client(found.address, set_as_default=False) as client:
        return dict(client.processing())


@pytest.mark.slow
@quiet
def test_a_worker_dies_the_race_goes_on_and_a_cancelled_one_leaves_nothing(tmp_path: Path) -> None:
    task, cancel, seen = shop(8, 10), Cancellation(), list[Progress]()
    with cluster(tmp_path, 2) as (found, (first, _)):

        def tell(progress: Progress) -> None:
            seen.append(progress)
            if first.poll() is None:
                first.kill()
                threading.Timer(4, cancel.cancel).start()

        options = SolveOptions(time_limit=100, on_progress=tell, cancel=cancel)
        answer = solve_on_cluster(task, found.address, options)
        ended = time.monotonic()
        assert answer.schedule.status in (Status.FEASIBLE, Status.OPTIMAL)
        assert validate(task, answer.schedule).valid
        assert answer.schedule.makespan <= min(float(p.value) for p in seen)
        if answer.schedule.interrupted:
            assert any("1 of" in note.message for note in answer.notes), answer.notes
        while any(map(len, processes_of(found).values())):
            assert time.monotonic() < ended + 20, "a racer is left on the cluster"
            time.sleep(0.1)
        small = irc.solve(job_shop(3), scheduler=found.address, shortcut=False, time_limit=50)
        assert small.status == "optimal"
        assert small.makespan == irc.solve(job_shop(3)).makespan


def test_what_cannot_be_used_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(connecting, "CONNECT_SECONDS", 0.3)
    with pytest.raises(ClusterError, match="cannot reach the scheduler 'nonsense://x'"):
        irc.solve(job_shop(1), scheduler="nonsense://x", shortcut=False)
    with socket.socket() as silent:
        silent.bind(("127.0.0.1", 0))
        silent.listen()
        address = f"tcp://127.0.0.1:{silent.getsockname()[1]}"
        with pytest.raises(ClusterError, match="cannot reach the scheduler"):
            irc.solve(job_shop(1), scheduler=address, shortcut=False)
    with pytest.raises(OptionError, match="cannot be deterministic"):
        irc.solve(job_shop(1), scheduler=address, deterministic=True)
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(LibraryMissing, match=r"irc-compiler\[cluster\]"):
        irc.solve(job_shop(1), scheduler=address, shortcut=False)


@pytest.mark.parametrize(
    ("theirs", "message"),
    [
        ({"irc": "0.0.1"}, "worker w has irc 0.0.1, and this is"),
        ({"ortools": "1.0"}, "worker w has ortools 1.0, and this is"),
        (ModuleNotFoundError("No module named 'irc'"), "worker w cannot load irc: No module"),
    ],
)
def test_other_versions_are_reported(theirs: Any, message: str) -> None:
    ours = connecting._all_versions()
    found = theirs if isinstance(theirs, Exception) else {**ours, **theirs}

    class Client:
        def wait_for_workers(self, *_: Any, **__: Any) -> None:
            pass

        def run(self, *_: Any, **__: Any) -> dict[str, Any]:
            return {"w": found}

    with pytest.raises(ClusterError, match=message):
        _require_workers(Client(), "tcp://x", connecting._all_versions)  # type: ignore[arg-type]


def test_parts_differ() -> None:
    assert search_limits(None) == search_limits(Part(0, 1))
    shares = [search_limits(Part(k, 4))[0] for k in range(4)]
    assert shares[2] == 0
    assert shares[1] == shares[3] > shares[0] > 0


def test_no_two_searches_have_one_seed() -> None:
    program: Any = SimpleNamespace(target="cpsat", task=None)
    options, client = SolveOptions(seed=2**31 - 1), cast(Any, None)
    running = Race(client, program, options, Budget(9), "ortools")
    threads = 4
    contacts = [Contact("worker", threads, Part(k, 3)) for k in range(3)]
    seeds = [running._request(contact).options["seed"] for contact in contacts]
    assert all(0 <= seed < 2**31 for seed in seeds)
    assert len({seed + k for seed in seeds for k in range(threads)}) == 3 * threads


def test_the_best_is_kept() -> None:
    exchange = Exchange()
    exchange.offer(9, "a")
    exchange.offer(7, "b")
    exchange.offer(8, "c")
    exchange.prove(3)
    exchange.prove(2)
    assert (exchange.best, exchange.bound) == ((7, "b"), 3)
