"""Imports and simulates the Online Robo Challenge; a strict judge checks every step.

    python benchmarks/online_robo.py [--target cpsat|pddl21] [--engine auto] [--time-limit 20]
                                     [--limit N] [--data DIR or FILE] [--report FILE]

An episode is approved if its history is valid at each moment and its last step has the reward of an
exact continuation of the history; `tests/oracles/online_robo.py` computes that without `irc`. Exits
with 1 if an episode is not valid, or not approved with `cpsat`. `--report` writes a JSON line for
each episode.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from irc.diagnostics import InputError
from irc.execution import simulate
from irc.frontends.formats import load_importer
from irc.model import Task
from irc.targets import EngineFailed, SolveOptions
from oracles.online_robo import Verdict, judge
from timed import spread

DATA = Path(__file__).resolve().parents[2] / "shared" / "data" / "robo_online"


@dataclass(frozen=True)
class Episode:
    """The result of an episode. `simulation` is the output of `irc simulate`."""

    name: str
    simulation: dict[str, Any]
    verdict: Verdict
    seconds: tuple[float, ...]
    """The seconds of each step."""

    @property
    def optimal_steps(self) -> int:
        return len(self.verdict.optima) - len(self.verdict.worse)

    def line(self) -> dict[str, Any]:
        """The report: each step, the frozen and moved entries, the reward and the verdict."""
        steps = [
            {
                "at": step["at"],
                "event": step["event"],
                "completed": step["completed"],
                "running": step["running"],
                "moved": step["moved"],
                "status": step["schedule"]["status"],
                "makespan": step["schedule"]["makespan"],
                "reward": _objective(step["schedule"], "reward"),
                "worse": self.verdict.worse.get(k),
                "seconds": round(seconds, 3),
            }
            for k, (step, seconds) in enumerate(
                zip(self.simulation["steps"], self.seconds, strict=False)
            )
        ]
        final = self.simulation["final"]
        return {
            "episode": self.name,
            "approved": self.verdict.approved,
            "makespan": final["makespan"],
            "reward": _objective(final, "reward"),
            "faults": self.verdict.faults,
            "steps": steps,
        }


def _objective(schedule: dict[str, Any], name: str) -> Any:
    return next((o["value"] for o in schedule["objective"] if o["name"] == name), None)


def episodes(data: Path) -> Iterator[tuple[dict[str, Any], Task]]:
    """(each raw episode, its imported task)."""
    importer = load_importer("robo-online")
    for path in sorted(data.glob("*.json")) if data.is_dir() else [data]:
        text = path.read_text("utf-8")
        raw = json.loads(text, parse_float=Fraction)
        for k, (_, task) in enumerate(importer(text, path.name)):
            yield (raw[k] if isinstance(raw, list) else raw), task


def run(raw: dict[str, Any], task: Task, options: SolveOptions) -> Episode:
    """Simulates an episode and judges it."""
    began = [time.perf_counter()]

    def on_step(_: object) -> None:
        began.append(time.perf_counter())

    done = simulate(task, on_step=on_step, options=options)
    document = json.loads(json.dumps(done.to_dict()), parse_float=Fraction)
    seconds = tuple(later - earlier for earlier, later in pairwise(began))
    return Episode(str(task.name), document, judge(raw, document), seconds)


def tell(episode: Episode, out: Callable[[str], Any]) -> None:
    """The faults of an episode."""
    for fault in episode.verdict.faults:
        out(f"{episode.name}: {fault}")
    for k, worse in episode.verdict.worse.items():
        out(f"{episode.name}: step {k}: {worse}")


def main() -> int:
    """Prints the episodes that are not approved, and a line of figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--target", default="cpsat", choices=["cpsat", "pddl21"])
    parser.add_argument("--engine", default="auto")
    parser.add_argument("--time-limit", type=float, default=20.0)
    parser.add_argument("--limit", type=int)
    parser.add_argument("--data", type=Path, default=DATA)
    parser.add_argument("--report", type=Path)
    options = parser.parse_args()
    how = SolveOptions(options.target, options.engine, options.time_limit, workers=1)
    done: list[Episode] = []
    failed = 0
    lines = []
    for raw, task in list(episodes(options.data))[: options.limit]:
        try:
            episode = run(raw, task, how)
        except (InputError, EngineFailed) as error:
            failed += 1
            print(f"{raw['id']}: {error}", flush=True)
            lines.append({"episode": raw["id"], "approved": False, "faults": [str(error)]})
            continue
        done.append(episode)
        lines.append(episode.line())
        tell(episode, lambda text: print(text, flush=True))
    if options.report is not None:
        text = "".join(json.dumps(line, default=_number) + "\n" for line in lines)
        options.report.write_text(text, "utf-8")
    total = len(done) + failed
    valid = sum(not episode.verdict.faults for episode in done)
    approved = sum(episode.verdict.approved for episode in done)
    steps = sum(len(episode.verdict.optima) for episode in done)
    print(
        f"{options.target}: approved {approved}/{total}, valid {valid}/{total}, optimal steps "
        f"{sum(episode.optimal_steps for episode in done)}/{steps}, moved "
        f"{sum(e.simulation['moved'] for e in done)}; a step: "
        f"{spread([s for episode in done for s in episode.seconds])}"
    )
    return int(valid < total or (options.target == "cpsat" and approved < total))


def _number(value: object) -> Any:
    if isinstance(value, Fraction):
        return float(value)
    raise TypeError(f"{value!r} is not of JSON")


if __name__ == "__main__":
    sys.exit(main())
