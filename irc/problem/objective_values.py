"""Computes the objective values of a schedule of a problem."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction

from irc.model.objectives import TIMES, is_sum, sum_value, terms_of
from irc.model.quantities import Number, exact
from irc.problem.activity import Activity, Details
from irc.problem.choices import UnexplainedError, decision_of
from irc.problem.decisions import Decision
from irc.problem.problem import PreviousPlace, Problem
from irc.problem.resources import Setup
from irc.problem.rules import Group
from irc.problem.setups import SetupLink, setup_links, total_setup
from irc.schedule import CANCELLED, Entry, Schedule


def in_units(problem: Problem, objective: str, value: int) -> Number:
    """The value of an objective, which engines count in whole numbers.

    Times are in ticks. A sum of several objectives is counted in parts of the time unit: as many
    as the denominator of the tick.
    """
    if is_sum(objective):
        return exact(Fraction(value, problem.tick.denominator))
    return problem.to_units(value) if objective in TIMES else value


def whole_terms(problem: Problem, objective: str) -> tuple[tuple[int, str], ...]:
    """The parts of an objective with the weights of their whole numbers; see `in_units`."""
    if not is_sum(objective):
        return ((1, objective),)
    tick = problem.tick
    return tuple(
        (weight * (tick.numerator if part in TIMES else tick.denominator), part)
        for weight, part in terms_of(objective)
    )


def schedule_values(problem: Problem, schedule: Schedule) -> Mapping[str, Number]:
    """The objective values of a schedule, in the task's unit; each occurrence counts.

    A cancelled occurrence has only its cost: it earns no reward and adds no tardiness.
    """
    # (The first activity stands for all occurrences of its action.)
    activities = {a.id: a for a in reversed(problem.activities)}
    dated = _DatedValues(problem)
    reward = cost = 0
    by_id: dict[str, list[Entry]] = {}
    grouped = {problem.activities[i].id for group in problem.groups for i in group.members}
    for entry in schedule.entries:
        details = activities[entry.id].details
        cost += details.cost + _cost_of_mode(details, entry)
        if entry.status == CANCELLED:
            continue
        by_id.setdefault(entry.id, []).append(entry)
        reward += details.reward
        dated.add(entry.end, details.due, details.weight)
        if entry.id not in grouped:
            dated.flow(entry.end, details.entered or 0, details.weight)
    for group in problem.groups:
        ends = _ends(problem, group, by_id)
        if ends:
            reward += group.reward
            dated.add(max(ends), group.due, group.weight)
            entered = min(problem.activities[i].details.entered or 0 for i in group.members)
            dated.flow(max(ends), entered, group.weight)
    values: dict[str, Number] = {
        "makespan": schedule.makespan,
        "tardiness": dated.tardiness,
        "tardy": dated.tardy,
        "max_tardiness": dated.max_tardiness,
        "earliness": dated.earliness,
        "flow_time": dated.flow_time,
        "reward": reward,
        "cost": cost,
        "changes": _changes(problem, by_id),
    }
    if problem.has_setups or any("setup" in name for name in problem.objectives):
        setups = _setups(problem, schedule, activities)
        values["setup_time"] = problem.to_units(setups.time)
        values["setup_cost"] = setups.cost
    return values | {name: sum_value(name, values) for name in problem.objectives if is_sum(name)}


@dataclass
class _DatedValues:
    """The sums over due dates and releases, in the task's unit."""

    problem: Problem
    tardiness: Number = 0
    tardy: int = 0
    max_tardiness: Number = 0
    earliness: Number = 0
    flow_time: Number = 0

    def add(self, end: Number, due: int | None, weight: int) -> None:
        """Counts an end that has a due date (in ticks)."""
        if due is None:
            return
        late = end - self.problem.to_units(due)
        self.tardiness += weight * max(0, late)
        self.tardy += weight * (late > 0)
        self.max_tardiness = max(self.max_tardiness, weight * late)
        self.earliness += weight * max(0, -late)

    def flow(self, end: Number, entered: int, weight: int) -> None:
        """Counts an end that follows on a release (in ticks)."""
        self.flow_time += weight * (end - self.problem.to_units(entered))


def _setups(problem: Problem, schedule: Schedule, activities: Mapping[str, Activity]) -> Setup:
    """The set-ups of a schedule together."""
    return total_setup(link for link, _, _ in _links(problem, schedule, activities))


def setups_shown(problem: Problem, schedule: Schedule) -> Iterator[tuple[int, Number, int]]:
    """(resource, start of the use after it, time) of each set-up that takes time, in ticks."""
    activities = {a.id: a for a in reversed(problem.activities)}
    for link, decisions, _ in _links(problem, schedule, activities):
        if link.setup.time:
            yield link.resource, decisions[link.after].start, link.setup.time


def setups_done(
    problem: Problem, schedule: Schedule
) -> Iterator[tuple[str, Entry | None, Entry, Number, int]]:
    """(resource, entries before and after, time in the task's unit, cost) of each set-up that
    takes time or costs; before the first use nothing is before.
    """
    activities = {a.id: a for a in reversed(problem.activities)}
    for link, _, entries in _links(problem, schedule, activities):
        if link.setup.time or link.setup.cost:
            before = None if link.before is None else entries[link.before]
            time = problem.to_units(link.setup.time)
            name = problem.resources[link.resource].id
            yield name, before, entries[link.after], time, link.setup.cost


def _links(
    problem: Problem, schedule: Schedule, activities: Mapping[str, Activity]
) -> Iterator[tuple[SetupLink, list[Decision], list[Entry]]]:
    """The set-ups of a schedule, with decisions and entries by the numbers that they have in
    them.
    """
    used: list[Activity] = []
    decisions: list[Decision] = []
    entries: list[Entry] = []
    for entry in schedule.entries:
        try:
            decision = decision_of(problem, activities[entry.id], entry)
        except UnexplainedError:  # An event has taken away its mode or resource.
            continue
        if decision.chosen:
            used.append(activities[entry.id])
            decisions.append(decision)
            entries.append(entry)
    chosen = [d.chosen for d in decisions]
    for link in setup_links(problem.resources, used, decisions, chosen):
        yield link, decisions, entries


def _cost_of_mode(details: Details, entry: Entry) -> int:
    return next((m.cost for m in details.modes if m.id == entry.mode), 0)


def costs(problem: Problem, schedule: Schedule) -> dict[str, Number]:
    """The values of the problem's objectives, in order; less is better, so rewards are negative."""
    values = schedule_values(problem, schedule)
    return {name: -values[name] if name == "reward" else values[name] for name in problem.levels}


def _changes(problem: Problem, by_id: Mapping[str, list[Entry]]) -> int:
    """The number of occurrences that are not where the previous plan has them; 0 without a plan."""
    changes = 0
    for i, (activity, first) in enumerate(
        zip(problem.activities, problem.previous.places, strict=False)
    ):
        if first is None:
            continue
        found = {entry.occurrence: entry for entry in by_id.get(activity.id, ())}
        places = (first, *problem.previous.recurring.get(i, ()))
        for number, place in enumerate(places, activity.details.occurrence):
            entry = found.get(number)
            changes += entry is None or not _is_there(problem, activity, place, entry)
    return changes


def _is_there(problem: Problem, activity: Activity, place: PreviousPlace, entry: Entry) -> bool:
    details = activity.details
    mode = None if place.mode is None else details.modes[place.mode].id
    held: dict[str, int] = {}
    for use, r in zip(activity.uses, place.resources, strict=True):
        if r is not None:
            held[problem.resources[r].id] = held.get(problem.resources[r].id, 0) + use.amount
    start = problem.to_units(place.start)
    return (entry.start, entry.mode, dict(entry.resources)) == (start, mode, held)


def _ends(problem: Problem, group: Group, by_id: Mapping[str, list[Entry]]) -> list[Number]:
    """The ends of a group's members if all are present, else none."""
    members = [by_id.get(problem.activities[i].id) for i in group.members]
    if not all(members):
        return []
    return [entry.end for entries in members for entry in entries or ()]
