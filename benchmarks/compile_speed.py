"""Compares the compilation of JSON text to PDDL2.1 text with unified-planning's PDDLWriter.

    python benchmarks/compile_speed.py [--runs 15]

Both sides start from the same JSON text and end with the text of domain and problem, in one
process, in turn. irc also checks the task. Prints the median CPU time of each and the ratio.
"""

from __future__ import annotations

import argparse
import gc
import json
import statistics
import time
from collections.abc import Callable

from unified_planning.io import PDDLWriter
from unified_planning.shortcuts import (
    And,
    BoolType,
    DurativeAction,
    EndTiming,
    Fluent,
    MinimizeMakespan,
    Problem,
    StartTiming,
    get_environment,
)

from graphs import random_graph
from irc.driver.compile import compile_task
from irc.frontends.files import parse_task


def through_irc(text: str) -> int:
    """The length of the emitted text."""
    program = compile_task(parse_task(text).task, "pddl21")
    return sum(len(file) for file in program.files.values())


def through_unified_planning(text: str) -> int:
    """The same encoding (actions that occur once, done facts) written with unified-planning."""
    document = json.loads(text)
    problem = Problem("task")
    todo, done = {}, {}
    for action in document["actions"]:
        name = action["id"]
        todo[name], done[name] = (
            Fluent(f"todo_{name}", BoolType()),
            Fluent(f"done_{name}", BoolType()),
        )
        problem.add_fluent(todo[name], default_initial_value=True)
        problem.add_fluent(done[name], default_initial_value=False)
    before: dict[str, list[str]] = {}
    for edge in document["precedence"]:
        before.setdefault(edge["after"], []).append(edge["before"])
    for action in document["actions"]:
        name = action["id"]
        durative = DurativeAction(name)
        durative.set_fixed_duration(action["duration"])
        durative.add_condition(StartTiming(), todo[name])
        for other in before.get(name, ()):
            durative.add_condition(StartTiming(), done[other])
        durative.add_effect(StartTiming(), todo[name], False)
        durative.add_effect(EndTiming(), done[name], True)
        problem.add_action(durative)
    problem.add_goal(And(*(done[a["id"]] for a in document["actions"])))
    problem.add_quality_metric(MinimizeMakespan())
    writer = PDDLWriter(problem)
    return len(writer.get_domain()) + len(writer.get_problem())


def seconds(call: Callable[[str], int], text: str) -> float:
    """The CPU time of one call; other work on the machine does not count.

    As in `timeit`, the garbage collector is off, so that garbage of one side does not slow the
    other.
    """
    gc.collect()
    gc.disable()
    began = time.process_time()
    call(text)
    spent = time.process_time() - began
    gc.enable()
    return spent


def main() -> None:
    """Prints a row for each size."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=15)
    options = parser.parse_args()
    get_environment().credits_stream = None
    for actions in (100, 1000):
        text = random_graph(actions, 2 * actions)
        through_irc(text)
        pairs = [
            (seconds(through_irc, text), seconds(through_unified_planning, text))
            for _ in range(options.runs)
        ]
        ours, theirs = (statistics.median(column) for column in zip(*pairs, strict=True))
        print(
            f"{actions} actions, {2 * actions} edges: irc {1000 * ours:.1f} ms, "
            f"unified-planning {1000 * theirs:.0f} ms, × {theirs / ours:.1f}"
        )


if __name__ == "__main__":
    main()
