"""Reads CP-SAT's answer as the exact schedule."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import Any

from irc.passes.unroll import unroll
from irc.problem import Activity, Problem
from irc.problem.decisions import ABSENT, AnswerError, Decision
from irc.retiming.retime import retime
from irc.retiming.to_schedule import schedule_of
from irc.schedule import Schedule
from irc_cpsat.encoding.occurrences import FILE_DEPTH

_STATUS = re.compile(r"\bstatus:\s*(\w+)")
_VALUES = re.compile(r"\bsolution:\s*(?:\[([^\]]*)\]|(-?\d+))")
_ANSWERED = frozenset(("OPTIMAL", "FEASIBLE"))


def decode_response(problem: Problem, names: Mapping[str, Any], answer: str) -> Schedule:
    """The schedule in a `CpSolverResponse` in protocol buffer text form.

    Raises `AnswerError` where it holds no solution, or one of another model.
    """
    status = _STATUS.search(answer)
    if status is not None and status[1] not in _ANSWERED:
        raise AnswerError(f"the response has the status {status[1]} and holds no solution")
    values: list[int] = []
    for match in _VALUES.finditer(answer):
        listed = match[1] if match[1] is not None else match[2]
        values += [int(v) for v in re.findall(r"-?\d+", listed)]
    if not values:
        raise AnswerError(
            "there is no solution in the answer; expected a CpSolverResponse as text, "
            "with 'solution: …' lines"
        )
    try:
        return _schedule(problem, names, values.__getitem__)
    except (IndexError, KeyError):
        raise AnswerError("the response belongs to another model") from None


Value = Callable[[int], int]
"""The value of a variable, by its number."""


def _true_name(literals: Mapping[str, int], value: Value) -> str | None:
    """The alternative that a use takes, or the mode that is chosen."""
    return next((name for name, index in literals.items() if value(index)), None)


def _schedule(problem: Problem, names: Mapping[str, Any], value: Value) -> Schedule:
    unrolled = unroll(problem, names.get("occurrences", FILE_DEPTH))
    variables = [names["actions"][activity.id] for activity in problem.activities]
    variables += names.get("further", ())
    decisions = [
        _decision(unrolled, activity, own, value)
        for activity, own in zip(unrolled.activities, variables, strict=True)
    ]
    return schedule_of(unrolled, retime(unrolled, decisions))


def _decision(
    problem: Problem, activity: Activity, variables: Mapping[str, Any], value: Value
) -> Decision:
    if "present" in variables and not value(variables["present"]):
        return ABSENT
    start = value(variables["start"])
    end = value(variables["end"]) if "end" in variables else start + activity.duration_min
    modes = variables.get("modes", {})
    mode = _true_name(modes, value)
    if modes and mode is None:
        raise AnswerError(f"the response chooses no mode of {activity.id!r}")
    ranks = variables.get("ranks")
    return Decision(
        start,
        end,
        _chosen(problem, activity, variables.get("choices", {}), value),
        mode=None if mode is None else [m.id for m in activity.details.modes].index(mode),
        rank=value(ranks[0]) if ranks else 0,
        end_rank=value(ranks[1]) if ranks else 0,
    )


def _chosen(
    problem: Problem, activity: Activity, choices: Mapping[str, Mapping[str, int]], value: Value
) -> tuple[int | None, ...]:
    """The resource of each use, as far as the response says which."""
    chosen: list[int | None] = [None] * len(activity.uses)
    for demand in activity.open_demands:
        pool: int | None = demand.alternatives[0]
        if str(demand.use) in choices:
            options = {problem.contention.pools[r].id: r for r in demand.alternatives}
            taken = _true_name(choices[str(demand.use)], value)
            if taken is None and activity.details.use_mode(demand.use) is None:
                raise AnswerError("the response takes none of the alternatives of a use")
            pool = None if taken is None else options[taken]
        members = () if pool is None else problem.contention.pools[pool].members
        chosen[demand.use] = members[0] if len(members) == 1 else None
    return tuple(chosen)
