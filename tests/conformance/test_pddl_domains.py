"""PDDL2.1 domains that others published, small instances: imported, solved on `cpsat`, and the
schedule, written as a plan, judged by unified-planning's validator on the original PDDL.
"""

from __future__ import annotations

from pathlib import Path

import pytest

import irc
from irc.frontends.importers.pddl import import_pddl
from irc.frontends.importers.pddl.plan import plan_text
from irc.model import Task
from irc.schedule import Status
from oracles.pddl_plans import Judge

pytest.importorskip("unified_planning")

EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "pddl"
SOLVED = {
    "matchcellar": (Status.OPTIMAL, 10),
    "ferry": (Status.OPTIMAL, 25),
    # Boarding and leaving take no time, so no number of them is certain to be enough.
    "deliveries": (Status.FEASIBLE, 17.5),
}
"""The domains that `cpsat` solves, what it says of its answer, and the instance's makespan."""


def imported(name: str) -> Task:
    files = [EXAMPLES / name / f"{part}.pddl" for part in ("domain", "problem")]
    return import_pddl(*((file.read_text("utf-8"), file.name) for file in files))


@pytest.mark.parametrize(("name", "said", "makespan"), [(k, *v) for k, v in SOLVED.items()])
def test_a_schedule_of_cpsat_is_an_accepted_plan_of_the_original(
    name: str, said: Status, makespan: float
) -> None:
    task = imported(name)
    schedule = irc.solve(task, "cpsat", time_limit=120)
    assert (schedule.status, schedule.makespan) == (said, makespan)
    assert Judge(EXAMPLES / name).accepts(plan_text(task, schedule))


def test_the_satellite_has_an_accepted_plan_too_though_not_a_proven_one() -> None:
    task = imported("satellite")
    schedule = irc.solve(task, "cpsat", time_limit=40)
    assert schedule.answered
    assert schedule.makespan >= 26.5
    assert Judge(EXAMPLES / "satellite").accepts(plan_text(task, schedule))
