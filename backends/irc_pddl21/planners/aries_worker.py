"""Runs aries through unified-planning in a process of its own; prints each better plan.

Started by file path: aries_worker.py DOMAIN PROBLEM SECONDS
"""

from __future__ import annotations

import sys
from fractions import Fraction

from unified_planning.environment import get_environment
from unified_planning.io import PDDLReader
from unified_planning.plans import TimeTriggeredPlan
from unified_planning.shortcuts import AnytimePlanner


def main(arguments: list[str]) -> int:
    """Prints plans in IPC form, each followed by an empty line."""
    domain_file, problem_file, seconds = arguments
    get_environment().credits_stream = None
    problem = PDDLReader().parse_problem(domain_file, problem_file)
    with AnytimePlanner(name="aries") as planner:
        for result in planner.get_solutions(problem, timeout=float(seconds)):
            if isinstance(result.plan, TimeTriggeredPlan):
                print_plan(result.plan)
    return 0


def print_plan(plan: TimeTriggeredPlan) -> None:
    """One plan, its exact times as decimals of six places."""
    for start, action, duration in plan.timed_actions:
        held = "" if duration is None else f" [{_decimal(duration)}]"
        print(f"{_decimal(start)}: ({action.action.name}){held}")
    print(flush=True)


def _decimal(value: Fraction) -> str:
    whole = round(value * 1_000_000)
    return f"{whole // 1_000_000}.{whole % 1_000_000:06d}"


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
