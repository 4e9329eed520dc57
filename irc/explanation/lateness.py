"""Explains why an action or an order is late: by how much, what makes it so, and what would help.

Late work is late for one of two reasons. Either it cannot be on time: then some statements and its
due date cannot hold together. Or it could, but other work would pay for it. What would help is one
change at a time, each verified by solving the changed task.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any

from irc.diagnostics import Code, Diagnostic, Findings, InputError, Report, did_you_mean
from irc.diagnostics.source import Pointer, Source, pointer_text
from irc.driver.judge import Answer
from irc.driver.solve import solve_task
from irc.explanation.chain import critical_chain
from irc.explanation.elements import Element, without
from irc.explanation.explain import TARGET, explain_within, steps_of
from irc.explanation.result import ChainStep, RenderedStatement, located
from irc.model import Action, DurationRange, Group, Task
from irc.model.canonical import written_task
from irc.model.from_document import to_task
from irc.model.quantities import Number
from irc.model.times import format_number, json_number
from irc.outcome import Outcome
from irc.schedule import Schedule, Status
from irc.targets import Budget, Cancellation, SolveOptions
from irc.targets.interrupt import ended_by_interrupt, lost

MOST_CHANGES = 12
"""At most this many changes are tried."""


@dataclass(frozen=True, slots=True)
class Change:
    """A change of one thing after which the work is on time, as the best plan found has it.

    `size` is how great it is, as a part of what was there before; the smallest is the cheapest.
    """

    text: str
    pointer: Pointer
    value: Any
    size: Fraction
    ends: Number

    def to_dict(self) -> dict[str, Any]:
        """The object in `changes`."""
        return {
            "text": self.text,
            "pointer": pointer_text(self.pointer),
            "value": self.value,
            "end": json_number(self.ends),
        }


@dataclass(frozen=True, slots=True)
class Shift:
    """Other work that would be later, or earlier, if the work in question were on time."""

    name: str
    late: Number
    would_be: Number

    def to_dict(self) -> dict[str, Any]:
        """The object in `instead`."""
        return {
            "name": self.name,
            "late": json_number(self.late),
            "would_be": json_number(self.would_be),
        }


@dataclass(frozen=True)
class Lateness:
    """Why an action or an order is late, in the task's time unit.

    - `late` is how much later than `due` it ends in the plan; 0 if it is on time.
    - `possible`: whether it could be on time. If not, `conflict` are statements that cannot hold
      together with its due date. If so, `instead` is who would be later. None: not known in time.
    - `chain` leads from t = 0 to its end in the plan; None where there is none to be shown.
    - `changes` would help, the cheapest first; each was verified.
    """

    name: str
    status: Status
    time_unit: str
    due: Number | None = None
    end: Number | None = None
    possible: bool | None = None
    minimal: bool = True
    conflict: tuple[RenderedStatement, ...] = ()
    instead: tuple[Shift, ...] = ()
    chain: tuple[ChainStep, ...] | None = None
    changes: tuple[Change, ...] = ()
    schedule: Schedule | None = None
    source: Source | None = field(default=None, repr=False)
    interrupted: bool = False

    @property
    def late(self) -> Number:
        """How much later than its due date it ends; 0 if it is on time or has none."""
        if self.due is None or self.end is None:
            return 0
        return max(0, self.end - self.due)

    @property
    def outcome(self) -> Outcome:
        """How the call ended: as that of solving the task."""
        return Outcome.of(str(self.status), ())

    def to_dict(self) -> dict[str, Any]:
        """The document that `irc explain --why NAME --format json` prints."""
        return {
            "irc_lateness": "1",
            "name": self.name,
            "status": str(self.status),
            "due": None if self.due is None else json_number(self.due),
            "end": None if self.end is None else json_number(self.end),
            "late": json_number(self.late),
            "possible": self.possible,
            "conflict": [statement.to_dict() for statement in self.conflict],
            "minimal": self.minimal,
            "instead": [shift.to_dict() for shift in self.instead],
            "chain": None if self.chain is None else [step.to_dict() for step in self.chain],
            "changes": [change.to_dict() for change in self.changes],
            **({} if self.outcome.answered else {"outcome": self.outcome.to_dict()}),
        }

    def _repr_html_(self) -> str:
        """The same for notebooks, with what cannot hold together, and a picture of the plan."""
        from irc.display.html import heading, items
        from irc.display.svg import bars_svg

        head, *lines = str(self).split("\n")
        if self.schedule is None:
            return heading(head)
        said = [*(statement.text for statement in self.conflict), *(line.strip() for line in lines)]
        picture = bars_svg(self.schedule.bars({self.name}), self.time_unit, head)
        return heading(head) + picture + (items(said) if said else "")

    def __str__(self) -> str:
        """The headline, and a line for each change that would help."""
        if self.end is None:
            return f"{self.name}: {self.status}"
        when = f"ends at {format_number(self.end)} {self.time_unit}"
        if self.due is not None:
            when += (
                f", {format_number(self.late)} {self.time_unit} late" if self.late else ", on time"
            )
        return "\n".join([f"{self.name} {when}", *(f"  {c.text}" for c in self.changes)])


def explain_lateness(
    task: Task,
    name: str,
    time_limit: float | None = None,
    *,
    cancel: Cancellation | None = None,
    spent: float = 0.0,
) -> Lateness:
    """Returns why the action or group `name` is late in the best plan of a task.

    `time_limit` is in seconds of wall-clock time for all of it. Raises `InputError` where there is
    no such action or group, or where solving does.
    """
    target = _target(task, name)
    with ended_by_interrupt(cancel) as ending:
        budget = Budget(time_limit, spent=spent, cancel=ending)
        answer = solve_task(task, _OPTIONS, budget.share(0.4))
        if answer.schedule.status is Status.UNKNOWN:
            lost(ending)
        found = _explained(task, target, answer, budget)
        return replace(found, source=task.source, interrupted=budget.is_cancelled)


_OPTIONS = SolveOptions(TARGET, time_limit=None, workers=1, seed=0)


@dataclass(frozen=True)
class _Target:
    """The work in question, its place in the document and its actions."""

    name: str
    pointer: Pointer
    actions: tuple[str, ...]
    due: Number | None
    deadline: Number | None

    def end(self, schedule: Schedule) -> Number | None:
        """When the last of its actions ends; None if none is present."""
        wanted = set(self.actions)
        return max((e.end for e in schedule.entries if e.id in wanted), default=None)


def _target(task: Task, name: str) -> _Target:
    parts: list[tuple[str, int, Action | Group]] = [
        *(("groups", k, group) for k, group in enumerate(task.groups)),
        *(("actions", k, action) for k, action in enumerate(task.actions)),
    ]
    for field_name, k, part in parts:
        if part.id == name:
            actions = part.actions if isinstance(part, Group) else (part.id,)
            due = None if part.due is None else task.number(part.due)
            deadline = None if part.deadline is None else task.number(part.deadline)
            return _Target(name, (field_name, k), tuple(actions), due, deadline)
    known = [part.id for _, _, part in parts]
    hint = did_you_mean(name, known) or "name one of the task's actions or groups"
    message = f"there is no action or group {name!r}"
    raise InputError(Report((Diagnostic(Code.UNKNOWN_NAME, message, hint=hint),), task.source))


def _explained(task: Task, target: _Target, answer: Answer, budget: Budget) -> Lateness:
    schedule = answer.schedule
    found = Lateness(target.name, schedule.status, task.time_unit, target.due, schedule=schedule)
    if not schedule.answered or (end := target.end(schedule)) is None:
        return found
    found = replace(found, end=end, chain=_chain(task, target, answer))
    if target.due is None or not found.late:
        return found
    found = _possibility(task, target, found, budget.share(0.5))
    return replace(found, changes=tuple(_changes(task, target, found, budget)))


def _chain(task: Task, target: _Target, answer: Answer) -> tuple[ChainStep, ...] | None:
    """The critical chain to the work's end; None for tasks with choices, state or calendars."""
    problem = answer.problem
    if not problem.is_plain or problem.has_calendars or problem.has_setups:
        return None
    wanted = set(target.actions)
    last = [i for i, activity in enumerate(problem.activities) if activity.id in wanted]
    links = critical_chain(problem, answer.schedule, last)
    return None if links is None else steps_of(task, problem, links)


# --- could it be on time? -----------------------------------------------------------------------


def _possibility(task: Task, target: _Target, found: Lateness, budget: Budget) -> Lateness:
    """Whether it could be on time, and what stands against it."""
    assert target.due is not None
    latest = target.due if target.deadline is None else min(target.deadline, target.due)
    on_time = _edited(task, (*target.pointer, "deadline"), json_number(latest))
    if on_time is None:
        return found
    answer = solve_task(on_time, _OPTIONS, budget.share(0.5))
    if answer.schedule.answered:
        instead = tuple(_instead(task, target, found.schedule, answer.schedule))
        return replace(found, possible=True, instead=instead)
    if answer.schedule.status is not Status.INFEASIBLE:
        return found
    conflict = explain_within(on_time, budget)
    statements = [_as_due(task, target, statement) for statement in conflict.conflict]
    return replace(
        found,
        possible=False,
        conflict=located(statements, task.source),
        minimal=conflict.minimal,
    )


def _as_due(task: Task, target: _Target, statement: RenderedStatement) -> RenderedStatement:
    """A statement of the conflict; the limit that stands for the due date is named as that."""
    if statement.pointer != (*target.pointer, "deadline") or target.due is None:
        return statement
    if target.deadline is not None and target.deadline <= target.due:
        return statement
    text = f"{target.name!r} is due at {format_number(target.due)} {task.time_unit}"
    return RenderedStatement("due", text, (*target.pointer, "due"))


def _instead(
    task: Task, target: _Target, before: Schedule | None, after: Schedule
) -> Iterator[Shift]:
    """Other work with a due date that would be later."""
    assert before is not None
    others: Iterable[Action | Group] = (*task.groups, *task.actions)
    for other in others:
        if other.due is None or other.id == target.name:
            continue
        one = _target(task, other.id)
        late, would_be = (_late(one, schedule) for schedule in (before, after))
        if would_be > late:
            yield Shift(other.id, late, would_be)


def _late(target: _Target, schedule: Schedule) -> Number:
    end = target.end(schedule)
    return 0 if end is None or target.due is None else max(0, end - target.due)


# --- what would help ----------------------------------------------------------------------------


def _changes(task: Task, target: _Target, found: Lateness, budget: Budget) -> Iterator[Change]:
    """The changes that help, the cheapest first."""
    candidates = sorted(_candidates(task, target, found), key=lambda change: change.size)
    candidates = candidates[:MOST_CHANGES]
    for k, change in enumerate(candidates):
        if budget.is_over:
            break
        changed = _edited(task, change.pointer, change.value)
        if changed is None:
            continue
        part = budget.share(1 / (len(candidates) - k))
        schedule = solve_task(changed, _OPTIONS, part).schedule
        after = _target(changed, target.name)
        end = after.end(schedule) if schedule.answered else None
        if end is not None and not _late(after, schedule):
            yield replace(change, ends=end)


def _candidates(task: Task, target: _Target, found: Lateness) -> Iterator[Change]:
    """Changes of what makes it late: of its chain and its conflict; and of its due date."""
    late = found.late
    first: dict[Pointer, RenderedStatement] = {}
    for statement in (*found.conflict, *(step.statement for step in found.chain or ())):
        first.setdefault(statement.pointer, statement)
    for statement in first.values():
        yield from _of_statement(task, statement, late)
    due = target.due or 0
    text = f"let {target.name!r} be due {format_number(late)} {task.time_unit} later"
    later = json_number(due + late)
    yield Change(text, (*target.pointer, "due"), later, _part(late, max(due, -due)), 0)


def _of_statement(task: Task, statement: RenderedStatement, late: Number) -> Iterator[Change]:
    pointer, unit = statement.pointer, task.time_unit
    amount = f"{format_number(late)} {unit}"
    if pointer[-1:] == ("duration",) and pointer[0] == "actions":
        owner: Any = task.actions[int(pointer[1])]
        name = repr(owner.id)
        if len(pointer) == 5:
            owner = owner.modes[int(pointer[3])]
            name = f"{name} in mode {owner.id!r}"
        length = owner.duration
        if length is None or isinstance(length, DurationRange):
            return
        taken = task.number(length)
        if taken >= late:
            less = json_number(taken - late)
            yield Change(f"{name} takes {amount} less", pointer, less, _part(late, taken), 0)
    elif statement.kind in ("capacity", "hand_over", "order"):
        k = int(pointer[1])
        resource = task.resources[k]
        if resource.kind != "reservoir":
            text = f"one more of {resource.id!r}"
            yield Change(text, pointer, resource.capacity + 1, Fraction(1, resource.capacity), 0)
    elif statement.kind == "release":
        action = task.actions[int(pointer[1])]
        release = task.number(action.release)
        if release >= late:
            text = f"{action.id!r} is released {amount} earlier"
            yield Change(text, pointer, json_number(release - late), _part(late, release), 0)
    elif statement.kind in ("window", "precedence", "calendar", "condition"):
        yield Change(f"without this: {statement.text}", pointer, None, Fraction(1), 0)


def _part(amount: Number, whole: Number) -> Fraction:
    return Fraction(amount) / Fraction(whole) if whole else Fraction(1)


def _edited(task: Task, pointer: Pointer, value: Any) -> Task | None:
    """The task with another value at a place, or without it (None); None if it cannot be."""
    edit = Element("", pointer, "", value)
    return to_task({**without(written_task(task), [edit]), "events": []}, Findings())
