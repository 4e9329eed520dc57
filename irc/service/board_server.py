"""Serves a board to browsers on this machine: the page, its data, and a stream that says "change".

Starlette and uvicorn (extra `board`) do the protocol: they judge requests, stream to clients that
come and go, and end within a given time, which a server of our own would have to be taught. The
server listens on the loopback interface alone, answers only requests that name this machine as
their host (so no page from elsewhere reads it by a name that leads here), and takes only GET.
"""

from __future__ import annotations

import asyncio
import socket
import threading
from collections.abc import AsyncIterator
from types import TracebackType
from typing import TYPE_CHECKING

from irc.errors import IrcError, LibraryMissing
from irc.outcome import MISUSED
from irc.service.board import Board

if TYPE_CHECKING:
    from starlette.applications import Starlette
    from starlette.requests import Request
    from starlette.responses import Response

HOST = "127.0.0.1"
_HOSTS = ["127.0.0.1", "localhost"]

ALIVE_SECONDS = 15.0
"""A stream says at least this often that it is alive."""

ENDING_SECONDS = 1
"""The time that open streams have to end when the command does."""

_HEADERS = {
    "Cache-Control": "no-store",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
}


class BoardError(IrcError):
    """The board cannot be served; the text says why."""

    ends_as = MISUSED


class BoardServer:
    """A server of a board in threads of its own, from `with` to the end of the block.

    `port` 0 takes a free one. Raises `BoardError` where the port cannot be had, and
    `LibraryMissing` without the extra.
    """

    def __init__(self, board: Board, port: int) -> None:
        try:
            import uvicorn
        except ImportError:
            raise LibraryMissing(
                "a board needs a library: `pip install irc-compiler[board]`"
            ) from None
        self.board = board
        self._socket = _listening(port)
        self.port: int = self._socket.getsockname()[1]
        config = uvicorn.Config(
            app(board),
            log_config=None,
            access_log=False,
            lifespan="off",
            ws="none",
            server_header=False,
            timeout_graceful_shutdown=ENDING_SECONDS,
        )
        self._server = uvicorn.Server(config)
        # (A signal is the command's business, and a thread other than the main one gets none.)
        self._thread = threading.Thread(
            target=self._server.run, args=([self._socket],), name="irc board", daemon=True
        )

    @property
    def url(self) -> str:
        """The address of the page."""
        return f"http://{HOST}:{self.port}/"

    def __enter__(self) -> BoardServer:
        self._thread.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.board.end()
        self._server.should_exit = True
        self._thread.join(timeout=ENDING_SECONDS + 2)
        self._socket.close()


def _listening(port: int) -> socket.socket:
    try:
        return socket.create_server((HOST, port))
    except (OSError, OverflowError) as error:
        why = getattr(error, "strerror", None) or error
        raise BoardError(f"the board cannot have port {port}: {why}; choose another") from None


def app(board: Board) -> Starlette:
    """The application: `/`, `/payload.json` and `/events`, for GET alone."""
    from starlette.applications import Starlette
    from starlette.middleware import Middleware
    from starlette.middleware.trustedhost import TrustedHostMiddleware
    from starlette.responses import Response, StreamingResponse
    from starlette.routing import Route

    def page(request: Request) -> Response:
        return Response(board.page(), media_type="text/html", headers=_HEADERS)

    def payload(request: Request) -> Response:
        return Response(board.payload(), media_type="application/json", headers=_HEADERS)

    async def events(request: Request) -> Response:
        # (A browser that comes back says what it has seen last.)
        seen = request.headers.get("last-event-id") or request.query_params.get("since")
        stream = _changes(board, int(seen) if seen and seen.isdecimal() else 0)
        return StreamingResponse(stream, media_type="text/event-stream", headers=_HEADERS)

    return Starlette(
        routes=[
            Route("/", page, methods=["GET"]),
            Route("/payload.json", payload, methods=["GET"]),
            Route("/events", events, methods=["GET"]),
        ],
        middleware=[Middleware(TrustedHostMiddleware, allowed_hosts=_HOSTS)],
    )


async def _changes(board: Board, seen: int) -> AsyncIterator[str]:
    """The events of a stream: `change` for each version after `seen`, and `end`."""
    changed = asyncio.Event()
    loop = asyncio.get_running_loop()

    def listener() -> None:
        loop.call_soon_threadsafe(changed.set)

    stop = board.listen(listener)
    try:
        yield "retry: 1000\n\n"
        while not board.ended:
            changed.clear()
            if board.version > seen:
                seen = board.version
                yield f"id: {seen}\nevent: change\ndata: {seen}\n\n"
            try:
                await asyncio.wait_for(changed.wait(), ALIVE_SECONDS)
            except TimeoutError:
                yield ": alive\n\n"
        yield "event: end\ndata: \n\n"
    finally:
        stop()
