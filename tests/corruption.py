"""Recorded answers made worse in four ways, and the figures that differ then."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping
from typing import Any

from irc.evaluation.data import Data, Record
from irc.evaluation.figure import Table, number, walk
from irc.evaluation.scored import Scored
from irc.evaluation.tables import all_tables
from paths import SHARED_DATA

Path = tuple[str, ...]
FACTOR = 24


def few(name: str, records: list[Record]) -> list[Record]:
    """The records of one small size, the easy kitchens, and the first questions.

    (No run of model-written PDDL succeeds in an easy episode, so others are kept of it, too.)
    """
    if name == "online_pddl":
        return [r for r in records if "easy" in r["id"] or "hard_temporal" in r["id"]]
    if name.startswith("asynchow"):
        return [r for r in records if r["pos"] < 20]
    if name.startswith(("robo", "online")):
        return [r for r in records if "easy" in r["id"]]
    size = 5 if name in ("xxl_planner", "xxl_cpsat") else 10
    return [r for r in records if r["n"] == size]


def figures(scored: Scored) -> dict[Path, float]:
    """All figures of the tables by the names that lead to them."""
    tables: Mapping[str, Table] = all_tables(scored)
    return {path: number(figure) for path, figure in walk(tables)}


_KNOWN: list[tuple[Scored, dict[Path, float]]] = []
"""Answers whose figures have been computed."""


def _figures_of(base: Scored) -> dict[Path, float]:
    """The figures of answers that many tests share."""
    for scored, known in _KNOWN:
        if scored is base:
            return known
    _KNOWN.append((base, figures(base)))
    return _KNOWN[-1][1]


def differing(base: Scored, file: str, position: int, record: Record) -> set[Path]:
    """The figures that are others once a record of a file is replaced."""

    def change(name: str, records: list[Record]) -> list[Record]:
        kept = few(name, records)
        return [*kept[:position], record, *kept[position + 1 :]] if name == file else kept

    changed = Scored(Data(SHARED_DATA, change))
    for name, rows in vars(base).items():
        if name != "data" and name not in ATTRIBUTES[file]:
            setattr(changed, name, rows)
    before, after = _figures_of(base), figures(changed)
    return {path for path in before.keys() | after.keys() if before.get(path) != after.get(path)}


ATTRIBUTES: dict[str, tuple[str, ...]] = {
    "xxl_planner": ("planner",),
    "xxl_cpsat": ("cpsat",),
    "xxl_pddl": ("pddl",),
    "xxl_direct_cpsat": ("direct_cpsat",),
    "xxl_direct_pddl": ("direct_pddl",),
    "xxl_nl_cpsat": ("nl_cpsat", "nl_ir"),
    "xxl_nl_pddl": ("nl_pddl",),
    "xxl_gold_pddl": ("gold_pddl", "gold_cpsat"),
    **{
        name: (name,)
        for kind in ("robo", "online")
        for name in (f"{kind}_planner", f"{kind}_pddl", f"{kind}_cpsat")
    },
    **{f"asynchow_{method}": ("asynchow",) for method in ("planner", "pddl", "cpsat")},
}
"""By file: the rows that are made of it."""

# --- graphs as JSON -----------------------------------------------------------------------------


def edges_key(content: Mapping[str, Any]) -> str:
    """The field that holds the edges."""
    return "dependencies" if "dependencies" in content else "precedence"


def with_content(record: Record, change: Callable[[dict[str, Any]], None]) -> Record:
    """The record with another JSON object in its answer."""
    content = json.loads(record["answer"])
    change(content)
    return {**record, "answer": json.dumps(content)}


def without_edge(record: Record, position: int) -> Record:
    """The answer without one of its edges."""

    def drop(content: dict[str, Any]) -> None:
        del content[edges_key(content)][position]

    return with_content(record, drop)


def with_long_step(record: Record, position: int) -> Record:
    """The answer with one of its durations multiplied by 24."""

    def stretch(content: dict[str, Any]) -> None:
        content["actions"][position]["duration"] *= FACTOR

    return with_content(record, stretch)


def turned_round(record: Record) -> Record:
    """The answer with every edge reversed."""

    def turn(content: dict[str, Any]) -> None:
        for edge in content[edges_key(content)]:
            edge["before"], edge["after"] = edge["after"], edge["before"]

    return with_content(record, turn)


def cut(record: Record, field: str = "answer") -> Record:
    """The first half of the answer."""
    return {**record, field: record[field][: len(record[field]) // 2]}


# --- plans ---------------------------------------------------------------------------------------

_LINE = re.compile(r"([\d.]+): (\(.*?\))\s+\[([\d.]+)\]")


def plan_lines(text: str) -> list[tuple[float, str, float]]:
    """(start, activity, duration) of each line."""
    return [(float(s), name, float(d)) for s, name, d in _LINE.findall(text)]


def plan_text(lines: list[tuple[float, str, float]]) -> str:
    """The lines as text."""
    return "\n".join(f"{s:.3f}: {name}  [{d:.3f}]" for s, name, d in lines)


Lines = list[tuple[float, str, float]]


def without_last(lines: Lines) -> Lines:
    """The plan without its last line."""
    return lines[:-1]


def with_long_last(lines: Lines) -> Lines:
    """The plan with the last line's duration multiplied by 24."""
    *rest, (start, name, duration) = lines
    return [*rest, (start, name, duration * FACTOR)]


def backwards(lines: Lines) -> Lines:
    """The plan run backwards in time."""
    end = max(start + duration for start, _, duration in lines)
    return [(end - start - duration, name, duration) for start, name, duration in lines]


def first_half(lines: Lines) -> Lines:
    """The first half of the plan's lines."""
    return lines[: len(lines) // 2]


WORSE_PLANS = (without_last, with_long_last, backwards, first_half)
