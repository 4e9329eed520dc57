"""Compares the reading of a large task from the DSL with the reading of the same task from JSON.

    python benchmarks/dsl_speed.py [--actions 100000] [--edges 300000] [--runs 3]

Three texts in the DSL: plain lines (names, durations, arrows), the same with a lag on every arrow
and a quoted name in every action (which the grammar itself must read), and one `for`. Each line has
the median time from text to task, for the DSL and for the JSON document of the same task, and their
ratio.
"""

from __future__ import annotations

import argparse
import json
import statistics
import time

from graphs import random_graph
from irc.frontends.dsl.printer import print_task
from irc.frontends.files import parse_task
from irc.model import Task
from irc.model.canonical import written_task


def seconds(text: str, name: str, runs: int) -> float:
    """The median wall-clock time of reading a text."""
    times = []
    for _ in range(runs):
        began = time.perf_counter()
        parse_task(text, name)
        times.append(time.perf_counter() - began)
    return statistics.median(times)


def compare(kind: str, text: str, runs: int) -> None:
    """Prints one line."""
    task = parse_task(text, "task.irc").task
    to_dict = json.dumps(written_task(task), indent=2)
    dsl, plain = seconds(text, "task.irc", runs), seconds(to_dict, "task.json", runs)
    print(
        f"{kind}: {len(task.actions):,} actions, {len(task.precedence):,} edges: "
        f"DSL {dsl:.2f} s ({len(text) / 1e6:.1f} MB), JSON {plain:.2f} s, × {dsl / plain:.2f}",
        flush=True,
    )


def unusual(line: str) -> str:
    """A line with nearly the same meaning that the fast reader of plain lines does not accept."""
    if "->" in line:
        return f"{line} + 2.5"
    name, _, rest = line.partition(" ")
    return f'"{name}" {rest} cost 3' if name else line


def main() -> None:
    """Prints a line for each kind of text."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--actions", type=int, default=100_000)
    parser.add_argument("--edges", type=int, default=300_000)
    parser.add_argument("--runs", type=int, default=3)
    options = parser.parse_args()
    graph = Task.model_validate(json.loads(random_graph(options.actions, options.edges)))
    text = print_task(graph)
    compare("plain lines", text, options.runs)
    compare("every line by the grammar", "\n".join(map(unusual, text.split("\n"))), options.runs)
    compare("one for", f"for i in 1 .. {options.actions}: step {{i}} 10 min", options.runs)


if __name__ == "__main__":
    main()
