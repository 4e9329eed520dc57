"""The exact schedule of a list schedule, as `irc.passes.serial_sgs` finds it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from irc.passes.serial_sgs import Found
from irc.problem import Problem
from irc.problem.choices import members_taken
from irc.problem.decisions import Decision
from irc.retiming.retime import retime
from irc.retiming.to_schedule import schedule_of
from irc.schedule import Schedule


def listed_schedule(problem: Problem, found: Found) -> Schedule:
    """The exact schedule of a list schedule of a problem.

    Raises `irc.problem.decisions.AnswerError` where it cannot be one.
    """
    decisions, choices = found
    chosen: Sequence[Decision] = [
        replace(decision, chosen=members_taken(problem, problem.activities[i], choices[i]))
        for i, decision in enumerate(decisions)
    ]
    return schedule_of(problem, retime(problem, chosen))
