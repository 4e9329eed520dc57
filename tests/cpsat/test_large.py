"""Large problems: local search answers alone, with the compiler's bound."""

from __future__ import annotations

from typing import Any

import pytest

import irc
from builders import act
from irc.local_search import compiled, search
from irc.model import Task
from irc.targets import Progress
from irc_cpsat import engines
from local_search_tasks import use


def shop() -> dict[str, Any]:
    """Eight actions on two machines, of which one is always busy."""
    actions = [act(f"a{k}", 2 + k % 3, uses=[use(f"m{k % 2}")]) for k in range(8)]
    return {"resources": [{"id": "m0"}, {"id": "m1"}], "actions": actions}


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (engines, search):
        monkeypatch.setattr(module, "LARGE", 8)
    monkeypatch.setattr(compiled, "IS_COMPILED", True)


@pytest.mark.usefixtures("small")
def test_local_search_answers_alone() -> None:
    told: list[Progress] = []
    schedule = irc.solve(Task.model_validate(shop()), time_limit=5, on_progress=told.append)
    assert (schedule.engine, schedule.status) == ("local-search", "optimal")
    assert schedule.makespan == 12


@pytest.mark.usefixtures("small")
@pytest.mark.parametrize(
    "more", [{"objective": ["minimize_makespan", "minimize_cost"]}, {"deadline": 12}]
)
def test_what_it_does_not_know_goes_to_cp_sat(more: dict[str, Any]) -> None:
    schedule = irc.solve(Task.model_validate({**shop(), **more}), time_limit=5)
    assert schedule.makespan == 12
    known = "deadline" in more
    assert (schedule.engine == "local-search") is known


@pytest.mark.usefixtures("small")
def test_an_impossible_deadline_goes_to_cp_sat() -> None:
    document = shop()
    document["actions"][0]["deadline"] = document["actions"][2]["deadline"] = 5
    schedule = irc.solve(Task.model_validate(document), time_limit=5)
    assert schedule.status == "infeasible"
    assert schedule.engine != "local-search"
