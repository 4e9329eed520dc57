"""What is known of a kitchen with orders at a time: documents of the IR, revised by hand."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

Document = dict[str, Any]


@dataclass(frozen=True)
class Run:
    """When an action runs, what it holds, and what became of it."""

    start: Fraction
    end: Fraction
    resources: Mapping[str, int] = field(default_factory=dict)
    status: str | None = None


Plan = Mapping[str, Run]


def plan_of(schedule: Document) -> dict[str, Run]:
    """The entries of a schedule document, by action."""
    return {
        entry["id"]: Run(
            Fraction(entry["start"]),
            Fraction(entry["end"]),
            entry.get("resources", {}),
            entry.get("status"),
        )
        for entry in schedule["actions"]
    }


@dataclass
class Kitchen:
    """A task document in parts. `over` are actions that were cancelled, `seen` those observed."""

    actions: dict[str, Document]
    resources: dict[str, Document]
    groups: dict[str, Document]
    lags: list[tuple[str, str, Fraction, Fraction | None]]
    deadline: Fraction
    objective: list[str]
    windows: dict[str, list[tuple[Fraction, Fraction | None, int]]] = field(default_factory=dict)
    over: set[str] = field(default_factory=set)
    seen: set[str] = field(default_factory=set)

    @classmethod
    def of(cls, task: Document) -> Kitchen:
        kitchen = cls(
            {a["id"]: a for a in task["actions"]},
            {r["id"]: r for r in task["resources"]},
            {g["id"]: g for g in task["groups"]},
            [],
            Fraction(task["deadline"]),
            task["objective"],
        )
        kitchen._order(task["precedence"])
        return kitchen

    def _order(self, precedence: list[Document]) -> None:
        for arc in precedence:
            most = arc.get("max_lag")
            self.lags.append(
                (
                    arc["before"],
                    arc["after"],
                    Fraction(arc.get("min_lag", 0)),
                    None if most is None else Fraction(most),
                )
            )

    # --- questions -------------------------------------------------------------------------------

    def duration(self, name: str) -> Fraction:
        return Fraction(self.actions[name]["duration"])

    def group_of(self, name: str) -> str | None:
        return next((g for g, said in self.groups.items() if name in said["actions"]), None)

    def limit(self, name: str) -> Fraction:
        """When an action must have ended."""
        group = self.group_of(name)
        own = None if group is None else self.groups[group].get("deadline")
        return self.deadline if own is None else min(self.deadline, Fraction(own))

    def capacity(self, resource: str, instant: Fraction) -> int:
        """What was said last counts."""
        for begin, end, capacity in reversed(self.windows.get(resource, [])):
            if begin <= instant and (end is None or instant < end):
                return capacity
        return int(self.resources[resource].get("capacity", 1))

    def half_done(self, begun: Plan) -> list[str]:
        """The orders of which something has begun, and something has not."""
        return [
            g
            for g, said in self.groups.items()
            if 0 < sum(name in begun for name in said["actions"]) < len(said["actions"])
        ]

    def finished(self, plan: Plan) -> list[str]:
        """The orders of which all is there."""
        return [g for g, said in self.groups.items() if all(n in plan for n in said["actions"])]

    def changes(self, name: str, run: Run, stock: str) -> list[tuple[Fraction, int]]:
        """When an action that runs then takes from a stock or adds to it, and how much."""
        action = self.actions[name]
        found = [
            (run.start, -use["amount"])
            for use in action.get("consumes", ())
            if use["resource"] == stock
        ]
        if run.status != "cancelled":
            found += [
                (run.end, made["amount"])
                for made in action.get("produces", ())
                if made["resource"] == stock
            ]
        return found

    # --- events ----------------------------------------------------------------------------------

    def take(self, event: Document, plan: Plan) -> tuple[dict[str, Run], list[str]]:
        """Follows an event. What has begun by then, and the names of new orders."""
        at = Fraction(event["at"])
        begun = {name: run for name, run in plan.items() if run.start < at}
        new: list[str] = []
        for change in event["changes"]:
            match change["op"]:
                case "add_actions":
                    self.actions |= {a["id"]: a for a in change["actions"]}
                case "add_precedence":
                    self._order(change["precedence"])
                case "add_groups":
                    self.groups |= {g["id"]: g for g in change["groups"]}
                    new += [g["id"] for g in change["groups"]]
                case "set_duration":
                    self._lengthen(change, begun, at)
                case "set_capacity":
                    end = change.get("to")
                    window = (at, None if end is None else Fraction(end), change["capacity"])
                    self.windows.setdefault(change["resource"], []).append(window)
                case "set_deadline" if "group" in change:
                    order = self.groups[change["group"]]
                    self.groups[change["group"]] = {**order, "deadline": change["deadline"]}
                case "set_deadline":
                    self.deadline = Fraction(change["deadline"])
                case "cancel_groups":
                    for order in change["groups"]:
                        self._cancel(self.groups.pop(order)["actions"], begun, at)
                case "observe":
                    self._see(change, begun)
                case other:
                    raise ValueError(f"nothing is known of {other!r}")
        return begun, new

    def _lengthen(self, change: Document, begun: dict[str, Run], at: Fraction) -> None:
        name = change["action"]
        self.actions[name] = {**self.actions[name], "duration": change["duration"]}
        run = begun.get(name)
        if run is not None and run.end > at:
            begun[name] = _until(run, run.start + self.duration(name))

    def _cancel(self, names: list[str], begun: dict[str, Run], at: Fraction) -> None:
        self.over |= set(names)
        for name in names:
            run = begun.get(name)
            if run is not None and run.end > at:
                begun[name] = Run(run.start, at, run.resources, "cancelled")

    def _see(self, change: Document, begun: dict[str, Run]) -> None:
        name = change["action"]
        self.seen.add(name)
        run = begun[name]
        start = Fraction(change.get("started", run.start))
        end = Fraction(change["finished"]) if "finished" in change else start + self.duration(name)
        self.actions[name] = {**self.actions[name], "duration": end - start}
        begun[name] = Run(start, end, run.resources, run.status)


def _until(run: Run, end: Fraction) -> Run:
    return Run(run.start, end, run.resources, run.status)
