"""Lowers a `Task` to a `Problem`: times become ticks, names become indexes, in canonical order."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from math import gcd

from irc.diagnostics.source import Pointer
from irc.lowering.elements import (
    ToTicks,
    natural_order,
    open_demands_of,
    pool_of,
    requirements,
    span,
    ticks_or_none,
)
from irc.model import Action, DurationRange, Precedence, Task
from irc.model.quantities import Number, TimeError
from irc.model.times import Clock, Instant, common_tick
from irc.problem import Activity, Arc, Contention, Problem, Renewable, Setups, Window

_FROM_END = {"finish-start", "finish-finish"}
_TO_END = {"finish-finish", "start-finish"}


def lower(task: Task, instants: Iterable[Number] = ()) -> Problem:
    """The whole task as integers, in a tick that also divides the `instants` (in its unit).

    Elements with unknown names and actions with faulty durations are left out: the structural
    checks report them.
    """
    clock = task.clock
    simple = [action.is_simple for action in task.actions]
    actions = {
        a.id: i
        for i, a in reversed(list(enumerate(task.actions)))
        if simple[i] or _has_sense(a, clock)
    }
    calendars = None
    if task.calendars:
        from irc.lowering.work import expanded

        calendars = expanded(task, clock, instants)
        instants = calendars.instants
    to_ticks, tick = _tick(task, actions.values(), simple, clock, instants)
    ids = sorted(actions, key=natural_order)
    index = {name: k for k, name in enumerate(ids)}
    resources = {r.id: i for i, r in reversed(list(enumerate(task.resources)))}
    renewable = (r for r in resources if task.resources[resources[r]].kind != "reservoir")
    resource_ids = sorted(renewable, key=natural_order)
    resource_index = {name: k for k, name in enumerate(resource_ids)}
    family_names = _families(task)
    families = {name: k for k, name in enumerate(family_names)}
    renewables = tuple(
        _renewable(task, resources[name], to_ticks, families) for name in resource_ids
    )
    if calendars is not None:
        renewables = tuple(calendars.renewable(r, to_ticks) for r in renewables)
    problem = Problem(
        name=task.name,
        time_unit=task.time_unit,
        tick=tick,
        activities=tuple(
            _simple(task.actions[i], i, to_ticks)
            if simple[i]
            else _activity(task.actions[i], i, resource_index, families, to_ticks)
            for i in map(actions.__getitem__, ids)
        ),
        resources=renewables,
        families=family_names,
        contention=Contention(tuple(pool_of(r, k) for k, r in enumerate(renewables))),
        arcs=_arcs(task, index, to_ticks),
        deadline=None if task.deadline is None else ticks_or_none(task.deadline, to_ticks),
    )
    if _is_rich(task, simple):
        from irc.lowering.choices import add_choices

        problem = add_choices(problem, task, index, to_ticks)
    if task.sequences:
        from irc.lowering.sequences import add_sequences

        problem = add_sequences(problem, task, index)
    if calendars is not None or any(a.breaks != "avoid" for a in task.actions):
        from irc.lowering.work import add_work

        problem = add_work(problem, task, calendars, to_ticks)
    return problem


def _is_rich(task: Task, simple: Sequence[bool]) -> bool:
    """Whether a task has more than actions that occur once, resources and precedence."""
    return bool(
        task.state
        or task.groups
        or task.goals
        or task.couplings
        or task.select
        or task.objective != ("minimize_makespan",)
        or any(r.kind == "reservoir" for r in task.resources)
        or any(not s and _is_rich_action(a) for a, s in zip(task.actions, simple, strict=True))
    )


def _is_rich_action(action: Action) -> bool:
    return bool(
        action.modes
        or action.occurs != "once"
        or action.consumes
        or action.produces
        or action.due is not None
        or action.reward
        or action.cost
    )


def _families(task: Task) -> tuple[str, ...]:
    """The families of a task with set-ups or loads, in order."""
    if not any(r.setups is not None or r.kind == "batch" for r in task.resources):
        return ()
    from irc.lowering.setups import families_of

    return families_of(task)


def _renewable(task: Task, index: int, to_ticks: ToTicks, families: Mapping[str, int]) -> Renewable:
    resource = task.resources[index]
    at: Pointer = ("resources", index)
    setups: Setups | None = None
    if resource.kind != "batch" and (resource.setups is not None or resource.no_idle):
        from irc.lowering.setups import lowered_setups

        setups = lowered_setups(resource, families, to_ticks)
    batch = resource.kind == "batch"
    if not resource.availability:
        return Renewable(resource.id, resource.capacity, at, setups=setups, batch=batch)
    windows = set()
    for window in resource.availability:
        start, end = ticks_or_none(window.from_, to_ticks), ticks_or_none(window.to, to_ticks)
        if start is not None and end is not None and start < end:
            windows.add(Window(start, end, window.capacity))
    return Renewable(resource.id, resource.capacity, at, tuple(sorted(windows)), setups, batch)


def _has_sense(action: Action, clock: Clock) -> bool:
    """Whether the action has durations, with no negative one and no empty range."""
    if action.duration is None and not action.modes:
        return False
    try:
        return all(0 <= lo <= hi for lo, hi in _duration_numbers(action, clock))
    except TimeError:
        return False


def _duration_numbers(action: Action, clock: Clock) -> Iterator[tuple[Number, Number]]:
    durations = [m.duration for m in action.modes] if action.modes else [action.duration]
    for duration in durations:
        if isinstance(duration, DurationRange):
            yield clock.number(duration.min), clock.number(duration.max)
        elif duration is not None:
            value = clock.number(duration)
            yield value, value


def _tick(
    task: Task,
    kept: Iterable[int],
    simple: Sequence[bool],
    clock: Clock,
    instants: Iterable[Number],
) -> tuple[ToTicks, Fraction]:
    """(a function from times to ticks, the largest tick that divides every time of the task)."""
    numbers: dict[Instant, Number] = {instant: instant for instant in instants}
    for value in _times(task, kept, simple):
        if value not in numbers:
            try:
                numbers[value] = clock.number(value)
            except TimeError:
                continue
    if all(type(n) is int for n in numbers.values()):
        whole = gcd(*(int(n) for n in numbers.values())) or 1
        # Only whole numbers: dividing fractions would take longer than everything else.
        return {value: int(number) // whole for value, number in numbers.items()}.__getitem__, (
            Fraction(whole)
        )
    tick = common_tick(numbers.values())
    return {value: int(number / tick) for value, number in numbers.items()}.__getitem__, tick


def _times(task: Task, kept: Iterable[int], simple: Sequence[bool]) -> Iterator[Instant]:
    """Every time of the kept elements, as it was written."""
    if task.deadline is not None:
        yield task.deadline
    for i in kept:
        action = task.actions[i]
        if simple[i]:
            yield action.duration  # type: ignore[misc]
            continue
        durations = [m.duration for m in action.modes] if action.modes else [action.duration]
        for duration in durations:
            if isinstance(duration, DurationRange):
                yield duration.min
                yield duration.max
            elif duration is not None:
                yield duration
        yield action.release
        if action.deadline is not None:
            yield action.deadline
        if action.start is not None:
            yield action.start
        if action.latest_start is not None:
            yield action.latest_start
        if action.max_pause is not None:
            yield action.max_pause
        if action.earliest_end is not None:
            yield action.earliest_end
        if action.due is not None:
            yield action.due
    for group in task.groups:
        if group.deadline is not None:
            yield group.deadline
        if group.due is not None:
            yield group.due
    for resource in task.resources:
        for window in resource.availability:
            yield window.from_
            yield window.to
        if resource.setups is not None:
            for row in resource.setups.times:
                yield row.time
    for variable in task.state:
        for change in variable.changes:
            yield change.at
    for edge in task.precedence:
        yield edge.min_lag
        if edge.max_lag is not None:
            yield edge.max_lag


def _simple(action: Action, index: int, to_ticks: ToTicks) -> Activity:
    ticks = to_ticks(action.duration)  # type: ignore[arg-type]
    return Activity(action.id, ticks, ticks, origin=("actions", index))


def _activity(
    action: Action,
    index: int,
    resource_index: dict[str, int],
    families: Mapping[str, int],
    to_ticks: ToTicks,
) -> Activity:
    duration = action.duration
    if action.modes:
        spans = [span(m.duration, to_ticks) for m in action.modes]
        shortest, longest = min(s[0] for s in spans), max(s[1] for s in spans)
    else:
        shortest, longest = span(duration, to_ticks)
    uses = requirements(action.uses, resource_index, families) if action.uses else ()
    return Activity(
        id=action.id,
        duration_min=shortest,
        duration_max=longest,
        release=ticks_or_none(action.release, to_ticks) or 0,
        deadline=None if action.deadline is None else ticks_or_none(action.deadline, to_ticks),
        start=None if action.start is None else ticks_or_none(action.start, to_ticks),
        latest_start=None
        if action.latest_start is None
        else ticks_or_none(action.latest_start, to_ticks),
        earliest_end=None
        if action.earliest_end is None
        else ticks_or_none(action.earliest_end, to_ticks),
        uses=uses,
        open_demands=open_demands_of(uses) if longest else (),
        origin=("actions", index),
    )


def _arcs(task: Task, index: dict[str, int], to_ticks: ToTicks) -> tuple[Arc, ...]:
    """The arcs of a task: plain precedences first, then the others, in canonical order, once."""
    plain: dict[tuple[int, int], int] = {}
    others: dict[tuple[int, ...], Arc] = {}
    for k, edge in enumerate(task.precedence):
        before, after = index.get(edge.before), index.get(edge.after)
        if before is None or after is None or before == after:
            continue
        if edge.max_lag is None and edge.min_lag == 0 and edge.type == "finish-start":
            plain.setdefault((before, after), k)
        else:
            arc = _arc(edge, k, index, to_ticks)
            if arc._replace(origin=0) == Arc(before, after):  # A lag of 0 written with a unit.
                plain.setdefault((before, after), k)
            else:
                others.setdefault(_arc_order(arc), arc)
    return (
        *(Arc(before, after, origin=k) for (before, after), k in sorted(plain.items())),
        *(others[key] for key in sorted(others)),
    )


def _arc(edge: Precedence, origin: int, index: dict[str, int], to_ticks: ToTicks) -> Arc:
    return Arc(
        index[edge.before],
        index[edge.after],
        edge.type in _FROM_END,
        edge.type in _TO_END,
        to_ticks(edge.min_lag),
        None if edge.max_lag is None else to_ticks(edge.max_lag),
        origin,
    )


def _arc_order(arc: Arc) -> tuple[int, ...]:
    return (*arc[:5], arc.max_lag is not None, arc.max_lag or 0)
