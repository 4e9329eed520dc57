"""Rules 6 and 7: state over time, and the goals at the end."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations

from irc.model import StateGoal, StateVariable
from irc.validation.bound_schedule import BoundSchedule, Occurrence, bind
from irc.validation.happenings import (
    Timeline,
    Timelines,
    given_ranks,
    starts_after,
    timelines_of,
    timing_edges,
)
from irc.validation.levels import Value, meets, need_of, need_text
from irc.validation.past_first import check_past_first
from irc.validation.rank_graph import StepBudget
from irc.validation.ranks import SEARCH_STEPS, STEPS_PER_OCCURRENCE, find_ranks
from irc.validation.resources import RankPairs, check_capacity
from irc.validation.simulator import Demand, StateSimulator
from irc.validation.simultaneous import is_left_out
from irc.validation.state_messages import add_unmet_goal
from irc.validation.stock import check_reservoirs
from irc.validation.verdict import Violations, listed

_READING_COST = 50
"""The cost of building the timelines again, per occurrence, in steps of the search."""


def check_goals(bound: BoundSchedule, violations: Violations) -> None:
    """Checks rule 7 for goals that name an action, and for those that are left out."""
    for goal in dict.fromkeys(bound.task.goals):
        if isinstance(goal, StateGoal):
            if is_left_out(bound, goal):
                what = f"the goal {need_text(goal.var, need_of(goal))} is left out"
                violations.add("goal", what, carried=True)
        elif goal not in bound.done:
            carried = goal in bound.left_out
            violations.add("goal", f"the goal {goal!r} is missing", [goal], carried=carried)


def check_state(bound: BoundSchedule, violations: Violations) -> None:
    """Checks rules 6 and 7 for state: by the ranks of the entries, else by ranks searched here."""
    if bound.ranked:
        _check_given_ranks(bound, violations)
    elif bound.variables:
        _look_for_ranks(bound, violations)


def _check_given_ranks(bound: BoundSchedule, violations: Violations) -> None:
    for occurrence in bound.occurrences:
        _check_duration_in_ranks(occurrence, violations)
    check_past_first(bound, violations)
    drawn_out = {o.number for o in bound.occurrences if o.start == o.end and o.rank != o.end_rank}
    timelines = timelines_of(bound, drawn_out)
    ranks = given_ranks(bound, timelines)
    rank_changes(bound, timelines, ranks)
    _follow(bound, timelines, ranks, violations)


def ranks_suit(bound: BoundSchedule, timelines: Timelines, ranks: Sequence[int]) -> bool:
    """Whether conditions, effects and goals hold under some ranks."""
    attempt = Violations(bound.task.time_unit)
    _follow(bound, timelines, ranks, attempt)
    return not attempt


def rank_changes(bound: BoundSchedule, timelines: Timelines, ranks: list[int]) -> None:
    """Finds the ranks of timed changes, which no entry says: those with the fewest violations.

    They come before the starts of their instant that touch their variable, on either side of ends.
    """
    for change in bound.changes:
        var = change.action.effects[0].var
        node = timelines.nodes[change.number][0]
        latest = [ranks[timelines.nodes[o.number][0]] - s for o, s in starts_after(bound, change)]
        ends = {
            ranks[timelines.nodes[o.number][1]]
            for o in bound.occurrences
            if o.start < o.end == change.start
        }
        places = sorted({0, *(r + d for r in ends for d in (-1, 0, 1)), *latest}, reverse=True)
        best: tuple[int, int] | None = None
        for place in places:
            if any(place > most for most in latest):
                continue
            ranks[node] = place
            attempt = Violations(bound.task.time_unit)
            timeline = timelines.by_variable[var]
            final = _simulated(bound, var, timeline, ranks, attempt)
            goals = [g for g in bound.task.goals if isinstance(g, StateGoal) and g.var == var]
            broken = len(attempt.found) + sum(not meets(final, need_of(goal)) for goal in goals)
            found = broken, len(attempt.carried)
            if best is None or found < best:
                best, chosen = found, place
            if not any(found):
                break
        ranks[node] = 0 if best is None else chosen


def _check_duration_in_ranks(occurrence: Occurrence, violations: Violations) -> None:
    """Checks that a duration keeps its bounds in ranks too, so that a fixed one has one rank."""
    entry, lasts = occurrence.entry, occurrence.end - occurrence.start
    if entry.end_rank is None or entry.end_rank == entry.rank:
        return
    if not occurrence.ends_freely:
        wanted = "its duration is fixed, so both have the same rank"
    elif lasts == occurrence.shortest and entry.end_rank < entry.rank:
        wanted = "so it lasts less than its shortest duration"
    elif lasts == occurrence.longest and entry.end_rank > entry.rank:
        wanted = "so it lasts more than its longest duration"
    else:
        return
    violations.add(
        "rank",
        f"{occurrence.name} starts with rank {entry.rank} and ends with rank {entry.end_rank}; "
        f"{wanted}",
        [entry.id],
        (occurrence.start, occurrence.end),
        carried=occurrence.past is not None and occurrence.past.over,
    )


def _look_for_ranks(bound: BoundSchedule, violations: Violations) -> None:
    """Tries all ranks 0 first, which suits most schedules; then searches.

    Where the history alone has no ranks either, all ranks are 0, as if the schedule gave them.
    """
    timelines = timelines_of(bound, ())
    if _is_clean(bound, timelines):
        return
    failure = _search(bound, timelines)
    if failure and _history_is_at_fault(bound):
        _follow(bound, timelines, [0] * timelines.node_count, violations)
    else:
        violations.merge(failure)


def _history_is_at_fault(bound: BoundSchedule) -> bool:
    """Whether no ranks suit the history, alone and without goals."""
    if bound.at is None:
        return False
    entries = tuple(o.entry for o in bound.occurrences if o.past)
    without_goals = bound.task.model_copy(update={"goals": ()})
    history = bind(without_goals, replace(bound.schedule, entries=entries))
    failure = _search(history, timelines_of(history, ()))
    return bool(failure) and not failure.only_undecided


def _search(bound: BoundSchedule, timelines: Timelines) -> Violations:
    """The violations that all ranks have; none where some ranks suit.

    An occurrence of no duration that could last longer has two readings, as one happening or as
    two; all readings are tried.
    """
    zero_length = [
        o.number
        for o in bound.occurrences
        if o.start == o.end
        and o.ends_freely
        and o.shortest == 0
        and (o.action.conditions or o.action.effects)
    ]
    budget = StepBudget(SEARCH_STEPS + STEPS_PER_OCCURRENCE * len(bound.occurrences))
    failures: list[Violations] = []
    for drawn_out in _readings(zero_length):
        if drawn_out:
            timelines = timelines_of(bound, drawn_out)
        failure = _try_reading(bound, timelines, budget)
        if not failure:
            return failure
        failures.append(failure)
        budget.charge(_READING_COST * (10 + len(bound.occurrences)))
        if budget.is_spent:
            break
    refuted = sum(not failure.only_undecided for failure in failures)
    if not zero_length or refuted == 2 ** len(zero_length):
        return failures[0]
    return _too_many_readings(bound, zero_length)


def _is_clean(bound: BoundSchedule, timelines: Timelines) -> bool:
    """Whether all ranks 0 suit; stops at the first variable where they do not."""
    ranks = [0] * timelines.node_count
    attempt = Violations(bound.task.time_unit)
    final: dict[str, Value] = {}
    for name, variable in bound.variables.items():
        final[name] = StateSimulator(variable, attempt).run(timelines.by_variable[name], ranks)
        if attempt:
            return False
    _check_state_goals(bound, final, attempt)
    return not attempt


def _readings(zero_length: list[int]) -> Iterator[tuple[int, ...]]:
    for size in range(len(zero_length) + 1):
        yield from combinations(zero_length, size)


def _try_reading(bound: BoundSchedule, timelines: Timelines, budget: StepBudget) -> Violations:
    violations = Violations(bound.task.time_unit)
    ranks = find_ranks(bound, timelines, budget, violations)
    if ranks is None:
        return violations
    # The search is not trusted: its ranks are judged like given ones.
    _follow(bound, timelines, ranks, violations)
    if any(ranks[b] < ranks[a] + least for a, b, least in timing_edges(bound, timelines)):
        violations.add("rank", "the ranks found do not keep all durations and precedences")
    pairs = [(ranks[start], ranks[end]) for start, end in timelines.nodes]
    if _levels_fail(bound, pairs) and not _levels_fail(bound, None):
        violations.add("rank", "the ranks found do not suit all resources and reservoirs")
    return violations


def _levels_fail(bound: BoundSchedule, ranks: RankPairs | None) -> bool:
    """Whether a resource or a reservoir does not suffice under some ranks."""
    attempt = Violations(bound.task.time_unit)
    check_capacity(bound, attempt, ranks)
    check_reservoirs(bound, attempt, ranks)
    return bool(attempt)


def _too_many_readings(bound: BoundSchedule, zero_length: list[int]) -> Violations:
    violations = Violations(bound.task.time_unit)
    names = [bound.occurrences[number].entry.id for number in zero_length]
    violations.add(
        "undecided",
        f"whether ranks exist is too hard to decide: {listed(names, len(names))} take no time, "
        "though each could last; give the schedule's ranks",
        names,
    )
    return violations


def _follow(
    bound: BoundSchedule, timelines: Timelines, ranks: Sequence[int], violations: Violations
) -> None:
    """Simulates every variable in the order of (time, rank): O(n log n)."""
    final: dict[str, Value] = {}
    for name in bound.variables:
        timeline = timelines.by_variable[name]
        final[name] = _simulated(bound, name, timeline, ranks, violations)
    _check_state_goals(bound, final, violations)


def _simulated(
    bound: BoundSchedule,
    name: str,
    timeline: Timeline,
    ranks: Sequence[int],
    violations: Violations,
) -> Value:
    """Simulates a variable, and returns its last value; what history alone breaks is carried."""
    variable = bound.variables[name]
    lost = frozenset() if bound.at is None else _lost_to_history(variable, timeline, ranks)
    return StateSimulator(variable, violations, lost).run(timeline, ranks)


def _lost_to_history(
    variable: StateVariable, timeline: Timeline, ranks: Sequence[int]
) -> frozenset[Demand]:
    """The demands that the history alone, with its own ranks, does not meet."""
    history = StateSimulator(variable, Violations(""))
    history.run(timeline.past, ranks)
    return frozenset(history.failed)


def _check_state_goals(
    bound: BoundSchedule, final: Mapping[str, Value], violations: Violations
) -> None:
    for goal in dict.fromkeys(bound.task.goals):
        if not isinstance(goal, StateGoal) or is_left_out(bound, goal):
            continue
        if not meets(final[goal.var], need_of(goal)):
            add_unmet_goal(goal.var, need_of(goal), final[goal.var], violations)
