"""The live board of `irc run`: read by real clients on the loopback interface."""

from __future__ import annotations

import http.client
import json
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from irc.execution.execution import Execution
from irc.model import Task
from irc.schedule import Entry, Schedule
from irc.service.board import MOST_PLANS, Board
from irc.service.board_server import BoardError, BoardServer
from runs import run_irc

SECONDS = 20.0
ACTIONS = [{"id": "a", "duration": 3}, {"id": "b", "duration": 2}]
TASK = {"time_unit": "min", "actions": ACTIONS, "precedence": [["a", "b"]]}
PLAN = Schedule((Entry("a", 0, 3), Entry("b", 3, 5)), time_unit="min")


def _execution() -> Execution:
    return Execution(Task(**TASK), PLAN)


@contextmanager
def _served(board: Board) -> Iterator[BoardServer]:
    with BoardServer(board, 0) as server:
        yield server


def _ask(port: int, path: str, method: str = "GET", **headers: str) -> tuple[int, bytes]:
    client = http.client.HTTPConnection("127.0.0.1", port, timeout=SECONDS)
    try:
        client.request(method, path, headers=headers)
        answer = client.getresponse()
        return answer.status, answer.read()
    finally:
        client.close()


class _Stream:
    """A stream of events, read line by line."""

    def __init__(self, port: int, since: int) -> None:
        self.client = http.client.HTTPConnection("127.0.0.1", port, timeout=SECONDS)
        self.client.request("GET", f"/events?since={since}")
        self.answer = self.client.getresponse()

    def next(self) -> str:
        """The name of the next event."""
        while line := self.answer.readline():
            if line.startswith(b"event: "):
                return line.removeprefix(b"event: ").decode().strip()
        return "closed"


def _times(payload: dict[str, Any]) -> list[list[str]]:
    """The start and the end of each action in the last plan."""
    return [payload["rows"][r]["c"][4:6] for r in payload["plans"][-1]["rows"]]


def test_the_page_shows_the_plan_and_may_ask_only_its_own_server() -> None:
    with _served(Board(_execution())) as server:
        status, html = _ask(server.port, "/")
        assert status == 200
        assert b"connect-src 'self'" in html
        assert b"default-src 'none'" in html
        payload = json.loads(_ask(server.port, "/payload.json")[1])
    assert payload["live"]
    assert [row["c"][0] for row in payload["rows"]] == ["a", "b"]


def test_a_change_reaches_a_client_that_listens() -> None:
    execution = _execution()
    board = Board(execution)
    with _served(board) as server:
        stream = _Stream(server.port, since=board.version)
        execution.observe("a", started=0, finished=4, at=4)
        board.publish(execution, execution.pending)
        assert stream.next() == "change"
        plan = json.loads(_ask(server.port, "/payload.json")[1])["plans"][-1]
        assert "out of date" in plan["label"]
        assert plan["events"] == ["at 4 min: a started at 0 min and finished at 4 min"]
        execution.replan()
        board.publish(execution)
        assert stream.next() == "change"
        payload = json.loads(_ask(server.port, "/payload.json")[1])
        assert _times(payload) == [["0", "4"], ["4", "6"]]
        assert [plan["at"] for plan in payload["plans"]] == ["0", "4"]
        assert payload["plans"][-1]["events"] == plan["events"]
    assert stream.next() == "end"
    assert stream.next() == "closed"


def test_a_client_that_comes_back_hears_of_what_it_missed() -> None:
    board = Board(_execution())
    seen = board.version
    execution = _execution()
    execution.advance(1)
    board.publish(execution)
    with _served(board) as server:
        assert _Stream(server.port, since=seen).next() == "change"


def test_nothing_can_be_written_and_other_hosts_are_refused() -> None:
    with _served(Board(_execution())) as server:
        for method in ("POST", "PUT", "DELETE"):
            assert _ask(server.port, "/", method)[0] == 405
        assert _ask(server.port, "/", Host="plans.example")[0] == 400
        assert _ask(server.port, "/", Host=f"localhost:{server.port}")[0] == 200
        assert _ask(server.port, "/secret")[0] == 404
        assert server.url.startswith("http://127.0.0.1:")


def test_a_taken_port_is_reported() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(BoardError, match=f"cannot have port {port}.*choose another"):
            BoardServer(Board(_execution()), port)


def test_time_that_passes_is_no_further_plan_and_old_plans_go() -> None:
    execution = _execution()
    board = Board(execution)
    execution.advance(1)
    board.publish(execution)
    (plan,) = json.loads(board.payload())["plans"]
    assert plan["at"] == "1"
    for k in range(MOST_PLANS + 5):
        task = Task(**TASK)
        later = Schedule((Entry("a", k + 2, k + 5), Entry("b", k + 5, k + 7)))
        board.publish(Execution(task, later))
    assert len(json.loads(board.payload())["plans"]) == MOST_PLANS


@pytest.mark.slow
def test_the_command_serves_a_board_while_it_runs_and_leaves_nothing_behind(
    tmp_path: Path,
) -> None:
    file = tmp_path / "task.json"
    file.write_text(json.dumps(TASK), "utf-8")
    command = [sys.executable, "-m", "irc", "run", str(file), "--stdio", "--board", "0"]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=pipe, text=True) as process:
        assert process.stdin is not None
        assert process.stderr is not None
        said = process.stderr.readline()
        port = int(said.rstrip("/\n").rpartition(":")[2])
        _answer(process)
        stream = _Stream(port, since=1)
        seen = {"do": "observe", "at": 4, "action": "a", "finished": 4, "replan": True}
        process.stdin.write(json.dumps(seen) + "\n")
        process.stdin.flush()
        assert _answer(process)["ok"]
        assert stream.next() == "change"
        payload = json.loads(_ask(port, "/payload.json")[1])
        assert payload["plans"][-1]["events"]
        process.stdin.write('{"do": "stop"}\n')
        process.stdin.flush()
        begin = time.monotonic()
        assert stream.next() == "end"
        assert process.wait(SECONDS) == 0
        assert time.monotonic() - begin < 5
    with pytest.raises(OSError):
        socket.create_connection(("127.0.0.1", port), timeout=1)


def _answer(process: subprocess.Popen[str]) -> dict[str, Any]:
    assert process.stdout
    found: dict[str, Any] = json.loads(process.stdout.readline())
    return found


def test_a_port_that_is_none_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "task.json"
    file.write_text(json.dumps(TASK), "utf-8")
    assert run_irc("run", file, "--stdio", "--board", "70000").exit_code == 2
