"""PDDL2.1 domains that others published, small instances: imported, solved on `cpsat`, and the
schedule, written as a plan, judged by unified-planning's validator on the original PDDL.
"""

from __future__ import annotations

import pytest

import irc
from irc.frontends.importers.pddl import import_pddl
from irc.frontends.importers.pddl.plan import plan_text
from irc.model import Task
from irc.schedule import Status
from irc.targets import get_backend
from oracles.pddl_plans import Judge
from paths import EXAMPLES

pytest.importorskip("unified_planning")

EXAMPLES = EXAMPLES / "pddl"
SOLVED = {
    "matchcellar": (Status.OPTIMAL, 10),
    "ferry": (Status.OPTIMAL, 24),
    # Boarding and leaving take no time, so no number of them is certain to be enough.
    "deliveries": (Status.FEASIBLE, 17.5),
}
"""The domains that `cpsat` solves, what it says of its answer, and the instance's makespan."""


def imported(name: str) -> Task:
    files = [EXAMPLES / name / f"{part}.pddl" for part in ("domain", "problem")]
    return import_pddl(*((file.read_text("utf-8"), file.name) for file in files))


@pytest.mark.slow
@pytest.mark.parametrize(("name", "said", "makespan"), [(k, *v) for k, v in SOLVED.items()])
def test_a_schedule_of_cpsat_is_an_accepted_plan_of_the_original(
    name: str, said: Status, makespan: float
) -> None:
    task = imported(name)
    schedule = irc.solve(task, "cpsat", time_limit=120)
    assert (schedule.status, schedule.makespan) == (said, makespan)
    assert Judge(EXAMPLES / name).accepts(plan_text(task, schedule))


@pytest.mark.slow
@pytest.mark.parametrize("name", [*SOLVED, "satellite"])
def test_a_planners_schedule_is_an_accepted_plan_of_the_original_too(name: str) -> None:
    missing = get_backend("pddl21").engines()["kairos"].missing()
    if missing is not None:
        pytest.skip(missing)
    task = imported(name)
    schedule = irc.solve(task, "pddl21", engine="kairos", time_limit=4)
    assert schedule.answered
    assert Judge(EXAMPLES / name).accepts(plan_text(task, schedule))
    if name in SOLVED:
        assert schedule.makespan >= SOLVED[name][1]
