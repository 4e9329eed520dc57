"""An event that is applied to the history of a running task."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

from irc.diagnostics import Code, Diagnostic, Findings
from irc.diagnostics.source import Pointer
from irc.execution.history import History
from irc.execution.presumed import Presumed, presumed
from irc.execution.state import Key, key_of
from irc.model import Action, Group, Task
from irc.model.quantities import Number
from irc.model.times import Clock, format_number
from irc.schedule import Entry


@dataclass
class EventStep:
    """An event that is applied to a history.

    `actions` and `groups` are those of the task, after the previous changes. `at` is the event's
    time, and `now` is the present: later than `at` for an observation that comes in late.
    """

    history: History
    task: Task
    at: Number
    now: Number
    findings: Findings
    actions: dict[str, Action]
    groups: dict[str, Group]
    notes: list[Diagnostic] = field(default_factory=list)
    _taken: Presumed | None = None
    _keys: dict[str, list[Key]] | None = None

    @property
    def clock(self) -> Clock:
        """The clock of the task."""
        return self.task.clock

    @property
    def taken(self) -> Presumed:
        """The facts as of now, after the previous changes of the event."""
        if self._taken is None:
            self._taken = presumed(self.history, self.task, self.now, self.actions)
            self._keys = None
        return self._taken

    def action(self, name: str) -> Action | None:
        """The action of this name, after the previous changes."""
        return self.actions.get(name)

    def occurrences(self, name: str) -> list[Entry]:
        """The entries of an action, as they are taken to be."""
        entries = self.taken.entries
        if self._keys is None:
            self._keys = {}
            for key in entries:
                self._keys.setdefault(key[0], []).append(key)
        return [entries[key] for key in self._keys.get(name, ())]

    def is_frozen(self, entry: Entry) -> bool:
        """Whether an occurrence has begun."""
        return key_of(entry) in self.taken.begun

    def is_running(self, entry: Entry) -> bool:
        """Whether an occurrence has begun and not ended."""
        return self.is_frozen(entry) and entry.end > self.at

    def put(self, entry: Entry, **fields: Any) -> None:
        """Puts an entry into the history."""
        self.history.entries[key_of(entry)] = replace(entry, **fields)
        self.forget()

    def remove(self, key: Key) -> None:
        """Removes what was planned."""
        self.history.entries.pop(key, None)
        self.forget()

    def forget(self) -> None:
        """Takes note that the history has changed."""
        self._taken = self._keys = None

    def add_finding(self, code: Code, message: str, pointer: Pointer, hint: str) -> None:
        """Adds a contradiction."""
        self.findings.add(code, message, pointer, hint=hint)

    def text(self, time: Number) -> str:
        """A time with the task's unit."""
        return f"{format_number(time)} {self.task.time_unit}"
