"""PyJobShop's `consecutive` tasks and `same_sequence` of machines as orders of uses.

PyJobShop gives each pair of tasks the same arc on both machines, that of a task to itself included,
which means that it is not there. So of each pair either both tasks use their machines or neither
does: a coupling or a selection says that, where it can be otherwise.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from irc.frontends.importers.instances import Part
from irc.frontends.importers.pyjobshop_choices import kind_of


class OrderReader:
    """Reads orders of uses; `couplings` and `select` say what has to be there for them."""

    def __init__(
        self, lists: Mapping[str, Sequence[Part]], names: Mapping[str, Sequence[str]]
    ) -> None:
        self.names = names
        self.couplings: list[dict[str, Any]] = []
        self.select: list[dict[str, Any]] = []
        self.tasks = lists["tasks"]
        self.modes: dict[int, list[Mapping[str, Any]]] = {}
        for mode in lists["modes"]:
            self.modes.setdefault(mode.value["task"], []).append(mode.value)
        self.machines = {
            k for k, part in enumerate(lists["resources"]) if kind_of(part.value) == "machine"
        }

    def sequences(self, rules: Mapping[str, Sequence[Part]]) -> Iterator[dict[str, Any]]:
        """The orders of uses of a problem."""
        for row in rules.get("consecutive", ()):
            yield from self._consecutive(row)
        for row in rules.get("same_sequence", ()):
            if (order := self._same_order(row)) is not None:
                yield order

    def _consecutive(self, row: Part) -> Iterator[dict[str, Any]]:
        pair = self._indexes(row, "task1", "task2")
        if pair is None or not self._take_time(row, pair):
            return
        held = [{m for mode in self.modes.get(k, ()) for m in mode["resources"]} for k in pair]
        for machine in sorted(held[0] & held[1] & self.machines):
            tasks = [self.names["tasks"][k] for k in pair]
            yield {"consecutive": tasks, "resource": self.names["resources"][machine]}

    def _same_order(self, row: Part) -> dict[str, Any] | None:
        machines = self._indexes(row, "machine1", "machine2")
        if machines is None:
            return None
        columns = []
        for machine, key in zip(machines, ("tasks1", "tasks2"), strict=True):
            if machine not in self.machines:
                row.fault(f"resource {self.names['resources'][machine]!r} is no machine")
                return None
            given = row.value.get(key)
            users = [k for k in sorted(self.modes) if self._uses(k, machine)]
            columns.append(users if given is None else given)
        if len(columns[0]) != len(columns[1]):
            row.fault("the two machines must have equally many tasks")
            return None
        if not self._take_time(row, [k for column in columns for k in column]):
            return None
        for one, other in zip(*columns, strict=True):
            self._both_or_neither(row, (one, machines[0]), (other, machines[1]))
        names = self.names["tasks"]
        return {
            "same_order": [self.names["resources"][m] for m in machines],
            "jobs": [[names[a], names[b]] for a, b in zip(*columns, strict=True)],
        }

    def _both_or_neither(self, row: Part, one: tuple[int, int], other: tuple[int, int]) -> None:
        """Adds that both tasks use their machines, or neither does."""
        always = all(self._always(task, machine) for task, machine in (one, other))
        optional = any(self.tasks[task].value.get("optional") for task, _ in (one, other))
        if one[0] == other[0] and all(self._alike(one[0], one[1], other[1])):
            return
        if optional and always:
            tasks = [self.names["tasks"][task] for task, _ in (one, other)]
            self.select.append({"actions": tasks, "all_or_none": True})
        elif optional or (one[0] == other[0] and not always):
            row.fault(
                "the IR cannot say that an optional task with a choice of machines has the place "
                "of another one"
            )
        elif not always:
            made = [
                {"action": self.names["tasks"][task], "resource": self.names["resources"][machine]}
                for task, machine in (one, other)
            ]
            self.couplings += [
                {"if": made[0], "then": made[1]},
                {"if": made[1], "then": made[0]},
            ]

    def _alike(self, task: int, one: int, other: int) -> Iterator[bool]:
        """For each mode of a task, whether it uses both of two machines or neither."""
        for mode in self.modes.get(task, ()):
            yield (one in mode["resources"]) == (other in mode["resources"])

    def _uses(self, task: int, machine: int) -> bool:
        return any(machine in mode["resources"] for mode in self.modes.get(task, ()))

    def _always(self, task: int, machine: int) -> bool:
        return all(machine in mode["resources"] for mode in self.modes.get(task, ()))

    def _take_time(self, row: Part, tasks: Sequence[int]) -> bool:
        """Whether all tasks take some time; what takes none has no place in an order of the IR."""
        if all(mode["duration"] for task in tasks for mode in self.modes.get(task, ())):
            return True
        row.fault("a task that takes no time has no place in an order of uses of the IR")
        return False

    @staticmethod
    def _indexes(row: Part, *keys: str) -> list[int] | None:
        found = [row.value.get(key) for key in keys]
        for key, value in zip(keys, found, strict=True):
            if not isinstance(value, int):
                row.fault(f"the field '{key}' is missing")
                return None
        return [value for value in found if isinstance(value, int)]
