"""Runs the kairos planner in a process of its own and prints each better plan as it comes.

Started by file path, so that it loads nothing but kairos:
kairos_worker.py DOMAIN PROBLEM SECONDS MEMORY_MB TARGET_COST THREADS SEED first|best [SEARCH]
"""

from __future__ import annotations

import sys
from typing import Any

import kairos


def main(arguments: list[str]) -> int:
    """Prints plans in IPC form, each followed by an empty line. 0 unless the input is bad."""
    domain_file, problem_file, seconds, memory, target, threads, seed, wanted, *search = arguments
    try:
        domain = kairos.parse_domain(_text(domain_file))
        problem = kairos.parse_problem(_text(problem_file), domain)
    except kairos.PddlError as error:
        print(error, file=sys.stderr)
        return 2
    options: dict[str, Any] = {
        "timeout": float(seconds),
        "memory_limit_mb": int(memory),
        "threads": int(threads),
        "seed": int(seed),
        "anytime": wanted == "best",
    }
    if search:
        options["search"] = search[0]
    if target != "-":
        options["target_cost"] = float(target)
    planner: Any = kairos.Planner
    for plan in planner().plans(problem, **options):
        print(f"{_timed(str(plan))}\n", flush=True)
    return 0


def _timed(plan: str) -> str:
    """A plan with times: kairos prints none for instants alone, which follow an epsilon apart."""
    lines = plan.splitlines()
    for k, line in enumerate(lines):
        if line.startswith("("):
            lines[k] = f"{k / 1000:.3f}: {line}"
    return "\n".join(lines)


def _text(path: str) -> str:
    with open(path, encoding="utf-8") as file:
        return file.read()


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
