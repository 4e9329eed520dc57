"""Whatever valid schedule an engine finds, re-timing keeps it valid and makes nothing later."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from irc.lowering.lower import lower
from irc.model import Task
from irc.passes import run_passes
from irc.passes.unroll import unroll
from irc.problem import Activity, Problem
from irc.problem.decisions import ABSENT, Decision, Placed
from irc.retiming.retime import retime
from irc.retiming.to_schedule import schedule_of
from irc.schedule import Entry, Schedule
from irc.validation import validate
from oracles.planted import planted

seeds = st.integers(0, 10**6)


def decisions_of(problem: Problem, entries: Sequence[Entry]) -> list[Decision]:
    by_name = {(entry.id, entry.occurrence): entry for entry in entries}
    index = {resource.id: r for r, resource in enumerate(problem.resources)}
    return [
        _decision(a, by_name[a.id, a.details.occurrence], index)
        if (a.id, a.details.occurrence) in by_name
        else ABSENT
        for a in problem.activities
    ]


def _decision(activity: Activity, entry: Entry, index: dict[str, int]) -> Decision:
    held = {index[name] for name in entry.resources}
    modes = [mode.id for mode in activity.details.modes]
    return Decision(
        int(entry.start),
        int(entry.end),
        tuple(next((r for r in u.alternatives if r in held), None) for u in activity.uses),
        mode=modes.index(entry.mode) if entry.mode is not None else None,
        rank=entry.rank,
        end_rank=entry.rank if entry.end_rank is None else entry.end_rank,
    )


def as_decisions(placed: Sequence[Placed]) -> list[Decision]:
    return [
        Decision(p.start, p.end, p.resources, p.present, p.mode, p.rank, p.end_rank) for p in placed
    ]


def with_explicit_ranks(entries: Sequence[Entry]) -> Schedule:
    """All ranks one higher, so that none are looked for: these ranks must do."""
    return Schedule(
        tuple(
            replace(e, rank=e.rank + 1, end_rank=None if e.end_rank is None else e.end_rank + 1)
            for e in entries
        )
    )


def problems(task: Task) -> tuple[Problem, Problem]:
    return unroll(lower(task), 3), unroll(run_passes(lower(task)), 3)


@pytest.mark.slow
@settings(max_examples=40, deadline=None)
@given(seeds)
def test_the_planted_schedule_is_valid(seed: int) -> None:
    task, entries = planted(seed)
    verdict = validate(task, with_explicit_ranks(entries))
    assert verdict.valid, verdict.violations


@pytest.mark.slow
@settings(max_examples=75, deadline=None)
@given(seeds)
def test_what_is_re_timed_stays_valid_with_its_own_ranks(seed: int) -> None:
    task, entries = planted(seed)
    for problem in problems(task):
        schedule = schedule_of(problem, retime(problem, decisions_of(problem, entries)))
        for judged in (schedule, with_explicit_ranks(schedule.entries)):
            verdict = validate(task, judged)
            assert verdict.valid, verdict.violations


@pytest.mark.slow
@settings(max_examples=40, deadline=None)
@given(seeds)
def test_nothing_becomes_later_and_choices_stay(seed: int) -> None:
    task, entries = planted(seed)
    for problem in problems(task):
        decisions = decisions_of(problem, entries)
        for place, decision in zip(retime(problem, decisions), decisions, strict=True):
            assert (place.present, place.mode) == (decision.present, decision.mode)
            assert place.start <= decision.start
            assert place.end <= decision.end


@pytest.mark.slow
@settings(max_examples=40, deadline=None)
@given(seeds)
def test_what_is_re_timed_moves_no_further(seed: int) -> None:
    task, entries = planted(seed)
    for problem in problems(task):
        placed = retime(problem, decisions_of(problem, entries))
        assert retime(problem, as_decisions(placed)) == placed


@pytest.mark.slow
@settings(max_examples=40, deadline=None)
@given(seeds, st.integers(1, 50))
def test_waiting_before_everything_starts_changes_nothing(seed: int, wait: int) -> None:
    """An idle gap is closed: with no date to keep, only the order says when things happen."""
    task, entries = planted(seed)
    document = task.model_dump(mode="json", by_alias=True, exclude_defaults=True)
    document.pop("deadline", None)
    for action in document["actions"]:
        action.pop("deadline", None)
    for resource in document.get("resources", ()):
        resource.pop("availability", None)
        if resource.get("kind") != "reservoir":
            resource["capacity"] = 20
    task = Task.model_validate(document)
    later = [replace(e, start=e.start + wait, end=e.end + wait) for e in entries]
    problem = unroll(lower(task), 3)
    if problem.tick != 1:
        return
    assert retime(problem, decisions_of(problem, later)) == retime(
        problem, decisions_of(problem, entries)
    )
