"""The base of objects built in code: each stands for a part of the IR, its `ir`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol, TypeVar

from irc.model.task import Task

if TYPE_CHECKING:
    from irc.model.events import Event

_Part = TypeVar("_Part", covariant=True)


class Built(Protocol[_Part]):
    """An object built in code, such as `irc.Task`, that stands for a part of the IR."""

    @property
    def ir(self) -> _Part:
        """The part of the IR as it is now."""
        ...


def task_of(task: Task | Built[Task]) -> Task:
    """The immutable task: the argument itself, or the `ir` of a task built in code."""
    return task if isinstance(task, Task) else task.ir


def event_of(event: Event | Built[Event]) -> Event:
    """The immutable event: the argument itself, or the `ir` of an event built in code."""
    from irc.model.events import Event

    return event if isinstance(event, Event) else event.ir
