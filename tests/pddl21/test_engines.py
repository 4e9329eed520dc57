"""Planners that misbehave: the best plan is kept, the status is honest, nothing is left running.

OPTIC is played by fakes, named in `$IRC_OPTIC`. They print what a test lets them print, and then
go wrong.
"""

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import irc
from irc.schedule import Status
from irc.targets import Budget, EngineFailed, EngineMissing, Outcome, SolveOptions, get_backend
from irc_pddl21.encoding.encode import encode
from paths import FAKES

pytestmark = pytest.mark.skipif(
    not sys.platform.startswith("linux"), reason="the fakes are shell scripts, kairos is for Linux"
)

SLACK = 1.5  # seconds that an engine may take beyond its limit

# One oven: b before a makes 9, a before b makes 7, which the work of the oven proves best.
TASK: dict[str, Any] = {
    "name": "one oven",
    "resources": [{"id": "oven"}],
    "actions": [
        {"id": "a", "duration": 3, "uses": [{"resource": "oven"}]},
        {"id": "b", "duration": 4, "uses": [{"resource": "oven"}]},
        {"id": "c", "duration": 2},
    ],
    "precedence": [["a", "c"]],
}

POOR = """\
; Plan found with metric 9.002
0.000: (b)  [4.000]
4.001: (a)  [3.000]
7.002: (c)  [2.000]

"""
BEST = """\
; Plan found with metric 7.001
0.000: (a)  [3.000]
3.001: (b)  [4.000]
3.001: (c)  [2.000]

"""
OVERFLOWN = POOR.replace("4.001:", "-2147483.00-647:")
LACKS_AN_ACTION = BEST.replace("3.001: (c)  [2.000]\n", "")
REPEATS_AN_ACTION = POOR.strip() + "\n9.003: (a)  [3.000]\n"
NAMES_A_STRANGER = POOR.strip() + "\n9.003: (wash)  [1.000]\n"
IN_WRONG_ORDER = POOR.replace("7.002: (c)", "0.000: (c)")
OVERBOOKED = BEST.replace("3.001: (b)", "0.000: (b)")


@pytest.fixture
def optic(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., Path]]:
    """Installs an OPTIC that prints a text and then behaves as told. Where it is asked for a first
    plan only (`-N`), as it is under the deadline of the bound, that is `asked_first`.

    Returns the file that appears when it is started. At the end nothing of it may be running.
    """
    started = tmp_path / "started"

    def install(says: str, then: str, *, asked_first: tuple[str, str] = ("", "exits")) -> Path:
        play = f"exec '{sys.executable}' -S '{FAKES / 'prints_then.py'}' '{tmp_path}"
        (tmp_path / "first").write_text(asked_first[0])
        (tmp_path / "best").write_text(says)
        command = tmp_path / "optic"
        command.write_text(
            f"#!/bin/sh\necho yes > '{started}'\n"
            f'test "$1" = -N && {play}/first\' {asked_first[1]} "$@"\n'
            f'{play}/best\' {then} "$@"\n'
        )
        command.chmod(0o755)
        monkeypatch.setenv("IRC_OPTIC", str(command))
        return started

    yield install
    left = running(tmp_path)
    for pid in left:
        os.kill(pid, signal.SIGKILL)
    assert not left, "a planner was left behind"


@pytest.fixture
def _without_aries(monkeypatch: pytest.MonkeyPatch) -> None:
    """aries takes seconds to start; what it does between the others is not what is tested."""
    from irc_pddl21.engines import Aries

    monkeypatch.setattr(Aries, "missing", lambda _: "not here")


without_aries = pytest.mark.usefixtures("_without_aries")


def running(folder: Path) -> list[int]:
    """The processes with a file of this folder on their command line, once they had time to go."""
    deadline = time.monotonic() + 1
    while True:
        found = [
            int(entry.name)
            for entry in Path("/proc").iterdir()
            if entry.name.isdigit() and str(folder).encode() in command_line(entry)
        ]
        if not found or time.monotonic() > deadline:
            return found
        time.sleep(0.02)


def command_line(process: Path) -> bytes:
    try:
        return (process / "cmdline").read_bytes()
    except OSError:  # it has just ended
        return b""


def outcome_of(engine: str, seconds: float = 20, task: dict[str, Any] = TASK) -> Outcome:
    """What an engine makes of a task; a net of 20 s where the limit is not what is tested."""
    program = irc.compile(task, "pddl21")
    chosen = get_backend("pddl21").engines()[engine]
    return chosen.solve(program, SolveOptions(), Budget(seconds))


def makespan(outcome: Outcome) -> object:
    return None if outcome.schedule is None else outcome.schedule.makespan


def told(outcome: Outcome) -> str:
    return "\n".join(note.message for note in outcome.notes)


# One planner that goes wrong


@pytest.mark.slow
@pytest.mark.parametrize("then", ["exits", "fails", "crashes"])
def test_a_plan_is_kept_however_the_planner_ends(optic, then: str) -> None:
    optic(POOR, then)
    outcome = outcome_of("optic")
    assert (outcome.status, makespan(outcome)) == (Status.FEASIBLE, 9)


@pytest.mark.alone
@pytest.mark.parametrize("then", ["hangs", "ignores", "forks"])
def test_a_plan_is_kept_when_time_is_up(optic, then: str) -> None:
    optic(POOR, then)
    began = time.monotonic()
    outcome = outcome_of("optic", seconds=1)
    assert 1 <= time.monotonic() - began <= 1 + SLACK
    assert (outcome.status, makespan(outcome)) == (Status.FEASIBLE, 9)


@pytest.mark.alone
@pytest.mark.parametrize("then", ["hangs", "ignores", "forks"])
def test_without_a_plan_in_time_nothing_is_claimed(optic, then: str) -> None:
    optic("Initial heuristic = 10.000\nb (2.000 | 27.004)", then)
    began = time.monotonic()
    outcome = outcome_of("optic", seconds=0.7)
    assert time.monotonic() - began <= 0.7 + SLACK
    assert (outcome.status, outcome.schedule) == (Status.UNKNOWN, None)
    assert "no usable plan within" in told(outcome)


@pytest.mark.alone
def test_a_planner_that_meets_the_bound_is_stopped_at_once(optic) -> None:
    optic(POOR + BEST, "hangs")
    began = time.monotonic()
    outcome = outcome_of("optic", seconds=20)
    assert time.monotonic() - began < 10
    assert makespan(outcome) == 7


@pytest.mark.slow
def test_the_best_of_several_plans_is_kept_not_the_last(optic) -> None:
    optic(BEST + POOR, "exits")
    assert makespan(outcome_of("optic")) == 7


@pytest.mark.slow
@pytest.mark.parametrize(
    ("then", "why"), [("fails", "exit status 3: bad_alloc: cannot go on"), ("crashes", "signal 11")]
)
def test_a_breakdown_without_a_plan_is_an_engine_failure(optic, then: str, why: str) -> None:
    optic("Initial heuristic = 10.000\n", then)
    with pytest.raises(EngineFailed, match=why):
        outcome_of("optic")


@pytest.mark.slow
@pytest.mark.parametrize(
    "says",
    [
        "",
        "\x00\x07 { rubbish ] \u2028\n" * 50,
        # OPTIC says so, and exits with 0.
        "Errors: /tmp/domain.pddl: line: 3: syntax error in action declaration.\n",
        "Problem Unsolvable\n",
    ],
)
def test_an_exit_without_a_plan_is_no_answer_and_no_proof(optic, says: str) -> None:
    optic(says, "exits")
    outcome = outcome_of("optic")
    assert (outcome.status, outcome.schedule) == (Status.UNKNOWN, None)
    assert told(outcome)


@pytest.mark.alone
def test_a_flood_is_cut_off_and_the_plan_before_it_kept(optic) -> None:
    optic(POOR, "floods")
    began = time.monotonic()
    outcome = outcome_of("optic", seconds=1)
    # Up to 64 MiB of chatter are read once more behind the end; that takes longer than `SLACK`.
    assert time.monotonic() - began < 8
    assert makespan(outcome) == 9


@pytest.mark.slow
@pytest.mark.parametrize(
    ("plan", "why"),
    [
        (OVERFLOWN, "has overflowed the planner's clock"),
        (LACKS_AN_ACTION, "'c' is missing"),
        (REPEATS_AN_ACTION, "'a' happens twice"),
        (NAMES_A_STRANGER, "the program has no action 'wash'"),
    ],
    ids=["overflown", "lacks an action", "repeats an action", "names a stranger"],
)
def test_a_bad_plan_is_not_used_but_a_good_one_beside_it_is(optic, plan: str, why: str) -> None:
    optic(plan, "exits")
    outcome = outcome_of("optic")
    assert (outcome.status, outcome.schedule) == (Status.UNKNOWN, None)
    assert why in told(outcome)
    optic(POOR + plan, "exits")
    assert makespan(outcome_of("optic")) == 9


@pytest.mark.slow
def test_damage_is_told_even_where_another_plan_is_used(optic) -> None:
    optic(POOR + OVERFLOWN, "exits")
    outcome = outcome_of("optic")
    assert makespan(outcome) == 9
    assert "'-2147483.00-647: (a)  [3.000]'" in told(outcome)


@pytest.mark.slow
def test_a_plan_against_the_precedence_is_put_in_order(optic) -> None:
    """A planner's times are not believed: its order on the oven is kept, the rest is re-timed."""
    optic(IN_WRONG_ORDER, "exits")
    schedule = irc.solve(TASK, "pddl21", engine="optic", time_limit=20)
    assert {e.id: (e.start, e.end) for e in schedule.entries} == {
        "b": (0, 4),
        "a": (4, 7),
        "c": (7, 9),
    }


@pytest.mark.slow
def test_a_plan_beyond_the_capacity_is_not_used(optic) -> None:
    optic(OVERBOOKED, "exits")
    assert outcome_of("optic").schedule is None


@pytest.mark.slow
def test_a_plan_beyond_the_capacity_does_not_displace_a_valid_one(optic) -> None:
    optic(POOR + OVERBOOKED, "exits")
    schedule = irc.solve(TASK, "pddl21", engine="optic", time_limit=20)
    assert (schedule.status, schedule.makespan) == (Status.FEASIBLE, 9)


# Asked first for a plan as short as the bound


def under_a_deadline(plan: str) -> str:
    """The plan in the finer units of the files that hold the bound as a deadline."""
    problem = irc.compile(TASK, "pddl21").problem
    scale = encode(replace(problem, deadline=problem.bounds.makespan.value)).scale
    assert scale > 1
    return re.sub(r"[\d.]+(?=:|\])", lambda time: f"{float(time[0]) * scale:.3f}", plan)


def test_a_plan_as_short_as_the_bound_needs_no_second_search(optic) -> None:
    optic("", "crashes", asked_first=(under_a_deadline(BEST), "hangs"))
    assert makespan(outcome_of("optic")) == 7


@pytest.mark.slow
@pytest.mark.parametrize("then", ["fails", "crashes", "hangs", "exits"])
def test_a_planner_that_finds_none_so_short_is_asked_for_any(optic, then: str) -> None:
    optic(POOR, "exits", asked_first=("", then))
    assert makespan(outcome_of("optic", seconds=4)) == 9


@pytest.mark.slow
@pytest.mark.parametrize("then", ["fails", "crashes", "exits"])
def test_a_longer_plan_is_kept_where_the_second_search_gives_nothing(optic, then: str) -> None:
    optic("", then, asked_first=(under_a_deadline(POOR), "exits"))
    assert makespan(outcome_of("optic")) == 9


# What is claimed


@pytest.mark.slow
def test_optimal_is_said_only_where_the_makespan_meets_the_bound(optic) -> None:
    optic(POOR + "Problem Unsolvable\n;;;; Solution Found\n" + POOR, "exits")
    poor = irc.solve(TASK, "pddl21", engine="optic", time_limit=20)
    assert (poor.status, poor.objective[0].value, poor.objective[0].bound) == (
        Status.FEASIBLE,
        9,
        7,
    )
    optic(BEST, "exits")
    best = irc.solve(TASK, "pddl21", engine="optic", time_limit=20)
    assert (best.status, best.objective[0].value, best.objective[0].bound) == (
        Status.OPTIMAL,
        7,
        7,
    )


def test_a_planners_epsilons_never_show(optic) -> None:
    optic(BEST, "exits")
    schedule = irc.solve(TASK, "pddl21", engine="optic", time_limit=20)
    assert {e.id: (e.start, e.end) for e in schedule.entries} == {
        "a": (0, 3),
        "b": (3, 7),
        "c": (3, 5),
    }


# 32-bit milliseconds


def long_task(duration: int) -> dict[str, Any]:
    """Three actions on one oven; no two of their durations have a common divisor."""
    actions = [
        {**action, "duration": duration + k} for k, action in enumerate(TASK["actions"], start=1)
    ]
    return {**TASK, "actions": actions}


def test_what_optics_clock_cannot_hold_is_refused_before_it_starts(optic) -> None:
    started = optic(POOR, "exits")
    with pytest.raises(irc.InputError, match="OPTIC's clock ends at") as caught:
        irc.solve(long_task(2_000_000), "pddl21", engine="optic", time_limit=20)
    assert caught.value.report.errors[0].code.id == "IRC502"
    assert not started.exists()


def test_a_deadline_beyond_optics_clock_is_refused_before_it_starts(optic) -> None:
    started = optic(POOR, "exits")
    with pytest.raises(irc.InputError, match="the task has times of up to"):
        irc.solve({**TASK, "deadline": 2_147_484}, "pddl21", engine="optic", time_limit=20)
    assert not started.exists()


def test_what_fits_optics_clock_once_divided_by_the_tick_is_not_refused(optic) -> None:
    started = optic("", "exits")
    whole_days = {
        **TASK,
        "actions": [{**a, "duration": a["duration"] * 864_000} for a in TASK["actions"]],
    }
    assert irc.compile(whole_days, "pddl21").problem.to_units(1) == 864_000
    assert outcome_of("optic", task=whole_days).status is Status.UNKNOWN
    assert started.exists()


@pytest.mark.slow
def test_auto_goes_on_with_another_planner_where_optics_clock_is_too_short(optic) -> None:
    started = optic(POOR, "exits")
    schedule = irc.solve(long_task(2_000_000), "pddl21", time_limit=20)
    assert (schedule.engine, schedule.makespan) == ("kairos", 4_000_004)
    assert not started.exists()


def test_what_kairos_cannot_tell_apart_is_refused_not_searched_for(optic) -> None:
    with pytest.raises(irc.InputError, match="beyond what kairos can tell apart"):
        irc.solve(long_task(10**14), "pddl21", engine="kairos", time_limit=20)


# The portfolio


def test_auto_without_optic_is_kairos(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delenv("IRC_OPTIC", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
    schedule = irc.solve(TASK, "pddl21", time_limit=20)
    assert (schedule.engine, schedule.status, schedule.makespan) == ("kairos", Status.OPTIMAL, 7)


@pytest.mark.slow
def test_auto_takes_optics_plan_where_it_meets_the_bound(optic) -> None:
    optic(BEST, "exits")
    outcome = outcome_of("auto")
    assert (outcome.engine, makespan(outcome)) == ("optic", 7)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("says", "then"),
    [("", "fails"), ("", "crashes"), ("", "exits"), (LACKS_AN_ACTION, "exits"), ("", "hangs")],
)
def test_auto_goes_on_with_kairos_where_optic_gives_nothing(optic, says: str, then: str) -> None:
    optic(says, then)
    outcome = outcome_of("auto", seconds=3 if then == "hangs" else 20)
    assert (outcome.engine, makespan(outcome)) == ("kairos", 7)
    assert told(outcome).startswith("optic: ")


@pytest.mark.slow
@without_aries
def test_auto_is_not_taken_in_by_a_plan_beyond_the_capacity(optic) -> None:
    optic(OVERBOOKED, "exits")
    schedule = irc.solve(TASK, "pddl21", time_limit=20)
    assert (schedule.status, schedule.makespan) == (Status.OPTIMAL, 7)


@pytest.mark.slow
@without_aries
def test_auto_goes_on_with_kairos_where_optics_plan_is_not_the_best(optic) -> None:
    optic(POOR, "exits")
    outcome = outcome_of("auto")
    assert (outcome.engine, makespan(outcome)) == ("kairos", 7)


def test_auto_keeps_optics_plan_where_no_other_planner_answers(
    optic, monkeypatch: pytest.MonkeyPatch
) -> None:
    from irc_pddl21.engines import Aries, Kairos

    def broken(*_: object) -> None:
        raise EngineFailed("broken")

    optic(POOR, "exits")
    for planner in (Aries, Kairos):
        monkeypatch.setattr(planner, "solve", broken)
    outcome = outcome_of("auto")
    assert (outcome.engine, makespan(outcome), outcome.status) == ("optic", 9, Status.FEASIBLE)


@pytest.mark.alone
def test_auto_keeps_to_one_time_limit_for_all_planners(optic) -> None:
    optic(POOR, "hangs")
    began = time.monotonic()
    outcome = outcome_of("auto", seconds=1.5)
    assert time.monotonic() - began <= 1.5 + SLACK
    assert makespan(outcome) in (7, 9)


def test_a_missing_optic_is_told_with_the_name_that_was_tried(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("IRC_OPTIC", "/nowhere/optic-clp")
    with pytest.raises(EngineMissing, match=r"\$IRC_OPTIC names '/nowhere/optic-clp'"):
        irc.solve(TASK, "pddl21", engine="optic")


# The command, ended from outside


@pytest.mark.slow
def test_a_planner_ends_with_the_command_that_started_it(optic, tmp_path: Path) -> None:
    started = optic("", "ignores")
    task = tmp_path / "task.json"
    task.write_text('{"actions": [{"id": "a", "duration": 3}]}')
    command = ["solve", str(task), "-t", "pddl21", "-e", "optic", "--no-shortcut"]
    with subprocess.Popen([sys.executable, "-m", "irc", *command]) as child:
        while not started.exists() and child.poll() is None:
            time.sleep(0.02)
        child.terminate()
        assert child.wait(10) == 128 + signal.SIGTERM
