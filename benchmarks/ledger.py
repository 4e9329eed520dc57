"""Checks that each field of the IR matters through `pddl21` too, by two answers to its witness.

    python benchmarks/ledger.py [--seconds 1] [--engine kairos]

A witness is a task in which a field matters and one without it, with the best values of both
(`tests/oracles/field_witnesses.py`). Prints how the answers compare, and names wrong ones.
(`tests/conformance/test_state_tasks.py` holds `cpsat` to all of them.)
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from pathlib import Path

import irc
from irc.model import Task
from irc.schedule import Status
from irc.targets import backends, refused_features

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from oracles.field_witnesses import WITNESSES, Answer


def compared(task: Task, best: Answer, engine: str, seconds: float) -> str:
    """The verdict on the planner's answer, given the best value."""
    if not irc.check(task).ok:
        return "no schedule, said by the checks" if best is None else "WRONG"
    if refused_features(task, backends()["pddl21"]):
        return "refused"
    schedule = irc.solve(task, "pddl21", engine=engine, time_limit=seconds, shortcut=False)
    if not schedule.answered:
        if schedule.status is Status.INFEASIBLE:
            return "no schedule" if best is None else "WRONG"
        return "no answer"
    values = tuple(int(o.value) for o in schedule.objective)
    if values == best:
        return f"best, {schedule.status}"
    return "WRONG" if best is None or schedule.status is Status.OPTIMAL else "valid, not the best"


def main() -> None:
    """Prints the counts, and the fields of wrong answers."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--engine", default="kairos")
    parser.add_argument("--seconds", type=float, default=1.0)
    options = parser.parse_args()
    counts: Counter[str] = Counter()
    for witness in WITNESSES:
        for task, best in (
            (witness.task, witness.answer),
            (witness.counterpart, witness.answer_instead),
        ):
            verdict = compared(task, best, options.engine, options.seconds)
            counts[verdict] += 1
            if verdict == "WRONG":
                print(f"{witness.field}: wrong")
    print(dict(counts))


if __name__ == "__main__":
    main()
