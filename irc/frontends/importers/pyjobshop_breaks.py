"""PyJobShop's breaks where the IR's windows of a resource do not say them.

Breaks bind each mode that names the resource, also one that takes nothing of it, and they are
there for stock. A task that may idle does so after its processing; breaks bind the processing, not
the idling. So a resource of its own stands for being open, and what the breaks bind uses it: modes
that hold nothing of the resource, and the processing of tasks that idle, an action of its own.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from irc.frontends.importers.instances import Part
from irc.frontends.importers.pyjobshop_choices import kind_of

Ways = Sequence[tuple[int, Part]]
"""The modes of a task, each with its index."""


class BreakReader:
    """Says what is used for the breaks of resources.

    Its `actions`, `precedence`, `couplings` and `select` are those of the processing of tasks that
    may idle.
    """

    def __init__(
        self, lists: Mapping[str, Sequence[Part]], names: Mapping[str, Sequence[str]]
    ) -> None:
        self.names = names
        self.resources = lists["resources"]
        self.tasks = lists["tasks"]
        self.actions: list[dict[str, Any]] = []
        self.precedence: list[dict[str, Any]] = []
        self.couplings: list[dict[str, Any]] = []
        self.select: list[dict[str, Any]] = []
        self._idled = {
            k
            for mode in lists["modes"]
            for k in mode.value["resources"]
            if self.may_idle(mode.value["task"]) and self._has_breaks(k)
        }
        self._opened: dict[int, str] = {}

    def may_idle(self, task: int) -> bool:
        """Whether a task may go on holding what it holds after its processing."""
        return bool(self.tasks[task].value.get("allow_idle"))

    def windows(self, resource: int) -> list[dict[str, Any]]:
        """The windows of a resource itself."""
        return [] if resource in self._idled else self._windows(resource)

    def open(self, resource: int, demand: int) -> list[dict[str, Any]]:
        """The uses of a mode that names a resource for its breaks, besides the resource itself."""
        kind = kind_of(self.resources[resource].value)
        held = kind == "machine" or (kind == "renewable" and demand)
        if not self._has_breaks(resource) or (held and resource not in self._idled):
            return []
        id = f"{self.names['resources'][resource]} open"
        while id in self.names["resources"]:
            id += " (breaks)"
        return [{"resource": self._opened.setdefault(resource, id)}]

    def declared(self) -> list[dict[str, Any]]:
        """The resources that stand for being open, of those that anything uses."""
        users = max(1, len(self.tasks))
        return [
            {"id": id, "capacity": users, "availability": self._windows(k)}
            for k, id in self._opened.items()
        ]

    def process(self, task: int, ways: Ways) -> bool:
        """Adds the processing of a task that idles as an action; whether breaks make it needed."""
        opened = [
            [use for k, demand in demands(mode) for use in self.open(k, demand)] for _, mode in ways
        ]
        if not any(opened):
            return False
        whole = self.names["tasks"][task]
        name = f"{whole} processing"
        while name in self.names["tasks"]:
            name += " (of a task)"
        value = self.tasks[task].value
        optional = {"occurs": "optional"} if value.get("optional") else {}
        pause = {"breaks": "pause"} if value.get("allow_breaks") else {}
        modes = [
            {"id": f"mode {m}", "duration": mode.value["duration"], "uses": uses}
            for (m, mode), uses in zip(ways, opened, strict=True)
        ]
        self.actions.append({"id": name, **optional, **pause, "modes": modes})
        pair = {"before": whole, "after": name}
        self.precedence += [
            {**pair, "type": "start-start", "max_lag": 0},
            {"before": name, "after": whole, "type": "finish-finish"},
        ]
        self.couplings.append({"same": "mode", "actions": [whole, name]})
        if optional:
            self.select.append({"actions": [whole, name], "all_or_none": True})
        return True

    def _has_breaks(self, resource: int) -> bool:
        return bool(self.resources[resource].value.get("breaks"))

    def _windows(self, resource: int) -> list[dict[str, Any]]:
        breaks = self.resources[resource].value.get("breaks") or []
        return [{"from": a, "to": b, "capacity": 0} for a, b in sorted(map(tuple, breaks))]


def demands(mode: Part) -> list[tuple[int, int]]:
    """(resource, how much of it) of a mode; of a machine there is but one."""
    resources = mode.value["resources"]
    return list(zip(resources, mode.value.get("demands") or [0] * len(resources), strict=False))
