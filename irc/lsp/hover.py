"""The descriptions that the editor shows over a name: the times of an action, the users of a
resource.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from functools import cached_property
from typing import Any

from irc.diagnostics import Code
from irc.diagnostics.catalogue import load_catalogue
from irc.diagnostics.listing import and_more
from irc.lsp.analysis import Analysis
from irc.lsp.critical_times import CriticalTimes, critical_times
from irc.lsp.mentions import Kind, Mention
from irc.lsp.names import Names
from irc.model.details import Setups
from irc.model.parts import Action, Resource, Use
from irc.model.quantities import Quantity
from irc.model.state_values import limits_text
from irc.model.times import format_number

_MOST_LISTED = 12
_TICKS = re.compile("`+")

Mark = Callable[[str], str]
"""A function that marks a name in a sentence."""


def plain(name: str) -> str:
    """A name in plain text."""
    return repr(name)


def code(name: str) -> str:
    """A name as Markdown code, whatever characters it has."""
    name = " ".join(name.split()) or " "
    fence = "`" * (1 + max(map(len, _TICKS.findall(name)), default=0))
    pad = " " if name.startswith("`") or name.endswith("`") else ""
    return f"{fence}{pad}{name}{pad}{fence}"


class Descriptions:
    """The descriptions of the names of one analysis."""

    def __init__(self, analysis: Analysis, names: Names) -> None:
        self.analysis = analysis
        self.names = names

    @cached_property
    def actions(self) -> dict[str, Action]:
        """The task's actions by id; none if the text has faults of shape."""
        task = self.analysis.task
        return {} if task is None else {a.id: a for a in task.actions}

    @cached_property
    def resources(self) -> dict[str, Resource]:
        """The task's resources by id."""
        task = self.analysis.task
        return {} if task is None else {r.id: r for r in task.resources}

    @cached_property
    def users(self) -> dict[str, list[str]]:
        """By resource, the actions that use it, may use it, or change its stock."""
        found: dict[str, dict[str, None]] = {}
        for action in self.actions.values():
            for resource in _used(action):
                found.setdefault(resource, {})[action.id] = None
        return {resource: list(ids) for resource, ids in found.items()}

    @cached_property
    def critical_times(self) -> CriticalTimes | None:
        """The critical-path times of the actions, if no error was found."""
        problem = self.analysis.sound
        return None if problem is None else critical_times(problem)

    def about(self, mention: Mention, mark: Mark) -> list[str]:
        """The paragraphs about the element that a mention names."""
        if mention.kind is Kind.ACTION and mention.name in self.actions:
            return list(self._action(self.actions[mention.name], mark))
        if mention.kind is Kind.RESOURCE and mention.name in self.resources:
            return list(self._resource(self.resources[mention.name], mark))
        if mention.kind in (Kind.VARIABLE, Kind.VALUE):
            return list(self._variable(mention.owner or mention.name, mark))
        if mention.kind is Kind.GROUP:
            return list(self._group(mention.name, mark))
        return [f"{mention.kind} {mark(mention.name)}"]

    # --- actions ---

    def _action(self, action: Action, mark: Mark) -> Iterator[str]:
        yield f"action {mark(action.id)}: {self._duration(action)}"
        if action.label:
            yield mark(action.label)
        if action.uses:
            yield "uses " + ", ".join(_use(use, mark) for use in action.uses)
        yield from self._limits(action)
        yield from self._when(action.id)

    def _duration(self, action: Action) -> str:
        if action.modes:
            lengths = ", ".join(f"{m.id} {self._time(m.duration)}" for m in action.modes)
            return f"one of the modes {lengths}"
        return self._time(action.duration)

    def _time(self, time: Any) -> str:
        """The text of a time as it was written, with the task's unit if it has no unit."""
        if time is None:
            return "no duration"
        if hasattr(time, "min"):
            return f"{self._time(time.min)} to {self._time(time.max)}"
        if isinstance(time, Quantity):
            return time.text
        if hasattr(time, "isoformat"):
            return str(time.isoformat())
        return self._number(time)

    def _number(self, number: Any) -> str:
        task = self.analysis.task
        unit = "s" if task is None else task.time_unit
        return f"{format_number(number)} {unit}"

    def _limits(self, action: Action) -> Iterator[str]:
        limits = []
        if action.occurs != "once":
            least, most = action.occurrence_bounds
            times = f"{least} to {most} times" if most is not None else f"at least {least} times"
            limits.append(f"occurs {times}")
        if action.release != 0:
            limits.append(f"not before {self._time(action.release)}")
        if action.start is not None:
            limits.append(f"fixed to start at {self._time(action.start)}")
        if action.latest_start is not None:
            limits.append(f"to start by {self._time(action.latest_start)}")
        if action.earliest_end is not None:
            limits.append(f"to end no earlier than {self._time(action.earliest_end)}")
        if action.deadline is not None:
            limits.append(f"to end by {self._time(action.deadline)}")
        if action.due is not None:
            limits.append(f"due at {self._time(action.due)}")
        if limits:
            yield ", ".join(limits)

    def _when(self, id: str) -> Iterator[str]:
        problem, found = self.analysis.sound, self.critical_times
        if problem is None or found is None:
            return
        times = found.times.get(id)
        if times is None:
            yield "not in every schedule, so it is not on the critical path"
            return
        first, last = (self._number(problem.to_units(t)) for t in (times.earliest, times.latest))
        length = self._number(problem.to_units(found.length))
        shared = ", without resources" if problem.has_contention else ""
        if times.slack:
            slack = self._number(problem.to_units(times.slack))
            yield (
                f"starts between {first} and {last}: slack {slack} "
                f"on a critical path of {length}{shared}"
            )
        else:
            yield f"starts at {first}: critical, on the critical path of {length}{shared}"

    # --- the rest ---

    def _resource(self, resource: Resource, mark: Mark) -> Iterator[str]:
        if resource.kind == "reservoir":
            most = "" if resource.max is None else f", at most {resource.max}"
            limits = f"initially {resource.initial}, at least {resource.min}{most}"
            yield f"stock {mark(resource.id)}: {limits}"
        else:
            yield f"resource {mark(resource.id)}: capacity {resource.capacity}"
        for window in resource.availability:
            ends = f"{self._time(window.from_)} to {self._time(window.to)}"
            yield f"capacity {window.capacity} from {ends}"
        if resource.kind == "batch":
            yield "takes loads: what is in it at once starts and ends together"
        if resource.no_idle:
            yield "no idle time between its uses"
        if resource.setups is not None:
            yield from self._setups(resource.setups, mark)
        users = self.users.get(resource.id, [])
        if not users:
            yield "no action uses it"
            return
        plural = "s" if len(users) > 1 else ""
        yield f"used by {len(users)} action{plural}: {_listed(users, mark)}"

    def _setups(self, setups: Setups, mark: Mark) -> Iterator[str]:
        if setups.initial is not None:
            yield f"set up for {mark(setups.initial)} at first"
        for row in setups.times:
            ends = f"from {mark(row.from_)} to {mark(row.to)}"
            cost = f", cost {row.cost}" if row.cost else ""
            yield f"set-up {ends}: {self._time(row.time)}{cost}"

    def _variable(self, id: str, mark: Mark) -> Iterator[str]:
        task = self.analysis.task
        found = None if task is None else next((v for v in task.state if v.id == id), None)
        yield f"state variable {mark(id)}"
        if found is not None and found.is_number:
            yield f"a number, {limits_text(found.min, found.max)}"
        elif found is not None:
            values = ", ".join(
                mark(str(v).lower() if v is True or v is False else v) for v in found.values
            )
            yield f"values {values}"

    def _group(self, id: str, mark: Mark) -> Iterator[str]:
        task = self.analysis.task
        found = None if task is None else next((g for g in task.groups if g.id == id), None)
        yield f"group {mark(id)}"
        if found is not None:
            kind = "all of" if found.required else "all or none of"
            yield f"{kind} {_listed(list(found.actions), mark)}"


def _used(action: Action) -> Iterator[str]:
    for use in (*action.uses, *(u for mode in action.modes for u in mode.uses)):
        yield from use.alternatives
    for part in action.ways:
        for stock in (*part.consumes, *part.produces):
            yield stock.resource


def _use(use: Use, mark: Mark) -> str:
    amount = f"{use.amount} of " if use.amount != 1 else ""
    family = "" if use.family is None else f" for {mark(use.family)}"
    return amount + " or ".join(map(mark, use.alternatives)) + family


def _listed(names: list[str], mark: Mark) -> str:
    return and_more([*map(mark, names[:_MOST_LISTED])], len(names))


def about_pool(name: str, members: list[str], mark: Mark) -> list[str]:
    """The paragraphs about a pool."""
    return [f"pool {mark(name)}", f"one of {_listed(members, mark)}"]


def about_code(code: Code) -> list[str]:
    """The text of `irc explain-code` about a diagnostic, without its examples."""
    entry = load_catalogue().get(code.id)
    head = f"{code.id}: {code.summary}"
    if entry is None:
        return [head]
    return [
        head,
        entry.explanation,
        f"What to do: {entry.remedy}.",
        f"`irc explain-code {code.id}` shows examples.",
    ]
