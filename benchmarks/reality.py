"""Random sessions with late, corrected and contradictory observations: no impossible history.

    python benchmarks/reality.py [--sessions 2000] [--first 0] [--target cpsat] [--time-limit 5]

Each session carries out a small random task (`tests/oracles/reality.py`), in the mode "assume" or
"confirm", and judges each step by what was observed. Exits with 1 on any fault; each is printed
with its seed (`--first SEED --sessions 1` replays it).
"""

from __future__ import annotations

import argparse
import sys
import traceback
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from irc.targets import SolveOptions
from oracles.reality import Session, play


def main() -> int:
    """Prints what the sessions came to; exits with 1 on a fault."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0] if __doc__ else "")
    parser.add_argument("--sessions", type=int, default=2000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--target", default="cpsat")
    parser.add_argument("--time-limit", type=float, default=5.0)
    options = parser.parse_args()
    means = SolveOptions(options.target, time_limit=options.time_limit, workers=1)
    count: Counter[str] = Counter()
    slowest, faulty = 0.0, 0
    for seed in range(options.first, options.first + options.sessions):
        try:
            found = play(seed, means)
        except Exception as error:  # noqa: BLE001 - reported as a fault of its session
            traceback.print_exc()
            found = Session(faults=[f"{type(error).__name__}: {error}"])
        for name in ("steps", "accepted", "refused", "corrected", "unanswered", "left_out"):
            count[name] += getattr(found, name)
        slowest = max(slowest, found.slowest)
        faulty += bool(found.faults)
        for fault in found.faults:
            print(f"seed {seed}: {fault}", flush=True)
    print(
        f"{options.sessions:,} sessions, {count['steps']:,} steps: {count['accepted']:,} events "
        f"accepted ({count['corrected']:,} correct others), {count['refused']:,} refused; "
        f"{count['unanswered']:,} steps without an answer, {count['left_out']:,} that leave "
        f"something out; slowest {slowest:.2f} s; {faulty:,} sessions with faults"
    )
    return 1 if faulty else 0


if __name__ == "__main__":
    sys.exit(main())
