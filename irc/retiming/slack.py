"""Computes slack: how much later an action could start without a later makespan."""

from __future__ import annotations

from math import floor

from irc.problem import Problem
from irc.problem.choices import UnexplainedError, choices_of
from irc.problem.decisions import AnswerError, Decision
from irc.problem.temporal_network import Network
from irc.problem.time_points import PointMap, latest_times, timing_network
from irc.retiming.resources import add_setups, resource_orders
from irc.schedule import Entry, Schedule


def slacks(problem: Problem, schedule: Schedule) -> dict[str, int]:
    """By action id, the most ticks by which the action could start later; 0: it is critical.

    What stays: the makespan (or less), the resources and modes chosen, and the order of every two
    actions that share a resource without overlapping. What may change: all times and, where a
    duration is a range, durations. All lags, deadlines, fixed and latest starts hold. Under these
    rules an action can start at *any* time up to its start + slack, while others move along; slack
    that several actions have is common to them. (Total float, with resources: Wiest, "Some
    properties of schedules for large projects with limited resources", 1964.)

    Ranks play no part. Without state and stock a resource is freed and taken at one rank of an
    instant, and lags ask for no more than weakly rising ranks: a valid
    schedule of such a problem is valid with all ranks 0, too, and so is each one that keeps its
    order by time.

    `schedule` must be a valid one of exactly the problem's activities; an answer without entries
    gives nothing. Raises `AnswerError` otherwise. Takes O(n log n) and the time of one pass over
    the temporal network.
    """
    if not schedule.entries:
        return {}
    if not problem.is_plain or problem.has_calendars:
        raise AnswerError("it can be computed only without state, stock, calendars and choices")
    entries = _entries(problem, schedule)
    decisions = [
        Decision(problem.to_ticks(entry.start), problem.to_ticks(entry.end)) for entry in entries
    ]
    makespan = floor(max(decision.end for decision in decisions))
    timing = timing_network(problem)
    points, network = timing.points, timing.network
    for before, after in resource_orders(problem, decisions, _held(problem, entries), 0):
        network.add(points.end[before], points.start[after], points.end_offset[before])
    if problem.has_setups:
        uses = uses_taken(problem, schedule)
        add_setups(problem, decisions, uses, points, network, timing.floors, 0)
    _keep_chosen_lengths(network, points, entries, decisions)
    latest = latest_times(problem, points, network, makespan)
    if latest is None:
        raise AnswerError("the order of the schedule contradicts the lags of the problem")
    found = {
        entry.id: floor(latest[point] - decision.start)
        for entry, point, decision in zip(entries, points.start, decisions, strict=True)
    }
    late = next((name for name, slack in found.items() if slack < 0), None)
    if late is not None:
        raise AnswerError(f"{late!r} is later in the schedule than the problem allows")
    return found


def _entries(problem: Problem, schedule: Schedule) -> list[Entry]:
    """The entry of each activity, in the problem's order."""
    by_id = {entry.id: entry for entry in schedule.entries}
    known = {activity.id for activity in problem.activities}
    if len(by_id) != len(schedule.entries) or by_id.keys() != known:
        raise AnswerError("the schedule does not have exactly the actions of the problem")
    return [by_id[activity.id] for activity in problem.activities]


def uses_taken(problem: Problem, schedule: Schedule) -> list[tuple[int, ...]]:
    """The resource of each use of each activity. Raises `AnswerError` where none is known."""
    chosen: list[tuple[int, ...]] = []
    for activity, entry in zip(problem.activities, _entries(problem, schedule), strict=True):
        try:
            _, taken = choices_of(problem, activity, entry)
        except UnexplainedError:
            raise AnswerError(f"{activity.id!r} cannot use what its entry says") from None
        if taken is None or None in taken:
            raise AnswerError(f"the entry of {activity.id!r} does not say what it uses")
        chosen.append(tuple(r for r in taken if r is not None))
    return chosen


def _held(problem: Problem, entries: list[Entry]) -> list[tuple[int, ...]]:
    index = {resource.id: k for k, resource in enumerate(problem.resources)}
    unknown = next((r for entry in entries for r in entry.resources if r not in index), None)
    if unknown is not None:
        raise AnswerError(f"the problem has no resource {unknown!r}")
    return [tuple(index[name] for name in entry.resources) for entry in entries]


def _keep_chosen_lengths(
    network: Network, points: PointMap, entries: list[Entry], decisions: list[Decision]
) -> None:
    """Adds the durations of chosen modes, and keeps activities of no duration at no duration."""
    for i, (entry, decision) in enumerate(zip(entries, decisions, strict=True)):
        length = decision.end - decision.start
        if points.start[i] != points.end[i] and (not length or entry.mode is not None):
            network.add(points.start[i], points.end[i], int(length))
            network.add(points.end[i], points.start[i], -int(length))
