"""Orders worth a reward: half-done ones are finished while they can be, and no reward is missed."""

from __future__ import annotations

from collections.abc import Iterator
from copy import deepcopy
from fractions import Fraction

import pytest

from oracles.online_orders_judge import Judgement, judge
from oracles.online_orders_kitchen import Document, Kitchen, plan_of
from oracles.online_orders_play import Played, play

SEEDS = range(18)


@pytest.fixture(scope="module")
def played() -> list[Played]:
    return [one for seed in SEEDS for one in play(seed)]


@pytest.mark.slow
def test_what_is_half_done_is_finished_while_it_can_be(played: list[Played]) -> None:
    assert [one.judged.faults for one in played if one.judged.faults] == []
    assert all(one.judged.compared and one.judged.worse is None for one in played)
    assert sum(bool(one.judged.given_up) for one in played) > 4
    assert sum(bool(one.judged.unaffordable) for one in played) > 2
    assert any(one.judged.resumed for one in played)


def judged_again(one: Played, step: Document) -> Judgement:
    """The judgement on another answer to the same events."""
    kitchen, at = Kitchen.of(deepcopy(one.task)), Fraction(0)
    # Only what the last event finds matters of the plan: what ran before is as `before` has it.
    for event in one.events:
        begun, new = kitchen.take(deepcopy(event), plan_of(one.before))
        at = Fraction(event["at"])
    old = {n: r for n, r in plan_of(one.before).items() if n not in kitchen.over}
    return judge(kitchen, begun, old, new, at, step)


def _firsts(played: list[Played]) -> Iterator[Played]:
    return (one for one in played if len(one.events) == 1 and one.judged.answered)


@pytest.mark.slow
def test_the_judge_tells_an_order_that_is_given_up_without_need(played: list[Played]) -> None:
    told = []
    for one in _firsts(played):
        finished = [g for g in one.judged.half_done if g not in one.judged.given_up]
        for order in finished:
            step = deepcopy(one.step)
            step["abandoned"] = [*step["abandoned"], order]
            begun = {n for n, r in plan_of(one.before).items() if r.start < step["at"]}
            entries = []
            for entry in step["schedule"]["actions"]:
                if not entry["id"].startswith(f"{order}."):
                    entries.append(entry)
                elif entry["id"] in begun:
                    entries.append({**entry, "status": "abandoned"})
            step["schedule"]["actions"] = entries
            told.append(any("can be" in f for f in judged_again(one, step).faults))
    assert told
    assert all(told)


@pytest.mark.slow
def test_the_judge_tells_a_reward_that_is_missed(played: list[Played]) -> None:
    told = []
    for one in _firsts(played):
        step = deepcopy(one.step)
        begun = {n for n, r in plan_of(one.before).items() if r.start < step["at"]}
        names = {e["id"].rsplit(".", 1)[0] for e in step["schedule"]["actions"]}
        names -= {name.rsplit(".", 1)[0] for name in begun}
        for order in sorted(names & {g["id"] for g in one.task["groups"]})[:1]:
            step["schedule"]["actions"] = [
                e for e in step["schedule"]["actions"] if not e["id"].startswith(f"{order}.")
            ]
            told.append(any("called optimal" in f for f in judged_again(one, step).faults))
    assert told
    assert all(told)
