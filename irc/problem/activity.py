"""An activity: work with a duration, in the order and with the indexes of the problem."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

from irc.diagnostics.source import Pointer
from irc.problem.needs import (
    Condition,
    Effect,
    Mode,
    NumberCondition,
    NumberEffect,
    OpenDemand,
    Protected,
    ProtectedLimits,
    Ranks,
    Requirement,
    StockChange,
    together,
)


@dataclass(frozen=True, slots=True)
class Details:
    """The rare fields of an activity, which most activities do not need.

    `optional`: it may be absent. `repeats`: the least and the greatest number of occurrences
    (None: no greatest) where more than one is possible; `irc.passes.unroll` makes an activity of
    each, the k-th with `occurrence` k and the index of its predecessor as `previous_occurrence`.

    With `modes` exactly one is chosen; each may have stock, conditions, effects and a cost besides
    those here, which are of every mode (see `in_mode`, `all_stock` and so on). `use_modes` says for
    each of the activity's `uses` in which mode (index) it is held, None: in all; empty stands for
    all None.

    `entered` is its release as the task says it, from which flow time counts (None where it does
    not count).

    `ranks` are those that its start and its end are known to have; where it starts at the time of
    `not_before`, (time, rank), its start has that rank at least, and changes stock behind all that
    ended then.

    With a `calendar` (index into `Problem.calendars`) it starts, lasts and ends at open times. If
    it pauses, `work` has its least and greatest working time, one pair for each mode or one alone.
    Closed times come on top of that, `max_pause` of them at most, so its durations only limit the
    time from start to end. One that has begun has `paused` instead: its times are known.
    """

    optional: bool = False
    repeats: tuple[int, int | None] | None = None
    occurrence: int = 1
    previous_occurrence: int | None = None
    modes: tuple[Mode, ...] = ()
    use_modes: tuple[int | None, ...] = ()
    ranks: Ranks | None = None
    not_before: tuple[int, int] | None = None
    calendar: int | None = None
    work: tuple[tuple[int, int], ...] = ()
    max_pause: int | None = None
    paused: bool = False
    stock: tuple[StockChange, ...] = ()
    conditions: tuple[Condition, ...] = ()
    effects: tuple[Effect, ...] = ()
    number_conditions: tuple[NumberCondition, ...] = ()
    number_effects: tuple[NumberEffect, ...] = ()
    protects: tuple[Protected, ...] = ()
    protects_limits: tuple[ProtectedLimits, ...] = ()
    due: int | None = None
    weight: int = 1
    reward: int = 0
    cost: int = 0
    entered: int | None = None

    @property
    def touches_state(self) -> bool:
        """Whether it has conditions or effects, on variables or on numbers, in any mode."""
        return bool(
            self.all_conditions
            or self.all_effects
            or self.all_number_conditions
            or self.all_number_effects
        )

    def use_mode(self, use: int) -> int | None:
        """The mode in which a use is held; None: in all."""
        return self.use_modes[use] if self.use_modes else None

    @property
    def keeps_units(self) -> bool:
        """Whether it keeps its units while a resource has no capacity."""
        return bool(self.work) or self.paused

    def in_mode(self, mode: int | None) -> Details:
        """The details with what a mode (index) adds among their own; the modes become bare.

        None: as they are.
        """
        if mode is None or self.modes[mode] == self.modes[mode].bare:
            return self
        own = self.modes[mode]
        return replace(
            self,
            modes=tuple(m.bare for m in self.modes),
            stock=tuple(sorted(self.stock + own.stock)),
            conditions=tuple(sorted({*self.conditions, *own.conditions})),
            effects=tuple(sorted({*self.effects, *own.effects})),
            number_conditions=(*self.number_conditions, *own.number_conditions),
            number_effects=together((*self.number_effects, *own.number_effects)),
            cost=self.cost + own.cost,
        )

    @property
    def ways(self) -> tuple[Details, ...]:
        """The details in each mode; the details themselves where there are no modes."""
        return tuple(self.in_mode(m) for m in range(len(self.modes))) or (self,)

    @property
    def all_stock(self) -> tuple[StockChange, ...]:
        """The changes of stock of the activity and of all its modes, of which one is chosen."""
        return self.stock + tuple(c for mode in self.modes for c in mode.stock)

    @property
    def all_conditions(self) -> tuple[Condition, ...]:
        """The conditions of the activity and of all its modes, of which one is chosen."""
        return self.conditions + tuple(c for mode in self.modes for c in mode.conditions)

    @property
    def all_effects(self) -> tuple[Effect, ...]:
        """The effects of the activity and of all its modes, of which one is chosen."""
        return self.effects + tuple(e for mode in self.modes for e in mode.effects)

    @property
    def all_number_conditions(self) -> tuple[NumberCondition, ...]:
        """The conditions on numbers of the activity and of all its modes."""
        return self.number_conditions + tuple(c for m in self.modes for c in m.number_conditions)

    @property
    def all_number_effects(self) -> tuple[NumberEffect, ...]:
        """The effects on numbers of the activity and of all its modes, of which one is chosen."""
        return self.number_effects + tuple(e for m in self.modes for e in m.number_effects)

    @property
    def touches_world(self) -> bool:
        """Whether it reads or changes state or stock, in any mode."""
        return bool(self.all_stock) or self.touches_state


PLAIN = Details()


IMPOSSIBLE_DEADLINE = -1
"""The deadline of an activity that must not occur: nothing ends before t = 0."""


class GroupDeadline(NamedTuple):
    """The deadline of a group, where it is the deadline of its members; `origin` is its place."""

    group: str
    origin: Pointer


@dataclass(frozen=True, slots=True)
class Activity:
    """An action; every schedule contains it exactly once unless its `details` say otherwise.

    With modes, the durations are the least and the greatest of all modes, and `uses` are the
    activity's own followed by those of each mode. With a `latest_start` it starts then or earlier,
    with an `earliest_end` it ends then or later.
    `deadline_by` is the group whose deadline `deadline` is; None where it is the activity's own.
    """

    id: str
    duration_min: int
    duration_max: int
    release: int = 0
    deadline: int | None = None
    start: int | None = None
    latest_start: int | None = None
    earliest_end: int | None = None
    deadline_by: GroupDeadline | None = None
    uses: tuple[Requirement, ...] = ()
    open_demands: tuple[OpenDemand, ...] = ()
    origin: Pointer = ()
    details: Details = PLAIN

    def has_ended_by(self, time: int) -> bool:
        """Whether it is known to have started before a time, and to end at it."""
        return (
            self.start is not None
            and self.is_fixed
            and self.start < time == self.start + self.duration_min
        )

    @property
    def deadline_origin(self) -> Pointer:
        """The place of the deadline in the document: the group's, or the activity's own."""
        if self.deadline_by is not None:
            return self.deadline_by.origin
        return (*self.origin, "deadline")

    @property
    def is_fixed(self) -> bool:
        """Whether the duration is fixed, so that no solver chooses it."""
        return self.duration_min == self.duration_max

    def uses_in(self, mode: int | None) -> tuple[int, ...]:
        """The indexes of the uses that apply in a mode (index); None: of those in every mode."""
        if not self.details.use_modes:
            return tuple(range(len(self.uses)))
        return tuple(u for u, m in enumerate(self.details.use_modes) if m is None or m == mode)
