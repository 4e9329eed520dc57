"""The order of one instant: the validator against a naive second one, on planted orders.

The second half shows that these cases would tell: each part of the validator that orders an
instant is put out of action, and then the two must disagree.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import cache

import pytest

from irc.model import Task
from irc.schedule import Entry, Schedule
from irc.validation import ranks, state, stock, validate
from irc.validation.bound_schedule import BoundSchedule
from irc.validation.happenings import Edge, Timelines
from irc.validation.level_clusters import LevelCluster, level_clusters
from oracles.instant_cases import instant_case
from oracles.naive_validation import all_rules_of_ranks, some_ranks_do

SEEDS = range(320)

Case = tuple[Task, tuple[Entry, ...], bool]
"""A task, a schedule of it, and whether that is valid."""


@cache
def without_ranks() -> list[Case]:
    """Valid where some ranks do."""
    cases = [instant_case(seed) for seed in SEEDS]
    return [(task, tuple(entries), some_ranks_do(task, entries)) for task, entries in cases]


def ranked(width: int) -> list[Case]:
    """With the ranks of the planted order, in which the entries are: so many share one."""
    found: list[Case] = []
    for task, entries in map(instant_case, SEEDS):
        own = tuple(replace(e, rank=1 + k // width) for k, e in enumerate(entries))
        given = {(k, end): e.rank for k, e in enumerate(own) for end in ("start", "end")}
        found.append((task, own, all_rules_of_ranks(task, own, given)))
    return found


@cache
def with_ranks() -> list[Case]:
    return ranked(1) + ranked(2)


KINDS: list[Callable[[], list[Case]]] = [without_ranks, with_ranks]


def disagreements(cases: Iterable[Case]) -> list[int]:
    """The numbers of the cases that the validator judges otherwise."""
    return [
        k
        for k, (task, entries, valid) in enumerate(cases)
        if (verdict := validate(task, Schedule(entries))).valid is not valid or verdict.undecided
    ]


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_each_planted_instant_is_judged_as_the_naive_check_does(
    kind: Callable[[], list[Case]],
) -> None:
    cases = kind()
    assert len(cases) // 8 < sum(valid for _, _, valid in cases) < 7 * len(cases) // 8
    assert disagreements(cases) == []


ENOUGH = 5
"""So many disagreements show that a case did not tell by luck."""


@pytest.mark.slow
def test_they_tell_if_orders_of_levels_are_not_searched(monkeypatch: pytest.MonkeyPatch) -> None:
    def needed(bound: BoundSchedule, timelines: Timelines) -> tuple[list[Edge], list[LevelCluster]]:
        return level_clusters(bound, timelines)[0], []

    monkeypatch.setattr(ranks, "level_clusters", needed)
    assert len(disagreements(without_ranks())) >= ENOUGH


def test_they_tell_if_hand_overs_demand_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    def searched(
        bound: BoundSchedule, timelines: Timelines
    ) -> tuple[list[Edge], list[LevelCluster]]:
        return [], level_clusters(bound, timelines)[1]

    monkeypatch.setattr(ranks, "level_clusters", searched)
    assert len(disagreements(without_ranks())) >= ENOUGH


def test_they_tell_if_levels_allow_every_order(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(LevelCluster, "allows", lambda *_: True)
    assert len(disagreements(without_ranks())) >= ENOUGH


@pytest.mark.slow
def test_they_tell_if_no_order_is_asked_of_one_rank(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stock, "_check_order", lambda *_: None)
    assert len(disagreements(without_ranks() + with_ranks())) >= ENOUGH


@pytest.mark.slow
def test_they_tell_if_the_past_need_not_come_first(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ranks, "past_first_pairs", lambda _: iter(()))
    assert len(disagreements(without_ranks())) >= ENOUGH
    monkeypatch.undo()
    monkeypatch.setattr(state, "check_past_first", lambda *_: None)
    assert len(disagreements(with_ranks())) >= ENOUGH
