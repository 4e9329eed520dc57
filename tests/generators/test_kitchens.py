"""New kitchens and episodes: read by the importers, with answers that an exact oracle confirms."""

from __future__ import annotations

import json
from fractions import Fraction
from typing import Any

import pytest

import irc
from irc.errors import OptionError
from irc.frontends.importers.robo import import_robo
from irc.frontends.importers.robo_online import import_robo_online
from irc.generators.episodes import generate_episode
from irc.generators.gold import GoldNotProven, clairvoyant, with_gold, with_oracle
from irc.generators.kitchen_words import episode_text, kitchen_text
from irc.generators.kitchens import AXES, generate_kitchen
from irc.model import Task
from oracles import state_brute_force
from oracles.online_robo import judge
from oracles.online_robo_best import continuation
from oracles.online_robo_kitchen import initial

PAPER_ITEMS = {
    "easy": 2.8,
    "medium": 5,
    "high-speedup": 17,
    "multi-agent": 10,
    "optimization": 7,
    "station": 10,
    "temporal": 8,
}
"""The mean number of items of each axis in the data (of easy: of its five dishes)."""


def task_of(document: dict[str, Any]) -> Task:
    """The task of a kitchen or an episode."""
    importer = import_robo_online if "initial_task" in document else import_robo
    ((_, task),) = importer(json.dumps(document), document["id"])
    return task


def episode_of(axis: str, seed: int, index: int = 0) -> tuple[dict[str, Any], dict[str, Any]]:
    """(the kitchen with its gold answer, its episode)."""
    kitchen = generate_kitchen(axis, None, seed, index)
    document = with_gold(kitchen, 20)
    return document, generate_episode(kitchen, int(document["optimal_makespan"]), seed)


@pytest.mark.parametrize("axis", AXES)
def test_the_kitchens_of_an_axis_have_the_items_of_the_data_and_differ(axis: str) -> None:
    found = [generate_kitchen(axis, None, 1, index).document for index in range(10)]
    assert sum(len(d["items"]) for d in found) / 10 == PAPER_ITEMS[axis]
    assert len({json.dumps([d["items"], d["action_durations"]]) for d in found}) == 10
    assert found == [generate_kitchen(axis, None, 1, index).document for index in range(10)]
    assert found[0]["items"] != generate_kitchen(axis, None, 2, 0).document["items"]
    for document in found:
        assert task_of(document).actions
    assert len(generate_kitchen(axis, 24, 1, 0).document["items"]) == 24


@pytest.mark.slow
@pytest.mark.parametrize("axis", AXES)
def test_the_gold_answer_is_that_of_an_exact_oracle(axis: str) -> None:
    document, episode = episode_of(axis, 4)
    known = initial(episode["initial_task"])
    if document.get("deadline"):
        known = initial({**episode["initial_task"], "deadline": document["deadline"]})
    best = continuation(known, {}, Fraction(0), 60)
    assert best is not None
    assert best.worth == (document.get("optimal_reward"), document["optimal_makespan"])


@pytest.mark.slow
@pytest.mark.parametrize("axis", ["easy", "temporal", "optimization"])
def test_an_episode_can_be_run_to_its_end_and_none_is_better_than_its_oracle(axis: str) -> None:
    _, episode = episode_of(axis, 9)
    episode = with_oracle(episode, 20)
    simulation = irc.simulate(task_of(episode), workers=1, time_limit=20)
    verdict = judge(episode, simulation.to_dict())
    assert verdict.approved, verdict
    reached = verdict.optima[-1]
    assert reached is not None
    oracle = episode["oracle"]
    best = -oracle.get("oracle_final_reward", 0), oracle["oracle_final_makespan"]
    assert best <= (-(reached[0] or 0), reached[1])


@pytest.mark.slow
def test_the_oracle_of_an_episode_is_the_optimum_with_releases() -> None:
    _, episode = episode_of("easy", 2, 2)
    (first, second) = episode["events"]
    task = clairvoyant(task_of(episode))
    releases = {a.id: a.release for a in task.actions if a.release}
    new = [*first["delta"]["add_items"], *second["delta"]["add_items"]]
    assert {name.partition("_")[2] for name in releases} == {*new}
    assert {*releases.values()} == {first["trigger_time"], second["trigger_time"]}
    best = state_brute_force.optimum(task)
    assert best is not None
    found = with_oracle(episode, 20)["oracle"]["oracle_final_makespan"]
    assert best.values["makespan"] == found


def test_a_rush_order_has_a_deadline_that_can_be_kept() -> None:
    kitchen = generate_kitchen("station", None, 3, 0)
    episode = generate_episode(kitchen, 25, 3)
    deadlines = [e["delta"]["add_deliveries"][0]["deadline"] for e in episode["events"]]
    assert [deadline is not None for deadline in deadlines] == [False, True, False]


def test_the_texts_name_all_items_times_and_wishes_of_the_kitchen() -> None:
    for axis in AXES:
        kitchen = generate_kitchen(axis, None, 5, 0)
        episode = generate_episode(kitchen, 30, 5)
        for text, document in (
            (kitchen_text(kitchen.document), kitchen.document),
            (episode_text(episode), episode["initial_task"]),
        ):
            for item in document["items"]:
                assert f"- {item.replace('_', ' ')}, " in text
            assert f"boiling takes {document['action_durations']['boil']} minutes" in text
        assert episode_text(episode).count("At minute ") == len(episode["events"])


def test_what_cannot_be_generated_is_refused() -> None:
    with pytest.raises(OptionError, match="did you mean `easy`"):
        generate_kitchen("eazy", None, 0, 0)
    with pytest.raises(OptionError, match="2 to 200 items"):
        generate_kitchen("easy", 1, 0, 0)
    with pytest.raises(GoldNotProven, match="was not proven within"):
        with_gold(generate_kitchen("high-speedup", 120, 0, 0), 0.02)
