"""`irc batch`: 350 tasks on all cores, killed and resumed, and on a Dask cluster of this machine.

    python benchmarks/batch.py [cores] [killed] [cluster] [--kills N] [--data DIR]

`cores` solves the 350 AsyncPlan-XXL graphs of 40 steps and more by `cpsat`, without the shortcut,
and reports the seconds from the start of the command to its end. `killed` does so with SIGKILL at
random moments, resumes until all is done, and counts the results of each trial, the processes left
and the torn lines. `cluster` solves job shops with one Dask worker and with two, each with one
thread, and compares the seconds.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests"))

from api.test_running import shop  # noqa: E402
from batches.dask_cluster import Cluster  # noqa: E402
from irc.batches.results_file import read_results  # noqa: E402

DATA = ROOT.parent / "shared" / "data" / "asyncplan_xxl"
SIZES = (40, 50, 60, 70, 80, 90, 100)


def command(data: Path, output: Path) -> list[str]:
    """The batch of the 350 graphs."""
    files = [str(data / f"nodes{size}.json") for size in SIZES]
    return [
        *(sys.executable, "-m", "irc", "batch", *files, "--from", "asyncplan"),
        *("--no-shortcut", "-o", str(output)),
    ]


def cores(data: Path, folder: Path, runs: int = 3) -> None:
    """The seconds of the whole command."""
    for _ in range(runs):
        output = folder / "cores.jsonl"
        output.unlink(missing_ok=True)
        began = time.perf_counter()
        subprocess.run(command(data, output), check=True, stdout=subprocess.DEVNULL)
        seconds = time.perf_counter() - began
        found = list(read_results(output))
        solvers = Counter(result.solver for result in found)
        statuses = Counter(result.status for result in found)
        print(f"cores: {len(found)} trials in {seconds:.1f} s, {dict(statuses)} by {dict(solvers)}")


def killed(data: Path, folder: Path, kills: int, seed: int) -> None:
    """Kills the command again and again, then lets it end."""
    rng, output = random.Random(seed), folder / "killed.jsonl"
    torn = 0
    left: Counter[str] = Counter()
    for _ in range(kills):
        process = subprocess.Popen(
            command(data, output), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        time.sleep(rng.uniform(1, 4))
        process.send_signal(signal.SIGKILL)
        process.wait()
        torn += output.exists() and output.read_bytes()[-1:] not in (b"", b"\n")
        time.sleep(1.5)
        left["processes left"] += len(workers())
    subprocess.run(command(data, output), check=True, stdout=subprocess.DEVNULL)
    counts = Counter(Counter(result.key for result in read_results(output)).values())
    print(
        f"killed {kills} times: results of a trial → trials {dict(counts)}, {dict(left)},"
        f" torn last lines {torn}"
    )


def workers() -> list[int]:
    """The worker processes of any batch."""
    found = []
    for entry in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            if b"irc.batches.worker" in entry.read_bytes():
                found.append(int(entry.parent.name))
        except OSError:
            continue
    return found


def on_cluster(folder: Path, tasks: int) -> None:
    """One worker against two, on shops that take a second or so each."""
    inputs = folder / "shops.jsonl"
    documents = (
        {**shop(6, 8).model_dump(mode="json", by_alias=True, exclude_unset=True), "name": f"s{k}"}
        for k in range(tasks)
    )
    inputs.write_text("".join(json.dumps(d) + "\n" for d in documents), "utf-8")
    seconds = {}
    for count in (1, 2):
        place = folder / str(count)
        place.mkdir()
        cluster = Cluster(place)
        try:
            for _ in range(count):
                cluster.add_worker()
            while (place / "log").read_text().count("Registered to") < count:
                time.sleep(0.1)
            seconds[count] = _solved(inputs, cluster.address, place / "results.jsonl")
        finally:
            cluster.end()
    print(
        f"cluster: {tasks} shops with one worker {seconds[1]:.1f} s, with two {seconds[2]:.1f} s:"
        f" × {seconds[1] / seconds[2]:.2f}"
    )


def _solved(inputs: Path, address: str, output: Path) -> float:
    began = time.perf_counter()
    subprocess.run(
        [
            *(sys.executable, "-m", "irc", "batch", str(inputs), "--scheduler", address),
            *("-o", str(output), "--time-limit", "20"),
        ],
        check=True,
        stdout=subprocess.DEVNULL,
    )
    seconds = time.perf_counter() - began
    print(f"  {Counter(result.status for result in read_results(output))}")
    return seconds


def main() -> None:
    """Measures what is named, or all."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("parts", nargs="*", help="cores, killed, cluster")
    parser.add_argument("--data", type=Path, default=DATA)
    parser.add_argument("--kills", type=int, default=5)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--tasks", type=int, default=24)
    parser.add_argument("--runs", type=int, default=3)
    options = parser.parse_args()
    parts = options.parts or ["cores", "killed", "cluster"]
    print(f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if "cores" in parts:
            cores(options.data, folder, options.runs)
        if "killed" in parts:
            killed(options.data, folder, options.kills, options.seed)
        if "cluster" in parts:
            on_cluster(folder, options.tasks)


if __name__ == "__main__":
    main()
