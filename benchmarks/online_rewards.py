"""Judges each step of random executions with rewarded orders by a model of its own.

    python benchmarks/online_rewards.py [--episodes 100] [--first 0] [--target cpsat]
                                        [--engine auto] [--time-limit 20] [--repros DIR]

An episode has one to four events, drawn for the plan that is carried out then: new orders (some
without enough stock), longer work, stations that fail, earlier deadlines, cancelled orders,
observations. Every step must be valid, finish as many half-done orders as an exact continuation of
the history, and earn the same reward (`tests/oracles/online_orders_judge.py`, which shares no code
with `irc`). Exits with 1 on any fault; `--first SEED --episodes 1` replays it.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from irc.diagnostics import InputError
from irc.targets import EngineFailed, SolveOptions
from oracles.online_orders_play import Played, play
from timed import spread


def tell(seed: int, number: int, one: Played, counts: Counter[str]) -> None:
    """Counts a step, and prints its faults."""
    judged = one.judged
    counts["steps"] += 1
    counts["valid"] += judged.answered and not judged.faults
    counts["infeasible"] += judged.infeasible
    counts["unanswered"] += not judged.answered and not judged.infeasible
    counts["proven"] += one.step["schedule"]["status"] == "optimal"
    counts["compared"] += judged.compared
    counts["equal"] += judged.compared and not judged.faults and judged.worse is None
    counts["not compared"] += judged.why_not is not None
    counts["half-done"] += len(judged.half_done)
    counts["given up"] += len(judged.given_up)
    counts["resumed"] += len(judged.resumed)
    counts["new"] += len(judged.new)
    counts["unaffordable"] += len(judged.unaffordable)
    counts["earned"] += judged.earned
    counts["possible"] += judged.possible
    counts["faults"] += len(judged.faults)
    for fault in judged.faults:
        print(f"seed {seed} step {number}: {fault}", flush=True)
    if judged.worse is not None:
        print(f"seed {seed} step {number}: not proven: {judged.worse}", flush=True)
    if judged.why_not is not None:
        print(f"seed {seed} step {number}: not compared: {judged.why_not}", flush=True)


def main() -> int:
    """Prints all faults and lower rewards, and a table of figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--episodes", type=int, default=100)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--target", default="cpsat", choices=["cpsat", "pddl21"])
    parser.add_argument("--engine", default="auto")
    parser.add_argument("--time-limit", type=float, default=20.0)
    parser.add_argument("--repros", type=Path)
    options = parser.parse_args()
    how = SolveOptions(options.target, options.engine, options.time_limit, workers=1)
    counts: Counter[str] = Counter()
    kinds: Counter[str] = Counter()
    seconds: list[float] = []
    for seed in range(options.first, options.first + options.episodes):
        counts["episodes"] += 1
        number, before, faulty, abandons = 0, counts["faults"], False, False
        began = time.perf_counter()
        try:
            for one in play(seed, how):
                number += 1
                tell(seed, number, one, counts)
                kinds[str(one.event["id"]).rsplit(" ", 1)[0]] += 1
                seconds.append(one.seconds)
                abandons = abandons or bool(one.judged.given_up)
                if options.repros is not None and one.judged.faults:
                    options.repros.mkdir(parents=True, exist_ok=True)
                    text = json.dumps(one.document(), indent=1)
                    (options.repros / f"{seed}_{number}.json").write_text(text, "utf-8")
        except (InputError, EngineFailed) as error:
            counts["faults"] += 1
            print(f"seed {seed} step {number + 1}: {error}", flush=True)
        faulty = counts["faults"] > before
        counts["approved"] += not faulty
        counts["with an abandonment"] += abandons
        if seed % 10 == 9:
            took = time.perf_counter() - began
            print(f"{seed}: {dict(counts)}, {took:.1f} s", file=sys.stderr, flush=True)
    width = max(map(len, counts))
    print(f"{options.target}, {options.time_limit:g} s a step")
    for name, count in counts.items():
        print(f"{name:{width}} {count:6}")
    print(f"events: {', '.join(f'{kind} {n}' for kind, n in sorted(kinds.items()))}")
    print(f"a step: {spread(seconds)}")
    return int(bool(counts["faults"]))


if __name__ == "__main__":
    sys.exit(main())
