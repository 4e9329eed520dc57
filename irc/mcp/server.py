"""Serves the tools by the Model Context Protocol, over standard input and output.

Each call works in a thread of its own with its own cancellation, so that calls run side by side,
and one that the client cancels, or a client that goes away, ends the planning.
"""

from __future__ import annotations

import io
import json
import os
import signal
import sys
import threading
from collections.abc import Callable
from functools import partial
from types import FrameType
from typing import Annotated, Any

import anyio
import anyio.to_thread
from mcp.server import MCPServer
from mcp.types import CallToolResult, TextContent, ToolAnnotations
from pydantic import Field

from irc._version import __version__
from irc.errors import IrcError
from irc.mcp import tools
from irc.mcp.tools import DEFAULT_SECONDS, MOST_SECONDS, Document, Given
from irc.targets import Cancellation

AT_ONCE = 4
"""Calls that work side by side; others wait."""

LONGEST_LINE = 8 * 2**20
"""Limit on one message from the client, in bytes."""

PATIENCE_SECONDS = 2.0
"""The time that calls under way have to end when the server does."""

INSTRUCTIONS = """\
irc plans asynchronous work: actions with durations, order, shared resources, state, deadlines.
Write a task (see the tool `schema`), `check` it and put right what the diagnostics name, `solve` \
it. `explain` says why there is no schedule, or no shorter one. `replan` continues a schedule that \
is being carried out."""

TaskArgument = Annotated[
    Given, Field(description="A task: a JSON object of the IR, or text (JSON, the DSL, English).")
]
ScheduleArgument = Annotated[
    Given, Field(description="A schedule: the document that `solve` returns.")
]
TimeArgument = Annotated[
    str | float, Field(description="A time of the task, in its unit, or a text such as '5 min'.")
]
EventsArgument = Annotated[
    str | list[dict[str, Any]] | dict[str, Any] | None,
    Field(description="What happened: an event, a list of them, or text; see `schema`, `event`."),
]
LimitArgument = Annotated[
    float, Field(description=f"Seconds for planning, at most {MOST_SECONDS:g}.")
]

Work = Callable[[Cancellation], Document]


class Calls:
    """The calls under way, each with what ends it."""

    def __init__(self) -> None:
        self._cancellations: dict[int, Cancellation] = {}
        self._free = anyio.CapacityLimiter(AT_ONCE)
        self._threads = 0
        self._idle = threading.Condition()

    async def run(self, work: Work) -> CallToolResult:
        """Runs the work in a thread; where this is cancelled, so is the work."""
        cancel = Cancellation()
        self._cancellations[id(cancel)] = cancel
        try:
            return await anyio.to_thread.run_sync(
                partial(self._work, work, cancel), abandon_on_cancel=True, limiter=self._free
            )
        finally:
            cancel.cancel()
            del self._cancellations[id(cancel)]

    def _work(self, work: Work, cancel: Cancellation) -> CallToolResult:
        with self._idle:
            self._threads += 1
        try:
            return _result(work(cancel), failed=False)
        except IrcError as error:
            return _result(tools.answered(error), failed=True)
        finally:
            with self._idle:
                self._threads -= 1
                self._idle.notify_all()

    def end(self) -> None:
        """Cancels all calls and waits a little for them, so that no child process goes on."""
        for cancel in list(self._cancellations.values()):
            cancel.cancel()
        with self._idle:
            self._idle.wait_for(lambda: not self._threads, PATIENCE_SECONDS)


def _result(document: Document, *, failed: bool) -> CallToolResult:
    """A document as structured content, and as text for agents that read nothing else."""
    text = TextContent(text=json.dumps(document, ensure_ascii=False))
    return CallToolResult(content=[text], structured_content=document, is_error=failed)


# --- the tools ----------------------------------------------------------------------------------


def make_server(calls: Calls) -> MCPServer[Any]:
    """The server with its tools. All of them only read: nothing outside of a call changes."""
    server: MCPServer[Any] = MCPServer(
        "irc", instructions=INSTRUCTIONS, version=__version__, log_level="WARNING"
    )

    async def check(task: TaskArgument) -> CallToolResult:
        """Report every fault of a task at once, each with code, place, hint and certain repairs."""
        return await calls.run(lambda _: tools.check(task))

    async def solve(
        task: TaskArgument,
        target: str = "cpsat",
        engine: str = "auto",
        time_limit: LimitArgument = DEFAULT_SECONDS,
    ) -> CallToolResult:
        """Find the best schedule of a task: exact, validated, with its status and a bound."""
        return await calls.run(lambda cancel: tools.solve(task, target, engine, time_limit, cancel))

    async def validate(
        task: TaskArgument, schedule: ScheduleArgument, at: TimeArgument | None = None
    ) -> CallToolResult:
        """Judge a schedule: every broken rule; what began before `at` is history."""
        return await calls.run(lambda _: tools.validate(task, schedule, at))

    async def explain(
        task: TaskArgument, time_limit: LimitArgument = DEFAULT_SECONDS
    ) -> CallToolResult:
        """Show which statements cannot hold together, or why no schedule is shorter."""
        return await calls.run(lambda cancel: tools.explain(task, time_limit, cancel))

    async def replan(
        task: TaskArgument,
        schedule: ScheduleArgument,
        at: TimeArgument,
        events: EventsArgument = None,
        time_limit: LimitArgument = DEFAULT_SECONDS,
    ) -> CallToolResult:
        """Plan the rest of a running schedule again at a time, after events; the past stays."""
        return await calls.run(
            lambda cancel: tools.replan(task, schedule, at, events, time_limit, cancel)
        )

    async def schema(strict: bool = True, event: bool = False) -> CallToolResult:
        """The JSON Schema of a task, or of an event; `strict` is the small, closed one."""
        return await calls.run(lambda _: tools.schema(strict, event))

    hints = ToolAnnotations(read_only_hint=True, idempotent_hint=True, open_world_hint=False)
    for tool in (check, solve, validate, explain, replan, schema):
        server.add_tool(tool, annotations=hints)
    return server


# --- standard input and output ------------------------------------------------------------------


class BoundedLines(io.BufferedIOBase):
    """Bytes of which no line is longer than a limit: what is longer is cut, and so is refused."""

    def __init__(self, raw: io.BufferedIOBase, limit: int = LONGEST_LINE) -> None:
        self._raw = raw
        self._limit = limit
        self._length = 0

    def readable(self) -> bool:
        """It is there to be read."""
        return True

    def read1(self, size: int | None = None) -> bytes:
        """Some bytes; none only at the end."""
        while data := self._raw.read1(size if size and size > 0 else 2**16):
            if kept := b"".join(self._kept(line) for line in data.splitlines(keepends=True)):
                return kept
        return b""

    read = read1

    def _kept(self, part: bytes) -> bytes:
        """A part of a line as far as the limit allows it."""
        left = max(0, self._limit - self._length)
        ends = part.endswith(b"\n")
        self._length = 0 if ends else self._length + len(part)
        return part if len(part) <= left else part[:left] + (b"\n" if ends else b"")


def serve_standard_streams() -> None:
    """Serves one client until it goes away, or until ^C or SIGTERM."""
    calls = Calls()

    def ended(number: int, _frame: FrameType | None) -> None:
        calls.end()
        os._exit(128 + number)

    for ending in (signal.SIGINT, signal.SIGTERM):
        signal.signal(ending, ended)
    sys.stdin = io.TextIOWrapper(BoundedLines(sys.stdin.buffer), encoding="utf-8")  # type: ignore[arg-type]
    make_server(calls).run("stdio")
    calls.end()
    # (Python would wait for threads that compute on for a client that is gone.)
    os._exit(0)
