"""Random small tasks with elements of the vocabulary, on both targets, against exact answers.

    python -m benchmarks.elements modes --tasks 500 --target cpsat
    python -m benchmarks.elements pairs --tasks 3000 --target cpsat
    python -m benchmarks.elements online --tasks 1000 --target cpsat

The first draws tasks with one element. The second draws tasks with each element alone and with
each pair of elements in turn, and prints for each how the answers ended; a fault is shown as the
smallest task that has it. The third carries such tasks out until some time, and judges one step.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests"))

from element_laws import judge_exact, judge_planner
from irc.targets import EngineFailed
from oracles.combined import document_with, pairs
from oracles.combined_judge import is_fault, smallest, verdict
from oracles.elements import KINDS, TooHardError
from oracles.online_pairs import judged_step


def judge_pairs(chosen: argparse.Namespace) -> int:
    """Prints a row for each element and pair of elements, and each fault."""
    began, cpu = time.perf_counter(), time.process_time()
    names = [p for p in pairs() if set(chosen.only) <= set(p)]
    seen = {pair: Counter[str]() for pair in names}
    for k in range(chosen.tasks):
        pair, seed = names[k % len(names)], chosen.first_seed + k // len(names)
        document, shortcut = document_with(pair, seed), bool(seed % 2)
        if chosen.kind == "online":
            said = judged_step(pair, seed, chosen.target, chosen.seconds)
        else:
            said = verdict(document, chosen.target, chosen.seconds, shortcut=shortcut)
        seen[pair][said.split(":")[0] if is_fault(said) else said] += 1
        if is_fault(said) and chosen.kind == "online":
            print(f"{' + '.join(pair)} {seed}: {said}", flush=True)
        elif is_fault(said):
            least = smallest(document, chosen.target, chosen.seconds, shortcut=shortcut)
            print(f"{' + '.join(pair)} {seed}: {said}\n  {json.dumps(least)}", flush=True)
    for pair, counts in seen.items():
        if counts:
            shown = ", ".join(f"{count} {how}" for how, count in sorted(counts.items()))
            print(f"{' + '.join(pair)}: {shown}")
    total = sum(seen.values(), Counter[str]())
    shown = "\n".join(f"{count:6} {how}" for how, count in total.most_common())
    last = chosen.first_seed + (chosen.tasks - 1) // len(names)
    print(
        f"{chosen.tasks} tasks with {len(names)} elements and pairs on {chosen.target}, "
        f"seeds {chosen.first_seed} to {last}; {time.perf_counter() - began:.0f} s, "
        f"{time.process_time() - cpu:.0f} s of processor time\n{shown}"
    )
    return 1 if any(is_fault(how) for how in total) else 0


def main() -> int:
    """Prints how the answers ended, and each that is wrong."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("kind", choices=["pairs", "online", *KINDS])
    parser.add_argument("--tasks", type=int, default=500)
    parser.add_argument("--first-seed", type=int, default=1000)
    parser.add_argument("--target", choices=["cpsat", "pddl21"], default="cpsat")
    parser.add_argument("--seconds", type=float, default=10.0, help="for each task")
    parser.add_argument("--only", nargs="*", default=[], help="elements that a pair must have")
    chosen = parser.parse_args()
    if chosen.kind in ("pairs", "online"):
        return judge_pairs(chosen)
    began = time.perf_counter()
    seen: Counter[str] = Counter()
    for seed in range(chosen.first_seed, chosen.first_seed + chosen.tasks):
        try:
            task, best = KINDS[chosen.kind](seed)
        except TooHardError:
            seen["not judged"] += 1
            continue
        try:
            if chosen.target == "cpsat":
                seen[judge_exact(task, best)] += 1
            else:
                seen[judge_planner(task, best, chosen.seconds)] += 1
        except (AssertionError, EngineFailed) as fault:
            seen["wrong"] += 1
            print(f"{chosen.kind} {seed}: {type(fault).__name__}: {fault}")
    shown = ", ".join(f"{count} {how}" for how, count in sorted(seen.items()))
    print(f"{chosen.kind} on {chosen.target}: {shown}; {time.perf_counter() - began:.0f} s")
    return 1 if seen["wrong"] else 0


if __name__ == "__main__":
    sys.exit(main())
