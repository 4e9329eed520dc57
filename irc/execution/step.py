"""The result of replanning at one instant."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from irc.diagnostics import Diagnostic
from irc.execution.history import History
from irc.execution.state import Key, key_of
from irc.model import Event, Task
from irc.model.quantities import Number
from irc.model.times import format_number, json_number
from irc.outcome import Outcome
from irc.schedule import Entry, LeftOut, Schedule


@dataclass(frozen=True, slots=True)
class Step:
    """The result of replanning at one instant.

    `completed` and `running` are ids as of then; `stopped` are those of what was cancelled or
    failed, which is over too. `moved` counts the planned occurrences whose start, mode or resources
    differ from the previous plan, or that are gone. `abandoned` are half-done groups that cannot be
    finished. `schedule` is the whole history with the new plan, an answer to `task` except for what
    is `left_out`.
    """

    at: Number
    events: tuple[Event, ...]
    completed: tuple[str, ...]
    running: tuple[str, ...]
    moved: int
    schedule: Schedule
    task: Task
    notes: tuple[Diagnostic, ...] = ()
    abandoned: tuple[str, ...] = ()
    stopped: tuple[str, ...] = ()

    @property
    def left_out(self) -> tuple[LeftOut, ...]:
        """The required actions and goals that cannot go on: the schedule is without them."""
        return self.schedule.left_out

    @property
    def outcome(self) -> Outcome:
        """How the replanning ended; without a plan, with the diagnostics that say why."""
        return self.schedule.outcome

    def _repr_html_(self) -> str:
        """Its events in words, and the plan from then on, for notebooks."""
        from irc.display.html import heading, items
        from irc.events.wording import changes_in_words

        said = [line for event in self.events for line in changes_in_words(event, self.task)]
        at = f"at {format_number(self.at)} {self.task.time_unit}"
        counts = f"{at}: {self.moved} moved, {len(self.completed)} completed"
        listed = items(said) if said else ""
        return heading(counts) + listed + self.schedule._repr_html_()

    def to_dict(self) -> dict[str, Any]:
        """The step as `irc simulate --format json` writes it."""
        return {
            "at": json_number(self.at),
            "event": [event.id for event in self.events],
            "completed": list(self.completed),
            "running": list(self.running),
            "stopped": list(self.stopped),
            "moved": self.moved,
            "abandoned": list(self.abandoned),
            "notes": [note.to_dict() for note in self.notes],
            "schedule": self.schedule.to_dict(),
            **({} if self.outcome.answered else {"outcome": self.outcome.to_dict()}),
        }


def moved(planned: Sequence[Entry], schedule: Schedule, history: History) -> int:
    """The number of planned occurrences, not cancelled, that moved or are gone."""
    now: dict[Key, Entry] = {key_of(entry): entry for entry in schedule.entries}
    return sum(
        entry.id not in history.cancelled and not _same(entry, now.get(key_of(entry)))
        for entry in planned
    )


def _same(old: Entry, new: Entry | None) -> bool:
    return new is not None and (old.start, old.mode, dict(old.resources)) == (
        new.start,
        new.mode,
        dict(new.resources),
    )
