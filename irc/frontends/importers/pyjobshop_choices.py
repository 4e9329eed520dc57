"""PyJobShop's identical and different resources, dependent modes and selections.

PyJobShop compares all resources that modes name, those of which they take nothing and stock
included. Where modes name such ones, the modes that go together are listed instead.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from irc.frontends.importers.instances import Part

Rule = dict[str, Any]


class ChoiceReader:
    """Reads rules about choices.

    Its `couplings` and `select` are those of the task, `by_mode` the tasks whose modes they name.
    """

    def __init__(
        self,
        lists: Mapping[str, Sequence[Part]],
        names: Mapping[str, Sequence[str]],
        rules: Mapping[str, Sequence[Part]],
    ) -> None:
        self.names = names["tasks"]
        self.tasks = lists["tasks"]
        self.modes = lists["modes"]
        self.kinds = [kind_of(part.value) for part in lists["resources"]]
        self.owned: dict[int, list[int]] = {}
        for m, mode in enumerate(self.modes):
            self.owned.setdefault(mode.value["task"], []).append(m)
        self.by_mode: set[int] = set()
        self.couplings: list[Rule] = []
        self.select: list[Rule] = []
        for row in rules.get("identical_resources", ()):
            self._resources(row, same=True)
        for row in rules.get("different_resources", ()):
            self._resources(row, same=False)
        for row in rules.get("mode_dependencies", ()):
            self._dependency(row)
        self.select += self._selections(rules)

    def _resources(self, row: Part, same: bool) -> None:
        one, other = (row.value.get(key) for key in ("task1", "task2"))
        if one is None or other is None or one == other:
            row.fault("expected two tasks in 'task1' and 'task2'")
            return
        pair = [self.names[one], self.names[other]]
        optional = any(self.tasks[k].value.get("optional") for k in (one, other))
        if same and optional and any(self._named(m) for k in (one, other) for m in self._of(k)):
            self.select.append({"actions": pair, "all_or_none": True})
        if all(self._holds_all(m) for k in (one, other) for m in self._of(k)):
            self.couplings.append({"same" if same else "different": "resource", "actions": pair})
            return
        self.by_mode |= {one, other}
        for m in self._of(one):
            for n in self._of(other):
                first, second = self._named(m), self._named(n)
                if not (first == second if same else first.isdisjoint(second)):
                    self._forbid(m, n)

    def _forbid(self, m: int, n: int) -> None:
        """Adds that two modes of two tasks are not chosen together."""
        for first, second in ((m, n), (n, m)):
            task = self.modes[second].value["task"]
            if others := [f"mode {k}" for k in self._of(task) if k != second]:
                then = {"action": self.names[task], "modes": others}
                self.couplings.append({"if": self._choice(first), "then": then})
                return
        tasks = [self.names[self.modes[k].value["task"]] for k in (m, n)]
        self.select.append({"actions": tasks, "max": 1})

    def _choice(self, mode: int) -> Rule:
        return {"action": self.names[self.modes[mode].value["task"]], "mode": f"mode {mode}"}

    def _dependency(self, row: Part) -> None:
        first, others = row.value["mode1"], row.value["modes2"]
        owners = {self.modes[m].value["task"] for m in others}
        if len(owners) != 1:
            row.fault("the modes that it allows are those of several tasks")
            return
        (owner,) = owners
        self.by_mode |= {owner, self.modes[first].value["task"]}
        allowed = [f"mode {m}" for m in others]
        then = {"action": self.names[owner], "modes": allowed}
        self.couplings.append({"if": self._choice(first), "then": then})

    def _selections(self, rules: Mapping[str, Sequence[Part]]) -> Iterator[Rule]:
        for key, bounds in (
            ("select_at_least_one", {"min": 1}),
            ("select_exactly_one", {"min": 1, "max": 1}),
            ("select_all_or_none", {"all_or_none": True}),
        ):
            for row in rules.get(key, ()):
                task = row.value.get("condition_task")
                condition = {} if task is None else {"if": self.names[task]}
                actions = [self.names[k] for k in row.value["tasks"]]
                yield {"actions": actions, **bounds, **condition}

    def _of(self, task: int) -> Sequence[int]:
        return self.owned.get(task, ())

    def _named(self, mode: int) -> frozenset[int]:
        return frozenset(self.modes[mode].value["resources"])

    def _holds_all(self, mode: int) -> bool:
        """Whether a mode holds each resource that it names, in the sense of the IR."""
        value = self.modes[mode].value
        demands = value.get("demands") or [0] * len(value["resources"])
        return all(
            self.kinds[k] == "machine" or (self.kinds[k] == "renewable" and demand)
            for k, demand in zip(value["resources"], demands, strict=False)
        )


def kind_of(resource: Mapping[str, Any]) -> str:
    """The kind of a resource: "machine", "renewable" or "consumable"."""
    given = resource.get("type") or ("renewable" if "capacity" in resource else "machine")
    return str(given)
