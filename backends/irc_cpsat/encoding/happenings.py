"""The happenings of state on the line of moments, shared by all variables and numbers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from irc_cpsat.encoding.builder import Builder, Literal


class Happenings:
    """The moments of starts, ends and timed changes; variables and literals are made once."""

    def __init__(self, builder: Builder) -> None:
        self.builder = builder
        self.model = builder.model
        self.problem = builder.problem
        self.stretched: dict[int, Literal] = {}
        self.last_end: Any = None

    def point(self, i: int, *, at_end: bool) -> Any:
        """A variable for the moment of a happening (intervals take one variable, not two)."""
        if at_end and self.problem.activities[i].is_fixed:
            start = self.builder.point(i, at_end=False)
            return start + self.problem.activities[i].duration_min * self.builder.rank_count
        return self.builder.point(i, at_end=at_end)

    def one_happening(self, i: int) -> bool | None:
        """Whether start and end are one happening; None where that is open."""
        activity = self.problem.activities[i]
        if activity.duration_min > 0:
            return False
        return True if activity.duration_max == 0 else None

    def is_stretched(self, i: int) -> Literal:
        """A literal that says that start and end are two happenings."""
        if i not in self.stretched:
            literal = self.model.new_bool_var("")
            start, end = self.point(i, at_end=False), self.point(i, at_end=True)
            self.model.add(end >= start + 1).only_enforce_if(literal)
            self.model.add(end == start).only_enforce_if(~literal)
            self.stretched[i] = literal
        return self.stretched[i]

    def change(self, at: int) -> Any:
        """A variable for the moment of a timed change at the tick `at`."""
        first = at * self.builder.rank_count
        return self.model.new_int_var(first, first + self.builder.rank_count - 1, "")

    def carried_out(self, i: int, mode: int | None) -> Literal | None:
        """A literal that says that an activity is present, in a mode; None where it always is."""
        return self.builder.present[i] if mode is None else self.builder.modes[i][mode]

    def start_around(self, i: int, when: Sequence[Literal], at: int, change: Any) -> None:
        """Where some literals are true, an activity starts before the instant of a timed change, or
        no earlier than the change."""
        opening = self.point(i, at_end=False)
        early = self.model.new_bool_var("")
        late = self.model.new_bool_var("")
        self.model.add(opening < at * self.builder.rank_count).only_enforce_if(early)
        self.model.add(opening >= change).only_enforce_if(late)
        self.model.add_bool_or([early, late, *(~literal for literal in when)])

    def end_of_all(self) -> Any:
        """The moment behind everything that happens at the last end."""
        if self.last_end is None:
            ends: list[Any] = [0]
            for i, present in enumerate(self.builder.present):
                end = self.model.new_int_var(0, self.builder.horizon, "")
                self.builder.enforced(self.model.add(end == self.builder.end(i)), i)
                if present is not None:
                    self.model.add(end == 0).only_enforce_if(~present)
                ends.append(end)
            time = self.model.new_int_var(0, self.builder.horizon, "")
            self.model.add_max_equality(time, ends)
            self.last_end = (time + 1) * self.builder.rank_count
        return self.last_end
