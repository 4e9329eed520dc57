"""Compares the cold start of `irc compile` with `python -c "import pydantic"`.

    python benchmarks/startup.py [--runs 15]

Whole processes, run in turn (A B A B …) after one warm-up each; the median of each, and of the
ratio pair by pair. Modules are compiled to bytecode once, as `pip install` does, also where the
environment forbids it for checkouts.
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import time
from pathlib import Path

EXAMPLE = Path(__file__).resolve().parents[1] / "examples" / "house_build_100.json"


def seconds(command: list[str]) -> float:
    """Wall-clock time of a whole process."""
    began = time.perf_counter()
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    subprocess.run(command, stdout=subprocess.DEVNULL, check=True, env=environment)
    return time.perf_counter() - began


def main() -> None:
    """Prints the two medians and the ratio."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=15)
    options = parser.parse_args()
    irc = Path(sys.executable).with_name("irc")
    ours = [str(irc), "compile", str(EXAMPLE), "--target", "pddl21"]
    base = [sys.executable, "-c", "import pydantic"]
    pairs = [(seconds(ours), seconds(base)) for _ in range(options.runs + 1)][1:]
    print(f"irc compile: median {statistics.median(a for a, _ in pairs):.3f} s")
    print(f"import pydantic: median {statistics.median(b for _, b in pairs):.3f} s")
    ratios = [a / b for a, b in pairs]
    print(f"ratio: median {statistics.median(ratios):.2f}, min {min(ratios):.2f}")


if __name__ == "__main__":
    main()
