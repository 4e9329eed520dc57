"""Reads all instance files of a folder, writes each again and reads it back: equal tasks?

    python benchmarks/instance_files.py FOLDER [--as psplib]

Read are job shops (.jsp, .txt, no suffix), flexible job shops (.fjs) and projects (.sm, .mm, .rcp,
.sch). Projects and flexible job shops are compared with what another reader finds (psplib,
fjsplib), too. `--as` writes in another format than that of the file, and reads that back.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from pathlib import Path
from typing import Any

from irc.diagnostics import InputError
from irc.frontends.formats import EXPORTERS, KNOWN_SUFFIXES, load_exporter, load_importer
from irc.model import Task
from irc.model.canonical import canonical_task

_THEIRS = {"psplib": "psplib", "patterson": "patterson", "rcpsp-max": "rcpsp_max"}


def by_another_reader(path: Path, source: str) -> list[Any] | None:
    """What another reader finds: capacities, durations and demands; None without one."""
    if source in _THEIRS:
        import psplib

        project = psplib.parse(path, _THEIRS[source])
        return [
            [resource.capacity for resource in project.resources],
            [[mode.duration for mode in a.modes] for a in project.activities],
        ]
    if source == "flexible-job-shop":
        import fjsplib

        return [list(map(list, job)) for job in fjsplib.read(path).jobs]
    return None


def by_irc(task: Task, source: str) -> list[Any]:
    """The same of a task of ours."""
    if source in _THEIRS:
        capacities = [r.initial if r.kind == "reservoir" else r.capacity for r in task.resources]
        return [capacities, [_durations(action) for action in task.actions]]
    machines = {resource.id: n for n, resource in enumerate(task.resources)}
    jobs: dict[str, list[Any]] = {}
    for action in task.actions:
        ways = []
        for way in action.modes or (action,):
            for use in way.uses:
                names = use.one_of or (use.resource,)
                ways += [(machines[name], way.duration) for name in names]
        jobs.setdefault(action.id.rsplit(".", 1)[0], []).append(sorted(ways))
    return list(jobs.values())


def _durations(action: Any) -> list[Any]:
    return [mode.duration for mode in action.modes] or [action.duration]


def one_file(path: Path, source: str, target: str) -> str:
    """What became of a file."""
    try:
        read = list(load_importer(source)(path.read_text("utf-8"), path.name))
    except (InputError, UnicodeDecodeError) as error:
        return f"not read: {str(error).splitlines()[0]}"
    for _, task in read:
        text = load_exporter(target)(task)
        ((_, again),) = load_importer(target)(text, path.name)
        if canonical_task(again.model_copy(update={"name": task.name})) != canonical_task(task):
            return "read back with a difference"
    theirs = by_another_reader(path, source)
    if theirs is None:
        return "equal"
    (_, task) = read[0]
    return "equal, and as another reader" if same(theirs, by_irc(task, source)) else "unlike"


def same(theirs: list[Any], ours: list[Any]) -> bool:
    """Whether both readers found the same numbers."""
    return _sorted(theirs) == _sorted(ours)


def _sorted(value: Any) -> Any:
    if isinstance(value, list) and value and isinstance(value[0], tuple):
        return sorted(value)
    return [_sorted(item) for item in value] if isinstance(value, list) else value


def main() -> int:
    """Prints the counts for each format, and each file with a difference."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path)
    parser.add_argument("--as", dest="target", choices=sorted(EXPORTERS))
    chosen = parser.parse_args()
    counts: Counter[tuple[str, str]] = Counter()
    faults = 0
    began = time.perf_counter()
    for path in sorted(p for p in chosen.folder.rglob("*") if p.is_file()):
        source = KNOWN_SUFFIXES.get(path.suffix.lower(), "job-shop")
        outcome = one_file(path, source, chosen.target or source)
        counts[source, outcome.split(":")[0]] += 1
        if not outcome.startswith("equal"):
            faults += 1
            print(f"{path.name}: {outcome}")
    for (source, outcome), count in sorted(counts.items()):
        print(f"{count:6} {source}: {outcome}")
    print(f"{time.perf_counter() - began:.0f} s")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
