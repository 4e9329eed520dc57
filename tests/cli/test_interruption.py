"""^C and SIGTERM: the first ends a command with the best answer so far, the second at once."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import irc
from api.test_running import shop
from irc.cli.interruption import Interrupted, Interruption
from irc.model import Task

pytestmark = [
    pytest.mark.alone,
    pytest.mark.skipif(sys.platform == "win32", reason="there are no signals"),
]

WITHIN = 5.0
"""Seconds in which a command ends after a signal, also where the machine is busy: far less than its
time limit. `benchmarks/interruption.py` measures the one second that is promised."""

OLD = "what was there before"


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a shop that nobody proves, and its plan."""
    folder = tmp_path_factory.mktemp("shop")
    document = shop().model_dump(mode="json", by_alias=True, exclude_unset=True)
    change = {"op": "set_duration", "action": "0-0", "duration": 150}
    document["events"] = [{"id": f"e{at}", "at": at, "changes": [change]} for at in (1, 2, 3)]
    (folder / "shop.json").write_text(json.dumps(document), encoding="utf-8")
    plan = irc.solve(Task.model_validate(document), time_limit=0.3)
    (folder / "plan.json").write_text(json.dumps(plan.to_dict()), encoding="utf-8")
    return folder


def begun(folder: Path, *arguments: str, **environment: str) -> subprocess.Popen[bytes]:
    """A command in a process of its own."""
    return subprocess.Popen(
        [sys.executable, "-m", "irc", *arguments],
        cwd=folder,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env={**os.environ, **environment},
    )


def interrupted(
    process: subprocess.Popen[bytes], number: int, after: float | Callable[[], bool]
) -> tuple[float, str, str]:
    """(processor seconds or seconds from the signal to the end, what it printed, its errors)."""
    if callable(after):
        while not after():
            time.sleep(0.01)
    else:
        time.sleep(after)
    assert process.poll() is None, process.communicate()
    began = time.perf_counter()
    process.send_signal(number)
    out, errors = process.communicate(timeout=30)
    return time.perf_counter() - began, out.decode(), errors.decode()


def planners_of(token: str) -> list[int]:
    """The processes with a token in their environment."""
    found = []
    for entry in Path("/proc").glob("[0-9]*/environ"):
        try:
            if token.encode() in entry.read_bytes():
                found.append(int(entry.parent.name))
        except OSError:
            continue
    return found


def searches(process: subprocess.Popen[bytes], token: str) -> bool:
    """Whether it has begun to search: a planner runs, or CP-SAT has its threads."""
    threads = list(Path(f"/proc/{process.pid}/task").iterdir())
    return len(planners_of(token)) > 1 or len(threads) > 3


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="there is no /proc")
@pytest.mark.parametrize(
    ("target", "number"), [("cpsat", signal.SIGINT), ("pddl21", signal.SIGTERM)]
)
def test_solve_ends_with_the_best_answer_so_far(
    files: Path, tmp_path: Path, target: str, number: int
) -> None:
    out = tmp_path / "out.json"
    out.write_text(OLD, encoding="utf-8")
    token = f"interrupted-{target}-{os.getpid()}"
    process = begun(
        *(files, "solve", "shop.json", "--target", target, "--format", "json"),
        *("--time-limit", "60", "-o", str(out)),
        IRC_TEST=token,
        TMPDIR=str(tmp_path),
    )
    seconds, printed, errors = interrupted(process, number, lambda: searches(process, token))
    assert process.returncode == 128 + number, errors
    assert seconds < WITHIN
    document = json.loads(printed)
    assert (document["status"], document["interrupted"]) == ("feasible", True)
    assert json.loads(out.read_text(encoding="utf-8")) == document
    assert irc.validate(files / "shop.json", irc.Schedule.from_dict(document)).valid
    assert "Traceback" not in errors
    assert planners_of(token) == []
    assert [path.name for path in tmp_path.iterdir()] == ["out.json"]


@pytest.mark.slow
def test_simulate_keeps_the_steps_before(files: Path, tmp_path: Path) -> None:
    process = begun(
        *(files, "simulate", "shop.json", "--schedule", "plan.json", "--format", "json"),
        *("--time-limit", "60", "--steps", str(tmp_path)),
    )
    first = tmp_path / "step_000.json"
    seconds, printed, errors = interrupted(process, signal.SIGINT, first.exists)
    assert process.returncode == 130, errors
    assert seconds < WITHIN
    document = json.loads(printed)
    assert document["interrupted"] is True
    assert 1 <= len(document["steps"]) < 4
    written = [json.loads(path.read_text()) for path in sorted(tmp_path.iterdir())]
    assert [step["schedule"] for step in written] == [s["schedule"] for s in document["steps"]]


@pytest.mark.slow
def test_a_command_that_has_nothing_yet_ends_without_an_answer(files: Path, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "never.json")
    process = begun(tmp_path, "solve", "never.json", "--format", "json", "-o", "out.json")
    seconds, printed, errors = interrupted(process, signal.SIGINT, 1.0)
    assert process.returncode == 130
    assert seconds < WITHIN
    assert "interrupted" in errors
    if printed:
        assert json.loads(printed)["exit"] == 130
    assert [path.name for path in tmp_path.iterdir()] == ["never.json"]


@pytest.mark.slow
def test_a_running_task_ends_while_it_waits_for_requests(files: Path) -> None:
    for number, status in ((signal.SIGTERM, 0), (signal.SIGINT, 130)):
        process = begun(files, "run", "shop.json", "--stdio", "--schedule", "plan.json")
        assert process.stdout is not None
        greeting = json.loads(process.stdout.readline())
        assert greeting["ok"]
        _, printed, errors = interrupted(process, number, 0.0)
        assert (process.returncode, printed, errors) == (status, "", "")


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="there is no /proc")
def test_a_running_task_answers_the_request_that_it_works_on(files: Path) -> None:
    command = ["run", "shop.json", "--stdio", "--schedule", "plan.json", "--target", "pddl21"]
    token = f"interrupted-run-{os.getpid()}"
    process = begun(files, *command, IRC_TEST=token)
    assert process.stdin is not None
    assert process.stdout is not None
    process.stdout.readline()
    process.stdin.write(b'{"do": "apply", "event": "#e1", "replan": true}\n')
    process.stdin.flush()
    seconds, printed, errors = interrupted(
        process, signal.SIGTERM, lambda: searches(process, token)
    )
    assert process.returncode == 0, errors
    assert seconds < WITHIN
    answer = json.loads(printed)
    assert answer["ok"]
    schedule = answer["step"]["schedule"]
    assert schedule["interrupted"] is True
    assert schedule["status"] in ("feasible", "unknown")


# --- the handler --------------------------------------------------------------------------------


def handle(interruption: Interruption, number: int) -> None:
    interruption._arrived(number, None)


def test_the_first_signal_cancels_and_the_second_raises() -> None:
    interruption = Interruption()
    with interruption.planning() as cancel:
        handle(interruption, signal.SIGINT)
        assert cancel.is_cancelled
        with pytest.raises(Interrupted) as ended:
            handle(interruption, signal.SIGTERM)
    assert ended.value.status == interruption.status == 130


def test_where_nothing_is_planned_the_first_one_raises() -> None:
    interruption = Interruption()
    with pytest.raises(Interrupted) as ended:
        handle(interruption, signal.SIGTERM)
    assert ended.value.status == 143


def test_planning_that_has_not_noticed_has_nothing_to_show() -> None:
    noticed, unnoticed, answered = Interruption(), Interruption(), Interruption()
    with noticed.planning() as cancel:
        handle(noticed, signal.SIGINT)
        assert cancel.is_cancelled
        noticed._waited(signal.SIGALRM, None)
    with answered.planning() as cancel:
        cancel.keep()
        handle(answered, signal.SIGINT)
        answered._waited(signal.SIGALRM, None)
    with unnoticed.planning():
        handle(unnoticed, signal.SIGINT)
        for _ in range(2):  # once more, if the first one was swallowed on its way
            with pytest.raises(Interrupted):
                unnoticed._waited(signal.SIGALRM, None)


def test_a_signal_can_be_the_usual_end() -> None:
    interruption = Interruption()
    interruption.usual = signal.SIGTERM
    with pytest.raises(Interrupted) as ended:
        handle(interruption, signal.SIGTERM)
    assert ended.value.status == 0


def test_json_says_that_there_is_no_answer(capsys: pytest.CaptureFixture[str]) -> None:
    from irc.cli.output import Format, reporting_errors

    def command() -> Any:
        with reporting_errors(Format.json):
            raise Interrupted(130)

    with pytest.raises(SystemExit) as ended:
        command()
    assert ended.value.code == 130
    assert json.loads(capsys.readouterr().out)["exit"] == 130


@pytest.mark.slow
def test_a_batch_that_is_killed_is_resumed_and_one_that_is_ended_says_so(tmp_path: Path) -> None:
    from irc.batches.results_file import read_results

    tasks = [{"name": f"t{k}", "actions": [{"id": "a", "duration": k + 1}]} for k in range(300)]
    lines = [*tasks, shop().model_dump(mode="json", by_alias=True, exclude_unset=True)]
    (tmp_path / "tasks.jsonl").write_text("".join(json.dumps(t) + "\n" for t in lines), "utf-8")
    output = tmp_path / "results.jsonl"
    command = ("batch", "tasks.jsonl", "-o", "results.jsonl", "-j", "1", "--time-limit", "60")

    def has_results(least: int) -> bool:
        return output.exists() and output.read_bytes().count(b"\n") >= least

    killed = begun(tmp_path, *command)
    while not has_results(1):
        time.sleep(0.005)
    killed.kill()
    killed.communicate(timeout=30)
    ended = begun(tmp_path, *command, IRC_CHILD_TOKEN="batch-test-token")
    seconds, out, errors = interrupted(ended, signal.SIGTERM, lambda: has_results(300))
    assert (ended.returncode, "interrupted: the same command" in errors) == (143, True)
    assert seconds < WITHIN
    assert "cpsat" in out
    found = [result.task for result in read_results(output)]
    assert sorted(found) == sorted(f"tasks.jsonl:{k + 1}" for k in range(300))
    assert planners_of("batch-test-token") == []
