"""Arcs in the task's words."""

from __future__ import annotations

from irc.model.times import format_number
from irc.problem.problem import Arc, Problem
from irc.problem.statements import Side


def arc_in_words(problem: Problem, arc: Arc, side: Side, *, must: bool = False) -> str:
    """An arc in words, or only one of its two lags: "starts", or with `must`, "must start"."""
    before, after = problem.activities[arc.before].id, problem.activities[arc.after].id
    plain = arc.from_end and not arc.to_end and arc.min_lag == 0
    if plain and (arc.max_lag is None or side is Side.LEAST):
        return f"{after!r} must follow {before!r}" if must else f"{before!r} precedes {after!r}"
    verb = "end" if arc.to_end else "start"
    what = f"{after!r} must {verb}" if must else f"{after!r} {verb}s"
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
