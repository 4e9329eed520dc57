"""The MCP server, asked by the SDK's own client over standard input and output."""

from __future__ import annotations

import io
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import AsyncIterator, Callable, Coroutine
from contextlib import asynccontextmanager
from typing import Any

import anyio
import pytest
from mcp import Client
from mcp.client.stdio import StdioServerParameters
from mcp.types import CallToolResult

import irc
from irc.mcp import tools
from irc.mcp.server import BoundedLines, Calls, make_server
from paths import EXAMPLES, ROOT
from runs import run_irc

TEA: dict[str, Any] = {
    "time_unit": "min",
    "resources": [{"id": "stove"}],
    "actions": [
        {"id": "boil", "duration": 4, "uses": [{"resource": "stove"}]},
        {"id": "fry", "duration": 6, "uses": [{"resource": "stove"}]},
        {"id": "eat", "duration": 9},
    ],
    "precedence": [["boil", "eat"]],
}
MISSPELT = {**TEA, "precedence": [["boyl", "eat"]]}
LATE = {**TEA, "deadline": 11}


def long_task() -> dict[str, Any]:
    """A job shop for which no minute is enough."""
    import random

    draw = random.Random(5)
    jobs, machines = 24, 12
    actions, edges = [], []
    for job in range(jobs):
        order = draw.sample(range(machines), machines)
        for step, machine in enumerate(order):
            use = [{"resource": f"m{machine}"}]
            actions.append({"id": f"{job}/{step}", "duration": draw.randint(1, 99), "uses": use})
            if step:
                edges.append([f"{job}/{step - 1}", f"{job}/{step}"])
    resources = [{"id": f"m{m}"} for m in range(machines)]
    return {"resources": resources, "actions": actions, "precedence": edges}


PATHS = os.pathsep.join(map(str, (ROOT, ROOT / "backends", ROOT / "grammars")))
COMMAND = [sys.executable, "-m", "irc", "mcp"]


def served() -> Client:
    parameters = StdioServerParameters(
        command=COMMAND[0], args=COMMAND[1:], env={"PYTHONPATH": PATHS}
    )
    return Client(parameters)


def asking(talk: Callable[[Client], Coroutine[Any, Any, None]], client: Client) -> None:
    """Runs a conversation with a server, which must not take long."""

    async def main() -> None:
        with anyio.fail_after(90):
            async with client as connected:
                await talk(connected)

    anyio.run(main)


def document(result: CallToolResult) -> dict[str, Any]:
    """The structured content, of which the text is a copy."""
    assert result.structured_content is not None, result.content
    (text,) = result.content
    assert json.loads(text.text) == result.structured_content  # type: ignore[union-attr]
    return result.structured_content


# --- the whole server ---------------------------------------------------------------------------


@pytest.mark.slow
def test_all_tools_over_standard_input_and_output() -> None:
    """One process: start-up, each tool, faults, time limit, cancellation, two calls at once."""

    async def talk(client: Client) -> None:
        listed = {tool.name: tool for tool in (await client.list_tools()).tools}
        assert set(listed) == {"check", "solve", "validate", "explain", "replan", "schema"}
        assert all(tool.description for tool in listed.values())
        assert listed["replan"].input_schema["required"] == ["task", "schedule", "at"]

        schedule = document(await client.call_tool("solve", {"task": TEA}))
        assert (schedule["status"], schedule["makespan"]) == ("optimal", 13)
        verdict = document(await client.call_tool("validate", {"task": TEA, "schedule": schedule}))
        assert verdict["valid"] is True

        faulty = await client.call_tool("solve", {"task": json.dumps(MISSPELT)})
        assert faulty.is_error
        assert "there is no action 'boyl'" in document(faulty)["text"]

        slow = {"task": long_task(), "time_limit": 1.0}
        begun = time.monotonic()
        answers: list[dict[str, Any]] = []

        async def solve() -> None:
            answers.append(document(await client.call_tool("solve", slow)))

        async with anyio.create_task_group() as calls:
            calls.start_soon(solve)
            calls.start_soon(solve)
        assert [a["status"] for a in answers] == ["feasible", "feasible"]
        assert time.monotonic() - begun < 20

        with anyio.move_on_after(0.5) as left:
            await client.call_tool("solve", {**slow, "time_limit": 200})
        assert left.cancelled_caught
        begun = time.monotonic()
        assert document(await client.call_tool("check", {"task": "unit min\na 5\n"}))["ok"]
        assert time.monotonic() - begun < 5

    asking(talk, served())


def request(number: int, tool: str, arguments: dict[str, Any]) -> bytes:
    call = {"name": tool, "arguments": arguments}
    message = {"jsonrpc": "2.0", "id": number, "method": "tools/call", "params": call}
    return json.dumps(message).encode() + b"\n"


def handshake() -> bytes:
    about = {"protocolVersion": "2025-06-18", "capabilities": {}}
    about["clientInfo"] = {"name": "test", "version": "0"}
    first = {"jsonrpc": "2.0", "id": 0, "method": "initialize", "params": about}
    second = {"jsonrpc": "2.0", "method": "notifications/initialized"}
    return b"".join(json.dumps(message).encode() + b"\n" for message in (first, second))


def begun() -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        COMMAND,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env={**os.environ, "PYTHONPATH": PATHS},
    )


def working(first: bytes, ids: set[int]) -> subprocess.Popen[bytes]:
    """A server that has answered these requests, and plans for one more by a process of its own."""
    server = begun()
    assert server.stdin is not None
    assert server.stdout is not None
    slow = {"task": long_task(), "time_limit": 200, "target": "pddl21"}
    server.stdin.write(handshake() + first + request(9, "solve", slow))
    server.stdin.flush()
    found: dict[int | None, Any] = {}
    while not ids <= set(found):
        message = json.loads(server.stdout.readline())
        found[message.get("id")] = message
    if 1 in found:
        assert found[1]["result"]["structuredContent"]["ok"] is True
        assert found[2]["result"]["isError"] is True
    time.sleep(1.0)
    return server


def left(server: subprocess.Popen[bytes]) -> bytes:
    """What the server still says; it must end soon, and with it all that has its output open."""
    said = time.monotonic()
    rest, _ = server.communicate(timeout=60)
    assert time.monotonic() - said < 10
    return rest


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_the_server_ends_with_a_signal() -> None:
    server = working(b"", {0})
    server.send_signal(signal.SIGTERM)
    left(server)
    assert server.returncode == 143


@pytest.mark.slow
def test_what_is_no_message_ends_nothing_and_a_client_that_goes_away_all() -> None:
    rubbish = b"hello\n\xff\xfe\n{}\n[]\n" + b"x" * (9 * 2**20) + b"\n"
    asked = request(1, "check", {"task": TEA}) + request(2, "check", {"tusk": 3})
    server = working(rubbish + asked, {1, 2})
    left(server)
    assert server.returncode == 0


def test_the_server_needs_its_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("irc.cli.mcp.find_spec", lambda _: None)
    told = run_irc("mcp")
    assert told.exit_code == 4
    assert "pip install 'irc-compiler[mcp]'" in told.stderr


# --- the tools, without a process ---------------------------------------------------------------


@asynccontextmanager
async def in_memory() -> AsyncIterator[Client]:
    async with Client(make_server(Calls())) as client:
        yield client


def called(tool: str, **arguments: Any) -> CallToolResult:
    async def main() -> CallToolResult:
        with anyio.fail_after(60):
            async with in_memory() as client:
                return await client.call_tool(tool, arguments)

    return anyio.run(main)


def test_check_reports_every_fault_with_its_place_and_hint() -> None:
    result = called("check", task=MISSPELT)
    assert not result.is_error
    (finding,) = document(result)["diagnostics"]
    assert finding["code"] == "IRC201"
    assert finding["pointer"] == "/precedence/0/0"
    assert "boil" in finding["hint"]
    assert document(called("check", task=TEA))["ok"] is True


@pytest.mark.slow
@pytest.mark.parametrize("file", ["pancake_breakfast.json", "night_shift.irc"])
def test_a_task_may_be_text_in_any_language(file: str) -> None:
    text = (EXAMPLES / file).read_text("utf-8")
    found = document(called("solve", task=text))
    assert found == {**irc.solve(irc.loads(text)).to_dict(), **_volatile(found)}


def _volatile(found: dict[str, Any]) -> dict[str, Any]:
    """The fields that differ from run to run, or between schedules that are equally good."""
    names = ("actions", "solver", "engine", "seconds", "solve_seconds", "outcome", "notes")
    return {name: found[name] for name in names if name in found}


def test_explain_names_what_cannot_hold_together() -> None:
    found = document(called("explain", task=LATE))
    assert found["status"] == "infeasible"
    assert any("deadline" in s["pointer"] for s in found["conflict"])
    assert document(called("explain", task=TEA))["makespan"] == 13
    told = called("solve", task=LATE)
    assert not told.is_error
    assert document(told)["outcome"]["status"] == "infeasible"


def test_replan_keeps_the_past_and_applies_what_happened() -> None:
    schedule = document(called("solve", task=TEA))
    event = {"changes": [{"op": "set_duration", "action": "eat", "duration": 20}]}
    for events in (
        event,
        [event],
        json.dumps(event),
        "event e at 1:\n    set duration of eat = 20\n",
    ):
        step = document(called("replan", task=TEA, schedule=schedule, at=1, events=events))
        assert step["schedule"]["makespan"] == 24
    step = document(called("replan", task=TEA, schedule=schedule, at="1 min"))
    assert step["schedule"]["makespan"] == 13
    wrong = {"changes": [{"op": "set_duration", "action": "eet", "duration": 20}]}
    told = called("replan", task=TEA, schedule=schedule, at=1, events=wrong)
    assert told.is_error
    (finding,) = document(told)["diagnostics"]
    assert finding["message"] == "there is no action 'eet'"
    assert finding["pointer"] == "/changes/0/action"


def test_validate_names_what_is_broken() -> None:
    schedule = document(called("solve", task=TEA))
    ends = {"boil": 4, "fry": 6, "eat": 13}
    schedule["actions"] = [
        {**a, "start": 4 if a["id"] == "eat" else 0, "end": ends[a["id"]]}
        for a in schedule["actions"]
    ]
    found = document(called("validate", task=TEA, schedule=schedule))
    assert found["valid"] is False
    assert found["violations"]


@pytest.mark.parametrize("strict", [True, False])
@pytest.mark.parametrize("event", [True, False])
def test_schema_is_that_of_a_task_or_an_event(strict: bool, event: bool) -> None:
    found = document(called("schema", strict=strict, event=event))
    assert ("changes" if event else "actions") in found["properties"]


@pytest.mark.parametrize(
    ("tool", "arguments", "message"),
    [
        ("solve", {"task": TEA, "time_limit": 0}, "time_limit is 0; it must be in (0, 300]"),
        ("solve", {"task": TEA, "time_limit": 1e9}, "it must be in (0, 300]"),
        ("solve", {"task": TEA, "target": "clingo"}, "there is no target 'clingo'"),
        ("solve", {"task": TEA, "engine": "none"}, "none"),
        ("solve", {"task": " "}, "the input is empty"),
        ("check", {"task": "x" * (tools.MOST_CHARACTERS + 1)}, "at most 1,048,576 are read"),
        ("check", {"task": 'include "/etc/passwd"\n'}, "include"),
        ("validate", {"task": TEA, "schedule": "{}"}, "schedule"),
        ("validate", {"task": TEA, "schedule": "$", "at": "noonish"}, "at: "),
        ("replan", {"task": TEA, "schedule": {}, "at": 1}, "schedule"),
        ("replan", {"task": TEA, "schedule": "$", "at": -1}, "before the task begins"),
        ("replan", {"task": TEA, "schedule": "$", "at": "x"}, "at: "),
        ("replan", {"task": TEA, "schedule": "$", "at": 1, "events": "event"}, "IRC010"),
    ],
)
def test_a_wrong_argument_is_a_result_that_names_it(
    tool: str, arguments: dict[str, Any], message: str
) -> None:
    if arguments.get("schedule") == "$":
        arguments = {**arguments, "schedule": irc.solve(TEA).to_dict()}
    result = called(tool, **arguments)
    assert message in json.dumps(document(result), ensure_ascii=False)
    assert result.is_error or tool == "check"
    assert "outcome" in document(result)


def test_a_line_is_cut_at_its_limit_and_the_next_one_is_whole() -> None:
    raw = io.BufferedReader(io.BytesIO(b"short\n" + b"y" * 100 + b"\nafter\n" + b"z" * 50))  # type: ignore[arg-type]
    lines = io.TextIOWrapper(BoundedLines(raw, 10), encoding="utf-8").readlines()  # type: ignore[arg-type]
    assert lines == ["short\n", "y" * 10 + "\n", "after\n", "z" * 10]
