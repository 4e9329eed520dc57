"""Re-times a schedule of a task: the same choices and orders, as early as they allow."""

from __future__ import annotations

from dataclasses import replace

from irc.driver.compile import later_events
from irc.driver.judge import Answer, _approved, finish
from irc.lowering.lower import lower
from irc.model import Task
from irc.passes.unroll import unroll
from irc.problem.choices import decision_of
from irc.problem.decisions import ABSENT, AnswerError, Decision
from irc.retiming.retime import retime
from irc.retiming.to_schedule import schedule_of
from irc.schedule import Entry, Schedule, Status
from irc.targets import Outcome
from irc.validation import validate


def retimed_answer(task: Task, schedule: Schedule) -> Answer:
    """The schedule moved as early as its choices and orders allow, validated.

    Raises `AnswerError` where the schedule is not valid, or cannot be re-timed.
    """
    verdict = validate(task, schedule)
    if not verdict.valid:
        raise AnswerError(f"the plan is {verdict}")
    by_id: dict[str, list[Entry]] = {}
    for entry in schedule.entries:
        by_id.setdefault(entry.id, []).append(entry)
    times = [time for entry in schedule.entries for time in (entry.start, entry.end)]
    problem = lower(task, times)
    problem = unroll(problem, max((len(found) for found in by_id.values()), default=0))
    decisions: list[Decision] = []
    for activity in problem.activities:
        number = activity.details.occurrence
        own = [e for e in by_id.get(activity.id, ()) if e.occurrence == number]
        decisions.append(decision_of(problem, activity, own[0]) if own else ABSENT)
    outcome = Outcome(Status.FEASIBLE, "plan", schedule_of(problem, retime(problem, decisions)))
    found = replace(finish(task, problem, outcome, "plan", 0.0), engine=None, target=None)
    return Answer(_approved(task, found), problem, later_events(task))
