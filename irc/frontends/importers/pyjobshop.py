"""Importer for PyJobShop: the JSON of its `ProblemData`.

A task becomes an action, a job a group, a break a window without capacity. Machines with set-up
times have a family for each task. What is not said this directly has modules of its own.

Source: Lan and Berkhout 2025, "PyJobShop: solving scheduling problems with constraint programming
in Python".
"""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from irc.frontends.importers.instances import Part, read_json
from irc.frontends.importers.pyjobshop_breaks import BreakReader, demands
from irc.frontends.importers.pyjobshop_choices import ChoiceReader, kind_of
from irc.frontends.importers.pyjobshop_jobs import NEVER, JobEnds
from irc.frontends.importers.pyjobshop_orders import OrderReader
from irc.frontends.importers.scheduling_files.projects import stem_of, task_of
from irc.model import Task

_EXPECTED = "expected the JSON of PyJobShop's ProblemData: jobs, resources, tasks, modes"
_LAGS = {
    "start_before_start": ("start-start", False),
    "start_before_end": ("start-finish", False),
    "end_before_start": ("finish-start", False),
    "end_before_end": ("finish-finish", False),
    "start_at_start": ("start-start", True),
    "start_at_end": ("start-finish", True),
    "end_at_start": ("finish-start", True),
    "end_at_end": ("finish-finish", True),
}
_OBJECTIVES = {
    "weight_makespan": "minimize_makespan",
    "weight_tardy_jobs": "minimize_tardy",
    "weight_total_flow_time": "minimize_flow_time",
    "weight_total_tardiness": "minimize_tardiness",
    "weight_total_earliness": "minimize_earliness",
    "weight_max_tardiness": "minimize_max_tardiness",
    "weight_total_setup_time": "minimize_setup_time",
}


def import_pyjobshop(text: str, name: str) -> Iterator[tuple[str, Task]]:
    """(file stem, task) of a problem. Raises `InputError` with every fault."""
    content, faults = read_json(text, name, hint=_EXPECTED)
    stem = stem_of(name)
    if not isinstance(content, Mapping):
        faults.add(_EXPECTED)
        faults.raise_any()
    problem = Part(content, (), stem, faults)
    _check_shape(problem)
    faults.raise_any()
    document = _Reader(problem).document()
    faults.raise_any()
    yield stem, task_of({"name": stem, **document}, faults.source)


_INDEX_OF = {
    **dict.fromkeys(
        ("task", "task1", "task2", "condition_task", "tasks", "tasks1", "tasks2"), "tasks"
    ),
    **dict.fromkeys(("machine", "machine1", "machine2", "resources"), "resources"),
    **dict.fromkeys(("mode1", "modes2"), "modes"),
    "job": "jobs",
}
"""The fields that hold an index, or a list of them, and the list that it is an index of."""

_TEXTS = ("name", "type")
_FLAGS = ("no_idle", "allow_idle", "allow_breaks", "optional")


def _check_shape(problem: Part) -> None:
    """Adds a fault for each part that has another shape than PyJobShop writes."""
    parts = problem.record(("resources", "tasks", "modes"), ("jobs", "constraints", "objective"))
    lists = {key: parts[key].items() for key in ("jobs", *_LISTS) if key in parts}
    sizes = {key: len(items) for key, items in lists.items()}
    rules = parts["constraints"].members() if "constraints" in parts else {}
    rows = [row for items in lists.values() for row in items]
    rows += [row for part in rules.values() for row in part.items()]
    for row in [*rows, *([parts["objective"]] if "objective" in parts else [])]:
        for key, part in row.members().items():
            _check_field(key, part, sizes)
    for key, required in (("modes", ("task", "resources", "duration")), ("setup_times", _SETUP)):
        for row in lists.get(key) or (rules[key].items() if key in rules else []):
            for name in required:
                if row.members().get(name) is None:
                    row.fault(f"the field '{name}' is missing")


def _check_field(key: str, part: Part, sizes: Mapping[str, int]) -> None:
    value = part.value
    if value is None:
        return
    if key in _TEXTS:
        if not isinstance(value, str):
            part.fault("expected a text")
    elif key in _FLAGS:
        part.flag()
    elif key == "breaks":
        for span in part.items():
            if len(bounds := span.items()) == 2:
                for bound in bounds:
                    bound.whole()
            else:
                span.fault("expected [start, end]")
    else:
        most = sizes.get(_INDEX_OF.get(key, ""))
        for one in part.items() if isinstance(value, list) else [part]:
            if type(one.value) is not int:
                one.fault("expected a whole number")
            elif key in _INDEX_OF and not 0 <= one.value < (most or 0):
                one.fault(f"it is no index of {_INDEX_OF[key]}, which count from 0")


_SETUP = ("machine", "task1", "task2", "duration")


@dataclass
class _Reader:
    """Reads the parts of a problem; what it cannot say is a fault with its place."""

    problem: Part
    names: dict[str, list[str]] = field(default_factory=dict)
    families: set[int] = field(default_factory=set)
    """The machines with set-up times."""

    def document(self) -> dict[str, Any]:
        parts = self.problem.record(
            ("resources", "tasks", "modes"), ("jobs", "constraints", "objective")
        )
        lists = {k: parts[k].items() if k in parts else [] for k in ("jobs", *_LISTS)}
        for kind, what in (("resources", "resource"), ("tasks", "task"), ("jobs", "job")):
            self.names[kind] = _names(lists[kind], what)
        rules = parts["constraints"].members() if "constraints" in parts else {}
        listed = {key: part.items() for key, part in rules.items()}
        for key in sorted(listed.keys() - _KNOWN):
            rules[key].fault("this importer does not know the constraint", key=True)
        setups = self._setups(listed.get("setup_times", ()))
        orders = OrderReader(lists, self.names)
        choices = ChoiceReader(lists, self.names, listed)
        breaks = BreakReader(lists, self.names)
        ends = JobEnds(lists, self.names, parts.get("objective"))
        actions = self._actions(lists, listed, ends, breaks, choices.by_mode)
        document = {
            "resources": [*self._resources(lists["resources"], setups, breaks), *breaks.declared()],
            "actions": [*actions, *breaks.actions, *ends.actions],
            "precedence": [*self._precedence(listed), *breaks.precedence, *ends.precedence],
            "groups": self._groups(lists),
            "couplings": [*choices.couplings, *breaks.couplings],
            "select": [*choices.select, *breaks.select, *ends.select],
            "sequences": [*orders.sequences(listed)],
            "objective": self._objective(parts.get("objective")),
        }
        document["couplings"] += orders.couplings
        document["select"] += orders.select
        return {key: value for key, value in document.items() if value or key == "actions"}

    # --- resources ---

    def _setups(self, rows: Sequence[Part]) -> dict[int, list[dict[str, Any]]]:
        found: dict[int, list[dict[str, Any]]] = {}
        for row in rows:
            machine = self._index(row, "machine")
            before, after = (self._task(row, key) for key in ("task1", "task2"))
            time = row.members()["duration"].whole() or 0
            found.setdefault(machine, []).append({"from": before, "to": after, "time": time})
        self.families = set(found)
        return found

    def _resources(
        self,
        resources: Sequence[Part],
        setups: Mapping[int, list[dict[str, Any]]],
        breaks: BreakReader,
    ) -> list[dict[str, Any]]:
        found = []
        for k, part in enumerate(resources):
            value, id, kind = part.value, self.names["resources"][k], kind_of(part.value)
            if kind == "consumable":
                initial = part.members()["capacity"].whole() or 0
                found.append({"id": id, "kind": "reservoir", "initial": initial})
                continue
            capacity = 1 if kind == "machine" else part.members()["capacity"].whole() or 0
            windows = breaks.windows(k)
            found.append(
                {
                    "id": id,
                    "capacity": capacity,
                    **({"availability": windows} if windows else {}),
                    **({"no_idle": True} if value.get("no_idle") else {}),
                    **({"setups": {"times": setups[k]}} if k in setups else {}),
                }
            )
        return found

    # --- actions ---

    def _actions(
        self,
        lists: Mapping[str, Sequence[Part]],
        rules: Mapping[str, Sequence[Part]],
        ends: JobEnds,
        breaks: BreakReader,
        by_mode: Container[int],
    ) -> list[dict[str, Any]]:
        modes: dict[int, list[tuple[int, Part]]] = {}
        for m, part in enumerate(lists["modes"]):
            modes.setdefault(self._index(part, "task"), []).append((m, part))
        horizon = _horizon(lists, rules)
        found = []
        for k, part in enumerate(lists["tasks"]):
            if k not in modes:
                part.fault("the task has no mode")
                continue
            idles = breaks.may_idle(k)
            apart = idles and breaks.process(k, modes[k])
            ways = [
                (m, self._way(mode, horizon if idles else None, None if apart else breaks))
                for m, mode in modes[k]
            ]
            action = {"id": self.names["tasks"][k], **self._limits(part, lists["jobs"], ends)}
            if part.value.get("allow_breaks") and not apart:
                action["breaks"] = "pause"
            if part.value.get("optional"):
                action["occurs"] = "optional"
            if len(ways) == 1 and not apart and k not in by_mode:
                found.append({**action, **ways[0][1]})
            else:
                found.append({**action, "modes": [{"id": f"mode {m}", **way} for m, way in ways]})
        return found

    def _way(self, mode: Part, horizon: int | None, breaks: BreakReader | None) -> dict[str, Any]:
        """A mode: its duration, or a range where the task may idle, and what it takes.

        Without `breaks`, another action uses what its breaks need.
        """
        duration = mode.members()["duration"].whole() or 0
        uses: list[dict[str, Any]] = []
        consumes: list[dict[str, Any]] = []
        for k, demand in demands(mode):
            kind = kind_of(self.problem.value["resources"][k])
            one: dict[str, Any] = {"resource": self.names["resources"][k]}
            if kind == "machine":
                name = self.names["tasks"][mode.value["task"]]
                uses.append({**one, "family": name} if k in self.families else one)
            elif demand and kind == "consumable":
                consumes.append({**one, "amount": demand})
            elif demand:
                uses.append({**one, "amount": demand})
            if breaks is not None:
                uses += breaks.open(k, demand)
        length = duration if horizon is None else {"min": duration, "max": duration + horizon}
        return {
            "duration": length,
            **({"uses": uses} if uses else {}),
            **({"consumes": consumes} if consumes else {}),
        }

    def _limits(self, part: Part, jobs: Sequence[Part], ends: JobEnds) -> dict[str, Any]:
        value = part.value
        release = value.get("earliest_start") or 0
        if value.get("job") is not None:
            release = max(release, jobs[value["job"]].value.get("release_date") or 0)
        limits = {
            "release": release,
            "latest_start": value.get("latest_start"),
            "earliest_end": value.get("earliest_end"),
            "deadline": ends.deadline(value),
        }
        default = {"release": 0, "earliest_end": 0}
        return {
            k: v for k, v in limits.items() if v is not None and v != default.get(k) and v < NEVER
        }

    # --- jobs, order, choices, objective ---

    def _groups(self, lists: Mapping[str, Sequence[Part]]) -> list[dict[str, Any]]:
        members: dict[int, list[int]] = {}
        for k, part in enumerate(lists["tasks"]):
            if part.value.get("job") is not None:
                members.setdefault(part.value["job"], []).append(k)
        found = []
        for j, part in enumerate(lists["jobs"]):
            tasks = members.get(j) or part.value.get("tasks") or []
            if not tasks:
                continue
            deadline, due = part.value.get("deadline"), part.value.get("due_date")
            bound = {
                **({"deadline": deadline} if deadline is not None and deadline < NEVER else {}),
                **({"due": due} if due is not None else {}),
            }
            if any(lists["tasks"][k].value.get("optional") for k in tasks):
                continue  # `JobEnds` says its dates.
            actions = [self.names["tasks"][k] for k in tasks]
            weight = part.value.get("weight")
            more = {"weight": weight} if weight is not None and weight != 1 else {}
            found.append({"id": self.names["jobs"][j], "actions": actions, **bound, **more})
        return found

    def _precedence(self, rules: Mapping[str, Sequence[Part]]) -> Iterator[dict[str, Any]]:
        for key, (kind, exact) in _LAGS.items():
            for row in rules.get(key, ()):
                delay = row.value.get("delay") or 0
                yield {
                    "before": self._task(row, "task1"),
                    "after": self._task(row, "task2"),
                    "type": kind,
                    "min_lag": delay,
                    **({"max_lag": delay} if exact else {}),
                }

    def _objective(self, part: Part | None) -> list[Any]:
        weights = {} if part is None else part.value
        terms = [
            (weight, name) for key, name in _OBJECTIVES.items() if (weight := weights.get(key) or 0)
        ]
        if not terms:
            return ["minimize_makespan"]
        if len(terms) == 1:
            return [terms[0][1]]
        return [{"sum": [[weight, name] for weight, name in terms]}]

    # --- indexes ---

    def _index(self, part: Part, key: str) -> int:
        """The index in a field of a part; 0 and a fault where it is missing."""
        value = part.value.get(key)
        if isinstance(value, int):
            return value
        part.fault(f"the field '{key}' is missing")
        return 0

    def _task(self, part: Part, key: str) -> str:
        return self.names["tasks"][self._index(part, key)]


_LISTS = ("resources", "tasks", "modes")
_DATES = (
    *("earliest_start", "latest_start", "earliest_end", "latest_end"),
    *("release_date", "deadline", "due_date"),
)
_KNOWN = frozenset(
    [
        *_LAGS,
        *("identical_resources", "different_resources", "consecutive", "same_sequence"),
        *("setup_times", "mode_dependencies", "select_all_or_none", "select_at_least_one"),
        "select_exactly_one",
    ]
)


def _names(parts: Sequence[Part], what: str) -> list[str]:
    """A name of its own for each part: the one that it has, or its kind and number."""
    found: list[str] = []
    for k, part in enumerate(parts):
        given = part.value.get("name") if isinstance(part.value, Mapping) else None
        name = given if isinstance(given, str) and given else f"{what} {k}"
        while name in found:
            name += f" ({what} {k})"
        found.append(name)
    return found


def _horizon(lists: Mapping[str, Sequence[Part]], rules: Mapping[str, Sequence[Part]]) -> int:
    """Enough time to idle: all durations, set-ups, delays, breaks and dates together."""
    rows = [*lists["modes"], *(row for listed in rules.values() for row in listed)]
    lengths = [abs(row.value.get(key) or 0) for row in rows for key in ("duration", "delay")]
    breaks = [b for part in lists["resources"] for b in part.value.get("breaks") or ()]
    parts = [*lists["tasks"], *lists["jobs"]]
    dates = [part.value.get(key) or 0 for part in parts for key in _DATES]
    known = [date for date in dates if date < NEVER]
    return int(sum(lengths) + max([0, *(end for _, end in breaks)]) + max([0, *known]))
