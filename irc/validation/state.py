"""Rules 6 and 7: state over time, and the goals at the end."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations

from irc.model import StateGoal, StateVariable
from irc.times import Number
from irc.validation.happenings import (
    Access,
    Happening,
    Hold,
    Story,
    Timeline,
    Value,
    given_ranks,
    tell,
    timing_edges,
    value_text,
)
from irc.validation.rank_graph import Budget
from irc.validation.ranks import SEARCH_STEPS, STEPS_PER_OCCURRENCE, find_ranks
from irc.validation.state_messages import (
    add_broken,
    add_contradiction,
    add_unheld,
    add_unmet,
    add_unmet_goal,
)
from irc.validation.subject import Occurrence, Subject
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
    )


def _look_for_ranks(subject: Subject, violations: Violations) -> None:
    """All ranks 0 first, which most schedules want; then a search.

    What lasts no time though it could last has two readings, one happening or two; all are tried.
    """
    story = tell(subject, ())
    if _is_clean(subject, story):
        return
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
            return
        failures.append(failure)
        budget.charge(_READING_COST * (10 + len(subject.occurrences)))
        if budget.is_spent:
            break
    refuted = sum(not failure.only_undecided for failure in failures)
    if not zero_length or refuted == 2 ** len(zero_length):
        violations.merge(failures[0])
    else:
        _add_too_many_readings(subject, zero_length, violations)


def _is_clean(subject: Subject, story: Story) -> bool:
    """Whether all ranks 0 will do; stops at the first variable where they do not."""
    ranks = [0] * story.node_count
    attempt = Violations(subject.task.time_unit)
    final: dict[str, Value] = {}
    for name, variable in subject.variables.items():
        final[name] = _Player(variable, attempt).play(story.timelines[name], ranks)
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


def _add_too_many_readings(
    subject: Subject, zero_length: list[int], violations: Violations
) -> None:
    names = [subject.occurrences[number].entry.id for number in zero_length]
    violations.add(
        "undecided",
        f"whether ranks exist is too hard to decide: {listed(names, len(names))} take no time, "
        "though each could last; give the schedule's ranks",
        names,
    )


def _follow(subject: Subject, story: Story, ranks: Sequence[int], violations: Violations) -> None:
    """Plays every variable through in the order of (time, rank): O(n log n)."""
    final: dict[str, Value] = {}
    for name, variable in subject.variables.items():
        final[name] = _Player(variable, violations).play(story.timelines[name], ranks)
    _check_state_goals(subject, final, violations)


def _check_state_goals(
    subject: Subject, final: Mapping[str, Value], violations: Violations
) -> None:
    for goal in dict.fromkeys(subject.task.goals):
        if isinstance(goal, StateGoal) and final[goal.var] != goal.value:
            add_unmet_goal(goal.var, goal.value, final[goal.var], violations)


@dataclass
class _Moment:
    """What concerns one variable at one (time, rank)."""

    reads: list[Access] = field(default_factory=list)
    writes: list[Access] = field(default_factory=list)
    opening: list[tuple[int, Hold]] = field(default_factory=list)
    closing: list[tuple[int, Hold]] = field(default_factory=list)


class _Player:
    """Plays one variable through."""

    def __init__(self, variable: StateVariable, violations: Violations) -> None:
        self.name = variable.id
        self.value: Value = variable.start_value
        self.violations = violations
        self.held: dict[Value, dict[int, Hold]] = {}

    def play(self, timeline: Timeline, ranks: Sequence[int]) -> Value:
        """Checks all that happens to it and returns its last value."""
        moments: dict[tuple[Number, int], _Moment] = {}

        def moment(happening: Happening) -> _Moment:
            return moments.setdefault((happening.time, ranks[happening.node]), _Moment())

        for access in timeline.reads:
            moment(access.happening).reads.append(access)
        for access in timeline.writes:
            moment(access.happening).writes.append(access)
        for number, hold in enumerate(timeline.holds):
            first = (hold.opening.time, ranks[hold.opening.node])
            last = (hold.closing.time, ranks[hold.closing.node])
            if first < last:
                moments.setdefault(first, _Moment()).opening.append((number, hold))
                moments.setdefault(last, _Moment()).closing.append((number, hold))
        for (_, rank), current in sorted(moments.items(), key=lambda item: item[0]):
            self._pass(current, rank)
        return self.value

    def _pass(self, moment: _Moment, rank: int) -> None:
        for access in moment.reads:
            if access.value != self.value:
                add_unmet(self.name, access, value_text(self.value), self.violations)
        for number, hold in moment.closing:
            self.held.get(hold.value, {}).pop(number, None)
        if moment.writes:
            self._check_interference(moment, rank)
            self._write(moment.writes)
        for number, hold in moment.opening:
            if hold.value != self.value:
                add_unheld(self.name, hold, value_text(self.value), self.violations)
            else:
                self.held.setdefault(hold.value, {})[number] = hold

    def _write(self, writes: list[Access]) -> None:
        for access in writes:
            broken = [
                hold
                for value, holds in self.held.items()
                if value != access.value
                for hold in holds.values()
            ]
            if broken:
                add_broken(self.name, access, broken, self.violations)
                # Told once: what is broken here need not be told again at every later change.
                self.held = {v: h for v, h in self.held.items() if v == access.value}
            self.value = access.value

    def _check_interference(self, moment: _Moment, rank: int) -> None:
        writers = {access.happening.node: access for access in moment.writes}
        for access in moment.writes:
            if access.value != writers[access.happening.node].value:
                add_contradiction(self.name, access, self.violations)
        parties = writers | {access.happening.node: access for access in moment.reads}
        if len(parties) < 2:
            return
        first = moment.writes[0].happening
        others = [a.happening.occurrence.entry.id for n, a in parties.items() if n != first.node]
        self.violations.add(
            "interference",
            f"{first.occurrence.name} changes {self.name!r} at "
            f"{self.violations.time(first.time)} with rank {rank}, where "
            f"{listed(others, len(others))} read or change it with the same rank; "
            "what comes later needs a higher rank",
            [first.occurrence.entry.id, *others],
            (first.time,),
        )
