"""Races irc against a plain CP-SAT model and PyJobShop on a folder of instances.

    python benchmarks/league.py FOLDER [--seconds 10] [--workers 2] [--known BEST.csv]
    python benchmarks/league.py FOLDER --generate [--count 2] [--seed 0]

The folder holds job shops (standard or Taillard's format), flexible job shops (.fjs), projects
(.sm, .mm, .rcp) or RCPSP/max (.sch); no data is in this repository. `--generate` fills it first, by
published generators. Every competitor runs in a process of its own, all in turn on one instance
after the other. What counts is the best schedule after equal processor time, with start-up, reading
and checks: `--seconds` for each worker. Competitors: `plain` (about thirty lines of CP-SAT),
`pyjobshop`, `irc`, and `irc-PART` with parts switched off (see `racing/through_irc.py`). Each final
schedule is judged here again.

`--known` names a file with lines `name,makespan`: the best known values. Gaps are measured
against these, or else against the best of the race. With `--results` every run is kept in a file,
and those that are there already are not done again. `--stop-after` ends a long race for now.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from itertools import product
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from racing.figures import progress, rows, table
from racing.gather import READ, gather
from racing.instance import Instance
from racing.plot import letters, picture
from racing.running import Race, Run, Runner, command


def arguments() -> argparse.Namespace:
    """What the command line says."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path)
    parser.add_argument("--generate", action="store_true", help="write instances there first")
    parser.add_argument("--count", type=int, default=1, help="generated instances of each size")
    parser.add_argument("--seed", type=int, default=0, help="of the generated instances")
    parser.add_argument("--format", choices=READ, help="of all files, whatever their suffix")
    parser.add_argument("--only", default="", help="instances whose name contains this")
    parser.add_argument("--competitors", nargs="+", default=["plain", "pyjobshop", "irc"])
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--seeds", type=int, default=1, help="runs of each, with other seeds")
    parser.add_argument("--known", type=Path, help="best known makespans: lines name,makespan")
    parser.add_argument("--results", type=Path, help="the file of all runs, to go on from")
    parser.add_argument("--stop-after", type=float, help="seconds; a race goes on later")
    parser.add_argument("--plot", type=Path, help="a picture of the mean gap over time")
    return parser.parse_args()


def known_values(path: Path | None) -> dict[str, int]:
    """The best known makespans. Exits at a line that is none."""
    found: dict[str, int] = {}
    lines = path.read_text("utf-8").splitlines() if path is not None else []
    for number, line in enumerate(lines, 1):
        words = line.replace(",", " ").split()
        if not words or words[0].startswith("#"):
            continue
        if len(words) != 2 or not words[1].isdecimal():
            sys.exit(f"{path}:{number}: expected 'name,makespan', found {line.strip()!r}")
        found[words[0]] = int(words[1])
    return found


def earlier_runs(path: Path | None, race: Race) -> list[Run]:
    """The runs of a race that are in a file already."""
    if path is None or not path.exists():
        return []
    found = []
    for line in path.read_text("utf-8").splitlines():
        try:
            raw = json.loads(line)
        except ValueError:
            continue  # (The last line of a race that was killed.)
        if (raw.pop("seconds"), raw.pop("workers")) == (race.seconds, race.workers):
            raw["trace"] = [(at, value) for at, value in raw["trace"]]
            found.append(Run(**raw))
    return found


def raced(
    options: argparse.Namespace, instances: Sequence[tuple[Instance, str]], done: Sequence[Run]
) -> Iterator[Run]:
    """All runs, one after the other; those that are done already are not done again.

    It ends between two instances, so that all competitors have had the same ones.
    """
    race = Race(options.seconds, options.workers)
    there = {(run.instance, run.competitor, run.seed): run for run in done}
    began = time.perf_counter()
    with tempfile.TemporaryDirectory() as name:
        runner = Runner(race, Path(name))
        paths = Path(name) / "instance.json", Path(name) / "task.json"
        for seed, (instance, task) in product(range(options.seeds), instances):
            over = _is_over(began, options.stop_after)
            paths[0].write_text(instance.text(), "utf-8")
            paths[1].write_text(task, "utf-8")
            for competitor in options.competitors:
                known = there.get((instance.name, competitor, seed))
                if known is None and over:
                    continue
                yield known or _kept(runner.run(competitor, instance, paths, seed), options)


def _is_over(began: float, seconds: float | None) -> bool:
    return seconds is not None and time.perf_counter() - began > seconds


def _kept(run: Run, options: argparse.Namespace) -> Run:
    """The run, written to the file of results and told."""
    if options.results is not None:
        line = {"seconds": options.seconds, "workers": options.workers, **asdict(run)}
        with options.results.open("a", encoding="utf-8") as file:
            file.write(json.dumps(line) + "\n")
    proven = ", proven" if run.proven else f", bound {run.bound}"
    fault = f" FAULT: {run.fault}" if run.fault else ""
    print(
        f"{run.instance} {run.competitor} seed {run.seed}: {run.value}{proven}, "
        f"{run.cpu:.1f} s of processor time in {run.wall:.1f} s{fault}",
        file=sys.stderr,
        flush=True,
    )
    return run


def comparable(runs: Sequence[Run], competitors: Sequence[str]) -> list[Run]:
    """The runs on instances that every competitor has had."""
    had: dict[tuple[str, int], set[str]] = {}
    for run in runs:
        had.setdefault((run.instance, run.seed), set()).add(run.competitor)
    return [run for run in runs if had[run.instance, run.seed] >= set(competitors)]


def report(runs: Sequence[Run], options: argparse.Namespace, known: dict[str, int]) -> None:
    """Prints the tables, the plot, and a line for each competitor."""
    compared = comparable(runs, options.competitors)
    if len(compared) < len(runs):
        print(f"{len(runs) - len(compared)} runs left out: not every competitor has had them yet")
    runs = compared
    for family in dict.fromkeys(run.family for run in runs):
        own = [run for run in runs if run.family == family]
        count = len({run.instance for run in own})
        print(f"\n{family}, {count} instances\n\n{table(rows(own, known, options.seconds))}")
    found = rows(runs, known, options.seconds)
    print(f"\nall, {len({run.instance for run in runs})} instances\n\n{table(found)}\n")
    curves = progress(runs, known, options.seconds)
    print(letters(curves) + "\n")
    if options.plot is not None and (why := picture(curves, options.plot)):
        print(why)
    for row in found:
        print(
            f"{row.competitor}: mean gap {100 * row.gap:.2f} %, proven {row.proven} of {row.runs}, "
            f"bound {100 * row.bound_gap:.2f} % below, behind on {100 * row.behind:.0f} %, "
            f"integral {100 * row.integral:.2f} %, faulty {row.faulty}"
        )


def main() -> None:
    """Runs a race and prints its figures."""
    options = arguments()
    for name in options.competitors:
        try:
            command(name, Path(), Path())
        except ValueError as error:
            sys.exit(str(error))
    known = known_values(options.known)
    if options.generate:
        from racing.generate import write_all

        print(f"{len(write_all(options.folder, options.count, options.seed))} instances written")
    if not options.folder.is_dir():
        sys.exit(f"there is no folder {str(options.folder)!r}; --generate fills one")
    found = gather(options.folder, options.format)
    for line in found.skipped:
        print(f"skipped: {line}")
    instances = [(i, task) for i, task in found.instances if options.only in i.name]
    print(f"{len(instances)} instances, {len(found.skipped)} skipped", flush=True)
    if not instances:
        sys.exit("no instance to race on")
    if any(name.startswith("irc") for name in options.competitors):
        # (What irc compiles once is not part of any run.)
        subprocess.run([sys.executable, "-m", "irc", "prepare"], check=True)
    done = earlier_runs(options.results, Race(options.seconds, options.workers))
    report([*raced(options, instances, done)], options, known)


if __name__ == "__main__":
    main()
