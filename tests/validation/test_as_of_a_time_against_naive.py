"""Judging as of a time against a naive second opinion, on small random tasks and schedules.

The naive check asks of each thing that is wrong whether something open takes part in it: written
from what docs/online.md says of a history, with quadratic loops.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from irc.model import Task
from irc.model.quantities import Number
from irc.schedule import Entry, Schedule
from irc.validation import Verdict, validate
from oracles.naive_validation import (
    SLOW,
    bounds_of,
    damage,
    end_points,
    explained,
    rule_3,
    rule_6_and_7,
    some_ranks_do,
    state_cases,
    tasks_and_schedules,
)


def is_past(task: Task, entry: Entry, at: Number) -> bool:
    changed = {f"{variable.id} at {at}" for variable in task.state}
    return entry.start < at or (
        entry.start == at and (entry.status == "begun" or entry.id in changed)
    )


def only(task: Task, entries: Sequence[Entry], at: Number) -> list[Entry]:
    return [entry for entry in entries if is_past(task, entry, at)]


def possible_ends(task: Task, entry: Entry, at: Number) -> list[Number]:
    """The ends that the history leaves an entry that is history, at both extremes."""
    (action,) = (action for action in task.actions if action.id == entry.id)
    bounds = bounds_of(action, entry)
    if entry.end <= at or bounds is None or bounds[0] == bounds[1]:
        return [entry.end]
    return [max(at, entry.start + bounds[0]), max(at, entry.start + bounds[1])]


def blames_2(task: Task, entries: Sequence[Entry], at: Number) -> bool:
    known = {action.id: action for action in task.actions}
    for entry in entries:
        if entry.id not in known:
            continue
        action, past = known[entry.id], is_past(task, entry, at)
        bounds, lasts = bounds_of(action, entry), entry.end - entry.start
        if bounds is None:
            if not past or lasts < 0:
                return True
        elif not bounds[0] <= lasts <= bounds[1] and not (past and 0 <= lasts <= at - entry.start):
            return True
        limits = [action.deadline, task.deadline]
        limits += [group.deadline for group in task.groups if entry.id in group.actions]
        deadlines = [task.number(limit) for limit in limits if limit is not None]
        earliest = None if action.earliest_end is None else task.number(action.earliest_end)
        early = earliest is not None and entry.end < earliest
        if early and (not past or possible_ends(task, entry, at)[-1] >= (earliest or 0)):
            return True
        if past:
            first = possible_ends(task, entry, at)[0]
            if any(first <= deadline < entry.end for deadline in deadlines):
                return True
            continue
        if any(entry.end > deadline for deadline in deadlines):
            return True
        if entry.start < max(0, task.number(action.release)):
            return True
        if action.start is not None and entry.start != task.number(action.start):
            return True
    return False


def blames_3(task: Task, entries: Sequence[Entry], at: Number) -> bool:
    by_id = {entry.id: entry for entry in entries}
    for precedence in task.precedence:
        alone = task.model_copy(update={"precedence": (precedence,)})
        pair = [by_id[n] for n in (precedence.before, precedence.after) if n in by_id]
        if rule_3(alone, pair):
            continue
        if not all(is_past(task, entry, at) for entry in pair):
            return True
        choices = product(*(possible_ends(task, entry, at) for entry in pair))
        other = [
            [Entry(e.id, e.start, end) for e, end in zip(pair, ends, strict=True)]
            for ends in choices
        ]
        if any(rule_3(alone, chosen) for chosen in other):
            return True
    return False


def blames_4(task: Task, entries: Sequence[Entry], at: Number) -> bool:
    known = {action.id: action for action in task.actions}
    for entry in entries:
        if entry.id not in known or is_past(task, entry, at):
            continue
        if not explained(task, known[entry.id], entry):
            return True
    for resource in task.resources:
        if resource.kind != "renewable":
            continue
        instants = {e.start for e in entries}
        instants |= {task.number(t) for w in resource.availability for t in (w.from_, w.to)}
        for t in instants:
            capacity = resource.capacity
            for w in resource.availability:
                if task.number(w.from_) <= t < task.number(w.to):
                    capacity = w.capacity
            holders = [e for e in entries if e.id in known and e.start <= t < e.end]
            amounts = [(e.resources.get(resource.id, 0), is_past(task, e, at)) for e in holders]
            if sum(amount for amount, _ in amounts) > capacity and any(
                amount and not past for amount, past in amounts
            ):
                return True
    return False


def blames_5(task: Task, entries: Sequence[Entry], at: Number) -> bool:
    for resource in task.resources:
        if resource.kind != "reservoir":
            continue
        changes: list[tuple[Number, int, bool]] = []
        for entry, action, _, _ in end_points(task, entries):
            past = is_past(task, entry, at)
            for sign, default, parts in (
                (-1, "start", action.consumes),
                (1, "end", action.produces),
            ):
                for part in parts:
                    if part.resource == resource.id:
                        time = entry.start if (part.at or default) == "start" else entry.end
                        changes.append((time, sign * part.amount, past))
        for t in {0, *(time for time, _, _ in changes)}:
            level = resource.initial + sum(amount for time, amount, _ in changes if time <= t)
            if level < resource.min:
                sign = 1
            elif resource.max is not None and level > resource.max:
                sign = -1
            else:
                continue
            by_open = sum(amount for time, amount, past in changes if time <= t and not past)
            just_now = sum(amount for time, amount, past in changes if time == t and not past)
            history = any(past for time, _, past in changes if time <= t)
            if not history or sign * by_open < 0 or sign * just_now < 0:
                return True
    return False


def numbers(verdict: Verdict) -> tuple[set[int | None], set[int | None]]:
    return {v.number for v in verdict.violations}, {v.number for v in verdict.carried}


@pytest.mark.slow
@SLOW
@given(st.data(), tasks_and_schedules(), st.integers(0, 9))
def test_what_is_open_is_blamed_exactly_where_the_naive_check_says(
    data: Any, case: tuple[Task, list[Entry]], at: int
) -> None:
    task, entries = case
    for _ in range(data.draw(st.integers(1, 3))):
        entries = damage(data.draw, entries) or entries
    schedule = Schedule(tuple(entries))
    plain, _ = numbers(validate(task, schedule))
    violated, carried = numbers(verdict := validate(task, schedule, at))
    assert violated | carried == plain, verdict
    if len({entry.id for entry in entries}) < len(entries):
        return  # Which of two entries a precedence binds is left open.
    checks = {2: blames_2, 3: blames_3, 4: blames_4, 5: blames_5}
    expected = {number for number, check in checks.items() if check(task, entries, at)}
    assert violated - {1, 7} == expected, verdict
    history = Schedule(tuple(only(task, entries, at)))
    assert carried <= numbers(validate(task, history))[0], verdict


Point = tuple[Number, int]


def blames_6(
    task: Task, entries: Sequence[Entry], ranks: dict[tuple[int, str], int], at: Number
) -> bool:
    """Rule 6, for ranks that are given."""
    reads, writes, holds = [], [], []
    for i, (entry, action, start, end) in enumerate(end_points(task, entries, ranks)):
        past, lasts = is_past(task, entry, at), end[0] - start[0]
        low, high = bounds_of(action, entry) or (lasts, lasts)
        if not (past and entry.end <= at) and not (
            (start[0] + low, start[1]) <= end <= (start[0] + high, start[1])
        ):
            return True
        if low == high and not (past and entry.end <= at):
            end = (end[0], start[1])
        for c in action.conditions:
            if c.at == "all" and start != end:
                holds.append((start, end, c.var, c.value, past))
            else:
                point = end if c.at == "end" else start
                reads.append((f"{i}{point}", point, c.var, c.value, past))
        for e in action.effects:
            point = end if e.at == "end" else start
            writes.append((f"{i}{point}", point, e.var, e.value, past))
    initial = {variable.id: variable.start_value for variable in task.state}

    def before(point: Point, var: str, *, history: bool = False) -> Any:
        earlier = [w for w in writes if w[2] == var and w[1] < point and (w[4] or not history)]
        return max(earlier, key=lambda w: w[1])[3] if earlier else initial[var]

    for who, point, var, value, past in writes:
        for other, point_2, var_2, value_2, past_2 in writes:
            same_place = (point, var) == (point_2, var_2) and not (past and past_2)
            if same_place and (who != other or value != value_2):
                return True
        for other, point_2, var_2, _, past_2 in reads:
            if (point, var) == (point_2, var_2) and who != other and not (past and past_2):
                return True
    for _, point, var, value, past in reads:
        lost = past and before(point, var, history=True) != value
        if before(point, var) != value and not lost:
            return True
    for start, end, var, value, past in holds:
        just_after = (start[0], start[1] + 1)
        lost = past and before(just_after, var, history=True) != value
        if before(just_after, var) != value and not lost:
            return True
        for _, point, var_2, value_2, past_2 in writes:
            if var != var_2 or value == value_2 or not start < point < end:
                continue
            if not past or (not past_2 and before(point, var) == value):
                return True
    return False


def comes_before_the_past(
    task: Task, entries: Sequence[Entry], ranks: dict[tuple[int, str], int], at: Number
) -> bool:
    """Whether something open starts at `at` with a lower rank than a fixed duration ended with."""
    ended, starts = [], []
    for entry, action, start, end in end_points(task, entries, ranks):
        low, high = bounds_of(action, entry) or (0, 0)
        if not (action.conditions or action.effects):
            continue
        if entry.start < entry.end == at and low == high:
            ended.append(end)
        if entry.start == at and not is_past(task, entry, at):
            starts.append(start)
    return any(start < end for start in starts for end in ended)


def has_ambiguous_values(
    task: Task, entries: Sequence[Entry], ranks: dict[tuple[int, str], int], at: Number
) -> bool:
    """Whether two write at one (time, rank), so that the value from then on is anybody's guess."""
    points = []
    for entry, action, start, end in end_points(task, entries, ranks):
        low, high = bounds_of(action, entry) or (0, 0)
        if low == high and not (is_past(task, entry, at) and entry.end <= at):
            end = (end[0], start[1])
        points += [(end if e.at == "end" else start, e.var) for e in action.effects]
    return len(set(points)) < len(points)


@pytest.mark.slow
@settings(SLOW, max_examples=25)
@given(st.data(), state_cases(), st.integers(0, 3))
def test_given_ranks_of_what_is_open_are_blamed_as_the_naive_check_does(
    data: Any, case: tuple[Task, list[Entry]], at: int
) -> None:
    task, entries = case
    task = task.model_copy(update={"precedence": (), "goals": ()})
    ranked = []
    for entry in entries:
        rank = data.draw(st.sampled_from([0, 0, 1, 2]))
        end_rank = data.draw(st.sampled_from([None, None, None, 0, 1, 2]))
        ranked.append(Entry(entry.id, entry.start, entry.end, rank=rank, end_rank=end_rank))
    # What does nothing says that ranks are given.
    task = task.model_copy(
        update={"actions": (*task.actions, *Task(actions=[{"id": "z", "duration": 0}]).actions)}
    )
    ranked.append(Entry("z", 9, 9, rank=1))
    ranks = {}
    for i, entry in enumerate(ranked):
        ranks[i, "start"] = entry.rank
        ranks[i, "end"] = entry.rank if entry.end_rank is None else entry.end_rank
    if has_ambiguous_values(task, ranked, ranks, at):
        return
    verdict = validate(task, Schedule(tuple(ranked)), at)
    blamed = blames_6(task, ranked, ranks, at) or comes_before_the_past(task, ranked, ranks, at)
    assert verdict.valid is not blamed, verdict
    if validate(task, Schedule(tuple(ranked))).valid:
        assert not verdict.carried, verdict


@pytest.mark.slow
@settings(SLOW, max_examples=25)
@given(state_cases(), st.integers(0, 3))
def test_ranks_are_looked_for_only_where_history_has_some(
    case: tuple[Task, list[Entry]], at: int
) -> None:
    task, entries = case
    task = task.model_copy(update={"precedence": ()})
    verdict = validate(task, Schedule(tuple(entries)), at)
    before = only(task, entries, at)
    without_goals = task.model_copy(update={"goals": ()})
    if some_ranks_do(task, entries) or some_ranks_do(without_goals, before):
        assert not verdict.carried
        assert verdict.valid is some_ranks_do(task, entries), verdict
        return
    ranks = {(i, end): 0 for i in range(len(entries)) for end in ("start", "end")}
    if has_ambiguous_values(task, entries, ranks, at):
        return
    blamed = blames_6(task, entries, ranks, at)
    assert any(v.rule != "goal" for v in verdict.violations) is blamed, verdict
    assert verdict.carried or verdict.violations
    assert rule_6_and_7(without_goals, entries, ranks) is False
