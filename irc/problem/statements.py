"""The statements of a task: the units of an explanation.

`KINDS` is the one place to add a kind of statement. A kind gives the place of its statements, their
demands on time (differences of time points), and the way to add them to a relaxation. So a set of
statements alone is a problem of its own, and they can hold together if that problem has a schedule.

An action without a stated duration takes any time from 0 on: without that statement, the action has
no length, or the length that others need.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping
from enum import StrEnum
from typing import ClassVar, NamedTuple

from irc.diagnostics.source import Pointer
from irc.problem.activity import GroupDeadline
from irc.problem.problem import Problem
from irc.problem.relaxation import Relaxation


class Kind(StrEnum):
    """The kind of a statement."""

    TASK_DEADLINE = "task_deadline"
    CAPACITY = "capacity"
    SETUPS = "setups"
    NO_IDLE = "no_idle"
    USE = "use"
    PRECEDENCE = "precedence"
    RELEASE = "release"
    START = "start"
    LATEST_START = "latest_start"
    EARLIEST_END = "earliest_end"
    DEADLINE = "deadline"
    GROUP_DEADLINE = "group_deadline"
    DURATION = "duration"


class Side(StrEnum):
    """The limit of a statement that is meant, where it has a least and a greatest value."""

    BOTH = "both"
    LEAST = "min"
    MOST = "max"


class Statement(NamedTuple):
    """One demand of the task.

    `of` is the index of the activity, resource or arc in the `Problem` (of a group: the index of
    its first activity); `use` is that of the entry in the activity's `uses`.
    """

    kind: Kind
    of: int = 0
    use: int = 0
    side: Side = Side.BOTH

    @property
    def says_least(self) -> bool:
        """Whether the lower limit is part of it."""
        return self.side is not Side.MOST

    @property
    def says_most(self) -> bool:
        """Whether the upper limit is part of it."""
        return self.side is not Side.LEAST


ORIGIN = 0
"""The time point t = 0."""


def start_point(activity: int) -> int:
    """The time point at which an activity starts."""
    return 1 + 2 * activity


def end_point(activity: int) -> int:
    """The time point at which an activity ends."""
    return 2 + 2 * activity


class Difference(NamedTuple):
    """`t[dst] - t[src] >= weight`, by `statement`; None: by the nature of time."""

    src: int
    dst: int
    weight: int
    statement: Statement | None = None


def activities_of(problem: Problem, statement: Statement) -> tuple[int, ...]:
    """The indexes of the activities that a statement is about."""
    if statement.kind in (Kind.TASK_DEADLINE, Kind.CAPACITY):
        return ()
    if statement.kind is Kind.PRECEDENCE:
        arc = problem.arcs[statement.of]
        return arc.before, arc.after
    return (statement.of,)


class StatementKind(ABC):
    """The properties of one kind of statement."""

    kind: ClassVar[Kind]

    @abstractmethod
    def all(self, problem: Problem) -> Iterator[Statement]:
        """Every statement of the kind, in canonical order."""

    @abstractmethod
    def pointer(self, problem: Problem, statement: Statement) -> Pointer:
        """The pointer of a statement in the document."""

    @abstractmethod
    def state(self, relaxation: Relaxation, statement: Statement) -> None:
        """Adds a statement to a relaxation."""

    def differences(self, problem: Problem, statement: Statement) -> Iterator[Difference]:
        """The demands of a statement on time."""
        yield from ()

    def has_two_sides(self, problem: Problem, statement: Statement) -> bool:
        """Whether a statement has a least and a greatest value that differ in effect."""
        return False


class _TaskDeadline(StatementKind):
    kind = Kind.TASK_DEADLINE

    def all(self, problem: Problem) -> Iterator[Statement]:
        if problem.deadline is not None:
            yield Statement(self.kind)

    def pointer(self, problem: Problem, statement: Statement) -> Pointer:
        return ("deadline",)

    def state(self, relaxation: Relaxation, statement: Statement) -> None:
        relaxation.deadline = relaxation.problem.deadline

    def differences(self, problem: Problem, statement: Statement) -> Iterator[Difference]:
        for i in range(len(problem.activities)):
            yield Difference(end_point(i), ORIGIN, -(problem.deadline or 0), statement)


class _Capacity(StatementKind):
    kind = Kind.CAPACITY

    def all(self, problem: Problem) -> Iterator[Statement]:
        used = {r for a in problem.activities for use in a.uses for r in use.alternatives}
        for r in sorted(used):
            yield Statement(self.kind, r)

    def pointer(self, problem: Problem, statement: Statement) -> Pointer:
        return (*problem.resources[statement.of].origin, "capacity")

    def state(self, relaxation: Relaxation, statement: Statement) -> None:
        relaxation.limited.add(statement.of)


class _Setups(StatementKind):
    kind = Kind.SETUPS

    def all(self, problem: Problem) -> Iterator[Statement]:
        for r, resource in enumerate(problem.resources):
            setups = resource.setups
            if setups is not None and (setups.table or setups.initial is not None):
                yield Statement(self.kind, r)

    def pointer(self, problem: Problem, statement: Statement) -> Pointer:
        return (*problem.resources[statement.of].origin, "setups")

    def state(self, relaxation: Relaxation, statement: Statement) -> None:
        relaxation.with_setups.add(statement.of)


class _NoIdle(StatementKind):
    kind = Kind.NO_IDLE

    def all(self, problem: Problem) -> Iterator[Statement]:
        for r, resource in enumerate(problem.resources):
            if resource.setups is not None and resource.setups.tight:
                yield Statement(self.kind, r)

    def pointer(self, problem: Problem, statement: Statement) -> Pointer:
        return (*problem.resources[statement.of].origin, "no_idle")

    def state(self, relaxation: Relaxation, statement: Statement) -> None:
        relaxation.without_gaps.add(statement.of)


class _Use(StatementKind):
    kind = Kind.USE

    def all(self, problem: Problem) -> Iterator[Statement]:
        for i, activity in enumerate(problem.activities):
            for u in range(len(activity.uses)):
                yield Statement(self.kind, i, u)

    def pointer(self, problem: Problem, statement: Statement) -> Pointer:
        activity = problem.activities[statement.of]
        return (*activity.origin, "uses", activity.uses[statement.use].origin)

    def state(self, relaxation: Relaxation, statement: Statement) -> None:
        relaxation.use(statement.of, statement.use)


class _Precedence(StatementKind):
    kind = Kind.PRECEDENCE

    def all(self, problem: Problem) -> Iterator[Statement]:
        for k in range(len(problem.arcs)):
            yield Statement(self.kind, k)

    def pointer(self, problem: Problem, statement: Statement) -> Pointer:
        return ("precedence", problem.arcs[statement.of].origin)

    def state(self, relaxation: Relaxation, statement: Statement) -> None:
        relaxation.arc(statement.of, statement.says_least, statement.says_most)

    def differences(self, problem: Problem, statement: Statement) -> Iterator[Difference]:
        arc = problem.arcs[statement.of]
        src = end_point(arc.before) if arc.from_end else start_point(arc.before)
        dst = end_point(arc.after) if arc.to_end else start_point(arc.after)
        if statement.says_least:
            yield Difference(src, dst, arc.min_lag, statement)
        if statement.says_most and arc.max_lag is not None:
            yield Difference(dst, src, -arc.max_lag, statement)

    def has_two_sides(self, problem: Problem, statement: Statement) -> bool:
        return problem.arcs[statement.of].max_lag is not None


class _Release(StatementKind):
    kind = Kind.RELEASE

    def all(self, problem: Problem) -> Iterator[Statement]:
        for i, activity in enumerate(problem.activities):
            if activity.release:
                yield Statement(self.kind, i)

    def pointer(self, problem: Problem, statement: Statement) -> Pointer:
        return (*problem.activities[statement.of].origin, "release")

    def state(self, relaxation: Relaxation, statement: Statement) -> None:
        i = statement.of
        relaxation.activity(i)["release"] = relaxation.problem.activities[i].release

    def differences(self, problem: Problem, statement: Statement) -> Iterator[Difference]:
        i = statement.of
        yield Difference(ORIGIN, start_point(i), problem.activities[i].release, statement)


class _Start(StatementKind):
    kind = Kind.START

    def all(self, problem: Problem) -> Iterator[Statement]:
        for i, activity in enumerate(problem.activities):
            if activity.start is not None:
                yield Statement(self.kind, i)

    def pointer(self, problem: Problem, statement: Statement) -> Pointer:
        return (*problem.activities[statement.of].origin, "start")

    def state(self, relaxation: Relaxation, statement: Statement) -> None:
        i = statement.of
        relaxation.activity(i)["start"] = relaxation.problem.activities[i].start

    def differences(self, problem: Problem, statement: Statement) -> Iterator[Difference]:
        i = statement.of
        fixed = problem.activities[i].start or 0
        yield Difference(ORIGIN, start_point(i), fixed, statement)
        yield Difference(start_point(i), ORIGIN, -fixed, statement)


class _LatestStart(StatementKind):
    kind = Kind.LATEST_START

    def all(self, problem: Problem) -> Iterator[Statement]:
        for i, activity in enumerate(problem.activities):
            if activity.latest_start is not None:
                yield Statement(self.kind, i)

    def pointer(self, problem: Problem, statement: Statement) -> Pointer:
        return (*problem.activities[statement.of].origin, "latest_start")

    def state(self, relaxation: Relaxation, statement: Statement) -> None:
        i = statement.of
        relaxation.activity(i)["latest_start"] = relaxation.problem.activities[i].latest_start

    def differences(self, problem: Problem, statement: Statement) -> Iterator[Difference]:
        i = statement.of
        latest = problem.activities[i].latest_start or 0
        yield Difference(start_point(i), ORIGIN, -latest, statement)


class _EarliestEnd(StatementKind):
    kind = Kind.EARLIEST_END

    def all(self, problem: Problem) -> Iterator[Statement]:
        for i, activity in enumerate(problem.activities):
            if activity.earliest_end is not None:
                yield Statement(self.kind, i)

    def pointer(self, problem: Problem, statement: Statement) -> Pointer:
        return (*problem.activities[statement.of].origin, "earliest_end")

    def state(self, relaxation: Relaxation, statement: Statement) -> None:
        i = statement.of
        relaxation.activity(i)["earliest_end"] = relaxation.problem.activities[i].earliest_end

    def differences(self, problem: Problem, statement: Statement) -> Iterator[Difference]:
        i = statement.of
        yield Difference(ORIGIN, end_point(i), problem.activities[i].earliest_end or 0, statement)


class _Deadline(StatementKind):
    kind = Kind.DEADLINE

    def all(self, problem: Problem) -> Iterator[Statement]:
        for i, activity in enumerate(problem.activities):
            if activity.deadline is not None and activity.deadline_by is None:
                yield Statement(self.kind, i)

    def pointer(self, problem: Problem, statement: Statement) -> Pointer:
        return (*problem.activities[statement.of].origin, "deadline")

    def state(self, relaxation: Relaxation, statement: Statement) -> None:
        i = statement.of
        relaxation.activity(i)["deadline"] = relaxation.problem.activities[i].deadline

    def differences(self, problem: Problem, statement: Statement) -> Iterator[Difference]:
        i = statement.of
        yield Difference(end_point(i), ORIGIN, -(problem.activities[i].deadline or 0), statement)


class _GroupDeadline(StatementKind):
    kind = Kind.GROUP_DEADLINE

    def all(self, problem: Problem) -> Iterator[Statement]:
        groups = {a.deadline_by for a in problem.activities if a.deadline_by is not None}
        for i in sorted(_members(problem, by)[0] for by in groups):
            yield Statement(self.kind, i)

    def pointer(self, problem: Problem, statement: Statement) -> Pointer:
        return problem.activities[statement.of].deadline_origin

    def state(self, relaxation: Relaxation, statement: Statement) -> None:
        activities = relaxation.problem.activities
        by = activities[statement.of].deadline_by
        for i in _members(relaxation.problem, by):
            relaxation.activity(i).update(deadline=activities[i].deadline, deadline_by=by)

    def differences(self, problem: Problem, statement: Statement) -> Iterator[Difference]:
        for i in _members(problem, problem.activities[statement.of].deadline_by):
            limit = problem.activities[i].deadline or 0
            yield Difference(end_point(i), ORIGIN, -limit, statement)


def _members(problem: Problem, by: GroupDeadline | None) -> list[int]:
    """The activities whose deadline is that of a group, in order."""
    return [i for i, a in enumerate(problem.activities) if a.deadline_by == by]


class _Duration(StatementKind):
    kind = Kind.DURATION

    def all(self, problem: Problem) -> Iterator[Statement]:
        for i in range(len(problem.activities)):
            yield Statement(self.kind, i)

    def pointer(self, problem: Problem, statement: Statement) -> Pointer:
        return (*problem.activities[statement.of].origin, "duration")

    def state(self, relaxation: Relaxation, statement: Statement) -> None:
        i = statement.of
        fields = relaxation.activity(i)
        if statement.says_least:
            fields["duration_min"] = relaxation.problem.activities[i].duration_min
        if statement.says_most:
            fields["duration_max"] = relaxation.problem.activities[i].duration_max

    def differences(self, problem: Problem, statement: Statement) -> Iterator[Difference]:
        i = statement.of
        activity, start, end = problem.activities[i], start_point(i), end_point(i)
        if statement.says_least:
            yield Difference(start, end, activity.duration_min, statement)
        if statement.says_most:
            yield Difference(end, start, -activity.duration_max, statement)

    def has_two_sides(self, problem: Problem, statement: Statement) -> bool:
        return not problem.activities[statement.of].is_fixed


KINDS: Mapping[Kind, StatementKind] = {
    of.kind: of
    for of in (
        _TaskDeadline(),
        _Capacity(),
        _Setups(),
        _NoIdle(),
        _Use(),
        _Precedence(),
        _Release(),
        _Start(),
        _LatestStart(),
        _EarliestEnd(),
        _Deadline(),
        _GroupDeadline(),
        _Duration(),
    )
}


def all_statements(problem: Problem) -> list[Statement]:
    """All statements of the task, in canonical order."""
    return [statement for kind in KINDS.values() for statement in kind.all(problem)]


def in_canonical_order(statements: Iterable[Statement]) -> list[Statement]:
    """The statements by kind, and within a kind in the order of the problem."""
    rank = {kind: k for k, kind in enumerate(KINDS)}
    return sorted(statements, key=lambda s: (rank[s.kind], s.of, s.use))


def pointer_of(problem: Problem, statement: Statement) -> Pointer:
    """The pointer of a statement in the document, for any kind."""
    return KINDS[statement.kind].pointer(problem, statement)


def differences_of(problem: Problem, statements: Iterable[Statement]) -> list[Difference]:
    """The demands of statements on time."""
    return [d for s in statements for d in KINDS[s.kind].differences(problem, s)]


def how_time_is(activities: Iterable[int]) -> Iterator[Difference]:
    """The demands that need no statement: no start before t = 0, no end before the start."""
    for i in activities:
        yield Difference(ORIGIN, start_point(i), 0)
        yield Difference(start_point(i), end_point(i), 0)


def problem_of(problem: Problem, statements: Iterable[Statement], free_length: int) -> Problem:
    """The problem with only these statements.

    It has only the activities and resources that the statements name. `free_length` is the greatest
    duration of an activity whose duration is not stated; no schedule may need more.
    """
    relaxation = Relaxation(problem, free_length)
    for statement in statements:
        KINDS[statement.kind].state(relaxation, statement)
    return relaxation.build()
