"""What was built in code stands for a part of the IR: its `ir`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol, TypeVar

from irc.model.task import Task

if TYPE_CHECKING:
    from irc.model.events import Event

_Part = TypeVar("_Part", covariant=True)


class Built(Protocol[_Part]):
    """Something built in code, such as `irc.Task`, that stands for a part of the IR."""

    @property
    def ir(self) -> _Part:
        """The part of the IR as it is now."""
        ...


def task_of(task: Task | Built[Task]) -> Task:
    """The task itself, or the one that was built."""
    return task if isinstance(task, Task) else task.ir


def event_of(event: Event | Built[Event]) -> Event:
    """The event itself, or the one that was built."""
    from irc.model.events import Event

    return event if isinstance(event, Event) else event.ir
