"""Runs irc on one instance of the league.

    python -m racing.through_irc INSTANCE.json TASK.json --parts all [--seconds 10] …

`--parts` names what is switched off: `all` (nothing is), or names of `WITHOUT` joined by `+`.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path
from typing import Any

from racing.spending import when_spent

WITHOUT = ("bounds", "hints", "improves", "destructive")
"""What can be switched off: what the compiler adds to the model, its list schedule, the local
search beside CP-SAT, the search for destructive bounds."""


def main() -> None:
    """Solves one instance."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("instance", type=Path)
    parser.add_argument("task", type=Path)
    parser.add_argument("--parts", default="all")
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--processor-seconds", type=float, default=0.0)
    options = parser.parse_args()
    unknown = {*options.parts.split("+")} - {*WITHOUT, "all"}
    if unknown:
        parser.error(
            f"there is no part {', '.join(sorted(unknown))}; known are {', '.join(WITHOUT)}"
        )
    print(json.dumps(_solved(options)), flush=True)


def _solved(options: argparse.Namespace) -> dict[str, Any]:
    from irc.driver.solve import solve_by, solve_task
    from irc.frontends.files import read_task
    from irc.targets import Cancellation, Progress, SolveOptions, get_backend

    def tell(progress: Progress) -> None:
        bound = None if progress.bound is None else int(progress.bound)
        line = {"cpu": time.process_time(), "value": int(progress.value), "bound": bound}
        print(json.dumps(line), flush=True)

    off: set[str] = set() if options.parts == "all" else set(options.parts.split("+"))
    task = read_task(str(options.task)).task
    spent = Cancellation()
    when_spent(options.processor_seconds, spent.cancel)
    asked = SolveOptions(
        time_limit=options.seconds,
        workers=options.workers,
        seed=options.seed,
        on_progress=tell,
        cancel=spent,
    )
    if off:
        from irc_cpsat.engines import OrTools

        if "destructive" in off:
            _leave_out_destructive_bounds()
        engine = OrTools(**{part: part not in off for part in ("bounds", "hints", "improves")})
        schedule = solve_by(task, get_backend("cpsat"), engine, asked, asked.budget()).schedule
    else:
        schedule = solve_task(task, asked).schedule
    final: dict[str, Any] = {
        "cpu": time.process_time(),
        "proven": schedule.status.value == "optimal",
        "status": schedule.status.value,
        "engine": schedule.engine,
    }
    if schedule.answered:
        level = schedule.objective[0]
        final |= {"value": int(level.value), "bound": None}
        if level.bound is not None:
            final["bound"] = int(level.bound)
        final |= _places(options.instance, schedule)
    return final


def _leave_out_destructive_bounds() -> None:
    import irc.passes

    irc.passes.resource_bounds = irc.passes.quick_bounds
    irc.passes.PASSES = tuple(
        irc.passes.quick_bounds if step.__name__ == "resource_bounds" else step
        for step in irc.passes.PASSES
    )


def _places(path: Path, schedule: Any) -> dict[str, Any]:
    """The start and the way of each job."""
    instance = json.loads(path.read_text("utf-8"))
    entries = {entry.id: entry for entry in schedule.entries}
    starts, ways = [], []
    for id_, own in zip(instance["ids"], instance["jobs"], strict=True):
        entry = entries[id_]
        starts.append(int(entry.start))
        taken = {entry.mode, *entry.resources}
        ways.append(next(k for k, way in enumerate(own) if len(own) == 1 or way["id"] in taken))
    return {"starts": starts, "ways": ways}


if __name__ == "__main__":
    main()
