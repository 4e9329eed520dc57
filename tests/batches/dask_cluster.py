"""A Dask cluster of processes on this machine, whose parts can be killed."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

START_SECONDS = 60


class Cluster:
    """A scheduler and its workers, each a process without children."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.processes: list[subprocess.Popen[bytes]] = []
        file = folder / "scheduler.json"
        self.scheduler = self._started(
            *("distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0"),
            *("--no-dashboard", "--no-show", "--scheduler-file", str(file)),
        )
        until = time.monotonic() + START_SECONDS
        while not (file.exists() and file.read_text()):
            assert self.scheduler.poll() is None, (folder / "log").read_text()
            assert time.monotonic() < until, "the scheduler does not start"
            time.sleep(0.05)
        self.address = str(json.loads(file.read_text())["address"])

    def _started(self, *arguments: str) -> subprocess.Popen[bytes]:
        log = (self.folder / "log").open("ab")
        path = os.pathsep.join(map(os.path.abspath, sys.path))
        process = subprocess.Popen(
            [sys.executable, "-P", "-m", *arguments],
            cwd=self.folder,
            env={**os.environ, "PYTHONPATH": path},
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=log,
        )
        self.processes.append(process)
        return process

    def add_worker(self) -> subprocess.Popen[bytes]:
        """A worker with one thread."""
        return self._started(
            *("distributed.cli.dask_worker", self.address, "--nthreads", "1", "--no-nanny"),
            *("--no-dashboard", "--local-directory", str(self.folder), "--memory-limit", "0"),
        )

    def end(self) -> None:
        """Kills what is left."""
        for process in self.processes:
            process.kill()
        for process in self.processes:
            process.wait(10)


@contextmanager
def cluster(folder: Path, workers: int) -> Iterator[tuple[Cluster, list[subprocess.Popen[bytes]]]]:
    """A cluster with some workers, and the workers."""
    found = Cluster(folder)
    try:
        yield found, [found.add_worker() for _ in range(workers)]
    finally:
        found.end()
