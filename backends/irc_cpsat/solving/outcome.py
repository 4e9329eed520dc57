"""From the result of one model to an engine's outcome."""

from __future__ import annotations

from dataclasses import replace

from irc.model.quantities import Number
from irc.problem import Problem
from irc.problem.objective_values import in_units, schedule_values
from irc.retiming.listed import listed_schedule
from irc.retiming.retime import retime
from irc.retiming.to_schedule import schedule_of
from irc.schedule import Schedule, Status
from irc.targets import ObjectiveLevel, Outcome
from irc_cpsat.encoding.builder import Model
from irc_cpsat.solving.levels import LexicographicResult


def outcome_of(engine: str, problem: Problem, built: Model, result: LexicographicResult) -> Outcome:
    """The outcome of a result: its exact schedule, or a known one where it has none."""
    if result.status is Status.INFEASIBLE:
        return Outcome(result.status, engine)
    if result.status is Status.UNKNOWN:
        known = _known_schedule(problem, built)
        if known is None:
            return Outcome(result.status, engine)
        return Outcome(Status.FEASIBLE, engine, known)
    schedule = schedule_of(problem, retime(problem, result.decisions))
    first = result.levels[0]
    bound = first.bound if first.name == "makespan" else 0
    levels = _objective_levels(problem, result, schedule)
    return Outcome(result.status, engine, schedule, bound, levels=levels)


def better(shallow: Outcome, deep: Outcome) -> Outcome:
    """The better of two answers, with the bounds of the one that leaves nothing out.

    When time is short, a deep model can come less far than a shallow one before it.
    """
    if shallow.schedule is None or deep.schedule is None or _values(deep) <= _values(shallow):
        return deep
    bounds = deep.levels[0].bound, *(None for _ in deep.levels[1:])
    levels = tuple(
        replace(level, bound=bound) for level, bound in zip(shallow.levels, bounds, strict=True)
    )
    return replace(shallow, status=Status.FEASIBLE, bound=deep.bound, levels=levels)


def _known_schedule(problem: Problem, built: Model) -> Schedule | None:
    """The schedule that was given as a hint, if there was one."""
    if built.hint is not None:
        return listed_schedule(problem, built.hint)
    return (
        schedule_of(problem, problem.previous.warm_start) if problem.previous.warm_start else None
    )


def _values(outcome: Outcome) -> tuple[Number, ...]:
    """The objective values in their order; less is better."""
    return tuple(-o.value if o.name == "reward" else o.value for o in outcome.levels)


def _objective_levels(
    problem: Problem, result: LexicographicResult, schedule: Schedule
) -> tuple[ObjectiveLevel, ...]:
    """Each objective with a bound among the best of the previous ones; none behind a gap."""
    values = schedule_values(problem, schedule)
    reached = {level.name: level for level in result.levels}
    found = []
    certain = True
    for name in problem.levels:
        level = reached.get(name) if certain else None
        bound = None if level is None else in_units(problem, name, level.bound)
        found.append(ObjectiveLevel(name, values[name], bound))
        certain = level is not None and level.proven
    return tuple(found)
