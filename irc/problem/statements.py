"""What a statement of the IR is: the units that an explanation speaks in.

`KINDS` is the one place to add a kind of statement. A kind says where its statements stand, what
each demands of time (differences of time points), and how a problem that contains nothing but
stated things comes to contain it. So a set of statements alone is a problem of its own, and
whether they can hold together is a question about that problem.

An action of which no duration is stated takes any time from 0 on: dropping the statement drops
all that the action weighs, or lets it be as long as others need it to be.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping
from enum import StrEnum
from typing import ClassVar, NamedTuple

from irc.diagnostics.source import Pointer
from irc.problem.problem import Problem
from irc.problem.relaxation import Relaxation


class Kind(StrEnum):
    """What a statement is about."""

    TASK_DEADLINE = "task_deadline"
    CAPACITY = "capacity"
    USE = "use"
    PRECEDENCE = "precedence"
    RELEASE = "release"
    START = "start"
    LATEST_START = "latest_start"
    DEADLINE = "deadline"
    DURATION = "duration"


class Side(StrEnum):
    """Which limit of a statement is meant, where it has a least and a greatest value."""

    BOTH = "both"
    LEAST = "min"
    MOST = "max"


class Statement(NamedTuple):
    """One thing that the task says.

    `of` is the index of the activity, resource or arc in the `Problem`; `use` that of the entry
    in the activity's `uses`.
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
    """`t[dst] - t[src] >= weight`; `statement` says so, or nobody: None is how time is."""

    src: int
    dst: int
    weight: int
    statement: Statement | None = None


class StatementKind(ABC):
    """Everything there is to know about one kind of statement."""

    kind: ClassVar[Kind]

    @abstractmethod
    def all(self, problem: Problem) -> Iterator[Statement]:
        """Every statement of the kind, in canonical order."""

    @abstractmethod
    def pointer(self, problem: Problem, statement: Statement) -> Pointer:
        """Where it stands in the document."""

    @abstractmethod
    def state(self, relaxation: Relaxation, statement: Statement) -> None:
        """Makes it part of a relaxation."""

    def differences(self, problem: Problem, statement: Statement) -> Iterator[Difference]:
        """What it demands of time."""
        yield from ()

    def has_two_sides(self, problem: Problem, statement: Statement) -> bool:
        """Whether its least and its greatest value are worth telling apart."""
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


class _Deadline(StatementKind):
    kind = Kind.DEADLINE

    def all(self, problem: Problem) -> Iterator[Statement]:
        for i, activity in enumerate(problem.activities):
            if activity.deadline is not None:
                yield Statement(self.kind, i)

    def pointer(self, problem: Problem, statement: Statement) -> Pointer:
        return (*problem.activities[statement.of].origin, "deadline")

    def state(self, relaxation: Relaxation, statement: Statement) -> None:
        i = statement.of
        relaxation.activity(i)["deadline"] = relaxation.problem.activities[i].deadline

    def differences(self, problem: Problem, statement: Statement) -> Iterator[Difference]:
        i = statement.of
        yield Difference(end_point(i), ORIGIN, -(problem.activities[i].deadline or 0), statement)


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
        _Use(),
        _Precedence(),
        _Release(),
        _Start(),
        _LatestStart(),
        _Deadline(),
        _Duration(),
    )
}


def all_statements(problem: Problem) -> list[Statement]:
    """Everything the task says, in canonical order."""
    return [statement for kind in KINDS.values() for statement in kind.all(problem)]


def in_canonical_order(statements: Iterable[Statement]) -> list[Statement]:
    """By kind, and in each kind as the problem has them."""
    rank = {kind: k for k, kind in enumerate(KINDS)}
    return sorted(statements, key=lambda s: (rank[s.kind], s.of, s.use))


def pointer_of(problem: Problem, statement: Statement) -> Pointer:
    """Where a statement stands in the document."""
    return KINDS[statement.kind].pointer(problem, statement)


def differences_of(problem: Problem, statements: Iterable[Statement]) -> list[Difference]:
    """What statements demand of time."""
    return [d for s in statements for d in KINDS[s.kind].differences(problem, s)]


def how_time_is(activities: Iterable[int]) -> Iterator[Difference]:
    """What nobody needs to state: nothing starts before t = 0 or ends before it starts."""
    for i in activities:
        yield Difference(ORIGIN, start_point(i), 0)
        yield Difference(start_point(i), end_point(i), 0)


def problem_of(problem: Problem, statements: Iterable[Statement], free_length: int) -> Problem:
    """The problem that states nothing else.

    It has only the activities and resources that are spoken of. `free_length` is how long an
    activity can be whose duration is not stated; no schedule must need more.
    """
    relaxation = Relaxation(problem, free_length)
    for statement in statements:
        KINDS[statement.kind].state(relaxation, statement)
    return relaxation.build()
