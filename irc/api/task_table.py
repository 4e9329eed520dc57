"""The actions of a task as rows of texts, for notebooks."""

from __future__ import annotations

from collections.abc import Iterator

from irc.model import Action, Task
from irc.model.base import write_time
from irc.model.parts import DurationRange, Use

COLUMNS = ("action", "duration", "uses", "after", "release", "due", "deadline")


def action_rows(task: Task) -> Iterator[tuple[str, ...]]:
    """A row of texts for each action; times as they were written."""
    before: dict[str, list[str]] = {}
    for precedence in task.precedence:
        before.setdefault(precedence.after, []).append(precedence.before)
    for action in task.actions:
        yield (
            action.id,
            _duration(action),
            ", ".join(map(_use, action.uses)),
            ", ".join(before.get(action.id, ())),
            *(
                "" if time is None else str(write_time(time))
                for time in (action.release or None, action.due, action.deadline)
            ),
        )


def _duration(action: Action) -> str:
    length = action.duration
    if length is None:
        return ", ".join(f"{mode.id}: {_length(mode.duration)}" for mode in action.modes)
    return _length(length)


def _length(length: object) -> str:
    if isinstance(length, DurationRange):
        return f"{write_time(length.min)} – {write_time(length.max)}"
    return "" if length is None else str(write_time(length))


def _use(use: Use) -> str:
    names = " or ".join(use.alternatives)
    return names if use.amount == 1 else f"{names} ×{use.amount}"
