"""The examples: clean, solved to the makespan that their table promises, by both targets."""

from __future__ import annotations

import re
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import pytest

import irc
from irc.api import validate
from irc.diagnostics import Code
from irc.model.quantities import Number
from irc.model.times import parse_number
from irc.schedule import Status
from irc.targets import get_backend, refused_features
from paths import EXAMPLES

ROW = re.compile(r"^\| \[([\w.]+)\]\(\1\) \| .* \| ([\d.]+) (\w+) \|$", re.MULTILINE)

HARD_TO_PLAN = {"software_project.irc", "delivery_round.irc", "rail_junction.irc"}
"""For kairos: it may not find a schedule of them in that time."""

PLANNER_SECONDS = 10.0
SEARCHED_ON_SECONDS = 2.5
SEARCHED_ON = {
    "robot_team.json",
    "lab_assay.json",
    "print_shop.json",
    "house_build_100.json",
    "cellar_fuses.irc",
    "roof_repair.json",
    "hospital_day.irc",
}
"""Where kairos has a plan soon, but may look for a better one or have no bound that proves it."""


@dataclass(frozen=True)
class Promised:
    """A row of the table: the file, and the makespan that it promises in the task's unit."""

    file: str
    makespan: Number
    time_unit: str

    @property
    def path(self) -> Path:
        return EXAMPLES / self.file


TABLE = [
    Promised(file, parse_number(makespan), unit)
    for file, makespan, unit in ROW.findall((EXAMPLES / "README.md").read_text("utf-8"))
]
LARGE = re.findall(
    r"^\| \[([\w.]+)\]\(\1\) \| .* \| (\w+ \d+(?:, \w+ \d+)*) \|$",
    (EXAMPLES / "README.md").read_text("utf-8"),
    re.MULTILINE,
)
"""(File, "objective value, …") of the examples whose first objectives alone are proven."""

INFEASIBLE = re.findall(
    r"^\| \[([\w.]+)\]\(\1\) \| .* \| none: (\d+) statements \|$",
    (EXAMPLES / "README.md").read_text("utf-8"),
    re.MULTILINE,
)
each_example = pytest.mark.parametrize("promised", TABLE, ids=[row.file for row in TABLE])


def test_the_table_lists_every_example() -> None:
    listed = [row.file for row in TABLE] + [file for file, _ in (*LARGE, *INFEASIBLE)]
    assert sorted(listed) == sorted(
        p.name for p in EXAMPLES.iterdir() if p.suffix in (".json", ".txt", ".irc")
    )


@pytest.mark.parametrize(("file", "count"), INFEASIBLE)
def test_an_example_without_a_schedule_has_the_promised_conflict(file: str, count: str) -> None:
    assert list(irc.check(EXAMPLES / file)) == []
    explanation = irc.explain(EXAMPLES / file)
    assert (explanation.feasible, explanation.minimal) == (False, True)
    assert len(explanation.conflict) == int(count)


@pytest.mark.slow
@each_example
def test_nothing_is_to_be_said_of_an_example(promised: Promised) -> None:
    report = irc.check(promised.path)
    assert list(report) == [], report.render()


@pytest.mark.slow
@each_example
def test_cpsat_proves_the_promised_makespan(promised: Promised) -> None:
    task = irc.load(promised.path).ir
    schedule = irc.solve(task, "cpsat", time_limit=60, shortcut=False)
    assert (schedule.status, schedule.makespan) == (Status.OPTIMAL, promised.makespan)
    assert task.time_unit == promised.time_unit
    assert validate(task, schedule).valid


@pytest.mark.slow
@pytest.mark.parametrize(("file", "values"), LARGE)
def test_a_large_example_has_a_schedule_soon(file: str, values: str) -> None:
    task = irc.load(EXAMPLES / file).ir
    assert list(irc.check(EXAMPLES / file)) == []
    first, least = values.split(", ")[0].split()
    schedule = irc.solve(task, "cpsat", time_limit=4)
    verdict = validate(task, schedule)
    assert verdict.valid
    assert {v.name: v.value for v in schedule.objective}[first] <= int(least)


@pytest.mark.slow
@pytest.mark.skipif(find_spec("kairos") is None, reason="kairos has wheels for Linux only")
@each_example
def test_kairos_answers_within_ten_seconds_or_the_target_refuses(promised: Promised) -> None:
    task = irc.load(promised.path).ir
    if refused_features(task, get_backend("pddl21")):
        with pytest.raises(irc.InputError) as refused:
            irc.compile(task, "pddl21")
        assert {d.code for d in refused.value.report.errors} == {Code.UNSUPPORTED}
        return
    hard = promised.file in HARD_TO_PLAN
    searched_on = hard or promised.file in SEARCHED_ON
    seconds = SEARCHED_ON_SECONDS if searched_on else PLANNER_SECONDS
    schedule = irc.solve(
        task, "pddl21", engine="kairos", time_limit=seconds, workers=1, shortcut=False
    )
    if hard and schedule.status is Status.UNKNOWN:
        return
    assert validate(task, schedule).valid
    if searched_on:
        assert schedule.makespan >= promised.makespan
    else:
        assert (schedule.status, schedule.makespan) == (Status.OPTIMAL, promised.makespan)


def test_the_house_has_a_hundred_steps() -> None:
    assert len(irc.load(EXAMPLES / "house_build_100.json").ir.actions) == 100
