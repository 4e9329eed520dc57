"""The data folder of the evaluation: gold instances and recorded answers, as they stand there."""

from __future__ import annotations

import gzip
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from irc.diagnostics import Code, Findings, InputError, Report
from irc.frontends.json.value import read_line

Record = Mapping[str, Any]
"""One recorded answer: a line of a file of `recorded/answers`."""

_TEXT: tuple[type, ...] = (str, type(None))
_NUMBER: tuple[type, ...] = (int, float, type(None))
_FIELDS: Mapping[str, Mapping[str, tuple[type, ...]]] = {
    "xxl": {"n": (int,), "pos": (int,)},
    "robo": {"id": (str,), "success": (bool,)},
    "online": {"id": (str,), "success": (bool,), "error_type": _TEXT, "final_plan": _TEXT},
    "asynchow": {"pos": (int,)},
    "planner": {"answer": _TEXT},
    "cpsat": {"answer": _TEXT, "recorded_makespan": _NUMBER},
    "pddl": {"outcome": (str,), "plan": (list, type(None))},
}
"""By the first and the last word of a file's name: the fields of its lines, with their types."""

_GRAPHS = "asyncplan_xxl"
_ANSWERS = Path("recorded", "answers")


@dataclass(frozen=True)
class StepInstance:
    """An instance of AsyncPlan-XXL: gold durations and edges by the number of the step.

    `by_order` are the same with steps numbered in Kahn's order of the nodes, which is what one
    of the paper's scripts takes for the number of the step.
    """

    size: int
    position: int
    durations: Mapping[int, int]
    edges: frozenset[tuple[int, int]]
    makespan: int
    texts: Mapping[int, str]
    by_order: tuple[Mapping[int, int], frozenset[tuple[int, int]]]


_STEP = re.compile(r"^\s*Step (\d+)\.\s*(.*?)\s*(?:\([^()]*\))?\s*$", re.MULTILINE)


def step_instance(raw: Mapping[str, Any], size: int, position: int) -> StepInstance:
    """The gold graph of an instance as it stands in the data."""
    graph = raw["graph"]
    node_of = {int(step): node for step, node in graph["step_to_node"].items()}
    step_of = {node: step for step, node in node_of.items()}
    durations, edges = graph["durations"], [(a, b) for a, b in graph["edges"]]
    number = {node: k for k, node in enumerate(kahn_order(len(durations), edges), 1)}
    return StepInstance(
        size,
        position,
        {step: durations[node] for step, node in node_of.items()},
        frozenset((step_of[a], step_of[b]) for a, b in edges),
        raw["answer"],
        {int(k): text for k, text in _STEP.findall(raw.get("question", ""))},
        (
            {number[node]: duration for node, duration in enumerate(durations)},
            frozenset((number[a], number[b]) for a, b in edges),
        ),
    )


def read_instance(path: Path, raw: Mapping[str, Any], size: int, position: int) -> StepInstance:
    """The gold graph of an instance. Raises `InputError` where it is not of AsyncPlan-XXL."""
    try:
        return step_instance(raw, size, position)
    except (KeyError, IndexError, TypeError, ValueError, AttributeError) as error:
        reason = f"instance {position + 1} is not one of AsyncPlan-XXL ({error!r})"
        raise unreadable(path, reason) from None


def kahn_order(size: int, edges: list[tuple[int, int]]) -> list[int]:
    """The nodes in the order of Kahn (1962): first in, first out, by number at the start."""
    waiting = [0] * size
    after: dict[int, list[int]] = {}
    for a, b in edges:
        waiting[b] += 1
        after.setdefault(a, []).append(b)
    order = [node for node in range(size) if not waiting[node]]
    for node in order:
        for following in after.get(node, ()):
            waiting[following] -= 1
            if not waiting[following]:
                order.append(following)
    return order


@dataclass
class Data:
    """The folder, read where it is asked for.

    `change`, where it is given, replaces the records of a file: (name, records) → records.
    """

    folder: Path
    change: Callable[[str, list[Record]], list[Record]] | None = None
    _graphs: dict[int, list[Any]] = field(default_factory=dict)
    _steps: dict[tuple[int, int], StepInstance] = field(default_factory=dict)

    def records(self, name: str) -> list[Record]:
        """The recorded answers of a file, such as `xxl_planner`; none where it is absent."""
        path = self.folder / _ANSWERS / f"{name}.jsonl.gz"
        if not path.is_file():
            return []
        try:
            with gzip.open(path, "rt", encoding="utf-8") as lines:
                found: list[Record] = [*_lines(path, lines)]
        except (OSError, EOFError, UnicodeDecodeError) as error:
            raise unreadable(path, str(error)) from None
        _check(path, found, _fields_of(name))
        return found if self.change is None else self.change(name, found)

    def steps(self, size: int, position: int) -> StepInstance:
        """The gold instance of AsyncPlan-XXL at a 0-based position of a size's file."""
        key = (size, position)
        if key not in self._steps:
            path = self.folder / _GRAPHS / f"nodes{size}.json"
            if size not in self._graphs:
                self._graphs[size] = _json(path)
            if not 0 <= position < len(self._graphs[size]):
                raise unreadable(path, f"there is no instance at position {position}")
            raw = self._graphs[size][position]
            self._steps[key] = read_instance(path, raw, size, position)
        return self._steps[key]

    @cached_property
    def asynchow(self) -> Mapping[int, Mapping[str, Any]]:
        """The instances of AsyncHow by 0-based position, which is the `id` less one."""
        files = sorted(self.folder.glob("asynchow*.json"))
        return {item["id"] - 1: item for path in files for item in _json(path)}

    @cached_property
    def kitchens(self) -> Mapping[str, Mapping[str, Any]]:
        """The instances of Robo Challenge by id."""
        return {item["id"]: item for item in self._folder("robo_challenge")}

    @cached_property
    def episodes(self) -> Mapping[str, Mapping[str, Any]]:
        """The episodes of Online Robo Challenge by id."""
        return {item["id"]: item for item in self._folder("robo_online")}

    @cached_property
    def errata(self) -> list[dict[str, object]]:
        """The instances of AsyncPlan-XXL whose gold is known to be wrong."""
        path = self.folder / "errata.json"
        found = _json(path).get(_GRAPHS, []) if path.is_file() else []
        return [dict(item) for item in found]

    def _folder(self, name: str) -> Iterator[Mapping[str, Any]]:
        for path in sorted((self.folder / name).glob("*.json")):
            found = _json(path)
            if not isinstance(found, dict) or "id" not in found:
                raise unreadable(path, "expected an object with an 'id'")
            yield found

    def instance(self, kind: Mapping[Any, Any], key: str | int, folder: str) -> Any:
        """An instance by its key. Raises `InputError` naming what is absent."""
        if key not in kind:
            raise unreadable(self.folder / folder, f"there is no instance {key!r}")
        return kind[key]


def _lines(path: Path, lines: Iterable[str]) -> Iterator[Any]:
    for position, line in enumerate(lines, 1):
        try:
            yield read_line(line)
        except ValueError as error:
            raise unreadable(path, f"line {position}: {error}") from None


def _fields_of(name: str) -> Mapping[str, tuple[type, ...]]:
    """The fields that the lines of a file must have."""
    benchmark, *_, method = name.split("_")
    if benchmark == "online":
        return {"model": (str,), **_FIELDS["online"]}
    if benchmark == "robo":
        text = "answer" if method == "planner" else "plan"
        domain = {"domain": _TEXT} if method == "pddl" else {}
        return {"model": (str,), **_FIELDS["robo"], text: _TEXT, **domain}
    return {"model": (str,), **_FIELDS[benchmark], **_FIELDS[method]}


def _check(path: Path, records: list[Record], fields: Mapping[str, tuple[type, ...]]) -> None:
    """Raises `InputError` at the first line that lacks a field, or has another type there."""
    for position, record in enumerate(records, 1):
        if not isinstance(record, dict):
            raise unreadable(path, f"line {position} is not an object")
        for name, types in fields.items():
            if name not in record or not isinstance(record[name], types):
                raise unreadable(path, f"line {position}: field {name!r} is missing or unusable")


def _json(path: Path) -> Any:
    try:
        return read_line(path.read_text("utf-8"))
    except (OSError, ValueError) as error:
        raise unreadable(path, str(error)) from None


def unreadable(path: Path, reason: str) -> InputError:
    """The error that says which file of the data cannot be used, and why."""
    findings = Findings()
    findings.add(Code.UNREADABLE, f"{path}: {reason}", hint="see docs/evaluation.md for the data")
    return InputError(Report(tuple(findings.items)))
