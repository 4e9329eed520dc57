"""Statements in the words of the task."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from irc.explanation.chain import HandOver
from irc.model.times import format_number
from irc.problem import NO_FAMILY, Problem
from irc.problem.arc_text import arc_in_words
from irc.problem.statements import Kind, Side, Statement


def in_words(problem: Problem, statement: Statement) -> str:
    """A statement as a sentence."""
    return _WORDS[statement.kind](problem, statement)


def _task_deadline(problem: Problem, statement: Statement) -> str:
    return f"everything ends by {problem.time_text(problem.deadline or 0)}"


def _capacity(problem: Problem, statement: Statement) -> str:
    resource = problem.resources[statement.of]
    return f"{resource.id!r} has a capacity of {resource.capacity}"


def _setups(problem: Problem, statement: Statement) -> str:
    return f"{problem.resources[statement.of].id!r} is set up between uses of different families"


def _no_idle(problem: Problem, statement: Statement) -> str:
    return f"{problem.resources[statement.of].id!r} is never idle between its uses"


def _use(problem: Problem, statement: Statement) -> str:
    activity = problem.activities[statement.of]
    use = activity.uses[statement.use]
    names = [repr(problem.resources[r].id) for r in use.alternatives]
    where = names[0] if len(names) == 1 else f"one of {', '.join(names)}"
    amount = f"{use.amount} of " if use.amount != 1 and len(names) == 1 else ""
    if use.amount != 1 and len(names) > 1:
        amount = f"{use.amount} units of "
    family = "" if use.family == NO_FAMILY else f" for {problem.families[use.family]!r}"
    return f"{activity.id!r} uses {amount}{where}{family}"


def _precedence(problem: Problem, statement: Statement) -> str:
    return arc_in_words(problem, problem.arcs[statement.of], statement.side)


def _release(problem: Problem, statement: Statement) -> str:
    activity = problem.activities[statement.of]
    return f"{activity.id!r} is released at {problem.time_text(activity.release)}"


def _start(problem: Problem, statement: Statement) -> str:
    activity = problem.activities[statement.of]
    return f"{activity.id!r} starts at {problem.time_text(activity.start or 0)}"


def _latest_start(problem: Problem, statement: Statement) -> str:
    activity = problem.activities[statement.of]
    return f"{activity.id!r} starts by {problem.time_text(activity.latest_start or 0)}"


def _earliest_end(problem: Problem, statement: Statement) -> str:
    activity = problem.activities[statement.of]
    return f"{activity.id!r} ends no earlier than {problem.time_text(activity.earliest_end or 0)}"


def _deadline(problem: Problem, statement: Statement) -> str:
    activity = problem.activities[statement.of]
    return f"{activity.id!r} ends by {problem.time_text(activity.deadline or 0)}"


def _group_deadline(problem: Problem, statement: Statement) -> str:
    activity = problem.activities[statement.of]
    group = "" if activity.deadline_by is None else activity.deadline_by.group
    return f"group {group!r} ends by {problem.time_text(activity.deadline or 0)}"


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


def setup_in_words(problem: Problem, hand_over: HandOver) -> str:
    """A set-up of the critical chain."""
    resource = problem.resources[hand_over.resource].id
    after = problem.activities[hand_over.after].id
    time = problem.time_text(abs(hand_over.setup))
    if hand_over.back:
        name = problem.activities[hand_over.before or 0].id
        return f"{resource!r} is never idle: {name!r} is right before {after!r}"
    if hand_over.before is None:
        return f"{resource!r} is set up for {after!r}: {time}"
    before = problem.activities[hand_over.before].id
    return f"{resource!r} is set up after {before!r} for {after!r}: {time}"


_WORDS: Mapping[Kind, Callable[[Problem, Statement], str]] = {
    Kind.TASK_DEADLINE: _task_deadline,
    Kind.CAPACITY: _capacity,
    Kind.SETUPS: _setups,
    Kind.NO_IDLE: _no_idle,
    Kind.USE: _use,
    Kind.PRECEDENCE: _precedence,
    Kind.RELEASE: _release,
    Kind.START: _start,
    Kind.LATEST_START: _latest_start,
    Kind.EARLIEST_END: _earliest_end,
    Kind.DEADLINE: _deadline,
    Kind.GROUP_DEADLINE: _group_deadline,
    Kind.DURATION: _duration,
}
