"""Whether the diagnostics that a rewrite shows name what is wrong with an answer.

    python benchmarks/retry_loop.py [--seeds N] [--first SEED]

Each seed corrupts one element of an answer that can be used, as language models do: 49 kinds, over
tasks of the IR, texts that are no JSON, step graphs, scheduling JSON and PDDL. The element is named
where a message or hint has its name or its wrong value, and placed where an error points into it.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from answer_corruptions import KINDS, corrupted, judged


def main() -> None:
    """Judges the corruptions, and prints the counts and all that is not named."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=60)
    parser.add_argument("--first", type=int, default=0)
    given = parser.parse_args()
    counts: Counter[str] = Counter()
    for seed in range(given.first, given.first + given.seeds):
        kind, made = corrupted(seed)
        found = judged(made)
        counts.update(named=found.is_named, shown=found.is_shown, placed=found.is_placed)
        if not (found.is_named and found.is_shown and found.is_placed):
            print(f"seed {seed}, {kind}: {found.answer.state}, wanted {made.named} {made.pointer}")
            print(found.answer.report.render())
    print(f"{len(KINDS)} kinds, {given.seeds} seeds from {given.first} on")
    for name in ("named", "shown", "placed"):
        print(f"{name} {counts[name]}/{given.seeds}")


if __name__ == "__main__":
    main()
