"""Relations between a random task and another one whose optimum follows from the first one's.

(Metamorphic testing: Chen, Cheung, Yiu, 1998.) No oracle is needed, so these tasks may be larger.
"""

from __future__ import annotations

import copy
import random
from collections.abc import Iterator
from fractions import Fraction
from typing import Any

import pytest

from irc.diagnostics import InputError
from irc.driver.solve import solve_task
from irc.model import Task
from irc.schedule import Status
from irc.targets import SolveOptions
from oracles.combined import combined_document

Document = dict[str, Any]
Seeds = Iterator[int]

TIMES = ("duration", "release", "deadline", "start", "latest_start", "due", "min_lag", "max_lag")


def best(document: Document) -> tuple[Any, ...] | None:
    """The optimal values; None where there is no schedule, or the checks say so."""
    try:
        task = Task.model_validate(document)
        schedule = solve_task(task, SolveOptions("cpsat", time_limit=60, workers=1)).schedule
    except InputError:
        return None
    assert schedule.status in (Status.OPTIMAL, Status.INFEASIBLE)
    if schedule.status is Status.INFEASIBLE:
        return None
    return tuple((o.name, o.value) for o in schedule.objective)


def scaled(value: Any, by: Fraction) -> Any:
    if isinstance(value, dict):
        return {key: scaled(part, by) for key, part in value.items()}
    return str(Fraction(value) * by)


def every_time(part: Any, change: Any) -> Any:
    """A document with all its times changed."""
    if isinstance(part, list):
        return [every_time(x, change) for x in part]
    if not isinstance(part, dict):
        return part
    return {
        key: change(value) if key in TIMES or key in ("from", "to") else every_time(value, change)
        for key, value in part.items()
    }


def renamed(part: Any, names: dict[str, str]) -> Any:
    if isinstance(part, list):
        return [renamed(x, names) for x in part]
    if isinstance(part, dict):
        return {key: renamed(value, names) for key, value in part.items()}
    return names.get(part, part) if isinstance(part, str) else part


def shuffled(part: Any, rng: random.Random) -> Any:
    """The same parts in another order, where their order means nothing."""
    if isinstance(part, dict):
        return {
            key: value if key == "objective" else shuffled(value, rng)
            for key, value in sorted(part.items(), key=lambda _: rng.random())
        }
    if isinstance(part, list):
        return sorted((shuffled(x, rng) for x in part), key=lambda _: rng.random())
    return part


@pytest.mark.parametrize("by", [Fraction(3), Fraction(1, 7)])
def test_scaling_all_times_scales_the_makespan(seeds: Seeds, by: Fraction) -> None:
    for seed in seeds:
        document = combined_document(seed)
        found, other = best(document), best(every_time(document, lambda t: scaled(t, by)))
        if found is not None:
            timed = ("makespan", "tardiness")
            found = tuple((n, v * by if n in timed else v) for n, v in found)
        assert found == other


def test_names_and_the_order_of_parts_do_not_matter(seeds: Seeds) -> None:
    for seed in seeds:
        rng = random.Random(seed)
        document = combined_document(seed, 4)
        letters = list("abcd")
        names = {x: f"{y} ü ; é" for x, y in zip(letters, rng.sample(letters, 4), strict=True)}
        assert best(document) == best(shuffled(renamed(document, names), rng))


def test_a_deadline_at_the_optimum_is_kept_and_an_earlier_one_cannot_be(seeds: Seeds) -> None:
    for seed in seeds:
        document = {**combined_document(seed, 4), "objective": ["minimize_makespan"]}
        document.pop("deadline", None)
        found = best(document)
        if found is None:
            assert best({**document, "deadline": 40}) is None
            continue
        ((_, makespan),) = found
        assert best({**document, "deadline": str(makespan)}) == found
        if makespan:
            sooner = str(Fraction(makespan) - Fraction(1, 6))
            assert best({**document, "deadline": sooner}) is None


def test_everything_may_begin_later_by_the_same_time(seeds: Seeds) -> None:
    for seed in seeds:
        document = {**combined_document(seed), "objective": ["minimize_makespan"]}
        found = best(document)
        later = copy.deepcopy(document)
        dates = ("deadline", "start", "latest_start", "due")
        for part in (later, *later["actions"], *later.get("groups", ())):
            part.update({key: part[key] + 5 for key in dates if key in part})
        for action in later["actions"]:
            action["release"] = action.get("release", 0) + 5
        for resource in later.get("resources", ()):
            for window in resource.get("availability", ()):
                window.update({"from": window["from"] + 5, "to": window["to"] + 5})
        if found is not None:
            ((name, makespan),) = found
            found = ((name, makespan + 5 if _must_act(document) else makespan),)
        if found is None or _must_act(document):
            assert best(later) == found


def _must_act(document: Document) -> bool:
    """Whether something happens in every schedule."""
    free = {n for g in document.get("groups", ()) if not g["required"] for n in g["actions"]}
    return any(a["id"] not in free and "occurs" not in a for a in document["actions"])


def test_an_action_in_two_halves_without_a_gap_takes_as_long(seeds: Seeds) -> None:
    for seed in seeds:
        rng = random.Random(seed)
        names = "abcd"
        actions = [
            {
                "id": name,
                "duration": rng.choice((2, 4, 6)),
                "uses": [{"resource": rng.choice("rs"), "amount": rng.choice((1, 1, 2))}],
            }
            for name in names
        ]
        pairs = [[x, y] for x in names for y in names if x < y and rng.random() < 0.3]
        resources = [{"id": "r", "capacity": 2}, {"id": "s", "capacity": 3}]
        document = {"actions": actions, "precedence": pairs, "resources": resources}
        half = actions[-1]["duration"] // 2
        halves = [{**actions[-1], "id": x, "duration": half} for x in ("d1", "d2")]
        again = [
            *([x, "d1"] if y == "d" else [x, y] for x, y in pairs),
            {"before": "d1", "after": "d2", "max_lag": 0},
        ]
        split = {"actions": [*actions[:-1], *halves], "precedence": again, "resources": resources}
        assert best(document) == best(split)
