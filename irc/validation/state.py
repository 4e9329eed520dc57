"""Rules 6 and 7: state over time, and the goals at the end."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations

from irc.model import StateGoal, StateVariable
from irc.validation.happenings import Story, Timeline, Value, given_ranks, tell, timing_edges
from irc.validation.player import Demand, Player
from irc.validation.rank_graph import Budget
from irc.validation.ranks import SEARCH_STEPS, STEPS_PER_OCCURRENCE, find_ranks
from irc.validation.state_messages import add_unmet_goal
from irc.validation.subject import Occurrence, Subject, resolve
from irc.validation.verdict import Violations, listed

_READING_COST = 50
"""What retelling the story costs per occurrence, in steps of the search."""


def check_goals(subject: Subject, violations: Violations) -> None:
    """Rule 7 for goals that name an action."""
    for goal in dict.fromkeys(subject.task.goals):
        if not isinstance(goal, StateGoal) and goal not in subject.done:
            violations.add("goal", f"the goal {goal!r} is not there", [goal])


def check_state(subject: Subject, violations: Violations) -> None:
    """Rules 6 and 7 for state: by the ranks the entries give, else by ranks looked for here."""
    if subject.ranked:
        _check_given_ranks(subject, violations)
    elif subject.variables:
        _look_for_ranks(subject, violations)


def _check_given_ranks(subject: Subject, violations: Violations) -> None:
    for occurrence in subject.occurrences:
        _check_duration_in_ranks(occurrence, violations)
    drawn_out = {o.number for o in subject.occurrences if o.start == o.end and o.rank != o.end_rank}
    story = tell(subject, drawn_out)
    _follow(subject, story, given_ranks(subject, story), violations)


def _check_duration_in_ranks(occurrence: Occurrence, violations: Violations) -> None:
    """A duration keeps to its bounds in ranks too, so a fixed one has one rank."""
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


def _look_for_ranks(subject: Subject, violations: Violations) -> None:
    """All ranks 0 first, which most schedules want; then a search.

    Where the history alone has no ranks either, all are taken to be 0, as they were given.
    """
    story = tell(subject, ())
    if _is_clean(subject, story):
        return
    failure = _search(subject, story)
    if failure and _history_is_at_fault(subject):
        _follow(subject, story, [0] * story.node_count, violations)
    else:
        violations.merge(failure)


def _history_is_at_fault(subject: Subject) -> bool:
    """Whether no ranks suit what began before, alone and without goals."""
    if subject.at is None:
        return False
    entries = tuple(o.entry for o in subject.occurrences if o.past)
    without_goals = subject.task.model_copy(update={"goals": ()})
    history = resolve(without_goals, replace(subject.schedule, entries=entries))
    failure = _search(history, tell(history, ()))
    return bool(failure) and not failure.only_undecided


def _search(subject: Subject, story: Story) -> Violations:
    """What is wrong under all ranks; nothing where some will do.

    What lasts no time though it could last has two readings, one happening or two; all are tried.
    """
    zero_length = [
        o.number
        for o in subject.occurrences
        if o.start == o.end
        and o.ends_freely
        and o.shortest == 0
        and (o.action.conditions or o.action.effects)
    ]
    budget = Budget(SEARCH_STEPS + STEPS_PER_OCCURRENCE * len(subject.occurrences))
    failures: list[Violations] = []
    for drawn_out in _readings(zero_length):
        if drawn_out:
            story = tell(subject, drawn_out)
        failure = _try_reading(subject, story, budget)
        if not failure:
            return failure
        failures.append(failure)
        budget.charge(_READING_COST * (10 + len(subject.occurrences)))
        if budget.is_spent:
            break
    refuted = sum(not failure.only_undecided for failure in failures)
    if not zero_length or refuted == 2 ** len(zero_length):
        return failures[0]
    return _too_many_readings(subject, zero_length)


def _is_clean(subject: Subject, story: Story) -> bool:
    """Whether all ranks 0 will do; stops at the first variable where they do not."""
    ranks = [0] * story.node_count
    attempt = Violations(subject.task.time_unit)
    final: dict[str, Value] = {}
    for name, variable in subject.variables.items():
        final[name] = Player(variable, attempt).play(story.timelines[name], ranks)
        if attempt:
            return False
    _check_state_goals(subject, final, attempt)
    return not attempt


def _readings(zero_length: list[int]) -> Iterator[tuple[int, ...]]:
    for size in range(len(zero_length) + 1):
        yield from combinations(zero_length, size)


def _try_reading(subject: Subject, story: Story, budget: Budget) -> Violations:
    violations = Violations(subject.task.time_unit)
    ranks = find_ranks(subject, story, budget, violations)
    if ranks is None:
        return violations
    # The search is not trusted: what it found is judged like ranks that were given.
    _follow(subject, story, ranks, violations)
    if any(ranks[b] < ranks[a] + least for a, b, least in timing_edges(subject, story)):
        violations.add("rank", "the ranks found do not keep all durations and precedences")
    return violations


def _too_many_readings(subject: Subject, zero_length: list[int]) -> Violations:
    violations = Violations(subject.task.time_unit)
    names = [subject.occurrences[number].entry.id for number in zero_length]
    violations.add(
        "undecided",
        f"whether ranks exist is too hard to decide: {listed(names, len(names))} take no time, "
        "though each could last; give the schedule's ranks",
        names,
    )
    return violations


def _follow(subject: Subject, story: Story, ranks: Sequence[int], violations: Violations) -> None:
    """Plays every variable through in the order of (time, rank): O(n log n)."""
    final: dict[str, Value] = {}
    for name, variable in subject.variables.items():
        timeline = story.timelines[name]
        lost = frozenset() if subject.at is None else _lost_to_history(variable, timeline, ranks)
        final[name] = Player(variable, violations, lost).play(timeline, ranks)
    _check_state_goals(subject, final, violations)


def _lost_to_history(
    variable: StateVariable, timeline: Timeline, ranks: Sequence[int]
) -> frozenset[Demand]:
    """What the history alone, with the ranks that it has, does not give itself."""
    history = Player(variable, Violations(""))
    history.play(timeline.past, ranks)
    return frozenset(history.failed)


def _check_state_goals(
    subject: Subject, final: Mapping[str, Value], violations: Violations
) -> None:
    for goal in dict.fromkeys(subject.task.goals):
        if isinstance(goal, StateGoal) and final[goal.var] != goal.value:
            add_unmet_goal(goal.var, goal.value, final[goal.var], violations)
