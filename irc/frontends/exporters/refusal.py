"""Refuses each element of a task that a format cannot say, with its place, as a target does."""

from __future__ import annotations

from collections.abc import Collection
from fractions import Fraction

from irc.diagnostics import Code, Findings, InputError, Report
from irc.diagnostics.source import Pointer
from irc.model import DurationRange, Task
from irc.model.features import Feature, features_of
from irc.model.times import Instant, format_number


class Refusals:
    """The elements of a task that a format cannot say, in the order in which they are found."""

    def __init__(self, task: Task, format: str) -> None:
        """`format` is the name of the format in messages."""
        self.task, self.format = task, format
        self._findings = Findings()

    def require_features(self, supported: Collection[Feature]) -> None:
        """Refuses each feature of the task outside of `supported`, at its first use."""
        seen = set(supported)
        for use in features_of(self.task):
            if use.feature not in seen:
                seen.add(use.feature)
                self.add(f"{use.element}: {self.format} has no {use.feature.value}", use.pointer)

    def add(self, message: str, pointer: Pointer = (), hint: str | None = None) -> None:
        """Records an element that the format cannot say."""
        self._findings.add(Code.UNSUPPORTED, message, pointer, hint=hint)

    def whole(self, value: Instant | DurationRange | None, element: str, pointer: Pointer) -> int:
        """A time of the task as a whole number of its unit; otherwise 0, and a refusal."""
        if value is None or isinstance(value, DurationRange):
            return 0
        number = Fraction(self.task.number(value))
        if number.denominator == 1:
            return int(number)
        message = (
            f"{element}: {self.format} has whole numbers only, not {format_number(number)} "
            f"{self.task.time_unit}"
        )
        self.add(message, pointer, "a smaller 'time_unit' makes it whole")
        return 0

    def raise_any(self) -> None:
        """Raises `InputError` with all refusals, if there are any."""
        if self._findings.items:
            raise InputError(Report(tuple(self._findings.items), self.task.source))
