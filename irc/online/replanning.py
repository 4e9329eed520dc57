"""One step of repair: what has begun stays, what is open is solved anew, on either target.

What is half-done is finished if any continuation allows it. Only where a proof says that none does,
orders are given up, as few as possible: first it is found which can be finished together.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import combinations
from typing import TYPE_CHECKING, Any

from irc.backend import (
    Backend,
    EngineFailed,
    EngineMissing,
    Limits,
    ObjectiveLevel,
    OnProgress,
    Outcome,
    Program,
    UnknownTarget,
    get_backend,
    require_support,
)
from irc.compiler import SHORTCUT_ENGINE, finish, schedule_of
from irc.diagnostics import Code, Diagnostic, Findings, InputError, Report
from irc.lower import lower
from irc.model import Event, Task
from irc.online.conflicts import overloaded
from irc.online.facts import UnexplainedError, ticks_of
from irc.online.freeze import Frozen, freeze, with_groups
from irc.online.history import ABANDONED, CANCELLED, History, ids
from irc.online.rebase import PastError, rebase
from irc.online.settle import settled
from irc.online.state import Key, key_of
from irc.passes import order_from_state, resource_bounds, run_passes
from irc.passes.contention import drop_uncontended, merge_pools
from irc.passes.critical_path import heads_and_tails
from irc.passes.grid import bound_on_grid
from irc.passes.reduction import reduce_transitively
from irc.pipeline import refusals_told
from irc.problem import Problem
from irc.retime import AnswerError, earliest_schedule
from irc.schedule import Entry, Schedule, Status
from irc.times import Number, json_number
from irc.worth import worth

if TYPE_CHECKING:
    from irc.backend import Engine

Judge = Callable[[Schedule], str | None]

Found = tuple[Outcome, Problem, tuple[int, ...]]
"""An outcome, the problem it answers, and the groups given up."""

LEAST_SECONDS = 0.1
"""An engine is always given so much."""

PROVER = "cpsat"
"""Says which orders cannot be finished, where the target's engines prove no such thing."""

GIVEN_UP_TRIED = 200
"""So many choices of orders to give up are tried at most, smaller ones first."""

_PASSES = (
    reduce_transitively,
    drop_uncontended,
    heads_and_tails,
    resource_bounds,
    bound_on_grid,
)


@dataclass(frozen=True, slots=True)
class Means:
    """What a step is solved with. `stability` is a part of the objective, 0 to 1 and beyond."""

    target: str = "cpsat"
    engine: str = "auto"
    limits: Limits = field(default_factory=Limits)
    stability: Fraction = Fraction(0)
    on_progress: OnProgress | None = None


@dataclass(frozen=True, slots=True)
class Step:
    """What one instant came to.

    `completed` and `running` are ids as of then, `moved` counts the planned actions whose start,
    mode or resources differ from before (or that are gone), `abandoned` are half-done groups that
    cannot be finished. `schedule` is the whole history with the new plan, an answer to `task`.
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

    def as_json(self) -> dict[str, Any]:
        """The step as `irc simulate --format json` has it."""
        return {
            "at": json_number(self.at),
            "event": [event.id for event in self.events],
            "completed": list(self.completed),
            "running": list(self.running),
            "moved": self.moved,
            "abandoned": list(self.abandoned),
            "notes": [note.as_json() for note in self.notes],
            "schedule": self.schedule.as_json(),
        }


def solve_step(
    task: Task, history: History, at: Number, means: Means, events: tuple[Event, ...] = ()
) -> Step:
    """The best continuation of a history at `at`, for the task as it is in force.

    Raises `InputError` (the target refuses the task, or the history does not fit it),
    `UnknownTarget`, `EngineMissing` or `EngineFailed`.
    """
    began = time.perf_counter()
    state = history.state(at)
    backend = get_backend(means.target)
    engine = _engine(means.target, means.engine)
    require_support(task, backend)
    instants = [at, *(t for e in history.entries.values() for t in (e.start, e.end))]
    problem = replace(lower(task, instants), stability=means.stability)
    problem = merge_pools(problem, overloaded(problem, state.running))
    frozen = _frozen(task, problem, history, at)
    solver = _Solver(task, frozen, history, at, backend, engine, means)
    with refusals_told(task):
        outcome, whole, given_up = solver.best()
    if outcome.schedule is not None:
        told = with_status(outcome.schedule, frozen, history, given_up)
        outcome = replace(outcome, schedule=told)
    schedule = finish(task, whole, outcome, means.target, time.perf_counter() - began)
    notes = outcome.notes
    if schedule.answered:
        notes = (*notes, *_carried(task, schedule, at))
    return Step(
        at,
        events,
        ids(state.completed),
        ids(state.running),
        moved(state.open, schedule, history) if schedule.answered else 0,
        schedule,
        task,
        notes,
        tuple(problem.groups[k].id for k in given_up),
    )


def _engine(target: str, name: str = "auto") -> Engine:
    engines = get_backend(target).engines()
    if name not in engines:
        raise UnknownTarget("engine", name, list(engines))
    return engines[name]


def _frozen(task: Task, problem: Problem, history: History, at: Number) -> Frozen:
    try:
        return freeze(problem, history, at, ticks_of(problem, at))
    except UnexplainedError as error:
        entry = error.entry
        findings = Findings()
        held = ", ".join(sorted(entry.resources)) or "nothing"
        findings.add(
            Code.BAD_SCHEDULE,
            f"{entry.id!r} has begun, and the schedule says that it holds {held}"
            + (f" in mode {entry.mode!r}" if entry.mode is not None else "")
            + ", which the task does not allow",
            hint="give the schedule that is being carried out, as `irc solve` wrote it",
        )
        raise InputError(Report(tuple(findings.items), task.source)) from None


@dataclass
class _Solver:
    """Looks for the best continuation, giving up half-done orders only on a proof."""

    task: Task
    frozen: Frozen
    history: History
    at: Number
    backend: Backend
    engine: Engine
    means: Means

    def __post_init__(self) -> None:
        self.began = time.perf_counter()

    def best(self) -> Found:
        """The best continuation that gives up as few half-done groups as possible."""
        half_done = self.frozen.half_done()
        nothing, problem = self.attempt(())
        if nothing.schedule is not None or not half_done:
            return nothing, problem, ()
        if nothing.status is Status.UNKNOWN and not self.backend.proves:
            prover = replace(self, backend=get_backend(PROVER), engine=_engine(PROVER))
            given_up = prover.best()[2]
            return (*self.attempt(given_up), given_up) if given_up else (nothing, problem, ())
        sizes = range(1, 1 + len(half_done))
        choices = (chosen for size in sizes for chosen in combinations(half_done, size))
        found: list[Found] = []
        certain = nothing.status is not Status.UNKNOWN
        for tried, given_up in enumerate(choices):
            if found and len(given_up) > len(found[0][2]):
                break
            spent = self.left is not None and self.left <= 0
            certain = certain and not spent and tried < GIVEN_UP_TRIED
            if not certain:
                break
            outcome, its = self.attempt(given_up)
            if outcome.schedule is not None:
                found.append((outcome, its, given_up))
            certain = outcome.status is not Status.UNKNOWN
        if found:
            return min(found, key=lambda f: _value(f[1], f[0]))
        # Without a proof that the others can be finished no more, none is given up.
        return nothing if certain else replace(nothing, status=Status.UNKNOWN), problem, ()

    @property
    def left(self) -> float | None:
        """Seconds until the limit."""
        seconds = self.means.limits.seconds
        return None if seconds is None else seconds - (time.perf_counter() - self.began)

    def attempt(self, given_up: Sequence[int]) -> tuple[Outcome, Problem]:
        """The outcome where these groups are given up, and the problem it answers."""
        frozen = order_from_state(with_groups(self.frozen, given_up))
        whole, impossible = _passed(frozen)
        if impossible is not None:
            return impossible, whole
        if not whole.has_contention and not any(whole.earlier):
            return _by_critical_path(whole), whole
        missing = self.engine.missing()
        if missing is not None:
            raise EngineMissing(missing)
        if self.backend.begins_now:
            return self._from_now(frozen, whole, given_up), whole
        return self._solved(whole), whole

    def _solved(self, problem: Problem, judge: Judge | None = None) -> Outcome:
        program = Program(self.backend, self.task, problem, judge=judge)
        limits = self.means.limits
        if self.left is not None:
            limits = replace(limits, seconds=max(LEAST_SECONDS, self.left))
        return self.engine.solve(program, limits, self.means.on_progress)

    def judged(self, schedule: Schedule, given_up: Sequence[int]) -> str | None:
        """What the validator has against a whole history; None: nothing."""
        from irc.validation import validate

        told = with_status(schedule, self.frozen, self.history, given_up)
        verdict = validate(self.task, told, self.at)
        return None if verdict.valid else "; ".join(v.message for v in verdict.violations[:2])

    def _from_now(self, frozen: Problem, whole: Problem, given_up: Sequence[int]) -> Outcome:
        """The outcome of what is left, with the history before it."""
        now = self.frozen.now
        try:
            rebased = rebase(frozen, self.frozen.facts, now)
        except PastError as error:
            return _impossible(str(error))
        left, impossible = _passed(rebased.problem)
        if impossible is not None:
            return impossible
        if whole.bound.value - now > left.bound.value:
            left = replace(left, bound=replace(whole.bound, value=whole.bound.value - now))

        def judge(schedule: Schedule) -> str | None:
            """What the validator says of a plan with the history before it."""
            try:
                merged = rebased.merged(whole, schedule)
            except AnswerError as error:
                return str(error)
            return self.judged(merged, given_up)

        found = self._solved(left, judge) if left.has_contention else _by_critical_path(left)
        if found.schedule is None:
            return found
        try:
            schedule = rebased.merged(whole, found.schedule)
        except AnswerError as error:
            raise EngineFailed(f"the answer does not continue what has begun: {error}") from None
        schedule = settled(whole, schedule, self.means.stability)
        return _of_whole(found, left, whole, schedule, now)


def _passed(problem: Problem) -> tuple[Problem, Outcome | None]:
    """The problem after the passes; an outcome where they show that it has no schedule."""
    try:
        problem = run_passes(problem, _PASSES)
    except ValueError:
        return problem, _impossible("what has begun and the lags of the task contradict each other")
    if problem.deadline is not None and problem.bound.value > problem.deadline:
        bound = f"no continuation ends before {problem.time_text(problem.bound.value)}"
        return problem, _impossible(f"{bound} ({problem.bound.reason})")
    return problem, None


def _by_critical_path(problem: Problem) -> Outcome:
    """Everything as early as it can be: what is too late even so shows that nothing is possible."""
    try:
        placed = earliest_schedule(problem)
    except AnswerError as error:
        return _impossible(str(error))
    for i, (activity, place) in enumerate(zip(problem.activities, placed, strict=True)):
        deadline = problem.effective_deadline(i)
        if deadline is not None and place.end > deadline:
            end, limit = problem.time_text(place.end), problem.time_text(deadline)
            return _impossible(f"{activity.id!r} cannot end before {end}, and must by {limit}")
        if activity.start is not None and place.start > activity.start:
            start, fixed = problem.time_text(place.start), problem.time_text(activity.start)
            return _impossible(f"{activity.id!r} must start at {fixed}, and cannot before {start}")
    schedule = schedule_of(problem, placed)
    return Outcome(Status.OPTIMAL, SHORTCUT_ENGINE, schedule, problem.bound.value)


def _of_whole(
    found: Outcome, left: Problem, whole: Problem, schedule: Schedule, now: int
) -> Outcome:
    """An outcome of what is left as one of the whole: each value is off by what history adds."""
    assert found.schedule is not None
    part, all_of_it = worth(left, found.schedule), worth(whole, schedule)
    levels = []
    for level in found.levels:
        bound = level.bound
        if bound is not None and level.name == "makespan":
            bound = whole.to_units(now) + bound if bound else None
        elif bound is not None:
            bound += all_of_it[level.name] - part[level.name]
        levels.append(ObjectiveLevel(level.name, all_of_it[level.name], bound))
    bound_now = now + found.bound if found.bound else 0
    status = found.status
    if status is Status.OPTIMAL and whole.stability:
        status = Status.FEASIBLE
    return replace(found, status=status, schedule=schedule, bound=bound_now, levels=tuple(levels))


def _impossible(why: str) -> Outcome:
    note = Diagnostic(Code.TOO_LATE, why, hint="a later deadline or more capacity would be needed")
    return Outcome(Status.INFEASIBLE, SHORTCUT_ENGINE, notes=(note,))


def _value(problem: Problem, outcome: Outcome) -> tuple[Number, ...]:
    """The objectives in their order; less is better."""
    assert outcome.schedule is not None
    values = worth(problem, outcome.schedule)
    return tuple(-values[n] if n == "reward" else values[n] for n in problem.levels)


def with_status(
    schedule: Schedule, frozen: Frozen, history: History, given_up: Sequence[int]
) -> Schedule:
    """The entries of what was cancelled, or ran for an order that is given up, say so."""
    groups = frozen.problem.groups
    kept = {i for k, g in enumerate(groups) if k not in given_up for i in g.members}
    lost = {
        frozen.problem.activities[i].id
        for k in given_up
        for i in groups[k].members
        if i not in kept
    }

    def told(entry: Entry) -> Entry:
        before = history.entries.get(key_of(entry))
        cancelled = before is not None and before.status == CANCELLED
        status = CANCELLED if cancelled else ABANDONED if entry.id in lost else None
        return replace(entry, status=status)

    entries = (told(e) for e in schedule.entries if e.id not in frozen.helpers)
    return replace(schedule, entries=tuple(entries))


def _carried(task: Task, schedule: Schedule, at: Number) -> list[Diagnostic]:
    """The conflicts that only history causes. Raises `EngineFailed` where there are others."""
    from irc.validation import validate

    verdict = validate(task, schedule, at)
    if not verdict.valid:
        reasons = "; ".join(v.message for v in verdict.violations[:3])
        raise EngineFailed(f"the answer was rejected by the validator: {reasons}")
    return [
        Diagnostic(
            Code.CARRIED,
            violation.message,
            hint="it has begun already, so it is carried on with; nothing else may add to it",
        )
        for violation in getattr(verdict, "carried", ())
    ]


def moved(planned: Sequence[Entry], schedule: Schedule, history: History) -> int:
    """How many planned occurrences, still wanted, are elsewhere now, or not there any more."""
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
