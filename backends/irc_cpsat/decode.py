"""CP-SAT's answer → the exact schedule."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import Any

from irc.compiler import schedule_of
from irc.problem import Problem
from irc.retime import AnswerError, Decision, retime
from irc.schedule import Schedule

_STATUS = re.compile(r"\bstatus:\s*(\w+)")
_VALUES = re.compile(r"\bsolution:\s*(?:\[([^\]]*)\]|(-?\d+))")
_ANSWERED = frozenset(("OPTIMAL", "FEASIBLE"))


def decode_response(problem: Problem, names: Mapping[str, Any], answer: str) -> Schedule:
    """Reads a `CpSolverResponse` in protocol buffer text form.

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


def _taken(literals: Mapping[str, int], value: Callable[[int], int]) -> str:
    """The alternative that a use takes."""
    for name, index in literals.items():
        if value(index):
            return name
    raise AnswerError("the response takes none of the alternatives of a use")


def _schedule(problem: Problem, names: Mapping[str, Any], value: Callable[[int], int]) -> Schedule:
    decisions = []
    for activity in problem.activities:
        variables = names["actions"][activity.id]
        start = value(variables["start"])
        end = value(variables["end"]) if "end" in variables else start + activity.duration_min
        taken = {
            int(use): _taken(literals, value)
            for use, literals in variables.get("choices", {}).items()
        }
        chosen: list[int | None] = [None] * len(activity.uses)
        for claim in activity.claims:
            options = {problem.shared[r].id: r for r in claim.alternatives}
            shared = options[taken[claim.use]] if claim.use in taken else claim.alternatives[0]
            members = problem.shared[shared].members
            chosen[claim.use] = members[0] if len(members) == 1 else None
        decisions.append(Decision(start, end, tuple(chosen)))
    return schedule_of(problem, retime(problem, decisions))
