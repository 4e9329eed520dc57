"""The few constructs of MiniZinc that the example backend writes, evaluated by their meaning.

A model is declarations, constraints (`forall`, comparisons, sums, `/\\`, `\\/`) and
`solve minimize makespan`; data are integers, arrays and sets of integers. Run as a program it is a
`minizinc` for such models: it prints better and better solutions, and proves the last one.
"""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterator, Mapping
from itertools import product
from pathlib import Path
from typing import Any

_FORALL = re.compile(
    r"forall \((\w+(?:, \w+)*) in ([^()]+?)(?: where ([^()]+))?\) \((.*)\)", re.DOTALL
)


class Array(dict[int, Any]):
    """An array, whose indexes begin at 1; any other index is an error."""


def read_data(text: str) -> dict[str, Any]:
    """The values in a data file."""
    values: dict[str, Any] = {}
    for name, written in re.findall(r"(\w+) = ([^;]+);\n", text):
        value = ast.literal_eval(written.replace("{}", "set()"))
        values[name] = Array(enumerate(value, 1)) if isinstance(value, list) else value
    return values


def constraints_of(model: str) -> list[Any]:
    """The constraints of a model, each as compiled Python."""
    text = re.sub(r"%[^\n]*", "", model)
    found = re.findall(r"constraint (.*?);", text, re.DOTALL)
    return [compile(_as_python(one), "<model>", "eval") for one in found]


def holds(constraints: list[Any], values: Mapping[str, Any]) -> bool:
    """Whether values for all variables satisfy all constraints."""
    names = {"__builtins__": {"all": all, "range": range}, **values}
    return all(eval(one, names) for one in constraints)


def _as_python(text: str) -> str:
    match = _FORALL.fullmatch(text.strip())
    if match is None:
        if "forall" in text:
            raise ValueError(f"not in the subset: {text}")
        return "(" + text.strip().replace("\\/", " or ").replace("/\\", " and ") + ")"
    names, over, where, body = match.groups()
    over = re.sub(r"^1\.\.(\w+)$", r"range(1, \1 + 1)", over)
    loops = " ".join(f"for {name} in {over}" for name in names.split(", "))
    return f"all({_as_python(body)} {loops}{f' if {where}' if where else ''})"


def solutions(model: str, data: Mapping[str, Any]) -> Iterator[dict[int, int]]:
    """Better and better solutions; the last one is the best.

    Some best solution begins each job as early as some order of the jobs on each machine allows, so
    all such orders are tried. Each solution is judged by the constraints of the model.
    """
    constraints, best = constraints_of(model), data["horizon"] + 1
    pairs = [(i, j) for jobs in data["on"].values() for i in jobs for j in jobs if i < j]
    for turned in product((False, True), repeat=len(pairs)):
        before = [(j, i) if turn else (i, j) for (i, j), turn in zip(pairs, turned, strict=True)]
        start = _earliest(data, before)
        if start is None:
            continue
        makespan = max((start[j] + data["duration"][j] for j in start), default=0)
        values = {**data, "start": start, "makespan": makespan}
        if makespan < best and holds(constraints, values):
            best = makespan
            yield start


def _earliest(data: Mapping[str, Any], before: list[tuple[int, int]]) -> dict[int, int] | None:
    """The earliest starts, None for a cycle."""
    arcs = [(data["before"][k], data["after"][k], data["lag"][k]) for k in data["before"]]
    arcs += [(i, j, 0) for i, j in before]
    start = Array(data["release"])
    for _ in range(len(start) + 1):
        later = dict(start)
        for i, j, lag in arcs:
            later[j] = max(later[j], later[i] + data["duration"][i] + lag)
        if later == start:
            return start
        start = Array(later)
    return None


def main() -> None:
    """Solves `model.mzn` with `data.dzn` in the current folder."""
    model, data = Path("model.mzn").read_text(), read_data(Path("data.dzn").read_text())
    found = False
    for start in solutions(model, data):
        found = True
        print("".join(f"job {j} {time}\n" for j, time in start.items()) + "-" * 10)
    print("=" * 10 if found else "=====UNSATISFIABLE=====")


if __name__ == "__main__":
    sys.exit(main())
