"""irc's validator and the kitchen's simulation judge the same plans alike."""

from __future__ import annotations

import json
from functools import cache

import pytest

from irc import Task, validate
from irc.evaluation.data import Data
from irc.evaluation.robo import judge_plan
from irc.frontends.importers.plan_lines import plan_schedule
from irc.frontends.importers.robo import import_robo
from irc.methods import read_plan
from paths import SHARED_DATA

DATA = Data(SHARED_DATA)


@cache
def task_of(instance: str) -> Task:
    ((_, task),) = import_robo(json.dumps(DATA.kitchens[instance]), instance)
    return task


@pytest.mark.shared_data
@pytest.mark.slow
def test_each_delivered_plan_gets_the_recorded_verdict_from_both() -> None:
    judged = less_reward = 0
    for record in DATA.records("robo_planner"):
        plan = read_plan(record["answer"] or "")
        kitchen = DATA.kitchens[record["id"]]
        if not plan:
            continue
        verdict = validate(task_of(record["id"]), plan_schedule(plan))
        assert judge_plan(kitchen, plan).valid is record["success"]
        if "candidate_goals" in kitchen:
            assert verdict.valid or not record["success"]
            less_reward += verdict.valid and not record["success"]
        else:
            judged += 1
            assert verdict.valid is record["success"], record["id"]
    assert judged > 100
    assert less_reward > 0
