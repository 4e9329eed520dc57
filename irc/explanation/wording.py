"""Statements in the words of the task."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from irc.model.times import format_number
from irc.problem import Arc, Problem
from irc.problem.statements import Kind, Side, Statement


def in_words(problem: Problem, statement: Statement) -> str:
    """A statement as a sentence."""
    return _WORDS[statement.kind](problem, statement)


def _task_deadline(problem: Problem, statement: Statement) -> str:
    return f"everything ends by {problem.time_text(problem.deadline or 0)}"


def _capacity(problem: Problem, statement: Statement) -> str:
    resource = problem.resources[statement.of]
    return f"{resource.id!r} has a capacity of {resource.capacity}"


def _use(problem: Problem, statement: Statement) -> str:
    activity = problem.activities[statement.of]
    use = activity.uses[statement.use]
    names = [repr(problem.resources[r].id) for r in use.alternatives]
    where = names[0] if len(names) == 1 else f"one of {', '.join(names)}"
    amount = f"{use.amount} of " if use.amount != 1 and len(names) == 1 else ""
    if use.amount != 1 and len(names) > 1:
        amount = f"{use.amount} units of "
    return f"{activity.id!r} uses {amount}{where}"


def _precedence(problem: Problem, statement: Statement) -> str:
    return arc_in_words(problem, problem.arcs[statement.of], statement.side)


def arc_in_words(problem: Problem, arc: Arc, side: Side) -> str:
    """An arc as a sentence, or only one of its two lags."""
    before, after = problem.activities[arc.before].id, problem.activities[arc.after].id
    plain = arc.from_end and not arc.to_end and arc.min_lag == 0
    if plain and (arc.max_lag is None or side is Side.LEAST):
        return f"{before!r} precedes {after!r}"
    what = f"{after!r} {'end' if arc.to_end else 'start'}s"
    since = f"the {'end' if arc.from_end else 'start'} of {before!r}"
    if arc.max_lag is None or side is Side.LEAST:
        return f"{what} {_distance(problem, arc.min_lag, 'at least', 'at most')} {since}"
    if side is Side.MOST:
        return f"{what} {_distance(problem, arc.max_lag, 'at most', 'at least')} {since}"
    low, high = (format_number(problem.to_units(lag)) for lag in (arc.min_lag, arc.max_lag))
    if arc.min_lag == arc.max_lag:
        return f"{what} exactly {problem.time_text(arc.min_lag)} after {since}"
    return f"{what} {low} to {high} {problem.time_unit} after {since}"


def _distance(problem: Problem, lag: int, later: str, earlier: str) -> str:
    if lag < 0:
        return f"{earlier} {problem.time_text(-lag)} before"
    if lag == 0:
        return "not before" if later == "at least" else "not after"
    return f"{later} {problem.time_text(lag)} after"


def _release(problem: Problem, statement: Statement) -> str:
    activity = problem.activities[statement.of]
    return f"{activity.id!r} is released at {problem.time_text(activity.release)}"


def _start(problem: Problem, statement: Statement) -> str:
    activity = problem.activities[statement.of]
    return f"{activity.id!r} starts at {problem.time_text(activity.start or 0)}"


def _deadline(problem: Problem, statement: Statement) -> str:
    activity = problem.activities[statement.of]
    return f"{activity.id!r} ends by {problem.time_text(activity.deadline or 0)}"


def _duration(problem: Problem, statement: Statement) -> str:
    activity = problem.activities[statement.of]
    low, high = activity.duration_min, activity.duration_max
    if low == high:
        return f"{activity.id!r} takes {problem.time_text(low)}"
    if statement.side is Side.LEAST:
        return f"{activity.id!r} takes at least {problem.time_text(low)}"
    if statement.side is Side.MOST:
        return f"{activity.id!r} takes at most {problem.time_text(high)}"
    least = format_number(problem.to_units(low))
    return f"{activity.id!r} takes {least} to {problem.time_text(high)}"


_WORDS: Mapping[Kind, Callable[[Problem, Statement], str]] = {
    Kind.TASK_DEADLINE: _task_deadline,
    Kind.CAPACITY: _capacity,
    Kind.USE: _use,
    Kind.PRECEDENCE: _precedence,
    Kind.RELEASE: _release,
    Kind.START: _start,
    Kind.DEADLINE: _deadline,
    Kind.DURATION: _duration,
}
