"""Random tasks that combine features, each target's answer against the exact optimum.

`python benchmarks/combined.py cpsat --first 0 --count 20000 --limit 10 --seconds 3600`
prints a line for each fault, with its seed and the smallest document found, and the counts.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests"))

from oracles.combined import combined_document, features_of
from oracles.combined_judge import is_fault, smallest, verdict


def main() -> None:
    """Judges tasks until their number or the time is reached."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("target", choices=["cpsat", "pddl21"])
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--limit", type=float, default=10.0, help="seconds for each task")
    parser.add_argument("--seconds", type=float, default=float("inf"), help="for all of them")
    given = parser.parse_args()
    counts: Counter[str] = Counter()
    end = time.monotonic() + given.seconds
    seed = given.first
    for seed in range(given.first, given.first + given.count):
        if time.monotonic() > end:
            break
        said = verdict(combined_document(seed), given.target, given.limit)
        counts[said.split(":")[0] if is_fault(said) else said] += 1
        if is_fault(said):
            least = smallest(combined_document(seed), given.target, given.limit)
            print(seed, features_of(seed), said, json.dumps(least), flush=True)
    print(f"seeds {given.first} to {seed}: {sum(counts.values())} tasks")
    for said, count in counts.most_common():
        print(f"{count:8} {said}")


if __name__ == "__main__":
    main()
