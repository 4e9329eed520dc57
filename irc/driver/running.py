"""Calls that run in a thread of their own: to be waited for, ended early, or awaited."""

from __future__ import annotations

import asyncio
import atexit
import weakref
from collections.abc import Callable
from concurrent.futures import Future
from contextlib import suppress
from threading import Thread
from typing import Any, Generic, TypeVar

from irc.targets import Cancellation

Result = TypeVar("Result")

_RUNNING: weakref.WeakSet[Running[Any]] = weakref.WeakSet()
"""The calls that are to end before the program does."""


class Running(Generic[Result]):
    """A call in a thread of its own; the call is given the cancellation that ends it."""

    def __init__(
        self, call: Callable[[Cancellation], Result], outer: Cancellation | None = None
    ) -> None:
        self.cancellation = Cancellation(outer)
        self.future: Future[Result] = Future()
        self.future.set_running_or_notify_cancel()
        _RUNNING.add(self)
        Thread(target=self._run, args=(call,), name="irc", daemon=True).start()

    def _run(self, call: Callable[[Cancellation], Result]) -> None:
        try:
            self.future.set_result(call(self.cancellation))
        except BaseException as error:  # noqa: BLE001 - it is raised where the result is asked for
            self.future.set_exception(error)

    def end(self) -> None:
        """Cancels the call, and waits until its engine has ended."""
        self.cancellation.cancel()
        self.future.exception()


@atexit.register
def _end_all() -> None:
    """Ends what still runs when the program ends, with its engines."""
    for running in list(_RUNNING):
        running.end()


async def awaited(
    call: Callable[[Cancellation], Result],
    outer: Cancellation | None = None,
    *,
    cancel: Callable[[], None] | None = None,
) -> Result:
    """The result of a call that does not block the event loop.

    If the task that waits is cancelled, so is the call (by `cancel`, if it takes more than the
    call's own cancellation); `CancelledError` goes on its way only when its engine has ended.
    """
    running = Running(call, outer)
    waiting = asyncio.wrap_future(running.future)
    try:
        return await asyncio.shield(waiting)
    except asyncio.CancelledError:
        running.cancellation.cancel()
        if cancel is not None:
            cancel()
        while not waiting.done():
            # (Cancelled again it waits all the same: nothing is to be left behind.)
            with suppress(asyncio.CancelledError):
                await asyncio.wait((waiting,))
        waiting.exception()  # (asyncio is not to report it as never retrieved.)
        raise
