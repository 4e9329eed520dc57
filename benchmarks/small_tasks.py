"""Compares the processor time of whole processes on tasks that are proven quickly.

    python benchmarks/small_tasks.py [FOLDER] [--most 2] [--runs 3] [--stages]

A process of the plain CP-SAT model of `benchmarks/racing/plain.py` against `irc solve`, in turn,
with start-up, reading, checks and validation, on the instances of a folder, or on generated ones:
job shops of 6 × 6 to 10 × 10, flexible job shops, projects of 30 activities. Only those count that
the plain model proves within `--most` seconds of processor time. `--stages` says where irc's time
goes.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from statistics import median

sys.path.insert(0, str(Path(__file__).resolve().parent))

from racing.gather import gather
from racing.generate import (
    PROJECT_SETTINGS,
    Lehmer,
    flexible_text,
    job_shop,
    job_shop_text,
    project,
)
from racing.instance import Instance

PLAIN = Path(__file__).resolve().parent / "racing" / "plain.py"


def write_small(folder: Path, seed: int = 1) -> None:
    """Small instances of each family."""
    draw = Lehmer(1000 + seed)
    for size in (6, 7, 8, 9, 10):
        for k in range(3):
            shop = job_shop(size, size, draw.whole(1, 2**31 - 2), draw.whole(1, 2**31 - 2))
            (folder / f"shop_{size}_{k}.jsp").write_text(job_shop_text(shop))
    for k in range(5):
        text = flexible_text(4, 5, draw.whole(1, 2**31 - 2), 3)
        (folder / f"flexible_{k}.fjs").write_text(text)
    for k in range(12):
        strength = (0.5, 0.7, 1.0)[k % 3]
        complexity, factor, _ = PROJECT_SETTINGS[k % len(PROJECT_SETTINGS)]
        text = project(30, complexity, factor, strength, draw.whole(1, 2**31 - 2))
        (folder / f"project_{k}.sm").write_text(text)


def process(arguments: list[str]) -> tuple[float, str]:
    """(processor seconds, output) of a Python process. Exits where it fails."""
    with tempfile.TemporaryFile("w+") as output:
        child = subprocess.Popen([sys.executable, *arguments], stdout=output, stderr=output)
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        output.seek(0)
        text = output.read()
    if child.returncode:
        sys.exit(f"{' '.join(arguments)} failed: {text[-500:]}")
    return usage.ru_utime + usage.ru_stime, text


def compared(
    instance: Instance, task: str, folder: Path, options: argparse.Namespace
) -> tuple[float, float] | None:
    """The median processor times of both; None where the plain model takes longer than that."""
    own, given = folder / "instance.json", folder / "task.json"
    own.write_text(instance.text(), "utf-8")
    given.write_text(task, "utf-8")
    workers = ["--workers", str(options.workers)]
    plain = [str(PLAIN), str(own), "--seconds", str(options.most), *workers]
    irc = ["-m", "irc", "solve", str(given), "--format", "json", *workers]
    times: tuple[list[float], list[float]] = ([], [])
    for _ in range(options.runs):
        cpu, text = process(plain)
        answer = json.loads(text.splitlines()[-1])
        if not answer["proven"] or cpu > options.most:
            return None
        times[0].append(cpu)
        cpu, text = process(irc)
        found = json.loads(text)
        if found["status"] != "optimal" or found["makespan"] != answer["value"]:
            sys.exit(
                f"{instance.name}: irc says {found['status']} {found['makespan']}, not {answer}"
            )
        times[1].append(cpu)
    return median(times[0]), median(times[1])


def stages(task: str, workers: int) -> Iterator[tuple[str, float]]:
    """(stage, processor seconds of this process) of one call, everything loaded before."""
    from irc.checks import run_checks
    from irc.diagnostics import Findings
    from irc.driver.compile import lower_checked
    from irc.driver.judge import finish
    from irc.frontends.json.document import read_document
    from irc.model.from_document import to_task
    from irc.targets import Budget, get_backend
    from irc.validation import validate
    from irc_cpsat.encoding.encode import build_model
    from irc_cpsat.solving.asking import asked, solver_for
    from irc_cpsat.solving.levels import solve_levels
    from irc_cpsat.solving.outcome import outcome_of

    last = time.process_time()

    def spent(name: str) -> tuple[str, float]:
        nonlocal last
        now = time.process_time()
        last, since = now, now - last
        return name, since

    read = to_task(read_document(task, "task").content, Findings())
    assert read is not None
    yield spent("reading")
    checked = run_checks(read, lint=False)
    yield spent("checks")
    backend = get_backend("cpsat")
    problem = lower_checked(checked, backend)
    yield spent("lowering and passes")
    built = build_model(problem)
    yield spent("encoding")

    def solve(model: object, *_: object) -> tuple[object, object]:
        solver = solver_for(problem, 0)
        solver.parameters.num_workers = workers
        return asked(solver, built.model, Budget(60)), solver

    result = solve_levels(built, solve, Budget(60))
    yield spent("search")
    outcome = outcome_of("ortools", problem, built, result)
    yield spent("re-timing")
    schedule = finish(read, problem, outcome, "cpsat", 1.0)
    yield spent("values")
    validate(read, schedule)
    yield spent("validation")


def main() -> None:
    """Prints both times of each instance, and the ratios."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, nargs="?")
    parser.add_argument("--most", type=float, default=2.0, help="seconds of the plain model")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--only", default="")
    parser.add_argument("--stages", action="store_true")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = options.folder or Path(name) / "instances"
        if options.folder is None:
            folder.mkdir()
            write_small(folder)
        found = gather(folder)
        for line in found.skipped:
            print(f"skipped: {line}")
        pairs: list[tuple[float, float]] = []
        total: dict[str, float] = {}
        for instance, task in found.instances:
            if options.only not in instance.name:
                continue
            if options.stages:
                for k in range(2):
                    for stage, seconds in stages(task, options.workers):
                        total[stage] = total.get(stage, 0.0) + k * seconds
                continue
            pair = compared(instance, task, Path(name), options)
            if pair is None:
                print(f"{instance.name}: not proven quickly")
                continue
            pairs.append(pair)
            plain, irc = pair
            print(
                f"{instance.name}: plain {plain:.3f} s, irc {irc:.3f} s, × {irc / plain:.2f}",
                flush=True,
            )
    for stage, seconds in total.items():
        print(f"{stage}: {seconds:.3f} s")
    if pairs:
        ratios = [irc / plain for plain, irc in pairs]
        plain, irc = map(sum, zip(*pairs, strict=True))
        print(
            f"{len(pairs)} instances: plain {plain:.1f} s, irc {irc:.1f} s, × {irc / plain:.2f}; "
            f"geometric mean × {math.exp(sum(map(math.log, ratios)) / len(ratios)):.2f}"
        )


if __name__ == "__main__":
    main()
